//! Panels around the canvas: what the selected node is, what is wrong, where the time goes, files, keys.

mod browser;
mod data;
mod help;
mod inspector;
mod lower;
mod pieces;
pub mod table;

pub use browser::{Browse, Browser, Chosen};
pub use help::help;
pub use inspector::inspector;
pub use lower::{Lower, Tab, Went};
