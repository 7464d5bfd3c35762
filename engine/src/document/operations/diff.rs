//! What makes one document into another.

use super::super::cluster::Cluster;
use super::super::fields::Name;
use super::super::format::{input_text, json_text, link_text, node_text, output_text};
use super::super::literal::Literal;
use super::super::model::{Document, Node};
use super::apply::apply_at;
use super::{Operation, Table};
use crate::value::Json;
use std::borrow::Cow;
use std::collections::{BTreeMap, HashSet};

impl Document {
    /// Operations that make `self` into `other`: applied in order, they give the same document and the same text, byte for
    /// byte. Nodes of the same type and version are changed field by field, others are put whole, and so are links; in
    /// clusters of this file differences are found in the same way. A node that is gone is renamed where `other` has one
    /// like it (its wires aside) that `self` has not, and no second one. O(n), linear in both texts, besides O(n) for every
    /// rename.
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
        let renames = renames(self, other);
        if renames.is_empty() {
            return self.difference(other, depth);
        }
        let mut renamed = self.clone();
        let possible = |rename: &Operation| apply_at(rename, &mut renamed, depth).is_ok();
        let mut all: Vec<Operation> = renames.into_iter().filter(possible).collect();
        all.extend(renamed.difference(other, depth));
        all
    }

    /// The same without renames.
    fn difference(&self, other: &Self, depth: usize) -> Vec<Operation> {
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
            (Table::Layout, &self.layout.extra, &other.layout.extra),
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
        for (node, _, look) in changed(&self.layout.looks, &other.layout.looks, |a, b| a == b) {
            if other.nodes.contains_key(node) {
                all.push(Operation::SetLook { node: node.into(), look: look.copied().unwrap_or_default() });
            }
        }
        all
    }
}

/// Pairs of a node that only `a` has and one that only `b` has which are alike, as renames in order of the old ids. Several
/// alike are told apart by where they lie and by what is wired to them; if they cannot, they are left as they are.
fn renames(a: &Document, b: &Document) -> Vec<Operation> {
    let gone: Vec<(&str, &Node)> = only_in(a, b);
    let new: Vec<(&str, &Node)> = only_in(b, a);
    let mut taken: HashSet<&str> = HashSet::new();
    let mut pairs: BTreeMap<&str, &str> = BTreeMap::new();
    for sharp in [true, false] {
        let mut alike: BTreeMap<String, [Vec<&str>; 2]> = BTreeMap::new();
        for (side, (document, nodes, others)) in [(a, &gone, b), (b, &new, a)].into_iter().enumerate() {
            for (id, node) in nodes.iter().filter(|(id, _)| !taken.contains(id)) {
                let mut key = likeness(node);
                if sharp {
                    let known = |from: &&Name| {
                        from.split_once('.').is_some_and(|(source, _)| others.nodes.contains_key(source))
                    };
                    let wires: Vec<&Name> = node.inputs.values().flat_map(|w| &w.from).filter(known).collect();
                    key.push_str(&format!("{wires:?} {:?}", document.layout.positions.get(*id)));
                }
                alike.entry(key).or_default()[side].push(id);
            }
        }
        for [gone, new] in alike.values() {
            if let ([from], [to]) = (&gone[..], &new[..]) {
                pairs.insert(from, to);
                taken.extend([*from, *to]);
            }
        }
    }
    pairs.into_iter().map(|(from, to)| Operation::Rename { from: from.into(), to: to.into() }).collect()
}

/// The nodes of `a` whose ids `b` does not have.
fn only_in<'a>(a: &'a Document, b: &Document) -> Vec<(&'a str, &'a Node)> {
    a.nodes.iter().filter(|(id, _)| !b.nodes.contains_key(*id)).map(|(id, node)| (id.as_str(), node)).collect()
}

/// Everything that the file says of a node, but of its wires only how many there are: their sources may be renamed too.
fn likeness(node: &Node) -> String {
    let mut bare = node.clone();
    let counts: Vec<(&Name, usize)> = node.inputs.iter().map(|(port, wires)| (port, wires.from.len())).collect();
    for port in node.inputs.keys() {
        if let Some(wires) = bare.inputs.get_mut(port) {
            wires.from.clear();
        }
    }
    bare.forget_source();
    format!("{} {counts:?} ", node_text(&bare, 0))
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

fn same_literal(a: &Literal, b: &Literal) -> bool {
    same_json(&a.json(), &b.json())
}

/// What the file says of a node.
fn source(node: &Node, depth: usize) -> Cow<'_, str> {
    match &node.more.raw.0 {
        Some(raw) => Cow::Borrowed(raw),
        None => Cow::Owned(node_text(node, depth)),
    }
}

fn node_diff(id: &str, a: &Node, b: &Node, depth: usize) -> Vec<Operation> {
    let whole = || vec![Operation::PutNode { id: id.into(), node: Some(Box::new(b.clone())) }];
    let same_extra = changed(&a.more.extra, &b.more.extra, same_json).is_empty();
    // Source text that is not in canonical form comes over only with the whole node.
    let plain = b.more.raw.0.as_ref().is_none_or(|raw| **raw == node_text(b, depth));
    if a.type_name != b.type_name || a.version != b.version || !same_extra || !plain {
        return whole();
    }
    let mut all = Vec::new();
    let gone = a.params.keys().filter(|p| !b.params.contains_key(p)).map(|p| (p, None));
    let there = b.params.iter().filter(|(p, v)| !a.params.get(p).is_some_and(|old| same_literal(old, v)));
    for (port, value) in gone.chain(there.map(|(p, v)| (p, Some(v.to_json())))) {
        all.push(Operation::SetParam { node: id.into(), port: port.to_string(), value });
    }
    let same =
        |a: &super::Wires, b: &super::Wires| a == b && changed(&a.more.extra, &b.more.extra, same_json).is_empty();
    let gone = a.inputs.keys().filter(|p| !b.inputs.contains_key(p)).map(|p| (p, None));
    let there = b.inputs.iter().filter(|(p, w)| !a.inputs.get(p).is_some_and(|old| same(old, w)));
    for (port, wires) in gone.chain(there.map(|(p, w)| (p, Some(w.clone())))) {
        all.push(Operation::PutWires { node: id.into(), port: port.to_string(), wires });
    }
    if a.matching != b.matching {
        all.push(Operation::SetMatching { node: id.into(), matching: b.matching });
    }
    if a.state != b.state {
        all.push(Operation::SetState { node: id.into(), state: b.state });
    }
    if a.more.note != b.more.note {
        all.push(Operation::SetNote { node: id.into(), note: b.more.note.clone() });
    }
    if all.is_empty() { whole() } else { all }
}
