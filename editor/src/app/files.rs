//! Opening, saving, leaving, exporting, and what is dropped on the window.

use super::App;
use super::dialogs::{Answer, Wish};
use crate::model::file::name_in;
use crate::panels::{self, Browse, Browser};
use eframe::egui::{self, Ui, ViewportCommand};
use std::path::{Path, PathBuf};
use tenon_engine::{Diagnostic, Operation};

/// Where one goes when unsaved work is left.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Leave {
    Quit,
    New,
    Open(PathBuf),
}

impl App {
    /// Opens a graph; of one that cannot be read whole, what can be read, without its name.
    pub fn open(&mut self, path: &Path) {
        match self.model.open(path) {
            Ok(()) => {
                self.opened();
                self.found = self.model.left_behind().is_some();
            }
            Err(why) => match self.model.salvage(path, &why) {
                true => self.opened(),
                false => {
                    let d = why.diagnostic();
                    let message = format!("{} was not opened: {}", path.display(), d.message);
                    self.model.message = Some(Diagnostic { message, ..d });
                }
            },
        }
    }

    /// After another graph was opened.
    fn opened(&mut self) {
        self.canvas.opened();
        self.viewport.opened();
        self.boards.opened();
    }

    pub(super) fn save(&mut self, ctx: &egui::Context, path: Option<&Path>) -> bool {
        if path.is_none() && self.model.path().is_none() {
            self.browse(ctx, Browse::Save);
            return false;
        }
        self.canvas.settle(&mut self.model);
        let saved = self.model.save(path);
        let done = saved.is_ok();
        self.model.message = saved.err();
        done
    }

    pub(super) fn leave(&mut self, ui: &Ui, to: Leave) {
        self.canvas.settle(&mut self.model);
        if self.model.unsaved() && self.leaving.as_ref() != Some(&to) {
            self.leaving = Some(to);
            return;
        }
        self.leaving = None;
        self.model.forget_kept();
        match to {
            Leave::Quit => {
                self.quits = true;
                ui.ctx().send_viewport_cmd(ViewportCommand::Close);
            }
            Leave::New => {
                self.model.clear();
                self.opened();
            }
            Leave::Open(path) => self.open(&path),
        }
    }

    /// Asks for a file: the desktop, if it is there and wanted, else by the window's own browser.
    pub(super) fn browse(&mut self, ctx: &egui::Context, what: Browse) {
        if self.preferences.desktop_dialogs && self.dialogs.are_there() {
            let (folder, name) = what.proposed(self.model.path());
            if self.dialogs.ask(ctx, Wish { what: what.clone(), folder, name }) {
                return;
            }
        }
        self.browser = Some(Browser::new(what, self.model.path()));
    }

    /// Takes what the desktop's windows have answered.
    fn answered(&mut self, ui: &Ui) {
        match self.dialogs.answer() {
            Answer::Nothing => {}
            Answer::Nobody(what) => self.browser = Some(Browser::new(what, self.model.path())),
            Answer::Path(what, path) => {
                let named = if what.writes() { what.with_ending(path.clone()) } else { path.clone() };
                if named != path && named.exists() {
                    // Whether a file may be written over, the desktop has asked of another name.
                    self.browser = Some(Browser::at(what, &named));
                } else {
                    self.chosen(ui, what, &named);
                }
            }
        }
    }

    /// Whether a question about unsaved work waits for its answer; until then nothing else is done.
    pub(super) fn asks(&self) -> bool {
        self.found || self.leaving.is_some()
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
                if self.save(ui.ctx(), None) {
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
                Err(e) => self.model.message = Some(self.model.put_aside(e)),
            },
            Some(false) => self.model.forget_kept(),
        }
        self.found = false;
    }

    /// Takes the state folder of this user: recent graphs, preferences, and unsaved work of graphs without a file.
    pub fn remember_in(&mut self, ctx: &egui::Context, folder: Option<PathBuf>) {
        self.model.remember_in(folder);
        self.take_preferences(ctx);
        // Somebody who is here for the first time sees the examples.
        self.gallery.open = !self.preferences.toured && self.model.path().is_none();
        self.found |= self.model.left_behind().is_some();
    }

    /// Takes a file that was dropped on the window: a plugin is loaded, a mesh or a picture is shown or read, everything else
    /// is opened as a graph.
    pub fn dropped(&mut self, ui: &Ui, path: &Path) {
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_lowercase();
        match ending.as_str() {
            e if e == std::env::consts::DLL_EXTENSION => self.load_plugin(path),
            "obj" => self.read_mesh(path),
            e if crate::viewport::PICTURES.contains(&e) => self.viewport.refer_to(&self.model, path),
            _ => self.leave(ui, Leave::Open(path.to_owned())),
        }
    }

    fn load_plugin(&mut self, path: &Path) {
        self.model.load_plugins(&[path.to_owned()], &[]);
    }

    /// Adds the node that reads a mesh.
    fn read_mesh(&mut self, path: &Path) {
        let name = name_in(self.model.path(), path);
        let (id, add) = self.model.new_node("read_mesh", self.canvas.middle());
        let set = Operation::SetParam { node: id.clone(), port: "path".into(), value: Some(name.into()) };
        if self.model.edit(Operation::All(vec![add, set])) {
            self.model.selection = [id].into();
        }
    }

    /// Does what a file was chosen for.
    fn chosen(&mut self, ui: &Ui, what: Browse, path: &Path) {
        match what {
            Browse::Open => self.leave(ui, Leave::Open(path.to_owned())),
            Browse::Save => {
                self.save(ui.ctx(), Some(path));
            }
            Browse::Input { node, port } => {
                let value = Some(name_in(self.model.path(), path).into());
                self.model.edit(Operation::SetParam { node, port, value });
            }
            Browse::Plugin => self.load_plugin(path),
            Browse::Reference => self.viewport.refer_to(&self.model, path),
            Browse::Picture => self.model.message = self.viewport.save_picture(ui.ctx(), path).err(),
            Browse::Export => self.model.message = self.model.export(path).err(),
        }
    }

    pub(super) fn files(&mut self, ui: &Ui) {
        if self.found {
            self.ask_for_found(ui);
        } else if !self.quits
            && let Some(soon) = self.model.keep()
        {
            ui.ctx().request_repaint_after(soon);
        }
        for path in ui.input(|i| i.raw.dropped_files.iter().map(|f| f.path().to_owned()).collect::<Vec<_>>()) {
            if self.asks() {
                let refused = Diagnostic::error("question-open", format!("{} was not taken", path.display()));
                self.model.message = Some(refused.hint("answer the question first"));
            } else {
                self.dropped(ui, &path);
            }
        }
        if let Some(what) = self.model.wanted_file.take() {
            self.browse(ui.ctx(), Browse::Input { node: what.0, port: what.1 });
        }
        if let Some(what) = self.viewport.wants.take() {
            self.browse(ui.ctx(), what);
        }
        if !self.asks() {
            self.answered(ui);
        }
        if let Some(said) = self.viewport.follow(ui.ctx(), &mut self.model) {
            self.said = Some(said);
        }
        match self.model.exported() {
            None => {}
            Some(Ok(said)) => self.said = Some(said),
            Some(Err(why)) => self.model.message = Some(why),
        }
        if let Some(mut browser) = self.browser.take() {
            match browser.show(ui) {
                panels::Chosen::Nothing => self.browser = Some(browser),
                panels::Chosen::Closed => {}
                panels::Chosen::Path(path) => self.chosen(ui, browser.what.clone(), &path),
            }
        }
        self.ask(ui);
        let closes = ui.input(|i| i.viewport().close_requested()) && !self.quits;
        if closes {
            self.canvas.settle(&mut self.model);
        }
        if closes && self.leaving != Some(Leave::Quit) && self.model.unsaved() {
            ui.ctx().send_viewport_cmd(ViewportCommand::CancelClose);
            self.leaving = Some(Leave::Quit);
        }
        let name =
            self.model.path().and_then(Path::file_name).and_then(|n| n.to_str()).unwrap_or("new graph").to_owned();
        let title = format!("{}{name} — Tenon", if self.model.seems_unsaved() { "• " } else { "" });
        if title != self.title {
            ui.ctx().send_viewport_cmd(ViewportCommand::Title(title.clone()));
            self.title = title;
        }
    }
}
