//! What an evaluation tells: progress while it runs, a report at its end, and a log of what the cache did.

use crate::diagnostic::{Diagnostic, Severity};
use crate::value::Json;
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
            Self::Blocked => "blocked",
            Self::Failed => "failed",
            Self::Frozen => "frozen",
            Self::Disabled => "disabled",
            Self::Bypassed => "bypassed",
        }
    }
}

/// One line of the log. Nodes by id.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// The node ran.
    Executed(Arc<str>),
    /// Its result was remembered.
    MemoHit(Arc<str>),
    /// Nothing that depends on it needs to run: its inputs or its outputs are the same as before.
    CutOff(Arc<str>),
    /// It failed.
    Failed(Arc<str>),
    /// It is blocked by the second node.
    Blocked(Arc<str>, Arc<str>),
    /// Its outputs were dropped from memory; their digests stay.
    Evicted(Arc<str>),
    /// The evaluation was cancelled; nothing of it stands.
    Cancelled,
}

impl std::fmt::Display for Event {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Executed(n) => write!(f, "executed {n}"),
            Self::MemoHit(n) => write!(f, "memo {n}"),
            Self::CutOff(n) => write!(f, "cut off {n}"),
            Self::Failed(n) => write!(f, "failed {n}"),
            Self::Blocked(n, by) => write!(f, "blocked {n} by {by}"),
            Self::Evicted(n) => write!(f, "evicted {n}"),
            Self::Cancelled => f.write_str("cancelled"),
        }
    }
}

/// One node in a report.
#[derive(Clone, Debug, PartialEq)]
pub struct NodeReport {
    /// Its id.
    pub id: Arc<str>,
    /// Its node type.
    pub type_name: Arc<str>,
    /// What happened to it.
    pub happened: Happened,
    /// Time it ran.
    pub time: Duration,
    /// Bytes of its outputs.
    pub bytes: usize,
    /// Digest of its outputs; 0 without.
    pub digest: u128,
}

/// What an evaluation came to.
#[derive(Clone, Debug, Default)]
pub struct Report {
    /// Everything wrong with what was asked for, also from nodes that did not run again.
    pub diagnostics: Vec<Diagnostic>,
    /// The nodes that were looked at, in order of evaluation; nodes that nothing has reached are not here.
    pub nodes: Vec<NodeReport>,
    /// It was cancelled and published nothing.
    pub cancelled: bool,
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
    pub fn node(&self, id: &str) -> Option<&NodeReport> {
        self.nodes.iter().find(|n| &*n.id == id)
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
                    "id": &*n.id,
                    "type": &*n.type_name,
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
            "diagnostics": self.diagnostics.iter().map(|d| serde_json::to_value(d).unwrap_or_default()).collect::<Vec<_>>(),
            "nodes": nodes,
        })
    }
}
