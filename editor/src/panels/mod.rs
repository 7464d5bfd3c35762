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

use eframe::egui::{DragValue, Id, Key, Ui};

/// A field for a number: what is typed and is no finite number, such as `inf` and `1e999`, is not taken, since no file could
/// hold it.
pub fn figure(value: &mut f64) -> DragValue<'_> {
    DragValue::new(value).custom_parser(finite)
}

/// Whether Escape was pressed in this frame or in the one before: there a field that counts when it is left brings what was typed
/// once more.
pub(crate) fn escaped(ui: &Ui) -> bool {
    let (id, now) = (Id::new("escaped"), ui.ctx().cumulative_pass_nr());
    if ui.input(|i| i.key_pressed(Key::Escape)) {
        ui.data_mut(|d| d.insert_temp(id, now));
    }
    ui.data(|d| d.get_temp::<u64>(id)).is_some_and(|at| now <= at + 1)
}

/// As such fields read numbers: blanks do not count, and minus is written in either way.
fn finite(text: &str) -> Option<f64> {
    let plain: String = text.chars().filter(|c| !c.is_whitespace()).map(|c| if c == '−' { '-' } else { c }).collect();
    plain.parse().ok().filter(|v: &f64| v.is_finite())
}

/// What comes of writing the files of a graph.
pub const EXPORT: &str = "what tenon run --out would write";
