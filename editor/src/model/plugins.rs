//! Plugins in the window: the libraries that were named or dropped, and those of the folders that every program of ours
//! searches. What a graph requires and is not there is told at the graph and at its nodes.

use super::Model;
use super::catalog::Catalog;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_engine::{Diagnostic, Registry};
use tenon_nodes::plugin::{Found, load_all};

/// What is loaded besides the built-in nodes, and from where.
#[derive(Default)]
pub struct Plugins {
    /// Libraries that were named or dropped on the window.
    pub named: Vec<PathBuf>,
    /// Folders that are searched.
    pub folders: Vec<PathBuf>,
    found: Found,
    /// What the graph requires and is not there.
    pub(super) missing: Vec<Diagnostic>,
}

impl Plugins {
    /// The built-in node types with those of all libraries that can be loaded; what is wrong with the others.
    pub(super) fn load(&mut self) -> (Registry, Vec<Diagnostic>) {
        let (mut wrong, mut good) = (Vec::new(), Vec::new());
        for library in &self.named {
            good.push(library.clone());
            if let Err(refused) = load_all(&mut tenon_nodes::registry(), &good, &[]) {
                wrong.push(Diagnostic::error("bad-plugin", refused.to_string()));
                good.pop();
            }
        }
        self.named = good;
        let mut registry = tenon_nodes::registry();
        match load_all(&mut registry, &self.named, &self.folders) {
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
        let (registry, wrong) = self.plugins.load();
        self.registry = Arc::new(registry);
        self.catalog = Catalog::new(&self.registry);
        self.catalog.take_clusters(&self.document, &self.registry);
        self.look_for_plugins();
        self.revision += 1;
        self.shown = Vec::new();
        self.show();
        self.worker.open(self.registry.clone(), self.document.clone(), self.host());
        wrong.into_iter().next().map_or(Ok(()), Err)
    }

    /// Finds out what the graph requires and is not there.
    pub(super) fn look_for_plugins(&mut self) {
        self.plugins.missing = self.plugins.found.missing(&self.document.requires);
        for (id, node) in self.document.nodes() {
            let plugin = node.type_name.split_once('.').map(|(plugin, _)| plugin);
            let unknown = plugin.filter(|_| self.catalog.get(&node.type_name).is_none());
            let Some(plugin) = unknown else { continue };
            let why = self.plugins.missing.iter().find(|d| d.message.contains(plugin)).cloned();
            let message = match &why {
                Some(why) => why.message.clone(),
                None => format!("the node type {} would come with a plugin {plugin}", node.type_name),
            };
            let hint = why.and_then(|w| w.hint.map(|h| h.to_string()));
            let hint = hint.unwrap_or_else(|| "drop the plugin's library on the window".to_owned());
            self.plugins.missing.push(Diagnostic::error("missing-plugin", message).at(id.as_str()).hint(hint));
        }
    }
}
