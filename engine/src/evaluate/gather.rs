//! What arrives at a node: wires merged, items converted, trees reshaped, files read; and the key that all of it makes.

use super::matching::{FileRead, FilesOfPort, Input, Matching};
use super::state::Value;
use crate::diagnostic::{Fail, Severity};
use crate::document::model::TreeOp;
use crate::plan::{Plan, Slot};
use crate::port::Port;
use crate::registry::{NodeType, Registry};
use crate::stop::Stoppable;
use crate::value::digest::Mixer;
use crate::value::{Column, Path, Text, Tree, digest_bytes};
use std::any::TypeId;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Values by output slot, as far as they are in memory.
pub(crate) type Values = [Value];

/// Files read in one evaluation, so that two nodes see the same content.
pub(crate) type Files = HashMap<Arc<str>, FileRead>;

/// Words of a key that are no digests.
const MISSING: u128 = 1;
const BUNDLE: u128 = 2;
const UNREAD: u128 = 3;

/// How every key of a node type begins.
#[inline]
pub(super) fn key_of(t: &NodeType, matching: Matching) -> Mixer {
    Mixer::new(t.digest ^ u128::from(matching as u8))
}

impl Mixer {
    fn feed_tree(&mut self, tree: &Tree) {
        match tree.as_number() {
            Some(v) => self.feed_number(v),
            None => self.feed(tree.digest()),
        }
    }

    /// Numbers are never dropped from memory, so they come as such every time.
    fn feed_value(&mut self, value: &Value) {
        match value.tree() {
            Some(tree) => self.feed_tree(tree),
            None => self.feed(value.digest()),
        }
    }
}

/// The cache key: node type, version, matching, and per port what comes in. No value is touched, only digests.
pub(crate) fn key(plan: &Plan, n: usize, values: &Values, files: &[FilesOfPort]) -> u128 {
    let node = &plan.nodes[n];
    let Some(t) = plan.node_type(n) else { return 0 };
    let mut d = key_of(t, node.matching);
    for (p, slot) in plan.node_slots(n).iter().enumerate() {
        match slot {
            Slot::Missing => d.feed(MISSING),
            // A default, the same value written out and the same by wire are the same input.
            Slot::Default => match &t.defaults[p] {
                Some(tree) => d.feed_tree(tree),
                None => d.feed(MISSING),
            },
            Slot::Literal(l) => d.feed_tree(&plan.literals[*l as usize]),
            Slot::Wire(source) => d.feed_value(&values[*source as usize]),
            Slot::Wires(_) => {
                let (sources, shape) = plan.wires(slot);
                d.feed(BUNDLE | (sources.len() as u128) << 8 | (shape.len() as u128) << 64);
                sources.iter().for_each(|s| d.feed_value(&values[*s as usize]));
                shape.iter().for_each(|op| d.feed(*op as u128));
            }
        }
    }
    for read in files.iter().flat_map(|(_, branches)| branches.iter().flatten()) {
        match read {
            Ok(bytes) => d.feed(digest_bytes(bytes)),
            Err(why) => {
                d.feed(UNREAD);
                d.feed(digest_bytes(why.as_bytes()));
            }
        }
    }
    d.finish()
}

/// The tree that arrives at one port.
pub(crate) fn tree<'a>(
    plan: &'a Plan,
    registry: &Registry,
    n: usize,
    p: usize,
    values: &'a Values,
    reports: &mut Vec<(Severity, Fail)>,
) -> Result<Option<Cow<'a, Tree>>, Fail> {
    let Some(t) = plan.node_type(n) else { return Ok(None) };
    let slot = &plan.node_slots(n)[p];
    match slot {
        Slot::Missing => return Ok(None),
        Slot::Default => return Ok(t.defaults[p].as_ref().map(Cow::Borrowed)),
        Slot::Literal(l) => return Ok(plan.literals.get(*l as usize).map(Cow::Borrowed)),
        Slot::Wire(_) | Slot::Wires(_) => {}
    }
    let (sources, shape) = plan.wires(slot);
    let port = &t.inputs[p];
    let gone = || Fail::new("engine-fault", format!("the value for \"{}\" is not in memory", port.name));
    let mut arrive = |source: &u32| {
        let tree = values[*source as usize].tree().ok_or_else(gone)?;
        convert(tree, port, registry, reports)
    };
    let tree = match sources {
        [] => return Ok(None),
        [one] => arrive(one)?,
        many if let Some(numbers) = numbers(many, port, values) => Cow::Owned(numbers),
        many => Cow::Owned(merge(&many.iter().map(arrive).collect::<Result<Vec<_>, Fail>>()?, port)?),
    };
    Ok(Some(shaped(tree, shape)))
}

fn shaped<'a>(mut tree: Cow<'a, Tree>, shape: &[TreeOp]) -> Cow<'a, Tree> {
    for op in shape {
        tree = Cow::Owned(match op {
            TreeOp::Graft => tree.graft(),
            TreeOp::Flatten => tree.flatten(),
            TreeOp::Simplify => tree.simplify(),
            TreeOp::Reverse => tree.reverse(),
        });
    }
    tree
}

impl Registry {
    /// What a node sees at a port to which wires bring these values, in their order: each converted to what the port takes,
    /// joined branch by branch and shaped, as in an evaluation. Items that cannot be converted are gaps. O(1) for one
    /// wire that brings what the port takes and is not shaped, else O(items).
    ///
    /// # Errors
    /// Says what came in and cannot be taken, or cannot be joined.
    pub fn arriving(&self, port: &Port, trees: &[Tree], shape: &[TreeOp]) -> Result<Tree, Fail> {
        let mut told = Vec::new();
        let mut arrive = |tree| convert(tree, port, self, &mut told);
        let tree = match trees {
            [] => return Ok(Tree::default()),
            [one] => arrive(one)?,
            many => Cow::Owned(merge(&many.iter().map(arrive).collect::<Result<Vec<_>, Fail>>()?, port)?),
        };
        Ok(shaped(tree, shape).into_owned())
    }
}

/// What a bypassed node gives at each output: the first input of the same type that comes in by wire and was not passed
/// before. O(inputs × outputs).
pub(crate) fn passed(
    plan: &Plan,
    registry: &Registry,
    n: usize,
    values: &Values,
    reports: &mut Vec<(Severity, Fail)>,
) -> Result<Vec<Option<Tree>>, Fail> {
    let Some(t) = plan.node_type(n) else { return Ok(Vec::new()) };
    let wired = |p: &usize| plan.slot(n, *p).is_wired();
    let mut free: Vec<usize> = (0..t.inputs.len()).filter(wired).collect();
    let mut outputs = Vec::with_capacity(t.outputs.len());
    for output in &t.outputs {
        let same = |p: &usize| t.inputs[*p].item_type.id == output.item_type.id;
        outputs.push(match free.iter().position(same) {
            Some(at) => tree(plan, registry, n, free.remove(at), values, reports)?.map(Cow::into_owned),
            None => None,
        });
    }
    Ok(outputs)
}

/// Items become what the port takes.
pub(crate) fn convert<'a>(
    tree: &'a Tree,
    port: &Port,
    registry: &Registry,
    reports: &mut Vec<(Severity, Fail)>,
) -> Result<Cow<'a, Tree>, Fail> {
    let Some(to) = port.item_type.id else { return Ok(Cow::Borrowed(tree)) };
    if tree.branches().iter().stoppable().all(|(_, c)| c.item_type() == to) {
        return Ok(Cow::Borrowed(tree));
    }
    let mut branches: Vec<(Path, Column)> = Vec::with_capacity(tree.branches().len());
    for (path, column) in tree.branches().iter().stoppable() {
        let converted = if column.item_type() == to {
            column.clone()
        } else if let Some(convert) = registry.conversion(column.item_type(), to) {
            let (converted, errors) = convert(column);
            for (i, why) in errors {
                let fail = Fail::new("not-convertible", why).port(port.name.to_string());
                reports.push((Severity::Error, if column.len() > 1 { fail.item(i) } else { fail }));
            }
            converted
        } else if (0..column.len()).stoppable().all(|i| !column.is_valid(i)) {
            // Nothing but gaps: their type does not matter.
            (port.item_type.empty)().pick(&vec![None; column.len()])
        } else {
            let message =
                format!("\"{}\" takes {}, but {} came in", port.name, port.item_type.name, column.type_name());
            return Err(Fail::new("wrong-type", message).port(port.name.to_string()));
        };
        branches.push((path.clone(), converted));
    }
    Ok(Cow::Owned(Tree::from_branches(branches)))
}

/// Many wires that bring a number each into a port that takes numbers, as they often do: one list, and no tree in between.
fn numbers(sources: &[u32], port: &Port, values: &Values) -> Option<Tree> {
    if port.item_type.id.is_some_and(|id| id != TypeId::of::<f64>()) {
        return None;
    }
    let all: Option<Vec<f64>> = sources.iter().map(|s| values[*s as usize].tree()?.as_number()).collect();
    all.map(Tree::list)
}

/// Many wires into one port: branches of the same path append in the order of the wires. O(n log n) in branches.
fn merge(trees: &[Cow<'_, Tree>], port: &Port) -> Result<Tree, Fail> {
    let branches = || trees.iter().flat_map(|t| t.branches()).stoppable();
    let mixed = |a: &Column, b: &Column| {
        let (a, b) = (a.type_name(), b.type_name());
        let message = format!("\"{}\" cannot join {a} and {b} in one list", port.name);
        Fail::new("mixed-types", message).port(port.name.to_string())
    };
    let Some((path, first)) = branches().next() else { return Ok(Tree::default()) };
    if branches().all(|(p, _)| p == path) {
        let columns: Vec<Column> = branches().map(|(_, c)| c.clone()).collect();
        return match columns.iter().find(|c| c.item_type() != first.item_type()) {
            Some(other) => Err(mixed(first, other)),
            None => Ok(Tree::branch(path.clone(), Column::concat(&columns).unwrap_or_else(|| first.clone()))),
        };
    }
    let mut known: BTreeMap<&Path, &Column> = BTreeMap::new();
    for (path, column) in branches() {
        let first = *known.entry(path).or_insert(column);
        if first.item_type() != column.item_type() {
            return Err(mixed(first, column));
        }
    }
    Ok(Tree::from_branches(branches().cloned().collect()))
}

/// Reads the files that the node's file ports name.
pub(crate) fn files(
    plan: &Plan,
    registry: &Registry,
    n: usize,
    values: &Values,
    read: &mut dyn FnMut(&Arc<str>) -> FileRead,
) -> Vec<FilesOfPort> {
    let Some(t) = plan.node_type(n) else { return Vec::new() };
    let mut all = Vec::new();
    for (p, _) in t.inputs.iter().enumerate().filter(|(_, p)| p.file) {
        // What is wrong with the tree is told when the node runs.
        let Ok(Some(paths)) = tree(plan, registry, n, p, values, &mut Vec::new()) else { continue };
        let branch = |column: &Column, read: &mut dyn FnMut(&Arc<str>) -> FileRead| -> Vec<FileRead> {
            (0..column.len())
                .map(|i| column.get::<Text>(i).map_or_else(|| Err("no path".into()), |t| read(&t.0)))
                .collect()
        };
        all.push((p, paths.branches().iter().map(|(_, column)| branch(column, read)).collect()));
    }
    all
}

/// What arrives at each port of a node, as long as that is one tree as it is (else `None`), and whether it came by wire.
pub(crate) fn simple<'a>(
    plan: &'a Plan,
    t: &'a NodeType,
    n: usize,
    values: &'a Values,
) -> impl Iterator<Item = Option<(Option<&'a Tree>, bool)>> {
    plan.node_slots(n).iter().enumerate().map(move |(p, slot)| match slot {
        Slot::Missing => Some((None, false)),
        Slot::Default => Some((t.defaults.get(p)?.as_ref(), false)),
        Slot::Literal(l) => Some((Some(plan.literals.get(*l as usize)?), false)),
        Slot::Wire(source) => Some((Some(values[*source as usize].tree()?), true)),
        Slot::Wires(_) => None,
    })
}

/// Everything that arrives at the node.
pub(crate) fn inputs<'a>(
    plan: &'a Plan,
    registry: &Registry,
    n: usize,
    values: &'a Values,
    files: Vec<FilesOfPort>,
    reports: &mut Vec<(Severity, Fail)>,
) -> Result<(Vec<Input<'a>>, Matching), Fail> {
    let mut inputs = Vec::with_capacity(plan.slot_count(n));
    for (p, slot) in plan.node_slots(n).iter().enumerate() {
        let tree = tree(plan, registry, n, p, values, reports)?;
        inputs.push(Input { tree, files: Vec::new(), unchecked: slot.is_wired() });
    }
    for (p, read) in files {
        inputs[p].files = read;
    }
    Ok((inputs, plan.nodes[n].matching))
}
