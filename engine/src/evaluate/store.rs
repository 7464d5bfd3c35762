//! Results that outlive the process: looked up where the memo knows nothing, kept where computing took longer than
//! reading will. Where they are kept is the host's business; a result is only used if it is whole.

use super::commit::Evaluation;
use super::jobs::Job;
use super::kept::{self, Kept, NotKept};
use super::matching::Outcome;
use super::report::{Event, Happened};
use super::session::Session;
use super::state::{NodeRun, Status, Told};
use crate::diagnostic::{Diagnostic, Severity};
use crate::stop;
use crate::value::{Digester, Tree};
use rayon::prelude::*;
use std::sync::atomic::AtomicBool;
use std::sync::{Arc, PoisonError};
use std::time::{Duration, Instant};

/// What took less than this is not kept: looking it up costs a good part of it.
const LEAST: Duration = Duration::from_millis(2);
/// ... nor what took less than this per byte: reading, checking and decoding would cost as much, nanoseconds.
const LEAST_PER_BYTE: u128 = 10;

/// A place for results beyond the life of the process, given in [`crate::Options`]. Many threads, sessions and processes
/// may use the same place at once. Both ways are called while nodes run: what takes long should look at
/// [`crate::stop::check`] now and then and must be fit to be left there, with nothing half-written.
pub trait Store: Send + Sync {
    /// The bytes last put under `key`; `None` if there are none.
    ///
    /// # Errors
    /// If there is something that is not what was put, or it cannot be read.
    fn get(&self, key: u128) -> Result<Option<Vec<u8>>, StoreFault>;

    /// Keeps `bytes` under `key`, whole or not at all, as long as the store sees fit.
    ///
    /// # Errors
    /// If they could not be written; then nothing is there, or what was there before.
    fn put(&self, key: u128, bytes: &[u8]) -> Result<(), StoreFault>;

    /// Where `key` is or would be kept, for messages.
    fn place(&self, key: u128) -> String;

    /// Whether a result of `bytes` bytes that took `time` to compute is worth keeping. By default: from 2 ms, and 10 ns
    /// per byte, so that reading it is always faster than computing it again.
    fn is_worth(&self, time: Duration, bytes: usize) -> bool {
        time >= LEAST && time.as_nanos() >= LEAST_PER_BYTE * bytes as u128
    }
}

/// What went wrong with a store; never an error of the run.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum StoreFault {
    /// What is kept is not what was put.
    #[error("{place} is damaged: {why}")]
    Damaged {
        /// Where it is kept.
        place: String,
        /// What is wrong with it.
        why: String,
    },
    /// It cannot be read or written.
    #[error("{place} cannot be used: {why}")]
    Failed {
        /// What was to be read or written.
        place: String,
        /// The reason.
        why: String,
    },
}

/// What a look into the store came to.
struct Found {
    kept: Option<Kept>,
    damaged: bool,
    time: Duration,
}

impl Found {
    fn nothing() -> Self {
        Self { kept: None, damaged: false, time: Duration::ZERO }
    }
}

/// The key under which a result outlives the process: besides node type, version and inputs, on which the memo's key
/// stands, everything of the program that may change results or their bytes.
fn key(memo_key: u128) -> u128 {
    let mut d = Digester::new();
    d.u32(kept::FORMAT);
    for text in [env!("CARGO_PKG_VERSION"), std::env::consts::ARCH, std::env::consts::OS] {
        d.str(text);
    }
    d.u128(memo_key);
    d.finish()
}

impl Session {
    /// Looks the jobs up in the store, at the same time, puts in place what is there, and gives those that have to run.
    pub(super) fn recall(&mut self, jobs: Vec<Job>, cancel: &Arc<AtomicBool>, e: &mut Evaluation) -> Vec<Job> {
        let Some(store) = self.options.store.clone() else { return jobs };
        let look = |job: &Job| stop::within(cancel, || self.look_up(&*store, job)).unwrap_or_else(Found::nothing);
        let found: Vec<Found> = match self.pool() {
            Some(pool) if jobs.len() > 1 => pool.install(|| jobs.par_iter().map(look).collect()),
            _ => jobs.iter().map(look).collect(),
        };
        let mut rest = Vec::with_capacity(jobs.len());
        for (mut job, found) in jobs.into_iter().zip(found) {
            if let Some(kept) = found.kept {
                self.put_in_place(&job, kept, found.time, e);
            } else if !self.fetch_missing(job.node) {
                job.rewrite = found.damaged;
                rest.push(job);
            }
        }
        rest
    }

    fn look_up(&self, store: &dyn Store, job: &Job) -> Found {
        let start = Instant::now();
        let mut found = Found::nothing();
        // What is computed in no time is not worth a look.
        if self.plan.node_type(job.node as usize).is_none_or(|t| t.cheap) {
            return found;
        }
        let key = key(job.key);
        let fault = match store.get(key).map(|bytes| bytes.map(|b| Kept::decode(&b, &self.registry))) {
            Ok(Some(Ok(kept))) if self.fits(job, &kept) => {
                found.kept = Some(kept);
                None
            }
            Ok(Some(Ok(_))) => {
                Some(StoreFault::Damaged { place: store.place(key), why: "it is another node's".into() })
            }
            Ok(Some(Err(NotKept::Damaged(why)))) => {
                Some(StoreFault::Damaged { place: store.place(key), why: why.to_owned() })
            }
            Ok(None | Some(Err(NotKept::Foreign))) => None,
            Err(fault) => Some(fault),
        };
        if let Some(fault) = fault {
            found.damaged = matches!(fault, StoreFault::Damaged { .. });
            self.remember_fault(job.node, fault);
        }
        found.time = start.elapsed();
        found
    }

    /// Whether a result has as many outputs as the node, none if it failed.
    fn fits(&self, job: &Job, kept: &Kept) -> bool {
        let count = self.plan.nodes[job.node as usize].output_count as usize;
        kept.outputs.len() == if kept.failed { 0 } else { count }
    }

    fn put_in_place(&mut self, job: &Job, kept: Kept, time: Duration, e: &mut Evaluation) {
        let (n, key, failed) = (job.node, job.key, kept.failed);
        let reports: super::cache::Reports = (!kept.reports.is_empty()).then(|| kept.reports.into());
        let outputs = kept.outputs.into_boxed_slice();
        let status = if failed { Status::Failed } else { Status::Good };
        self.events.push(Event::DiskHit(n));
        self.publish(n, NodeRun::new(key, status), Told::of(status, n, reports.clone()), &outputs, e);
        self.memo.put(key, outputs, reports, failed, kept.nanoseconds);
        self.note(n, if failed { Happened::Failed } else { Happened::Disk }, time, e);
    }

    /// Keeps what a node has given, if that is worth it; `rewrite`: in any case, because what is kept is damaged.
    pub(super) fn keep_outside(
        &self,
        store: &Arc<dyn Store>,
        job: (u32, u128, bool),
        outcome: &Outcome,
        time: Duration,
    ) {
        let (node, memo_key, rewrite) = job;
        let bytes = || outcome.outputs.iter().map(Tree::bytes).sum();
        if outcome.cancelled || outcome.panicked || !(rewrite || store.is_worth(time, bytes())) {
            return;
        }
        let nanoseconds = u64::try_from(time.as_nanos()).unwrap_or(u64::MAX);
        let encoded = kept::encode(&outcome.outputs, &outcome.reports, outcome.failed, nanoseconds);
        if let Some(Err(fault)) = encoded.map(|bytes| store.put(key(memo_key), &bytes)) {
            self.remember_fault(node, fault);
        }
    }

    fn remember_fault(&self, node: u32, fault: StoreFault) {
        let mut faults = self.faults.lock().unwrap_or_else(PoisonError::into_inner);
        faults.push((node, fault));
    }

    /// Every damaged result, and why the store cannot be used, once; in order of nodes.
    pub(super) fn cache_faults(&mut self) -> Vec<Diagnostic> {
        let mut faults = std::mem::take(self.faults.get_mut().unwrap_or_else(PoisonError::into_inner));
        faults.sort_by_key(|(node, _)| *node);
        faults.dedup();
        let (mut failed, mut diagnostics) = (false, Vec::new());
        for (node, fault) in faults {
            let told = match &fault {
                StoreFault::Damaged { .. } => {
                    let message = format!("the kept result {fault}; the node ran again");
                    Diagnostic::error("cache-damaged", message).at(&self.plan.ids[node as usize])
                }
                StoreFault::Failed { .. } if failed => continue,
                StoreFault::Failed { .. } => {
                    failed = true;
                    let hint = "the result is the same without it; next time the same nodes run again";
                    Diagnostic::error("cache-failed", format!("the cache {fault}")).hint(hint)
                }
            };
            diagnostics.push(told.with_severity(Severity::Warning));
        }
        diagnostics
    }
}
