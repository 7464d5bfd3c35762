//! Convex polygons in the plane: hull, outward offset, half-plane clipping, and how far one must slide along an axis
//! to clear another. All polygons run counter-clockwise.

use glam::DVec2;

/// Far above the rounding of board coordinates, far below what any machine can place, mm.
const ROUNDING: f64 = 1e-9;

/// Convex hull, counter-clockwise, without collinear points; fewer than three points when the input has no area.
/// O(n log n) (Andrew's monotone chain), for large inputs mostly O(n) (Akl and Toussaint 1978: points inside the
/// octagon of the extremes are dropped first).
#[must_use]
pub fn hull(points: &[DVec2]) -> Vec<DVec2> {
    let mut sorted = if points.len() < 64 { points.to_vec() } else { outside_of_extremes(points) };
    sorted.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    sorted.dedup();
    if sorted.len() < 3 {
        return sorted;
    }
    let mut lower = half_hull(sorted.iter().copied());
    let upper = half_hull(sorted.iter().rev().copied());
    lower.pop();
    lower.extend_from_slice(&upper[..upper.len() - 1]);
    lower
}

/// The points that do not lie strictly inside the polygon of the extremes in eight directions.
fn outside_of_extremes(points: &[DVec2]) -> Vec<DVec2> {
    let keys = |p: &DVec2| [p.x, p.x + p.y, p.y, p.y - p.x];
    let (mut least, mut most) = ([points[0]; 4], [points[0]; 4]);
    let (mut low, mut high) = (keys(&points[0]), keys(&points[0]));
    for p in points {
        for (k, v) in keys(p).into_iter().enumerate() {
            if v < low[k] {
                (low[k], least[k]) = (v, *p);
            }
            if v > high[k] {
                (high[k], most[k]) = (v, *p);
            }
        }
    }
    // Counter-clockwise from the right.
    let [a, b, c, d] = most;
    let [e, f, g, h] = least;
    let corners = [a, b, c, d, e, f, g, h];
    let edges: [(DVec2, DVec2); 8] = std::array::from_fn(|k| (corners[k], corners[(k + 1) % 8] - corners[k]));
    let inside = |p: &DVec2| edges.iter().all(|(from, edge)| edge.perp_dot(*p - *from) > 0.0 || *edge == DVec2::ZERO);
    points.iter().filter(|p| !inside(p)).copied().collect()
}

/// The counter-clockwise half of a hull over points that are sorted along the walk.
fn half_hull(points: impl Iterator<Item = DVec2>) -> Vec<DVec2> {
    let mut chain: Vec<DVec2> = Vec::new();
    for p in points {
        while let [.., a, b] = chain[..] {
            if (b - a).perp_dot(p - b) > 0.0 {
                break;
            }
            chain.pop();
        }
        chain.push(p);
    }
    chain
}

/// Area of a polygon, positive when counter-clockwise, mm². O(n).
#[must_use]
pub fn area(polygon: &[DVec2]) -> f64 {
    0.5 * polygon.iter().zip(polygon.iter().cycle().skip(1)).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
}

/// Least and greatest coordinates; `None` for no points.
#[must_use]
pub fn bounds(polygon: &[DVec2]) -> Option<(DVec2, DVec2)> {
    polygon.iter().fold(None, |b, p| match b {
        None => Some((*p, *p)),
        Some((lo, hi)) => Some((lo.min(*p), hi.max(*p))),
    })
}

/// A convex polygon that contains every point within `by` mm of `polygon`: mitred corners, sharp ones (more than a
/// right angle of turn) cut square at distance ≥ `by`. O(n).
#[must_use]
pub fn inflate(polygon: &[DVec2], by: f64) -> Vec<DVec2> {
    if polygon.len() < 3 || by <= 0.0 {
        return polygon.to_vec();
    }
    // Corners that only rounding keeps apart have an edge of arbitrary direction between them.
    let apart = |k: &usize| polygon[*k].distance(polygon[(k + 1) % polygon.len()]) > ROUNDING;
    let polygon: Vec<DVec2> = (0..polygon.len()).filter(apart).map(|k| polygon[k]).collect();
    let n = polygon.len();
    let direction = |k: usize| (polygon[(k + 1) % n] - polygon[k]).normalize();
    let mut out = Vec::with_capacity(n + 4);
    let mut before = direction(n - 1);
    for (k, &corner) in polygon.iter().enumerate() {
        let after = direction(k);
        let (n0, n1) = (-before.perp(), -after.perp());
        if before.dot(after) > -0.1 {
            out.push(corner + (n0 + n1) * (by / (1.0 + n0.dot(n1))));
        } else {
            out.push(corner + (n0 + before) * by);
            out.push(corner + (n1 - after) * by);
        }
        before = after;
    }
    out
}

/// The part of a convex polygon where `normal · p <= offset`. O(n).
#[must_use]
pub fn clip(polygon: &[DVec2], normal: DVec2, offset: f64) -> Vec<DVec2> {
    let mut out = Vec::with_capacity(polygon.len() + 1);
    for (k, &a) in polygon.iter().enumerate() {
        let b = polygon[(k + 1) % polygon.len()];
        let (da, db) = (normal.dot(a) - offset, normal.dot(b) - offset);
        if da <= 0.0 {
            out.push(a);
        }
        if (da < 0.0 && db > 0.0) || (da > 0.0 && db < 0.0) {
            out.push(a.lerp(b, da / (da - db)));
        }
    }
    out
}

/// Distance by which two convex polygons are apart along the best of their edge normals, mm: positive when they are
/// disjoint (a lower bound of their distance), else minus the depth of overlap. O(n·m).
#[must_use]
pub fn separation(a: &[DVec2], b: &[DVec2]) -> f64 {
    let one_way = |p: &[DVec2], q: &[DVec2]| {
        (0..p.len())
            .filter_map(|k| {
                let normal = -(p[(k + 1) % p.len()] - p[k]).perp().try_normalize()?;
                Some(q.iter().map(|c| normal.dot(*c - p[k])).fold(f64::INFINITY, f64::min))
            })
            .fold(f64::NEG_INFINITY, f64::max)
    };
    one_way(a, b).max(one_way(b, a))
}

/// The two monotone boundaries of a convex polygon as functions over one axis: points `(t, value)` with rising `t`.
#[derive(Clone, Debug, Default)]
pub struct Chains {
    /// Greatest value over `t`: a concave function.
    pub high: Vec<DVec2>,
    /// Least value over `t`: a convex function.
    pub low: Vec<DVec2>,
}

impl Chains {
    /// Boundaries of `polygon` over its x axis. O(n log n).
    #[must_use]
    pub fn over_x(polygon: &[DVec2]) -> Self {
        let mut p = polygon.to_vec();
        p.sort_unstable_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
        p.dedup();
        let mut low = half_hull(p.iter().copied());
        let mut high = half_hull(p.iter().rev().copied());
        high.reverse();
        trim_ends(&mut low, f64::min);
        trim_ends(&mut high, f64::max);
        Self { high, low }
    }

    /// Boundaries over the y axis. O(n log n).
    #[must_use]
    pub fn over_y(polygon: &[DVec2]) -> Self {
        let swapped: Vec<DVec2> = polygon.iter().map(|p| DVec2::new(p.y, p.x)).collect();
        Self::over_x(&swapped)
    }
}

/// Takes upright edges off the ends of a chain: they belong to neither boundary. An edge that rounding has tipped is
/// upright too; its outer point keeps its place, so the polygon never shrinks.
fn trim_ends(chain: &mut Vec<DVec2>, outer: fn(f64, f64) -> f64) {
    while let [a, b, ..] = chain[..]
        && b.x - a.x < ROUNDING
    {
        chain[1] = DVec2::new(a.x, outer(a.y, b.y));
        chain.remove(0);
    }
    while let [.., a, b] = chain[..]
        && b.x - a.x < ROUNDING
    {
        chain.pop();
        if let Some(last) = chain.last_mut() {
            *last = DVec2::new(b.x, outer(a.y, b.y));
        }
    }
}

/// Greatest `a(t - ta) - b(t - tb)` over the `t` that both functions share: the least amount by which the polygon of
/// the low chain `b` must be raised to lie beyond the polygon of the high chain `a`. `None` if they share no interval.
/// O(n + m).
#[must_use]
pub fn clearance(a: &[DVec2], ta: f64, b: &[DVec2], tb: f64) -> Option<f64> {
    let (a0, a1, b0, b1) = (a.first()?.x + ta, a.last()?.x + ta, b.first()?.x + tb, b.last()?.x + tb);
    let (from, to) = (a0.max(b0), a1.min(b1));
    if from >= to {
        return None;
    }
    let (mut i, mut j) = (0, 0);
    let mut best = f64::NEG_INFINITY;
    let mut t = from;
    loop {
        while i + 2 < a.len() && a[i + 1].x + ta <= t {
            i += 1;
        }
        while j + 2 < b.len() && b[j + 1].x + tb <= t {
            j += 1;
        }
        best = best.max(value(a, i, t - ta) - value(b, j, t - tb));
        if t >= to {
            return Some(best);
        }
        t = match (a.get(i + 1).map(|p| p.x + ta), b.get(j + 1).map(|p| p.x + tb)) {
            (Some(x), Some(y)) => [x, y].into_iter().filter(|n| *n > t).fold(to, f64::min),
            _ => to,
        };
    }
}

/// Value at `t` of a polyline on its segment `k`.
fn value(chain: &[DVec2], k: usize, t: f64) -> f64 {
    let Some(b) = chain.get(k + 1) else { return chain[k].y };
    let a = chain[k];
    let span = b.x - a.x;
    if span > 0.0 { a.y + (b.y - a.y) * ((t - a.x) / span).clamp(0.0, 1.0) } else { a.y }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn cloud() -> impl Strategy<Value = Vec<DVec2>> {
        prop::collection::vec((-50.0..50.0f64, -50.0..50.0f64).prop_map(|(x, y)| DVec2::new(x, y)), 3..14)
    }

    proptest! {
        #[test]
        fn hull_is_convex_and_holds_its_points(points in cloud()) {
            let h = hull(&points);
            let n = h.len();
            for k in 0..n {
                let (a, b, c) = (h[k], h[(k + 1) % n], h[(k + 2) % n]);
                prop_assert!((b - a).perp_dot(c - b) > 0.0);
                for p in &points {
                    prop_assert!((b - a).perp_dot(*p - a) >= -1e-9);
                }
            }
        }

        #[test]
        fn hull_of_many_points_drops_none_that_count(points in prop::collection::vec((-9.0..9.0f64, -9.0..9.0f64), 64..200)) {
            let points: Vec<DVec2> = points.into_iter().map(|(x, y)| DVec2::new(x, y)).collect();
            let whole = hull(&points);
            let halves = [hull(&points[..63]), points[63..].chunks(60).flat_map(hull).collect()].concat();
            prop_assert_eq!(whole, hull(&hull(&halves)));
        }

        #[test]
        fn a_polygon_slid_by_its_clearance_just_touches(a in cloud(), b in cloud(), dy in -60.0..60.0f64) {
            let (a, mut b) = (hull(&a), hull(&b));
            let (ca, cb) = (Chains::over_y(&a), Chains::over_y(&b));
            if let Some(dx) = clearance(&ca.high, 0.0, &cb.low, dy) {
                b.iter_mut().for_each(|p| *p += DVec2::new(dx, dy));
                prop_assert!(separation(&a, &b) >= -1e-9);
                b.iter_mut().for_each(|p| p.x -= 1e-3);
                prop_assert!(separation(&a, &b) < 0.0);
            }
        }

        #[test]
        fn inflated_polygon_clears_by_its_amount(a in cloud(), by in 0.1..20.0f64) {
            let h = hull(&a);
            let grown = inflate(&h, by);
            let n = grown.len();
            for k in 0..n {
                let (p, q) = (grown[k], grown[(k + 1) % n]);
                if let Some(normal) = (q - p).perp().try_normalize() {
                    for c in &h {
                        prop_assert!(normal.dot(*c - p) >= by - 1e-9);
                    }
                }
            }
        }
    }

    #[test]
    fn corners_doubled_by_rounding_do_not_matter() {
        let square =
            [DVec2::ZERO, DVec2::X, DVec2::new(1.0, 3e-14), DVec2::ONE, DVec2::new(1.0 - 1e-15, 1.0), DVec2::Y];
        let grown = inflate(&square, 0.5);

        assert!((area(&grown) - 4.0).abs() < 1e-9);
    }

    #[test]
    fn edges_tipped_by_rounding_still_count() {
        let square = |tip: f64| [DVec2::ZERO, DVec2::X, DVec2::new(1.0 + tip, 1.0), DVec2::new(tip, 1.0)];
        for tip in [-3e-16, -1e-13, 0.0, 1e-13, 3e-16] {
            let c = Chains::over_x(&square(tip));
            for shift in [0.1, 1e3 / 3.0, 1e4 / 7.0] {
                // Only the last sliver of the interval is shared.
                let dy = clearance(&c.high, shift, &c.low, shift + 1.0 - 1e-12).unwrap();
                assert!((dy - 1.0).abs() < 1e-9, "{tip} {dy}");
            }
        }
    }

    #[test]
    fn polygons_without_a_shared_interval_need_no_shift() {
        let square = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        let c = Chains::over_x(&square);
        assert_eq!(clearance(&c.high, 0.0, &c.low, 2.0), None);
        assert_eq!(clearance(&c.high, 0.0, &c.low, 0.5), Some(1.0));
    }
}
