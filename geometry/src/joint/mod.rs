//! Joints: machining features, fasteners along edges, hardware, reach.

mod cover;
mod edges;
mod fastener;
mod feature;
mod issue;
mod reach;
mod rule;
#[cfg(test)]
mod tests;

pub use edges::{JointEdge, Misplaced, select_edges, take_misplaced};
pub use fastener::{DOWEL_LENGTHS, SCREW_LENGTHS, lay_all, lay_edges, lay_fasteners};
pub use feature::{Feature, FeatureSet, Hardware, Machining};
pub use issue::{FastenerError, JointIssue};
pub use reach::{OutOfReach, ReachError, ReachIssue, ReachRule, check_reach, reach, reach_with};
pub use rule::{
    Direction, EdgeSelection, Fastener, FastenerRule, Head, Height, Pin, PinKind, ShortEdge, Toe, ToeLength,
};
