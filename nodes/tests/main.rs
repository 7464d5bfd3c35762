//! Whole chains through the nodes.

mod bad_input;
mod chain;
mod common;
mod corpus;
mod examples;
mod expression;
mod fasteners;
#[path = "../../fuzz/src/lib.rs"]
mod fuzz;
mod graphs;
mod kept;
mod order;
mod polygons;
mod registry;
mod same_bytes;
mod trees;
