//! Where a straight line runs inside a swept frustum, exactly.
//!
//! A frustum B that moves by t without turning sweeps `B ⊕ [0, t]`: the point `q + s n` is swept iff some τ in [0, 1] has
//! `q + s n - τ t` in B. In the plane (s, τ) that is a convex set bounded by four lines (τ = 0, τ = 1, foot and head
//! of the frustum) and one conic (its side); its least and greatest s lie on a line or where the conic's tangent is τ.

use super::sweep::Sweep;
use glam::DVec3;

/// Least and greatest `s` with `origin + s direction` in the sweep of a straight move; `None` if the line misses it.
/// Of a sweep in which the tool turns only its start is taken, which is part of it. Constant cost.
pub(crate) fn ray_interval(sweep: &Sweep, origin: DVec3, direction: DVec3) -> Option<(f64, f64)> {
    let [foot, head, end, _] = &sweep.discs;
    let axis = foot.axis;
    let travel = if sweep.margin == 0.0 { end.center - foot.center } else { DVec3::ZERO };
    let height = (head.center - foot.center).dot(axis);
    if height <= 0.0 {
        return None;
    }
    let slope = (head.radius - foot.radius) / height;
    let across = |v: DVec3| v - axis * axis.dot(v);
    let start = origin - foot.center;
    // Height above the foot: w = w0 + s ws + τ wt. Radius there: r = r0 + s rs + τ rt.
    let (w0, ws, wt) = (start.dot(axis), direction.dot(axis), -travel.dot(axis));
    let (r0, rs, rt) = (foot.radius + slope * w0, slope * ws, slope * wt);
    let (d, n, t) = (across(start), across(direction), -across(travel));
    // Q = a s² + 2 b sτ + c τ² + 2 e s + 2 g τ + h ≤ 0 inside the side.
    let (a, b, c) = (n.dot(n) - rs * rs, n.dot(t) - rs * rt, t.dot(t) - rt * rt);
    let (e, g, h) = (n.dot(d) - rs * r0, t.dot(d) - rt * r0, d.dot(d) - r0 * r0);

    let slack = 1e-9;
    let mut found: Option<(f64, f64)> = None;
    let mut take = |s: f64| {
        found = Some(found.map_or((s, s), |(low, high)| (low.min(s), high.max(s))));
    };
    // Where the conic's s is stationary over τ.
    if c.abs() > 1e-12 {
        for s in roots(a - b * b / c, e - b * g / c, h - g * g / c).into_iter().flatten() {
            let tau = -(b * s + g) / c;
            let w = w0 + s * ws + tau * wt;
            if (-slack..=1.0 + slack).contains(&tau) && (-slack..=height + slack).contains(&w) {
                take(s);
            }
        }
    }
    // Along each of the four lines (s, τ) = p + k v, cut by the other lines, then by the conic.
    let across_lines = ws * ws + wt * wt;
    let lines = [(0.0, 0.0, 1.0, 0.0), (0.0, 1.0, 1.0, 0.0)].into_iter().chain(
        [0.0, height].into_iter().filter(|_| across_lines > 1e-24).map(|level| {
            let k = (level - w0) / across_lines;
            (k * ws, k * wt, -wt, ws)
        }),
    );
    for (ps, pt, vs, vt) in lines {
        let mut range = (f64::NEG_INFINITY, f64::INFINITY);
        let inside = limit(&mut range, pt, vt, 0.0, 1.0, slack)
            && limit(&mut range, w0 + ps * ws + pt * wt, vs * ws + vt * wt, 0.0, height, slack);
        if !inside || range.0 > range.1 {
            continue;
        }
        let qa = a * vs * vs + 2.0 * b * vs * vt + c * vt * vt;
        let qb = a * ps * vs + b * (ps * vt + pt * vs) + c * pt * vt + e * vs + g * vt;
        let qc = a * ps * ps + 2.0 * b * ps * pt + c * pt * pt + 2.0 * e * ps + 2.0 * g * pt + h;
        let scale = 1.0 + foot.radius * foot.radius + head.radius * head.radius;
        for k in [range.0, range.1] {
            if k.is_finite() && (qa * k + 2.0 * qb) * k + qc <= slack * scale {
                take(ps + k * vs);
            }
        }
        for k in roots(qa, qb, qc).into_iter().flatten() {
            if k >= range.0 && k <= range.1 {
                take(ps + k * vs);
            }
        }
    }
    found
}

/// Narrows `range` to the k with `low ≤ p + k v ≤ high`; false if the line runs outside altogether.
fn limit(range: &mut (f64, f64), p: f64, v: f64, low: f64, high: f64, slack: f64) -> bool {
    if v.abs() < 1e-15 {
        return p >= low - slack && p <= high + slack;
    }
    let (k0, k1) = ((low - p) / v, (high - p) / v);
    range.0 = range.0.max(k0.min(k1));
    range.1 = range.1.min(k0.max(k1));
    true
}

/// Roots of a x² + 2 b x + c.
fn roots(a: f64, b: f64, c: f64) -> [Option<f64>; 2] {
    if a.abs() < 1e-14 {
        return if b.abs() < 1e-14 { [None, None] } else { [Some(-0.5 * c / b), None] };
    }
    let disc = b * b - a * c;
    if disc < 0.0 {
        return [None, None];
    }
    // The root without cancellation first, the other from the product.
    let q = -(b + b.signum() * disc.sqrt());
    if q == 0.0 {
        return [Some(0.0), None];
    }
    [Some(q / a), Some(c / q)]
}

#[cfg(test)]
mod tests {
    use super::super::sweep::Disc;
    use super::*;
    use proptest::prelude::*;

    fn sweep(from: DVec3, to: DVec3, axis: DVec3, r0: f64, r1: f64, height: f64) -> Sweep {
        let disc = |center, radius| Disc { center, axis, radius };
        Sweep {
            discs: [disc(from, r0), disc(from + axis * height, r1), disc(to, r0), disc(to + axis * height, r1)],
            margin: 0.0,
        }
    }

    /// Whether a point is swept, by trying places along the travel.
    fn swept(s: &Sweep, p: DVec3, grow: f64) -> bool {
        let height = (s.discs[1].center - s.discs[0].center).length();
        (0..=4000).any(|k| {
            let c = s.discs[0].center.lerp(s.discs[2].center, f64::from(k) / 4000.0);
            let w = (p - c).dot(s.discs[0].axis);
            let r = s.discs[0].radius + (s.discs[1].radius - s.discs[0].radius) * (w / height).clamp(0.0, 1.0);
            w >= -grow && w <= height + grow && (p - c - s.discs[0].axis * w).length() <= r + grow
        })
    }

    #[test]
    fn a_flat_side_is_met_where_it_lies() {
        let s = sweep(DVec3::new(-50.0, 10.0, -1.0), DVec3::new(50.0, 10.0, -1.0), DVec3::Z, 10.0, 10.0, 60.0);
        let (near, far) = ray_interval(&s, DVec3::new(3.0, 0.0, 5.0), DVec3::Y).unwrap();
        assert!(near.abs() < 1e-12 && (far - 20.0).abs() < 1e-12);
        assert!(ray_interval(&s, DVec3::new(3.0, 0.0, -2.0), DVec3::Y).is_none());
        // In the round end.
        let (near, _) = ray_interval(&s, DVec3::new(56.0, 0.0, 5.0), DVec3::Y).unwrap();
        assert!((near - 2.0).abs() < 1e-12);
        // A drill's point from below.
        let s = sweep(DVec3::ZERO, DVec3::ZERO, DVec3::Z, 0.0, 2.0, 1.0);
        let (near, far) = ray_interval(&s, DVec3::new(1.0, 0.0, -3.0), DVec3::Z).unwrap();
        assert!((near - 3.5).abs() < 1e-9 && (far - 4.0).abs() < 1e-9, "{near} {far}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]

        #[test]
        fn inside_the_interval_is_swept_and_outside_is_not(
            origin in (-15.0..15.0f64, -15.0..15.0f64, -15.0..15.0f64),
            by in (-20.0..20.0f64, -20.0..20.0f64, -20.0..20.0f64),
            tilt in 0.0..1.2f64, r0 in 0.0..6.0f64, r1 in 0.5..6.0f64,
            ray in (0.0..3.1f64, -3.2..3.2f64), still in 0..4,
        ) {
            let axis = DVec3::new(tilt.sin(), 0.0, tilt.cos());
            let by = match still { 0 => DVec3::ZERO, 1 => axis * by.2, _ => DVec3::new(by.0, by.1, by.2) };
            let s = sweep(DVec3::ZERO, by, axis, r0, r1, 12.0);
            let origin = DVec3::new(origin.0, origin.1, origin.2);
            let direction = DVec3::new(ray.0.sin() * ray.1.cos(), ray.0.sin() * ray.1.sin(), ray.0.cos());
            let interval = ray_interval(&s, origin, direction);
            let inside = |x: f64| interval.is_some_and(|(a, b)| x >= a - 1e-6 && x <= b + 1e-6);
            for k in -60..=60 {
                let x = f64::from(k) * 0.7;
                let p = origin + direction * x;
                if swept(&s, p, 0.0) {
                    prop_assert!(inside(x), "{x} is swept, {interval:?}");
                } else if !swept(&s, p, 0.02) {
                    prop_assert!(!inside(x), "{x} is not swept, {interval:?}");
                }
            }
        }
    }
}
