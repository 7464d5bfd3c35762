//! What makes one document into another.

use super::super::cluster::Cluster;
use super::super::format::{input_text, json_text, link_text, node_text, output_text};
use super::super::model::{Document, Node};
use super::{Operation, Table};
use crate::value::Json;
use std::borrow::Cow;
use std::collections::BTreeMap;

impl Document {
    /// Operations that make `self` into `other`: applied in order, they give the same document and the same text, byte for
    /// byte. Nodes of the same type and version are changed field by field, others are put whole, and so are links; in
    /// clusters of this file differences are found in the same way. A renamed node counts as
    /// removed and added. O(n), linear in both texts.
    #[must_use]
    pub fn diff(&self, other: &Self) -> Vec<Operation> {
        let mut all = self.content_diff(other, 0);
        for (name, before, after) in changed(&self.clusters, &other.clusters, |_, _| false) {
            match (before, after) {
                (Some(Cluster::Here(before)), Some(Cluster::Here(after))) => {
                    let inside = |operation| Operation::InCluster { name: name.into(), operation: Box::new(operation) };
                    all.extend(before.content_diff(after, 2).into_iter().map(inside));
                }
                (Some(Cluster::File(before)), Some(Cluster::File(after))) if link_text(before) == link_text(after) => {}
                _ => {
                    let cluster = after.cloned().map(Box::new);
                    all.push(Operation::SetCluster { name: name.into(), cluster });
                }
            }
        }
        all
    }

    /// The difference but for clusters, of documents whose braces stand at `depth` in their files.
    fn content_diff(&self, other: &Self, depth: usize) -> Vec<Operation> {
        let mut all = Vec::new();
        for (id, before, after) in changed(&self.nodes, &other.nodes, |a, b| source(a, depth) == source(b, depth)) {
            match (before, after) {
                (Some(before), Some(after)) => all.extend(node_diff(id, before, after, depth)),
                (None, Some(node)) => all.push(Operation::AddNode { id: id.into(), node: Box::new(node.clone()) }),
                _ => all.push(Operation::PutNode { id: id.into(), node: None }),
            }
        }
        for (name, _, input) in changed(&self.inputs, &other.inputs, |a, b| input_text(a, 3) == input_text(b, 3)) {
            all.push(Operation::SetInput { name: name.into(), input: input.cloned() });
        }
        for (name, _, output) in changed(&self.outputs, &other.outputs, |a, b| output_text(a, 3) == output_text(b, 3)) {
            all.push(Operation::SetOutput { name: name.into(), output: output.cloned() });
        }
        let tables = [
            (Table::Requires, &self.requires, &other.requires),
            (Table::Groups, &self.groups, &other.groups),
            (Table::Interface, &self.interface_extra, &other.interface_extra),
            (Table::Top, &self.extra, &other.extra),
        ];
        for (table, a, b) in tables {
            for (key, _, value) in changed(a, b, same_json) {
                all.push(Operation::SetEntry { table, key: key.into(), value: value.cloned() });
            }
        }
        if self.foreign != other.foreign {
            all.push(Operation::SetForeign { text: other.foreign().map(str::to_owned) });
        }
        // Positions last: they are only of nodes that are there. Those of removed nodes have gone with them.
        for (node, _, to) in changed(&self.layout.positions, &other.layout.positions, |a, b| a == b) {
            if other.nodes.contains_key(node) {
                all.push(Operation::Move { node: node.into(), to: to.copied() });
            }
        }
        all
    }
}

/// The keys whose values differ, in order.
fn changed<'a, V>(
    a: &'a BTreeMap<String, V>,
    b: &'a BTreeMap<String, V>,
    same: impl Fn(&V, &V) -> bool,
) -> Vec<(&'a str, Option<&'a V>, Option<&'a V>)> {
    let gone = a.iter().filter(|(k, _)| !b.contains_key(*k)).map(|(k, v)| (k.as_str(), Some(v), None));
    let there = b.iter().map(|(k, v)| (k.as_str(), a.get(k), Some(v)));
    gone.chain(there.filter(|(_, a, b)| !a.zip(*b).is_some_and(|(a, b)| same(a, b)))).collect()
}

/// By text, not by value: 0.0 and -0.0 are equal numbers and different bytes.
fn same_json(a: &Json, b: &Json) -> bool {
    json_text(a) == json_text(b)
}

/// What the file says of a node.
fn source(node: &Node, depth: usize) -> Cow<'_, str> {
    match &node.raw.0 {
        Some(raw) => Cow::Borrowed(raw),
        None => Cow::Owned(node_text(node, depth)),
    }
}

fn node_diff(id: &str, a: &Node, b: &Node, depth: usize) -> Vec<Operation> {
    let whole = || vec![Operation::PutNode { id: id.into(), node: Some(Box::new(b.clone())) }];
    let same_extra = changed(&a.extra, &b.extra, same_json).is_empty();
    // Source text that is not in canonical form comes over only with the whole node.
    let plain = b.raw.0.as_ref().is_none_or(|raw| **raw == node_text(b, depth));
    if a.type_name != b.type_name || a.version != b.version || !same_extra || !plain {
        return whole();
    }
    let mut all = Vec::new();
    let gone = a.params.keys().filter(|p| !b.params.contains_key(p)).map(|p| (p, None));
    let there = b.params.iter().filter(|(p, v)| !a.params.get(p).is_some_and(|old| same_json(old, v)));
    for (port, value) in gone.chain(there.map(|(p, v)| (p, Some(v.clone())))) {
        all.push(Operation::SetParam { node: id.into(), port: port.clone(), value });
    }
    let same = |a: &super::Wires, b: &super::Wires| a == b && changed(&a.extra, &b.extra, same_json).is_empty();
    let gone = a.inputs.keys().filter(|p| !b.inputs.contains_key(p)).map(|p| (p, None));
    let there = b.inputs.iter().filter(|(p, w)| !a.inputs.get(p).is_some_and(|old| same(old, w)));
    for (port, wires) in gone.chain(there.map(|(p, w)| (p, Some(w.clone())))) {
        all.push(Operation::PutWires { node: id.into(), port: port.clone(), wires });
    }
    if a.matching != b.matching {
        all.push(Operation::SetMatching { node: id.into(), matching: b.matching });
    }
    if a.state != b.state {
        all.push(Operation::SetState { node: id.into(), state: b.state });
    }
    if a.note != b.note {
        all.push(Operation::SetNote { node: id.into(), note: b.note.clone() });
    }
    if all.is_empty() { whole() } else { all }
}
