//! A plane that cuts the view open: what lies in front of it is not drawn, and where it meets bodies they are filled.

use crate::model::beside::Beside;
use crate::scene::{Drawing, Kind, Line, Part, Vertex};
use eframe::egui::Context;
use glam::DVec3;
use std::sync::Arc;

/// A plane of any direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clip {
    /// Unit normal, towards what is cut away.
    pub normal: DVec3,
    /// How far the plane lies from the origin along it, mm.
    pub at: f64,
}

impl Clip {
    /// A plane square to an axis (0, 1, 2 for X, Y, Z); what lies beyond it is cut away.
    #[must_use]
    pub fn square_to(axis: usize, at: f64) -> Self {
        Self { normal: DVec3::AXES[axis.min(2)], at }
    }

    /// A plane through a place.
    #[must_use]
    pub fn through(place: DVec3, normal: DVec3) -> Self {
        let normal = normal.normalize_or(DVec3::X);
        Self { normal, at: place.dot(normal) }
    }

    /// The same plane with the other side cut away.
    #[must_use]
    pub fn flipped(self) -> Self {
        Self { normal: -self.normal, at: -self.at }
    }

    /// How far a place lies on the side that is cut away, mm; negative where it is seen.
    #[must_use]
    pub fn side(self, p: DVec3) -> f64 {
        p.dot(self.normal) - self.at
    }

    /// Normal and distance as the graphics card wants them.
    #[must_use]
    pub fn plane(self) -> [f32; 4] {
        let n = self.normal;
        [n.x as f32, n.y as f32, n.z as f32, -self.at as f32]
    }

    /// From where to where the plane can be moved to meet a box, mm.
    #[must_use]
    pub fn reach(self, [low, high]: [DVec3; 2]) -> [f64; 2] {
        let (middle, half) = ((low + high) / 2.0, (high - low) / 2.0);
        let (at, by) = (middle.dot(self.normal), half.dot(self.normal.abs()));
        [at - by, at + by]
    }

    /// Turn about Z and height over the ground of the normal, degrees.
    #[must_use]
    pub fn angles(self) -> [f64; 2] {
        let n = self.normal;
        [n.y.atan2(n.x).to_degrees(), n.z.clamp(-1.0, 1.0).asin().to_degrees()]
    }

    /// The plane through the same place with a normal of those angles.
    #[must_use]
    pub fn turned(self, [turn, tilt]: [f64; 2], place: DVec3) -> Self {
        let ((st, ct), (sh, ch)) = (turn.to_radians().sin_cos(), tilt.to_radians().sin_cos());
        Self::through(place, DVec3::new(ct * ch, st * ch, sh))
    }
}

/// A section, made beside the window while nothing changes.
#[derive(Default)]
pub struct Section {
    made: Beside<Option<Arc<Drawing>>>,
}

impl Section {
    /// Where a plane cuts drawings: outlines, and bodies filled; none if it meets none.
    pub fn of<'a>(
        &mut self,
        ctx: &Context,
        clip: Clip,
        all: impl Iterator<Item = &'a Arc<Drawing>>,
    ) -> Option<Arc<Drawing>> {
        let all: Vec<Arc<Drawing>> = all.filter(|d| !d.triangles.is_empty()).cloned().collect();
        let bits = clip.normal.to_array().into_iter().chain([clip.at]).map(|v| u128::from(v.to_bits()));
        let digests = all.iter().map(|d| d.digest);
        // Only that it is another than before matters.
        let key =
            bits.chain(digests).fold(7_u128, |sum, d| sum.rotate_left(29).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ d);
        let ctx = ctx.clone();
        let make = move || cut(clip, &all).map(|d| Arc::new(Drawing { digest: key, ..d }));
        self.made.want(key, move || ctx.request_repaint(), make);
        self.made.last()?.as_ref().clone()
    }

    /// Where a ray meets what is filled, as far as that is cut by this very plane. O(triangles of the section).
    pub fn hit(&self, clip: Clip, origin: DVec3, direction: DVec3) -> Option<DVec3> {
        let section = self.made.now()?.as_ref().as_ref()?;
        hit(section, clip, origin, direction)
    }

    /// The corners of outlines.
    pub fn corners(&self) -> impl Iterator<Item = DVec3> {
        let lines = self.made.now().and_then(|m| m.as_ref().as_ref()).into_iter().flat_map(|d| &d.lines);
        lines.flat_map(|l| [l.from, l.to]).map(|p| DVec3::from(p.map(f64::from)))
    }

    /// Whether nothing is being cut.
    pub fn settled(&self) -> bool {
        self.made.settled()
    }
}

/// O(triangles).
fn cut(clip: Clip, all: &[Arc<Drawing>]) -> Option<Drawing> {
    let mut section = Drawing::empty(Kind::Mesh);
    for d in all {
        for own in d.triangles.chunk_by(|a, b| a.part == b.part) {
            let first = section.lines.len();
            own.chunks_exact(3).for_each(|t| section.lines.extend(met(clip, t)));
            if d.kind == Kind::Panels {
                let filled = fill(&section.lines[first..]);
                section.triangles.extend(filled);
            }
        }
    }
    let ends = section.lines.iter().flat_map(|l| [l.from, l.to]).map(|p| DVec3::from(p.map(f64::from)));
    section.bounds = ends.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[a, b], p| [a.min(p), b.max(p)]);
    section.parts = vec![Part::new("section".into(), section.bounds[0])];
    (!section.lines.is_empty()).then_some(section)
}

/// Where a ray meets the plane in a triangle of a section.
fn hit(section: &Drawing, clip: Clip, origin: DVec3, direction: DVec3) -> Option<DVec3> {
    let along = -clip.side(origin) / direction.dot(clip.normal);
    let at = origin + direction * along;
    let inside = |t: &[Vertex]| {
        let corners = [0, 1, 2].map(|k| DVec3::from(t[k].position.map(f64::from)));
        let side = |k: usize| (corners[(k + 1) % 3] - corners[k]).cross(at - corners[k]).dot(clip.normal);
        let sides = [side(0), side(1), side(2)];
        sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
    };
    (along.is_finite() && along > 0.0 && section.triangles.chunks_exact(3).any(inside)).then_some(at)
}

/// The line in which a triangle meets the plane.
fn met(clip: Clip, triangle: &[Vertex]) -> Option<Line> {
    let [a, b, c] = triangle else { return None };
    let p = [a, b, c].map(|v| DVec3::from(v.position.map(f64::from)));
    let s = p.map(|p| clip.side(p));
    let crossing = |(a, b): (usize, usize)| {
        ((s[a] > 0.0) != (s[b] > 0.0)).then(|| p[a].lerp(p[b], s[a] / (s[a] - s[b])).as_vec3().to_array())
    };
    let mut ends = [(0, 1), (1, 2), (2, 0)].into_iter().filter_map(crossing);
    Some(Line { from: ends.next()?, to: ends.next()?, part: 0 })
}

/// What a plane cuts of a convex body with that outline, as a fan about its middle.
fn fill(outline: &[Line]) -> Vec<Vertex> {
    let place = |p: [f32; 3]| DVec3::from(p.map(f64::from));
    let count = 2.0 * outline.len().max(1) as f64;
    let middle = outline.iter().map(|l| place(l.from) + place(l.to)).sum::<DVec3>() / count;
    // Lit alike whatever the plane's direction.
    let normal = [0, 0, 127, 0];
    let vertex = |position| Vertex { position, normal, part: 0 };
    outline.iter().flat_map(|l| [middle.as_vec3().to_array(), l.from, l.to].map(vertex)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use tenon_engine::Tree;
    use tenon_geometry::mesh::Mesh;
    use tenon_nodes::value::V;

    fn drawn(points: &[[f64; 3]], faces: &[[u32; 4]]) -> Drawing {
        let points = points.iter().map(|p| DVec3::from_array(*p)).collect();
        crate::scene::draw(&Tree::item(V::new(Mesh::from_faces(points, faces)))).unwrap()
    }

    #[test]
    fn a_plane_meets_a_square_in_one_line() {
        let corners = [[0.0, 0.0, 0.0], [4.0, 0.0, 0.0], [4.0, 2.0, 0.0], [0.0, 2.0, 0.0]];
        let mesh = Arc::new(drawn(&corners, &[[0, 1, 2, 3]]));
        let clip = Clip::square_to(0, 1.0);
        assert!(clip.side(DVec3::new(3.0, 0.0, 0.0)) > 0.0 && clip.side(DVec3::ZERO) < 0.0);
        assert!(clip.flipped().side(DVec3::new(3.0, 0.0, 0.0)) < 0.0);
        let d = cut(clip, std::slice::from_ref(&mesh)).unwrap();
        let length: f32 = d.lines.iter().map(|l| (l.to[1] - l.from[1]).abs()).sum();
        assert!((length - 2.0).abs() < 1e-6 && d.lines.iter().all(|l| l.from[0] == 1.0));
        assert!(cut(Clip { at: 9.0, ..clip }, &[mesh]).is_none());
    }

    #[test]
    fn a_body_is_filled_where_a_leaning_plane_cuts_it() {
        let corners: Vec<[f64; 3]> = (0..8).map(|i| [i & 1, i >> 1 & 1, i >> 2].map(|c| f64::from(c) * 2.0)).collect();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let mut cube = drawn(&corners, &faces);
        // One body, as a panel is.
        cube.kind = Kind::Panels;
        cube.triangles.iter_mut().for_each(|v| v.part = 0);
        let clip = Clip::through(DVec3::ONE, DVec3::new(1.0, 0.0, 1.0));
        let d = cut(clip, &[Arc::new(cube)]).unwrap();
        let place = |v: &Vertex| DVec3::from(v.position.map(f64::from));
        let area: f64 = d
            .triangles
            .chunks_exact(3)
            .map(|t| {
                let [a, b, c] = [place(&t[0]), place(&t[1]), place(&t[2])];
                0.5 * (b - a).cross(c - a).length()
            })
            .sum();
        assert!((area - 2.0 * 8f64.sqrt()).abs() < 1e-5, "{area}");
        // Rays meet what is filled, and nothing beside it.
        let down = |x: f64, y: f64| hit(&d, clip, DVec3::new(x, y, 9.0), -DVec3::Z);
        assert!(down(0.7, 1.4).unwrap().distance(DVec3::new(0.7, 1.4, 1.3)) < 1e-9);
        assert_eq!((down(0.7, 2.1), hit(&d, clip, DVec3::splat(9.0), DVec3::Z)), (None, None));
        let turned = clip.turned([90.0, 0.0], DVec3::ONE);
        assert!(turned.normal.distance(DVec3::Y) < 1e-12 && (turned.at - 1.0).abs() < 1e-12);
        assert!((clip.angles()[1] - 45.0).abs() < 1e-9);
        assert_eq!(Clip::square_to(2, 0.0).reach([DVec3::ZERO, DVec3::new(1.0, 2.0, 3.0)]), [0.0, 3.0]);
    }
}
