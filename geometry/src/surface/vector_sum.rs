//! Vector-sum surfaces (000 §4.3): one curve carried along another, planar quads all.

use super::error::SurfaceError;
use super::grid::Grid;
use crate::ifs::Curve;
use crate::mesh::Mesh;
use glam::{DVec3, DVec4};

/// The surface `M_ij = A_i + B_j − c` in R⁴, `c = (x, y, z, 1)`, projected last (000 §4.3.2): a parallelogram per pair of
/// segments where all weights are 1, a planar quad wherever `W_A + W_B − 1 > 0`.
///
/// Column = index on A, row = index on B; faces are counter-clockwise, their right-hand normal is dA × dB. A closed curve
/// closes the mesh without duplicate vertices. O(|A| · |B|) time and memory; one pass of one addition and one division
/// per vertex. `progress` gets the fraction done and returns false to cancel.
///
/// # Errors
/// [`SurfaceError::Disconnected`], [`SurfaceError::TooShort`], [`SurfaceError::Weight`] with the pair of points whose
/// weights sum lowest, [`SurfaceError::NotFinite`], [`SurfaceError::TooManyVertices`], [`SurfaceError::Cancelled`].
pub fn vector_sum(
    a: &Curve,
    b: &Curve,
    centre: DVec3,
    progress: &(dyn Fn(f64) -> bool + Sync),
) -> Result<Mesh, SurfaceError> {
    for (name, curve) in [('A', a), ('B', b)] {
        if curve.strip_count() > 1 {
            return Err(SurfaceError::Disconnected { curve: name, strips: curve.strip_count() });
        }
    }
    let grid = Grid { columns: a.points.len(), rows: b.points.len(), closed_a: a.closed, closed_b: b.closed };
    grid.check()?;
    let (i, j) = (lightest(&a.points), lightest(&b.points));
    let weight = a.points[i].w + b.points[j].w - 1.0;
    if weight.is_nan() || weight <= 0.0 {
        return Err(SurfaceError::Weight { a: i, b: j, weight });
    }
    if !centre.is_finite() {
        return Err(SurfaceError::NotFinite { what: "the centre of the vector sum" });
    }
    let largest = |points: &[DVec4]| points.iter().fold(0.0_f64, |m, p| m.max(p.abs().max_element()));
    if !((largest(&a.points) + largest(&b.points) + centre.abs().max_element()) / weight).is_finite() {
        return Err(SurfaceError::NotFinite { what: "a vertex of the vector sum" });
    }
    let centre = centre.extend(1.0);
    let shifted: Vec<DVec4> = b.points.iter().map(|p| *p - centre).collect();
    grid.mesh(|i, j| a.points[i] + shifted[j], progress)
}

/// Index of the point with the least weight, the first of several.
fn lightest(points: &[DVec4]) -> usize {
    let mut least = 0;
    for (i, p) in points.iter().enumerate() {
        if p.w < points[least].w {
            least = i;
        }
    }
    least
}
