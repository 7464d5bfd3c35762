//! Panels around the canvas: what the selected node is, the graph's inputs and outputs, what is wrong, where the time goes, files, keys.

mod browser;
mod data;
pub mod entries;
pub mod examples;
mod figure;
mod help;
mod inspector;
mod interface;
mod lower;
mod pieces;
mod plan;
mod profile;
pub mod table;

pub use browser::{Browse, Browser, Chosen};
pub use figure::figure;
pub use help::help;
pub use inspector::inspector;
pub(crate) use inspector::step_around;
pub use lower::{Lower, Tab, Went};

use eframe::egui::{Id, Key, Ui};

/// Whether Escape was pressed in this frame or in the one before: there a field that counts when it is left brings what was typed
/// once more.
pub(crate) fn escaped(ui: &Ui) -> bool {
    let (id, now) = (Id::new("escaped"), ui.ctx().cumulative_pass_nr());
    if ui.input(|i| i.key_pressed(Key::Escape)) {
        ui.data_mut(|d| d.insert_temp(id, now));
    }
    ui.data(|d| d.get_temp::<u64>(id)).is_some_and(|at| now <= at + 1)
}

/// What comes of writing the files of a graph.
pub const EXPORT: &str = "what tenon run --out would write";
