//! Choosing a file: folders and graphs as a list, and a path that can be typed. Needs nothing of the desktop.

use crate::model::file::ENDING;
use eframe::egui::{Key, RichText, ScrollArea, TextEdit, Ui, Window};
use std::path::{Path, PathBuf};

/// What a file is wanted for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Browse {
    /// To be read.
    Open,
    /// To be written.
    Save,
}

/// What came of a frame.
#[derive(Debug, PartialEq)]
pub enum Chosen {
    /// Nothing yet.
    Nothing,
    /// The window was closed.
    Closed,
    /// A graph to open.
    Open(PathBuf),
    /// A file to write.
    Save(PathBuf),
}

/// An open file window.
pub struct Browser {
    what: Browse,
    folder: PathBuf,
    name: String,
    entries: Vec<(String, bool)>,
    error: Option<String>,
    /// A file of that name is there and may be written over.
    over: Option<PathBuf>,
}

impl Browser {
    /// Opens at the folder of a graph, or where the program was started.
    #[must_use]
    pub fn new(what: Browse, near: Option<&Path>) -> Self {
        let here = || std::env::current_dir().unwrap_or_default();
        let folder = near.and_then(Path::parent).map_or_else(here, Path::to_owned);
        let folder = folder.canonicalize().unwrap_or(folder);
        let name = match (what, near.and_then(Path::file_name).and_then(|n| n.to_str())) {
            (Browse::Save, Some(name)) => name.to_owned(),
            (Browse::Save, None) => format!("new{ENDING}"),
            (Browse::Open, _) => String::new(),
        };
        let mut browser = Self { what, folder, name, entries: Vec::new(), error: None, over: None };
        browser.read();
        browser
    }

    fn read(&mut self) {
        self.entries.clear();
        match self.folder.read_dir() {
            Err(e) => self.error = Some(format!("{} cannot be read: {e}", self.folder.display())),
            Ok(entries) => {
                self.error = None;
                for entry in entries.flatten() {
                    let (name, path) = (entry.file_name().to_string_lossy().into_owned(), entry.path());
                    let is_folder = path.is_dir();
                    if !name.starts_with('.') && (is_folder || name.ends_with(ENDING)) {
                        self.entries.push((name, is_folder));
                    }
                }
            }
        }
        self.entries.sort_by(|a, b| b.1.cmp(&a.1).then_with(|| a.0.cmp(&b.0)));
    }

    /// Shows it.
    pub fn show(&mut self, ui: &Ui) -> Chosen {
        let (mut open, mut chosen) = (true, Chosen::Nothing);
        let title = if self.what == Browse::Open { "Open a graph" } else { "Save the graph" };
        Window::new(title).open(&mut open).collapsible(false).default_width(460.0).show(ui.ctx(), |ui| {
            ui.label(RichText::new(self.folder.display().to_string()).monospace());
            ScrollArea::vertical().max_height(300.0).auto_shrink(false).show(ui, |ui| {
                let mut go = None;
                if self.folder.parent().is_some() && ui.selectable_label(false, "..").clicked() {
                    go = self.folder.parent().map(Path::to_owned);
                }
                for (name, is_folder) in &self.entries {
                    let words = if *is_folder { format!("{name}/") } else { name.clone() };
                    let row = ui.selectable_label(*name == self.name, words);
                    if row.clicked() && *is_folder {
                        go = Some(self.folder.join(name));
                    } else if row.clicked() {
                        self.name.clone_from(name);
                    }
                    if row.double_clicked() && !is_folder && self.what == Browse::Open {
                        chosen = Chosen::Open(self.folder.join(name));
                    }
                }
                if let Some(folder) = go {
                    self.folder = folder;
                    self.read();
                }
            });
            ui.horizontal(|ui| {
                let field = ui.add(TextEdit::singleline(&mut self.name).desired_width(300.0).hint_text("file or path"));
                let enter = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
                let words = match (self.what, &self.over) {
                    (Browse::Open, _) => "Open",
                    (Browse::Save, None) => "Save",
                    (Browse::Save, Some(_)) => "Write over it",
                };
                if ui.button(words).clicked() || enter {
                    chosen = self.choose();
                }
            });
            if let Some(error) = &self.error {
                ui.colored_label(ui.visuals().error_fg_color, error);
            }
        });
        let escaped = ui.input(|i| i.key_pressed(Key::Escape));
        if (!open || escaped) && chosen == Chosen::Nothing { Chosen::Closed } else { chosen }
    }

    fn choose(&mut self) -> Chosen {
        let path = self.folder.join(self.name.trim());
        if self.name.trim().is_empty() {
            return Chosen::Nothing;
        }
        if self.what == Browse::Open {
            if path.is_dir() && crate::model::file::find(&path).is_err() {
                (self.folder, self.name) = (path, String::new());
                self.read();
                return Chosen::Nothing;
            }
            if !path.exists() {
                self.error = Some(format!("{} is not there", path.display()));
                return Chosen::Nothing;
            }
            return Chosen::Open(path);
        }
        let path = if path.extension().is_none() { PathBuf::from(format!("{}{ENDING}", path.display())) } else { path };
        if path.exists() && self.over.as_ref() != Some(&path) {
            self.error = Some(format!("{} is there already", path.display()));
            self.over = Some(path);
            return Chosen::Nothing;
        }
        Chosen::Save(path)
    }
}
