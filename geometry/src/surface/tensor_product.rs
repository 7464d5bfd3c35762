//! Tensor-product surfaces (000 §5.4.1): a grid of control points, subdivided by one scheme per direction.

use super::error::SurfaceError;
use super::grid::Grid;
use crate::ifs::{Basis, Continuity, Scheme, check_count, patch_count};
use crate::mesh::Mesh;
use glam::{DVec3, DVec4};
use rayon::prelude::*;

/// How far the columns of two patches may differ where they meet, by rounding.
const ROUNDING: f64 = 1e-12;

/// One direction of a tensor product.
#[derive(Clone, Copy, Debug)]
pub struct Direction<'a> {
    /// The scheme.
    pub scheme: &'a Scheme,
    /// Iterations.
    pub iterations: u32,
    /// Control points that neighbouring patches share: 1, or m − 1 for uniform B-splines.
    pub shared: usize,
    /// Whether the control points go round: the last patch ends with the first points.
    pub closed: bool,
}

/// The surface with control grid `grid`, row by row, `columns` points per row (along A; homogeneous points
/// (WX, WY, WZ, W)), subdivided by `T_ij = T_i^A ⊗ T_j^B`: first every row by A's scheme, then every column by B's, each
/// with its own number of iterations. A direction with more control points than its scheme has is a chain of patches.
///
/// Column = index along A, row = index along B; faces are counter-clockwise, their right-hand normal is dA × dB. Closed
/// directions close the mesh without duplicate vertices. O(m_A · rows · N_A + m_B · N_A · N_B) time, O(N_A · N_B) memory.
/// `progress` gets the fraction done and returns false to cancel.
///
/// # Errors
/// [`SurfaceError`]: grid size, NaN or infinity, a scheme whose figure is not connected, patches that do not meet, a
/// vertex with W ≤ 0 (named), too many vertices, cancelled.
pub fn tensor_product(
    grid: &[DVec4],
    columns: usize,
    a: Direction,
    b: Direction,
    progress: &(dyn Fn(f64) -> bool + Sync),
) -> Result<Mesh, SurfaceError> {
    if columns == 0 || grid.is_empty() || !grid.len().is_multiple_of(columns) {
        let rows = if columns == 0 { 0 } else { grid.len().div_ceil(columns) };
        return Err(SurfaceError::GridSize { given: grid.len(), rows, columns });
    }
    if !grid.iter().all(|p| p.is_finite()) {
        return Err(SurfaceError::NotFinite { what: "a point of the control grid" });
    }
    let rows = grid.len() / columns;
    let along_a = Line::new(a, columns, 'A')?;
    let along_b = Line::new(b, rows, 'B')?;
    let size = Grid { columns: along_a.points, rows: along_b.points, closed_a: a.closed, closed_b: b.closed };
    size.check()?;
    let mut ribs = Vec::with_capacity(rows * along_a.points);
    for row in grid.chunks_exact(columns) {
        ribs.par_extend(
            (0..along_a.points).into_par_iter().with_min_len(1 << 12).map(|i| along_a.point(i, |c| row[c])),
        );
    }
    let point = |i: usize, j: usize| along_b.point(j, |r| ribs[r * along_a.points + i]);
    let mesh = size.mesh(point, progress)?;
    // A vertex with W ≤ 0 may still project to finite numbers, so weights are looked at on their own.
    let bad = (0..mesh.points.len()).into_par_iter().with_min_len(1 << 12).find_first(|&v| {
        let w = along_b.weight(v / along_a.points, |r| ribs[r * along_a.points + v % along_a.points].w);
        w.is_nan() || w <= 0.0 || !mesh.points[v].is_finite()
    });
    match bad {
        None => Ok(mesh),
        Some(v) => {
            let (i, j) = (v % along_a.points, v / along_a.points);
            Err(SurfaceError::Weight { a: i, b: j, weight: point(i, j).w })
        }
    }
}

/// The control grid of a vector sum, `p_ij = c + (p_i^A − c) + (p_j^B − c)` in R⁴ (000 §5.4.1): one row per point of `b`.
/// O(|a| · |b|).
#[must_use]
pub fn vector_sum_grid(a: &[DVec4], b: &[DVec4], centre: DVec3) -> Vec<DVec4> {
    let c = centre.extend(1.0);
    b.iter().flat_map(|q| a.iter().map(move |p| *p + (*q - c))).collect()
}

/// The points along one direction as combinations of the control points.
struct Line {
    basis: Basis,
    m: usize,
    /// Control points in this direction.
    control: usize,
    /// Control points from one patch to the next.
    step: usize,
    /// Points that each patch adds.
    stride: usize,
    patches: usize,
    /// Number of points.
    points: usize,
}

impl Line {
    fn new(direction: Direction, control: usize, name: char) -> Result<Self, SurfaceError> {
        let Direction { scheme, iterations, shared, closed } = direction;
        let m = scheme.control_count();
        let wrong = |source| SurfaceError::Direction { direction: name, source };
        let patches = patch_count(control, m, shared, closed).map_err(wrong)?;
        check_count(scheme, patches, iterations).map_err(wrong)?;
        let continuity = Continuity::of(scheme, iterations);
        if !continuity.connected() {
            return Err(SurfaceError::Disconnected { curve: name, strips: continuity.strip_count() });
        }
        let basis = Basis::new(scheme, &continuity, iterations, true);
        let (step, stride) = (m - shared, basis.points - 1);
        if patches > 1 || closed {
            let entry = |column: &[f64], row: usize, from: usize| {
                row.checked_sub(from).and_then(|r| column.get(r)).copied().unwrap_or(0.0)
            };
            let (end, start) = (basis.column(m, stride), basis.column(m, 0));
            let meet = (0..m + step).all(|r| {
                let (e, s) = (entry(end, r, 0), entry(start, r, step));
                (e - s).abs() <= ROUNDING * e.abs().max(1.0)
            });
            if !meet {
                return Err(SurfaceError::PatchesApart { direction: name, shared });
            }
        }
        Ok(Self { basis, m, control, step, stride, patches, points: patches * stride + usize::from(!closed) })
    }

    /// First control point and column of point `i`.
    #[inline]
    fn at(&self, i: usize) -> (usize, &[f64]) {
        let patch = (i / self.stride).min(self.patches - 1);
        (patch * self.step, self.basis.column(self.m, i - patch * self.stride))
    }

    #[inline]
    fn point(&self, i: usize, control: impl Fn(usize) -> DVec4) -> DVec4 {
        let (first, column) = self.at(i);
        let wrapped = |r: usize| if r < self.control { r } else { r - self.control };
        column.iter().enumerate().fold(DVec4::ZERO, |sum, (r, &c)| sum + control(wrapped(first + r)) * c)
    }

    #[inline]
    fn weight(&self, i: usize, control: impl Fn(usize) -> f64) -> f64 {
        let (first, column) = self.at(i);
        let wrapped = |r: usize| if r < self.control { r } else { r - self.control };
        column.iter().enumerate().fold(0.0, |sum, (r, &c)| sum + control(wrapped(first + r)) * c)
    }
}
