//! Border conditions: how the edges without a neighbour are cut (000 §6.3.2).

use super::set::Side;
use glam::DVec3;

/// How one border edge is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BorderCut {
    /// Perpendicular to the front face.
    Square,
    /// In a limit plane of the given normal (any length): the cut contains the edge and lies in the limit plane
    /// whenever the edge does. A support has its own normal, a wall the wall's.
    InPlane {
        /// Normal of the limit plane.
        normal: DVec3,
    },
    /// Leaning from square by an angle in radians, within ±π/2; positive cuts wood away, so that the back edge lies
    /// `thickness · tan(angle)` further in than the front edge.
    Angle(f64),
}

/// One border edge with a cut of its own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EdgeCut {
    /// Mesh face.
    pub face: u32,
    /// Edge of that face, from 0.
    pub edge: u32,
    /// Its cut.
    pub cut: BorderCut,
}

/// The cut of every border edge: one per side of the ordered grid, with exceptions.
#[derive(Clone, Debug, PartialEq)]
pub struct BorderRule {
    /// Edges v1 v2.
    pub bottom: BorderCut,
    /// Edges v2 v3.
    pub right: BorderCut,
    /// Edges v3 v4.
    pub top: BorderCut,
    /// Edges v4 v1.
    pub left: BorderCut,
    /// Edges on meshes that are no grid.
    pub other: BorderCut,
    /// Exceptions; a later one overrides an earlier one.
    pub edges: Vec<EdgeCut>,
}

impl BorderRule {
    /// The same cut everywhere.
    #[must_use]
    pub fn all(cut: BorderCut) -> Self {
        Self { bottom: cut, right: cut, top: cut, left: cut, other: cut, edges: Vec::new() }
    }

    /// The cut of a side.
    #[must_use]
    pub fn side(&self, side: Side) -> BorderCut {
        match side {
            Side::Bottom => self.bottom,
            Side::Right => self.right,
            Side::Top => self.top,
            Side::Left => self.left,
            Side::Other => self.other,
        }
    }
}

impl Default for BorderRule {
    fn default() -> Self {
        Self::all(BorderCut::Square)
    }
}
