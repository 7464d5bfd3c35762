//! From points and weights to control polygons in homogeneous coordinates.

use super::error::CurveError;
use glam::{DVec3, DVec4};

/// The homogeneous point (WX, WY, WZ, W) of a point with a weight (000 §4.3.2).
#[must_use]
pub fn homogeneous(point: DVec3, weight: f64) -> DVec4 {
    (point * weight).extend(weight)
}

/// Divides a row of control points into patches of `m` points, of which neighbours share `shared`: 1 where patches meet
/// end to end, m − 1 for uniform B-splines. A `closed` row continues with its first points. O(points · m / (m − shared)).
///
/// # Errors
/// [`CurveError::Shared`] when `shared ≥ m`; [`CurveError::NoWholePatches`] with the next number that works.
pub fn patches(points: &[DVec4], m: usize, shared: usize, closed: bool) -> Result<Vec<Vec<DVec4>>, CurveError> {
    let count = patch_count(points.len(), m, shared, closed)?;
    let step = m - shared;
    Ok((0..count).map(|p| (0..m).map(|a| points[(p * step + a) % points.len()]).collect()).collect())
}

/// Number of patches in a row of `given` control points.
pub(crate) fn patch_count(given: usize, m: usize, shared: usize, closed: bool) -> Result<usize, CurveError> {
    if shared >= m {
        return Err(CurveError::Shared { m, shared });
    }
    if given == 0 {
        return Err(CurveError::Empty);
    }
    let step = m - shared;
    let fixed = if closed { 0 } else { shared };
    // A closed row must be long enough that no patch meets itself.
    let least = if closed { m.next_multiple_of(step) } else { m };
    if given < least || !(given - fixed).is_multiple_of(step) {
        let fitting = if given < least { least } else { (given - fixed).next_multiple_of(step) + fixed };
        return Err(CurveError::NoWholePatches { given, m, shared, fitting });
    }
    Ok((given - fixed) / step)
}
