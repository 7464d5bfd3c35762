//! What the evaluation has found so far, in the form in which views ask for it.

use super::cut;
use super::worker::{Done, Stage, Update};
use crate::scene::Drawing;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use std::time::Duration;
use tenon_engine::{Diagnostic, Document, File, Happened, Node, Progress, Severity, Tree};

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
    /// Outputs whose values tell what the machine makes, as [`super::cut`] asks for them, in order.
    pub(super) made: Vec<String>,
    /// What happened to nodes and to instances as a whole, by path.
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
    /// Path of the node that was cut short by that.
    pub stopped_at: Option<Arc<str>>,
    /// Counts what was taken.
    pub count: u64,
    /// Places in `diagnostics` by node, and by every instance that a node stands in.
    of: HashMap<String, Vec<u32>>,
    /// Instances in `nodes`.
    summed: Vec<String>,
    /// Nodes may have gone with the request of this number.
    may_be_gone: Option<u64>,
    revision: u64,
    stage: Option<Stage>,
}

impl Results {
    /// Takes what the evaluation of a document has to tell.
    pub(super) fn take(&mut self, update: Update, document: &Document) {
        match update {
            Update::Progress(progress) => self.progress = Some(progress),
            Update::Done(done) => self.done(*done, document),
            Update::Lost(_) => {}
        }
    }

    /// Nodes may be gone once the evaluation knows of so many requests.
    pub(super) fn forget_what_is_gone(&mut self, revision: u64) {
        self.may_be_gone = Some(revision);
    }

    fn done(&mut self, done: Done, document: &Document) {
        self.count += 1;
        // That nothing more will come is told once more, without a node.
        let known = self.stopped_at.take().filter(|_| self.cancelled && done.report.cancelled);
        self.stopped_at = done.report.stopped_at.clone().or(known);
        self.cancelled = done.report.cancelled;
        self.progress = None;
        self.revision = done.revision;
        self.stage = Some(done.stage);
        if done.report.cancelled {
            return;
        }
        match done.stage {
            Stage::Shown => self.shown_in = done.report.elapsed,
            Stage::All => self.elapsed = done.report.elapsed,
        }
        for instance in self.summed.drain(..) {
            self.nodes.remove(&instance);
        }
        for n in done.report.nodes.iter() {
            let entry = self.nodes.entry(n.id.to_string());
            let node = entry.or_insert(NodeResult { happened: n.happened, time: n.time, bytes: n.bytes });
            // A node that did not run again keeps the time that it took when it did.
            let time = if n.happened == Happened::Executed { n.time } else { node.time };
            *node = NodeResult { happened: n.happened, time, bytes: n.bytes };
        }
        if let Some(revision) = self.may_be_gone {
            self.nodes.retain(|path, _| instances(document, path).is_some());
            self.may_be_gone = Some(revision).filter(|r| done.revision < *r);
        }
        self.sum_instances(document);
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
        let made = self.values.iter().filter(|(_, tree)| cut::MADE.contains(&tree.type_name()));
        self.made = made.map(|(output, _)| output.clone()).collect();
        self.made.sort_unstable();
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

    /// What is inside an instance counts for it, and for every instance that it stands in.
    fn sum_instances(&mut self, document: &Document) {
        let mut sums: HashMap<String, NodeResult> = HashMap::new();
        for (path, r) in self.nodes.iter().filter(|(path, _)| path.contains('/')) {
            for instance in instances(document, path).into_iter().flatten() {
                let sum =
                    sums.entry(instance.to_owned()).or_insert(NodeResult { time: Duration::ZERO, bytes: 0, ..*r });
                sum.time += r.time;
                sum.bytes += r.bytes;
                match r.happened {
                    Happened::Failed => sum.happened = r.happened,
                    Happened::Blocked if sum.happened != Happened::Failed => sum.happened = r.happened,
                    _ => {}
                }
            }
        }
        self.summed = sums.keys().cloned().collect();
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

/// The paths of the instances that a node stands in, from the outside; none if there is no such node. Ids may have a slash in
/// them, so the document says where one ends. O(levels of clusters).
pub(super) fn instances<'a>(document: &Document, path: &'a str) -> Option<Vec<&'a str>> {
    fn go<'a, 'd>(
        document: &'d Document,
        (body, names): (&'d Document, &mut Vec<&'d str>),
        (path, from): (&'a str, usize),
        found: &mut Vec<&'a str>,
    ) -> bool {
        let rest = &path[from..];
        if body.nodes().contains_key(rest) {
            return true;
        }
        for (end, _) in rest.match_indices('/') {
            let Some(cluster) = body.nodes().get(&rest[..end]).and_then(Node::cluster) else { continue };
            names.push(cluster);
            found.push(&path[..from + end]);
            let inner = document.definition(names.iter().copied());
            if inner.is_some_and(|(inner, _)| go(document, (inner, names), (path, from + end + 1), found)) {
                return true;
            }
            names.pop();
            found.pop();
        }
        false
    }
    let mut found = Vec::new();
    go(document, (document, &mut Vec::new()), (path, 0), &mut found).then_some(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_instances_of_a_path_are_those_of_the_document() {
        let text = r#"{
  "format": "tenon",
  "version": 1,
  "clusters": {
    "in": { "interface": { "version": 1 }, "nodes": { "n": { "type": "number", "v": 1 } } },
    "out": { "interface": { "version": 1 }, "nodes": { "a/b": { "type": "cluster:in", "v": 1 } } }
  },
  "nodes": { "x": { "type": "cluster:out", "v": 1 }, "x/y": { "type": "number", "v": 1 } }
}"#;
        let document = Document::from_slice(text.as_bytes()).unwrap();
        assert_eq!(instances(&document, "x/a/b/n"), Some(vec!["x", "x/a/b"]));
        assert_eq!(instances(&document, "x/y"), Some(vec![]), "a node of its own");
        assert_eq!(instances(&document, "x/a"), None);
        assert_eq!(instances(&document, "x/a/b/m"), None);
    }
}
