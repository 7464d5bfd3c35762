//! Moving subdivision points: from places in space to columns (000 §4.1).

use super::error::SchemeError;
use super::least_norm::PseudoInverse;
use super::scheme::{Scheme, Tie, combine};
use glam::{DVec3, DVec4, Vec4Swizzles};

/// Rounding of a point's coordinates by homogeneous conversion and one sum, relative.
const ROUNDING: f64 = 16.0 * f64::EPSILON;
/// Singular values below this fraction of the largest are noise.
const NOISE: f64 = 1e-12;

/// A subdivision point and where it shall go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// Number of the point, from 0: `i · m + a` is the image of control point `a` under transformation `i`.
    pub point: usize,
    /// Its place, mm.
    pub position: DVec3,
    /// Its weight; `None` keeps the one that the scheme gives it.
    pub weight: Option<f64>,
}

/// A move that has been checked.
struct Target {
    point: usize,
    position: DVec3,
    weight: f64,
    /// How far the point has to go, mm; 0 when it is there, to rounding.
    distance: f64,
    moves: bool,
}

impl Scheme {
    /// The scheme whose subdivision points lie where `moves` says, on the given control points. Each moved point's
    /// column is the scheme's own (the reference) plus the correction of least norm, and is written to every point
    /// tied to it. A point sent to where it is (to rounding) is left alone and follows its ties. A point sent to the
    /// very place and weight of another in the list takes that one's column: so a figure in pieces is joined
    /// (000 §5.1.2). Control points that are flat to `tolerance` mm count as flat. O(moves · (moves + m + points)).
    ///
    /// # Errors
    /// [`SchemeError`]: wrong number of control points, NaN or infinity, a point that is a control point, tied points
    /// sent apart by more than `tolerance`, a place that no column reaches within `tolerance`.
    pub fn moved(&self, control: &[DVec4], moves: &[Move], tolerance: f64) -> Result<Self, SchemeError> {
        if control.len() != self.m {
            return Err(SchemeError::ControlCount { given: control.len(), needed: self.m });
        }
        if let Some(at) = control.iter().position(|p| !p.is_finite()) {
            return Err(SchemeError::ControlNotFinite { control: at });
        }
        let targets = moves.iter().map(|m| self.target(control, m)).collect::<Result<Vec<_>, _>>()?;
        let mut result = self.clone();
        let mut moved_by: Vec<Option<usize>> = vec![None; self.windows.len()];
        for (at, target) in targets.iter().enumerate().filter(|(_, t)| t.moves) {
            let (class, shift) = match self.ties[target.point] {
                Tie::Class { class, shift } => (class, shift),
                Tie::Control(_) if target.distance <= tolerance => continue,
                Tie::Control(control) => {
                    let (point, control) = (target.point, control as usize);
                    return Err(SchemeError::Fixed { point, control, distance: target.distance });
                }
            };
            if let Some(first) = moved_by[class as usize] {
                let there = combine(control, result.column(target.point));
                let distance = target.position.distance(there.xyz() / there.w);
                if distance <= tolerance {
                    continue;
                }
                return Err(SchemeError::TiedApart { a: first, b: target.point, distance });
            }
            let window = self.windows[class as usize];
            let start = (window.start + shift) as usize;
            let rows = start..start + window.len as usize;
            let settled = |(i, t): &(usize, &Target)| {
                (*i < at || !t.moves) && t.position == target.position && t.weight == target.weight
            };
            let mask = match targets.iter().enumerate().find(settled) {
                Some((_, other)) if rows == (0..self.m) => result.column(other.point).to_vec(),
                _ => reach(&control[rows.clone()], &self.column(target.point)[rows], target, tolerance)?,
            };
            for (p, tie) in self.ties.iter().enumerate() {
                if let Tie::Class { class: c, shift } = *tie
                    && c == class
                {
                    let at = p * self.m + (window.start + shift) as usize;
                    result.columns[p * self.m..(p + 1) * self.m].fill(0.0);
                    result.columns[at..at + mask.len()].copy_from_slice(&mask);
                }
            }
            moved_by[class as usize] = Some(target.point);
        }
        Ok(result)
    }

    fn target(&self, control: &[DVec4], &Move { point, position, weight }: &Move) -> Result<Target, SchemeError> {
        self.check_point(point)?;
        let here = combine(control, self.column(point));
        let weight = weight.unwrap_or(here.w);
        if !(position.is_finite() && weight.is_finite()) {
            return Err(SchemeError::PointNotFinite { point });
        }
        if weight <= 0.0 {
            return Err(SchemeError::PointWeight { point, weight });
        }
        let size = control.iter().filter(|p| p.w != 0.0).map(|p| (p.xyz() / p.w).abs().max_element());
        let size = size.fold(position.abs().max_element(), f64::max);
        let distance = position.distance(here.xyz() / here.w);
        let moves = !(distance <= ROUNDING * size && (weight - here.w).abs() <= ROUNDING * weight);
        Ok(Target { point, position, weight, distance, moves })
    }
}

/// The column nearest to `reference` that puts the target's point with its weight at its position.
fn reach(control: &[DVec4], reference: &[f64], target: &Target, tolerance: f64) -> Result<Vec<f64>, SchemeError> {
    // Rows are centred and scaled, which leaves the solution as it is and makes singular values comparable.
    let sum = control.iter().copied().fold(DVec4::ZERO, |s, p| s + p);
    let centre = if sum.w == 0.0 { DVec3::ZERO } else { sum.xyz() / sum.w };
    let offset = |p: &DVec4| p.xyz() - centre * p.w;
    let size = control.iter().map(|p| offset(p).length()).fold(0.0, f64::max);
    let size = if size > 0.0 { size } else { 1.0 };
    let rows: Vec<DVec4> = control.iter().map(|p| (offset(p) / size).extend(p.w)).collect();
    let right = ((target.position - centre) * target.weight / size).extend(target.weight);
    let inverse = PseudoInverse::new(&rows, (tolerance / size).max(NOISE));
    let mut column = reference.to_vec();
    // The second round takes out the rounding of the first.
    for _ in 0..2 {
        let correction = inverse.solve(right - combine(&rows, &column));
        column.iter_mut().zip(correction).for_each(|(c, d)| *c += d);
    }
    let there = combine(control, &column);
    let nearest = there.xyz() / there.w;
    let residual = nearest.distance(target.position);
    if residual <= tolerance && column.iter().all(|c| c.is_finite()) {
        Ok(column)
    } else {
        Err(SchemeError::Unreachable { point: target.point, residual, nearest })
    }
}
