//! The line below: how the evaluation goes, what is wrong, what is drawn with.

use super::App;
use crate::panels;
use crate::theme::{self, Theme};
use eframe::egui::{self, RichText, Ui};

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
            if ui.button("Data").clicked() {
                self.lower.toggle(panels::Tab::Data);
            }
            if ui.button("Pieces").clicked() {
                self.lower.toggle(panels::Tab::Pieces);
            }
            if ui.button("Profile").clicked() {
                self.lower.toggle(panels::Tab::Profile);
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
                ui.label(&*p.node);
                if ui.button("Stop").on_hover_text("Esc").clicked() {
                    self.model.cancel();
                }
            } else {
                ui.label("evaluating …");
            }
            ui.separator();
            if let Some(message) = &self.model.message {
                let hint = message.hint.as_ref().map(|h| format!(" ({h})")).unwrap_or_default();
                ui.colored_label(theme.error, format!("{}{hint}", message.message));
            } else if let Some(said) = &self.model.said {
                ui.label(said);
            } else if let Some(said) = self.said.clone() {
                if ui.label(said).on_hover_text("click to put away").interact(egui::Sense::click()).clicked() {
                    self.said = None;
                }
            } else {
                let chosen = self.model.selection.len();
                let nodes = self.model.document().nodes().len();
                ui.weak(format!("{nodes} nodes, {chosen} selected"));
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.weak(&self.card));
        });
    }
}
