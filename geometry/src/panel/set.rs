//! The panel set: a structure of arrays of n-gons (METHODS §5).
//!
//! A panel lies between its front face and the parallel back face at `thickness` behind it. Edge `k` of a panel runs from
//! front corner `k` to front corner `k + 1`; corner `k` lies between edge `k - 1` and edge `k`. On the back, edge `k` has
//! two ends of its own: where the end of edge `k - 1` and the start of edge `k` differ the node is voided and the triangle
//! (front corner, end of `k - 1`, start of `k`) is a node facet. All panels of a set are convex.

use crate::mesh::Address;
use crate::plane::Plane;
use crate::shared::Shared;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// One edge of one panel.
#[derive(
    Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, bytemuck::Pod, bytemuck::Zeroable,
)]
#[repr(C)]
pub struct EdgeRef {
    /// Panel index in the set.
    pub panel: u32,
    /// Edge index in the panel, from 0.
    pub edge: u32,
}

/// The edge across an edge, or none, in the form in which programs outside read it: both numbers `u32::MAX` for none.
#[derive(Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize, bytemuck::Pod, bytemuck::Zeroable)]
#[serde(from = "Option<EdgeRef>", into = "Option<EdgeRef>")]
#[repr(transparent)]
pub struct Neighbour(EdgeRef);

impl Neighbour {
    /// The border, or a panel that could not be made.
    pub const NONE: Self = Self(EdgeRef { panel: u32::MAX, edge: u32::MAX });

    /// The edge across, if there is one.
    #[must_use]
    pub fn get(self) -> Option<EdgeRef> {
        (self != Self::NONE).then_some(self.0)
    }
}

impl From<Option<EdgeRef>> for Neighbour {
    fn from(edge: Option<EdgeRef>) -> Self {
        edge.map_or(Self::NONE, Self)
    }
}

impl From<Neighbour> for Option<EdgeRef> {
    fn from(neighbour: Neighbour) -> Self {
        neighbour.get()
    }
}

impl std::fmt::Debug for Neighbour {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.get().fmt(f)
    }
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
    pub address: Shared<Address>,
    /// Unit normal of the front face per panel, pointing away from the wood.
    pub normal: Shared<DVec3>,
    /// First corner of each panel; length = panels + 1.
    pub corner_start: Shared<u32>,
    /// Front corners, counter-clockwise seen from the front, mm.
    pub front: Shared<DVec3>,
    /// Mesh vertex of each front corner.
    pub vertex: Shared<u32>,
    /// Chamfer plane of each edge, normal pointing away from the wood.
    pub chamfer: Shared<Plane>,
    /// The panel edge across each edge; none on the border and beside a panel that could not be made.
    pub neighbour: Shared<Neighbour>,
    /// Grid side of each edge.
    pub side: Shared<Side>,
    /// On the back, where edge `k` starts (beside corner `k`), mm.
    pub back_start: Shared<DVec3>,
    /// On the back, where edge `k` ends (beside corner `k + 1`), mm.
    pub back_end: Shared<DVec3>,
    /// Whether corner `k` is voided: its node facet is (front k, back_end k-1, back_start k).
    pub voided: Shared<bool>,
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
