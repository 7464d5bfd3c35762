//! One evaluation. Level by level: look at each node that may have changed, find its result in the memo or run it, commit in
//! order of node number, and wake only successors of nodes whose outputs changed. Nothing recurses; a cancelled
//! evaluation is taken back as a whole.

use super::gather::{self, Files};
use super::matching::{self, FileRead, Outcome};
use super::report::{Control, Event, Happened, NodeReport, Progress, Report};
use super::session::{NodeRun, Session, Status};
use crate::call::Monitor;
use crate::diagnostic::{Diagnostic, Severity};
use crate::document::model::NodeState;
use crate::plan::{Plan, Slot};
use crate::value::Tree;
use rayon::prelude::*;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// Nodes that take less than this run on the calling thread, nanoseconds.
const TINY: f64 = 20_000.0;
/// ... unless more than this comes in, bytes.
const TINY_BYTES: usize = 64 << 10;
/// What a node of unknown cost is taken to cost, nanoseconds: slow ones and others.
const GUESS: (f64, f64) = (50e6, 1e5);

struct Job {
    node: u32,
    key: u128,
    files: Vec<(usize, Vec<Vec<FileRead>>)>,
}

struct Evaluation {
    /// What nodes were before this evaluation touched them.
    undo: Vec<(u32, NodeRun)>,
    /// And what came out of them, in the same order.
    undo_outputs: Vec<(Option<Tree>, u128)>,
    reports: Vec<NodeReport>,
    files: Files,
    /// Length of the event log before.
    log: usize,
}

/// Fraction done by expected cost, told at most 30 times a second.
struct Meter<'a> {
    tell: Option<&'a (dyn Fn(&Progress) + Sync)>,
    state: Mutex<MeterState>,
}

struct MeterState {
    total: f64,
    done: f64,
    shown: f64,
    last: Option<Instant>,
}

impl Meter<'_> {
    fn show(&self, node: &Arc<str>, weight: f64, fraction: f64) {
        let (Some(tell), Ok(mut state)) = (self.tell, self.state.lock()) else { return };
        let now = Instant::now();
        if state.last.is_some_and(|t| now - t < Duration::from_millis(33)) {
            return;
        }
        let fraction = ((state.done + weight * fraction) / state.total.max(1.0)).min(1.0).max(state.shown);
        (state.shown, state.last) = (fraction, Some(now));
        drop(state);
        tell(&Progress { fraction, node: node.clone() });
    }

    fn finish(&self, weight: f64) {
        if self.tell.is_some()
            && let Ok(mut state) = self.state.lock()
        {
            state.done += weight;
        }
    }
}

impl Session {
    /// Brings targets (interface outputs or `node.port`) up to date; without any, every interface output and every writer, or, if there are
    /// none of either, every node. Runs only what they need and what has changed. A cancelled evaluation leaves the session as it was.
    pub fn evaluate(&mut self, targets: &[&str], control: &Control<'_>) -> Report {
        let start = Instant::now();
        let mut report = Report { diagnostics: self.plan.general.clone(), ..Report::default() };
        if !targets.is_empty() || !self.all_needed {
            let goals = self.find_goals(targets, &mut report.diagnostics);
            self.mark_needed(goals);
            self.all_needed = targets.is_empty();
        }
        let mut evaluation = Evaluation {
            undo: Vec::new(),
            undo_outputs: Vec::new(),
            reports: Vec::new(),
            files: Files::new(),
            log: self.events.len(),
        };
        let dirty_before = self.fill_queue();
        let meter = Meter { tell: control.on_progress, state: Mutex::new(self.expected(control)) };
        let mut level = Vec::new();
        while self.queue.len() > 0 && !control.cancel.load(Ordering::Relaxed) {
            self.queue.pop_level(&mut level);
            if !self.run_level(&level, &mut evaluation, &control.cancel, &meter) {
                break;
            }
        }
        if control.cancel.load(Ordering::Relaxed) {
            self.take_back(evaluation, dirty_before);
            report.cancelled = true;
            report.elapsed = start.elapsed();
            return report;
        }
        report.nodes = evaluation.reports;
        self.evict();
        self.tell(&mut report.diagnostics);
        report.elapsed = start.elapsed();
        report
    }

    fn find_goals(&self, targets: &[&str], diagnostics: &mut Vec<Diagnostic>) -> Vec<u32> {
        let mut goals = Vec::new();
        for target in targets {
            match self.find_value(target) {
                Ok((n, _)) => goals.push(n as u32),
                Err(diagnostic) => diagnostics.push(diagnostic),
            }
        }
        if targets.is_empty() {
            let outputs = self.document.outputs.values();
            goals.extend(outputs.filter_map(|o| self.plan.find_output(&o.port).ok()).map(|(n, _)| n as u32));
            let writer = |n: &u32| self.plan.node_type(*n as usize).is_some_and(|t| t.writer);
            goals.extend((0..self.nodes.len() as u32).filter(writer));
            if goals.is_empty() && self.document.outputs.is_empty() {
                goals.extend(0..self.nodes.len() as u32);
            }
        }
        goals.sort_unstable();
        goals.dedup();
        goals
    }

    /// Marks everything that the goals depend on. O(nodes + wires) when the goals are others than last time, else O(goals).
    fn mark_needed(&mut self, goals: Vec<u32>) {
        if self.goals.as_ref() == Some(&goals) {
            return;
        }
        for node in &mut self.nodes {
            (node.needed, node.wanted) = (false, false);
        }
        let mut stack = goals.clone();
        for n in &goals {
            let node = &mut self.nodes[*n as usize];
            (node.needed, node.wanted) = (true, true);
        }
        while let Some(n) = stack.pop() {
            for p in self.plan.predecessors(n as usize) {
                let node = &mut self.nodes[p as usize];
                if !node.needed {
                    node.needed = true;
                    stack.push(p);
                }
            }
        }
        self.goals = Some(goals);
    }

    /// Queues what is needed and dirty; gives the dirty list as it was.
    fn fill_queue(&mut self) -> Vec<u32> {
        for i in 0..self.readers.len() {
            self.mark_dirty(self.readers[i]);
        }
        let before = std::mem::take(&mut self.dirty);
        for n in &before {
            if self.nodes[*n as usize].needed {
                self.queue.push(*n, self.plan.nodes[*n as usize].height);
            } else {
                self.dirty.push(*n);
            }
        }
        // A goal whose value was dropped must be made again even if nothing changed.
        if self.evicted {
            for n in self.goals.iter().flatten() {
                let node = &self.nodes[*n as usize];
                if node.status == Status::Good && !node.present {
                    self.queue.push(*n, self.plan.nodes[*n as usize].height);
                }
            }
        }
        before
    }

    fn weight(&self, n: usize) -> f64 {
        let known = self.costs.get(self.plan.nodes[n].node_type as usize).copied().unwrap_or(0.0);
        let slow = self.plan.node_type(n).is_some_and(|t| t.slow);
        if known > 0.0 {
            known
        } else if slow {
            GUESS.0
        } else {
            GUESS.1
        }
    }

    /// The work ahead if everything that a dirty node reaches has to run.
    fn expected(&self, control: &Control<'_>) -> MeterState {
        if control.on_progress.is_none() {
            return MeterState { total: 0.0, done: 0.0, shown: 0.0, last: None };
        }
        let mut reached: Vec<bool> = self.nodes.iter().map(|n| n.needed && n.dirty).collect();
        let mut stack: Vec<usize> = (0..reached.len()).filter(|n| reached[*n]).collect();
        let mut total = 0.0;
        while let Some(n) = stack.pop() {
            total += self.weight(n);
            for s in self.plan.successors(n) {
                let s = *s as usize;
                if self.nodes[s].needed && !reached[s] {
                    reached[s] = true;
                    stack.push(s);
                }
            }
        }
        MeterState { total, done: 0.0, shown: 0.0, last: None }
    }

    /// False if a node was cancelled.
    fn run_level(&mut self, level: &[u32], e: &mut Evaluation, cancel: &AtomicBool, meter: &Meter<'_>) -> bool {
        let mut jobs = Vec::new();
        for n in level {
            if let Some(job) = self.look_at(*n, e) {
                jobs.push(job);
            }
        }
        if jobs.is_empty() {
            return true;
        }
        if jobs.len() == 1
            && let Some(job) = jobs.pop_if(|j| self.is_tiny(j.node as usize))
        {
            let (n, key) = (job.node, job.key);
            let (outcome, time) = self.run_job(job, false, cancel, meter);
            if cancel.load(Ordering::Relaxed) {
                return false;
            }
            meter.finish(self.weight(n as usize));
            self.commit(n, key, outcome, time, e);
            return true;
        }
        let order: Vec<(u32, u128)> = jobs.iter().map(|j| (j.node, j.key)).collect();
        let outcomes = self.run_jobs(jobs, cancel, meter);
        if cancel.load(Ordering::Relaxed) {
            return false;
        }
        for ((n, key), (outcome, time)) in order.into_iter().zip(outcomes) {
            meter.finish(self.weight(n as usize));
            self.commit(n, key, outcome, time, e);
        }
        true
    }

    /// Decides what to do with a node; a job if it has to run.
    fn look_at(&mut self, n: u32, e: &mut Evaluation) -> Option<Job> {
        let i = n as usize;
        let id = self.plan.ids[i].clone();
        if self.plan.nodes[i].state == NodeState::Disabled {
            self.publish(n, NodeRun { status: Status::Disabled, ..NodeRun::default() }, &[], e);
            self.note(n, Happened::Disabled, Duration::ZERO, e);
            return None;
        }
        let run = &self.nodes[i];
        if self.plan.nodes[i].state == NodeState::Frozen && run.status == Status::Good && run.present {
            // It may come from an earlier document, so those behind it have not seen it yet: commit it as it is.
            let kept = self.nodes[i].clone();
            let outputs: Vec<Tree> = self.outputs(i).iter().flatten().cloned().collect();
            self.publish(n, kept, &outputs, e);
            self.note(n, Happened::Frozen, Duration::ZERO, e);
            return None;
        }
        if !self.plan.is_sound(i) {
            let unknown = self.plan.node_type(i).is_none();
            let status = if unknown { Status::Blocked } else { Status::Failed };
            self.publish(n, NodeRun { status, blocked_by: n, ..NodeRun::default() }, &[], e);
            self.note(n, if unknown { Happened::Blocked } else { Happened::Failed }, Duration::ZERO, e);
            self.events.push(if unknown { Event::Blocked(id.clone(), id) } else { Event::Failed(id) });
            return None;
        }
        if let Some(by) = self.blocked_by(i) {
            self.publish(n, NodeRun { status: Status::Blocked, blocked_by: by, ..NodeRun::default() }, &[], e);
            self.note(n, Happened::Blocked, Duration::ZERO, e);
            self.events.push(Event::Blocked(id, self.plan.ids[by as usize].clone()));
            return None;
        }
        if self.plan.missing(i).next().is_some() {
            self.publish(n, NodeRun { status: Status::Failed, blocked_by: n, ..NodeRun::default() }, &[], e);
            self.note(n, Happened::Failed, Duration::ZERO, e);
            self.events.push(Event::Failed(id));
            return None;
        }
        if self.plan.nodes[i].has_files && self.fetch_missing(n) {
            return None;
        }
        let files = self.read_files(i, e);
        let key = gather::key(&self.plan, i, &self.digests, &files);
        let run = &self.nodes[i];
        let known = matches!(run.status, Status::Good | Status::Failed) && run.key == key;
        let useful = run.present || run.status == Status::Failed || !self.is_wanted(i);
        if known && useful {
            self.nodes[i].dirty = false;
            self.note(n, Happened::CutOff, Duration::ZERO, e);
            self.events.push(Event::CutOff(id));
            return None;
        }
        if let Some(entry) = self.memo.get(key) {
            let (outputs, reports, failed) = (entry.outputs.clone(), entry.reports.clone(), entry.failed);
            let status = if failed { Status::Failed } else { Status::Good };
            self.events.push(Event::MemoHit(id));
            self.publish(n, NodeRun { key, reports, status, blocked_by: n, ..NodeRun::default() }, &outputs, e);
            self.note(n, if failed { Happened::Failed } else { Happened::Memo }, Duration::ZERO, e);
            return None;
        }
        if self.fetch_missing(n) {
            return None;
        }
        Some(Job { node: n, key, files })
    }

    fn is_wanted(&self, i: usize) -> bool {
        self.nodes[i].wanted
    }

    fn outputs(&self, i: usize) -> &[Option<Tree>] {
        let node = &self.plan.nodes[i];
        &self.values[node.outputs as usize..(node.outputs + node.output_count) as usize]
    }

    /// The node at the root of what keeps this one from running.
    fn blocked_by(&self, i: usize) -> Option<u32> {
        self.plan.predecessors(i).find_map(|p| match self.nodes[p as usize].status {
            Status::Failed | Status::Disabled => Some(p),
            Status::Blocked => Some(self.nodes[p as usize].blocked_by),
            Status::New | Status::Good => None,
        })
    }

    /// Queues the sources whose values were dropped from memory, and the node behind them again; false if all are there.
    fn fetch_missing(&mut self, n: u32) -> bool {
        if self.plan.predecessors(n as usize).all(|p| self.nodes[p as usize].present) {
            return false;
        }
        let gone = self.plan.predecessors(n as usize).filter(|p| !self.nodes[*p as usize].present);
        for p in gone.collect::<Vec<u32>>() {
            self.nodes[p as usize].wanted = true;
            self.queue.push(p, self.plan.nodes[p as usize].height);
        }
        self.queue.push(n, self.plan.nodes[n as usize].height);
        true
    }

    fn read_files(&self, i: usize, e: &mut Evaluation) -> Vec<(usize, Vec<Vec<FileRead>>)> {
        if !self.plan.nodes[i].has_files {
            return Vec::new();
        }
        let host = &self.options.host;
        let files = &mut e.files;
        gather::files(&self.plan, &self.registry, i, &self.values, &mut |path| {
            files.entry(path.clone()).or_insert_with(|| host.read(path).map_err(|e| e.to_string())).clone()
        })
    }

    fn run_jobs(&self, jobs: Vec<Job>, cancel: &AtomicBool, meter: &Meter<'_>) -> Vec<(Outcome, Duration)> {
        let expected: f64 = jobs.iter().map(|j| self.weight(j.node as usize)).sum();
        if expected < 10.0 * TINY && jobs.iter().all(|j| self.is_tiny(j.node as usize)) {
            return jobs.into_iter().map(|j| self.run_job(j, false, cancel, meter)).collect();
        }
        let slow = jobs.iter().any(|j| self.plan.node_type(j.node as usize).is_some_and(|t| t.slow));
        let run = || -> Vec<(Outcome, Duration)> {
            if jobs.len() == 1 {
                return jobs.into_iter().map(|j| self.run_job(j, true, cancel, meter)).collect();
            }
            let least = if slow { 1 } else { 32 };
            jobs.into_par_iter().with_min_len(least).map(|j| self.run_job(j, true, cancel, meter)).collect()
        };
        match self.pool() {
            Some(pool) => pool.install(run),
            None => run(),
        }
    }

    /// Known to take so little time that it is not worth a thread pool's attention.
    fn is_tiny(&self, i: usize) -> bool {
        let cost = self.costs.get(self.plan.nodes[i].node_type as usize).copied().unwrap_or(0.0);
        cost > 0.0 && cost < TINY && self.bytes_into(i) < TINY_BYTES
    }

    fn bytes_into(&self, i: usize) -> usize {
        let literals = self.plan.node_slots(i).iter().map(|s| match s {
            Slot::Literal(l) => self.plan.literals[*l as usize].bytes(),
            _ => 0,
        });
        let wires = self.plan.node_wires(i).map(|w| self.values[w as usize].as_ref().map_or(0, Tree::bytes));
        literals.chain(wires).sum()
    }

    fn run_job(&self, job: Job, parallel: bool, cancel: &AtomicBool, meter: &Meter<'_>) -> (Outcome, Duration) {
        let i = job.node as usize;
        let start = Instant::now();
        let Some(t) = self.plan.node_type(i) else { return (Outcome::failure(Vec::new()), Duration::ZERO) };
        let mut reports = Vec::new();
        let (inputs, matching) =
            match gather::inputs(&self.plan, &self.registry, i, &self.values, job.files, &mut reports) {
                Ok(inputs) => inputs,
                Err(fail) => {
                    reports.push((Severity::Error, fail));
                    return (Outcome::failure(reports), start.elapsed());
                }
            };
        let (id, weight) = (&self.plan.ids[i], self.weight(i));
        let show = |fraction: f64| meter.show(id, weight, fraction);
        let report: Option<&(dyn Fn(f64) + Sync)> = if meter.tell.is_some() { Some(&show) } else { None };
        if meter.tell.is_some() {
            show(0.0);
        }
        let monitor = Monitor { cancel, report, span: (0.0, 1.0) };
        let mut outcome = matching::run(t, inputs, matching, monitor, parallel);
        if !reports.is_empty() {
            reports.append(&mut outcome.reports);
            outcome.reports = reports;
        }
        (outcome, start.elapsed())
    }

    fn commit(&mut self, n: u32, key: u128, mut outcome: Outcome, time: Duration, e: &mut Evaluation) {
        let i = n as usize;
        let t = self.plan.nodes[i].node_type as usize;
        let nanoseconds = time.as_nanos() as f64;
        self.costs[t] =
            if self.costs[t] > 0.0 { 0.7 * self.costs[t] + 0.3 * nanoseconds } else { nanoseconds.max(1.0) };
        if outcome.cancelled && !outcome.failed {
            outcome.failed = true;
            outcome.outputs.clear();
            let fail =
                crate::Fail::new("gave-up", "the node stopped as if it had been cancelled, but nobody asked it to");
            outcome.reports.push((Severity::Error, fail));
        }
        let reports: super::cache::Reports = (!outcome.reports.is_empty()).then(|| outcome.reports.into());
        let outputs = outcome.outputs.into_boxed_slice();
        let id = self.plan.ids[i].clone();
        let status = if outcome.failed { Status::Failed } else { Status::Good };
        self.events.push(if outcome.failed { Event::Failed(id.clone()) } else { Event::Executed(id.clone()) });
        let run = NodeRun { key, reports: reports.clone(), status, blocked_by: n, ..NodeRun::default() };
        if !self.publish(n, run, &outputs, e) {
            self.events.push(Event::CutOff(id));
        }
        if !outcome.panicked {
            self.memo.put(key, outputs, reports, outcome.failed, time.as_nanos() as u64);
        }
        self.note(n, if outcome.failed { Happened::Failed } else { Happened::Executed }, time, e);
    }

    /// Puts a node's new result in place and wakes its successors if it is another than before.
    fn publish(&mut self, n: u32, mut run: NodeRun, outputs: &[Tree], e: &mut Evaluation) -> bool {
        let i = n as usize;
        let (from, count) = (self.plan.nodes[i].outputs as usize, self.plan.nodes[i].output_count as usize);
        let old = &self.nodes[i];
        (run.needed, run.wanted, run.dirty) = (old.needed, old.wanted, false);
        run.present = run.status == Status::Good;
        let mut changed =
            old.status != run.status || (run.status == Status::Blocked && old.blocked_by != run.blocked_by);
        // A frozen node brought over from another document has not been seen by anybody.
        changed |= self.plan.nodes[i].state == NodeState::Frozen && old.dirty;
        for o in 0..count {
            let tree = outputs.get(o).cloned();
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

    fn note(&self, n: u32, happened: Happened, time: Duration, e: &mut Evaluation) {
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
        let type_name = self.plan.node_type(i).map_or_else(|| Arc::from("?"), |t| t.type_name.clone());
        let bytes = outputs.iter().flatten().map(Tree::bytes).sum();
        e.reports.push(NodeReport { id: self.plan.ids[i].clone(), type_name, happened, time, bytes, digest });
    }

    /// Restores everything that this evaluation changed; what it computed stays remembered.
    fn take_back(&mut self, e: Evaluation, dirty_before: Vec<u32>) {
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
    fn evict(&mut self) {
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
            self.evicted = true;
            self.nodes[i].present = false;
            self.nodes[i].wanted = false;
            let node = &self.plan.nodes[i];
            self.values[node.outputs as usize..(node.outputs + node.output_count) as usize].fill(None);
            self.events.push(Event::Evicted(self.plan.ids[i].clone()));
        }
    }

    /// Everything that the nodes which are needed have to say, in order of node ids.
    fn tell(&self, diagnostics: &mut Vec<Diagnostic>) {
        let mut nodes: Vec<u32> = self.vocal.iter().copied().collect();
        nodes.extend(self.plan.nodes_with_errors().map(|n| n as u32));
        nodes.sort_unstable();
        nodes.dedup();
        for n in nodes {
            let i = n as usize;
            let run = &self.nodes[i];
            if !run.needed || self.plan.nodes[i].state == NodeState::Disabled {
                continue;
            }
            let id = &self.plan.ids[i];
            diagnostics.extend(self.plan.errors(i).cloned());
            diagnostics
                .extend(run.reports.iter().flat_map(|r| r.iter()).map(|(severity, fail)| fail.at(*severity, id)));
            if run.status == Status::Failed && self.plan.is_sound(i) {
                diagnostics.extend(self.plan.missing(i).map(|port| Plan::missing_diagnostic(id, port)));
            }
            if run.status == Status::Blocked && run.blocked_by != n {
                let by = run.blocked_by as usize;
                let off = self.plan.nodes[by].state == NodeState::Disabled;
                let message =
                    format!("blocked by {}{}", self.plan.ids[by], if off { ", which is disabled" } else { "" });
                let severity = if off { Severity::Warning } else { Severity::Note };
                diagnostics.push(Diagnostic::error("blocked", message).with_severity(severity).at(&**id));
            }
        }
    }
}
