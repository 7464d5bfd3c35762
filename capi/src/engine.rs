//! The engine: node types and settings that graphs share.

use crate::error::{Failure, guard, guard_or, tenon_error};
use crate::handle::{self, Object};
use crate::read;
use crate::text::{self, tenon_text};
use ::tenon_engine::{Json, Registry, nearest};
use std::ffi::c_char;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_nodes::plugin::{Sources, folders};

/// Node types and settings. Free it with `tenon_engine_free`; graphs that were loaded with it live on.
pub struct tenon_engine {
    _opaque: [u8; 0],
}

/// What a `tenon_engine` stands for.
pub struct Engine {
    /// The node types for graphs that require nothing of plugins.
    registry: Arc<Registry>,
    pub(crate) plugins: Arc<Sources>,
    pub(crate) threads: usize,
    pub(crate) cache_bytes: usize,
}

/// Settings of an engine. Set `size` to `sizeof(tenon_engine_config)` and the rest to 0 for the defaults.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct tenon_engine_config {
    /// Bytes of this struct.
    pub size: u32,
    /// Threads per graph; 0: as many as the machine has. Results do not depend on it.
    pub threads: u32,
    /// Memory for remembered results per graph, bytes; 0: 1 GiB.
    pub cache_bytes: u64,
    /// Paths of plugins to load, NUL-terminated UTF-8; one that is refused is an error.
    pub plugins: *const *const c_char,
    /// Number of `plugins`.
    pub plugin_count: u64,
    /// 1: also load the plugins in the folders of `TENON_PLUGIN_PATH` and in the user's folder; those that are refused
    /// are left out, and graphs that need them say so.
    pub search: u32,
    /// 0.
    pub flags: u32,
    /// Absolute paths of folders whose plugins are loaded, before those of `search`, NUL-terminated UTF-8; those that are
    /// refused are left out, and graphs that need them say so. Since 1.1, as all that follows.
    pub folders: *const *const c_char,
    /// Number of `folders`.
    pub folder_count: u64,
    /// Ids of plugins that run in processes of their own whatever a graph says, NUL-terminated UTF-8; `all`: each.
    pub isolate: *const *const c_char,
    /// Number of `isolate`.
    pub isolate_count: u64,
}

// SAFETY: plain data, size first.
unsafe impl read::Sized32 for tenon_engine_config {}

/// Makes an engine with every built-in node type and those of plugins. `config` may be NULL. All plugins are loaded here,
/// in this process unless `isolate` or the variable `TENON_PLUGIN_ISOLATION` says otherwise, so that their node types are
/// known; where they are evaluated each graph says. Fails if an argument is wrong or a plugin of `plugins` is refused.
/// [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_engine_new(
    config: *const tenon_engine_config,
    out: *mut *mut tenon_engine,
) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let default = tenon_engine_config {
            size: 0,
            threads: 0,
            cache_bytes: 0,
            plugins: std::ptr::null(),
            plugin_count: 0,
            search: 0,
            flags: 0,
            folders: std::ptr::null(),
            folder_count: 0,
            isolate: std::ptr::null(),
            isolate_count: 0,
        };
        // SAFETY: the header asks for NULL or a struct of that size.
        let config = unsafe { read::options(config, default, "config")? };
        if config.threads > 1024 {
            return Err(Failure::argument(format!("{} threads are asked for; 1024 is the most", config.threads)));
        }
        // SAFETY: the header asks for so many NUL-terminated strings each.
        let [named, inside, apart] = unsafe {
            [
                read::texts(config.plugins, config.plugin_count, "plugins")?,
                read::texts(config.folders, config.folder_count, "folders")?,
                read::texts(config.isolate, config.isolate_count, "isolate")?,
            ]
        };
        if let Some(relative) = inside.iter().find(|folder| !Path::new(folder).is_absolute()) {
            return Err(Failure::argument(format!("the folder {relative} is not an absolute path")));
        }
        let searched = if config.search == 0 { Vec::new() } else { folders() };
        let plugins = Sources::new(
            named.into_iter().map(PathBuf::from).collect(),
            inside.into_iter().map(PathBuf::from).chain(searched).collect(),
            apart.into_iter().map(str::to_owned).collect(),
        );
        let registry = plugins.plain().map_err(|e| Failure::argument(e.to_string()))?;
        let cache_bytes = if config.cache_bytes == 0 { 1 << 30 } else { config.cache_bytes };
        let engine = Engine {
            registry,
            plugins: plugins.into(),
            threads: config.threads as usize,
            cache_bytes: usize::try_from(cache_bytes).unwrap_or(usize::MAX),
        };
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(handle::give(Object::Engine(engine.into()))) };
        Ok(())
    })
}

/// Frees an engine. NULL and engines that were freed before do nothing. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_engine_free(engine: *mut tenon_engine) {
    guard_or((), || {
        handle::free(engine);
        Ok(())
    });
}

/// Describes a node type as JSON: name, doc, ports with type, unit, range and default; all node types as a list if
/// `type_name` is NULL. Fails if there is no such node type. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_engine_describe(
    engine: *const tenon_engine,
    type_name: *const c_char,
    out: *mut *mut tenon_text,
) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let engine = handle::engine(engine)?;
        let json = if type_name.is_null() {
            Json::Array(engine.registry.iter().map(|t| t.describe()).collect())
        } else {
            // SAFETY: not NULL; the header asks for a NUL-terminated string.
            let name = unsafe { read::text(type_name, "type_name")? };
            let Some(node_type) = engine.registry.get(name) else {
                let near = nearest(name, engine.registry.iter().map(|t| t.type_name()));
                let hint = near.map(|n| format!("; did you mean \"{n}\"?")).unwrap_or_default();
                return Err(Failure::argument(format!("there is no node type \"{name}\"{hint}")));
            };
            node_type.describe()
        };
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(text::give(json.to_string())) };
        Ok(())
    })
}
