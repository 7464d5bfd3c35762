//! Matching: which items meet in which lane, and one node run over all its lanes.
//! A lane that fails leaves a gap at its index in every output; item i never meets item i+1's partner.

use super::output::{Output, Pieces, alone};
use super::pieces::{Done, Piece, gather};
use crate::call::{Call, MOST_ITEMS, Monitor, too_many};
use crate::diagnostic::{Fail, Severity};
use crate::port::{Access, Port};
use crate::registry::NodeType;
use crate::stop::{self, Pending, Stoppable, Ticker};
use crate::value::{Column, Path, Tree};
use smallvec::SmallVec;
use std::any::Any;
use std::borrow::Cow;
use std::ops::Range;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// How items of ports with different lengths meet.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Matching {
    /// As many lanes as the longest list; shorter ones repeat their last item.
    #[default]
    Longest,
    /// As many lanes as the shortest list.
    Shortest,
    /// Every item with every item; the last port turns fastest.
    Cross,
}

impl Matching {
    /// Its name in the file.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Longest => "longest",
            Self::Shortest => "shortest",
            Self::Cross => "cross",
        }
    }
}

/// Content of a file, or why it could not be read.
pub(crate) type FileRead = Result<Arc<[u8]>, String>;

/// The files of one port, by its number: per branch and item what was read.
pub(crate) type FilesOfPort = (usize, Vec<Vec<FileRead>>);

/// What a lane needs to find its item in a column.
pub(crate) struct Rule<'a> {
    len: usize,
    stride: usize,
    pub files: Option<&'a [FileRead]>,
}

/// What arrives at one port in one branch.
pub(crate) enum Arg<'a> {
    Missing,
    /// One item, the same in every lane.
    One(&'a Column),
    Item(&'a Column, Rule<'a>),
    List(&'a Column),
    Tree(&'a Tree),
}

/// The lanes of one branch.
#[derive(Clone, Copy)]
pub(crate) struct Lanes {
    pub count: usize,
    cross: bool,
}

impl Lanes {
    pub fn index(&self, lane: usize, rule: &Rule<'_>) -> usize {
        if self.cross { lane / rule.stride % rule.len.max(1) } else { lane.min(rule.len.saturating_sub(1)) }
    }
}

/// What arrives at one port in all branches.
pub(crate) struct Input<'a> {
    pub tree: Option<Cow<'a, Tree>>,
    /// For a file port: what was read, per branch and item.
    pub files: Vec<Vec<FileRead>>,
    /// Came by wire, so nobody has checked range, choices and finiteness yet.
    pub unchecked: bool,
}

/// What a node's run came to.
pub(crate) struct Outcome {
    pub outputs: SmallVec<[Tree; 1]>,
    pub reports: Vec<(Severity, Fail)>,
    /// No lane gave anything.
    pub failed: bool,
    pub cancelled: bool,
    /// A node that panicked is not remembered.
    pub panicked: bool,
}

impl Outcome {
    pub fn failure(reports: Vec<(Severity, Fail)>) -> Self {
        Self { outputs: SmallVec::new(), reports, failed: true, cancelled: false, panicked: false }
    }

    /// Left in the middle.
    pub fn stopped() -> Self {
        Self { outputs: SmallVec::new(), reports: Vec::new(), failed: false, cancelled: true, panicked: false }
    }
}

/// What arrives at the ports in a branch is looked up when it runs: for a million branches it would fill the memory.
pub(super) struct Branch<'a> {
    pub path: &'a Path,
    pub lanes: Lanes,
}

/// The most lanes all branches together may have.
const MOST_LANES: usize = MOST_ITEMS;
/// With more lanes than this, few faults are told in each piece of them, however the pieces are shared out: nobody reads
/// millions, and they would fill the memory.
const MANY_LANES: usize = 1 << 20;
const FEW_FAULTS: usize = 16;
/// The path of what has no branches to be named after.
static ROOT: Path = Path::ROOT;
/// One lane.
pub(super) const ALONE: Lanes = Lanes { count: 1, cross: false };
/// Lanes of a node that is not slow are shared out in pieces of this many.
const PIECE: usize = 1024;

/// Runs a node over all branches and lanes. `parallel`: lanes may be shared out on the current rayon pool.
pub(crate) fn run(
    node_type: &NodeType,
    mut inputs: Vec<Input<'_>>,
    matching: Matching,
    monitor: Monitor<'_>,
    parallel: bool,
) -> Outcome {
    let mut reports = Vec::new();
    for (input, port) in inputs.iter_mut().zip(&node_type.inputs) {
        if input.unchecked && port.is_checked() && !check(input, port, &mut reports) {
            return Outcome::failure(reports);
        }
    }
    let branches = match branches(node_type, &inputs, matching) {
        Ok(branches) => branches,
        Err(fail) => {
            reports.push((Severity::Error, fail));
            return Outcome::failure(reports);
        }
    };
    if let [branch] = branches.as_slice()
        && branch.lanes.count == 1
    {
        return run_alone(node_type, branch, &arriving(node_type, &inputs, matching, 0).0, monitor, reports);
    }
    let few = branches.iter().stoppable().map(|b| b.lanes.count).sum::<usize>() > MANY_LANES;
    let most_faults = if few { FEW_FAULTS } else { usize::MAX };
    let mut pieces: Pending<(usize, usize, usize)> = Pending::new(Vec::with_capacity(branches.len()));
    for (b, branch) in branches.iter().enumerate().stoppable() {
        let count = branch.lanes.count;
        let size = match (parallel, node_type.slow) {
            (false, _) => count,
            (true, true) if !few => count.div_ceil(256),
            // Whole pieces, so that what is told of each does not depend on how they are shared out.
            (true, true) => count.div_ceil(256).next_multiple_of(PIECE),
            (true, false) => PIECE,
        };
        let size = size.max(1);
        pieces.extend((0..count.div_ceil(size)).map(|i| (b, i * size, ((i + 1) * size).min(count))));
    }
    let work = |&(b, from, to): &(usize, usize, usize)| {
        let mut outputs: Pieces = node_type.outputs.iter().map(|_| Output::new(to - from)).collect();
        let (args, lanes) = arriving(node_type, &inputs, matching, b);
        let lot = stop::within(monitor.cancel, || {
            let mut lot = run_lanes(node_type, &args, lanes, from..to, &mut outputs, monitor, most_faults);
            lot.reports.shrink_to_fit();
            lot
        });
        Piece { lanes: to - from, outputs, lot: lot.unwrap_or_else(Lot::stopped) }
    };
    let done = Done::of(&pieces, parallel, work, &|| monitor.cancelled());
    let made = monitor.made.load(Ordering::Relaxed);
    if made > MOST_ITEMS as u64 && !done.is_cut_short() {
        // Which lane was the last to fit is up to the threads.
        reports.push((Severity::Error, too_many(made)));
        return Outcome::failure(reports);
    }
    gather(node_type, &branches, done, reports)
}

/// One branch, one lane.
fn run_alone(
    node_type: &NodeType,
    branch: &Branch<'_>,
    args: &[Arg<'_>],
    monitor: Monitor<'_>,
    reports: Vec<(Severity, Fail)>,
) -> Outcome {
    let mut outputs: Pieces = node_type.outputs.iter().map(|_| Output::new(1)).collect();
    let lot = run_lanes(node_type, args, branch.lanes, 0..1, &mut outputs, monitor, usize::MAX);
    finish_alone(node_type, lot, outputs.into_iter(), branch.path, reports)
}

/// What one lane has set becomes trees.
pub(super) fn finish_alone(
    node_type: &NodeType,
    lot: Lot,
    set: impl Iterator<Item = Output>,
    path: &Path,
    mut reports: Vec<(Severity, Fail)>,
) -> Outcome {
    reports.extend(lot.reports);
    let mut failed = lot.good == 0 && (lot.bad > 0 || !reports.is_empty());
    let mut outputs = SmallVec::new();
    if !failed && !lot.cancelled {
        outputs.reserve_exact(node_type.outputs.len());
        for (output, port) in set.zip(&node_type.outputs) {
            match alone(output, port, path) {
                Ok(tree) => outputs.push(tree),
                Err(fail) => {
                    reports.push((Severity::Error, fail));
                    failed = true;
                }
            }
        }
    }
    if failed {
        outputs.clear();
    }
    Outcome { outputs, reports, failed, cancelled: lot.cancelled, panicked: lot.panicked }
}

/// Turns items that the port does not accept into gaps; false if the port sees lists or trees and so cannot do without them.
fn check(input: &mut Input<'_>, port: &Port, reports: &mut Vec<(Severity, Fail)>) -> bool {
    let Some(tree) = &input.tree else { return true };
    let many = tree.branches().len() > 1;
    let mut bad_branches = Vec::new();
    for (b, (path, column)) in tree.branches().iter().enumerate().stoppable() {
        let bad = port.check(column);
        if bad.places.is_empty() {
            continue;
        }
        let single = column.len() == 1 && !many;
        let mut order: Vec<Option<usize>> = (0..column.len()).stoppable().map(Some).collect();
        for i in &bad.places {
            order[*i] = None;
        }
        let (told, more) = (bad.told.len(), bad.places.len() - bad.told.len());
        for (i, fail) in bad.places.into_iter().zip(bad.told) {
            let fail = if single { fail } else { fail.item(i) };
            reports.push((Severity::Error, if many { fail.hint(format!("in branch {path}")) } else { fail }));
        }
        if more > 0 {
            let message = format!("the port refuses {more} more items like the {told} that are told");
            reports.push((Severity::Error, Fail::new("more-faults", message).port(port.name.to_string())));
        }
        bad_branches.push((b, column.pick(&order)));
    }
    if bad_branches.is_empty() {
        return true;
    }
    if port.access != Access::Item {
        return false;
    }
    let mut branches = Pending::new(Vec::with_capacity(tree.branches().len()));
    branches.extend(tree.branches().iter().stoppable().cloned());
    for (b, column) in bad_branches {
        branches[b].1 = column;
    }
    input.tree = Some(Cow::Owned(Tree::from_branches(branches.take())));
    true
}

fn branches<'a>(node_type: &NodeType, inputs: &'a [Input<'a>], matching: Matching) -> Result<Vec<Branch<'a>>, Fail> {
    let matched = || {
        let ports = inputs.iter().zip(&node_type.inputs).filter(|(_, p)| p.access != Access::Tree);
        ports.filter_map(|(i, _)| i.tree.as_deref())
    };
    let count = match matching {
        Matching::Shortest => matched().map(|t| t.branches().len()).min(),
        Matching::Longest | Matching::Cross => matched().map(|t| t.branches().len()).max(),
    };
    let Some(count) = count else {
        return Ok(vec![Branch { path: &ROOT, lanes: ALONE }]);
    };
    // The first port with the most branches names the paths.
    let longest = matched().map(|t| t.branches().len()).max().unwrap_or(0);
    let names = matched().find(|t| t.branches().len() == longest);
    let mut all = Vec::with_capacity(count);
    let mut sum = 0usize;
    let ticker = Ticker::new();
    for b in 0..count {
        ticker.tick();
        let path = names.and_then(|t| t.branches().get(b)).map_or(&ROOT, |(p, _)| p);
        let (_, lanes) = arriving(node_type, inputs, matching, b);
        if lanes.count > MOST_LANES {
            let message = format!("the inputs cross to {} runs; the most is {MOST_LANES}", lanes.count);
            return Err(Fail::new("too-many-lanes", message));
        }
        sum = sum.saturating_add(lanes.count);
        if sum > MOST_LANES {
            let message = format!("{} of {count} branches come to {sum} runs; the most is {MOST_LANES}", b + 1);
            return Err(Fail::new("too-many-lanes", message));
        }
        all.push(Branch { path, lanes });
    }
    Ok(all)
}

/// What arrives at each port in branch `b`, and how many lanes that makes. O(ports).
fn arriving<'a>(
    node_type: &NodeType,
    inputs: &'a [Input<'a>],
    matching: Matching,
    b: usize,
) -> (SmallVec<[Arg<'a>; 6]>, Lanes) {
    let mut args = SmallVec::with_capacity(inputs.len());
    let (mut longest, mut shortest, mut any) = (0, usize::MAX, false);
    for (input, port) in inputs.iter().zip(&node_type.inputs) {
        let Some(tree) = input.tree.as_deref() else {
            args.push(Arg::Missing);
            continue;
        };
        if port.access == Access::Tree {
            args.push(Arg::Tree(tree));
            continue;
        }
        let at = b.min(tree.branches().len().saturating_sub(1));
        let Some((_, column)) = tree.branches().get(at) else {
            // A tree without branches at an item port: nothing to iterate over. At a list port: an empty list.
            args.push(Arg::Missing);
            if port.access == Access::Item {
                (shortest, any) = (0, true);
            }
            continue;
        };
        if port.access == Access::List {
            args.push(Arg::List(column));
        } else {
            (longest, shortest, any) = (longest.max(column.len()), shortest.min(column.len()), true);
            let files = input.files.get(at).map(Vec::as_slice);
            args.push(Arg::Item(column, Rule { len: column.len(), stride: 1, files }));
        }
    }
    let cross = matching == Matching::Cross;
    let count = match matching {
        _ if !any => 1,
        _ if shortest == 0 => 0,
        Matching::Longest => longest,
        Matching::Shortest => shortest,
        Matching::Cross => {
            let mut stride = 1usize;
            for arg in args.iter_mut().rev() {
                if let Arg::Item(_, rule) = arg {
                    rule.stride = stride;
                    stride = stride.saturating_mul(rule.len);
                }
            }
            stride
        }
    };
    (args, Lanes { count, cross })
}

/// How a piece of the lanes went.
pub(super) struct Lot {
    pub reports: Vec<(Severity, Fail)>,
    /// Reports that are left out because there are too many.
    pub untold: usize,
    pub good: usize,
    pub bad: usize,
    pub cancelled: bool,
    pub panicked: bool,
}

impl Lot {
    /// One lane, and what it said.
    pub fn alone(done: Result<(), Box<(Fail, bool)>>, reports: Vec<(Severity, Fail)>, monitor: Monitor<'_>) -> Self {
        let mut lot = Self { reports, untold: 0, good: 1, bad: 0, cancelled: false, panicked: false };
        if let Err(fault) = done {
            let (fail, panic) = *fault;
            (lot.good, lot.panicked, lot.cancelled) = (0, panic, fail.is_cancelled() || monitor.cancelled());
            if !fail.is_cancelled() {
                lot.bad = 1;
                lot.reports.push((Severity::Error, fail.item_or(None)));
            }
        }
        lot
    }

    fn stopped() -> Self {
        Self { reports: Vec::new(), untold: 0, good: 0, bad: 0, cancelled: true, panicked: false }
    }
}

/// Runs the node in the lane at which `call` stands; an error with whether it was a panic.
pub(super) fn run_lane(call: &mut Call<'_>) -> Result<(), Box<(Fail, bool)>> {
    let node_type = call.node_type;
    let result = match &node_type.run {
        Some(run) => catch_unwind(AssertUnwindSafe(|| run(call))),
        None => Ok(Ok(())),
    };
    let fault = match (result, call.bug.take()) {
        (Ok(Ok(())), None) => return Ok(()),
        (Ok(Err(fail)), _) | (Ok(Ok(())), Some(fail)) => (fail, false),
        (Err(payload), _) if stop::is_stop(&*payload) => (Fail::cancelled(), false),
        (Err(payload), _) => (panicked(node_type, &*payload), true),
    };
    Err(Box::new(fault))
}

/// What is told of a panic.
pub(super) fn panicked(node_type: &NodeType, payload: &(dyn Any + Send)) -> Fail {
    let text = payload.downcast_ref::<&str>().copied();
    let text = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or_default();
    let message = format!("\"{}\" stopped in an unforeseen state: {text}", node_type.type_name);
    Fail::new("panic", message).hint("this is a fault in the node, please report it")
}

pub(super) fn run_lanes(
    node_type: &NodeType,
    args: &[Arg<'_>],
    lanes: Lanes,
    range: Range<usize>,
    outputs: &mut [Output],
    monitor: Monitor<'_>,
    most_faults: usize,
) -> Lot {
    let (from, to) = (range.start, range.end);
    let mut reports = Vec::new();
    let (mut good, mut bad, mut cancelled, mut panicked) = (0, 0, false, false);
    let gaps: Vec<(&Column, &Rule<'_>)> = args
        .iter()
        .filter_map(|a| match a {
            Arg::Item(column, rule) if column.has_gaps() => Some((*column, rule)),
            _ => None,
        })
        .collect();
    let mut call = Call {
        node_type,
        args,
        lanes,
        lane: from,
        first_lane: from,
        outputs,
        reports: &mut reports,
        monitor,
        bug: None,
    };
    let share = 1.0 / lanes.count.max(1) as f64;
    let mut untold = 0;
    let mut most = 0;
    for lane in from..to {
        untold += call.reports.len().saturating_sub(most);
        call.reports.truncate(most);
        if (lane - from).is_multiple_of(PIECE) {
            most = call.reports.len().saturating_add(most_faults);
        }
        if call.monitor.cancelled() {
            cancelled = true;
            break;
        }
        if gaps.iter().any(|(column, rule)| !column.is_valid(lanes.index(lane, rule))) {
            continue;
        }
        call.lane = lane;
        call.monitor.span = (lane as f64 * share, share);
        let Err(fault) = run_lane(&mut call) else {
            good += 1;
            continue;
        };
        let (fail, panic) = *fault;
        panicked |= panic;
        call.outputs.iter_mut().for_each(|o| o.clear(lane - from));
        if fail.is_cancelled() {
            cancelled = true;
            break;
        }
        bad += 1;
        call.reports.push((Severity::Error, fail.item_or((lanes.count > 1).then_some(lane))));
        if call.monitor.cancelled() {
            cancelled = true;
            break;
        }
    }
    untold += reports.len().saturating_sub(most);
    reports.truncate(most);
    Lot { reports, untold, good, bad, cancelled, panicked }
}
