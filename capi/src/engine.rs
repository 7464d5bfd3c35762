//! The engine: node types and settings that graphs share.

use crate::error::{Failure, guard, guard_or, tenon_error};
use crate::handle::{self, Object};
use crate::read;
use crate::text::{self, tenon_text};
use ::tenon_engine::{Json, Registry, nearest};
use std::collections::BTreeMap;
use std::ffi::c_char;
use std::path::PathBuf;
use std::sync::Arc;
use tenon_nodes::plugin::{Found, Wanted, folders, load_all};

/// Node types and settings. Free it with `tenon_engine_free`; graphs that were loaded with it live on.
pub struct tenon_engine {
    _opaque: [u8; 0],
}

/// What a `tenon_engine` stands for.
pub struct Engine {
    pub(crate) registry: Arc<Registry>,
    pub(crate) plugins: Found,
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
}

// SAFETY: plain data, size first.
unsafe impl read::Sized32 for tenon_engine_config {}

/// Makes an engine with every built-in node type and those of plugins. `config` may be NULL. Fails if an argument is
/// wrong or a plugin is refused. [any thread]
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
        };
        // SAFETY: the header asks for NULL or a struct of that size.
        let config = unsafe { read::options(config, default, "config")? };
        if config.threads > 1024 {
            return Err(Failure::argument(format!("{} threads are asked for; 1024 is the most", config.threads)));
        }
        let mut named = Vec::new();
        // SAFETY: the header asks for so many NUL-terminated strings.
        for path in unsafe { read::texts(config.plugins, config.plugin_count, "plugins")? } {
            named.push(PathBuf::from(path));
        }
        let mut registry = tenon_nodes::registry();
        let folders = if config.search == 0 { Vec::new() } else { folders() };
        // Which plugins run apart is the policy's to say: graphs come later.
        let wanted = Wanted::new(&BTreeMap::new(), &[]);
        let plugins =
            load_all(&mut registry, &named, &folders, &wanted).map_err(|e| Failure::argument(e.to_string()))?;
        let cache_bytes = if config.cache_bytes == 0 { 1 << 30 } else { config.cache_bytes };
        let engine = Engine {
            registry: Arc::new(registry),
            plugins,
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
/// `type_name` is NULL. [any thread]
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
