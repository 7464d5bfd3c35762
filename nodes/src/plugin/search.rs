//! Where plugins are looked for, and what a graph that names plugins lacks. Nothing is ever loaded from the working
//! directory unless it is named.

use super::wanted::Need;
use super::{Plugin, PluginError, Wanted, register};
use std::env;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_engine::{Diagnostic, Registry};
use tenon_plugin::load::LoadFault;

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
    /// Plugins of versions that the graph does not take; nothing of them is registered.
    pub unfit: Vec<Arc<Plugin>>,
    /// Libraries in folders that were refused; nothing of them is registered.
    pub refused: Vec<PluginError>,
}

/// Loads the named libraries and those in folders, in order. The first of an id wins. What is wanted and not there is told
/// by the registry from then on: nodes of missing plugins say what to install.
///
/// # Errors
/// If a named library is refused; those in folders are only told.
pub fn load_all(
    registry: &mut Registry,
    named: &[PathBuf],
    folders: &[PathBuf],
    wanted: &Wanted,
) -> Result<Found, PluginError> {
    let mut found = Found::default();
    for path in named {
        if !found.has(path) {
            found.load(registry, path, wanted)?;
        }
    }
    found.search(registry, folders.iter().flat_map(|folder| libraries(folder)), wanted);
    Ok(found)
}

/// The same where named libraries that are refused are only told, too, before those in folders.
pub fn load_willing(registry: &mut Registry, named: &[PathBuf], folders: &[PathBuf], wanted: &Wanted) -> Found {
    let mut found = Found::default();
    let libraries = folders.iter().flat_map(|folder| libraries(folder));
    found.search(registry, named.iter().cloned().chain(libraries), wanted);
    found
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
        path.canonicalize().is_ok_and(|path| self.plugins.iter().chain(&self.unfit).any(|p| p.path == path))
    }

    /// Loads what lies at these paths and lets the registry tell what is missing then.
    fn search(&mut self, registry: &mut Registry, paths: impl Iterator<Item = PathBuf>, wanted: &Wanted) {
        for path in paths {
            if !self.has(&path)
                && let Err(why) = self.load(registry, &path, wanted)
            {
                self.refused.push(why);
            }
        }
        for (id, why) in self.missing(wanted) {
            registry.register_absent(id, why);
        }
    }

    fn load(&mut self, registry: &mut Registry, path: &Path, wanted: &Wanted) -> Result<(), PluginError> {
        let plugin = Arc::new(wanted.load(path)?);
        match wanted.needs.get(&plugin.id) {
            Some(Ok(need)) if !fits(need, &plugin) => self.unfit.push(plugin),
            _ => {
                register(registry, &plugin)?;
                self.plugins.push(plugin);
            }
        }
        Ok(())
    }

    /// What is wanted and not there, by plugin id, with what would help.
    #[must_use]
    pub fn missing(&self, wanted: &Wanted) -> Vec<(String, Diagnostic)> {
        let lacks = |(id, need): (&String, _)| Some((id.clone(), self.lacks(id, need)?));
        wanted.needs.iter().filter_map(lacks).collect()
    }

    fn lacks(&self, id: &str, need: &Result<Need, String>) -> Option<Diagnostic> {
        let wrong = |message: String| Some(Diagnostic::error("missing-plugin", message));
        let need = match need {
            Ok(need) => need,
            Err(why) => {
                return wrong(format!("requires: what it says of the plugin {id} cannot be read: {why}"))
                    .map(|d| d.hint("write it like \">=1.2, <2\""));
            }
        };
        if self.plugins.iter().any(|p| p.id == id && fits(need, p)) {
            return None;
        }
        let wanted = &need.version;
        if let Some(plugin) = self.unfit.iter().chain(&self.plugins).find(|p| p.id == id) {
            let message = format!("the graph needs the plugin {id} {wanted}; what is there is {}", plugin.version);
            return wrong(message).map(|d| d.hint(format!("replace {}", plugin.path.display())));
        }
        // One that could not be asked in its process who it is may be the one that is missing.
        let unknown = |r: &PluginError| matches!(r, PluginError::Load(e) if matches!(e.why, LoadFault::Process(_)));
        let named = |r: &&PluginError| r.to_string().contains(id);
        let refused = self.refused.iter().find(named).or_else(|| self.refused.iter().find(|r| unknown(r)));
        let refused = refused.map(ToString::to_string);
        let place = user_folder().map_or_else(String::new, |f| format!("put its library into {}, or ", f.display()));
        let hint = refused.unwrap_or_else(|| format!("{place}name it with --plugin LIBRARY"));
        wrong(format!("the graph needs the plugin {id} {wanted}, which is not there")).map(|d| d.hint(hint))
    }
}

fn fits(need: &Need, plugin: &Plugin) -> bool {
    // A graph that asks for no version takes versions that are none, too.
    need.version == semver::VersionReq::STAR
        || semver::Version::parse(&plugin.version).is_ok_and(|v| need.version.matches(&v))
}
