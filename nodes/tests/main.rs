//! Whole chains through the nodes.

mod bad_input;
mod chain;
mod common;
mod expression;
mod graphs;
mod order;
mod registry;
mod same_bytes;
mod trees;
