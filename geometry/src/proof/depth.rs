//! How deep a sweep goes into a convex solid: the largest distance to the solid's surface of any point that the two
//! share, with certified bounds.
//!
//! `depth = max over x in S of min over faces f of (o_f - n_f · x)` is a game between points of the sweep and weights on
//! the faces; by duality it equals `min over weights λ of Σ λ_f o_f + h_S(-Σ λ_f n_f)`, h the sweep's support function.
//! Every λ gives an upper bound (a single face: "this face separates them but for …"), every point a lower one.

use super::sweep::Sweep;
use crate::plane::Plane;
use glam::DVec3;

/// The depth lies between `lower` and `upper`, mm; negative: apart. `at` is a point of the sweep as deep as `lower`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Depth {
    pub upper: f64,
    pub lower: f64,
    pub at: DVec3,
}

/// Upper bound from the faces alone: cheap, and tight where one face separates. O(faces).
pub(crate) fn depth_bound(sweep: &Sweep, planes: &[Plane]) -> f64 {
    planes.iter().map(|p| p.offset + sweep.reach(-p.normal)).fold(f64::INFINITY, f64::min)
}

/// Most rounds of the game; the bounds usually meet in ten.
const ROUNDS: usize = 48;

/// The depth to within `precision`, or until it is certain to be no more than `enough`. O(rounds² · faces).
pub(crate) fn depth(sweep: &Sweep, planes: &[Plane], enough: f64, precision: f64) -> Depth {
    let mut points: Vec<DVec3> = Vec::with_capacity(ROUNDS + planes.len());
    let mut upper = f64::INFINITY;
    for p in planes {
        let bound = p.offset + sweep.reach(-p.normal);
        upper = upper.min(bound);
        points.push(sweep.farthest(-p.normal));
    }
    let mut best = Depth { upper, lower: f64::NEG_INFINITY, at: points.first().copied().unwrap_or_default() };
    let mut payoff: Vec<f64> = Vec::with_capacity((ROUNDS + planes.len()) * planes.len());
    let row = |x: DVec3| planes.iter().map(move |p| p.offset - p.normal.dot(x));
    payoff.extend(points.iter().flat_map(|x| row(*x)));
    for _ in 0..ROUNDS {
        if best.upper <= enough || best.upper - best.lower <= precision {
            break;
        }
        let Some(game) = solve_game(&payoff, planes.len()) else { break };
        let at: DVec3 = points.iter().zip(&game.rows).map(|(x, w)| *x * *w).sum();
        let lower = row(at).fold(f64::INFINITY, f64::min);
        if lower > best.lower {
            best.lower = lower;
            best.at = at;
        }
        let m: DVec3 = planes.iter().zip(&game.columns).map(|(p, w)| p.normal * *w).sum();
        let offset: f64 = planes.iter().zip(&game.columns).map(|(p, w)| p.offset * *w).sum();
        best.upper = best.upper.min(offset + sweep.reach(-m));
        let next = sweep.farthest(-m);
        points.push(next);
        payoff.extend(row(next));
    }
    best
}

/// Least pivot, of entries between 0.1 and 1.1.
const PIVOT: f64 = 1e-9;

/// Optimal mixed strategies of a matrix game.
struct Game {
    rows: Vec<f64>,
    columns: Vec<f64>,
}

/// Solves the zero-sum game in which the row player (points) maximizes and the column player (faces) minimizes the
/// payoff, by the simplex method on the column player's programme. `None` if it does not end (rounding).
fn solve_game(payoff: &[f64], columns: usize) -> Option<Game> {
    let rows = payoff.len().checked_div(columns)?;
    let least = payoff.iter().copied().fold(f64::INFINITY, f64::min);
    let scale = payoff.iter().map(|v| v - least).fold(1.0, f64::max);
    // Maximize Σ q subject to A q ≤ 1, q ≥ 0 with A > 0; slack basis to start. One row more for the objective.
    let width = columns + rows + 1;
    let mut t = vec![0.0; (rows + 1) * width];
    for r in 0..rows {
        for c in 0..columns {
            t[r * width + c] = (payoff[r * columns + c] - least) / scale + 0.1;
        }
        t[r * width + columns + r] = 1.0;
        t[r * width + width - 1] = 1.0;
    }
    for c in 0..columns {
        t[rows * width + c] = -1.0;
    }
    let mut basis: Vec<usize> = (columns..columns + rows).collect();
    for round in 0..200 {
        let objective = &t[rows * width..];
        // The steepest column first; Bland's rule later, so that it ends.
        let entering = if round < 100 {
            (0..width - 1).min_by(|a, b| objective[*a].total_cmp(&objective[*b])).filter(|c| objective[*c] < -1e-12)
        } else {
            (0..width - 1).find(|c| objective[*c] < -1e-12)
        };
        let Some(c) = entering else {
            let total = t[rows * width + width - 1];
            if total <= 0.0 {
                return None;
            }
            let mut game = Game { rows: vec![0.0; rows], columns: vec![0.0; columns] };
            for (r, b) in basis.iter().enumerate() {
                if *b < columns {
                    game.columns[*b] = t[r * width + width - 1] / total;
                }
            }
            for r in 0..rows {
                game.rows[r] = t[rows * width + columns + r].max(0.0) / total;
            }
            normalize(&mut game.rows)?;
            normalize(&mut game.columns)?;
            return Some(game);
        };
        // Of the rows that bind first, give or take rounding, the one with the largest pivot: equal faces and points
        // leave differences of rounding size, and dividing by one of those would lose everything.
        let ratio = |r: usize| t[r * width + width - 1].max(0.0) / t[r * width + c];
        let candidates = || (0..rows).filter(|r| t[r * width + c] > PIVOT);
        let first = candidates().map(ratio).fold(f64::INFINITY, f64::min);
        let leaving = candidates()
            .filter(|r| ratio(*r) <= first + 1e-10 * (1.0 + first))
            .max_by(|a, b| t[a * width + c].total_cmp(&t[b * width + c]).then(basis[*b].cmp(&basis[*a])))?;
        let pivot = t[leaving * width + c];
        for k in 0..width {
            t[leaving * width + k] /= pivot;
        }
        for r in 0..=rows {
            let factor = t[r * width + c];
            if r != leaving && factor != 0.0 {
                for k in 0..width {
                    t[r * width + k] -= factor * t[leaving * width + k];
                }
            }
        }
        basis[leaving] = c;
    }
    None
}

/// Rounding must not let weights sum to anything but 1: the bounds rest on it.
fn normalize(weights: &mut [f64]) -> Option<()> {
    for w in weights.iter_mut() {
        *w = w.max(0.0);
    }
    let sum: f64 = weights.iter().sum();
    if !(sum > 0.0 && sum.is_finite()) {
        return None;
    }
    weights.iter_mut().for_each(|w| *w /= sum);
    Some(())
}

#[cfg(test)]
mod tests {
    use super::super::sweep::Disc;
    use super::*;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_6;

    pub(crate) fn cube(half: f64) -> Vec<Plane> {
        [DVec3::X, DVec3::Y, DVec3::Z]
            .iter()
            .flat_map(|n| [*n, -*n])
            .map(|n| Plane { normal: n, offset: half })
            .collect()
    }

    fn sweep(from: DVec3, to: DVec3, axis: DVec3, r0: f64, r1: f64, height: f64) -> Sweep {
        let disc = |center, radius| Disc { center, axis, radius };
        Sweep {
            discs: [disc(from, r0), disc(from + axis * height, r1), disc(to, r0), disc(to + axis * height, r1)],
            margin: 0.0,
        }
    }

    #[test]
    fn known_depths() {
        let planes = cube(10.0);
        // A cylinder of radius 3 standing 2 mm inside one side, upright, through.
        let s = sweep(DVec3::new(11.0, -50.0, -40.0), DVec3::new(11.0, 50.0, -40.0), DVec3::Z, 3.0, 3.0, 80.0);
        assert!((depth_bound(&s, &planes) - 2.0).abs() < 1e-12);
        let d = depth(&s, &planes, 0.0, 1e-6);
        assert!((d.upper - 2.0).abs() < 1e-6 && (d.lower - 2.0).abs() < 1e-6, "{d:?}");
        // Through the middle: as deep as the cube.
        let s = sweep(DVec3::new(0.0, 0.0, -40.0), DVec3::new(0.0, 0.0, -40.0), DVec3::Z, 3.0, 3.0, 80.0);
        assert!((depth(&s, &planes, 0.0, 1e-6).upper - 10.0).abs() < 1e-5);
        // Round end past an edge of the cube: no face separates, but they are apart.
        let s = sweep(DVec3::new(12.0, 12.0, -40.0), DVec3::new(12.0, 12.0, -40.0), DVec3::Z, 2.5, 2.5, 80.0);
        assert!(depth_bound(&s, &planes) > 0.4);
        assert!(depth(&s, &planes, 0.0, 1e-6).upper <= 0.0);
        // And cutting that edge: along the diagonal the circle reaches 12√2 - 3.5; depth is that of a point on x = y.
        let s = sweep(DVec3::new(12.0, 12.0, -40.0), DVec3::new(12.0, 12.0, -40.0), DVec3::Z, 3.5, 3.5, 80.0);
        let expected = 10.0 - (12.0 - 3.5 / 2f64.sqrt());
        let d = depth(&s, &planes, 0.0, 1e-6);
        assert!((d.upper - expected).abs() < 1e-5 && (d.lower - expected).abs() < 1e-5, "{d:?} {expected}");
    }

    #[test]
    fn a_long_flat_cut_beside_a_leaning_side_is_apart() {
        let plane = |x: f64, y: f64, z: f64, offset: f64| Plane { normal: DVec3::new(x, y, z), offset };
        // Node facets on borders have their chamfer's plane: the same face several times.
        let bottom = plane(0.0, 6.938893903907228e-18, -1.0, 1.4356411920979646e-14);
        let top = plane(0.0, -6.938893903907228e-18, 1.0, 9.999999999999986);
        let far = plane(3.469446951953614e-18, 0.9793837241602413, -0.20200871478729943, 2026.3224034640775);
        let right = plane(0.9885312213469695, 0.15095839878818784, 0.004193597211826369, 620.4891448258833);
        let near = plane(0.0, -0.9661943264098489, -0.2578149018451393, -1834.5922151029094);
        let left = plane(-0.9885312511613612, -0.15095840334113744, 0.004186399174492747, -342.4209787678343);
        let planes = [bottom, top, far, right, near, left, left, far, near, left];
        let axis = DVec3::new(0.0, 0.19478218961070887, 0.9808465214346523);
        let (from, to) = (DVec3::new(29.168, 1881.888, -2.929), DVec3::new(313.773, 1881.888, -2.929));
        let mut s = sweep(from, to, axis, 10.0, 10.0, 65.0);
        s.discs[1].center = DVec3::new(29.168, 1894.548842324696, 60.8260238932524);
        s.discs[3].center = DVec3::new(313.773, 1894.548842324696, 60.8260238932524);
        let d = depth(&s, &planes, 0.005, 5e-4);
        assert!(d.upper <= 0.005, "{d:?}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]

        /// The bounds enclose what a cloud of points of the sweep finds, and they meet.
        #[test]
        fn bounds_enclose_sampled_depth(
            from in (-15.0..15.0f64, -15.0..15.0f64, -15.0..15.0f64),
            by in (-20.0..20.0f64, -20.0..20.0f64, -20.0..20.0f64),
            tilt in 0.0..1.2f64, heading in -3.2..3.2f64, r0 in 0.0..4.0f64, r1 in 0.1..4.0f64,
        ) {
            let axis = DVec3::new(tilt.sin() * heading.cos(), tilt.sin() * heading.sin(), tilt.cos());
            let from = DVec3::new(from.0, from.1, from.2);
            let s = sweep(from, from + DVec3::new(by.0, by.1, by.2), axis, r0, r1, 12.0);
            let planes = cube(8.0);
            let d = depth(&s, &planes, f64::NEG_INFINITY, 1e-4);
            prop_assert!(d.lower <= d.upper + 1e-9);
            prop_assert!(d.upper - d.lower <= 1e-2, "{:?}", d);
            prop_assert!(d.upper <= depth_bound(&s, &planes) + 1e-9);
            let side = axis.any_orthonormal_vector();
            let other = axis.cross(side);
            for i in 0..6 {
                for j in 0..6 {
                    for k in 0..12 {
                        let (h, t, phi) = (f64::from(i) / 5.0, f64::from(j) / 5.0, f64::from(k) * FRAC_PI_6);
                        let c = s.discs[0].center.lerp(s.discs[2].center, t) + axis * (12.0 * h);
                        let x = c + (side * phi.cos() + other * phi.sin()) * (r0 + (r1 - r0) * h);
                        let at = planes.iter().map(|p| -p.distance(x)).fold(f64::INFINITY, f64::min);
                        prop_assert!(at <= d.upper + 1e-9);
                    }
                }
            }
        }

        /// Cuts as they occur, along and across a panel whose faces partly stand twice in the list: the bounds meet.
        #[test]
        fn bounds_meet_on_panels(
            lean in prop::array::uniform4(-0.6..0.6f64), turn in prop::array::uniform4(-0.2..0.2f64),
            at in (-200.0..200.0f64, -90.0..90.0f64, -12.0..12.0f64), length in -400.0..400.0f64,
            tilt in -0.7..0.7f64, heading in 0.0..6.3f64, double in 0..4usize,
        ) {
            let mut planes = vec![
                Plane { normal: -DVec3::Z, offset: 0.0 },
                Plane { normal: DVec3::Z, offset: 10.0 },
            ];
            for k in 0..4 {
                let angle = std::f64::consts::FRAC_PI_2 * k as f64 + turn[k];
                let out = DVec3::new(angle.cos(), angle.sin(), 0.0);
                let normal = out * lean[k].cos() + DVec3::Z * lean[k].sin();
                planes.push(Plane::through(out * if k % 2 == 0 { 150.0 } else { 60.0 }, normal));
            }
            planes.extend_from_within(6 - double..);
            let along = DVec3::new(heading.cos(), heading.sin(), 0.0);
            let across = DVec3::new(-heading.sin(), heading.cos(), 0.0);
            let axis = across * tilt.sin() + DVec3::Z * tilt.cos();
            let from = DVec3::new(at.0, at.1, at.2);
            for radius in [1.5, 10.0] {
                let s = sweep(from, from + along * length, axis, radius, radius, 65.0);
                let d = depth(&s, &planes, 0.005, 5e-4);
                prop_assert!(d.upper <= 0.005 || d.upper - d.lower <= 5e-4, "{:?}", d);
            }
        }
    }
}
