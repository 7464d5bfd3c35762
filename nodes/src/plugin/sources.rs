//! Where a host that works on many graphs takes plugins from, and the node types for each of its graphs.

use super::search::load_willing;
use super::{PluginError, Wanted, load_all};
use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tenon_engine::{Json, Registry};

/// What a graph requires, by plugin id.
type Requires = BTreeMap<String, Json>;

/// Libraries and folders that a host names. Graphs that require the same have one registry, made when the first asks.
#[derive(Debug)]
pub struct Sources {
    named: Vec<PathBuf>,
    folders: Vec<PathBuf>,
    apart: Vec<String>,
    /// The youngest last.
    made: Mutex<Vec<(Requires, Arc<Registry>)>>,
}

/// Registries that are kept. A host has few graphs with few plugins; a registry made anew costs milliseconds.
const KEPT: usize = 16;

impl Sources {
    /// Named libraries, folders with libraries, and ids of plugins that run in processes of their own whatever a graph says
    /// (`all`: each).
    #[must_use]
    pub fn new(named: Vec<PathBuf>, folders: Vec<PathBuf>, apart: Vec<String>) -> Self {
        Self { named, folders, apart, made: Mutex::default() }
    }

    /// The built-in node types and those of the plugins, for graphs that require nothing of them.
    ///
    /// # Errors
    /// If a named library is refused; those in folders are left out.
    pub fn plain(&self) -> Result<Arc<Registry>, PluginError> {
        let mut registry = crate::registry();
        let wanted = Wanted::new(&Requires::new(), &self.apart);
        load_all(&mut registry, &self.named, &self.folders, &wanted)?;
        Ok(self.keep(&Requires::new(), registry))
    }

    /// The same as a graph with these `requires` wants it: versions, processes, limits. Libraries that are refused are left
    /// out, and nodes of what is required and not there say so.
    #[must_use]
    pub fn registry(&self, requires: &Requires) -> Arc<Registry> {
        let found = self.made().iter().find(|(of, _)| of == requires).map(|(_, registry)| registry.clone());
        found.unwrap_or_else(|| {
            let mut registry = crate::registry();
            load_willing(&mut registry, &self.named, &self.folders, &Wanted::new(requires, &self.apart));
            self.keep(requires, registry)
        })
    }

    fn made(&self) -> MutexGuard<'_, Vec<(Requires, Arc<Registry>)>> {
        self.made.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn keep(&self, requires: &Requires, registry: Registry) -> Arc<Registry> {
        let mut made = self.made();
        let registry = Arc::new(registry);
        if made.len() == KEPT {
            made.remove(0);
        }
        made.push((requires.clone(), registry.clone()));
        registry
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn graphs_that_require_the_same_share_a_registry() {
        let sources = Sources::new(Vec::new(), Vec::new(), Vec::new());
        let requires = |id: usize| BTreeMap::from([(format!("acme_{id}"), Json::from(">=1"))]);
        let plain = sources.plain().unwrap();
        assert!(Arc::ptr_eq(&plain, &sources.registry(&Requires::new())));
        let first = sources.registry(&requires(1));
        assert!(Arc::ptr_eq(&first, &sources.registry(&requires(1))));
        assert!(!Arc::ptr_eq(&plain, &first));
        // The oldest goes first, and is made again when it is asked for.
        for id in 2..=KEPT {
            let _ = sources.registry(&requires(id));
        }
        assert!(!Arc::ptr_eq(&plain, &sources.registry(&Requires::new())));
    }

    #[test]
    fn named_libraries_are_refused_at_once_and_left_out_later() {
        let sources = Sources::new(vec!["nowhere.so".into()], Vec::new(), Vec::new());
        assert!(sources.plain().unwrap_err().to_string().contains("nowhere.so"));
        assert!(sources.registry(&Requires::new()).get("thicken").is_some());
    }
}
