//! What an evaluation tells: progress while it runs, a report at its end, and a log of what the cache did.

use crate::diagnostic::{Diagnostic, Severity};
use crate::plan::texts::Texts;
use crate::value::digest::Packed;
use crate::value::{Json, Tree};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// How to stop an evaluation and hear of its progress.
#[derive(Clone, Default)]
pub struct Control<'a> {
    /// Set it to true from any thread to stop.
    pub cancel: Arc<AtomicBool>,
    /// Called at most about 30 times a second, from any thread.
    pub on_progress: Option<&'a (dyn Fn(&Progress) + Sync)>,
}

/// How far an evaluation is.
#[derive(Clone, Debug, PartialEq)]
pub struct Progress {
    /// Fraction done by expected cost, 0 to 1, never falling.
    pub fraction: f64,
    /// The node that reports, or was begun.
    pub node: Arc<str>,
}

/// What happened to a node in one evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Happened {
    /// It ran.
    Executed,
    /// Its inputs turned out the same as before; it did not run.
    CutOff,
    /// Its result was remembered from an earlier run with the same inputs.
    Memo,
    /// Its result was kept from an earlier process with the same inputs.
    Disk,
    /// Something that it depends on failed or is missing.
    Blocked,
    /// It failed, or cannot run as the document stands.
    Failed,
    /// It keeps its last output.
    Frozen,
    /// It is disabled.
    Disabled,
    /// It passes its inputs on.
    Bypassed,
}

impl Happened {
    /// Its name in reports.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Executed => "executed",
            Self::CutOff => "cut-off",
            Self::Memo => "memo",
            Self::Disk => "disk",
            Self::Blocked => "blocked",
            Self::Failed => "failed",
            Self::Frozen => "frozen",
            Self::Disabled => "disabled",
            Self::Bypassed => "bypassed",
        }
    }
}

/// One line of the log; nodes by id, inside the engine by number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Event<N> {
    /// The node ran.
    Executed(N),
    /// Its result was remembered.
    MemoHit(N),
    /// Its result was kept from an earlier process.
    DiskHit(N),
    /// Nothing that depends on it needs to run: its inputs or its outputs are the same as before.
    CutOff(N),
    /// It failed.
    Failed(N),
    /// It is blocked by the second node.
    Blocked(N, N),
    /// Its outputs were dropped from memory; their digests stay.
    Evicted(N),
    /// The evaluation was cancelled; nothing of it stands.
    Cancelled,
}

impl<N> Event<N> {
    fn map<M>(self, f: impl Fn(N) -> M) -> Event<M> {
        match self {
            Self::Executed(n) => Event::Executed(f(n)),
            Self::MemoHit(n) => Event::MemoHit(f(n)),
            Self::DiskHit(n) => Event::DiskHit(f(n)),
            Self::CutOff(n) => Event::CutOff(f(n)),
            Self::Failed(n) => Event::Failed(f(n)),
            Self::Blocked(n, by) => Event::Blocked(f(n), f(by)),
            Self::Evicted(n) => Event::Evicted(f(n)),
            Self::Cancelled => Event::Cancelled,
        }
    }
}

impl<N: std::fmt::Display> std::fmt::Display for Event<N> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Executed(n) => write!(f, "executed {n}"),
            Self::MemoHit(n) => write!(f, "memo {n}"),
            Self::DiskHit(n) => write!(f, "disk {n}"),
            Self::CutOff(n) => write!(f, "cut off {n}"),
            Self::Failed(n) => write!(f, "failed {n}"),
            Self::Blocked(n, by) => write!(f, "blocked {n} by {by}"),
            Self::Evicted(n) => write!(f, "evicted {n}"),
            Self::Cancelled => f.write_str("cancelled"),
        }
    }
}

/// A log of events: a few bytes each, whatever the nodes are called.
#[derive(Clone, Debug, Default)]
pub struct Events {
    /// What was logged before the document was exchanged, with the ids of then.
    past: Vec<(Arc<Texts>, Vec<Event<u32>>)>,
    ids: Arc<Texts>,
    now: Vec<Event<u32>>,
}

impl Events {
    pub(crate) fn new(ids: Arc<Texts>) -> Self {
        Self { past: Vec::new(), ids, now: Vec::new() }
    }

    pub(crate) fn push(&mut self, event: Event<u32>) {
        self.now.push(event);
    }

    /// From now on nodes have other numbers.
    pub(crate) fn renumber(&mut self, ids: Arc<Texts>) {
        let old = std::mem::replace(&mut self.ids, ids);
        if !self.now.is_empty() {
            self.past.push((old, std::mem::take(&mut self.now)));
        }
    }

    /// Takes everything; the ids stay.
    pub(crate) fn take(&mut self) -> Self {
        let fresh = Self::new(self.ids.clone());
        std::mem::replace(self, fresh)
    }

    /// Makes room for the events of so many nodes.
    pub(crate) fn reserve(&mut self, nodes: usize) {
        self.now.reserve(nodes);
    }

    /// How much was logged since the document was exchanged.
    pub(crate) fn mark(&self) -> usize {
        self.now.len()
    }

    pub(crate) fn truncate(&mut self, mark: usize) {
        self.now.truncate(mark);
    }

    /// The events in order.
    pub fn iter(&self) -> impl Iterator<Item = Event<&str>> {
        let past = self.past.iter().map(|(ids, events)| (ids, events));
        past.chain([(&self.ids, &self.now)])
            .flat_map(|(ids, events)| events.iter().map(move |event| event.map(|n| &ids[n as usize])))
    }

    /// Number of events.
    #[must_use]
    pub fn len(&self) -> usize {
        self.now.len() + self.past.iter().map(|(_, events)| events.len()).sum::<usize>()
    }

    /// True if nothing happened.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// The same happened to the same nodes in the same order.
impl PartialEq for Events {
    fn eq(&self, other: &Self) -> bool {
        self.len() == other.len() && self.iter().eq(other.iter())
    }
}

/// One node in a report.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeReport<'a> {
    /// Its id.
    pub id: &'a str,
    /// Its node type.
    pub type_name: &'a str,
    /// What happened to it.
    pub happened: Happened,
    /// Time it ran. Of cheap nodes that ran one after another each has the mean: reading the clock takes as long as they do.
    pub time: Duration,
    /// Bytes of its outputs.
    pub bytes: usize,
    /// Digest of its outputs; 0 without.
    pub digest: u128,
}

/// What a report keeps of a node.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Row {
    pub node: u32,
    pub node_type: u32,
    /// Nanoseconds that it ran.
    pub time: f32,
    pub happened: Happened,
    pub bytes: usize,
    pub digest: Seen,
}

/// What came out, by its digest. That of a number is made when somebody asks for it.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Seen {
    Digest(Packed),
    Number(f64),
}

impl From<Seen> for u128 {
    fn from(seen: Seen) -> Self {
        match seen {
            Seen::Digest(digest) => digest.into(),
            Seen::Number(v) => Tree::item(v).digest(),
        }
    }
}

impl Row {
    fn time(&self) -> Duration {
        Duration::from_nanos(self.time as u64)
    }
}

/// The nodes of a report, in order of evaluation.
#[derive(Clone, Debug, Default)]
pub struct NodeReports {
    pub(crate) ids: Arc<Texts>,
    pub(crate) types: Arc<Texts>,
    pub(crate) rows: Vec<Row>,
}

impl NodeReports {
    /// The nodes in order of evaluation.
    pub fn iter(&self) -> impl Iterator<Item = NodeReport<'_>> {
        self.rows.iter().map(|row| NodeReport {
            id: &self.ids[row.node as usize],
            type_name: self.types.get(row.node_type as usize).unwrap_or("?"),
            happened: row.happened,
            time: row.time(),
            bytes: row.bytes,
            digest: row.digest.into(),
        })
    }

    /// Number of nodes.
    #[must_use]
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// True if no node was looked at.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

/// What an evaluation came to.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Everything wrong with what was asked for, also from nodes that did not run again.
    pub diagnostics: Vec<Diagnostic>,
    /// The nodes that were looked at, in order of evaluation; nodes that nothing has reached are not here.
    pub nodes: NodeReports,
    /// What went wrong with the store ([`crate::Options::store`]), as warnings. It never changes a result, so it is none of the
    /// graph's diagnostics.
    pub cache: Vec<Diagnostic>,
    /// It was cancelled and published nothing.
    pub cancelled: bool,
    /// The node that was cut short by that, by its path; of several at once the one that had run longest. None if it came
    /// between nodes.
    pub stopped_at: Option<Arc<str>>,
    /// Time it took.
    pub elapsed: Duration,
}

impl Report {
    /// True if a diagnostic is an error.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|d| d.severity == Severity::Error)
    }

    /// The node of that id, if it was looked at.
    #[must_use]
    pub fn node(&self, id: &str) -> Option<NodeReport<'_>> {
        self.nodes.iter().find(|n| n.id == id)
    }

    /// `{"cancelled", "elapsed_ms", "diagnostics": [...], "nodes": [{"id", "type", "happened", "time_ms", "bytes", "digest"}]}`.
    #[must_use]
    pub fn to_json(&self) -> Json {
        let ms = |d: Duration| d.as_secs_f64() * 1e3;
        let nodes: Vec<Json> = self
            .nodes
            .iter()
            .map(|n| {
                serde_json::json!({
                    "id": n.id,
                    "type": n.type_name,
                    "happened": n.happened.as_str(),
                    "time_ms": ms(n.time),
                    "bytes": n.bytes,
                    "digest": format!("{:032x}", n.digest),
                })
            })
            .collect();
        serde_json::json!({
            "cancelled": self.cancelled,
            "elapsed_ms": ms(self.elapsed),
            "diagnostics": self.diagnostics.iter().chain(&self.cache).map(|d| serde_json::to_value(d).unwrap_or_default()).collect::<Vec<_>>(),
            "nodes": nodes,
        })
    }
}
