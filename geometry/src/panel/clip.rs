//! Cutting convex polyhedra by half-spaces, and the volume that two of them share.

use super::solid::Solid;
use crate::plane::Plane;
use glam::DVec3;

const NONE: u32 = u32::MAX;

impl Solid {
    /// The part of a convex polyhedron that lies behind `plane`; empty if nothing does. Vertices are sorted by side once
    /// and every cut edge gets one vertex, so that the result is closed whatever the rounding. O(corners).
    #[must_use]
    pub fn behind(&self, plane: &Plane) -> Self {
        let distance: Vec<f64> = self.points.iter().map(|&p| plane.distance(p)).collect();
        if distance.iter().all(|&d| d <= 0.0) {
            return self.clone();
        }
        let mut cut =
            Cut { from: self, distance, kept: vec![NONE; self.points.len()], out: Self::default(), edges: Vec::new() };
        let mut cap: Vec<[u32; 2]> = Vec::new();
        let mut loop_ = Vec::new();
        for f in 0..self.face_count() {
            cut.clip_face(self.face(f), &mut loop_, &mut cap);
            if loop_.len() >= 3 {
                cut.out.push_face(loop_.iter().copied(), self.planes[f]);
            }
        }
        // The cap runs along the new edges the other way; chain them into loops.
        cap.sort_unstable();
        while let Some([start, mut at]) = cap.pop() {
            loop_.clear();
            loop_.push(start);
            while at != start {
                loop_.push(at);
                let Ok(i) = cap.binary_search_by_key(&at, |e| e[0]) else { break };
                at = cap.remove(i)[1];
            }
            if loop_.len() >= 3 {
                cut.out.push_face(loop_.iter().copied(), *plane);
            }
        }
        cut.out
    }

    /// The intersection of two convex polyhedra; empty if they do not meet. O(f · (f + g)) for f and g faces.
    #[must_use]
    pub fn intersection(&self, other: &Self) -> Self {
        let mut rest = self.clone();
        for plane in &other.planes {
            if rest.planes.is_empty() {
                break;
            }
            rest = rest.behind(plane);
        }
        rest
    }

    /// Volume that two convex polyhedra share, mm³.
    #[must_use]
    pub fn shared_volume(&self, other: &Self) -> f64 {
        self.intersection(other).volume()
    }
}

/// A cut in progress.
struct Cut<'a> {
    from: &'a Solid,
    /// Signed distance of each old vertex.
    distance: Vec<f64>,
    /// New index of each kept vertex.
    kept: Vec<u32>,
    out: Solid,
    /// (lower old vertex, higher old vertex, new vertex) of each cut edge.
    edges: Vec<(u32, u32, u32)>,
}

impl Cut<'_> {
    /// Clips one loop into `loop_` and adds the reversed new edges to `cap`.
    fn clip_face(&mut self, face: &[u32], loop_: &mut Vec<u32>, cap: &mut Vec<[u32; 2]>) {
        loop_.clear();
        let inside = |v: u32, d: &[f64]| d[v as usize] <= 0.0;
        // Where the loop left the kept side and has not come back yet; where it first came back, if it began outside.
        let (mut left, mut first_back) = (None, None);
        for (i, &v) in face.iter().enumerate() {
            let w = face[(i + 1) % face.len()];
            let (v_in, w_in) = (inside(v, &self.distance), inside(w, &self.distance));
            if v_in {
                loop_.push(self.keep(v));
            }
            if v_in != w_in {
                let crossing = self.crossing(v, w);
                loop_.push(crossing);
                if v_in {
                    left = Some(crossing);
                } else if let Some(l) = left.take() {
                    cap.push([crossing, l]);
                } else {
                    first_back = Some(crossing);
                }
            }
        }
        if let (Some(l), Some(b)) = (left, first_back) {
            cap.push([b, l]);
        }
    }

    fn keep(&mut self, v: u32) -> u32 {
        if self.kept[v as usize] == NONE {
            self.kept[v as usize] = self.push(self.from.points[v as usize]);
        }
        self.kept[v as usize]
    }

    fn crossing(&mut self, v: u32, w: u32) -> u32 {
        let (a, b) = (v.min(w), v.max(w));
        if let Some(e) = self.edges.iter().find(|e| (e.0, e.1) == (a, b)) {
            return e.2;
        }
        let (da, db) = (self.distance[a as usize], self.distance[b as usize]);
        let (pa, pb) = (self.from.points[a as usize], self.from.points[b as usize]);
        let new = self.push(pa + (pb - pa) * (da / (da - db)));
        self.edges.push((a, b, new));
        new
    }

    fn push(&mut self, p: DVec3) -> u32 {
        self.out.points.push(p);
        self.out.points.len() as u32 - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The box [lo, hi].
    fn cuboid(lo: DVec3, hi: DVec3) -> Solid {
        let mut s = Solid::default();
        for i in 0..8 {
            let pick = |bit: i32, l: f64, h: f64| if i & bit == 0 { l } else { h };
            s.points.push(DVec3::new(pick(1, lo.x, hi.x), pick(2, lo.y, hi.y), pick(4, lo.z, hi.z)));
        }
        for (face, n) in [
            ([0, 4, 6, 2], DVec3::NEG_X),
            ([1, 3, 7, 5], DVec3::X),
            ([0, 1, 5, 4], DVec3::NEG_Y),
            ([2, 6, 7, 3], DVec3::Y),
            ([0, 2, 3, 1], DVec3::NEG_Z),
            ([4, 5, 7, 6], DVec3::Z),
        ] {
            let p = s.points[face[0] as usize];
            s.push_face(face, Plane::through(p, n));
        }
        s
    }

    #[test]
    fn a_cube_without_its_corner() {
        let cube = cuboid(DVec3::ZERO, DVec3::ONE);
        assert!((cube.volume() - 1.0).abs() < 1e-15);
        let n = DVec3::ONE.normalize();
        let cut = cube.behind(&Plane::through(DVec3::new(1.0, 1.0, 0.5), n));
        assert!((cut.volume() - (1.0 - 0.125 / 6.0)).abs() < 1e-15);
        assert_eq!(cut.face_count(), 7);
        let tip = cube.behind(&Plane::through(DVec3::new(0.5, 0.0, 0.0), n));
        assert!((tip.volume() - 0.125 / 6.0).abs() < 1e-15);
        assert_eq!(tip.face_count(), 4);
    }

    #[test]
    fn boxes_share_their_overlap() {
        let a = cuboid(DVec3::ZERO, DVec3::new(2.0, 3.0, 4.0));
        let b = cuboid(DVec3::new(1.0, -1.0, 2.5), DVec3::new(5.0, 1.0, 9.0));
        assert!((a.shared_volume(&b) - 1.5).abs() < 1e-14);
        assert!((b.shared_volume(&a) - 1.5).abs() < 1e-14);
        let touching = cuboid(DVec3::new(2.0, 0.0, 0.0), DVec3::new(3.0, 3.0, 4.0));
        assert_eq!(a.shared_volume(&touching), 0.0);
        let far = cuboid(DVec3::splat(10.0), DVec3::splat(11.0));
        assert_eq!(a.intersection(&far).face_count(), 0);
        assert!((a.shared_volume(&a) - 24.0).abs() < 1e-13);
    }
}
