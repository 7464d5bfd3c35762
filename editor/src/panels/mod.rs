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

use eframe::egui::DragValue;

/// A field for a number: what is typed and is no finite number, such as `inf` and `1e999`, is not taken, since no file could
/// hold it.
pub fn figure(value: &mut f64) -> DragValue<'_> {
    DragValue::new(value).custom_parser(finite)
}

/// As such fields read numbers: blanks do not count, and minus is written in either way.
fn finite(text: &str) -> Option<f64> {
    let plain: String = text.chars().filter(|c| !c.is_whitespace()).map(|c| if c == '−' { '-' } else { c }).collect();
    plain.parse().ok().filter(|v: &f64| v.is_finite())
}

/// What comes of writing the files of a graph.
pub const EXPORT: &str = "what tenon run --out would write";
