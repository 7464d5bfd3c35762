//! Texts.

mod format;
mod template;

use tenon_engine::NodeType;

/// Every node of this folder.
pub(crate) fn nodes() -> Vec<NodeType> {
    vec![format::node()]
}
