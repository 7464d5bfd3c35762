//! Nodes between panels and boards.

mod map;
mod pack;

use tenon_engine::NodeType;

pub(crate) fn nodes() -> Vec<NodeType> {
    vec![map::node(), pack::node()]
}
