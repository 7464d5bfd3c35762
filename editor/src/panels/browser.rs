//! Choosing a file or a folder: entries as a list, and a path that can be typed. Needs nothing of the desktop.

use crate::model::file::ENDING;
use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::{Key, RichText, ScrollArea, TextEdit, Ui, Window};
use std::path::{Path, PathBuf};

/// What a file is wanted for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Browse {
    /// A graph to be read.
    Open,
    /// A graph to be written.
    Save,
    /// A file that an input names.
    Input {
        /// The node.
        node: String,
        /// Its input.
        port: String,
    },
    /// The library of a plugin.
    Plugin,
    /// A mesh or a picture behind the model.
    Reference,
    /// A folder for the files that the graph makes.
    Export,
    /// A picture of the viewport.
    Picture,
}

impl Browse {
    /// The words at the top and on the button.
    #[must_use]
    pub fn words(&self) -> (&'static str, &'static str) {
        match self {
            Self::Open => ("Open a graph", "Open"),
            Self::Save => ("Save the graph", "Save"),
            Self::Input { .. } => ("Choose a file", "Take"),
            Self::Plugin => ("Load a plugin", "Load"),
            Self::Reference => ("Show a mesh or a picture behind the model", "Show"),
            Self::Export => ("Write the files of the graph into a folder", "Write here"),
            Self::Picture => ("Save a picture of the viewport", "Save"),
        }
    }

    /// Whether a file is written.
    #[must_use]
    pub fn writes(&self) -> bool {
        matches!(self, Self::Save | Self::Picture)
    }

    /// Endings of the files that will do; none: all.
    #[must_use]
    pub fn endings(&self) -> &'static [&'static str] {
        match self {
            Self::Open | Self::Save => &[ENDING],
            Self::Plugin => &[".so", ".dll", ".dylib"],
            Self::Reference => &[".obj", ".png", ".jpg", ".jpeg"],
            Self::Picture => &[".png"],
            Self::Input { .. } | Self::Export => &[],
        }
    }

    /// The folder to begin in and the name that is proposed, near a graph's file if there is one.
    #[must_use]
    pub fn proposed(&self, near: Option<&Path>) -> (PathBuf, String) {
        let here = || std::env::current_dir().unwrap_or_default();
        let folder =
            near.and_then(Path::parent).filter(|f| !f.as_os_str().is_empty()).map_or_else(here, Path::to_owned);
        let name = match (self, near.and_then(Path::file_name).and_then(|n| n.to_str())) {
            (Self::Save, Some(name)) => name.to_owned(),
            (Self::Save, None) => format!("new{ENDING}"),
            (Self::Picture, Some(name)) => format!("{}.png", name.strip_suffix(ENDING).unwrap_or(name)),
            (Self::Picture, None) => "viewport.png".to_owned(),
            (Self::Export, _) => "out".to_owned(),
            _ => String::new(),
        };
        (folder, name)
    }

    /// A path to be written, with the ending that it lacks.
    #[must_use]
    pub fn with_ending(&self, path: PathBuf) -> PathBuf {
        let ending = self.endings().first().copied().unwrap_or_default();
        if path.extension().is_none() { PathBuf::from(format!("{}{ending}", path.display())) } else { path }
    }
}

/// What came of a frame.
#[derive(Debug, PartialEq)]
pub enum Chosen {
    /// Nothing yet.
    Nothing,
    /// The window was closed.
    Closed,
    /// A file or folder.
    Path(PathBuf),
}

/// An open file window.
pub struct Browser {
    /// What it is for.
    pub what: Browse,
    folder: PathBuf,
    name: String,
    entries: Vec<(String, bool)>,
    error: Option<String>,
    /// A file of that name is there and may be written over.
    over: Option<PathBuf>,
    /// It was shown.
    begun: bool,
}

impl Browser {
    /// Opens at the folder of a graph, or where the program was started.
    #[must_use]
    pub fn new(what: Browse, near: Option<&Path>) -> Self {
        let (folder, name) = what.proposed(near);
        let folder = folder.canonicalize().unwrap_or(folder);
        let mut browser = Self { what, folder, name, entries: Vec::new(), error: None, over: None, begun: false };
        browser.read();
        browser
    }

    /// Opens with the name of a file that is to be written.
    #[must_use]
    pub fn at(what: Browse, file: &Path) -> Self {
        let name = file.file_name().unwrap_or_default().to_string_lossy().into_owned();
        Self { name, ..Self::new(what, Some(file)) }
    }

    fn read(&mut self) {
        self.entries.clear();
        match self.folder.read_dir() {
            Err(e) => self.error = Some(format!("{} cannot be read: {e}", self.folder.display())),
            Ok(entries) => {
                self.error = None;
                let endings = self.what.endings();
                for entry in entries.flatten() {
                    let (name, path) = (entry.file_name().to_string_lossy().into_owned(), entry.path());
                    let is_folder = path.is_dir();
                    let plain = name.to_lowercase();
                    let fits = endings.is_empty() || endings.iter().any(|e| plain.ends_with(e));
                    if !name.starts_with('.') && (is_folder || (fits && self.what != Browse::Export)) {
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
        let (title, verb) = self.what.words();
        Window::new(title).open(&mut open).collapsible(false).default_width(460.0).show(ui.ctx(), |ui| {
            ui.label(RichText::new(self.folder.display().to_string()).monospace());
            let room = (ui.ctx().content_rect().height() - 220.0).clamp(80.0, 300.0);
            ScrollArea::vertical().max_height(room).auto_shrink(false).show(ui, |ui| {
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
                    if row.double_clicked() && !is_folder && !self.what.writes() {
                        chosen = Chosen::Path(self.folder.join(name));
                    }
                }
                if let Some(folder) = go {
                    self.folder = folder;
                    self.read();
                }
            });
            ui.horizontal(|ui| {
                let field = ui.add(TextEdit::singleline(&mut self.name).desired_width(300.0).hint_text("file or path"));
                if !std::mem::replace(&mut self.begun, true) {
                    // So that a path can be typed at once, over the name that is proposed.
                    field.request_focus();
                    let mut state = TextEdit::load_state(ui.ctx(), field.id).unwrap_or_default();
                    let end = CCursor::new(self.name.chars().count());
                    state.cursor.set_char_range(Some(CCursorRange::two(CCursor::new(0), end)));
                    state.store(ui.ctx(), field.id);
                }
                let enter = field.lost_focus() && ui.input(|i| i.key_pressed(Key::Enter));
                let words = if self.over.is_some() { "Write over it" } else { verb };
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
        if self.what == Browse::Export {
            return Chosen::Path(path);
        }
        if self.name.trim().is_empty() {
            return Chosen::Nothing;
        }
        if !self.what.writes() {
            let graph = self.what == Browse::Open && crate::model::file::find(&path).is_ok();
            if path.is_dir() && !graph {
                (self.folder, self.name) = (path, String::new());
                self.read();
                return Chosen::Nothing;
            }
            if !path.exists() {
                self.error = Some(format!("{} is not there", path.display()));
                return Chosen::Nothing;
            }
            return Chosen::Path(path);
        }
        let path = self.what.with_ending(path);
        if path.exists() && self.over.as_ref() != Some(&path) {
            self.error = Some(format!("{} is there already", path.display()));
            self.over = Some(path);
            return Chosen::Nothing;
        }
        Chosen::Path(path)
    }
}
