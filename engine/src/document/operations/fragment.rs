//! Copy and paste: a fragment is a document of its own, so its text can go through a clipboard.

use super::super::cluster::Cluster;
use super::super::fields::Name;
use super::super::model::{Document, Node, split_port};
use super::{Operation, Table};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::value::Json;
use std::collections::{BTreeMap, BTreeSet, HashMap};

/// What becomes of wires that come to a fragment from outside of it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OuterWires {
    /// They stay where the document has a node of that id.
    Keep,
    /// They go.
    Drop,
}

/// A paste that has been prepared.
#[derive(Clone, Debug, PartialEq)]
pub struct Paste {
    /// Apply it to the document that it was prepared for.
    pub operation: Operation,
    /// Id in the document by id in the fragment.
    pub ids: BTreeMap<String, String>,
}

impl Document {
    /// The nodes of those ids with all their wires, the groups that consist of nothing else, their positions, and the clusters that they need. O(groups + nodes
    /// copied).
    ///
    /// # Errors
    /// If there is no node of one of the ids.
    pub fn copy(&self, ids: &[&str]) -> Result<Self, Diagnostic> {
        let mut fragment = Self::new();
        for id in ids {
            let Some(node) = self.nodes.get(*id) else {
                let hint = did_you_mean(id, self.nodes.keys().take(10_000).map(String::as_str));
                return Err(Diagnostic::error("unknown-name", format!("there is no node \"{id}\"")).maybe_hint(hint));
            };
            fragment.nodes.insert((*id).into(), node.clone());
            if let Some(position) = self.layout.positions.get(*id) {
                fragment.layout.positions.insert((*id).into(), *position);
            }
            if let Some(look) = self.layout.looks.get(*id) {
                fragment.layout.looks.insert((*id).into(), *look);
            }
        }
        for (name, group) in &self.groups {
            let Some(members) = group.get("nodes").and_then(Json::as_array) else { continue };
            let inside = |m: &Json| m.as_str().is_some_and(|id| fragment.nodes.contains_key(id));
            if !members.is_empty() && members.iter().all(inside) {
                fragment.groups.insert(name.clone(), group.clone());
            }
        }
        // The clusters that its instances need, and those that these need.
        let mut open: Vec<&str> = fragment.nodes.values().filter_map(Node::cluster).collect();
        let mut needed = BTreeSet::new();
        while let Some(name) = open.pop() {
            let Some(cluster) = self.clusters.get(name).filter(|_| needed.insert(name)) else { continue };
            if let Cluster::Here(body) = cluster {
                open.extend(body.nodes.values().filter_map(Node::cluster));
            }
        }
        let needed: BTreeMap<String, Cluster> =
            needed.into_iter().filter_map(|n| Some((n.to_owned(), self.clusters.get(n)?.clone()))).collect();
        fragment.clusters = needed;
        Ok(fragment)
    }

    /// The operation that puts a fragment into this document. Nodes and groups whose names are taken get the next free
    /// one (`add`, `add-2`, `add-3` …); so do clusters, unless the one that is here is the same; wires inside the fragment follow. Positions are moved by `offset`. The fragment's
    /// interface and foreign data stay behind. O(fragment × log n).
    #[must_use]
    pub fn paste(&self, fragment: &Self, outer: OuterWires, offset: [f64; 2]) -> Paste {
        let mut names = Names::default();
        let (mut own, mut all) = (None, Vec::new());
        if !fragment.clusters.is_empty() {
            let mut brought = fragment.clone();
            all = self.bring(&mut brought, &mut Names::default());
            own = Some(brought);
        }
        let fragment = own.as_ref().unwrap_or(fragment);
        // Names that are free stay, and nobody else may get them.
        let keep = fragment.nodes.keys().filter(|id| !self.nodes.contains_key(*id)).cloned();
        let mut ids: BTreeMap<String, String> = keep.map(|id| (id.clone(), id)).collect();
        for id in fragment.nodes.keys().filter(|id| self.nodes.contains_key(*id)) {
            let taken = |n: &str| self.nodes.contains_key(n) || fragment.nodes.contains_key(n);
            ids.insert(id.clone(), names.next(id, taken));
        }
        let address = |from: &str| {
            let (node, port) = split_port(from)?;
            match ids.get(node) {
                Some(id) => Some(format!("{id}.{port}")),
                None if outer == OuterWires::Keep && self.nodes.contains_key(node) => Some(from.to_owned()),
                None => None,
            }
        };
        for (id, node) in &fragment.nodes {
            let mut node = node.clone();
            let mut inputs = node.inputs.clone();
            for (port, wires) in &node.inputs {
                let mut wires = wires.clone();
                wires.from = wires.from.iter().filter_map(|f| address(f).map(Name::from)).collect();
                if wires.says_nothing() {
                    inputs.remove(port);
                } else {
                    inputs.insert(port.clone(), wires);
                }
            }
            if inputs != node.inputs {
                node.inputs = inputs;
                node.forget_source();
            }
            all.push(Operation::AddNode { id: ids[id].clone(), node: Box::new(node) });
        }
        for (id, [x, y]) in &fragment.layout.positions {
            if let Some(id) = ids.get(id) {
                all.push(Operation::Move { node: id.clone(), to: Some([x + offset[0], y + offset[1]]) });
            }
        }
        for (id, look) in &fragment.layout.looks {
            if let Some(id) = ids.get(id) {
                all.push(Operation::SetLook { node: id.clone(), look: *look });
            }
        }
        for (name, group) in &fragment.groups {
            let mut group = group.clone();
            if let Some(members) = group.get_mut("nodes").and_then(Json::as_array_mut) {
                for member in members {
                    if let Some(id) = member.as_str().and_then(|m| ids.get(m)) {
                        *member = Json::from(id.as_str());
                    }
                }
            }
            let taken = |n: &str| self.groups.contains_key(n) || fragment.groups.contains_key(n);
            let key = if self.groups.contains_key(name) { names.next(name, taken) } else { name.clone() };
            all.push(Operation::SetEntry { table: Table::Groups, key, value: Some(group) });
        }
        Paste { operation: Operation::All(all), ids }
    }
}

/// Gives out free names.
#[derive(Default)]
pub(super) struct Names {
    /// The number that each name was last given out with.
    last: HashMap<String, u64>,
    given: BTreeSet<String>,
}

impl Names {
    pub(super) fn next(&mut self, name: &str, taken: impl Fn(&str) -> bool) -> String {
        let numbered = name.rsplit_once('-').filter(|(s, n)| !s.is_empty() && n.parse::<u32>().is_ok());
        let stem = numbered.map_or(name, |(stem, _)| stem);
        let last = self.last.entry(stem.to_owned()).or_insert(1);
        loop {
            *last += 1;
            let candidate = format!("{stem}-{last}");
            if !taken(&candidate) && self.given.insert(candidate.clone()) {
                return candidate;
            }
        }
    }
}
