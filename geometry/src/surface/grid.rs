//! A grid of vertices as a mesh: loops, addresses, closed directions.

use super::error::SurfaceError;
use crate::mesh::{Address, Mesh};
use glam::{DVec3, DVec4, Vec4Swizzles};
use rayon::prelude::*;

/// Most vertices of one surface: 2²⁶.
const MAX_VERTICES: usize = 1 << 26;
/// Vertices between two looks at the caller's wish to stop.
const SLAB: usize = 1 << 18;
/// Least vertices or faces per thread.
const GRAIN: usize = 1 << 13;

/// Size and topology of a grid: `columns` vertices along A, `rows` along B.
#[derive(Clone, Copy)]
pub(super) struct Grid {
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) closed_a: bool,
    pub(super) closed_b: bool,
}

impl Grid {
    pub(super) fn check(&self) -> Result<(), SurfaceError> {
        for (curve, points, closed) in [('A', self.columns, self.closed_a), ('B', self.rows, self.closed_b)] {
            if points < if closed { 3 } else { 2 } {
                return Err(SurfaceError::TooShort { curve, points });
            }
        }
        match self.columns.checked_mul(self.rows) {
            Some(vertices) if vertices <= MAX_VERTICES => Ok(()),
            vertices => {
                let vertices = vertices.unwrap_or(usize::MAX);
                Err(SurfaceError::TooManyVertices { vertices, limit: MAX_VERTICES })
            }
        }
    }

    /// The mesh of the vertices `point(a, b)`, projected; their weights must be positive. Vertex (a, b) has the index
    /// `b · columns + a`; the face between a, a + 1 and b, b + 1 is at row b, column a, its loop (a, b), (a + 1, b),
    /// (a + 1, b + 1), (a, b + 1). O(vertices).
    pub(super) fn mesh(
        &self,
        point: impl Fn(usize, usize) -> DVec4 + Sync,
        progress: &(dyn Fn(f64) -> bool + Sync),
    ) -> Result<Mesh, SurfaceError> {
        let (columns, vertices) = (self.columns as u32, self.columns * self.rows);
        let mut points: Vec<DVec3> = Vec::with_capacity(vertices);
        for start in (0..vertices).step_by(SLAB) {
            if !progress(start as f64 / vertices as f64) {
                return Err(SurfaceError::Cancelled);
            }
            let slab = start as u32..vertices.min(start + SLAB) as u32;
            points.par_extend(slab.into_par_iter().with_min_len(GRAIN).map(|v| {
                let p = point((v % columns) as usize, (v / columns) as usize);
                p.xyz() / p.w
            }));
        }
        let across = columns - u32::from(!self.closed_a);
        let along = self.rows as u32 - u32::from(!self.closed_b);
        let faces = across * along;
        let indexed = || (0..faces).into_par_iter().with_min_len(GRAIN);
        let loops: Vec<[u32; 4]> = indexed()
            .map(|f| {
                let (a, b) = (f % across, f / across);
                let right = if a + 1 == columns { 0 } else { a + 1 };
                let low = b * columns;
                let high = if b as usize + 1 == self.rows { 0 } else { low + columns };
                [low + a, low + right, high + right, high + a]
            })
            .collect();
        Ok(Mesh {
            points: points.into(),
            face_start: (0..faces + 1).into_par_iter().with_min_len(GRAIN).map(|f| f * 4).collect::<Vec<_>>().into(),
            face_vertices: loops.into_flattened().into(),
            addresses: indexed()
                .map(|f| Address { patch: 0, row: f / across, column: f % across })
                .collect::<Vec<_>>()
                .into(),
        })
    }
}
