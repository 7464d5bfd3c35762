//! Putting results in place, waking what depends on them, taking everything back after a cancellation, and telling what
//! nodes have to say.

use super::gather::Files;
use super::matching::Outcome;
use super::report::{Event, Happened, Row, Seen};
use super::session::Session;
use super::state::{NodeRun, Status, Told, Value};
use crate::diagnostic::{Diagnostic, Severity};
use crate::document::model::NodeState;
use crate::value::Tree;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// Up to this many bytes the results of cheap nodes are not remembered.
pub(super) const SMALL: usize = 512;

/// One evaluation under way.
pub(crate) struct Evaluation {
    /// The nodes of the level that is looked at.
    pub level: Vec<u32>,
    /// The nodes that this evaluation touched.
    pub undo: Vec<u32>,
    /// What they were before, in the same order.
    pub undo_runs: Vec<NodeRun>,
    /// What came out of them, in the same order.
    pub undo_outputs: Vec<Value>,
    /// What those of them had to say that had or have something to say.
    pub undo_told: Vec<(u32, Option<Told>)>,
    pub reports: Vec<Row>,
    pub files: Files,
    /// Length of the event log before.
    pub log: usize,
    /// When the last node was done.
    pub clock: Instant,
    /// The reports before this one have their times.
    pub settled: usize,
    /// The node that was cut short and how long it had run; of several the one that had run longest.
    pub cut_short: Option<(u32, Duration)>,
}

/// Room for this many nodes is kept from one evaluation to the next: those of a slider are as large as the one before.
pub(super) const SPARE: usize = 1024;

/// The lists of an evaluation that are empty when it is over.
#[derive(Default)]
pub(crate) struct Spare {
    level: Vec<u32>,
    undo: Vec<u32>,
    undo_runs: Vec<NodeRun>,
    undo_outputs: Vec<Value>,
}

impl Evaluation {
    pub fn new(spare: Spare, log: usize, start: Instant) -> Self {
        let Spare { level, undo, undo_runs, undo_outputs } = spare;
        Self {
            level,
            undo,
            undo_runs,
            undo_outputs,
            undo_told: Vec::new(),
            reports: Vec::new(),
            files: Files::new(),
            log,
            clock: start,
            settled: 0,
            cut_short: None,
        }
    }

    /// What the next evaluation can use again.
    pub fn spare(self) -> Spare {
        fn empty<T>(mut list: Vec<T>) -> Vec<T> {
            list.clear();
            if list.capacity() <= SPARE { list } else { Vec::new() }
        }
        Spare {
            level: empty(self.level),
            undo: empty(self.undo),
            undo_runs: empty(self.undo_runs),
            undo_outputs: empty(self.undo_outputs),
        }
    }
}

impl Session {
    pub(super) fn commit(&mut self, n: u32, key: u128, mut outcome: Outcome, time: Duration, e: &mut Evaluation) {
        let i = n as usize;
        self.learn(self.plan.nodes[i].node_type, time.as_nanos() as f64);
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
        let told = Told::of(status, n, reports.clone());
        if !self.publish(n, NodeRun::new(key, status), told, &outputs, e) {
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
    /// made is taken along as well: that it was cheap would have to be found out. Notes what was not finished.
    pub(super) fn keep(&mut self, n: u32, key: u128, outcome: Outcome, time: Duration, e: &mut Evaluation) {
        if outcome.cancelled && e.cut_short.is_none_or(|(_, longest)| longest < time) {
            e.cut_short = Some((n, time));
        }
        if !outcome.cancelled && !outcome.panicked {
            let reports: super::cache::Reports = (!outcome.reports.is_empty()).then(|| outcome.reports.into());
            let outputs = outcome.outputs.into_vec().into_boxed_slice();
            self.memo.put(key, outputs, reports, outcome.failed, time.as_nanos() as u64);
        }
    }

    /// Learns how many nanoseconds nodes of a type take.
    #[inline]
    pub(super) fn learn(&mut self, node_type: u32, now: f64) {
        let cost = &mut self.costs[node_type as usize];
        *cost = if *cost > 0.0 { 0.7 * *cost + 0.3 * now } else { now.max(1.0) };
    }

    /// Small results of a node that costs less than remembering them; of those in place.
    fn is_cheap(&self, i: usize) -> bool {
        let bytes = || self.outputs(i).iter().map(Value::bytes).sum::<usize>();
        self.plan.node_type(i).is_some_and(|t| t.cheap) && bytes() <= SMALL
    }

    /// Puts a node's new result in place and wakes its successors if it is another than before.
    pub(super) fn publish(
        &mut self,
        n: u32,
        run: NodeRun,
        told: Option<Told>,
        outputs: &[Tree],
        e: &mut Evaluation,
    ) -> bool {
        self.publish_each(n, run, told, |o| outputs.get(o).cloned().into(), e)
    }

    /// As [`Session::publish`], with nothing at some outputs; they are asked for in order.
    pub(super) fn publish_each(
        &mut self,
        n: u32,
        mut run: NodeRun,
        told: Option<Told>,
        mut output: impl FnMut(usize) -> Value,
        e: &mut Evaluation,
    ) -> bool {
        let i = n as usize;
        let (from, count) = (self.plan.nodes[i].outputs as usize, self.plan.nodes[i].output_count as usize);
        let old = &self.nodes[i];
        (run.needed, run.wanted, run.dirty) = (old.needed, old.wanted, false);
        run.present = run.status == Status::Good;
        let mut changed = old.status != run.status;
        for o in 0..count {
            let old = std::mem::replace(&mut self.values[from + o], output(o));
            changed |= old != self.values[from + o];
            e.undo_outputs.push(old);
        }
        if told.is_some() || !self.told.is_empty() {
            let by = |told: &Option<Told>| told.as_ref().and_then(|t| t.blocked_by);
            let now = by(&told);
            let old = match told {
                Some(told) => self.told.insert(n, told),
                None => self.told.remove(&n),
            };
            changed |= run.status == Status::Blocked && by(&old) != now;
            e.undo_told.push((n, old));
        }
        e.undo.push(n);
        e.undo_runs.push(self.nodes[i]);
        self.nodes[i] = run;
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
            [one] if one.tree().is_none() => 0,
            [one] => one.digest(),
            many if many.iter().all(|v| v.tree().is_none()) => 0,
            many => {
                let mut d = crate::Digester::new();
                many.iter().for_each(|v| d.u128(v.digest()));
                d.finish()
            }
        };
        let node_type = self.plan.nodes[i].node_type;
        let bytes = outputs.iter().map(Value::bytes).sum();
        let time = time.as_nanos() as f32;
        e.reports.push(Row { node: n, node_type, time, happened, bytes, digest: Seen::Digest(digest.into()) });
    }

    /// Restores everything that this evaluation changed; what it computed stays remembered.
    pub(super) fn take_back(&mut self, e: Evaluation, dirty_before: Vec<u32>) {
        let mut again = dirty_before;
        self.queue.drain(&mut again);
        let mut outputs = e.undo_outputs;
        for (n, run) in e.undo.into_iter().zip(e.undo_runs).rev() {
            let i = n as usize;
            let (from, count) = (self.plan.nodes[i].outputs as usize, self.plan.nodes[i].output_count as usize);
            for (o, value) in outputs.drain(outputs.len() - count..).enumerate() {
                self.values[from + o] = value;
            }
            self.nodes[i] = run;
            again.push(n);
        }
        for (n, told) in e.undo_told.into_iter().rev() {
            match told {
                Some(told) => self.told.insert(n, told),
                None => self.told.remove(&n),
            };
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
            if !run.present
                || goal
                || frozen
                || self.plan.nodes[i].output_count == 0
                || self.memo.contains(run.key.into())
            {
                continue;
            }
            if self.is_cheap(i) {
                continue;
            }
            self.evicted = true;
            self.nodes[i].present = false;
            self.nodes[i].wanted = false;
            let node = &self.plan.nodes[i];
            self.values[node.outputs as usize..(node.outputs + node.output_count) as usize]
                .iter_mut()
                .for_each(Value::drop_tree);
            self.events.push(Event::Evicted(i as u32));
        }
    }

    /// Everything that the nodes which are needed have to say, in order of node ids.
    pub(super) fn tell(&self, diagnostics: &mut Vec<Diagnostic>) {
        let mut nodes: Vec<u32> = self.told.keys().copied().collect();
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
            let told = self.told.get(&n);
            let reports = told.iter().filter_map(|t| t.reports.as_ref()).flat_map(|r| r.iter());
            diagnostics.extend(reports.map(|(severity, fail)| fail.at(*severity, id)));
            if run.status == Status::Failed && self.plan.is_sound(i) {
                diagnostics.extend(self.plan.missing(i).map(|port| self.plan.missing_diagnostic(i, port)));
            }
            if run.status == Status::Blocked
                && let Some(by) = told.and_then(|t| t.blocked_by).filter(|by| *by != n)
            {
                let by = by as usize;
                let (why, severity) = match self.plan.nodes[by].state {
                    NodeState::Disabled => (", which is disabled", Severity::Warning),
                    NodeState::Bypassed if self.nodes[by].status == Status::Good => {
                        (", which is bypassed and has no wire of that type to pass on", Severity::Warning)
                    }
                    _ => ("", Severity::Note),
                };
                let message = format!("blocked by {}{why}", &self.plan.ids[by]);
                diagnostics.push(Diagnostic::error("blocked", message).with_severity(severity).at(id));
            }
        }
    }
}
