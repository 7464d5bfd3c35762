//! Addresses on panels: which of them are seen, and not hidden behind others, is found beside the window.

use super::Camera;
use super::section::Clip;
use crate::model::beside::Beside;
use crate::scene::Drawing;
use eframe::egui::{Align2, Color32, Context, FontId, Painter, Rect, vec2};
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;

/// No more labels than this are drawn.
const MOST: usize = 3000;
/// A body so near before its label, as a share of the distance of the eye, does not hide it.
const NEAR: f64 = 2e-3;

/// Labels are dark in a light halo, so that they are read on wood, and on a dark ground as on a light one.
const INK: Color32 = Color32::from_rgb(24, 22, 20);
const HALO: Color32 = Color32::from_rgb(252, 248, 240);
/// Room that is left free around a label, points.
const ROOM: f32 = 1.0;

/// The labels that are seen, with their places, and where those are drawn that do not lie over nearer ones.
#[derive(Default)]
pub struct Labels {
    seen: Beside<Vec<(String, DVec3)>>,
    drawn: Vec<(String, Rect)>,
}

impl Labels {
    /// Paints the labels of drawings; those that were seen a moment ago while the eye moves.
    pub fn paint(
        &mut self,
        ctx: &Context,
        painter: &Painter,
        (area, camera): (Rect, &Camera),
        clip: Option<Clip>,
        all: Vec<Arc<Drawing>>,
    ) {
        let numbers = camera.matrix(1.0).to_cols_array().into_iter();
        let cut = clip.map_or([0.0; 4], |c| [c.normal.x, c.normal.y, c.normal.z, c.at]);
        let bits = numbers.chain(cut).map(|v| u128::from(v.to_bits())).chain(all.iter().map(|d| d.digest));
        // Only that it is another than before matters.
        let key = bits.fold(3_u128, |sum, d| sum.rotate_left(31).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ d);
        let (eye, wake) = (*camera, ctx.clone());
        self.seen.want(key, move || wake.request_repaint(), move || seen(&eye, clip, &all));
        let place = camera.projector(area);
        self.drawn.clear();
        let mut free = Free::default();
        for (label, at) in self.seen.last().into_iter().flat_map(|s| s.iter()) {
            let Some(at) = place(*at).filter(|at| area.contains(*at)) else { continue };
            let galley = painter.layout_no_wrap(label.clone(), FontId::proportional(crate::theme::SMALL), INK);
            let rect = Align2::CENTER_CENTER.anchor_size(at, galley.size()).expand(ROOM);
            if !free.take(rect) {
                continue;
            }
            for by in [vec2(1.0, 0.0), vec2(-1.0, 0.0), vec2(0.0, 1.0), vec2(0.0, -1.0)] {
                painter.galley_with_override_text_color(rect.min + vec2(ROOM, ROOM) + by, galley.clone(), HALO);
            }
            painter.galley(rect.min + vec2(ROOM, ROOM), galley, INK);
            self.drawn.push((label.clone(), rect));
        }
    }

    /// The labels that are drawn, and where.
    pub fn drawn(&self) -> &[(String, Rect)] {
        &self.drawn
    }

    /// Whether nothing is being looked for.
    pub fn settled(&self) -> bool {
        self.seen.settled()
    }
}

/// Room on screen that is taken, in bands, so that few labels are asked for each.
#[derive(Default)]
struct Free {
    bands: HashMap<i32, Vec<Rect>>,
}

impl Free {
    /// Height of a band, points.
    const BAND: f32 = 16.0;

    /// Takes room if all of it is free.
    fn take(&mut self, rect: Rect) -> bool {
        let band = |y: f32| (y / Self::BAND).floor() as i32;
        let bands = band(rect.top())..=band(rect.bottom());
        let met = |b: i32| self.bands.get(&b).is_some_and(|all| all.iter().any(|r| r.intersects(rect)));
        if bands.clone().any(met) {
            return false;
        }
        bands.for_each(|b| self.bands.entry(b).or_default().push(rect));
        true
    }
}

/// The nearest first. O(labels × parts).
fn seen(camera: &Camera, clip: Option<Clip>, all: &[Arc<Drawing>]) -> Vec<(String, DVec3)> {
    let there = |p: DVec3| clip.is_none_or(|c| c.side(p) <= 0.0);
    let parts = all.iter().flat_map(|d| &d.parts).take(MOST).filter(|p| there(p.centre));
    let bare = |p: &&crate::scene::Part| {
        let towards = camera.towards(p.centre);
        let from = p.centre + towards * camera.distance * NEAR;
        all.iter().all(|d| d.pick(from, towards, there).is_none())
    };
    let mut seen: Vec<(String, DVec3)> = parts.filter(bare).map(|p| (p.label.clone(), p.centre)).collect();
    let near = |p: &DVec3| camera.back().dot(*p);
    seen.sort_by(|a, b| near(&b.1).total_cmp(&near(&a.1)));
    seen
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::viewport::Standard;
    use tenon_engine::Tree;
    use tenon_geometry::mesh::Mesh;
    use tenon_nodes::value::V;

    #[test]
    fn labels_behind_a_body_or_cut_away_are_not_seen() {
        let square = |z: f64| [[0.0, 0.0, z], [100.0, 0.0, z], [100.0, 100.0, z], [0.0, 100.0, z]];
        let points = [square(0.0), square(500.0)].concat().into_iter().map(DVec3::from_array).collect();
        let mesh = Mesh::from_faces(points, &[[0, 1, 2, 3], [4, 5, 6, 7]]);
        let drawing = Arc::new(crate::scene::draw(&Tree::item(V::new(mesh))).unwrap());
        let mut camera = Camera { orthographic: true, ..Camera::default() };
        camera.stand(Standard::Top);
        let names = |camera: &Camera, clip| -> Vec<String> {
            seen(camera, clip, std::slice::from_ref(&drawing)).into_iter().map(|s| s.0).collect()
        };
        assert_eq!(names(&camera, None), ["1"]);
        assert_eq!(names(&camera, Some(Clip::square_to(2, 200.0))), ["0"], "what hid it is cut away");
        camera.stand(Standard::Bottom);
        assert_eq!(names(&camera, None), ["0"]);
        camera.stand(Standard::Front);
        assert_eq!(names(&camera, None).len(), 2);
    }
}
