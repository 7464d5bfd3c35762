//! Kinematics of a head with two rotary axes: programmed angles to tool axis and back, tip to pivot and back.
//!
//! The tool axis is `v(a, b) = R(p, σ_p a) · R(s, σ_s b) · Z` with the primary axis `p`, the secondary `s` and their signs
//! `σ`. For the machine of 000 §7.3.1 (p = Z, s = X, both signs -1) this is `(sin A sin B, cos A sin B, cos B)`, and the
//! inverse is `B = ± atan2(hypot(v_x, v_y), v_z)`, `A = atan2(± v_x, ± v_y)`; the sign rule printed there fails for
//! `v_y < 0` (METHODS §8).

use super::{Machine, Tool};
use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;

/// Below this distance of the tool axis from the primary axis (radians) the primary angle is kept: turning it would
/// move the tool axis by no more than this.
const POLE: f64 = 1e-11;

/// How far an angle may lie outside a limit by rounding alone, radians.
const SLACK: f64 = 1e-9;

/// A tool position: where the tip's centre is and where the tool points, in board coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// Centre of the tool tip, mm.
    pub tip: DVec3,
    /// Unit tool axis, from tip to spindle.
    pub axis: DVec3,
}

/// Why an orientation cannot be taken.
#[derive(Clone, Debug, PartialEq, thiserror::Error, Serialize, Deserialize)]
pub enum KinematicsError {
    /// Neither of the two solutions lies within the limits of an axis.
    #[error(
        "axis {letter} would have to stand at {angle:.3}°, but it turns from {min}° to {max}° only (tool axis {axis:?})"
    )]
    Limit {
        /// Letter of the axis that cannot turn as far.
        letter: char,
        /// Angle that it would need, degrees, for the solution nearest to the limits.
        angle: f64,
        /// Least angle, degrees.
        min: f64,
        /// Greatest angle, degrees.
        max: f64,
        /// The tool axis asked for.
        axis: [f64; 3],
    },
    /// The head cannot point there with any angles: its two axes are not square to each other and the tool.
    #[error("this head cannot point the tool along {axis:?} with any angles; it misses by {by:.3}°")]
    OutOfReach {
        /// The tool axis asked for.
        axis: [f64; 3],
        /// How far the nearest orientation is away, degrees.
        by: f64,
    },
    /// The tool axis has no direction.
    #[error("a tool axis must be a finite vector of length 1, not {axis:?}")]
    NotADirection {
        /// The tool axis given.
        axis: [f64; 3],
    },
}

/// `v` turned by `angle` about the unit vector `about`.
fn turned(v: DVec3, about: DVec3, angle: f64) -> DVec3 {
    let (s, c) = angle.sin_cos();
    about * (about.dot(v) * (1.0 - c)) + v * c + about.cross(v) * s
}

impl Machine {
    /// Unit tool axis (tip to spindle) for the programmed angles `[primary, secondary]`, radians. Constant cost.
    #[must_use]
    pub fn tool_axis(&self, angles: [f64; 2]) -> DVec3 {
        let (p, s) = (&self.primary, &self.secondary);
        turned(turned(DVec3::Z, s.about, s.sign * angles[1]), p.about, p.sign * angles[0])
    }

    /// Rotation of the head for the programmed angles, radians; it takes Z to [`Machine::tool_axis`].
    #[must_use]
    pub fn head(&self, angles: [f64; 2]) -> DQuat {
        let (p, s) = (&self.primary, &self.secondary);
        DQuat::from_axis_angle(p.about, p.sign * angles[0]) * DQuat::from_axis_angle(s.about, s.sign * angles[1])
    }

    /// Every pair of programmed angles (radians) within the limits that points the tool along the unit vector `axis`,
    /// the nearest to `previous` first; of two equally near ones that with the positive secondary angle. At the pole,
    /// where any primary angle serves, the primary stays at `previous`. Constant cost.
    ///
    /// # Errors
    /// A limit exceeded (names axis, angle, range), a direction that the head cannot take, or no direction at all.
    pub fn solutions(&self, axis: DVec3, previous: [f64; 2]) -> Result<Vec<[f64; 2]>, KinematicsError> {
        if !axis.is_finite() || (axis.length_squared() - 1.0).abs() > 1e-6 {
            return Err(KinematicsError::NotADirection { axis: axis.into() });
        }
        let v = axis.normalize();
        let (primary, secondary) = (&self.primary, &self.secondary);
        let (p, s) = (primary.about, secondary.about);
        // p · R(s, b) Z = along + β cos b + γ sin b must equal p · v. Differences of cosines near the poles are taken
        // from the sine of the small angle, because the cosine has lost half its digits there.
        let along = p.dot(s) * s.z;
        let (beta, gamma) = (p.z - along, p.dot(s.cross(DVec3::Z)));
        let reach = beta.hypot(gamma);
        let (cosine, sine_squared) = (p.dot(v), p.cross(v).length_squared());
        let to_pole = if cosine > 0.0 { sine_squared / (1.0 + cosine) } else { 1.0 - cosine };
        let to_antipole = if cosine < 0.0 { sine_squared / (1.0 - cosine) } else { 1.0 + cosine };
        let snapped = |x: f64| if x.abs() < 1e-12 { 0.0 } else { x };
        let below = snapped(reach + along - 1.0) + to_pole;
        let above = snapped(reach - along - 1.0) + to_antipole;
        if below < -1e-12 || above < -1e-12 {
            let nearest = (along + if below < 0.0 { reach } else { -reach }).clamp(-1.0, 1.0);
            let by = (nearest.acos() - cosine.clamp(-1.0, 1.0).acos()).abs().to_degrees();
            return Err(KinematicsError::OutOfReach { axis: axis.into(), by });
        }
        let half = (below.max(0.0) * above.max(0.0)).sqrt().atan2(cosine - along);
        let middle = gamma.atan2(beta);

        let mut found: Vec<[f64; 2]> = Vec::with_capacity(8);
        let mut refused: Option<(f64, KinematicsError)> = None;
        let mut refuse = |letter: char, angle: f64, min: f64, max: f64| {
            let beyond = (min - angle).max(angle - max);
            if refused.as_ref().is_none_or(|(least, _)| beyond < *least) {
                let axis = axis.into();
                refused = Some((beyond, KinematicsError::Limit { letter, angle, min, max, axis }));
            }
        };
        for b in [middle + half, middle - half] {
            let w = turned(DVec3::Z, s, b);
            let (w_side, v_side) = (w - p * p.dot(w), v - p * p.dot(v));
            let at_pole = v_side.length() < POLE || w_side.length() < POLE;
            let a = if at_pole {
                previous[0]
            } else {
                primary.sign * p.dot(w_side.cross(v_side)).atan2(w_side.dot(v_side))
            };
            let b_turns = turns_within(secondary.sign * b, secondary.min, secondary.max);
            let a_turns = turns_within(a, primary.min, primary.max);
            if b_turns.is_empty() {
                let angle = nearest_turn(secondary.sign * b, secondary.min, secondary.max);
                refuse(secondary.letter, angle.to_degrees(), secondary.min, secondary.max);
            } else if a_turns.is_empty() {
                let angle = nearest_turn(a, primary.min, primary.max);
                refuse(primary.letter, angle.to_degrees(), primary.min, primary.max);
            }
            for &b in &b_turns {
                if at_pole {
                    let (min, max) = (primary.min.to_radians(), primary.max.to_radians());
                    found.push([previous[0].clamp(min, max.max(min)), b]);
                } else {
                    found.extend(a_turns.iter().map(|&a| [a, b]));
                }
            }
        }
        if found.is_empty() {
            return Err(refused.map_or(KinematicsError::NotADirection { axis: axis.into() }, |(_, e)| e));
        }
        let travel = |q: &[f64; 2]| (q[0] - previous[0]).abs() + (q[1] - previous[1]).abs();
        // Rounded, so that twins at the same distance are told apart by sign and not by the last bit.
        let key = |q: &[f64; 2]| ((travel(q) * 1e9).round(), q[1] < 0.0, q[0].abs());
        found.sort_by(|x, y| key(x).partial_cmp(&key(y)).unwrap_or(std::cmp::Ordering::Equal));
        found.dedup();
        Ok(found)
    }

    /// The solution of [`Machine::solutions`] with the least travel.
    ///
    /// # Errors
    /// As there.
    pub fn angles(&self, axis: DVec3, previous: [f64; 2]) -> Result<[f64; 2], KinematicsError> {
        // `solutions` never returns an empty list.
        self.solutions(axis, previous).map(|found| found.first().copied().unwrap_or(previous))
    }

    /// Distance from the tool's tip to the point that the linear axes move: 0 with tip control, else tip to the
    /// crossing of the rotary axes, mm.
    #[must_use]
    pub fn reach_above_tip(&self, tool: &Tool) -> f64 {
        if self.tip_control { 0.0 } else { tool.gauge() + self.pivot }
    }

    /// The X, Y, Z to program for a pose, mm: the tip, or the pivot on a machine without tip control.
    #[must_use]
    pub fn programmed(&self, pose: Pose, tool: &Tool) -> DVec3 {
        pose.tip + pose.axis * self.reach_above_tip(tool)
    }

    /// The pose for programmed X, Y, Z (mm) and angles (radians): the inverse of [`Machine::programmed`].
    #[must_use]
    pub fn pose(&self, programmed: DVec3, angles: [f64; 2], tool: &Tool) -> Pose {
        let axis = self.tool_axis(angles);
        Pose { tip: programmed - axis * self.reach_above_tip(tool), axis }
    }
}

/// All `angle + k · 2π` within `min..=max` (degrees), in radians, ascending; an angle outside by rounding is put on the
/// limit.
fn turns_within(angle: f64, min: f64, max: f64) -> Vec<f64> {
    let (low, high) = (min.to_radians(), max.to_radians());
    let first = ((low - SLACK - angle) / TAU).ceil();
    let last = ((high + SLACK - angle) / TAU).floor();
    // A rotary axis without real limits is given as a few turns; more would only be further away.
    let (first, last) = (first.max(-1000.0), last.min(1000.0));
    (0..)
        .map(|k| first + f64::from(k))
        .take_while(|k| *k <= last)
        .map(|k| (angle + k * TAU).clamp(low, high.max(low)))
        .collect()
}

/// `angle + k · 2π` nearest to the range, for messages.
fn nearest_turn(angle: f64, min: f64, max: f64) -> f64 {
    let middle = 0.5 * (min + max).to_radians();
    angle - ((angle - middle) / TAU).round() * TAU
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Rotary;
    use crate::machine::test_machine;
    use proptest::prelude::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    fn table_head() -> Machine {
        let mut m = test_machine();
        m.primary = Rotary { letter: 'C', about: DVec3::Z, sign: 1.0, min: -360.0, max: 360.0 };
        m.secondary = Rotary { letter: 'B', about: DVec3::Y, sign: 1.0, min: -120.0, max: 120.0 };
        m
    }

    /// A head whose secondary axis leans 45°: it reaches the upper half only through combined turns.
    fn nutating() -> Machine {
        let mut m = table_head();
        m.secondary.about = DVec3::new(0.0, 0.5f64.sqrt(), 0.5f64.sqrt());
        m.secondary.min = -180.0;
        m.secondary.max = 180.0;
        m
    }

    fn unit(theta: f64, phi: f64) -> DVec3 {
        DVec3::new(theta.sin() * phi.cos(), theta.sin() * phi.sin(), theta.cos())
    }

    #[test]
    fn the_axis_of_the_thesis_machine_is_the_formula_of_the_thesis() {
        let m = test_machine();
        for (a, b) in [(0.3f64, 0.5f64), (2.5, 0.5), (-2.0, 0.7), (1.0, -0.4), (-0.2, -0.9)] {
            let v = DVec3::new(a.sin() * b.sin(), a.cos() * b.sin(), b.cos());
            assert!((m.tool_axis([a, b]) - v).length() < 1e-15);
        }
    }

    #[test]
    fn all_four_quadrants_and_both_poles_return() {
        for m in [test_machine(), table_head()] {
            for phi in [0.0, 0.8, FRAC_PI_2, 2.2, PI, -2.5, -1.0] {
                for theta in [0.0, 1e-13, 1e-10, 1e-8, 1e-5, 0.2, 1.0, FRAC_PI_2, 2.0] {
                    let v = unit(theta, phi);
                    for q in m.solutions(v, [0.4, 0.1]).unwrap() {
                        assert!((m.tool_axis(q) - v).length() < 1e-9, "{v} {q:?}");
                    }
                }
            }
        }
    }

    #[test]
    fn the_pole_keeps_the_primary() {
        let q = test_machine().angles(DVec3::Z, [1.25, 0.5]).unwrap();
        assert_eq!(q[0], 1.25);
        assert!(q[1].abs() < 1e-15);
    }

    #[test]
    fn the_nearer_twin_is_taken() {
        let m = test_machine();
        let v = m.tool_axis([0.1, 0.3]);
        let near = m.angles(v, [0.0, 0.2]).unwrap();
        assert!((near[0] - 0.1).abs() < 1e-12 && (near[1] - 0.3).abs() < 1e-12);
        let twin = m.angles(v, [3.2, -0.3]).unwrap();
        assert!((twin[0] - (0.1 + std::f64::consts::PI)).abs() < 1e-12 && (twin[1] + 0.3).abs() < 1e-12);
    }

    #[test]
    fn a_limit_names_axis_angle_and_range() {
        let mut m = test_machine();
        m.secondary.min = -30.0;
        m.secondary.max = 30.0;
        match m.angles(unit(40f64.to_radians(), 1.0), [0.0, 0.0]) {
            Err(KinematicsError::Limit { letter: 'B', angle, min, max, .. }) => {
                assert!((angle.abs() - 40.0).abs() < 1e-9);
                assert_eq!((min, max), (-30.0, 30.0));
            }
            other => panic!("{other:?}"),
        }
        let text = m.angles(unit(0.7, 1.0), [0.0, 0.0]).unwrap_err().to_string();
        assert!(text.contains("axis B") && text.contains("-30° to 30°"), "{text}");
    }

    #[test]
    fn a_leaning_head_refuses_what_it_cannot_reach() {
        let m = nutating();
        assert!(matches!(m.angles(-DVec3::Z, [0.0, 0.0]), Err(KinematicsError::OutOfReach { by, .. }) if by > 89.0));
        assert!(matches!(m.angles(DVec3::NAN, [0.0, 0.0]), Err(KinematicsError::NotADirection { .. })));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        #[test]
        fn forward_of_inverse_is_the_axis(theta in 0.0..2.09f64, phi in -3.2..3.2f64, a in -6.2..6.2f64, b in -2.0..2.0f64) {
            let v = unit(theta, phi);
            for m in [test_machine(), table_head()] {
                for q in m.solutions(v, [a, b]).unwrap() {
                    prop_assert!((m.tool_axis(q) - v).length() < 1e-9);
                    prop_assert!((m.head(q) * DVec3::Z - v).length() < 1e-9);
                    prop_assert!(q[0].to_degrees().abs() <= 360.0 + 1e-9 && q[1].to_degrees().abs() <= 120.0 + 1e-9);
                }
            }
            let upper = unit(theta.min(1.57), phi);
            for q in nutating().solutions(upper, [a, b]).unwrap() {
                prop_assert!((nutating().tool_axis(q) - upper).length() < 1e-9);
            }
        }

        #[test]
        fn programmed_and_pose_are_inverse(theta in 0.0..1.5f64, phi in -3.2..3.2f64, x in -100.0..100.0f64) {
            let mut m = test_machine();
            m.tip_control = false;
            m.pivot = 200.0;
            let tool = m.tools[0].clone();
            let axis = unit(theta, phi);
            let pose = Pose { tip: DVec3::new(x, 20.0, 5.0), axis };
            let q = m.angles(axis, [0.0, 0.0]).unwrap();
            let back = m.pose(m.programmed(pose, &tool), q, &tool);
            prop_assert!((back.tip - pose.tip).length() < 1e-9);
        }
    }
}
