//! A graph: load, save, set, edit. Edits go to a draft and never wait for an evaluation, which gets them in its turn.

use crate::engine::{Engine, tenon_engine};
use crate::error::{Failure, guard, guard_or, tenon_error};
use crate::handle::{self, Object};
use crate::job::Job;
use crate::read;
use crate::text::{self, tenon_text};
use crate::turns::Turns;
use ::tenon_engine::{Diagnostic, Document, Draft, Given, Host, Json, Node, Operation, Options, Session, Tree};
use std::ffi::c_char;
use std::fs::File;
use std::io::{self, Read};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// One graph being worked on. Free it with `tenon_graph_free`. Any thread may call with it. Evaluations of one graph run
/// one after another, each of the graph as it was when it was asked for; setting, editing and saving never wait for them.
pub struct tenon_graph {
    _opaque: [u8; 0],
}

/// What a `tenon_graph` stands for.
pub struct Graph {
    draft: Mutex<Front>,
    pub(crate) session: Mutex<Session>,
    pub(crate) turns: Turns<Change>,
    /// The evaluations that run or wait for their turn.
    jobs: Mutex<Vec<Arc<Job>>>,
}

/// The graph as it stands, and what the session has not seen of it yet.
pub(crate) struct Front {
    pub(crate) draft: Draft,
    changes: Vec<Change>,
}

/// What a session is to do before it evaluates.
pub(crate) enum Change {
    Edit(Operation),
    Give(Given),
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
        let host = options.host.clone();
        let registry = engine.plugins.registry(&document.requires);
        let session = Session::new(registry.clone(), document, options);
        let draft = Draft::new(registry, host, session.document().clone());
        Self {
            draft: Front { draft, changes: Vec::new() }.into(),
            session: session.into(),
            turns: Turns::default(),
            jobs: Mutex::default(),
        }
    }

    pub(crate) fn front(&self) -> MutexGuard<'_, Front> {
        self.draft.lock().unwrap_or_else(PoisonError::into_inner)
    }

    pub(crate) fn jobs(&self) -> MutexGuard<'_, Vec<Arc<Job>>> {
        self.jobs.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn edit(&self, operation: Operation) -> Result<(), Failure> {
        self.front().edit(operation)
    }

    /// Gives a name a value that has no written form.
    pub(crate) fn give(&self, name: &str, tree: &Tree) -> Result<(), Failure> {
        let mut front = self.front();
        let given = front.draft.given(name, tree).map_err(|d| Failure::of(&[d]))?;
        front.changes.extend(given.into_iter().map(Change::Give));
        Ok(())
    }

    /// A place among the evaluations, for the graph as it stands now.
    pub(crate) fn queue(&self) -> u64 {
        let mut front = self.front();
        let changes = std::mem::take(&mut front.changes);
        // Under the lock, so that turns have the order of changes.
        self.turns.enter(changes)
    }
}

impl Front {
    fn edit(&mut self, operation: Operation) -> Result<(), Failure> {
        self.draft.apply(&operation).map_err(|d| Failure::of(&[d]))?;
        let place = |o: &Operation| match o {
            Operation::SetParam { node, port, .. } => Some((node.clone(), port.clone())),
            _ => None,
        };
        // Who sets one input again and again before evaluating wants the last value only.
        if let Some(Change::Edit(last)) = self.changes.last_mut()
            && place(last).is_some_and(|p| place(&operation) == Some(p))
        {
            *last = operation;
        } else {
            self.changes.push(Change::Edit(operation));
        }
        Ok(())
    }

    fn set(&mut self, name: &str, value: Json) -> Result<(), Failure> {
        let mut all = self.draft.settings([(name, value)]).map_err(|d| Failure::of(&[d]))?;
        match all.len() {
            0 => Ok(()),
            1 => self.edit(all.remove(0)),
            _ => self.edit(Operation::All(all)),
        }
    }
}

impl Change {
    pub(crate) fn apply(self, session: &mut Session) -> Result<(), Diagnostic> {
        match self {
            Self::Edit(operation) => session.edit(&operation).map(drop),
            Self::Give(given) => {
                session.give(&given);
                Ok(())
            }
        }
    }
}

/// Loads a graph from the `length` bytes of a `*.tenon.json` file. `folder` is where files that nodes name are looked
/// for; with NULL there are none. What it requires of plugins holds for it: versions, processes of their own, limits. Nodes
/// that nobody knows or whose plugin is missing are kept as they stand, and evaluation tells what to install. Fails if the
/// text is no graph, with line and column. [any thread]
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
        let graph = Graph::new(&engine, document, folder);
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(handle::give(Object::Graph(graph.into()))) };
        Ok(())
    })
}

/// Frees a graph; results that it gave live on, and evaluations under way go on to their end. NULL and graphs that were
/// freed before do nothing. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_graph_free(graph: *mut tenon_graph) {
    guard_or((), || {
        handle::free(graph);
        Ok(())
    });
}

/// The graph as text in the canonical form, with all values set so far. Fails if the graph is none. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_save(graph: *const tenon_graph, out: *mut *mut tenon_text) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let graph = handle::graph(graph)?;
        let saved = {
            let front = graph.front();
            front.draft.document().to_string_canonical_for(front.draft.registry())
        };
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
        graph.front().set(name, value)
    })
}

/// The same with a number. Fails as that does, and if the number is not finite. [any thread]
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
        graph.front().set(name, value.into())
    })
}

/// Adds a node. Fails if the id is taken or has a dot in it. A type that nobody knows is accepted: evaluation then says that
/// it is missing. [any thread]
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
        if let Some(known) = graph.front().draft.registry().get(type_name) {
            node.version = known.version();
        }
        graph.edit(Operation::AddNode { id: id.to_owned(), node: Box::new(node) })
    })
}

/// Removes a node and the wires from it. Fails if there is no such node. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_remove_node(graph: *mut tenon_graph, id: *const c_char) -> *mut tenon_error {
    guard(|| {
        let graph = handle::graph(graph)?;
        // SAFETY: the header asks for a NUL-terminated string.
        let id = unsafe { read::text(id, "id")? };
        graph.edit(Operation::RemoveNode { id: id.to_owned() })
    })
}

/// Wires `from` (`node.port`) to the input `port` of `node`, behind the wires that it has. Fails if one of the nodes is not
/// there, `from` is no `node.port` or the wire is there already. What the wire's ends are is not looked at here: evaluation
/// says what does not fit. [any thread]
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
        graph.edit(Operation::Connect { node: node.into(), port: port.into(), from: from.into(), at: None })
    })
}

/// Takes a wire away. Fails if there is no such wire. [any thread]
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
        graph.edit(Operation::Disconnect { node: node.into(), port: port.into(), from: from.into() })
    })
}
