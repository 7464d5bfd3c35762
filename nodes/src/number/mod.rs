//! Numbers: remap, random, statistics.

mod random;
mod remap;
mod statistics;

use tenon_engine::NodeType;

/// Every node of this folder.
pub(crate) fn nodes() -> Vec<NodeType> {
    vec![remap::node(), random::node(), statistics::node()]
}
