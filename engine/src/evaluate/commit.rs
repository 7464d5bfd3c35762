//! Putting results in place, waking what depends on them, taking everything back after a cancellation, and telling what
//! nodes have to say.

use super::gather::Files;
use super::matching::Outcome;
use super::report::{Event, Happened, Row};
use super::session::{NodeRun, Session, Status};
use crate::diagnostic::{Diagnostic, Severity};
use crate::document::model::NodeState;
use crate::value::Tree;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// Up to this many bytes the results of cheap nodes are not remembered.
pub(super) const SMALL: usize = 512;

/// One evaluation under way.
pub(crate) struct Evaluation {
    /// What nodes were before this evaluation touched them.
    pub undo: Vec<(u32, NodeRun)>,
    /// And what came out of them, in the same order.
    pub undo_outputs: Vec<(Option<Tree>, u128)>,
    pub reports: Vec<Row>,
    pub files: Files,
    /// Length of the event log before.
    pub log: usize,
    /// When the last node was done.
    pub clock: Instant,
    /// The reports before this one have their times.
    pub settled: usize,
}

impl Session {
    pub(super) fn commit(&mut self, n: u32, key: u128, mut outcome: Outcome, time: Duration, e: &mut Evaluation) {
        let i = n as usize;
        self.learn(self.plan.nodes[i].node_type, time);
        if outcome.cancelled && !outcome.failed {
            outcome.failed = true;
            outcome.outputs.clear();
            let fail =
                crate::Fail::new("gave-up", "the node stopped as if it had been cancelled, but nobody asked it to");
            outcome.reports.push((Severity::Error, fail));
        }
        let reports: super::cache::Reports = (!outcome.reports.is_empty()).then(|| outcome.reports.into());
        let outputs = outcome.outputs.into_vec().into_boxed_slice();
        let status = if outcome.failed { Status::Failed } else { Status::Good };
        self.events.push(if outcome.failed { Event::Failed(n) } else { Event::Executed(n) });
        let run = NodeRun { key, reports: reports.clone(), status, blocked_by: n, ..NodeRun::default() };
        if !self.publish(n, run, &outputs, e) {
            self.events.push(Event::CutOff(n));
        }
        if !outcome.panicked && !self.is_cheap(i) {
            let t = self.plan.nodes[i].node_type as usize;
            self.remembered[t] = true;
            self.memo.put(key, outputs, reports, outcome.failed, time.as_nanos() as u64);
        }
        self.note(n, if outcome.failed { Happened::Failed } else { Happened::Executed }, time, e);
        // It has a time of its own: what cheap nodes behind it share is not its business.
        e.settled = e.reports.len();
    }

    /// Remembers what was finished when the evaluation was cancelled, though nothing of it is put in place. What cheap nodes
    /// made is taken along as well: that it was cheap would have to be found out.
    pub(super) fn keep(&mut self, key: u128, outcome: Outcome, time: Duration) {
        if !outcome.cancelled && !outcome.panicked {
            let reports: super::cache::Reports = (!outcome.reports.is_empty()).then(|| outcome.reports.into());
            let outputs = outcome.outputs.into_vec().into_boxed_slice();
            self.memo.put(key, outputs, reports, outcome.failed, time.as_nanos() as u64);
        }
    }

    /// Learns how long nodes of a type take.
    pub(super) fn learn(&mut self, node_type: u32, time: Duration) {
        let (cost, now) = (&mut self.costs[node_type as usize], time.as_nanos() as f64);
        *cost = if *cost > 0.0 { 0.7 * *cost + 0.3 * now } else { now.max(1.0) };
    }

    /// Small results of a node that costs less than remembering them; of those in place.
    fn is_cheap(&self, i: usize) -> bool {
        let bytes = || self.outputs(i).iter().flatten().map(Tree::bytes).sum::<usize>();
        self.plan.node_type(i).is_some_and(|t| t.cheap) && bytes() <= SMALL
    }

    /// Puts a node's new result in place and wakes its successors if it is another than before.
    pub(super) fn publish(&mut self, n: u32, run: NodeRun, outputs: &[Tree], e: &mut Evaluation) -> bool {
        self.publish_each(n, run, |o| outputs.get(o).cloned(), e)
    }

    /// As [`Session::publish`], with nothing at some outputs; they are asked for in order.
    pub(super) fn publish_each(
        &mut self,
        n: u32,
        mut run: NodeRun,
        mut output: impl FnMut(usize) -> Option<Tree>,
        e: &mut Evaluation,
    ) -> bool {
        let i = n as usize;
        let (from, count) = (self.plan.nodes[i].outputs as usize, self.plan.nodes[i].output_count as usize);
        let old = &self.nodes[i];
        (run.needed, run.wanted, run.dirty) = (old.needed, old.wanted, false);
        run.present = run.status == Status::Good;
        let mut changed =
            old.status != run.status || (run.status == Status::Blocked && old.blocked_by != run.blocked_by);
        for o in 0..count {
            let tree = output(o);
            let digest = tree.as_ref().map_or(0, Tree::digest);
            changed |= digest != self.digests[from + o];
            let old = std::mem::replace(&mut self.values[from + o], tree);
            e.undo_outputs.push((old, std::mem::replace(&mut self.digests[from + o], digest)));
        }
        if run.reports.is_some() || run.status != Status::Good {
            self.vocal.insert(n);
        } else if !self.vocal.is_empty() {
            self.vocal.remove(&n);
        }
        let old = std::mem::replace(&mut self.nodes[i], run);
        e.undo.push((n, old));
        if changed {
            for at in 0..self.plan.successors(i).len() {
                let s = self.plan.successors(i)[at];
                let node = &mut self.nodes[s as usize];
                if node.needed {
                    node.dirty = true;
                    self.queue.push(s, self.plan.nodes[s as usize].height);
                } else if !node.dirty {
                    node.dirty = true;
                    self.dirty.push(s);
                }
            }
        }
        changed
    }

    pub(super) fn note(&self, n: u32, happened: Happened, time: Duration, e: &mut Evaluation) {
        let i = n as usize;
        let outputs = self.outputs(i);
        let digest = match outputs {
            [one] => one.as_ref().map_or(0, Tree::digest),
            many => {
                let mut d = crate::Digester::new();
                many.iter().for_each(|t| d.u128(t.as_ref().map_or(0, Tree::digest)));
                if many.iter().any(Option::is_some) { d.finish() } else { 0 }
            }
        };
        let node_type = self.plan.nodes[i].node_type;
        let bytes = outputs.iter().flatten().map(Tree::bytes).sum();
        e.reports.push(Row { node: n, node_type, happened, time, bytes, digest });
    }

    /// Restores everything that this evaluation changed; what it computed stays remembered.
    pub(super) fn take_back(&mut self, e: Evaluation, dirty_before: Vec<u32>) {
        let mut again = dirty_before;
        self.queue.drain(&mut again);
        let mut outputs = e.undo_outputs;
        for (n, run) in e.undo.into_iter().rev() {
            let i = n as usize;
            let (from, count) = (self.plan.nodes[i].outputs as usize, self.plan.nodes[i].output_count as usize);
            for (o, (value, digest)) in outputs.drain(outputs.len() - count..).enumerate() {
                self.values[from + o] = value;
                self.digests[from + o] = digest;
            }
            if run.reports.is_some() || !matches!(run.status, Status::Good | Status::New) {
                self.vocal.insert(n);
            } else {
                self.vocal.remove(&n);
            }
            self.nodes[i] = run;
            again.push(n);
        }
        // Some of these were made dirty by changes that are taken back: looking at them once more costs little.
        again.extend((0..self.nodes.len() as u32).filter(|n| self.nodes[*n as usize].dirty));
        again.sort_unstable();
        again.dedup();
        again.iter().for_each(|n| self.nodes[*n as usize].dirty = true);
        self.dirty = again;
        self.events.truncate(e.log);
        self.events.push(Event::Cancelled);
    }

    /// Keeps the memo in its budget; values that nobody remembers any more are dropped, except those asked for.
    pub(super) fn evict(&mut self) {
        if !self.memo.shrink(self.options.cache_bytes) {
            return;
        }
        for i in 0..self.nodes.len() {
            let run = &self.nodes[i];
            let goal = self.goals.as_ref().is_some_and(|g| g.binary_search(&(i as u32)).is_ok());
            let frozen = self.plan.nodes[i].state == NodeState::Frozen;
            if !run.present || goal || frozen || self.plan.nodes[i].output_count == 0 || self.memo.contains(run.key) {
                continue;
            }
            if self.is_cheap(i) {
                continue;
            }
            self.evicted = true;
            self.nodes[i].present = false;
            self.nodes[i].wanted = false;
            let node = &self.plan.nodes[i];
            self.values[node.outputs as usize..(node.outputs + node.output_count) as usize].fill(None);
            self.events.push(Event::Evicted(i as u32));
        }
    }

    /// Everything that the nodes which are needed have to say, in order of node ids.
    pub(super) fn tell(&self, diagnostics: &mut Vec<Diagnostic>) {
        let mut nodes: Vec<u32> = self.vocal.iter().copied().collect();
        nodes.extend(self.plan.nodes_with_errors().map(|n| n as u32));
        nodes.sort_unstable();
        nodes.dedup();
        // No wire leads to nodes of unknown types, so they are not among what is needed.
        let strangers = self.plan.strangers.iter().filter(|(n, _)| self.nodes[*n as usize].needed);
        let strangers: BTreeSet<u32> = strangers.map(|(_, stranger)| *stranger).collect();
        for n in nodes {
            let i = n as usize;
            let run = &self.nodes[i];
            if !(run.needed || strangers.contains(&n)) || self.plan.nodes[i].state == NodeState::Disabled {
                continue;
            }
            let id = &self.plan.ids[i];
            diagnostics.extend(self.plan.errors(i).cloned());
            diagnostics
                .extend(run.reports.iter().flat_map(|r| r.iter()).map(|(severity, fail)| fail.at(*severity, id)));
            if run.status == Status::Failed && self.plan.is_sound(i) {
                diagnostics.extend(self.plan.missing(i).map(|port| self.plan.missing_diagnostic(i, port)));
            }
            if run.status == Status::Blocked && run.blocked_by != n {
                let by = run.blocked_by as usize;
                let (why, severity) = match self.plan.nodes[by].state {
                    NodeState::Disabled => (", which is disabled", Severity::Warning),
                    NodeState::Bypassed if self.nodes[by].status == Status::Good => {
                        (", which is bypassed and has no wire of that type to pass on", Severity::Warning)
                    }
                    _ => ("", Severity::Note),
                };
                let message = format!("blocked by {}{why}", self.plan.ids[by]);
                diagnostics.push(Diagnostic::error("blocked", message).with_severity(severity).at(&**id));
            }
        }
    }
}
