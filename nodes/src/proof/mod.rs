//! Nodes that prove programs.

mod prove;

use tenon_engine::NodeType;

pub(crate) fn nodes() -> Vec<NodeType> {
    vec![prove::node()]
}
