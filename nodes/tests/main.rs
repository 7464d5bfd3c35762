//! Whole chains through the nodes.

mod registry;
