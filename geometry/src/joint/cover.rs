//! How much wood remains around a hole in a convex panel, and between two holes.

use crate::panel::PanelSet;
use crate::plane::Plane;
use glam::DVec3;

/// A straight round hole: a cylinder from `entry` along the unit vector `axis`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hole {
    pub entry: DVec3,
    pub axis: DVec3,
    pub radius: f64,
    /// Height of the drill's point, mm.
    pub point: f64,
}

/// The planes of all panels in compressed rows: front, back, chamfers, node facets.
pub(super) struct PanelPlanes {
    start: Vec<u32>,
    planes: Vec<Plane>,
}

impl PanelPlanes {
    pub fn new(set: &PanelSet) -> Self {
        let mut all = Self { start: vec![0], planes: Vec::new() };
        for i in 0..set.len() {
            if let (Some(front), Some(back)) = (set.front_plane(i), set.back_plane(i)) {
                all.planes.extend([front, back]);
                all.planes.extend_from_slice(&set.chamfer[set.corners(i)]);
                all.planes.extend((0..set.corners(i).len()).filter_map(|k| set.facet(i, k)).map(|(_, plane)| plane));
            }
            all.start.push(all.planes.len() as u32);
        }
        all
    }

    /// The planes of panel `i` other than `entered` (and node facets that lie in it).
    pub fn others(&self, i: u32, entered: Plane) -> impl Iterator<Item = &Plane> + Clone {
        let planes = &self.planes[self.start[i as usize] as usize..self.start[i as usize + 1] as usize];
        planes.iter().filter(move |&&p| p != entered)
    }
}

impl Hole {
    /// Least wood between the mouth of the hole at `at` in the plane `surface` and the `others`, mm: the mouth is the
    /// ellipse in which the cylinder meets the surface. To a face behind an obtuse edge the way leads along the surface
    /// (a node facet may be nearly level with its chamfer), to others straight through the wood.
    pub fn beside_mouth<'a>(&self, at: DVec3, surface: Plane, others: impl Iterator<Item = &'a Plane>) -> f64 {
        let wood = |p: &Plane| {
            let level = p.normal.dot(surface.normal).clamp(0.0, 1.0);
            (-p.distance(at) - self.mouth_reach(p.normal, surface.normal)) / (1.0 - level * level).sqrt()
        };
        others.map(wood).fold(f64::INFINITY, f64::min)
    }

    /// How far the mouth in a plane of normal `surface` reaches from its centre in the direction `towards`, mm.
    pub fn mouth_reach(&self, towards: DVec3, surface: DVec3) -> f64 {
        self.radius * (towards - surface * (self.axis.dot(towards) / self.axis.dot(surface))).length()
    }

    /// The greatest depth that leaves `cover` of wood between the end of the hole and the `others`, mm.
    pub fn deepest<'a>(&self, cover: f64, others: impl Iterator<Item = &'a Plane>) -> f64 {
        let depth = |p: &Plane| {
            let towards = self.axis.dot(p.normal);
            if towards <= 0.0 {
                return f64::INFINITY;
            }
            let room = -cover - p.distance(self.entry);
            let rim = self.radius * (1.0 - towards * towards).max(0.0).sqrt();
            (room / towards).min((room - rim) / towards + self.point)
        };
        others.map(depth).fold(f64::INFINITY, f64::min)
    }
}

/// Distance between the segments a0 a1 and b0 b1, mm (Ericson 2005, §5.1.9).
pub(super) fn segment_distance([a0, a1]: [DVec3; 2], [b0, b1]: [DVec3; 2]) -> f64 {
    let (u, v, w) = (a1 - a0, b1 - b0, a0 - b0);
    let (uu, uv, vv, uw, vw) = (u.dot(u), u.dot(v), v.dot(v), u.dot(w), v.dot(w));
    let clamp = |x: f64| if x.is_finite() { x.clamp(0.0, 1.0) } else { 0.0 };
    let s = clamp((uv * vw - vv * uw) / (uu * vv - uv * uv));
    let t = clamp((uv * s + vw) / vv);
    let s = clamp((uv * t - uw) / uu);
    (w + u * s - v * t).length()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_between_segments() {
        let p = DVec3::new;
        let a = [p(0.0, 0.0, 0.0), p(10.0, 0.0, 0.0)];
        for (b, d) in [
            ([p(5.0, -3.0, 4.0), p(5.0, 3.0, 4.0)], 4.0),
            ([p(13.0, 4.0, 0.0), p(20.0, 4.0, 0.0)], 5.0),
            ([p(2.0, 7.0, 0.0), p(8.0, 7.0, 0.0)], 7.0),
            ([p(-3.0, 4.0, 0.0), p(-3.0, 9.0, 0.0)], 5.0),
        ] {
            assert!((segment_distance(a, b) - d).abs() < 1e-12);
            assert!((segment_distance(b, a) - d).abs() < 1e-12);
        }
    }

    #[test]
    fn an_oblique_hole_in_a_board() {
        // Down at 45° from a chamfer x = 0 into a board 10 mm thick, radius 1.5, entry in mid-height.
        let axis = DVec3::new(1.0, 0.0, -1.0).normalize();
        let hole = Hole { entry: DVec3::ZERO, axis, radius: 1.5, point: 0.0 };
        // A face nearly level with the chamfer, its edge 20 mm away, is as far as its edge.
        let level = Plane::through(DVec3::Y * 20.0, DVec3::new(-1.0, 1e-3, 0.0).normalize());
        let square = Hole { axis: DVec3::X, ..hole };
        let beside = square.beside_mouth(DVec3::ZERO, Plane::through(DVec3::ZERO, DVec3::NEG_X), [level].iter());
        assert!((beside - 18.5).abs() < 1e-9, "{beside}");
        let chamfer = Plane::through(DVec3::ZERO, DVec3::NEG_X);
        let planes = [Plane { normal: DVec3::Z, offset: 5.0 }, Plane { normal: DVec3::NEG_Z, offset: 5.0 }];
        let beside = hole.beside_mouth(hole.entry, chamfer, planes.iter());
        assert!((beside - (5.0 - 1.5 * 2f64.sqrt())).abs() < 1e-12);
        let deepest = hole.deepest(1.0, planes.iter());
        let half = std::f64::consts::FRAC_1_SQRT_2;
        assert!((deepest * half - (4.0 - 1.5 * half)).abs() < 1e-12);
        // A pointed drill goes deeper, until its point is the nearest.
        let pointed = Hole { point: 0.9, ..hole }.deepest(1.0, planes.iter());
        assert!((pointed - deepest - 0.9).abs() < 1e-12);
        let sharp = Hole { point: 9.0, ..hole }.deepest(1.0, planes.iter());
        assert!((sharp * half - 4.0).abs() < 1e-12);
    }
}
