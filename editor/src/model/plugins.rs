//! Plugins in the window: the libraries that were named or dropped, and those of the folders that every program of ours
//! searches. They are loaded beside the window, since a library may take its time to say who it is; until then nodes of it
//! are unknown. What a graph requires and is not there is told at the graph and at its nodes.

use super::Model;
use super::beside::spawn;
use super::catalog::Catalog;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use tenon_engine::{Diagnostic, Document, Json, Registry};
use tenon_nodes::plugin::{Found, Wanted, load_willing};

/// What is loaded besides the built-in nodes, and from where.
#[derive(Default)]
pub struct Plugins {
    /// Libraries that were named or dropped on the window.
    pub named: Vec<PathBuf>,
    /// Folders that are searched.
    pub folders: Vec<PathBuf>,
    /// All run in processes of their own.
    apart: bool,
    /// The program that becomes their processes; without one it is `tenon`.
    host: Option<PathBuf>,
    found: Found,
    /// The requirements that they are loaded for, or will be.
    loaded_for: Option<BTreeMap<String, Json>>,
    /// What is being loaded, all at once.
    coming: Option<Coming>,
    /// What else was asked for meanwhile, in words.
    next: Option<String>,
}

/// What is being loaded.
struct Coming {
    /// In words.
    what: String,
    /// The libraries that were named when it began.
    named: Vec<PathBuf>,
    done: Receiver<Loaded>,
}

/// The built-in node types with those of all libraries that can be loaded.
struct Loaded {
    registry: Registry,
    catalog: Catalog,
    found: Found,
}

impl Plugins {
    /// What is being loaded, in words; none if nothing is.
    #[must_use]
    pub fn loading(&self) -> Option<&str> {
        self.coming.as_ref().map(|c| c.what.as_str())
    }

    /// Begins to load all that is wanted now; if something is being loaded, as soon as that is done.
    fn load(&mut self, what: String, wake: Arc<dyn Fn() + Send + Sync>) {
        if self.coming.is_some() {
            self.next = Some(what);
            return;
        }
        let apart: &[String] = if self.apart { &["all".to_owned()] } else { &[] };
        let requires = self.loaded_for.clone().unwrap_or_default();
        let wanted = Wanted::new(&requires, apart).hosted_by(self.host.clone());
        let (named, folders) = (self.named.clone(), self.folders.clone());
        let asked = named.clone();
        let work = move || {
            let mut registry = tenon_nodes::registry();
            let found = load_willing(&mut registry, &asked, &folders, &wanted);
            Loaded { catalog: Catalog::new(&registry), registry, found }
        };
        let awake = wake.clone();
        let done = match spawn("plugins", move || awake(), work) {
            Ok((_, done)) => done,
            // Nobody answers, which is told as what could not be loaded.
            Err(_) => {
                wake();
                channel().1
            }
        };
        self.coming = Some(Coming { what, named, done });
    }

    /// What came of it, once it is done. Libraries that were refused are not asked for again.
    fn come(&mut self) -> Option<Result<Loaded, Diagnostic>> {
        let done = match self.coming.as_ref()?.done.try_recv() {
            Ok(loaded) => Some(loaded),
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => None,
        };
        let Coming { what, named, .. } = self.coming.take()?;
        if let Some(done) = &done {
            let all = || done.found.plugins.iter().chain(&done.found.unfit);
            self.named.retain(|path| !named.contains(path) || all().any(|plugin| plugin.path == *path));
        }
        Some(done.ok_or_else(|| Diagnostic::error("bad-plugin", format!("{what} could not be loaded"))))
    }

    /// Ids and versions of what is loaded.
    pub fn loaded(&self) -> impl Iterator<Item = (&str, &str, &Path)> {
        self.found.plugins.iter().map(|p| (p.id.as_str(), p.version.as_str(), p.path.as_path()))
    }
}

impl Model {
    /// The plugins that are loaded.
    #[must_use]
    pub fn plugins(&self) -> &Plugins {
        &self.plugins
    }

    /// Whether plugins that are loaded from now on run in processes of their own, whatever graphs say.
    pub fn run_plugins_apart(&mut self, apart: bool) {
        self.plugins.apart = apart;
    }

    /// The program that becomes the processes of plugins that run apart: it is called as `PROGRAM plugin host`.
    pub fn host_plugins_by(&mut self, program: Option<PathBuf>) {
        self.plugins.host = program;
    }

    /// Begins to load libraries besides those that are loaded, and to search `folders` if there are any. The document stays
    /// as it is; nodes whose types come with the plugins run once they are there. Which library is refused and why is told in
    /// [`Model::message`] then; the others are loaded all the same.
    pub fn load_plugins(&mut self, libraries: &[PathBuf], folders: &[PathBuf]) {
        for path in libraries.iter().map(|p| p.canonicalize().unwrap_or_else(|_| p.clone())) {
            if !self.plugins.named.contains(&path) {
                self.plugins.named.push(path);
            }
        }
        if !folders.is_empty() {
            self.plugins.folders = folders.to_vec();
        }
        self.message = None;
        self.plugins.loaded_for = Some(self.document.requires.clone());
        let names = libraries.iter().filter_map(|p| p.file_name()).map(|name| name.to_string_lossy());
        self.plugins.load(named(names), self.wake.clone());
    }

    /// Begins to load what a graph with such requirements takes, unless just these are there or on their way. Until then no
    /// plugin runs: it may be one that the graph does not take, or not in this process.
    pub(super) fn load_if_others(&mut self, requires: &BTreeMap<String, Json>) {
        let same = self.plugins.loaded_for.as_ref().map_or(requires.is_empty(), |there| there == requires);
        if same {
            return;
        }
        self.registry = Arc::new(tenon_nodes::registry());
        self.catalog = Catalog::new(&self.registry);
        self.plugins.found = Found::default();
        self.plugins.loaded_for = Some(requires.clone());
        self.plugins.load(named(requires.keys()), self.wake.clone());
    }

    /// Takes plugins that are loaded by now; true if there were any, or some that were refused.
    pub(super) fn take_plugins(&mut self) -> bool {
        let Some(loaded) = self.plugins.come() else { return false };
        match (loaded, self.plugins.next.take()) {
            (Err(why), next) => {
                self.message = Some(why);
                // The same graph opened again is another try.
                self.plugins.loaded_for = None;
                next.into_iter().for_each(|what| self.plugins.load(what, self.wake.clone()));
            }
            (Ok(loaded), next) => {
                let refused = loaded.found.refused.first();
                self.message = refused.map(|r| Diagnostic::error("bad-plugin", r.to_string())).or(self.message.take());
                match next {
                    Some(what) => self.plugins.load(what, self.wake.clone()),
                    None => self.take_types(loaded),
                }
            }
        }
        true
    }

    /// Takes other node types for the graph that is open.
    fn take_types(&mut self, loaded: Loaded) {
        self.registry = Arc::new(loaded.registry);
        self.catalog = loaded.catalog;
        self.plugins.found = loaded.found;
        // Nodes that were kept byte for byte are written as all others are from now on.
        if let Ok(saved) = Document::from_slice(self.saved.0.as_bytes()) {
            self.saved.0 = saved.to_string_canonical_for(&self.registry);
        }
        if self.history.steps() == (0, 0) {
            self.document.migrate(&self.registry);
        } else if let Err(refused) = self.become_like(self.document.clone()) {
            // What was done before speaks of the nodes as they were, so this is a step of its own.
            self.message = Some(refused);
        }
        self.catalog_for_here();
        self.revision += 1;
        self.shown = Vec::new();
        self.show();
        self.worker.open(self.registry.clone(), self.document.clone(), self.host());
    }
}

/// What is loaded, in words.
fn named(names: impl Iterator<Item = impl AsRef<str>>) -> String {
    let names = names.fold(String::new(), |all, name| match all.is_empty() {
        true => name.as_ref().to_owned(),
        false => format!("{all}, {}", name.as_ref()),
    });
    if names.is_empty() { "plugins".to_owned() } else { names }
}
