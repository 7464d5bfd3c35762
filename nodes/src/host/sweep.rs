//! Rows of sweeps: evaluated, written whole or not at all, recognised again when they are there.
//!
//! A result is the folder `DIR/KEY` with `result.json` and `files/`. It is made under another name, synced and renamed.

use super::graph::{self, GraphError};
use super::made::{self, Made};
use super::output::{self, Staged, WriteError};
use crate::plugin::Sources;
use std::collections::{HashMap, HashSet};
use std::fs::{self, File, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicU32, Ordering};
use tenon_engine::sweep::{Row, RowEvaluator, seal, unseal};
use tenon_engine::{Control, Diagnostic, Host, Json, Options, Severity, Store, digest_bytes};

/// Name of the file that says what a row came to.
const RESULT: &str = "result.json";

/// Ending of folders that are not results (yet).
const TEMPORARY: &str = ".tmp";

/// A row of a plan, and its graph's file from here.
#[derive(Clone, Debug)]
pub struct Planned {
    /// The row.
    pub row: Row,
    /// The graph's file.
    pub graph: PathBuf,
}

impl Planned {
    /// A row of a plan that lies in `folder`.
    #[must_use]
    pub fn new(row: Row, folder: &Path) -> Self {
        Self { graph: folder.join(&row.graph), row }
    }
}

/// Why a row could not be evaluated.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// Its graph cannot be read.
    #[error(transparent)]
    Graph(#[from] GraphError),
    /// The graph or the program has changed since the plan was made.
    #[error("{}, or the program, is another than when row {key} was planned", .graph.display())]
    Stale {
        /// The graph's file.
        graph: PathBuf,
        /// The row's key.
        key: String,
    },
    /// An input refuses a value.
    #[error("row {key} sets a value that its input refuses")]
    Refused {
        /// The row's key.
        key: String,
        /// What the input says.
        because: Box<Diagnostic>,
    },
    /// A result cannot be written.
    #[error(transparent)]
    Write(#[from] WriteError),
    /// Somebody else works in the folder and wants to be alone there.
    #[error("another sweep works in {}", .dir.display())]
    Busy {
        /// The folder.
        dir: PathBuf,
    },
}

impl SweepError {
    /// Name of the kind of fault.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Graph(error) => error.code(),
            Self::Stale { .. } => "stale-plan",
            Self::Refused { .. } => "set",
            Self::Write(error) => error.code(),
            Self::Busy { .. } => "busy",
        }
    }

    /// What would help, where it is known.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::Graph(error) => error.hint(),
            Self::Stale { .. } => Some("make the plan again; what has not changed is not evaluated again".to_owned()),
            Self::Busy { .. } => Some("wait for it, or name another folder".to_owned()),
            Self::Refused { .. } | Self::Write(_) => None,
        }
    }
}

/// A session that evaluates row after row, so that what rows have in common is computed once.
pub struct Bench {
    plugins: Arc<Sources>,
    threads: usize,
    cache_bytes: usize,
    store: Option<Arc<dyn Store>>,
    loaded: Option<(PathBuf, RowEvaluator)>,
}

/// What a row came to.
pub struct RowResult {
    /// The content of its `result.json`.
    pub result: Json,
    /// All its diagnostics.
    pub diagnostics: Vec<Diagnostic>,
    /// What went wrong with the cache: of no matter to the result, and so not in it.
    pub cache: Vec<Diagnostic>,
}

impl Bench {
    /// A session of so many threads (0: all there are) and so much memory for results, bytes. `plugins`: besides the
    /// built-in node types, as each graph requires them.
    /// `store`: where results outlive it.
    #[must_use]
    pub fn new(plugins: Arc<Sources>, threads: usize, cache_bytes: usize, store: Option<Arc<dyn Store>>) -> Self {
        Self { plugins, threads, cache_bytes, store, loaded: None }
    }

    fn options(&self, host: Arc<dyn Host>) -> Options {
        Options { threads: self.threads, cache_bytes: self.cache_bytes, host, store: self.store.clone() }
    }

    /// Reads the row's graph, unless it is at hand.
    ///
    /// # Errors
    /// If it is not the graph that the plan was made for.
    pub fn load(&mut self, planned: &Planned) -> Result<&mut RowEvaluator, SweepError> {
        let at_hand = self.loaded.take().filter(|(graph, _)| *graph == planned.graph);
        let (_, evaluator) = match at_hand {
            Some(loaded) => self.loaded.insert(loaded),
            None => {
                let (_, document) = graph::load(&planned.graph)?;
                let host = Arc::new(graph::Files::new(&planned.graph, HashSet::new()));
                let options = self.options(host);
                let registry = self.plugins.registry(&document.requires);
                let evaluator = RowEvaluator::new(registry, document, options);
                self.loaded.insert((planned.graph.clone(), evaluator))
            }
        };
        if evaluator.takes(&planned.row) {
            return Ok(evaluator);
        }
        Err(SweepError::Stale { graph: planned.graph.clone(), key: planned.row.key.clone() })
    }

    /// Evaluates a row and writes its result into `dir`; `None` if it was cancelled: then nothing is written.
    ///
    /// # Errors
    /// A plan that is not this graph's, a value that an input refuses, a folder that cannot be written.
    pub fn evaluate(
        &mut self,
        planned: &Planned,
        control: &Control<'_>,
        dir: &Path,
    ) -> Result<Option<RowResult>, SweepError> {
        let evaluator = self.load(planned)?;
        let refused = |d| SweepError::Refused { key: planned.row.key.clone(), because: Box::new(d) };
        let report = evaluator.evaluate(&planned.row, control).map_err(refused)?;
        if report.cancelled {
            return Ok(None);
        }
        let made = write(evaluator, planned, report.diagnostics, dir)?;
        Ok(Some(RowResult { cache: report.cache, ..made }))
    }
}

/// Writes the result of the row that was evaluated last.
fn write(
    evaluator: &RowEvaluator,
    planned: &Planned,
    mut diagnostics: Vec<Diagnostic>,
    dir: &Path,
) -> Result<RowResult, SweepError> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let n = COUNT.fetch_add(1, Ordering::Relaxed);
    let key = &planned.row.key;
    let folder = Temporary(dir.join(format!(".{key}-{}-{n}{TEMPORARY}", std::process::id())));
    let _ = fs::remove_dir_all(&folder.0);
    let files_in = folder.0.join("files");
    fs::create_dir_all(&files_in).map_err(io_at(&files_in))?;
    let mut staged = Staged::default();
    let made = made::stage(&mut staged, evaluator.session().files(), Some(&files_in), false)?;
    diagnostics.extend(made.iter().filter_map(Made::diagnostic));
    let result = result(evaluator, planned, &diagnostics, &made, &folder.0);
    staged.add(&folder.0.join(RESULT), format!("{result:#}\n").as_bytes())?;
    staged.commit()?;
    let target = dir.join(key);
    if fs::rename(&folder.0, &target).is_err() {
        // Something is there: the same by another process, or what an older file or a damage has left.
        if !matches!(found(dir, planned, &mut Inputs::default()), Found::Finished(_)) {
            let old = Temporary(folder.0.with_extension("old.tmp"));
            fs::rename(&target, &old.0).map_err(io_at(&target))?;
            fs::rename(&folder.0, &target).map_err(io_at(&target))?;
        }
    }
    // The rename itself is durable once the folder is synced; systems that cannot sync folders say so here.
    let _ = File::open(dir).and_then(|f| f.sync_all());
    Ok(RowResult { result, diagnostics, cache: Vec::new() })
}

/// The content of `result.json`: without times, so that the same row always gives the same bytes.
fn result(
    evaluator: &RowEvaluator,
    planned: &Planned,
    diagnostics: &[Diagnostic],
    made: &[Made],
    folder: &Path,
) -> Json {
    let errors = diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
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
    seal(serde_json::json!({
        "key": planned.row.key,
        "set": planned.row.set,
        "ok": errors == 0 && made.iter().all(|f| !f.withheld),
        "values": evaluator.values(),
        "diagnostics": diagnostics,
        "files": files,
        "inputs": evaluator.inputs(),
    }))
}

fn io_at(path: &Path) -> impl FnOnce(io::Error) -> SweepError + '_ {
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

/// What there is of a row in a folder of results.
pub enum Found {
    /// Nothing.
    Nothing,
    /// Its result, whole, and the files that it came from are the same as today.
    Finished(Json),
    /// Its result, but a file that the graph reads is another one today.
    Outdated,
    /// Something that is not as it was written; what it is.
    Damaged(String),
}

/// What is said of a damaged result.
pub fn damage(planned: &Planned, file: &str) -> String {
    format!("{}: {file} is damaged; the row is evaluated again", planned.row.key)
}

/// Looks for the row's result in `dir`.
pub fn found(dir: &Path, planned: &Planned, inputs: &mut Inputs) -> Found {
    let folder = dir.join(&planned.row.key);
    if !folder.exists() {
        return Found::Nothing;
    }
    let text = fs::read(folder.join(RESULT)).ok();
    let sealed = text.as_deref().and_then(unseal).filter(|r| r["key"].as_str() == Some(&planned.row.key));
    let Some(result) = sealed else { return Found::Damaged(RESULT.to_owned()) };
    for file in result["files"].as_array().map_or(&[][..], Vec::as_slice) {
        let name = file["path"].as_str().unwrap_or_default();
        let bytes = output::inside(&folder, name).ok().and_then(|path| fs::read(path).ok());
        let digest = bytes.map(|bytes| format!("{:032x}", digest_bytes(&bytes)));
        if digest.is_none() || digest.as_deref() != file["digest"].as_str() {
            return Found::Damaged(name.to_owned());
        }
    }
    for (path, digest) in result["inputs"].as_object().into_iter().flatten() {
        if inputs.digest(&planned.graph, path).as_deref() != digest.as_str() {
            return Found::Outdated;
        }
    }
    Found::Finished(result)
}

/// The row's result in `dir`, if it is there, whole and of today's files.
pub fn finished(dir: &Path, planned: &Planned, inputs: &mut Inputs) -> Option<Json> {
    match found(dir, planned, inputs) {
        Found::Finished(result) => Some(result),
        _ => None,
    }
}

/// Keeps a folder of results from being cleared while somebody works in it. The system lets go of it when the process
/// ends, however it ends.
pub struct Lock(Option<File>);

impl Lock {
    fn file(dir: &Path) -> Result<File, SweepError> {
        let path = dir.join(".tenon-sweep.lock");
        File::options().create(true).truncate(false).write(true).open(&path).map_err(io_at(&path))
    }

    fn of(file: File, locked: Result<(), TryLockError>, dir: &Path) -> Result<Self, SweepError> {
        match locked {
            Ok(()) => Ok(Self(Some(file))),
            Err(TryLockError::WouldBlock) => Err(SweepError::Busy { dir: dir.to_owned() }),
            // A file system without locks: results are whole all the same.
            Err(TryLockError::Error(_)) => Ok(Self(None)),
        }
    }

    /// Beside others that evaluate single rows.
    pub fn shared(dir: &Path) -> Result<Self, SweepError> {
        let file = Self::file(dir)?;
        let locked = file.try_lock_shared();
        Self::of(file, locked, dir)
    }

    /// Alone; clears away what killed processes have left.
    pub fn alone(dir: &Path) -> Result<Self, SweepError> {
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
