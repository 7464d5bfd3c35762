//! The window: menus, canvas, viewport, panels, keys. Everything that it does goes to the model.

use crate::boards::BoardView;
use crate::canvas::Canvas;
use crate::model::Model;
use crate::panels::{self, Browse, Browser, Lower};
use crate::theme::{self, Theme};
use crate::viewport::{self, Viewport};
use eframe::egui::{self, Button, Key, KeyboardShortcut, Modifiers, RichText, Ui, ViewportCommand};
use std::path::{Path, PathBuf};
use tenon_engine::{Diagnostic, Operation};

/// The editor's window.
pub struct App {
    /// What is worked on.
    pub model: Model,
    /// Nodes and wires.
    pub canvas: Canvas,
    /// What nodes make.
    pub viewport: Viewport,
    /// Parts on boards, and the player.
    pub boards: BoardView,
    /// What stands beside the canvas.
    pub side: Side,
    /// What stands below the canvas.
    pub lower: Lower,
    browser: Option<Browser>,
    help: bool,
    /// A question that must be answered before unsaved work is left.
    leaving: Option<Leave>,
    /// The graphics card, or why there is none.
    card: String,
    has_card: bool,
    title: String,
    /// Unsaved work of an earlier window was found, and nobody has said yet what becomes of it.
    found: bool,
}

/// What stands beside the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// What nodes make, in space.
    Space,
    /// Parts on boards.
    Boards,
}

/// Where one goes when unsaved work is left.
#[derive(Clone, Debug, PartialEq)]
enum Leave {
    Quit,
    New,
    Open(PathBuf),
}

const fn command(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

const UNDO: KeyboardShortcut = command(Key::Z);
const REDO: KeyboardShortcut = command(Key::Y);
const REDO_TOO: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
const SAVE: KeyboardShortcut = command(Key::S);
const SAVE_AS: KeyboardShortcut = KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::S);
const OPEN: KeyboardShortcut = command(Key::O);
const NEW: KeyboardShortcut = command(Key::N);
const ALL: KeyboardShortcut = command(Key::A);
const DUPLICATE: KeyboardShortcut = command(Key::D);
const GROUP: KeyboardShortcut = command(Key::G);

impl App {
    /// The window's content; opens `graph` if one is given.
    ///
    /// # Errors
    /// If the system gives no thread for evaluation.
    pub fn new(cc: &eframe::CreationContext<'_>, graph: Option<&Path>) -> std::io::Result<Self> {
        let ctx = cc.egui_ctx.clone();
        // A second pass over the same input would do twice what a key or a click asks for.
        ctx.options_mut(|o| o.max_passes = std::num::NonZeroUsize::MIN);
        let card = cc.wgpu_render_state.as_ref().map(viewport::install);
        let mut app = Self {
            model: Model::new(move || ctx.request_repaint())?,
            canvas: Canvas::default(),
            viewport: Viewport::default(),
            boards: BoardView::default(),
            side: Side::Space,
            lower: Lower::default(),
            browser: None,
            help: false,
            leaving: None,
            has_card: card.is_some(),
            card: card.unwrap_or_else(|| "no graphics".into()),
            title: String::new(),
            found: false,
        };
        if let Some(graph) = graph {
            app.open(graph);
        }
        Ok(app)
    }

    /// Opens a graph; what keeps it from being read is told in the window.
    pub fn open(&mut self, path: &Path) {
        match self.model.open(path) {
            Ok(()) => {
                self.canvas.opened();
                self.viewport.opened();
                self.boards.opened();
                self.found = self.model.left_behind().is_some();
            }
            Err(all) => {
                let more = if all.len() > 1 { format!(" (and {} more)", all.len() - 1) } else { String::new() };
                let first = all.into_iter().next().map_or_else(String::new, |d| d.message);
                let message = format!("{} was not opened: {first}{more}", path.display());
                self.model.message = Some(Diagnostic::error("not-opened", message));
            }
        }
    }

    fn save(&mut self, path: Option<&Path>) -> bool {
        if path.is_none() && self.model.path().is_none() {
            self.browser = Some(Browser::new(Browse::Save, None));
            return false;
        }
        let saved = self.model.save(path);
        let done = saved.is_ok();
        self.model.message = saved.err();
        done
    }

    fn leave(&mut self, ui: &Ui, to: Leave) {
        if self.model.unsaved() && self.leaving.as_ref() != Some(&to) {
            self.leaving = Some(to);
            return;
        }
        self.leaving = None;
        self.model.forget_kept();
        match to {
            Leave::Quit => ui.ctx().send_viewport_cmd(ViewportCommand::Close),
            Leave::New => {
                self.model.clear();
                self.canvas.opened();
                self.viewport.opened();
                self.boards.opened();
            }
            Leave::Open(path) => self.open(&path),
        }
    }

    fn browse(&mut self, what: Browse) {
        self.browser = Some(Browser::new(what, self.model.path()));
    }

    fn menus(&mut self, ui: &mut Ui) {
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
                egui::widgets::global_theme_preference_buttons(ui);
            });
            if ui.button("Help").on_hover_text("F1").clicked() {
                self.help = !self.help;
            }
            ui.separator();
            let (undo, redo) = self.model.steps();
            if ui.add_enabled(undo > 0, Button::new("Undo")).clicked() {
                self.model.undo();
            }
            if ui.add_enabled(redo > 0, Button::new("Redo")).clicked() {
                self.model.redo();
            }
            if ui.button("Add node").on_hover_text("double-click on the canvas").clicked() {
                self.canvas.open_finder(ui);
            }
        });
    }

    fn file_menu(&mut self, ui: &mut Ui) {
        let item = |ui: &mut Ui, words: &str, keys: KeyboardShortcut| {
            ui.add(Button::new(words).shortcut_text(ui.ctx().format_shortcut(&keys))).clicked()
        };
        if item(ui, "New", NEW) {
            self.leave(ui, Leave::New);
        }
        if item(ui, "Open …", OPEN) {
            self.browse(Browse::Open);
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
        if item(ui, "Save", SAVE) {
            self.save(None);
        }
        if item(ui, "Save as …", SAVE_AS) {
            self.browse(Browse::Save);
        }
        ui.separator();
        if ui.button("Quit").clicked() {
            self.leave(ui, Leave::Quit);
        }
    }

    fn edit_menu(&mut self, ui: &mut Ui) {
        let any = !self.model.selection.is_empty();
        let item = |ui: &mut Ui, on: bool, words: &str, keys: KeyboardShortcut| {
            ui.add_enabled(on, Button::new(words).shortcut_text(ui.ctx().format_shortcut(&keys))).clicked()
        };
        let (undo, redo) = self.model.steps();
        if item(ui, undo > 0, "Undo", UNDO) {
            self.model.undo();
        }
        if item(ui, redo > 0, "Redo", REDO) {
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
        if item(ui, any, "Duplicate", DUPLICATE) {
            self.model.message = self.model.duplicate([40.0, 40.0]).err();
        }
        if item(ui, any, "Group", GROUP) {
            self.group();
        }
        if ui.add_enabled(any, Button::new("Delete").shortcut_text("Del")).clicked() {
            self.model.delete_selection();
        }
        if item(ui, true, "Select all", ALL) {
            self.model.selection = self.model.document().nodes().keys().cloned().collect();
        }
    }

    fn copy(&self, ui: &Ui) {
        if let Some(text) = self.model.copy() {
            ui.ctx().copy_text(text);
        }
    }

    fn group(&mut self) {
        if !self.model.selection.is_empty() {
            let operation: Operation = crate::canvas::group(&self.model);
            self.model.edit(operation);
        }
    }

    /// Keys that mean the same everywhere in the window, unless somebody types.
    fn keys(&mut self, ui: &Ui) {
        let pressed = |keys| ui.input_mut(|i| i.consume_shortcut(&keys));
        if pressed(SAVE_AS) {
            self.browse(Browse::Save);
        } else if pressed(SAVE) {
            self.save(None);
        }
        if pressed(OPEN) {
            self.browse(Browse::Open);
        }
        if pressed(NEW) {
            self.leave(ui, Leave::New);
        }
        if ui.input(|i| i.key_pressed(Key::F1)) {
            self.help = !self.help;
        }
        if ui.ctx().egui_wants_keyboard_input() || self.canvas.is_typing() {
            return;
        }
        if pressed(REDO_TOO) || pressed(REDO) {
            self.model.redo();
        } else if pressed(UNDO) {
            self.model.undo();
        }
        if pressed(ALL) {
            self.model.selection = self.model.document().nodes().keys().cloned().collect();
        }
        if pressed(DUPLICATE) && !self.model.selection.is_empty() {
            self.model.message = self.model.duplicate([40.0, 40.0]).err();
        }
        if pressed(GROUP) {
            self.group();
        }
        if ui.input(|i| i.key_pressed(Key::Delete) || i.key_pressed(Key::Backspace)) {
            self.model.delete_selection();
        }
        if ui.input(|i| i.key_pressed(Key::Escape)) && !self.model.cancel() {
            self.model.selection.clear();
        }
        if ui.input(|i| i.key_pressed(Key::F5)) {
            self.model.again();
        }
        for event in ui.input(|i| i.events.clone()) {
            match event {
                egui::Event::Copy => self.copy(ui),
                egui::Event::Cut => {
                    self.copy(ui);
                    self.model.delete_selection();
                }
                egui::Event::Paste(text) => self.model.message = self.model.paste(&text, [40.0, 40.0]).err(),
                _ => {}
            }
        }
    }

    fn status(&mut self, ui: &mut Ui) {
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
            } else {
                let chosen = self.model.selection.len();
                let nodes = self.model.document().nodes().len();
                ui.weak(format!("{nodes} nodes, {chosen} selected"));
            }
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| ui.weak(&self.card));
        });
    }

    fn side(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.selectable_value(&mut self.side, Side::Space, "Space");
            ui.selectable_value(&mut self.side, Side::Boards, "Boards");
        });
        let keys = ui.rect_contains_pointer(ui.max_rect()) && !ui.ctx().egui_wants_keyboard_input();
        let fit = keys && ui.input(|i| i.key_pressed(Key::F));
        match self.side {
            Side::Boards => {
                if fit {
                    self.boards.show_all();
                }
                self.boards.show(ui, &mut self.model, &mut self.viewport.picked);
            }
            Side::Space if self.has_card => {
                if fit {
                    self.viewport.show_all();
                }
                self.viewport.show(ui, &mut self.model);
            }
            Side::Space => {
                ui.centered_and_justified(|ui| ui.label("no graphics: the viewport cannot be shown"));
            }
        }
    }

    fn ask(&mut self, ui: &Ui) {
        let Some(to) = self.leaving.clone() else { return };
        let mut answer = None;
        egui::Modal::new(egui::Id::new("leaving")).show(ui.ctx(), |ui| {
            ui.heading("The graph has changes that are not saved");
            ui.horizontal(|ui| {
                for (words, save) in [("Save", Some(true)), ("Discard changes", Some(false)), ("Cancel", None)] {
                    if ui.button(words).clicked() {
                        answer = Some(save);
                    }
                }
            });
        });
        match answer {
            None => {}
            Some(None) => self.leaving = None,
            Some(Some(false)) => self.leave(ui, to),
            Some(Some(true)) => {
                self.leaving = None;
                if self.save(None) {
                    self.leave(ui, to);
                }
            }
        }
    }

    /// Asks what becomes of work that an earlier window has left behind.
    fn ask_for_found(&mut self, ui: &Ui) {
        let mut answer = None;
        egui::Modal::new(egui::Id::new("found")).show(ui.ctx(), |ui| {
            ui.heading("An earlier window ended without saving its work on this graph");
            ui.horizontal(|ui| {
                for (words, take) in [("Recover it", true), ("Throw it away", false)] {
                    if ui.button(words).clicked() {
                        answer = Some(take);
                    }
                }
            });
        });
        match answer {
            None => return,
            Some(true) => match self.model.recover() {
                Ok(()) => self.model.forget_kept(),
                Err(e) => self.model.message = Some(e),
            },
            Some(false) => self.model.forget_kept(),
        }
        self.found = false;
    }

    /// Takes the state folder of this user: recent graphs, and unsaved work of graphs without a file.
    pub fn remember_in(&mut self, folder: Option<PathBuf>) {
        self.model.state = folder;
        self.model.remember();
        self.found |= self.model.left_behind().is_some();
    }

    fn files(&mut self, ui: &Ui) {
        if self.found {
            self.ask_for_found(ui);
        } else if let Some(soon) = self.model.keep() {
            ui.ctx().request_repaint_after(soon);
        }
        let dropped = ui.input(|i| i.raw.dropped_files.first().map(|f| f.path().to_owned()));
        if let Some(path) = dropped {
            self.leave(ui, Leave::Open(path));
        }
        if let Some(mut browser) = self.browser.take() {
            match browser.show(ui) {
                panels::Chosen::Nothing => self.browser = Some(browser),
                panels::Chosen::Closed => {}
                panels::Chosen::Open(path) => self.leave(ui, Leave::Open(path)),
                panels::Chosen::Save(path) => {
                    self.save(Some(&path));
                }
            }
        }
        if ui.input(|i| i.viewport().close_requested()) && self.leaving != Some(Leave::Quit) && self.model.unsaved() {
            ui.ctx().send_viewport_cmd(ViewportCommand::CancelClose);
            self.leaving = Some(Leave::Quit);
        }
        let name =
            self.model.path().and_then(Path::file_name).and_then(|n| n.to_str()).unwrap_or("new graph").to_owned();
        let title = format!("{}{name} — Tenon", if self.model.unsaved() { "• " } else { "" });
        if title != self.title {
            ui.ctx().send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }
}

impl eframe::App for App {
    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        self.model.poll();
        self.keys(ui);
        egui::Panel::top("menus").show(ui, |ui| self.menus(ui));
        egui::Panel::bottom("status").show(ui, |ui| self.status(ui));
        let width = ui.available_width();
        egui::Panel::right("right").default_size(width * 0.45).min_size(160.0).show(ui, |ui| {
            egui::Panel::bottom("inspector")
                .resizable(true)
                .min_size(150.0)
                .default_size(ui.available_height() * 0.34)
                .show(ui, |ui| {
                    panels::inspector(ui, &mut self.model);
                });
            egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| self.side(ui));
        });
        if self.lower.tab.is_some() {
            egui::Panel::bottom("lower").resizable(true).default_size(200.0).show(ui, |ui| {
                if let Some(node) = self.lower.show(ui, &self.model) {
                    self.model.selection = [node].into();
                    self.canvas.show_all();
                }
            });
        }
        egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| self.canvas.show(ui, &mut self.model));
        panels::help(ui, &mut self.help);
        self.files(ui);
        self.ask(ui);
        if !self.model.settled() {
            // The worker wakes the window when it has something; this only keeps the clock of the bar going.
            ui.ctx().request_repaint_after(std::time::Duration::from_millis(200));
        }
    }
}
