//! Nodes that make panels.

mod thicken;

use tenon_engine::NodeType;

pub(crate) fn nodes() -> Vec<NodeType> {
    vec![thicken::node()]
}
