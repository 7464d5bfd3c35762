//! Where plugins are looked for, and what a graph that names plugins lacks. Nothing is ever loaded from the working
//! directory unless it is named.

use super::{Plugin, PluginError, load};
use std::collections::BTreeMap;
use std::env;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_engine::{Diagnostic, Json, Registry};

/// The variable that names folders with plugins.
pub const VARIABLE: &str = "TENON_PLUGIN_PATH";

/// The folder of the user's own plugins; `None` if the system names no home.
#[must_use]
pub fn user_folder() -> Option<PathBuf> {
    let from = |name: &str| env::var_os(name).map(PathBuf::from).filter(|p| p.is_absolute());
    let data = if cfg!(windows) {
        from("APPDATA")
    } else if cfg!(target_os = "macos") {
        from("HOME").map(|home| home.join("Library/Application Support"))
    } else {
        from("XDG_DATA_HOME").or_else(|| from("HOME").map(|home| home.join(".local/share")))
    };
    data.map(|data| data.join("tenon").join("plugins"))
}

/// The folders that are searched, in order: those of `TENON_PLUGIN_PATH`, then the user's. Entries that are not absolute
/// are left out.
#[must_use]
pub fn folders() -> Vec<PathBuf> {
    let named = env::var_os(VARIABLE).unwrap_or_default();
    env::split_paths(&named).filter(|p| p.is_absolute()).chain(user_folder()).collect()
}

/// What was found.
#[derive(Debug, Default)]
pub struct Found {
    /// Plugins whose nodes are registered.
    pub plugins: Vec<Arc<Plugin>>,
    /// Libraries in folders that were refused; nothing of them is registered.
    pub refused: Vec<PluginError>,
}

/// Loads the named libraries and those in folders, in order. The first of an id wins.
///
/// # Errors
/// If a named library is refused; those in folders are only told.
pub fn load_all(registry: &mut Registry, named: &[PathBuf], folders: &[PathBuf]) -> Result<Found, PluginError> {
    let mut found = Found::default();
    for path in named {
        if !found.has(path) {
            found.plugins.push(load(registry, path)?);
        }
    }
    for path in folders.iter().flat_map(|folder| libraries(folder)) {
        if found.has(&path) {
            continue;
        }
        match load(registry, &path) {
            Ok(plugin) => found.plugins.push(plugin),
            Err(why) => found.refused.push(why),
        }
    }
    Ok(found)
}

/// The libraries in a folder, by name; none if it cannot be read.
fn libraries(folder: &Path) -> Vec<PathBuf> {
    let entries = folder.read_dir().into_iter().flatten().filter_map(Result::ok);
    let is_library = |p: &PathBuf| p.extension().is_some_and(|e| e == env::consts::DLL_EXTENSION);
    let mut all: Vec<PathBuf> = entries.map(|e| e.path()).filter(is_library).collect();
    all.sort();
    all
}

impl Found {
    fn has(&self, path: &Path) -> bool {
        path.canonicalize().is_ok_and(|path| self.plugins.iter().any(|p| p.path == path))
    }

    /// What a graph's `requires` (plugin id to version range, such as `">=1.2, <2"`) asks for and is not there.
    #[must_use]
    pub fn missing(&self, requires: &BTreeMap<String, Json>) -> Vec<Diagnostic> {
        requires.iter().filter_map(|(id, range)| self.lacks(id, range)).collect()
    }

    fn lacks(&self, id: &str, range: &Json) -> Option<Diagnostic> {
        let wrong = |message: String| Some(Diagnostic::error("missing-plugin", message));
        let Some(wanted) = range.as_str().and_then(|r| semver::VersionReq::parse(r).ok()) else {
            return wrong(format!("requires: {range} is no range of versions for the plugin {id}"))
                .map(|d| d.hint("write it like \">=1.2, <2\""));
        };
        let Some(plugin) = self.plugins.iter().find(|p| p.id == id) else {
            let refused = self.refused.iter().map(ToString::to_string).find(|r| r.contains(id));
            let place =
                user_folder().map_or_else(String::new, |f| format!("put its library into {}, or ", f.display()));
            let hint = refused.unwrap_or_else(|| format!("{place}name it with --plugin LIBRARY"));
            return wrong(format!("the graph needs the plugin {id} {wanted}, which is not there"))
                .map(|d| d.hint(hint));
        };
        let version = semver::Version::parse(&plugin.version).ok();
        if version.is_some_and(|v| wanted.matches(&v)) {
            return None;
        }
        let message = format!("the graph needs the plugin {id} {wanted}; what is there is {}", plugin.version);
        wrong(message).map(|d| d.hint(format!("replace {}", plugin.path.display())))
    }
}
