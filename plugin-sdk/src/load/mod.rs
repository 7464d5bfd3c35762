//! The host's side: loads a plugin, reads its descriptors into values of its own, and calls its nodes. A library is
//! trusted code: once loaded it can do what the program can do. Libraries are never unloaded.

mod call;
mod descriptor;
mod fences;
mod gate;
#[cfg(test)]
mod gate_tests;
mod layout;
mod migrate;
mod slot;
#[cfg(test)]
mod tests;

pub use call::{EvaluateError, Message, Sink, Views, Watch};
pub use slot::late_calls;

use crate::abi::layout::TYPE;
use crate::abi::plugin::*;
use crate::abi::value::*;
use crate::apart::Processes;
use std::ffi::c_void;
use std::ops::Deref;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What the gate is made of; its model in the tests has others.
mod atomic {
    pub use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering, fence};
    pub use std::thread::yield_now;
}

/// Why a plugin was not loaded.
#[derive(Debug, thiserror::Error)]
#[error("{}: {why}", .path.display())]
pub struct LoadError {
    /// The library.
    pub path: PathBuf,
    /// What is wrong with it.
    pub why: LoadFault,
}

/// What is wrong with a library.
#[derive(Debug, thiserror::Error)]
pub enum LoadFault {
    /// The system does not load it.
    #[error("cannot be loaded: {0}")]
    System(String),
    /// It is no plugin.
    #[error("is no plugin of Tenon: it does not export {SYMBOL}")]
    NoSymbol,
    /// The symbol leads to something else.
    #[error("{0}")]
    NotAPlugin(String),
    /// It was made for another contract.
    #[error(
        "was made for version {found} of the plugin contract, this program has version {TENON_PLUGIN_MAJOR}: {}",
        if *found > TENON_PLUGIN_MAJOR { "a newer Tenon loads it" } else { "build it with the plugin-sdk of this Tenon" }
    )]
    Version {
        /// Its major version.
        found: u32,
    },
    /// It was built from another source of the contract than its version says, or by a compiler that lays out otherwise.
    #[error(
        "{}\nbuild it anew, for this program's system, with the plugin-sdk of this Tenon (contract {TENON_PLUGIN_MAJOR}.{TENON_PLUGIN_MINOR})",
        misplaced(of, name, *theirs, *ours)
    )]
    Layout {
        /// The struct.
        of: String,
        /// The first field that differs; empty: the struct's size does.
        name: String,
        /// Where the plugin has it: bytes before it, its bytes.
        theirs: (u32, u32),
        /// Where this program has it.
        ours: (u32, u32),
    },
    /// Its process does not do what it should.
    #[error("{0}")]
    Process(String),
    /// A descriptor is wrong.
    #[error("{place}: {why}")]
    Descriptor {
        /// Which.
        place: String,
        /// What is wrong.
        why: String,
    },
}

fn misplaced(of: &str, name: &str, theirs: (u32, u32), ours: (u32, u32)) -> String {
    if name.is_empty() {
        return format!("{of} has {} bytes in the plugin and {} in this program", theirs.1, ours.1);
    }
    if let Some(field) = name.strip_suffix(TYPE) {
        return format!("{of}.{field} has another type in the plugin than in this program");
    }
    let place = |(offset, bytes)| format!("{bytes} bytes after {offset}");
    format!("{of}.{name} is {} in the plugin and {} in this program", place(theirs), place(ours))
}

/// A port of a plugin's node.
#[derive(Clone, Debug)]
pub struct PortInfo {
    /// Name.
    pub name: String,
    /// What it means.
    pub doc: String,
    /// `TENON_NUMBER` and so on.
    pub kind: tenon_kind,
    /// `TENON_ITEM` and so on.
    pub access: tenon_access,
    /// Sign of the unit; may be empty.
    pub unit: String,
    /// Default literal as JSON; may be empty.
    pub default_json: String,
    /// Smallest and largest number.
    pub range: Option<(f64, f64)>,
    /// Texts accepted; none: any.
    pub choices: Vec<String>,
    /// It may stay without a value.
    pub optional: bool,
}

/// What a node type of a plugin says of itself.
#[derive(Debug)]
pub struct NodeInfo {
    /// Name in graph files.
    pub id: String,
    /// Version.
    pub version: u32,
    /// Name for people.
    pub name: String,
    /// Where a palette shows it.
    pub category: String,
    /// What it does.
    pub doc: String,
    /// Other words to find it by.
    pub keywords: Vec<String>,
    /// Inputs.
    pub inputs: Vec<PortInfo>,
    /// Outputs.
    pub outputs: Vec<PortInfo>,
    /// Worth a thread of its own.
    pub slow: bool,
    /// The host makes the node around it.
    pub fastener: bool,
    /// The oldest version of which nodes can be brought forward; its own version if none can.
    pub migrate_from: u32,
}

/// A node type of a plugin: its description, and where it is evaluated.
#[derive(Debug)]
pub struct PluginNode {
    info: NodeInfo,
    body: Body,
}

impl Deref for PluginNode {
    type Target = NodeInfo;
    fn deref(&self) -> &NodeInfo {
        &self.info
    }
}

/// Where a node is evaluated.
#[derive(Debug)]
enum Body {
    /// In this process.
    Here { evaluate: Evaluate, migrate: Option<Migrate>, data: *mut c_void },
    /// In a process of its own, as the node of that index.
    Apart(Arc<Processes>, u32),
}

type Evaluate = unsafe extern "C" fn(*mut c_void, *const tenon_call, *const tenon_tree, u32) -> tenon_status;

type Migrate = unsafe extern "C" fn(*mut c_void, u32, tenon_str, tenon_give, *mut c_void) -> tenon_status;

// SAFETY: the contract asks that `data` may be used by many threads at once.
unsafe impl Send for Body {}
// SAFETY: see above.
unsafe impl Sync for Body {}

/// What a plugin says of itself, as it comes from another process.
#[cfg(target_os = "linux")]
pub(crate) struct PluginInfo {
    pub id: String,
    pub version: String,
    pub vendor: String,
    pub doc: String,
    pub nodes: Vec<NodeInfo>,
}

/// A loaded plugin.
#[derive(Debug)]
pub struct Plugin {
    /// Where it lies.
    pub path: PathBuf,
    /// Name in graph files.
    pub id: String,
    /// Version.
    pub version: String,
    /// Who made it.
    pub vendor: String,
    /// What it is for.
    pub doc: String,
    /// Its node types.
    pub nodes: Vec<PluginNode>,
}

impl Plugin {
    /// A plugin that is evaluated in processes of its own.
    #[cfg(target_os = "linux")]
    pub(crate) fn apart(path: PathBuf, info: PluginInfo, processes: &Arc<Processes>) -> Self {
        let PluginInfo { id, version, vendor, doc, nodes } = info;
        let nodes = (0..).zip(nodes).map(|(i, info)| PluginNode { info, body: Body::Apart(processes.clone(), i) });
        Self { path, id, version, vendor, doc, nodes: nodes.collect() }
    }

    /// Loads a library and reads what it says of itself. Its initialisers run; nothing is evaluated.
    ///
    /// # Errors
    /// Says what is wrong with it, and for descriptors, which.
    pub fn load(path: &Path) -> Result<Self, LoadError> {
        let fail = |why| LoadError { path: path.to_owned(), why };
        // An absolute path, so that the system does not search for it.
        let full = path.canonicalize().map_err(|e| fail(LoadFault::System(e.to_string())))?;
        // SAFETY: the library's initialisers run. The user named the library or its folder, which is the trust that
        // plugins need.
        let library = unsafe { libloading::Library::new(&full) };
        let library = library.map_err(|e| fail(LoadFault::System(e.to_string())))?;
        // SAFETY: a symbol of this name is a function of this type, says the contract.
        let entry = unsafe { library.get::<unsafe extern "C" fn() -> *const tenon_plugin>(SYMBOL.as_bytes()) };
        let entry = entry.map(|symbol| *symbol).map_err(|_| fail(LoadFault::NoSymbol))?;
        // Functions and descriptors are used for ever.
        std::mem::forget(library);
        // SAFETY: the contract: no arguments, and it gives a descriptor.
        let plugin = unsafe { entry() };
        // SAFETY: it comes from the entry.
        unsafe { Self::read(plugin, full) }.map_err(fail)
    }
}
