//! The panel set: a structure of arrays of n-gons (METHODS §5).
//!
//! A panel lies between its front face and the parallel back face at `thickness` behind it. Edge `k` of a panel runs from
//! front corner `k` to front corner `k + 1`; corner `k` lies between edge `k - 1` and edge `k`. On the back, edge `k` has
//! two ends of its own: where the end of edge `k - 1` and the start of edge `k` differ the node is voided and the triangle
//! (front corner, end of `k - 1`, start of `k`) is a node facet. All panels of a set are convex.

use crate::mesh::Address;
use crate::plane::Plane;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// One edge of one panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct EdgeRef {
    /// Panel index in the set.
    pub panel: u32,
    /// Edge index in the panel, from 0.
    pub edge: u32,
}

/// Which side of the ordered grid an edge faces; `Other` on meshes that are no grid.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, bytemuck::NoUninit, bytemuck::CheckedBitPattern,
)]
#[repr(u8)]
pub enum Side {
    /// v1 v2.
    Bottom,
    /// v2 v3.
    Right,
    /// v3 v4.
    Top,
    /// v4 v1.
    Left,
    /// Not a quad of an ordered grid.
    Other,
}

/// Panels as columns. `corner_start` has one entry more than there are panels; every per-corner (equally per-edge)
/// column is indexed by `corner_start[panel] + k`. A panel that could not be made has no corners and stays at its index.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PanelSet {
    /// Thickness of every panel, mm.
    pub thickness: f64,
    /// Address per panel.
    pub address: Vec<Address>,
    /// Unit normal of the front face per panel, pointing away from the wood.
    pub normal: Vec<DVec3>,
    /// First corner of each panel; length = panels + 1.
    pub corner_start: Vec<u32>,
    /// Front corners, counter-clockwise seen from the front, mm.
    pub front: Vec<DVec3>,
    /// Mesh vertex of each front corner.
    pub vertex: Vec<u32>,
    /// Chamfer plane of each edge, normal pointing away from the wood.
    pub chamfer: Vec<Plane>,
    /// The panel edge across each edge; `None` on the border and beside a panel that could not be made.
    pub neighbour: Vec<Option<EdgeRef>>,
    /// Grid side of each edge.
    pub side: Vec<Side>,
    /// On the back, where edge `k` starts (beside corner `k`), mm.
    pub back_start: Vec<DVec3>,
    /// On the back, where edge `k` ends (beside corner `k + 1`), mm.
    pub back_end: Vec<DVec3>,
    /// Whether corner `k` is voided: its node facet is (front k, back_end k-1, back_start k).
    pub voided: Vec<bool>,
}

impl PanelSet {
    /// Number of panels, failed ones included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.corner_start.len().saturating_sub(1)
    }

    /// Whether the set has no panels.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Range of the corner and edge columns that belongs to panel `i`; empty for a failed panel.
    #[must_use]
    pub fn corners(&self, i: usize) -> std::ops::Range<usize> {
        self.corner_start[i] as usize..self.corner_start[i + 1] as usize
    }

    /// Whether panel `i` could be made.
    #[must_use]
    pub fn is_valid(&self, i: usize) -> bool {
        !self.corners(i).is_empty()
    }
}
