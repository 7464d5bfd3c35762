//! Plugins as nodes: each node type that a library brings becomes one of the registry's.

pub(crate) mod fastener;
mod node;
mod search;
mod sources;
mod wanted;

pub use search::{Found, VARIABLE, folders, load_all, load_willing, user_folder};
pub use sources::Sources;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::SystemTime;
use tenon_engine::{Digester, Json, Registry, RegistryError, digest_bytes};
pub use tenon_plugin::load::{LoadError, Plugin};
pub use tenon_plugin::{apart, check};
pub use wanted::{HOST, POLICY, Wanted};

/// Why a plugin's nodes are not there.
#[derive(Debug, thiserror::Error)]
pub enum PluginError {
    /// The library was refused.
    #[error(transparent)]
    Load(#[from] LoadError),
    /// A node type was refused.
    #[error("{}: {why}", .path.display())]
    Register {
        /// The library.
        path: std::path::PathBuf,
        /// Why.
        why: RegistryError,
    },
    /// A port's description cannot be used.
    #[error("{}: {place}: {why}", .path.display())]
    Port {
        /// The library.
        path: std::path::PathBuf,
        /// Node type and port.
        place: String,
        /// What is wrong.
        why: String,
    },
}

/// Loads a library and registers its node types. If one is refused, none is registered. It stays loaded for ever.
///
/// # Errors
/// Says what is wrong with the library, a descriptor, or that a name is taken.
pub fn load(registry: &mut Registry, path: &Path) -> Result<Arc<Plugin>, PluginError> {
    let plugin = Arc::new(Plugin::load(path)?);
    register(registry, &plugin)?;
    Ok(plugin)
}

/// Registers the node types of a plugin that is loaded.
///
/// # Errors
/// As [`load`].
pub fn register(registry: &mut Registry, plugin: &Arc<Plugin>) -> Result<(), PluginError> {
    let mut made = Vec::new();
    let build = digest(&plugin.path);
    for index in 0..plugin.nodes.len() {
        made.push(node::node_type(plugin, index)?.build(build));
    }
    let refused = |why| PluginError::Register { path: plugin.path.clone(), why };
    for node in &made {
        if registry.get(node.type_name()).is_some() {
            return Err(refused(RegistryError::Duplicate(node.type_name().to_owned())));
        }
    }
    made.into_iter().try_for_each(|node| registry.register(node)).map_err(refused)?;
    for (index, node) in plugin.nodes.iter().enumerate() {
        for from in node.migrate_from..node.version {
            let plugin = plugin.clone();
            let step = move |json: Json| {
                let text = plugin.nodes[index].migrate(from, &json.to_string())?;
                serde_json::from_str(&text).map_err(|e| format!("the plugin gives what is not JSON: {e}"))
            };
            registry.register_migration(&node.id, from, step).map_err(refused)?;
        }
    }
    Ok(())
}

/// The digest of a library's file. One that cannot be read any more is another one each time: nothing is found of it.
fn digest(path: &Path) -> u128 {
    static AGAIN: AtomicU64 = AtomicU64::new(0);
    match std::fs::read(path) {
        Ok(bytes) => digest_bytes(&bytes),
        Err(_) => {
            let mut d = Digester::new();
            let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
            d.u128(now.as_nanos());
            d.u64(AGAIN.fetch_add(1, Ordering::Relaxed));
            d.finish()
        }
    }
}
