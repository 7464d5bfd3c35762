//! What must stay in sight until somebody has put it away: nodes of a broken file that could not be read, and that the
//! processor draws.

use super::App;
use crate::theme::Theme;
use eframe::egui::{self, RichText, ScrollArea, Ui};

impl App {
    /// Shows the notices above the canvas, if there are any.
    pub(super) fn notices(&mut self, ui: &mut Ui) {
        if let Some(lost) = self.model.lost() {
            let away = egui::Panel::top("lost").show(ui, |ui| {
                let away = ui.horizontal_wrapped(|ui| {
                    ui.label(RichText::new(lost.words()).color(Theme::of(ui).error));
                    ui.button("Put away").clicked()
                });
                ui.weak(format!("The file stays as it is; save under another name. {}", lost.why));
                if !lost.nodes.is_empty() {
                    ui.collapsing("What could not be read", |ui| {
                        ScrollArea::vertical().max_height(120.0).show(ui, |ui| {
                            for (id, why) in &lost.nodes {
                                ui.label(format!("{id}: {why}"));
                            }
                        });
                    });
                }
                away.inner
            });
            if away.inner {
                self.model.put_lost_away();
            }
        }
        if self.software && !self.preferences.told_of_software {
            let read = egui::Panel::top("software").show(ui, |ui| {
                let line = ui.horizontal_wrapped(|ui| {
                    ui.label("No graphics card was found: the processor draws. Large models turn slowly.");
                    ui.button("I see").clicked()
                });
                line.inner
            });
            if read.inner {
                self.preferences.told_of_software = true;
                self.keep_preferences();
            }
        }
    }
}
