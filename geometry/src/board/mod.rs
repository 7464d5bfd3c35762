//! Boards: mapping parts to the machine plane, outlines, packing.

mod part;
pub use part::{Board, Layout, PartSet, Placement, Up};
