//! The line below: how the evaluation goes, what is wrong, what is drawn with.

use super::App;
use crate::panels;
use crate::theme::{self, Theme};
use eframe::egui::{self, Label, RichText, TextStyle, TextWrapMode, Ui, WidgetText};

impl App {
    pub(super) fn status(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            let theme = Theme::of(ui);
            let (errors, warnings) = self.model.results.counts();
            let words = format!("{errors} errors, {warnings} warnings");
            let colour = if errors > 0 { theme.error } else { theme.faint_text };
            if ui.button(RichText::new(words).color(colour)).clicked() {
                self.lower.toggle(panels::Tab::Problems);
            }
            for tab in [panels::Tab::Data, panels::Tab::Pieces, panels::Tab::Profile] {
                if ui.button(tab.name()).clicked() {
                    self.lower.toggle(tab);
                }
            }
            ui.separator();
            if self.model.settled() {
                let r = &self.model.results;
                let words = if r.cancelled {
                    "stopped; F5 runs it again".into()
                } else {
                    format!("done in {}", theme::duration(r.elapsed))
                };
                ui.label(words);
            } else if let Some(p) = &self.model.results.progress {
                ui.add(egui::ProgressBar::new(p.fraction as f32).desired_width(120.0));
                if ui.button("Stop").on_hover_text("Esc").clicked() {
                    self.model.cancel();
                }
                ui.scope(|ui| {
                    ui.set_max_width(120.0);
                    ui.add(Label::new(&*p.node).truncate());
                });
            } else {
                ui.label("evaluating …");
            }
            if let Some(what) = self.model.plugins().loading() {
                ui.separator();
                ui.label(format!("loading {what} …"));
            }
            if let Some(folder) = self.model.exporting() {
                ui.separator();
                let name = folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy();
                ui.label(format!("writing files into {name} …"));
            }
            ui.separator();
            if let Some(message) = &self.model.message {
                let hint = message.hint.as_ref().map(|h| format!(" ({h})")).unwrap_or_default();
                let words = RichText::new(format!("{}{hint}", message.message)).color(theme.error);
                ui.add(Label::new(words).truncate());
            } else if let Some(said) = &self.model.said {
                ui.add(Label::new(said).truncate());
            } else if let Some(said) = self.said.clone() {
                let said = ui.add(Label::new(said).truncate().sense(egui::Sense::click()));
                if said.on_hover_text("click to put away").clicked() {
                    self.said = None;
                }
            } else {
                let chosen = self.model.selection.len();
                let nodes = self.model.document().nodes().len();
                let words = format!("{nodes} node{}, {chosen} selected", if nodes == 1 { "" } else { "s" });
                ui.add(Label::new(RichText::new(words).weak()).truncate());
            }
            // The card is named where there is room for its whole name.
            let card = WidgetText::from(RichText::new(&self.card).weak());
            let card = card.into_galley(ui, Some(TextWrapMode::Extend), f32::INFINITY, TextStyle::Body);
            if card.size().x <= ui.available_width() {
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.label(card));
            }
        });
    }
}
