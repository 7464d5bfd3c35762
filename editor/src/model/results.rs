//! What the evaluation has found so far, in the form in which views ask for it.

use super::worker::{Done, Stage, Update};
use crate::scene::Drawing;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::time::Duration;
use tenon_engine::{Diagnostic, File, Happened, Progress, Severity, Tree};

/// What happened to a node when it was last looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NodeResult {
    /// What happened.
    pub happened: Happened,
    /// How long it ran when it last did.
    pub time: Duration,
    /// Bytes of its outputs.
    pub bytes: usize,
}

/// What the evaluation has found so far.
#[derive(Default)]
pub struct Results {
    /// Values by `node.port`.
    pub values: HashMap<String, Tree>,
    /// What happened to nodes, by id.
    pub nodes: HashMap<String, NodeResult>,
    /// All that is wrong, errors first.
    pub diagnostics: Vec<Diagnostic>,
    /// What the viewport shows, by `node.port`.
    pub drawings: BTreeMap<String, Arc<Drawing>>,
    /// The files that writers made, with the `node.port` that made them, in the order of node ids.
    pub files: Vec<(String, File)>,
    /// How far the running evaluation is.
    pub progress: Option<Progress>,
    /// How long the last evaluation of the whole graph took.
    pub elapsed: Duration,
    /// How long the last evaluation of what is shown took.
    pub shown_in: Duration,
    /// The last evaluation was stopped.
    pub cancelled: bool,
    /// Path of the node at which it was, if it told.
    pub stopped_at: Option<Arc<str>>,
    /// Counts what was taken.
    pub count: u64,
    /// Places in `diagnostics` by node, and by every instance that a node stands in.
    of: HashMap<String, Vec<u32>>,
    revision: u64,
    stage: Option<Stage>,
}

impl Results {
    pub(super) fn take(&mut self, update: Update) {
        match update {
            Update::Progress(progress) => self.progress = Some(progress),
            Update::Done(done) => self.done(*done),
            Update::Lost(_) => {}
        }
    }

    fn done(&mut self, done: Done) {
        self.count += 1;
        self.cancelled = done.report.cancelled;
        self.stopped_at = self.progress.take().map(|p| p.node).filter(|_| self.cancelled);
        self.revision = done.revision;
        self.stage = Some(done.stage);
        if done.report.cancelled {
            return;
        }
        match done.stage {
            Stage::Shown => self.shown_in = done.report.elapsed,
            Stage::All => self.elapsed = done.report.elapsed,
        }
        for n in done.report.nodes.iter() {
            let entry = self.nodes.entry(n.id.to_string());
            let node = entry.or_insert(NodeResult { happened: n.happened, time: n.time, bytes: n.bytes });
            // A node that did not run again keeps the time that it took when it did.
            let time = if n.happened == Happened::Executed { n.time } else { node.time };
            *node = NodeResult { happened: n.happened, time, bytes: n.bytes };
        }
        self.sum_instances();
        if done.stage == Stage::All {
            self.diagnostics = done.report.diagnostics;
            for fault in done.faults {
                if !self.diagnostics.contains(&fault) {
                    self.diagnostics.push(fault);
                }
            }
        } else {
            // Of what was not looked at, what is known stays until the whole graph has been.
            let seen = |d: &Diagnostic| d.node.as_deref().is_some_and(|id| done.report.node(id).is_some());
            self.diagnostics.retain(|d| !seen(d));
            for new in done.report.diagnostics {
                if !self.diagnostics.contains(&new) {
                    self.diagnostics.push(new);
                }
            }
        }
        self.diagnostics.sort_by(|a, b| b.severity.cmp(&a.severity).then_with(|| a.node.cmp(&b.node)));
        self.index();
        if done.stage == Stage::All {
            self.files = done.files;
        }
        self.values = done.values;
        self.drawings = done.drawings;
    }

    /// Notes which diagnostics are said of which node, since the canvas asks for every node at every frame.
    fn index(&mut self) {
        self.of.clear();
        for (i, diagnostic) in self.diagnostics.iter().enumerate() {
            let Some(node) = diagnostic.node.as_deref() else { continue };
            let ends = node.match_indices('/').map(|(at, _)| at).chain([node.len()]);
            for path in ends.filter_map(|end| node.get(..end)) {
                self.of.entry(path.to_owned()).or_default().push(i as u32);
            }
        }
    }

    /// What is inside an instance counts for the instance.
    fn sum_instances(&mut self) {
        let mut sums: HashMap<String, NodeResult> = HashMap::new();
        for (path, r) in &self.nodes {
            let Some((instance, _)) = path.split_once('/') else { continue };
            let sum = sums.entry(instance.to_owned()).or_insert(NodeResult { time: Duration::ZERO, bytes: 0, ..*r });
            sum.time += r.time;
            sum.bytes += r.bytes;
            if matches!(r.happened, Happened::Failed | Happened::Blocked) {
                sum.happened = r.happened;
            }
        }
        self.nodes.extend(sums);
    }

    pub(super) fn settled(&self, sent: u64) -> bool {
        self.revision == sent && self.stage == Some(Stage::All)
    }

    fn places(&self, id: &str) -> &[u32] {
        self.of.get(id).map_or(&[], Vec::as_slice)
    }

    /// All that is said of a node, or of what is inside an instance, the worst first. O(what is said of it).
    pub fn of_node<'a>(&'a self, id: &str) -> impl Iterator<Item = &'a Diagnostic> + use<'a> {
        self.places(id).iter().filter_map(|i| self.diagnostics.get(*i as usize))
    }

    /// The worst that is said of a node, and how many things are said of it. O(1).
    #[must_use]
    pub fn worst(&self, id: &str) -> Option<(&Diagnostic, usize)> {
        Some((self.of_node(id).next()?, self.places(id).len()))
    }

    /// Numbers of errors and warnings.
    #[must_use]
    pub fn counts(&self) -> (usize, usize) {
        let count = |s| self.diagnostics.iter().filter(|d| d.severity == s).count();
        (count(Severity::Error), count(Severity::Warning))
    }
}
