//! Nodes for joints.

pub(crate) mod detail;

use tenon_engine::NodeType;

pub(crate) fn nodes() -> Vec<NodeType> {
    vec![detail::node()]
}
