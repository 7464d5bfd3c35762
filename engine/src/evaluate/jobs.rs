//! Running nodes that were found to have to run: one after another on this thread if they are tiny, else on the pool.

use super::gather;
use super::matching::{self, FilesOfPort, Outcome, panicked};
use super::meter::Meter;
use super::session::Session;
use super::simple::run_simple;
use crate::call::Monitor;
use crate::diagnostic::{Fail, Severity};
use crate::plan::Slot;
use crate::registry::NodeType;
use crate::stop;
use rayon::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// Nodes that take less than this run on the calling thread, nanoseconds.
const TINY: f64 = 20_000.0;
/// ... unless more than this comes in, bytes.
const TINY_BYTES: usize = 64 << 10;
/// The same for types that say that they are cheap: waking another thread takes longer than going through so much.
const CHEAP_BYTES: usize = 256 << 10;

/// Runs the engine's own work on what a node takes or gives; `None` if it was told to stop. Items are the nodes' own: copying,
/// converting or digesting one may panic as the node itself may.
pub(super) fn guarded<R>(t: &NodeType, cancel: &Arc<AtomicBool>, work: impl FnOnce() -> R) -> Result<Option<R>, Fail> {
    catch_unwind(AssertUnwindSafe(|| stop::within(cancel, work))).map_err(|payload| panicked(t, &*payload))
}

pub(super) struct Job {
    pub node: u32,
    pub key: u128,
    pub files: Vec<FilesOfPort>,
    /// What is kept of it is damaged and must be written anew.
    pub rewrite: bool,
}

impl Session {
    pub(super) fn run_jobs(
        &self,
        jobs: Vec<Job>,
        cancel: &Arc<AtomicBool>,
        meter: &Meter<'_>,
    ) -> Vec<(Outcome, Duration)> {
        let expected: f64 = jobs.iter().map(|j| self.weight(j.node as usize)).sum();
        if expected < 10.0 * TINY && jobs.iter().all(|j| self.is_tiny(j.node as usize)) {
            let mut clock = Instant::now();
            let run = |j| {
                let (outcome, end) = self.run_job(j, false, cancel, meter);
                (outcome, end - std::mem::replace(&mut clock, end))
            };
            return jobs.into_iter().map(run).collect();
        }
        let alone = |j| {
            let start = Instant::now();
            let (outcome, end) = self.run_job(j, true, cancel, meter);
            (outcome, end - start)
        };
        // Each tiny job alone would cost more to hand over than to do.
        let heavy = |j: &Job| {
            let i = j.node as usize;
            self.plan.node_type(i).is_some_and(|t| t.slow) || !self.is_tiny(i)
        };
        let least = if jobs.iter().any(heavy) { 1 } else { 32 };
        let run = || -> Vec<(Outcome, Duration)> {
            if jobs.len() == 1 {
                return jobs.into_iter().map(alone).collect();
            }
            jobs.into_par_iter().with_min_len(least).map(alone).collect()
        };
        match self.pool() {
            Some(pool) => pool.install(run),
            None => run(),
        }
    }

    /// Known to take so little time that it is not worth a thread pool's attention.
    pub(super) fn is_tiny(&self, i: usize) -> bool {
        let cost = self.costs.get(self.plan.nodes[i].node_type as usize).copied().unwrap_or(0.0);
        let cheap = self.plan.node_type(i).is_some_and(|t| t.cheap);
        cost > 0.0 && (cheap || cost < TINY) && self.bytes_into(i) < if cheap { CHEAP_BYTES } else { TINY_BYTES }
    }

    fn bytes_into(&self, i: usize) -> usize {
        let literals = self.plan.node_slots(i).iter().map(|s| match s {
            Slot::Literal(l) => self.plan.literals[*l as usize].bytes(),
            _ => 0,
        });
        let wires = self.plan.node_wires(i).map(|w| self.values[w as usize].bytes());
        literals.chain(wires).sum()
    }

    /// Runs a node and keeps what it gives, where that is worth it; gives when it was done.
    pub(super) fn run_job(
        &self,
        job: Job,
        parallel: bool,
        cancel: &Arc<AtomicBool>,
        meter: &Meter<'_>,
    ) -> (Outcome, Instant) {
        let Some(store) = &self.options.store else { return self.run_node(job, parallel, cancel, meter) };
        let (start, kept) = (Instant::now(), (job.node, job.key, job.rewrite));
        let (outcome, end) = self.run_node(job, parallel, cancel, meter);
        if !cancel.load(Ordering::Relaxed) {
            // Nothing is lost if it is left in the middle: it is kept whole or not at all.
            stop::within(cancel, || self.keep_outside(store, kept, &outcome, end - start));
        }
        (outcome, end)
    }

    /// Runs a node; gives when it was done, so that of nodes that run one after another each reads the clock once.
    fn run_node(&self, job: Job, parallel: bool, cancel: &Arc<AtomicBool>, meter: &Meter<'_>) -> (Outcome, Instant) {
        let i = job.node as usize;
        let Some(t) = self.plan.node_type(i) else { return (Outcome::failure(Vec::new()), Instant::now()) };
        let (id, weight) = (&self.plan.ids[i], self.weight(i));
        let show = |fraction: f64| meter.show(id, weight, fraction);
        let report: Option<&(dyn Fn(f64) + Sync)> = if meter.tell.is_some() { Some(&show) } else { None };
        if meter.tell.is_some() {
            show(0.0);
        }
        let made = AtomicU64::new(0);
        let monitor = Monitor { cancel, report, made: &made, span: (0.0, 1.0) };
        let outcome = match guarded(t, cancel, || self.run_with(job, t, monitor, parallel)) {
            Ok(outcome) => outcome.unwrap_or_else(Outcome::stopped),
            Err(fail) => Outcome { panicked: true, ..Outcome::failure(vec![(Severity::Error, fail)]) },
        };
        (outcome, Instant::now())
    }

    fn run_with(&self, job: Job, t: &NodeType, monitor: Monitor<'_>, parallel: bool) -> Outcome {
        let i = job.node as usize;
        if monitor.cancelled() {
            return Outcome::stopped();
        }
        if job.files.is_empty()
            && let Some(outcome) = run_simple(t, gather::simple(&self.plan, t, i, &self.values), monitor)
        {
            return outcome.into();
        }
        let mut reports = Vec::new();
        let (inputs, matching) =
            match gather::inputs(&self.plan, &self.registry, i, &self.values, job.files, &mut reports) {
                Ok(inputs) => inputs,
                Err(fail) => {
                    reports.push((Severity::Error, fail));
                    return Outcome::failure(reports);
                }
            };
        let mut outcome = matching::run(t, inputs, matching, monitor, parallel);
        if !reports.is_empty() {
            reports.append(&mut outcome.reports);
            outcome.reports = reports;
        }
        outcome
    }
}
