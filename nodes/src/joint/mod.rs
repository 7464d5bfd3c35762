//! Nodes for joints.

pub(crate) mod detail;
mod laid;

use tenon_engine::NodeType;

pub(crate) fn nodes() -> Vec<NodeType> {
    vec![detail::node()]
}
