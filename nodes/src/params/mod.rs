//! Parameters and plumbing: values that people set, lists, ranges.

mod canvas;
mod chosen;
mod list;
mod primitive;
mod spatial;

pub(crate) use list::{LONGEST, numbers};
use tenon_engine::NodeType;

/// Every node of this folder.
pub(crate) fn nodes() -> Vec<NodeType> {
    [primitive::nodes(), chosen::nodes(), spatial::nodes(), list::nodes(), canvas::nodes()]
        .into_iter()
        .flatten()
        .collect()
}
