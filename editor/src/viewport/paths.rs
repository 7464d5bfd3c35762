//! Tool paths in space: the moves of every part where its panel is, coloured by what they do.

use crate::boards::kind_colour;
use crate::model::Model;
use crate::model::cut::{self, Kind as Does};
use crate::scene::{Drawing, Kind, Line, Part};
use glam::DVec3;
use std::sync::Arc;
use tenon_geometry::board::PartSet;
use tenon_geometry::motion::{MoveKind, PartPaths};

/// What moves do, in the order of the colours.
const KINDS: [Does; 4] = [Does::Rapid, Does::Plunge, Does::Cut, Does::Retract];

/// Tool paths of all parts, kept while they stay the same.
#[derive(Default)]
pub struct Paths {
    of: Option<u128>,
    drawing: Option<Arc<Drawing>>,
    colours: Arc<Vec<u32>>,
}

impl Paths {
    /// What is drawn, and the colours of what moves do; none if no node gives tool paths. O(moves) after a change.
    pub fn of(&mut self, model: &Model) -> Option<(Arc<Drawing>, Arc<Vec<u32>>)> {
        let (paths, parts, digest) = cut::paths(model)?;
        if self.of != Some(digest) {
            self.drawing = draw(paths, parts, digest).map(Arc::new);
            self.of = Some(digest);
            let bytes = |k| {
                let c: eframe::egui::Color32 = kind_colour(k);
                u32::from_le_bytes([c.r(), c.g(), c.b(), 255])
            };
            self.colours = Arc::new(KINDS.into_iter().map(bytes).chain([0]).collect());
        }
        Some((self.drawing.clone()?, self.colours.clone()))
    }
}

fn draw(paths: &PartPaths, parts: &PartSet, digest: u128) -> Option<Drawing> {
    let p = &paths.paths;
    let mut lines = Vec::new();
    let mut bounds = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for o in &p.operations {
        let Some(frame) = parts.frame.get(o.part as usize) else { continue };
        let back = frame.inverse();
        let mut last: Option<DVec3> = None;
        for k in o.moves.start as usize..o.moves.end as usize {
            let (Some(tip), Some(kind)) = (p.tip.get(k), p.kind.get(k)) else { continue };
            let at = back.transform_point3(*tip);
            bounds = [bounds[0].min(at), bounds[1].max(at)];
            let part = match kind {
                MoveKind::Rapid | MoveKind::Approach => 0,
                MoveKind::Plunge => 1,
                MoveKind::Cut => 2,
                MoveKind::Lift => 3,
            };
            if let Some(from) = last {
                lines.push(Line { from: from.as_vec3().to_array(), to: at.as_vec3().to_array(), part });
            }
            last = Some(at);
        }
    }
    let parts = vec![Part::new("tool paths".into(), bounds[0])];
    let (triangles, points) = (Vec::new(), Vec::new());
    let seen = !lines.is_empty() && bounds.iter().all(|b| b.is_finite());
    seen.then_some(Drawing { kind: Kind::Paths, triangles, lines, points, parts, bounds, digest })
}
