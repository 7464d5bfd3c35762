//! A graph: load, save, set, edit, evaluate.

use crate::engine::{Engine, tenon_engine};
use crate::error::{Failure, guard, guard_or, tenon_error};
use crate::handle::{self, Object};
use crate::read;
use crate::result::{Evaluated, tenon_result};
use crate::text::{self, tenon_text};
use ::tenon_engine::{Control, Document, Host, Json, Node, Operation, Options, Progress, Session};
use std::ffi::{c_char, c_void};
use std::fs::File;
use std::io::{self, Read};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tenon_nodes::plugin::Wanted;
use tenon_plugin::abi::value::tenon_str;

/// One graph being worked on. Free it with `tenon_graph_free`. Any thread may call with it; calls wait for one another,
/// and while one evaluates only `tenon_graph_cancel` goes ahead.
pub struct tenon_graph {
    _opaque: [u8; 0],
}

/// What a `tenon_graph` stands for.
pub struct Graph {
    session: Mutex<Session>,
    /// The flag of the evaluation that runs, if one does.
    running: Mutex<Option<Arc<AtomicBool>>>,
}

/// The largest file that a node may read, bytes.
const LARGEST_INPUT: u64 = 4 << 30;

/// Files that nodes name, relative to a folder; none without a folder.
struct Folder(Option<PathBuf>);

impl Host for Folder {
    fn read(&self, path: &str) -> io::Result<Arc<[u8]>> {
        let Some(folder) = &self.0 else {
            return Err(io::Error::new(io::ErrorKind::Unsupported, "the graph was loaded without a folder"));
        };
        let mut bytes = Vec::new();
        File::open(folder.join(path))?.take(LARGEST_INPUT + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > LARGEST_INPUT {
            return Err(io::Error::new(
                io::ErrorKind::FileTooLarge,
                format!("larger than {} GiB", LARGEST_INPUT >> 30),
            ));
        }
        Ok(bytes.into())
    }
}

impl Graph {
    fn new(engine: &Engine, document: Document, folder: Option<PathBuf>) -> Self {
        let options = Options {
            threads: engine.threads,
            cache_bytes: engine.cache_bytes,
            host: Arc::new(Folder(folder)),
            ..Options::default()
        };
        let session = Session::new(engine.registry.clone(), document, options);
        Self { session: session.into(), running: Mutex::new(None) }
    }

    fn session(&self) -> MutexGuard<'_, Session> {
        self.session.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn edit(&self, operation: &Operation) -> Result<(), Failure> {
        self.session().edit(operation).map(|_| ()).map_err(|d| Failure::of(&[d]))
    }
}

/// Loads a graph from the `length` bytes of a `*.tenon.json` file. `folder` is where files that nodes name are looked
/// for; with NULL there are none. Node types that nobody knows are kept as they stand and are told by evaluation. Fails
/// if the text is no graph, with line and column, or requires plugins that are not there. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_load(
    engine: *const tenon_engine,
    json: *const c_char,
    length: u64,
    folder: *const c_char,
    out: *mut *mut tenon_graph,
) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let engine = handle::engine(engine)?;
        // SAFETY: the header asks for `length` readable bytes.
        let json = unsafe { read::bytes(json, length, "json")? };
        let folder = if folder.is_null() {
            None
        } else {
            // SAFETY: not NULL; the header asks for a NUL-terminated string.
            Some(PathBuf::from(unsafe { read::text(folder, "folder")? }))
        };
        let document = Document::from_slice(json).map_err(|d| Failure::of(&d))?;
        let missing = engine.plugins.missing(&Wanted::new(&document.requires, &[]));
        let missing: Vec<_> = missing.into_iter().map(|(_, why)| why).collect();
        if !missing.is_empty() {
            return Err(Failure::of(&missing));
        }
        let graph = Graph::new(&engine, document, folder);
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(handle::give(Object::Graph(graph.into()))) };
        Ok(())
    })
}

/// Frees a graph; results that it gave live on. An evaluation that runs is finished first. NULL and graphs that were
/// freed before do nothing. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_graph_free(graph: *mut tenon_graph) {
    guard_or((), || {
        handle::free(graph);
        Ok(())
    });
}

/// The graph as text in the canonical form, with all values set so far. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_save(graph: *const tenon_graph, out: *mut *mut tenon_text) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let graph = handle::graph(graph)?;
        let session = graph.session();
        let saved = session.document().to_string_canonical_for(session.registry());
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(text::give(saved)) };
        Ok(())
    })
}

/// Gives an interface input or a parameter (`node.port`) the value that the JSON text says; `null` brings the default
/// back. Nothing is evaluated, so many can be set at once; the same value as before costs nothing later. Fails, with
/// nothing changed, if the name is not known, the port has a wire, or the value is not accepted. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_set(
    graph: *mut tenon_graph,
    name: *const c_char,
    json: *const c_char,
) -> *mut tenon_error {
    guard(|| {
        let graph = handle::graph(graph)?;
        // SAFETY: the header asks for NUL-terminated strings.
        let (name, json) = unsafe { (read::text(name, "name")?, read::text(json, "json")?) };
        let value: Json = serde_json::from_str(json).map_err(|e| Failure::argument(format!("json: {e}")))?;
        graph.session().set(name, value).map_err(|d| Failure::of(&[d]))
    })
}

/// The same with a number. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_set_number(
    graph: *mut tenon_graph,
    name: *const c_char,
    value: f64,
) -> *mut tenon_error {
    guard(|| {
        let graph = handle::graph(graph)?;
        // SAFETY: the header asks for a NUL-terminated string.
        let name = unsafe { read::text(name, "name")? };
        if !value.is_finite() {
            return Err(Failure::argument(format!("{name}: {value} is not a finite number")));
        }
        graph.session().set(name, value.into()).map_err(|d| Failure::of(&[d]))
    })
}

/// Adds a node. Fails if the id is taken or has a dot in it. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_add_node(
    graph: *mut tenon_graph,
    id: *const c_char,
    type_name: *const c_char,
) -> *mut tenon_error {
    guard(|| {
        let graph = handle::graph(graph)?;
        // SAFETY: the header asks for NUL-terminated strings.
        let (id, type_name) = unsafe { (read::text(id, "id")?, read::text(type_name, "type_name")?) };
        let mut node = Node::new(type_name);
        if let Some(known) = graph.session().registry().get(type_name) {
            node.version = known.version();
        }
        graph.edit(&Operation::AddNode { id: id.to_owned(), node: Box::new(node) })
    })
}

/// Removes a node and the wires from it. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_remove_node(graph: *mut tenon_graph, id: *const c_char) -> *mut tenon_error {
    guard(|| {
        let graph = handle::graph(graph)?;
        // SAFETY: the header asks for a NUL-terminated string.
        let id = unsafe { read::text(id, "id")? };
        graph.edit(&Operation::RemoveNode { id: id.to_owned() })
    })
}

/// Wires `from` (`node.port`) to the input `port` of `node`, behind the wires that it has. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_connect(
    graph: *mut tenon_graph,
    from: *const c_char,
    node: *const c_char,
    port: *const c_char,
) -> *mut tenon_error {
    guard(|| {
        let graph = handle::graph(graph)?;
        // SAFETY: the header asks for NUL-terminated strings.
        let [from, node, port] =
            unsafe { [read::text(from, "from")?, read::text(node, "node")?, read::text(port, "port")?] };
        graph.edit(&Operation::Connect { node: node.into(), port: port.into(), from: from.into(), at: None })
    })
}

/// Takes a wire away. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_disconnect(
    graph: *mut tenon_graph,
    from: *const c_char,
    node: *const c_char,
    port: *const c_char,
) -> *mut tenon_error {
    guard(|| {
        let graph = handle::graph(graph)?;
        // SAFETY: the header asks for NUL-terminated strings.
        let [from, node, port] =
            unsafe { [read::text(from, "from")?, read::text(node, "node")?, read::text(port, "port")?] };
        graph.edit(&Operation::Disconnect { node: node.into(), port: port.into(), from: from.into() })
    })
}

/// What an interface lists: its inputs or its outputs.
pub type tenon_side_of_graph = u32;
/// Inputs.
pub const TENON_INPUTS: tenon_side_of_graph = 0;
/// Outputs.
pub const TENON_OUTPUTS: tenon_side_of_graph = 1;

/// Describes the interface as JSON: a list of objects with `name`, `doc`, `unit`, `ports` and, for inputs, `min`, `max`;
/// in order of their names. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_interface(
    graph: *const tenon_graph,
    side: tenon_side_of_graph,
    out: *mut *mut tenon_text,
) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let graph = handle::graph(graph)?;
        let session = graph.session();
        let document = session.document();
        let list: Json = match side {
            TENON_INPUTS => document
                .inputs
                .iter()
                .map(|(name, i)| {
                    serde_json::json!({ "name": name, "doc": i.doc, "unit": i.unit, "ports": i.ports,
                                        "min": i.min, "max": i.max })
                })
                .collect(),
            TENON_OUTPUTS => document
                .outputs
                .iter()
                .map(|(name, o)| serde_json::json!({ "name": name, "doc": o.doc, "unit": o.unit, "ports": [o.port] }))
                .collect(),
            other => {
                return Err(Failure::argument(format!("side is {other}; there are TENON_INPUTS and TENON_OUTPUTS")));
            }
        };
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(text::give(list.to_string())) };
        Ok(())
    })
}

/// How to evaluate. Set `size` to `sizeof(tenon_evaluate_options)` and the rest to 0 or NULL for the defaults.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct tenon_evaluate_options {
    /// Bytes of this struct.
    pub size: u32,
    /// 0.
    pub flags: u32,
    /// Given to `progress` as it is.
    pub context: *mut c_void,
    /// Called at most about 30 times a second with the fraction done, 0 to 1, and the node at work, from threads of the
    /// library, one call at a time. Giving 0 cancels. It must not call the library with the same graph, except
    /// `tenon_graph_cancel`, and must not throw.
    pub progress: Option<unsafe extern "C" fn(context: *mut c_void, fraction: f64, node: tenon_str) -> i32>,
}

// SAFETY: plain data and a function pointer that may be NULL, size first.
unsafe impl read::Sized32 for tenon_evaluate_options {}

/// The caller's context and function, called by one thread at a time.
struct Listener(Mutex<tenon_evaluate_options>);

// SAFETY: the context is only handed back to the caller's function, which the header asks to be fit for any thread.
unsafe impl Sync for Listener {}

impl Listener {
    fn hear(&self, progress: &Progress, cancel: &AtomicBool) {
        let options = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(call) = options.progress {
            // SAFETY: the caller gave function and context for each other; the text lives through the call.
            let go_on = unsafe { call(options.context, progress.fraction, tenon_str::of(&progress.node)) };
            if go_on == 0 {
                cancel.store(true, Ordering::Relaxed);
            }
        }
    }
}

/// Evaluates `count` outputs, each an interface output or `node.port`; with `count` 0 every interface output and every
/// node that makes files. Only what changed runs. Waits until it is done. The result holds what the outputs are now and
/// stays as it is whatever happens to the graph later; the caller frees it. That nodes failed is no error of this call:
/// the result says it. Fails if an argument is wrong. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_evaluate(
    graph: *mut tenon_graph,
    outputs: *const *const c_char,
    count: u64,
    options: *const tenon_evaluate_options,
    out: *mut *mut tenon_result,
) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let graph = handle::graph(graph)?;
        // SAFETY: the header asks for `count` NUL-terminated strings.
        let names = unsafe { read::texts(outputs, count, "outputs")? };
        let default = tenon_evaluate_options { size: 0, flags: 0, context: std::ptr::null_mut(), progress: None };
        // SAFETY: the header asks for NULL or a struct of that size.
        let listener = Listener(Mutex::new(unsafe { read::options(options, default, "options")? }));
        let listens = default_listens(&listener);
        let mut session = graph.session();
        let cancel = Arc::new(AtomicBool::new(false));
        *graph.running.lock().unwrap_or_else(PoisonError::into_inner) = Some(cancel.clone());
        let hear = |p: &Progress| listener.hear(p, &cancel);
        let control = Control { cancel: cancel.clone(), on_progress: if listens { Some(&hear) } else { None } };
        let report = session.evaluate(&names, &control);
        *graph.running.lock().unwrap_or_else(PoisonError::into_inner) = None;
        let evaluated = Evaluated::new(&session, &names, report);
        drop(session);
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(handle::give(Object::Result(evaluated.into()))) };
        Ok(())
    })
}

fn default_listens(listener: &Listener) -> bool {
    listener.0.lock().unwrap_or_else(PoisonError::into_inner).progress.is_some()
}

/// Stops the evaluation of this graph that runs, if one does: its result says that it was cancelled, and the graph is as
/// it was before. [any thread, also while the graph is evaluated]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_graph_cancel(graph: *const tenon_graph) {
    guard_or((), || {
        if let Some(flag) = &*handle::graph(graph)?.running.lock().unwrap_or_else(PoisonError::into_inner) {
            flag.store(true, Ordering::Relaxed);
        }
        Ok(())
    });
}
