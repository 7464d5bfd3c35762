//! Tool paths in space: the moves of every part where its panel is, coloured by what they do.

use crate::boards::kind_colour;
use crate::model::Model;
use crate::model::beside::Beside;
use crate::model::cut;
use crate::model::play::Kind as Does;
use crate::scene::{Drawing, Kind, Line, Part};
use eframe::egui::Context;
use glam::DVec3;
use std::sync::Arc;
use tenon_geometry::board::PartSet;
use tenon_geometry::motion::{MoveKind, PartPaths};

/// What moves do, in the order of the colours.
const KINDS: [Does; 4] = [Does::Rapid, Does::Plunge, Does::Cut, Does::Retract];

/// What is drawn of tool paths.
pub struct Ways {
    /// Moves at feed.
    pub feed: Arc<Drawing>,
    /// Rapid moves and approaches.
    pub rapid: Arc<Drawing>,
    /// Colours of what moves do.
    pub colours: Arc<Vec<u32>>,
}

/// Tool paths of all parts, made beside the window and kept while they stay the same.
#[derive(Default)]
pub struct Paths {
    made: Beside<Option<[Arc<Drawing>; 2]>>,
    colours: Arc<Vec<u32>>,
}

impl Paths {
    /// What is drawn; none if no node gives tool paths, or they are still being drawn.
    pub fn of(&mut self, ctx: &Context, model: &Model) -> Option<Ways> {
        let (paths, parts, digest) = cut::paths(model)?;
        if self.colours.is_empty() {
            let bytes = |k| {
                let c: eframe::egui::Color32 = kind_colour(k);
                u32::from_le_bytes([c.r(), c.g(), c.b(), 255])
            };
            self.colours = Arc::new(KINDS.into_iter().map(bytes).chain([0]).collect());
        }
        let ctx = ctx.clone();
        self.made.want(digest, move || ctx.request_repaint(), move || draw(&paths, &parts, digest));
        let [feed, rapid] = self.made.last()?.as_ref().clone()?;
        Some(Ways { feed, rapid, colours: self.colours.clone() })
    }

    /// Whether nothing is being drawn.
    pub fn settled(&self) -> bool {
        self.made.settled()
    }
}

/// O(moves).
fn draw(paths: &PartPaths, parts: &PartSet, digest: u128) -> Option<[Arc<Drawing>; 2]> {
    let p = &paths.paths;
    let (mut feed, mut rapid) = (Vec::new(), Vec::new());
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
                let lines = if part == 0 { &mut rapid } else { &mut feed };
                lines.push(Line { from: from.as_vec3().to_array(), to: at.as_vec3().to_array(), part });
            }
            last = Some(at);
        }
    }
    let parts = vec![Part::new("tool paths".into(), bounds[0])];
    let seen = !feed.is_empty() && bounds.iter().all(|b| b.is_finite());
    let drawing = |lines, digest| {
        Arc::new(Drawing { lines, parts: parts.clone(), bounds, digest, ..Drawing::empty(Kind::Paths) })
    };
    seen.then(|| [drawing(feed, digest), drawing(rapid, !digest)])
}
