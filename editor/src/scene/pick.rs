//! What is under the pointer: parts that a ray meets, curves and points that are seen near a place of the picture.

use super::{Drawing, Kind, PartBox};
use tenon_geometry::{DVec2, DVec3};

impl Drawing {
    /// The part that a ray meets first where `seen` holds, and how far away, in lengths of `direction`. O(parts + triangles of
    /// parts whose boxes it meets).
    #[must_use]
    pub fn pick(&self, origin: DVec3, direction: DVec3, seen: impl Fn(DVec3) -> bool) -> Option<(u32, f64)> {
        self.pick_in(0..self.boxes.len(), origin, direction, seen)
    }

    /// The same among the triangles of some boxes.
    pub(crate) fn pick_in(
        &self,
        boxes: impl IntoIterator<Item = usize>,
        origin: DVec3,
        direction: DVec3,
        seen: impl Fn(DVec3) -> bool,
    ) -> Option<(u32, f64)> {
        let mut best: Option<(u32, f64)> = None;
        let boxes = boxes.into_iter().filter_map(|i| self.boxes.get(i));
        for own in boxes.filter(|b| b.meets(origin, direction)) {
            for t in self.triangles[own.corners.clone()].chunks_exact(3) {
                let [a, b, c] = [t[0], t[1], t[2]].map(|v| DVec3::from(v.position.map(f64::from)));
                if let Some(at) = meet(origin, direction, a, b, c)
                    && best.is_none_or(|(_, best)| at < best)
                    && seen(origin + direction * at)
                {
                    best = Some((t[0].part, at));
                }
            }
        }
        best
    }

    /// The corners of all boxes, by their numbers for [`Drawing::pick_in`].
    pub(crate) fn box_corners(&self) -> impl Iterator<Item = [DVec3; 8]> {
        self.boxes.iter().map(|b| {
            let ends = [b.low.as_dvec3(), b.high.as_dvec3()];
            std::array::from_fn(|i| DVec3::new(ends[i & 1].x, ends[i >> 1 & 1].y, ends[i >> 2].z))
        })
    }

    /// The curve or point that is seen nearest to a place of the picture, no farther than `near`, and where that is in space.
    /// `picture` says where a place in space is seen; none where it is not. O(lines + points).
    #[must_use]
    pub fn pick_thin(
        &self,
        at: DVec2,
        near: f64,
        picture: impl Fn(DVec3) -> Option<DVec2>,
    ) -> Option<(u32, DVec3, f64)> {
        let mut best: Option<(u32, DVec3, f64)> = None;
        let mut take = |part, place, away: f64| {
            if away <= near && best.is_none_or(|b| away < b.2) {
                best = Some((part, place, away));
            }
        };
        let space = |p: [f32; 3]| DVec3::from(p.map(f64::from));
        if self.kind == Kind::Curve {
            for line in &self.lines {
                let (from, to) = (space(line.from), space(line.to));
                let (Some(a), Some(b)) = (picture(from), picture(to)) else { continue };
                let t = ((at - a).dot(b - a) / (b - a).length_squared().max(1e-12)).clamp(0.0, 1.0);
                take(line.part, from.lerp(to, t), a.lerp(b, t).distance(at));
            }
        }
        for (i, point) in self.points.iter().enumerate() {
            if let Some(p) = picture(space(*point)) {
                take(i as u32, space(*point), p.distance(at));
            }
        }
        best
    }
}

impl PartBox {
    /// Whether a ray goes through the box, a little widened for its rounding (Kay, Kajiya 1986).
    fn meets(&self, origin: DVec3, direction: DVec3) -> bool {
        let (low, high) = (self.low.as_dvec3() - DVec3::splat(1e-3), self.high.as_dvec3() + DVec3::splat(1e-3));
        let (a, b) = ((low - origin) / direction, (high - origin) / direction);
        // Along an axis that the ray does not move on, 0/0 may come up: such a bound does not count.
        let bound = |from: f64, to: f64| {
            if from.is_nan() || to.is_nan() { [f64::NEG_INFINITY, f64::INFINITY] } else { [from.min(to), from.max(to)] }
        };
        let all = [bound(a.x, b.x), bound(a.y, b.y), bound(a.z, b.z)];
        let enter = all.iter().map(|b| b[0]).fold(0.0, f64::max);
        let leave = all.iter().map(|b| b[1]).fold(f64::INFINITY, f64::min);
        enter <= leave
    }
}

/// Where a ray meets a triangle from either side (Möller, Trumbore 1997).
fn meet(origin: DVec3, direction: DVec3, a: DVec3, b: DVec3, c: DVec3) -> Option<f64> {
    let (u, v) = (b - a, c - a);
    let p = direction.cross(v);
    let determinant = u.dot(p);
    if determinant == 0.0 {
        return None;
    }
    let s = (origin - a) / determinant;
    let x = s.dot(p);
    let q = s.cross(u);
    let y = direction.dot(q);
    let at = v.dot(q);
    (x >= 0.0 && y >= 0.0 && x + y <= 1.0 && at > 0.0).then_some(at)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::draw;
    use tenon_engine::Tree;
    use tenon_nodes::value::Point;

    #[test]
    fn curves_and_points_are_picked_where_they_are_seen() {
        let points = vec![Point(DVec3::new(1.0, 2.0, 9.0)), Point(DVec3::new(4.0, 2.0, 0.0))];
        let d = draw(&Tree::list(points)).unwrap();
        let from_above = |p: DVec3| Some(p.truncate());
        assert_eq!(d.pick_thin(DVec2::new(3.5, 2.0), 1.0, from_above), Some((1, DVec3::new(4.0, 2.0, 0.0), 0.5)));
        assert_eq!(d.pick_thin(DVec2::new(2.5, 2.0), 1.0, from_above), None);
        let line = [[0.0, 0.0, 0.0], [10.0, 0.0, 5.0]].map(|[x, y, z]| DVec3::new(x, y, z));
        let mut d = Drawing::empty(Kind::Curve);
        d.line(line[0], line[1], 3);
        let (part, place, away) = d.pick_thin(DVec2::new(5.0, 0.5), 1.0, from_above).unwrap();
        assert_eq!((part, place, away), (3, DVec3::new(5.0, 0.0, 2.5), 0.5));
    }
}
