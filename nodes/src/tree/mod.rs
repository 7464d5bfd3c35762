//! Lists and trees of items of any type: pick, order, reshape, and take apart what a value holds.

mod explode;
mod list;
mod pair;
mod shape;
mod table;

use tenon_engine::NodeType;

/// Every node of this folder.
pub(crate) fn nodes() -> Vec<NodeType> {
    [list::nodes(), pair::nodes(), shape::nodes(), explode::nodes(), table::nodes()].into_iter().flatten().collect()
}
