//! The polygon mesh that every room shares: points and faces in compressed rows.

use crate::shared::Shared;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::fmt;

/// A polygon mesh. Face `f` is the loop `face_vertices[face_start[f]..face_start[f + 1]]`, counter-clockwise seen from
/// its front (right-hand rule).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Mesh {
    /// Vertex positions, mm.
    pub points: Shared<DVec3>,
    /// Where each face's loop starts; one longer than the number of faces, first entry 0.
    pub face_start: Shared<u32>,
    /// Vertex indices of all loops, one after the other.
    pub face_vertices: Shared<u32>,
    /// One address per face once the mesh is ordered; empty before.
    pub addresses: Shared<Address>,
}

/// A face's or panel's place in the structure (000 §6.2): row from the bottom, column from the left, both from 0.
/// A mesh of several grid patches counts them; a mesh that is no grid has `row = 0` and its face index as column.
#[derive(
    Clone,
    Copy,
    Debug,
    Default,
    PartialEq,
    Eq,
    Hash,
    PartialOrd,
    Ord,
    Serialize,
    Deserialize,
    bytemuck::Pod,
    bytemuck::Zeroable,
)]
#[repr(C)]
pub struct Address {
    /// Grid patch, 0 on a plain grid.
    pub patch: u32,
    /// Row.
    pub row: u32,
    /// Column.
    pub column: u32,
}

/// The address as engraved, drawn and listed: `row.column`, on later patches `patch-row.column`.
impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.patch > 0 {
            write!(f, "{}-", self.patch)?;
        }
        write!(f, "{}.{}", self.row, self.column)
    }
}

impl Mesh {
    /// A mesh of `points` and equal-sided faces.
    #[must_use]
    pub fn from_faces<const N: usize>(points: Vec<DVec3>, faces: &[[u32; N]]) -> Self {
        Self {
            points: points.into(),
            face_start: (0..=faces.len() as u32).map(|f| f * N as u32).collect(),
            face_vertices: faces.iter().flatten().copied().collect(),
            addresses: Shared::default(),
        }
    }

    /// Number of faces.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.face_start.len().saturating_sub(1)
    }

    /// Vertex indices of face `f`.
    #[must_use]
    pub fn face(&self, f: usize) -> &[u32] {
        &self.face_vertices[self.face_start[f] as usize..self.face_start[f + 1] as usize]
    }
}
