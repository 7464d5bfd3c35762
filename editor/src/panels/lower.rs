//! Below the canvas: all that is wrong, where the time goes, and values as tables. A click goes to the node.

use super::data::DataView;
use super::pieces::Pieces;
use super::profile::Profile;
use crate::boards::BoardView;
use crate::model::Model;
use crate::theme::Theme;
use crate::viewport::Picked;
use eframe::egui::{RichText, ScrollArea, TextWrapMode, Ui};
use tenon_engine::Severity;

/// What stands below the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tab {
    /// All that is wrong.
    Problems,
    /// Where the time goes.
    Profile,
    /// What the selected node gives.
    Data,
    /// All parts.
    Pieces,
}

impl Tab {
    /// Its name for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Problems => "Problems",
            Self::Profile => "Profile",
            Self::Data => "Data",
            Self::Pieces => "Pieces",
        }
    }
}

/// What was clicked.
#[derive(Clone, Debug, PartialEq)]
pub enum Went {
    /// A node, by its path.
    Node(String),
    /// A panel.
    Panel(Picked),
    /// Where the files of the graph are written.
    Export,
}

/// The panel below the canvas.
#[derive(Default)]
pub struct Lower {
    /// What it shows; none: it is closed.
    pub tab: Option<Tab>,
    data: DataView,
    pieces: Pieces,
    profile: Profile,
}

impl Lower {
    /// Opens at a tab, or closes if it shows that.
    pub fn toggle(&mut self, tab: Tab) {
        self.tab = if self.tab == Some(tab) { None } else { Some(tab) };
    }

    /// What is made only for who looks at it is given up, if nobody does.
    pub fn rest(&mut self) {
        if self.tab != Some(Tab::Data) {
            self.data.close();
        }
    }

    /// Whether nothing is being made to be shown.
    #[must_use]
    pub fn settled(&self) -> bool {
        self.data.settled()
    }

    /// Shows it; gives what was clicked.
    pub fn show(&mut self, ui: &mut Ui, model: &Model, boards: &BoardView) -> Option<Went> {
        ui.horizontal(|ui| {
            for tab in [Tab::Problems, Tab::Profile, Tab::Data, Tab::Pieces] {
                if ui.selectable_label(self.tab == Some(tab), tab.name()).clicked() {
                    self.tab = Some(tab);
                }
            }
            if ui.small_button("×").on_hover_text("close").clicked() {
                self.tab = None;
            }
        });
        ui.separator();
        // Its height is the person's, however little there is to show.
        ui.set_min_height(ui.available_height());
        match self.tab? {
            Tab::Problems => problems(ui, model).map(Went::Node),
            Tab::Profile => self.profile.show(ui, model).map(Went::Node),
            Tab::Data => {
                self.data.show(ui, model);
                None
            }
            Tab::Pieces => self.pieces.show(ui, model, boards),
        }
    }
}

fn problems(ui: &mut Ui, model: &Model) -> Option<String> {
    let all = &model.results.diagnostics;
    if all.is_empty() {
        ui.weak("Nothing is wrong.");
        return None;
    }
    let (theme, mut go) = (Theme::of(ui), None);
    let height = ui.text_style_height(&eframe::egui::TextStyle::Body) + 4.0;
    ScrollArea::vertical().auto_shrink(false).show_rows(ui, height, all.len(), |ui, rows| {
        // One line each, however long; all of it under the pointer.
        ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
        for d in all.get(rows).unwrap_or(&[]) {
            let colour = match d.severity {
                Severity::Error => theme.error,
                Severity::Warning => theme.warning,
                Severity::Note => theme.faint_text,
            };
            let words = d.to_string();
            let row = ui.selectable_label(false, RichText::new(&words).color(colour)).on_hover_text(words);
            if row.clicked() {
                go = d.node.as_deref().map(str::to_owned);
            }
        }
    });
    go
}
