//! Nodes that describe the machine and how it is used.

mod file;
mod machining;

use tenon_engine::NodeType;

pub(crate) fn nodes() -> Vec<NodeType> {
    vec![file::node(), machining::node()]
}
