//! Whole chains through the nodes.

mod bad_input;
mod common;
mod registry;
mod same_bytes;
