//! Nodes whose every port has one item, one list or one tree as it is, as nearly all of a graph's small nodes do: they run
//! without lists of what meets what.

use super::matching::{ALONE, Arg, Lot, Outcome, finish_alone, run_lane};
use super::output::Output;
use crate::call::{Call, Monitor};
use crate::port::Access;
use crate::registry::NodeType;
use crate::stop::Stoppable;
use crate::value::{Column, Path, Tree};
use smallvec::SmallVec;
use std::borrow::Cow;

/// What a simple node gives.
pub(crate) enum Simple {
    /// One number and nothing to say: kept in a register, since making a tree of it takes as long as the node.
    Number(f64),
    Outcome(Box<Outcome>),
}

impl From<Simple> for Outcome {
    fn from(simple: Simple) -> Self {
        match simple {
            Simple::Outcome(outcome) => *outcome,
            Simple::Number(v) => {
                let outputs = SmallVec::from([Tree::item(v)]);
                Self { outputs, reports: Vec::new(), failed: false, cancelled: false, panicked: false }
            }
        }
    }
}

/// Nodes with more inputs than this are never simple.
pub(crate) const SIMPLE_PORTS: usize = 6;

/// Runs a node whose every port has one item, one list or one tree as it is: no list has to be built to run it. `None`:
/// it is not that simple, and nothing was run. `inputs` gives what arrives at each port and whether it came by wire; an
/// inner `None` where that is not one tree as it is.
pub(crate) fn run_simple<'a>(
    node_type: &NodeType,
    inputs: impl Iterator<Item = Option<(Option<&'a Tree>, bool)>>,
    monitor: Monitor<'_>,
) -> Option<Simple> {
    if node_type.inputs.len() > SIMPLE_PORTS {
        return None;
    }
    let mut args = [const { Arg::Missing }; SIMPLE_PORTS];
    let mut path = None;
    for ((input, port), arg) in inputs.zip(&node_type.inputs).zip(&mut args) {
        let (tree, by_wire) = input?;
        let Some(tree) = tree else { continue };
        if port.access != Access::Tree && tree.branches().len() != 1 {
            return None;
        }
        let takes = |column: &Column| {
            port.item_type.id.is_none_or(|id| id == column.item_type())
                && (!by_wire || !port.is_checked() || port.accepts_all(column))
        };
        if !tree.branches().iter().stoppable().all(|(_, column)| takes(column)) {
            return None;
        }
        if port.access == Access::Tree {
            *arg = Arg::Tree(tree);
            continue;
        }
        let [(name, column)] = tree.branches() else { return None };
        path = path.or(Some(name));
        *arg = match port.access {
            Access::List => Arg::List(column),
            _ if column.len() == 1 && !column.has_gaps() => Arg::One(column),
            _ => return None,
        };
    }
    Some(run_args(node_type, args.get(..node_type.inputs.len())?, path, monitor))
}

/// Runs a node in its only lane, in the branch of that path.
pub(crate) fn run_args(node_type: &NodeType, args: &[Arg<'_>], path: Option<&Path>, monitor: Monitor<'_>) -> Simple {
    let root = path.is_none_or(Path::is_root);
    let path = || path.map_or_else(|| Cow::Owned(Path::root()), Cow::Borrowed);
    let mut reports = Vec::new();
    let mut run = |outputs: &mut [Output]| {
        let reports = &mut reports;
        let (lane, first_lane) = (0, 0);
        run_lane(&mut Call { node_type, args, lanes: ALONE, lane, first_lane, outputs, reports, monitor, bug: None })
    };
    if node_type.outputs.len() != 1 {
        let mut outputs: Vec<Output> = node_type.outputs.iter().map(|_| Output::new(1)).collect();
        let lot = Lot::alone(run(&mut outputs), reports, monitor);
        let outcome = finish_alone(node_type, lot, outputs.into_iter(), &path(), Vec::new());
        return Simple::Outcome(Box::new(outcome));
    }
    let mut output = [Output::new(1)];
    let done = run(&mut output);
    if done.is_ok()
        && root
        && reports.is_empty()
        && let Some(v) = output[0].as_number()
    {
        return Simple::Number(v);
    }
    let lot = Lot::alone(done, reports, monitor);
    Simple::Outcome(Box::new(finish_alone(node_type, lot, output.into_iter(), &path(), Vec::new())))
}
