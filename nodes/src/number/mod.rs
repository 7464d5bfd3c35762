//! Numbers: expression, remap, random, statistics.

mod expression;
mod random;
mod remap;
mod statistics;

use tenon_engine::NodeType;

/// Every node of this folder.
pub(crate) fn nodes() -> Vec<NodeType> {
    vec![expression::node(), remap::node(), random::node(), statistics::node()]
}
