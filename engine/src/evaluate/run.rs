//! One evaluation. Level by level: look at each node that may have changed, find its result in the memo or run it, commit in
//! order of node number, and wake only successors of nodes whose outputs changed. Nothing recurses; a cancelled
//! evaluation is taken back as a whole.

use super::commit::{Evaluation, SPARE};
use super::gather;
use super::jobs::{Job, guarded};
use super::matching::FilesOfPort;
use super::meter::{Meter, MeterState};
use super::report::{Control, Event, Happened, NodeReports, Report};
use super::session::Session;
use super::state::{NodeRun, Status, Told, Value};
use crate::diagnostic::{Diagnostic, Severity};
use crate::document::model::NodeState;
use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// What a node of unknown cost is taken to cost, nanoseconds: slow ones and others.
const GUESS: (f64, f64) = (50e6, 1e5);

impl Session {
    /// Brings targets (interface outputs or `node.port`) up to date; without any, every interface output and every writer, or, if there are
    /// none of either, every node. Runs only what they need and what has changed. A cancelled evaluation leaves the session
    /// as it was, but the nodes that it finished are remembered: the next one goes on from there.
    pub fn evaluate(&mut self, targets: &[&str], control: &Control<'_>) -> Report {
        let start = Instant::now();
        self.memo.begin();
        let mut report = Report { diagnostics: self.plan.general.clone(), ..Report::default() };
        let mut asked_before = None;
        let same = |asked: &Vec<(String, _)>| asked.iter().map(|(name, _)| name).eq(targets);
        if !self.asked.as_ref().is_some_and(same) {
            let (places, goals) = self.find_goals(targets, &mut report.diagnostics);
            if self.goals.as_ref() != Some(&goals) {
                let flags: Vec<(bool, bool)> = self.nodes.iter().map(|n| (n.needed, n.wanted)).collect();
                asked_before = Some((self.goals.clone(), flags));
            }
            self.mark_needed(goals);
            let all_known = report.diagnostics.len() == self.plan.general.len();
            let names = targets.iter().map(|t| (*t).to_owned());
            self.asked = all_known.then(|| names.zip(places).collect());
        }
        let mut evaluation = Evaluation::new(std::mem::take(&mut self.spare), self.events.mark(), start);
        let dirty_before = self.fill_queue();
        let total = if control.on_progress.is_some() { self.expected() } else { 0.0 };
        let state = MeterState { total, done: 0.0, shown: 0.0, last: None, counted: None };
        let meter = Meter { tell: control.on_progress, state: Mutex::new(state) };
        let mut level = std::mem::take(&mut evaluation.level);
        while self.queue.len() > 0 && !control.cancel.load(Ordering::Relaxed) {
            self.queue.pop_level(&mut level);
            if !self.run_level(&level, &mut evaluation, &control.cancel, &meter) {
                break;
            }
        }
        self.settle(&mut evaluation, &meter);
        evaluation.level = level;
        if control.cancel.load(Ordering::Relaxed) {
            report.stopped_at = evaluation.cut_short.map(|(n, _)| self.plan.ids[n as usize].into());
            self.take_back(evaluation, dirty_before);
            if let Some((goals, flags)) = asked_before {
                (self.goals, self.asked) = (goals, None);
                for (node, (needed, wanted)) in self.nodes.iter_mut().zip(flags) {
                    (node.needed, node.wanted) = (needed, wanted);
                }
            }
            self.memo.shrink_older(self.options.cache_bytes);
            self.cache_faults();
            report.cancelled = true;
            report.elapsed = start.elapsed();
            return report;
        }
        self.last_size = evaluation.reports.len();
        let (ids, types) = (self.plan.ids.clone(), self.plan.type_names.clone());
        report.nodes = NodeReports { ids, types, rows: std::mem::take(&mut evaluation.reports) };
        if self.dirty.is_empty() && dirty_before.capacity() <= SPARE {
            self.dirty = dirty_before;
            self.dirty.clear();
        }
        self.spare = evaluation.spare();
        self.evict();
        self.tell(&mut report.diagnostics);
        report.cache = self.cache_faults();
        report.elapsed = start.elapsed();
        report
    }

    /// Node and output index of each target that is known, and the nodes that are asked for, each once, in order.
    fn find_goals(&self, targets: &[&str], diagnostics: &mut Vec<Diagnostic>) -> (Vec<(usize, usize)>, Vec<u32>) {
        let mut places = Vec::with_capacity(targets.len());
        for target in targets {
            match self.find_value(target) {
                Ok(place) => places.push(place),
                Err(diagnostic) => diagnostics.push(diagnostic),
            }
        }
        let mut goals: Vec<u32> = places.iter().map(|(n, _)| *n as u32).collect();
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
        (places, goals)
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

    pub(super) fn weight(&self, n: usize) -> f64 {
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
    fn expected(&self) -> f64 {
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
        total
    }

    /// False if a node was cancelled.
    fn run_level(&mut self, level: &[u32], e: &mut Evaluation, cancel: &Arc<AtomicBool>, meter: &Meter<'_>) -> bool {
        for (at, n) in level.iter().enumerate() {
            if !self.run_quick(*n, e, cancel, meter) {
                return self.run_slowly(&level[at..], e, cancel, meter);
            }
            if cancel.load(Ordering::Relaxed) {
                return false;
            }
        }
        true
    }

    /// As [`Session::run_level`] with nodes of which the first is not to be run the short way.
    fn run_slowly(&mut self, level: &[u32], e: &mut Evaluation, cancel: &Arc<AtomicBool>, meter: &Meter<'_>) -> bool {
        let (mut jobs, mut twins, mut keys) = (Vec::new(), Vec::new(), BTreeSet::new());
        for (at, n) in level.iter().enumerate() {
            if at > 0 && self.run_quick(*n, e, cancel, meter) {
                if cancel.load(Ordering::Relaxed) {
                    return false;
                }
                continue;
            }
            let Some(job) = self.look_at(*n, e, cancel) else { continue };
            // Instances of one cluster meet at one level, often with the same inputs: one runs, the others find its result.
            if self.plan.has_instances() && !keys.insert(job.key) {
                twins.push(*n);
            } else {
                jobs.push(job);
            }
        }
        if !jobs.is_empty() && !self.run_batch(jobs, e, cancel, meter) {
            return false;
        }
        if twins.is_empty() {
            return true;
        }
        let jobs = twins.into_iter().filter_map(|n| self.look_at(n, e, cancel)).collect();
        self.run_batch(jobs, e, cancel, meter)
    }

    /// False if a node was cancelled.
    fn run_batch(&mut self, jobs: Vec<Job>, e: &mut Evaluation, cancel: &Arc<AtomicBool>, meter: &Meter<'_>) -> bool {
        let mut jobs = self.recall(jobs, cancel, e);
        if cancel.load(Ordering::Relaxed) {
            return false;
        }
        if jobs.is_empty() {
            return true;
        }
        self.settle(e, meter);
        meter.recount(|| self.expected());
        if jobs.len() == 1
            && let Some(job) = jobs.pop_if(|j| self.is_tiny(j.node as usize))
        {
            let (n, key) = (job.node, job.key);
            let (outcome, end) = self.run_job(job, false, cancel, meter);
            let time = end - std::mem::replace(&mut e.clock, end);
            if cancel.load(Ordering::Relaxed) {
                self.keep(n, key, outcome, time, e);
                return false;
            }
            meter.finish(self.weight(n as usize));
            self.commit(n, key, outcome, time, e);
            return true;
        }
        let order: Vec<(u32, u128)> = jobs.iter().map(|j| (j.node, j.key)).collect();
        let outcomes = self.run_jobs(jobs, cancel, meter);
        e.clock = Instant::now();
        if cancel.load(Ordering::Relaxed) {
            for ((n, key), (outcome, time)) in order.into_iter().zip(outcomes) {
                self.keep(n, key, outcome, time, e);
            }
            return false;
        }
        for ((n, key), (outcome, time)) in order.into_iter().zip(outcomes) {
            meter.finish(self.weight(n as usize));
            self.commit(n, key, outcome, time, e);
        }
        true
    }

    /// Decides what to do with a node; a job if it has to run.
    fn look_at(&mut self, n: u32, e: &mut Evaluation, cancel: &Arc<AtomicBool>) -> Option<Job> {
        let i = n as usize;
        if self.plan.nodes[i].state == NodeState::Disabled {
            self.stop(n, Status::Disabled, n, e);
            self.note(n, Happened::Disabled, Duration::ZERO, e);
            return None;
        }
        let run = &self.nodes[i];
        if self.plan.nodes[i].state == NodeState::Frozen && run.status == Status::Good && run.present {
            // It may come from an earlier document, so those behind it have not seen it yet: commit it as it is.
            let (kept, told) = (self.nodes[i], self.told.get(&n).cloned());
            let outputs: Vec<Value> = self.outputs(i).to_vec();
            self.publish_each(n, kept, told, |o| outputs.get(o).cloned().unwrap_or_default(), e);
            self.note(n, Happened::Frozen, Duration::ZERO, e);
            return None;
        }
        if !self.plan.is_sound(i) {
            let unknown = self.plan.node_type(i).is_none();
            let status = if unknown { Status::Blocked } else { Status::Failed };
            self.stop(n, status, n, e);
            self.note(n, if unknown { Happened::Blocked } else { Happened::Failed }, Duration::ZERO, e);
            self.events.push(if unknown { Event::Blocked(n, n) } else { Event::Failed(n) });
            return None;
        }
        if let Some(by) = self.blocked_by(i) {
            self.stop(n, Status::Blocked, by, e);
            self.note(n, Happened::Blocked, Duration::ZERO, e);
            self.events.push(Event::Blocked(n, by));
            return None;
        }
        if self.plan.nodes[i].state == NodeState::Bypassed {
            self.pass_on(n, e, cancel);
            return None;
        }
        if self.plan.missing(i).next().is_some() {
            self.stop(n, Status::Failed, n, e);
            self.note(n, Happened::Failed, Duration::ZERO, e);
            self.events.push(Event::Failed(n));
            return None;
        }
        if self.plan.nodes[i].has_files && self.fetch_missing(n) {
            return None;
        }
        let files = self.read_files(n, e, cancel)?;
        let key = gather::key(&self.plan, i, &self.values, &files);
        let run = &self.nodes[i];
        let known = matches!(run.status, Status::Good | Status::Failed) && run.key == key.into();
        let useful = run.present || run.status == Status::Failed || !self.is_wanted(i);
        if known && useful {
            self.nodes[i].dirty = false;
            self.note(n, Happened::CutOff, Duration::ZERO, e);
            self.events.push(Event::CutOff(n));
            return None;
        }
        if let Some(entry) = self.memo.get(key) {
            let (outputs, reports, failed) = (entry.outputs.clone(), entry.reports.clone(), entry.failed);
            let status = if failed { Status::Failed } else { Status::Good };
            self.events.push(Event::MemoHit(n));
            self.publish(n, NodeRun::new(key, status), Told::of(status, n, reports), &outputs, e);
            self.note(n, if failed { Happened::Failed } else { Happened::Memo }, Duration::ZERO, e);
            return None;
        }
        // With a store, what comes in may not be needed.
        if self.options.store.is_none() && self.fetch_missing(n) {
            return None;
        }
        Some(Job { node: n, key, files, rewrite: false })
    }

    /// Puts a node in a state in which it gives nothing.
    fn stop(&mut self, n: u32, status: Status, blocked_by: u32, e: &mut Evaluation) {
        let told = Told { reports: None, blocked_by: Some(blocked_by) };
        self.publish(n, NodeRun::new(0, status), Some(told), &[], e);
    }

    fn is_wanted(&self, i: usize) -> bool {
        self.nodes[i].wanted
    }

    pub(crate) fn outputs(&self, i: usize) -> &[Value] {
        let node = &self.plan.nodes[i];
        &self.values[node.outputs as usize..(node.outputs + node.output_count) as usize]
    }

    /// The node at the root of what keeps this one from running.
    fn blocked_by(&self, i: usize) -> Option<u32> {
        self.plan.node_wires(i).find_map(|wire| {
            let p = self.plan.output_node[wire as usize];
            match self.nodes[p as usize].status {
                Status::Failed | Status::Disabled => Some(p),
                Status::Blocked => Some(self.told.get(&p).and_then(|t| t.blocked_by).unwrap_or(p)),
                // Of bypassed nodes some outputs give nothing.
                Status::Good if matches!(self.values[wire as usize], Value::Nothing) => Some(p),
                Status::New | Status::Good => None,
            }
        })
    }

    /// Puts what comes into a bypassed node at its outputs.
    fn pass_on(&mut self, n: u32, e: &mut Evaluation, cancel: &Arc<AtomicBool>) {
        if self.fetch_missing(n) {
            return;
        }
        let i = n as usize;
        let Some(t) = self.plan.node_type(i) else { return };
        let mut reports = Vec::new();
        let pass = || gather::passed(&self.plan, &self.registry, i, &self.values, &mut reports);
        let passed = match guarded(t, cancel, pass) {
            Ok(None) => return,
            Ok(Some(passed)) => passed,
            Err(fail) => Err(fail),
        };
        let status = if passed.is_ok() { Status::Good } else { Status::Failed };
        let happened = if passed.is_ok() { Happened::Bypassed } else { Happened::Failed };
        let outputs = passed.unwrap_or_else(|fail| {
            reports.push((Severity::Error, fail));
            self.events.push(Event::Failed(n));
            Vec::new()
        });
        let reports = (!reports.is_empty()).then(|| reports.into());
        let told = Told::of(status, n, reports);
        self.publish_each(n, NodeRun::new(0, status), told, |o| outputs.get(o).cloned().flatten().into(), e);
        self.note(n, happened, Duration::ZERO, e);
    }

    /// Queues the sources whose values were dropped from memory, and the node behind them again; false if all are there.
    pub(super) fn fetch_missing(&mut self, n: u32) -> bool {
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

    /// The files that a node reads; `None` if it was told to stop meanwhile, or failed with them.
    fn read_files(&mut self, n: u32, e: &mut Evaluation, cancel: &Arc<AtomicBool>) -> Option<Vec<FilesOfPort>> {
        let i = n as usize;
        if !self.plan.nodes[i].has_files {
            return Some(Vec::new());
        }
        let t = self.plan.node_type(i)?;
        let (host, known) = (&self.options.host, &mut e.files);
        let mut read = |path: &Arc<str>| {
            known.entry(path.clone()).or_insert_with(|| host.read(path).map_err(|e| e.to_string())).clone()
        };
        match guarded(t, cancel, || gather::files(&self.plan, &self.registry, i, &self.values, &mut read)) {
            Ok(files) => files,
            Err(fail) => {
                let reports: Vec<_> = vec![(Severity::Error, fail)];
                let told = Told::of(Status::Failed, n, Some(reports.into()));
                self.publish(n, NodeRun::new(0, Status::Failed), told, &[], e);
                self.note(n, Happened::Failed, Duration::ZERO, e);
                self.events.push(Event::Failed(n));
                None
            }
        }
    }
}
