//! A plane that cuts the view open: what lies in front of it is not drawn, and where it meets faces their outline is.

use crate::scene::{Drawing, Kind, Line, Part};
use glam::DVec3;
use std::sync::Arc;

/// A plane square to an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clip {
    /// 0, 1, 2 for X, Y, Z.
    pub axis: usize,
    /// Where it stands on that axis, mm.
    pub at: f64,
    /// What lies below it is cut away, not what lies above.
    pub below: bool,
}

impl Clip {
    /// Square to the plane, towards what is cut away.
    #[must_use]
    pub fn normal(self) -> DVec3 {
        let n = [DVec3::X, DVec3::Y, DVec3::Z][self.axis.min(2)];
        if self.below { -n } else { n }
    }

    /// How far a place lies on the side that is cut away, mm; negative where it is seen.
    #[must_use]
    pub fn side(self, p: DVec3) -> f64 {
        let away = p[self.axis.min(2)] - self.at;
        if self.below { -away } else { away }
    }

    /// Normal and distance as the graphics card wants them.
    #[must_use]
    pub fn plane(self) -> [f32; 4] {
        let n = self.normal();
        let d = if self.below { self.at } else { -self.at };
        [n.x as f32, n.y as f32, n.z as f32, d as f32]
    }
}

/// The outline of a section, kept while nothing changes.
#[derive(Default)]
pub struct Section {
    made_for: Option<(Clip, Vec<u128>)>,
    drawing: Option<Arc<Drawing>>,
}

impl Section {
    /// The lines in which a plane meets the faces of drawings; none if it meets none. O(triangles) after a change.
    pub fn of<'a>(&mut self, clip: Clip, all: impl Iterator<Item = &'a Arc<Drawing>>) -> Option<Arc<Drawing>> {
        let all: Vec<&Arc<Drawing>> = all.filter(|d| !d.triangles.is_empty()).collect();
        let now = (clip, all.iter().map(|d| d.digest).collect::<Vec<_>>());
        if self.made_for.as_ref() != Some(&now) {
            self.drawing = cut(clip, &all).map(Arc::new);
            self.made_for = Some(now);
        }
        self.drawing.clone()
    }
}

fn cut(clip: Clip, all: &[&Arc<Drawing>]) -> Option<Drawing> {
    let mut lines = Vec::new();
    for t in all.iter().flat_map(|d| d.triangles.chunks_exact(3)) {
        let p = [t[0], t[1], t[2]].map(|v| DVec3::from(v.position.map(f64::from)));
        let s = p.map(|p| clip.side(p));
        let mut ends = Vec::with_capacity(2);
        for (a, b) in [(0, 1), (1, 2), (2, 0)] {
            if (s[a] > 0.0) != (s[b] > 0.0) {
                ends.push(p[a].lerp(p[b], s[a] / (s[a] - s[b])));
            }
        }
        if let [from, to] = ends[..] {
            let (from, to) = (from.as_vec3().to_array(), to.as_vec3().to_array());
            lines.push(Line { from, to, part: 0 });
        }
    }
    // Only that it is another than before matters.
    let digest = (clip.at.to_bits() as u128) << 8 | (clip.axis as u128) << 1 | u128::from(clip.below);
    let digest = all.iter().fold(digest, |sum, d| sum.rotate_left(17) ^ d.digest);
    let ends = lines.iter().flat_map(|l| [l.from, l.to]).map(|p| DVec3::from(p.map(f64::from)));
    let bounds = ends.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[a, b], p| [a.min(p), b.max(p)]);
    let parts = vec![Part::new("section".into(), bounds[0])];
    let none = Vec::new();
    let shown = !lines.is_empty();
    shown.then_some(Drawing { kind: Kind::Curve, triangles: Vec::new(), lines, points: none, parts, bounds, digest })
}

#[cfg(test)]
mod tests {
    use super::*;
    use tenon_engine::Tree;
    use tenon_geometry::mesh::Mesh;
    use tenon_nodes::value::V;

    #[test]
    fn a_plane_meets_a_square_in_one_line() {
        let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 2.0], [0.0, 2.0]].map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        let mesh =
            Arc::new(crate::scene::draw(&Tree::item(V::new(Mesh::from_faces(points, &[[0, 1, 2, 3]])))).unwrap());
        let clip = Clip { axis: 0, at: 1.0, below: false };
        assert!(clip.side(DVec3::new(3.0, 0.0, 0.0)) > 0.0 && clip.side(DVec3::ZERO) < 0.0);
        let mut section = Section::default();
        let d = section.of(clip, [&mesh].into_iter()).unwrap();
        let length: f32 = d.lines.iter().map(|l| (l.to[1] - l.from[1]).abs()).sum();
        assert!((length - 2.0).abs() < 1e-6 && d.lines.iter().all(|l| l.from[0] == 1.0));
        assert!(section.of(Clip { at: 9.0, ..clip }, [&mesh].into_iter()).is_none());
    }
}
