//! The bar of menus.

use super::App;
use super::files::Leave;
use super::keys::{self, command};
use crate::panels::{self, Browse};
use eframe::egui::{self, Button, Key, KeyboardShortcut, Modifiers, Ui, ViewportCommand};
use tenon_engine::NodeState;

/// An entry of a menu with the keys that do the same; whether it was clicked.
fn item(ui: &mut Ui, on: bool, words: &str, keys: KeyboardShortcut) -> bool {
    ui.add_enabled(on, Button::new(words).shortcut_text(ui.ctx().format_shortcut(&keys))).clicked()
}

impl App {
    pub(super) fn menus(&mut self, ui: &mut Ui) {
        egui::MenuBar::new().ui(ui, |ui| {
            ui.menu_button("File", |ui| self.file_menu(ui));
            ui.menu_button("Edit", |ui| self.edit_menu(ui));
            ui.menu_button("View", |ui| {
                if ui.button("Show all on the canvas").clicked() {
                    self.model.selection.clear();
                    self.canvas.show_all();
                }
                if ui.button("Show all in the viewport").clicked() {
                    self.viewport.show_all();
                }
                ui.separator();
                let with_alt = |key| KeyboardShortcut::new(Modifiers::ALT, key);
                for (key, tab) in keys::BELOW {
                    if item(ui, true, tab.name(), with_alt(key)) {
                        self.lower.toggle(tab);
                    }
                }
                for (key, side) in keys::BESIDE {
                    if item(ui, true, side.name(), with_alt(key)) {
                        self.side = side;
                    }
                }
                ui.separator();
                self.preferences_menu(ui);
            });
            ui.menu_button("Help", |ui| {
                if ui.add(Button::new("Keys").shortcut_text("F1")).clicked() {
                    self.help = !self.help;
                }
                if ui.button("Tour of three steps").clicked() {
                    self.begin_tour(ui);
                }
                if ui.button("Examples …").clicked() {
                    self.gallery.open = true;
                }
            });
            ui.separator();
            let (undo, redo) = self.model.steps();
            if ui.add_enabled(undo > 0, Button::new("Undo")).clicked() {
                self.model.undo();
            }
            if ui.add_enabled(redo > 0, Button::new("Redo")).clicked() {
                self.model.redo();
            }
            if ui.button("Add node").on_hover_text("F4, or double-click on the canvas").clicked() {
                self.canvas.open_finder(ui);
            }
        });
    }

    fn file_menu(&mut self, ui: &mut Ui) {
        if item(ui, true, "New", keys::NEW) {
            self.leave(ui, Leave::New);
        }
        if item(ui, true, "Open …", keys::OPEN) {
            self.browse(ui.ctx(), Browse::Open);
        }
        if ui.button("Examples …").clicked() {
            self.gallery.open = true;
        }
        ui.menu_button("Open recent", |ui| {
            let recent = self.model.recent();
            if recent.is_empty() {
                ui.weak("none yet");
            }
            for path in recent {
                if ui.button(path.display().to_string()).clicked() {
                    self.leave(ui, Leave::Open(path));
                }
            }
        });
        if item(ui, true, "Save", keys::SAVE) {
            self.save(ui.ctx(), None);
        }
        if item(ui, true, "Save as …", keys::SAVE_AS) {
            self.browse(ui.ctx(), Browse::Save);
        }
        ui.separator();
        if ui.button("Export the files …").on_hover_text(panels::EXPORT).clicked() {
            self.browse(ui.ctx(), Browse::Export);
        }
        if ui.button("Load a plugin …").clicked() {
            self.browse(ui.ctx(), Browse::Plugin);
        }
        if ui.button("Show a mesh or picture behind …").clicked() {
            self.browse(ui.ctx(), Browse::Reference);
        }
        ui.separator();
        if ui.button("Quit").clicked() {
            self.leave(ui, Leave::Quit);
        }
    }

    fn edit_menu(&mut self, ui: &mut Ui) {
        let any = !self.model.selection.is_empty();
        let (undo, redo) = self.model.steps();
        if item(ui, undo > 0, "Undo", keys::UNDO) {
            self.model.undo();
        }
        if item(ui, redo > 0, "Redo", keys::REDO) {
            self.model.redo();
        }
        ui.separator();
        if item(ui, any, "Copy", command(Key::C)) {
            self.copy(ui);
        }
        if item(ui, any, "Cut", command(Key::X)) {
            self.copy(ui);
            self.model.delete_selection();
        }
        if item(ui, true, "Paste", command(Key::V)) {
            // The desktop gives what is in the clipboard when it is asked, as an event of the next frame.
            ui.ctx().send_viewport_cmd(ViewportCommand::RequestPaste);
        }
        if item(ui, any, "Duplicate", keys::DUPLICATE) {
            self.model.message = self.model.duplicate([40.0, 40.0]).err();
        }
        if item(ui, any, "Group", keys::GROUP) {
            self.group();
        }
        if item(ui, any, "Ungroup", keys::UNGROUP) {
            self.ungroup();
        }
        if item(ui, any, "Make a cluster", keys::CLUSTER) {
            self.model.message = self.model.gather().err();
        }
        if item(ui, any, "Explode clusters", keys::EXPLODE) {
            self.explode();
        }
        if item(ui, any, "Show or hide in the viewport", keys::PREVIEW) {
            self.model.toggle_preview();
        }
        if item(ui, any, "Enable or disable", keys::ENABLE) {
            self.model.toggle_state(NodeState::Disabled);
        }
        if item(ui, any, "Freeze or thaw", keys::FREEZE) {
            self.model.toggle_state(NodeState::Frozen);
        }
        if ui.add_enabled(any, Button::new("Delete").shortcut_text("Del")).clicked() {
            self.model.delete_selection();
        }
        if ui.add(Button::new("Find a node of the graph …").shortcut_text("F3")).clicked() {
            self.canvas.open_search();
        }
        if item(ui, true, "Select all", keys::ALL) {
            self.model.selection = self.model.document().nodes().keys().cloned().collect();
        }
    }

    pub(super) fn copy(&mut self, ui: &Ui) {
        if let Some(text) = self.model.copy() {
            ui.ctx().copy_text(text);
        }
    }

    pub(super) fn group(&mut self) {
        if !self.model.selection.is_empty() {
            let operation = crate::canvas::group(&self.model);
            self.model.edit(operation);
        }
    }
}
