//! One row of a sweep: evaluated, written whole or not at all, recognised again when it is there.
//!
//! A result is the folder `DIR/KEY` with `result.json` and `files/`. It is made under another name, synced and renamed.

use super::plan::{self, Row};
use crate::files::{self, Made};
use crate::output::{self, Staged};
use crate::words::{Wrong, to_json};
use crate::{graph, output::WriteError};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use tenon_engine::{
    Control, Diagnostic, Document, Host, Json, NodeState, Options, Registry, Session, Severity, digest_bytes,
};

/// Name of the file that says what a row came to.
const RESULT: &str = "result.json";

/// Ending of folders that are not results (yet).
const TEMPORARY: &str = ".tmp";

/// Types of which values stand in the result; of the others only their digest and one line.
const PLAIN: [&str; 4] = ["number", "integer", "boolean", "text"];

/// Hands files on and remembers which, with their digests.
struct Recorder {
    files: graph::Files,
    seen: Mutex<BTreeMap<String, Option<u128>>>,
}

impl Host for Recorder {
    fn read(&self, path: &str) -> io::Result<Arc<[u8]>> {
        let read = self.files.read(path);
        let digest = read.as_ref().ok().map(|bytes| digest_bytes(bytes));
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned(), digest);
        read
    }
}

/// A session that evaluates row after row, so that what rows have in common is computed once.
pub struct Bench {
    registry: Arc<Registry>,
    threads: usize,
    cache_bytes: usize,
    loaded: Option<Loaded>,
}

struct Loaded {
    graph: PathBuf,
    document: Document,
    digest: u128,
    session: Session,
    recorder: Arc<Recorder>,
    names: Vec<String>,
}

/// What a row came to.
pub struct RowResult {
    /// The content of its `result.json`.
    pub result: Json,
    /// All its diagnostics.
    pub diagnostics: Vec<Diagnostic>,
}

impl Bench {
    /// A session of so many threads (0: all there are) and so much memory for results, bytes.
    pub fn new(threads: usize, cache_bytes: usize) -> Self {
        Self { registry: Arc::new(tenon_nodes::registry()), threads, cache_bytes, loaded: None }
    }

    /// Reads the row's graph, unless it is at hand.
    ///
    /// # Errors
    /// If it is not the graph that the plan was made for.
    pub fn load(&mut self, row: &Row) -> Result<(), Wrong> {
        if self.loaded.as_ref().is_none_or(|l| l.graph != row.graph) {
            let (_, document) = graph::load(&row.graph)?;
            let files = graph::Files::new(&row.graph, HashSet::new());
            let recorder = Arc::new(Recorder { files, seen: Mutex::default() });
            let options = Options { threads: self.threads, cache_bytes: self.cache_bytes, host: recorder.clone() };
            let digest = plan::digest(&document);
            let session = Session::new(self.registry.clone(), document.clone(), options);
            self.loaded =
                Some(Loaded { graph: row.graph.clone(), document, digest, session, recorder, names: Vec::new() });
        }
        match &self.loaded {
            Some(l) if plan::key(l.digest, &row.set) == row.key => Ok(()),
            _ => {
                let message = format!(
                    "{}, or the program, is another than when row {} was planned",
                    row.graph.display(),
                    row.key
                );
                Err(Wrong::new("stale-plan", message)
                    .hint("make the plan again; what has not changed is not evaluated again"))
            }
        }
    }

    /// Evaluates a row and writes its result into `dir`; `None` if it was cancelled: then nothing is written.
    ///
    /// # Errors
    /// A plan that is not this graph's, a value that an input refuses, a folder that cannot be written.
    pub fn evaluate(&mut self, row: &Row, control: &Control<'_>, dir: &Path) -> Result<Option<RowResult>, Wrong> {
        self.load(row)?;
        let Some(l) = &mut self.loaded else { return Ok(None) };
        let names: Vec<String> = row.set.keys().cloned().collect();
        if l.document.nodes().values().any(|node| node.state == NodeState::Frozen) {
            // A frozen node keeps what the row before has given it; a row's result must not depend on that.
            let options = Options { threads: self.threads, cache_bytes: self.cache_bytes, host: l.recorder.clone() };
            l.session = Session::new(self.registry.clone(), l.document.clone(), options);
        } else if l.names != names {
            // Inputs that only the row before has set go back to what the graph says.
            l.session.replace(l.document.clone());
            l.names = names;
        }
        for (name, value) in &row.set {
            let refused =
                |d| Wrong::new("set", format!("row {}: {name} = {value} cannot be done", row.key)).because(vec![d]);
            l.session.set(name, value.clone()).map_err(refused)?;
        }
        l.recorder.seen.lock().unwrap_or_else(PoisonError::into_inner).clear();
        let report = l.session.evaluate(&[], control);
        if report.cancelled {
            return Ok(None);
        }
        l.write(row, report.diagnostics, dir).map(Some)
    }
}

impl Loaded {
    fn write(&self, row: &Row, mut diagnostics: Vec<Diagnostic>, dir: &Path) -> Result<RowResult, Wrong> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let n = COUNT.fetch_add(1, Ordering::Relaxed);
        let folder = Temporary(dir.join(format!(".{}-{}-{n}{TEMPORARY}", row.key, std::process::id())));
        let _ = fs::remove_dir_all(&folder.0);
        let files_in = folder.0.join("files");
        fs::create_dir_all(&files_in).map_err(io_at(&files_in))?;
        let mut staged = Staged::default();
        let made = files::stage(&mut staged, self.session.files(), Some(&files_in), false)?;
        diagnostics.extend(made.iter().filter_map(Made::diagnostic));
        let result = self.result(row, &diagnostics, &made, &folder.0);
        staged.add(&folder.0.join(RESULT), format!("{result:#}\n").as_bytes())?;
        staged.commit()?;
        let target = dir.join(&row.key);
        if fs::rename(&folder.0, &target).is_err() {
            // Something is there: the same by another process, or what an older file or a damage has left.
            if finished(dir, row, &mut Inputs::default()).is_none() {
                let old = Temporary(folder.0.with_extension("old.tmp"));
                fs::rename(&target, &old.0).map_err(io_at(&target))?;
                fs::rename(&folder.0, &target).map_err(io_at(&target))?;
            }
        }
        // The rename itself is durable once the folder is synced; systems that cannot sync folders say so here.
        let _ = File::open(dir).and_then(|f| f.sync_all());
        Ok(RowResult { result, diagnostics })
    }

    /// The content of `result.json`: without times, so that the same row always gives the same bytes.
    fn result(&self, row: &Row, diagnostics: &[Diagnostic], made: &[Made], folder: &Path) -> Json {
        let errors = diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
        let mut values = serde_json::Map::new();
        for name in self.session.document().outputs.keys() {
            let value = self.session.value(name).map_or(Json::Null, |tree| {
                let digest = format!("{:032x}", tree.digest());
                let mut value =
                    serde_json::json!({ "type": tree.type_name(), "digest": digest, "summary": tree.summary() });
                if PLAIN.contains(&tree.type_name()) {
                    value["value"] = tree.to_json();
                }
                value
            });
            values.insert(name.clone(), value);
        }
        let files: Vec<Json> = made
            .iter()
            .map(|f| {
                let path = f.path();
                let path = path.as_deref().and_then(|p| p.strip_prefix(folder).ok()).and_then(Path::to_str);
                serde_json::json!({
                    "from": f.from,
                    "name": &*f.file.name,
                    "path": path,
                    "bytes": f.file.bytes.len(),
                    "digest": format!("{:032x}", digest_bytes(&f.file.bytes)),
                    "withheld": f.file.withheld.as_deref(),
                })
            })
            .collect();
        let seen = self.recorder.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let inputs: BTreeMap<&String, Option<String>> =
            seen.iter().map(|(path, digest)| (path, digest.map(|d| format!("{d:032x}")))).collect();
        serde_json::json!({
            "key": row.key,
            "set": row.set,
            "ok": errors == 0 && made.iter().all(|f| !f.withheld),
            "values": values,
            "diagnostics": to_json(diagnostics),
            "files": files,
            "inputs": inputs,
        })
    }
}

fn io_at(path: &Path) -> impl FnOnce(io::Error) -> Wrong + '_ {
    |error| WriteError::Io { path: path.to_owned(), error }.into()
}

/// A folder that goes away unless it was renamed.
struct Temporary(PathBuf);

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Digests of files that graphs read, each made once.
#[derive(Default)]
pub struct Inputs(HashMap<PathBuf, HashMap<String, Option<String>>>);

impl Inputs {
    fn digest(&mut self, graph: &Path, path: &str) -> Option<String> {
        let of_graph = self.0.entry(graph.to_owned()).or_default();
        let read = || graph::Files::new(graph, HashSet::new()).read(path).ok();
        of_graph
            .entry(path.to_owned())
            .or_insert_with(|| read().map(|bytes| format!("{:032x}", digest_bytes(&bytes))))
            .clone()
    }
}

/// The row's result in `dir`, if it is there and whole, and the files that it came from are the same as today.
pub fn finished(dir: &Path, row: &Row, inputs: &mut Inputs) -> Option<Json> {
    let folder = dir.join(&row.key);
    let result: Json = serde_json::from_slice(&fs::read(folder.join(RESULT)).ok()?).ok()?;
    if result["key"].as_str() != Some(&row.key) {
        return None;
    }
    for file in result["files"].as_array()? {
        let bytes = fs::read(output::inside(&folder, file["path"].as_str()?).ok()?).ok()?;
        if file["digest"].as_str()? != format!("{:032x}", digest_bytes(&bytes)) {
            return None;
        }
    }
    for (path, digest) in result["inputs"].as_object()? {
        if inputs.digest(&row.graph, path).as_deref() != digest.as_str() {
            return None;
        }
    }
    Some(result)
}

/// Keeps a folder of results from being cleared while somebody works in it. The system lets go of it when the process
/// ends, however it ends.
pub struct Lock(Option<File>);

impl Lock {
    fn file(dir: &Path) -> Result<File, Wrong> {
        let path = dir.join(".tenon-sweep.lock");
        File::options().create(true).truncate(false).write(true).open(&path).map_err(io_at(&path))
    }

    fn of(file: File, locked: Result<(), TryLockError>, dir: &Path) -> Result<Self, Wrong> {
        match locked {
            Ok(()) => Ok(Self(Some(file))),
            Err(TryLockError::WouldBlock) => {
                let message = format!("another sweep works in {}", dir.display());
                Err(Wrong::new("busy", message).hint("wait for it, or name another folder"))
            }
            // A file system without locks: results are whole all the same.
            Err(TryLockError::Error(_)) => Ok(Self(None)),
        }
    }

    /// Beside others that evaluate single rows.
    pub fn shared(dir: &Path) -> Result<Self, Wrong> {
        let file = Self::file(dir)?;
        let locked = file.try_lock_shared();
        Self::of(file, locked, dir)
    }

    /// Alone; clears away what killed processes have left.
    pub fn alone(dir: &Path) -> Result<Self, Wrong> {
        let file = Self::file(dir)?;
        let locked = file.try_lock();
        let lock = Self::of(file, locked, dir)?;
        if lock.0.is_some() {
            for entry in fs::read_dir(dir).map_err(io_at(dir))?.flatten() {
                let name = entry.file_name();
                if name.to_str().is_some_and(|n| n.starts_with('.') && n.ends_with(TEMPORARY)) && entry.path().is_dir()
                {
                    let _ = fs::remove_dir_all(entry.path());
                }
            }
        }
        Ok(lock)
    }
}
