//! Addresses on panels: which of them are seen, and not hidden behind others, is found beside the window.

use super::Camera;
use super::section::Clip;
use crate::model::beside::Beside;
use crate::scene::{Drawing, Part};
use eframe::egui::{Align2, Color32, Context, FontId, Painter, Pos2, Rect, Vec2, vec2};
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;

/// No more labels than this are drawn, and of no more places it is asked whether they are hidden.
const MOST: usize = 3000;
/// Of this size, points, are the fields of the view among which they are shared out where there are more.
const FIELD: [f32; 2] = [48.0, 16.0];
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
        let size = area.size();
        let sides = [size.x, size.y].map(f64::from);
        let bits = numbers.chain(cut).chain(sides).map(|v| u128::from(v.to_bits())).chain(all.iter().map(|d| d.digest));
        // Only that it is another than before matters.
        let key = bits.fold(3_u128, |sum, d| sum.rotate_left(31).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ d);
        let (eye, wake) = (*camera, ctx.clone());
        self.seen.want(key, move || wake.request_repaint(), move || seen(&eye, size, clip, &all));
        let place = camera.projector(area);
        self.drawn.clear();
        let mut free = Free::default();
        for (label, at) in self.seen.last().into_iter().flat_map(|s| s.iter()) {
            let Some(at) = place(*at).filter(|at| area.contains(*at)) else { continue };
            // Most fall out by their middle alone, before their letters are set.
            if free.is_taken(Rect::from_pos(at)) {
                continue;
            }
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

    fn bands_of(rect: Rect) -> std::ops::RangeInclusive<i32> {
        let band = |y: f32| (y / Self::BAND).floor() as i32;
        band(rect.top())..=band(rect.bottom())
    }

    /// Whether some of a room is taken.
    fn is_taken(&self, rect: Rect) -> bool {
        let met = |b: i32| self.bands.get(&b).is_some_and(|all| all.iter().any(|r| r.intersects(rect)));
        Self::bands_of(rect).any(met)
    }

    /// Takes room if all of it is free.
    fn take(&mut self, rect: Rect) -> bool {
        if self.is_taken(rect) {
            return false;
        }
        Self::bands_of(rect).for_each(|b| self.bands.entry(b).or_default().push(rect));
        true
    }
}

/// The nearest first, in a view of a size. O(parts log parts), as far as few lie over one another in the view.
fn seen(camera: &Camera, size: Vec2, clip: Option<Clip>, all: &[Arc<Drawing>]) -> Vec<(String, DVec3)> {
    let there = |p: DVec3| clip.is_none_or(|c| c.side(p) <= 0.0);
    let mut parts: Vec<&Part> = all.iter().flat_map(|d| &d.parts).filter(|p| there(p.centre)).collect();
    let near = |p: &Part| camera.back().dot(p.centre);
    parts.sort_by(|a, b| near(b).total_cmp(&near(a)));
    // Of few all are looked at, also those beside the view, which may soon be in it.
    let view = Rect::from_min_size(Pos2::ZERO, size);
    let place = camera.projector(view);
    let many = parts.len() > MOST;
    if many {
        parts = shared_out(view, &place, parts);
    }
    let bodies = Bodies::new(all, if many { view } else { Rect::EVERYTHING }, &place);
    let bare = |p: &&&Part| {
        let Some(at) = place(p.centre) else { return false };
        let towards = camera.towards(p.centre);
        let from = p.centre + towards * camera.distance * NEAR;
        bodies.over(at).all(|(d, b)| all[d].pick_in([b], from, towards, there).is_none())
    };
    parts.iter().filter(bare).map(|p| (p.label.clone(), p.centre)).collect()
}

/// The field of the view that a place lies in.
fn field(at: Pos2) -> [i32; 2] {
    [0, 1].map(|k| (at[k] / FIELD[k]).floor() as i32)
}

/// Which bodies may be seen in which field, so that few are asked whether they hide a label: a place and all that lies before it
/// are in one. By the numbers of drawings and of their boxes.
struct Bodies {
    fields: HashMap<[i32; 2], Vec<(usize, usize)>>,
    /// Those in many fields, or partly behind the eye.
    large: Vec<(usize, usize)>,
}

impl Bodies {
    /// In more fields than this they are large.
    const MANY: i64 = 64;

    /// Of bodies that are seen within a part of the view. O(parts).
    fn new(all: &[Arc<Drawing>], within: Rect, place: &impl Fn(DVec3) -> Option<Pos2>) -> Self {
        let mut bodies = Self { fields: HashMap::new(), large: Vec::new() };
        for (d, drawing) in all.iter().enumerate() {
            for (b, corners) in drawing.box_corners().enumerate() {
                let mut seen = Rect::NOTHING;
                let before = corners.into_iter().filter_map(place).map(|at| seen.extend_with(at)).count();
                // A little more for rounding.
                let seen = seen.expand(1.0);
                if before == 0 || before == corners.len() && !seen.intersects(within) {
                    continue;
                }
                let [low, high] = [field(seen.min), field(seen.max)];
                let sides = [0, 1].map(|k| i64::from(high[k]) - i64::from(low[k]) + 1);
                if before < corners.len() || sides[0].saturating_mul(sides[1]) > Self::MANY {
                    bodies.large.push((d, b));
                    continue;
                }
                for x in low[0]..=high[0] {
                    for y in low[1]..=high[1] {
                        bodies.fields.entry([x, y]).or_default().push((d, b));
                    }
                }
            }
        }
        bodies
    }

    /// Those that may be seen at a place of the view.
    fn over(&self, at: Pos2) -> impl Iterator<Item = (usize, usize)> {
        self.fields.get(&field(at)).into_iter().flatten().chain(&self.large).copied()
    }
}

/// Of parts in order those that lie in the view, no more than [`MOST`]: the first of every field of it, then the second …
fn shared_out<'a>(view: Rect, place: &impl Fn(DVec3) -> Option<Pos2>, parts: Vec<&'a Part>) -> Vec<&'a Part> {
    let mut fields: HashMap<[i32; 2], usize> = HashMap::new();
    let mut ranked: Vec<(usize, usize)> = Vec::new();
    for (i, part) in parts.iter().enumerate() {
        let Some(at) = place(part.centre).filter(|at| view.contains(*at)) else { continue };
        let rank = fields.entry(field(at)).or_default();
        ranked.push((*rank, i));
        *rank += 1;
    }
    ranked.sort_unstable();
    ranked.truncate(MOST);
    // In the order that they came in.
    ranked.sort_unstable_by_key(|(_, i)| *i);
    ranked.into_iter().map(|(_, i)| parts[i]).collect()
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
            seen(camera, vec2(800.0, 600.0), clip, std::slice::from_ref(&drawing)).into_iter().map(|s| s.0).collect()
        };
        assert_eq!(names(&camera, None), ["1"]);
        assert_eq!(names(&camera, Some(Clip::square_to(2, 200.0))), ["0"], "what hid it is cut away");
        camera.stand(Standard::Bottom);
        assert_eq!(names(&camera, None), ["0"]);
        camera.stand(Standard::Front);
        assert_eq!(names(&camera, None).len(), 2);
    }

    #[test]
    fn of_more_parts_than_are_drawn_those_in_view_are_looked_at() {
        // A sheet of 70 × 70 squares.
        let count = 70_u32;
        let corner = |i: u32| DVec3::new(f64::from(i % (count + 1)), f64::from(i / (count + 1)), 0.0) * 100.0;
        let face = |i: u32| {
            let first = i / count * (count + 1) + i % count;
            [first, first + 1, first + count + 2, first + count + 1]
        };
        let points = (0..(count + 1).pow(2)).map(corner).collect();
        let mesh = Mesh::from_faces(points, &(0..count.pow(2)).map(face).collect::<Vec<_>>());
        let drawing = Arc::new(crate::scene::draw(&Tree::item(V::new(mesh))).unwrap());
        let view = vec2(800.0, 600.0);
        let names = |camera: &Camera| -> Vec<String> {
            seen(camera, view, None, std::slice::from_ref(&drawing)).into_iter().map(|s| s.0).collect()
        };
        let mut camera = Camera::default();
        camera.stand(Standard::Top);
        // The last ones, from near.
        (camera.target, camera.distance) = (DVec3::new(6900.0, 6900.0, 0.0), 1000.0);
        let near = names(&camera);
        for wanted in ["4899", "4898", "4829", "4828"] {
            assert!(near.iter().any(|n| n == wanted), "{wanted} is none of {near:?}");
        }
        assert!(near.len() < 200, "what is out of view is not looked at");
        // All of them, from afar: every part of the sheet has some.
        camera.fit(Rect::from_min_size(Pos2::ZERO, view), drawing.bounds);
        let all: Vec<u32> = names(&camera).iter().map(|n| n.parse().unwrap()).collect();
        assert!(all.len() <= MOST);
        for quarter in 0..4 {
            let own = all.iter().filter(|n| (*n / count / 35) * 2 + *n % count / 35 == quarter).count();
            assert!(own > 300, "{own} of quarter {quarter}");
        }
    }
}
