//! What a node's pieces of lanes have given, and how they become its outputs.

use super::matching::{Branch, Lot, Outcome};
use super::output::{Pieces, join};
use crate::diagnostic::{Fail, Severity};
use crate::registry::NodeType;
use crate::stop::{Pending, Stoppable, drop_beside};
use crate::value::{Column, Path, Tree};
use rayon::prelude::*;
use smallvec::SmallVec;

/// A piece of the lanes of one branch and what it has set.
pub(super) struct Piece {
    pub lanes: usize,
    pub outputs: Pieces,
    pub lot: Lot,
}

/// All pieces in their order, in batches. Cut short, they are not all there. Millions of them are dropped on another thread.
pub(super) struct Done {
    batches: Vec<Vec<Piece>>,
    all: bool,
}

/// Of more pieces than this several go together, so that a node that is told to stop need not touch each.
const MANY: usize = 1 << 12;
/// The most that go together.
const BATCH: usize = 256;

impl Done {
    /// Does the work on each piece, on the current rayon pool if `parallel`. Once `stopped` says so, the rest is left out.
    pub fn of<T: Sync>(
        pieces: &[T],
        parallel: bool,
        work: impl Fn(&T) -> Piece + Sync,
        stopped: &(dyn Fn() -> bool + Sync),
    ) -> Self {
        let batch = |batch: &[T]| -> Vec<Piece> {
            let mut done = Vec::with_capacity(if stopped() { 0 } else { batch.len() });
            done.extend(batch.iter().take_while(|_| !stopped()).map(&work));
            done
        };
        let size = (pieces.len() / MANY).clamp(1, BATCH);
        let batches: Vec<Vec<Piece>> = if parallel && pieces.len() > 1 {
            pieces.par_chunks(size).map(batch).collect()
        } else {
            pieces.chunks(size).map(batch).collect()
        };
        let mut done = Self { batches, all: true };
        done.all = done.count() == pieces.len() && !done.iter_mut().any(|piece| piece.lot.cancelled);
        done
    }

    fn count(&self) -> usize {
        self.batches.iter().map(Vec::len).sum()
    }

    /// Whether the node was left in the middle.
    pub fn is_cut_short(&self) -> bool {
        !self.all
    }

    fn iter_mut(&mut self) -> impl Iterator<Item = &mut Piece> {
        self.batches.iter_mut().flatten()
    }
}

impl Drop for Done {
    fn drop(&mut self) {
        let count = self.count();
        drop_beside::<Piece>(count, std::mem::take(&mut self.batches));
    }
}

/// Puts the pieces together: branches in their order, in each the lanes in theirs.
pub(super) fn gather(
    node_type: &NodeType,
    branches: &[Branch<'_>],
    mut done: Done,
    mut reports: Vec<(Severity, Fail)>,
) -> Outcome {
    if done.is_cut_short() {
        // What they have is not worth putting together.
        let panicked = done.iter_mut().any(|piece| piece.lot.panicked);
        done.iter_mut().for_each(|piece| reports.append(&mut piece.lot.reports));
        return Outcome { reports, panicked, ..Outcome::stopped() };
    }
    let (mut good, mut bad, mut untold, mut panicked) = (0, 0, 0, false);
    for piece in done.iter_mut().stoppable() {
        let lot = &mut piece.lot;
        (good, bad, untold, panicked) = (good + lot.good, bad + lot.bad, untold + lot.untold, panicked | lot.panicked);
        reports.append(&mut lot.reports);
    }
    let mut parts: SmallVec<[Pending<(Path, Column)>; 1]> =
        node_type.outputs.iter().map(|_| Pending::new(Vec::with_capacity(branches.len()))).collect();
    let mut next = done.batches.iter_mut().flat_map(|batch| batch.iter_mut());
    let mut columns: SmallVec<[Pieces; 1]> = SmallVec::new();
    for branch in branches.iter().stoppable() {
        columns.clear();
        columns.resize_with(node_type.outputs.len(), Pieces::new);
        let mut covered = 0;
        while covered < branch.lanes.count {
            let Some(piece) = next.next() else { break };
            covered += piece.lanes;
            columns.iter_mut().zip(std::mem::take(&mut piece.outputs)).for_each(|(all, one)| all.push(one));
        }
        for ((pieces, port), out) in columns.iter_mut().zip(&node_type.outputs).zip(&mut parts) {
            if let Err(fail) = join(std::mem::take(pieces), port, branch.path, branch.lanes.count, out) {
                // A fault of the node: nothing that it made can be trusted.
                reports.push((Severity::Error, fail));
                return Outcome::failure(reports);
            }
        }
    }
    let failed = good == 0 && (bad > 0 || !reports.is_empty());
    if untold > 0 {
        let message = format!("{untold} more items have something to say; there are too many of them to tell it all");
        reports.push((Severity::Warning, Fail::new("more-faults", message)));
    }
    if failed {
        return Outcome { panicked, ..Outcome::failure(reports) };
    }
    let outputs = parts.into_iter().map(|part| Tree::from_branches(part.take())).collect();
    Outcome { outputs, reports, failed, cancelled: false, panicked }
}
