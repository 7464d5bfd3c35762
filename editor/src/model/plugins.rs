//! Plugins in the window: the libraries that were named or dropped, and those of the folders that every program of ours
//! searches. What a graph requires and is not there is told at the graph and at its nodes.

use super::Model;
use super::catalog::Catalog;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_engine::{Diagnostic, Json, Registry};
use tenon_nodes::plugin::{Found, Wanted, load_all};

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
    /// The requirements that they were loaded for.
    loaded_for: Option<BTreeMap<String, Json>>,
}

impl Plugins {
    /// The built-in node types with those of all libraries that can be loaded; what is wrong with the others. Nodes of
    /// plugins that are required and not there say so themselves from then on.
    pub(super) fn load(&mut self, requires: &BTreeMap<String, Json>) -> (Registry, Vec<Diagnostic>) {
        let apart: &[String] = if self.apart { &["all".to_owned()] } else { &[] };
        let wanted = Wanted::new(requires, apart).hosted_by(self.host.clone());
        let (mut wrong, mut good) = (Vec::new(), Vec::new());
        for library in &self.named {
            good.push(library.clone());
            if let Err(refused) = load_all(&mut tenon_nodes::registry(), &good, &[], &wanted) {
                wrong.push(Diagnostic::error("bad-plugin", refused.to_string()));
                good.pop();
            }
        }
        self.named = good;
        let mut registry = tenon_nodes::registry();
        match load_all(&mut registry, &self.named, &self.folders, &wanted) {
            Ok(found) => {
                wrong.extend(found.refused.iter().map(|r| Diagnostic::error("bad-plugin", r.to_string())));
                self.found = found;
            }
            Err(refused) => wrong.push(Diagnostic::error("bad-plugin", refused.to_string())),
        }
        (registry, wrong)
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

    /// Loads libraries besides those that are loaded, and searches `folders` if there are any. The document stays as it is;
    /// nodes whose types come with the plugins run.
    ///
    /// # Errors
    /// Says which library was refused and why; the others are loaded all the same.
    pub fn load_plugins(&mut self, libraries: &[PathBuf], folders: &[PathBuf]) -> Result<(), Diagnostic> {
        let whole = libraries.iter().map(|p| p.canonicalize().unwrap_or_else(|_| p.clone()));
        self.plugins.named.extend(whole);
        self.plugins.named.dedup();
        if !folders.is_empty() {
            self.plugins.folders = folders.to_vec();
        }
        let wrong = self.load_for(&self.document.requires.clone());
        self.catalog.take_clusters(&self.document, &self.registry);
        self.revision += 1;
        self.shown = Vec::new();
        self.show();
        self.worker.open(self.registry.clone(), self.document.clone(), self.host());
        wrong.into_iter().next().map_or(Ok(()), Err)
    }

    /// Takes the node types that there are for a graph with such requirements.
    pub(super) fn load_for(&mut self, requires: &BTreeMap<String, Json>) -> Vec<Diagnostic> {
        let (registry, wrong) = self.plugins.load(requires);
        self.registry = Arc::new(registry);
        self.catalog = Catalog::new(&self.registry);
        self.plugins.loaded_for = Some(requires.clone());
        wrong
    }

    /// The same, unless they are taken for just these already.
    pub(super) fn load_if_others(&mut self, requires: &BTreeMap<String, Json>) {
        let same = self.plugins.loaded_for.as_ref().map_or(requires.is_empty(), |there| there == requires);
        if !same {
            self.message = self.load_for(requires).into_iter().next().or(self.message.take());
        }
    }
}
