//! Panels around the canvas: what the selected node is, the graph's inputs and outputs, what is wrong, where the time goes, files, keys.

mod browser;
mod data;
pub mod entries;
pub mod examples;
mod help;
mod inspector;
mod interface;
mod lower;
mod pieces;
mod plan;
pub mod table;

pub use browser::{Browse, Browser, Chosen};
pub use help::help;
pub use inspector::inspector;
pub(crate) use inspector::step_around;
pub use lower::{Lower, Tab, Went};

/// What comes of writing the files of a graph.
pub const EXPORT: &str = "what tenon run --out would write";
