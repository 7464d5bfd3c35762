//! Tool paths as columns: poses of the tool tip in board coordinates, grouped into operations.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::ops::Range;

/// What a move does; it fixes the feed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum MoveKind {
    /// At full speed, clear of everything.
    Rapid,
    /// From the safe height down to the material.
    Approach,
    /// Into the material.
    Plunge,
    /// Through the material.
    Cut,
    /// Out of the material.
    Lift,
}

/// What an operation is for; boards are machined in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Purpose {
    /// Holes by which parts are screwed to the table.
    Fixing,
    /// Addresses.
    Engraving,
    /// Holes for fasteners.
    Drilling,
    /// Chamfers and node facets.
    Contour,
}

/// A run of moves with one tool on one part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Operation {
    /// What for.
    pub purpose: Purpose,
    /// Board number.
    pub board: u32,
    /// Part index.
    pub part: u32,
    /// Index into `Machine::tools`.
    pub tool: u32,
    /// Range of the move columns.
    pub moves: Range<u32>,
}

/// Moves as columns; move `k` goes in a straight line, axis turning evenly, from pose `k - 1` to pose `k`. The first
/// move of an operation is a rapid at the safe height.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ToolPaths {
    /// Operations, ordered by board, purpose, tool, part.
    pub operations: Vec<Operation>,
    /// Kind per move.
    pub kind: Vec<MoveKind>,
    /// Tool tip centre at the end of each move, board frame, mm.
    pub tip: Vec<DVec3>,
    /// Unit tool axis at the end of each move, from tip to spindle.
    pub axis: Vec<DVec3>,
    /// Feed per move, mm/min; 0 for rapids.
    pub feed: Vec<f64>,
}
