//! Applying an operation. All of them come down to putting single places to values through `Edit`, which notes how to
//! take each back; so no operation needs an inverse of its own.

use super::super::fields::Name;
use super::super::format::node_text;
use super::super::layout::{LAYOUT_KEYS, Look};
use super::super::literal::Literal;
use super::super::load::{DEPTH_LIMIT, check_foreign, read_node};
use super::super::model::WiresMore;
use super::super::model::{Document, InterfaceInput, InterfaceOutput, Node, Wires, split_port, valid_id};
use super::cluster::{CLUSTER_KEYS, check_interface_key};
use super::{Operation, Table};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::value::Json;
use std::collections::BTreeMap;

/// A document under change, and what takes the changes back, the last first.
pub(super) struct Edit<'a> {
    pub document: &'a mut Document,
    pub undo: Vec<Operation>,
    /// Levels of braces in the file around the document: 0, or 2 for a cluster.
    pub above: usize,
}

/// Applies an operation to a document that stands so many levels down in its file.
pub(super) fn apply_at(operation: &Operation, document: &mut Document, above: usize) -> Result<Operation, Diagnostic> {
    let mut edit = Edit { document, undo: Vec::new(), above };
    for part in operation.parts() {
        if let Err(diagnostic) = edit.part(part) {
            let undo = std::mem::take(&mut edit.undo);
            for step in undo.into_iter().rev() {
                // What was there a moment ago is accepted again.
                let back = edit.part(&step);
                debug_assert!(back.is_ok(), "{back:?}");
            }
            return Err(diagnostic);
        }
    }
    edit.undo.reverse();
    let one = if edit.undo.len() == 1 { edit.undo.pop() } else { None };
    Ok(one.unwrap_or(Operation::All(edit.undo)))
}

pub(super) fn refuse<T>(code: &'static str, message: String) -> Result<T, Diagnostic> {
    Err(Diagnostic::error(code, message))
}

impl Edit<'_> {
    fn part(&mut self, operation: &Operation) -> Result<(), Diagnostic> {
        match operation {
            Operation::AddNode { id, node } => {
                self.free(id)?;
                self.put_node(id, Some(node))
            }
            Operation::RemoveNode { id } => self.remove_node(id),
            Operation::PutNode { id, node } => self.put_node(id, node.as_deref()),
            Operation::Rename { from, to } => self.rename(from, to),
            Operation::Connect { node, port, from, at } => self.connect(node, port, from, *at),
            Operation::Disconnect { node, port, from } => self.disconnect(node, port, from),
            Operation::PutWires { node, port, wires } => {
                self.known(node)?;
                if let Some(wires) = wires {
                    check_wires(wires)?;
                }
                self.put_wires(node, port, wires.clone());
                Ok(())
            }
            Operation::SetParam { node, port, value } => self.set_param(node, port, value.as_ref()),
            Operation::SetMatching { node, matching } => {
                self.known(node)?;
                self.change(node, |n| n.matching = *matching);
                Ok(())
            }
            Operation::SetState { node, state } => {
                self.known(node)?;
                self.change(node, |n| n.state = *state);
                Ok(())
            }
            Operation::SetNote { node, note } => {
                self.known(node)?;
                self.change(node, |n| n.more.note.clone_from(note));
                Ok(())
            }
            Operation::SetGroup { name, nodes } => self.set_group(name, nodes.as_deref()),
            Operation::SetInput { name, input } => {
                if let Some(input) = input {
                    check_input(name, input)?;
                }
                self.put_input(name, input.clone());
                Ok(())
            }
            Operation::SetOutput { name, output } => {
                if let Some(output) = output {
                    check_address(&output.port)?;
                }
                self.put_output(name, output.clone());
                Ok(())
            }
            Operation::SetEntry { table, key, value } => self.set_entry(*table, key, value.as_ref()),
            Operation::SetCluster { name, cluster } => self.set_cluster(name, cluster.as_deref()),
            Operation::InCluster { name, operation } => self.in_cluster(name, operation),
            Operation::SetForeign { text } => {
                let text = text.as_deref().map(str::trim);
                if let Some(text) = text {
                    check_foreign(text, self.above)?;
                }
                let old = std::mem::replace(&mut self.document.foreign, text.map(Into::into));
                self.undo.push(Operation::SetForeign { text: old.map(|t| t.to_string()) });
                Ok(())
            }
            Operation::Move { node, to } => {
                self.known(node)?;
                if to.is_some_and(|p| !p.iter().all(|v| v.is_finite())) {
                    return refuse("bad-position", format!("the position of \"{node}\" is not finite"));
                }
                self.put_position(node, *to);
                Ok(())
            }
            Operation::SetLook { node, look } => {
                self.known(node)?;
                self.put_look(node, *look);
                Ok(())
            }
            Operation::All(_) => Ok(()), // `parts` has taken it apart.
        }
    }

    fn known(&self, id: &str) -> Result<(), Diagnostic> {
        if self.document.nodes.contains_key(id) {
            return Ok(());
        }
        let hint = did_you_mean(id, self.document.nodes.keys().take(10_000).map(String::as_str));
        Err(Diagnostic::error("unknown-name", format!("there is no node \"{id}\"")).maybe_hint(hint))
    }

    fn free(&self, id: &str) -> Result<(), Diagnostic> {
        if self.document.nodes.contains_key(id) {
            return refuse("taken-id", format!("there is already a node \"{id}\""));
        }
        Ok(())
    }

    fn put_node(&mut self, id: &str, node: Option<&Node>) -> Result<(), Diagnostic> {
        let Some(node) = node else {
            self.put_position(id, None);
            self.put_look(id, Look::default());
            let old = self.document.nodes.remove(id).map(Box::new);
            self.undo.push(Operation::PutNode { id: id.into(), node: old });
            return Ok(());
        };
        if !valid_id(id) {
            return refuse("bad-id", format!("\"{id}\" cannot be a node's id: it is empty or has a dot in it"));
        }
        if node.version == 0 {
            return refuse("bad-version", format!("\"v\" of node \"{id}\" must be a whole number from 1, not 0"));
        }
        node.params.values().filter_map(Literal::nested).try_for_each(|v| check_depth(v, 4 + self.above))?;
        node.inputs.values().try_for_each(check_wires)?;
        let mut node = node.clone();
        node.check_source();
        let old = self.document.nodes.insert(id.into(), node).map(Box::new);
        self.undo.push(Operation::PutNode { id: id.into(), node: old });
        Ok(())
    }

    /// Changes a node that is there; the whole of it is put back by undoing, so its source text comes back too.
    fn change(&mut self, id: &str, change: impl FnOnce(&mut Node)) {
        let Some(node) = self.document.nodes.get_mut(id) else { return };
        self.undo.push(Operation::PutNode { id: id.into(), node: Some(Box::new(node.clone())) });
        node.forget_source();
        change(node);
    }

    fn set_param(&mut self, id: &str, port: &str, value: Option<&Json>) -> Result<(), Diagnostic> {
        self.known(id)?;
        value.map_or(Ok(()), |v| check_depth(v, 4 + self.above))?;
        let put = |node: &mut Node| match value {
            Some(value) => node.params.insert(port, value.clone()),
            None => node.params.remove(port),
        };
        match self.document.nodes.get_mut(id) {
            // A slider moves often: without source text to bring back, the old value is all that undoing needs.
            Some(node) if node.more.raw.0.is_none() => {
                let old = put(node);
                self.undo.push(Operation::SetParam {
                    node: id.into(),
                    port: port.into(),
                    value: old.map(|v| v.to_json()),
                });
            }
            _ => self.change(id, |node| {
                put(node);
            }),
        }
        Ok(())
    }

    fn put_wires(&mut self, id: &str, port: &str, wires: Option<Wires>) {
        self.change(id, |node| match wires {
            Some(wires) => {
                node.inputs.insert(port, wires);
            }
            None => {
                node.inputs.remove(port);
            }
        });
    }

    fn wires(&self, id: &str, port: &str) -> Option<Wires> {
        self.document.nodes.get(id)?.inputs.get(port).cloned()
    }

    fn connect(&mut self, id: &str, port: &str, from: &str, at: Option<usize>) -> Result<(), Diagnostic> {
        self.known(id)?;
        check_address(from)?;
        self.known(split_port(from).map_or("", |(node, _)| node))?;
        let mut wires = self.wires(id, port).unwrap_or_default();
        if wires.from.iter().any(|f| f == from) {
            let message = format!("the wire from {from} is already there");
            return Err(Diagnostic::error("duplicate-wire", message).at(id).port(port));
        }
        wires.from.insert(at.unwrap_or(usize::MAX).min(wires.from.len()), from.into());
        self.put_wires(id, port, Some(wires));
        Ok(())
    }

    fn disconnect(&mut self, id: &str, port: &str, from: &str) -> Result<(), Diagnostic> {
        self.known(id)?;
        let mut wires = self.wires(id, port).unwrap_or_default();
        let Some(i) = wires.from.iter().position(|f| f == from) else {
            let hint = did_you_mean(from, wires.from.iter().map(Name::as_str));
            let message = format!("there is no wire from {from}");
            return Err(Diagnostic::error("unknown-wire", message).at(id).port(port).maybe_hint(hint));
        };
        wires.from.remove(i);
        self.put_wires(id, port, Some(wires).filter(|w| !w.says_nothing()));
        Ok(())
    }

    fn remove_node(&mut self, id: &str) -> Result<(), Diagnostic> {
        self.known(id)?;
        self.readdress(id, None);
        self.put_node(id, None)
    }

    fn rename(&mut self, from: &str, to: &str) -> Result<(), Diagnostic> {
        self.known(from)?;
        if from == to {
            return Ok(());
        }
        self.free(to)?;
        if !valid_id(to) {
            return refuse("bad-id", format!("\"{to}\" cannot be a node's id: it is empty or has a dot in it"));
        }
        // First the addresses, so that a node wired to itself follows too.
        self.readdress(from, Some(to));
        let position = self.document.layout.positions.get(from).copied();
        let look = self.document.look(from);
        let node = self.document.nodes.get(from).cloned();
        self.put_node(from, None)?;
        self.put_node(to, node.as_ref())?;
        if position.is_some() {
            self.put_position(to, position);
        }
        self.put_look(to, look);
        Ok(())
    }

    /// Lets everything that names a node name another, or removes it. O(document).
    fn readdress(&mut self, id: &str, to: Option<&str>) {
        let of_node = |address: &str| split_port(address).is_some_and(|(n, _)| n == id);
        let renamed = |address: &str| match split_port(address) {
            Some((n, port)) if n == id => to.map(|to| format!("{to}.{port}")),
            _ => Some(address.to_owned()),
        };
        let mut touched = Vec::new();
        for (user, node) in &self.document.nodes {
            for (port, wires) in &node.inputs {
                if wires.from.iter().any(|f| of_node(f)) {
                    touched.push((user.clone(), port.clone(), wires.clone()));
                }
            }
        }
        for (user, port, mut wires) in touched {
            wires.from = wires.from.iter().filter_map(|f| renamed(f).map(Name::from)).collect();
            self.put_wires(&user, &port, Some(wires).filter(|w| !w.says_nothing()));
        }
        let inputs = self.document.inputs.iter().filter(|(_, i)| i.ports.iter().any(|p| of_node(p)));
        let inputs: Vec<(String, InterfaceInput)> = inputs.map(|(n, i)| (n.clone(), i.clone())).collect();
        for (name, mut input) in inputs {
            input.ports = input.ports.iter().filter_map(|p| renamed(p)).collect();
            self.put_input(&name, Some(input).filter(|i| !i.ports.is_empty()));
        }
        let outputs = self.document.outputs.iter().filter(|(_, o)| of_node(&o.port));
        let outputs: Vec<(String, InterfaceOutput)> = outputs.map(|(n, o)| (n.clone(), o.clone())).collect();
        for (name, output) in outputs {
            let output = renamed(&output.port).map(|port| InterfaceOutput { port, ..output });
            self.put_output(&name, output);
        }
        let groups: Vec<(String, Json)> = self.document.groups.iter().map(|(n, g)| (n.clone(), g.clone())).collect();
        for (name, mut group) in groups {
            let Some(members) = group.get_mut("nodes").and_then(Json::as_array_mut) else { continue };
            let before = members.len();
            match to {
                None => members.retain(|m| m.as_str() != Some(id)),
                Some(to) => members.iter_mut().filter(|m| m.as_str() == Some(id)).for_each(|m| *m = to.into()),
            }
            if members.len() < before || to.is_some() && members.iter().any(|m| m.as_str() == to) {
                self.put_entry(Table::Groups, &name, Some(group));
            }
        }
    }

    fn set_group(&mut self, name: &str, nodes: Option<&[String]>) -> Result<(), Diagnostic> {
        let Some(nodes) = nodes else {
            if !self.document.groups.contains_key(name) {
                return refuse("unknown-name", format!("there is no group \"{name}\""));
            }
            self.put_entry(Table::Groups, name, None);
            return Ok(());
        };
        nodes.iter().try_for_each(|id| self.known(id))?;
        let mut group = self.document.groups.get(name).and_then(Json::as_object).cloned().unwrap_or_default();
        group.insert("nodes".into(), nodes.iter().map(|id| Json::from(id.as_str())).collect());
        self.put_entry(Table::Groups, name, Some(Json::Object(group)));
        Ok(())
    }

    fn put_input(&mut self, name: &str, input: Option<InterfaceInput>) {
        let input = put(&mut self.document.inputs, name, input);
        self.undo.push(Operation::SetInput { name: name.into(), input });
    }

    fn put_output(&mut self, name: &str, output: Option<InterfaceOutput>) {
        let output = put(&mut self.document.outputs, name, output);
        self.undo.push(Operation::SetOutput { name: name.into(), output });
    }

    fn put_position(&mut self, node: &str, to: Option<[f64; 2]>) {
        let old = put(&mut self.document.layout.positions, node, to);
        if old.is_some() || to.is_some() {
            self.undo.push(Operation::Move { node: node.into(), to: old });
        }
    }

    fn put_look(&mut self, node: &str, look: Look) {
        let new = Some(look).filter(|look| *look != Look::default());
        let old = put(&mut self.document.layout.looks, node, new).unwrap_or_default();
        if old != look {
            self.undo.push(Operation::SetLook { node: node.into(), look: old });
        }
    }

    fn set_entry(&mut self, table: Table, key: &str, value: Option<&Json>) -> Result<(), Diagnostic> {
        let reserved: &[&str] = match table {
            Table::Top if self.above > 0 => CLUSTER_KEYS,
            Table::Top => &["format", "version", "units", "requires", "groups", "clusters", "x", "interface", "nodes"],
            Table::Interface => &["inputs", "outputs"],
            Table::Layout if self.above > 0 => {
                return refuse("reserved-key", "the layout file keeps nothing else of clusters".to_owned());
            }
            Table::Layout => LAYOUT_KEYS,
            Table::Requires | Table::Groups => &[],
        };
        if reserved.contains(&key) {
            return refuse("reserved-key", format!("\"{key}\" has a meaning of its own in the file"));
        }
        value.map_or(Ok(()), |v| check_depth(v, 2 + self.above))?;
        if let (Table::Interface, Some(value)) = (table, value) {
            check_interface_key(key, value)?;
        }
        self.put_entry(table, key, value.cloned());
        Ok(())
    }

    fn put_entry(&mut self, table: Table, key: &str, value: Option<Json>) {
        let map = match table {
            Table::Requires => &mut self.document.requires,
            Table::Groups => &mut self.document.groups,
            Table::Interface => &mut self.document.interface_extra,
            Table::Top => &mut self.document.extra,
            Table::Layout => &mut self.document.layout.extra,
        };
        let value = put(map, key, value);
        self.undo.push(Operation::SetEntry { table, key: key.into(), value });
    }
}

pub(super) fn put<V>(map: &mut BTreeMap<String, V>, key: &str, value: Option<V>) -> Option<V> {
    match value {
        Some(value) => map.insert(key.into(), value),
        None => map.remove(key),
    }
}

impl Node {
    /// Drops source text that no longer says what the node is: fields are public, so a copy may have been changed.
    /// O(source text).
    pub(crate) fn check_source(&mut self) {
        let Some(raw) = &self.more.raw.0 else { return };
        if read_node(raw).is_none_or(|said| said != *self || node_text(&said, 0) != node_text(self, 0)) {
            self.forget_source();
        }
    }
}

impl Wires {
    pub(super) fn says_nothing(&self) -> bool {
        self.from.is_empty() && *self.more == WiresMore::default()
    }
}

pub(super) fn check_address(address: &str) -> Result<(), Diagnostic> {
    if split_port(address).is_none() {
        return refuse("bad-address", format!("\"{address}\" is not of the form node.port"));
    }
    Ok(())
}

pub(super) fn check_wires(wires: &Wires) -> Result<(), Diagnostic> {
    wires.from.iter().try_for_each(|f| check_address(f))
}

pub(super) fn check_input(name: &str, input: &InterfaceInput) -> Result<(), Diagnostic> {
    input.ports.iter().try_for_each(|p| check_address(p))?;
    if [input.min, input.max].into_iter().flatten().any(|v| !v.is_finite()) {
        return refuse("bad-range", format!("the range of input \"{name}\" is not finite"));
    }
    if input.step.is_some_and(|v| !(v.is_finite() && v > 0.0)) {
        return refuse("bad-range", format!("the step of input \"{name}\" is not above 0"));
    }
    Ok(())
}

/// Refuses a value that would nest the file too deep to be read again; it stands `above` levels down. O(value).
pub(super) fn check_depth(value: &Json, above: usize) -> Result<(), Diagnostic> {
    let mut open = vec![(value, above)];
    while let Some((value, depth)) = open.pop() {
        let inside = depth + 1;
        if (value.is_array() || value.is_object()) && inside > DEPTH_LIMIT {
            return refuse("too-deep", format!("the file would nest deeper than {DEPTH_LIMIT} levels"));
        }
        match value {
            Json::Array(list) => open.extend(list.iter().map(|v| (v, inside))),
            Json::Object(map) => open.extend(map.values().map(|v| (v, inside))),
            _ => {}
        }
    }
    Ok(())
}
