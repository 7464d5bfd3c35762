//! Making a cluster of nodes that stand in a graph: wires across the border become ports of its interface.

use super::super::cluster::Cluster;
use super::super::model::{Document, InterfaceInput, InterfaceOutput, Node, Wires, split_port};
use super::fragment::Names;
use super::{Operation, Table};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::expression::Expression;
use crate::value::Json;
use std::collections::{BTreeMap, BTreeSet};

/// What crosses the border of a cluster under construction.
#[derive(Default)]
struct Border {
    body: Document,
    instance: Node,
    names: Names,
    /// The cluster's output by the `node.port` that it shows.
    outputs: BTreeMap<String, String>,
    all: Vec<Operation>,
}

impl Document {
    /// The operation that makes a cluster of the nodes of those ids and puts one instance in their place. Wires that come
    /// in become inputs (equal ones the same), wires that go out become outputs; interface inputs and outputs of the
    /// document follow, and formulas over the document's inputs are handed in from the instance. Results stay the same.
    /// O(document).
    ///
    /// # Errors
    /// If a node is not there, the name or the instance's id is taken, or one port takes wires both from inside and
    /// from outside: such a port can be in the cluster only with all that it takes, or with nothing of it.
    pub fn gather(&self, ids: &[&str], name: &str, instance: &str) -> Result<Operation, Diagnostic> {
        let inside: BTreeSet<&str> = ids.iter().copied().collect();
        if let Some(id) = inside.iter().find(|id| !self.nodes.contains_key(**id)) {
            let hint = did_you_mean(id, self.nodes.keys().take(10_000).map(String::as_str));
            return Err(Diagnostic::error("unknown-name", format!("there is no node \"{id}\"")).maybe_hint(hint));
        }
        if self.clusters.contains_key(name) {
            return Err(Diagnostic::error("taken-id", format!("there is already a cluster \"{name}\"")));
        }
        if self.nodes.contains_key(instance) && !inside.contains(instance) {
            return Err(Diagnostic::error("taken-id", format!("there is already a node \"{instance}\"")));
        }
        let mut border = Border { instance: Node::instance(name), ..Border::default() };
        for (id, node) in self.nodes.iter().filter(|(id, _)| inside.contains(id.as_str())) {
            border.take_in(self, id, node, &inside)?;
        }
        border.follow_inputs(self, &inside, instance);
        border.lead_out(self, &inside, instance);
        border.follow_groups(self, &inside, instance);
        let mut all = vec![];
        // First away with the nodes, so that the instance may have the id of one of them.
        all.extend(inside.iter().map(|id| Operation::PutNode { id: (*id).into(), node: None }));
        all.push(Operation::SetCluster {
            name: name.into(),
            cluster: Some(Box::new(Cluster::Here(Box::new(border.body)))),
        });
        all.push(Operation::AddNode { id: instance.into(), node: Box::new(border.instance) });
        all.extend(border.all);
        let positions: Vec<[f64; 2]> = inside.iter().filter_map(|id| self.position(id)).collect();
        if !positions.is_empty() {
            let mean = |i: usize| positions.iter().map(|p| p[i]).sum::<f64>() / positions.len() as f64;
            all.push(Operation::Move { node: instance.into(), to: Some([mean(0), mean(1)]) });
        }
        Ok(Operation::All(all))
    }
}

fn is_inside(inside: &BTreeSet<&str>, address: &str) -> bool {
    split_port(address).is_some_and(|(node, _)| inside.contains(node))
}

impl Border {
    /// Puts a node into the body; what comes to it from outside goes to the instance.
    fn take_in(
        &mut self,
        document: &Document,
        id: &str,
        node: &Node,
        inside: &BTreeSet<&str>,
    ) -> Result<(), Diagnostic> {
        let mut taken = node.clone();
        for (port, wires) in &node.inputs {
            let inner = wires.from.iter().filter(|from| is_inside(inside, from)).count();
            if inner == wires.from.len() {
                continue;
            }
            if inner > 0 {
                let message = "the port takes wires both from the cluster and from outside of it".to_owned();
                let hint = "take all of its sources into the cluster, or none, or join them in a node of their own";
                return Err(Diagnostic::error("mixed-wires", message).at(id).port(port).hint(hint));
            }
            taken.inputs.remove(port);
            taken.forget_source();
            let shared = self.instance.inputs.iter().find(|(_, w)| *w == wires).map(|(name, _)| name.to_string());
            let input = shared.unwrap_or_else(|| self.new_input(id, port));
            self.bind(&input, id, port);
            self.instance.inputs.insert(input, wires.clone());
        }
        for (port, literal) in &node.params {
            // A formula over inputs of the document is computed outside and handed in.
            if names_input(document, &literal.json()) && !node.inputs.contains_key(port) {
                taken.params.remove(port);
                taken.forget_source();
                let input = self.new_input(id, port);
                self.bind(&input, id, port);
                self.instance.params.insert(input, literal.clone());
            }
        }
        if let Some(position) = document.position(id) {
            self.body.layout.positions.insert(id.to_owned(), position);
        }
        if let Some(look) = document.layout.looks.get(id) {
            self.body.layout.looks.insert(id.to_owned(), *look);
        }
        self.body.nodes.insert(id.to_owned(), taken);
        Ok(())
    }

    /// A name for an input that leads to `port`: its own, or with its node's before it, or with a number behind it.
    fn new_input(&mut self, id: &str, port: &str) -> String {
        let long = format!("{id}_{port}");
        let free = [port, &long].into_iter().find(|name| !self.body.inputs.contains_key(*name)).map(str::to_owned);
        free.unwrap_or_else(|| self.names.next(&long, |name| self.body.inputs.contains_key(name)))
    }

    fn new_output(&mut self, id: &str, port: &str) -> String {
        let long = format!("{id}_{port}");
        let free = [port, &long].into_iter().find(|name| !self.body.outputs.contains_key(*name)).map(str::to_owned);
        free.unwrap_or_else(|| self.names.next(&long, |name| self.body.outputs.contains_key(name)))
    }

    fn bind(&mut self, input: &str, id: &str, port: &str) {
        self.body.inputs.entry(input.to_owned()).or_default().ports.push(format!("{id}.{port}"));
    }

    /// Interface inputs of the document that lead inside lead to the instance, and what is known of them comes along.
    fn follow_inputs(&mut self, document: &Document, inside: &BTreeSet<&str>, instance: &str) {
        for (name, input) in &document.inputs {
            let (inner, mut ports): (Vec<String>, Vec<String>) =
                input.ports.iter().cloned().partition(|p| is_inside(inside, p));
            // Ports that have become inputs by a wire or a formula lead there already.
            let bound = |p: &String| self.body.inputs.iter().find(|(_, i)| i.ports.contains(p)).map(|(n, _)| n.clone());
            let (known, open): (Vec<String>, Vec<String>) = inner.into_iter().partition(|p| bound(p).is_some());
            let mut through: Vec<String> = known.iter().filter_map(bound).collect();
            if !open.is_empty() {
                let own = if self.body.inputs.contains_key(name) {
                    self.names.next(name, |n| self.body.inputs.contains_key(n))
                } else {
                    name.clone()
                };
                // The value goes up to the instance, where the document's input now sets it. The range stays with the
                // document: only what is set from now on has to lie in it.
                let mut values = open.iter().map(|p| {
                    let (id, port) = split_port(p)?;
                    self.body.nodes.get(id)?.params.get(port).cloned()
                });
                if let Some(Some(value)) = values.next()
                    && values.all(|other| other.as_ref() == Some(&value))
                {
                    self.instance.params.insert(own.as_str(), value);
                }
                let (unit, doc) = (input.unit.clone(), input.doc.clone());
                self.body.inputs.insert(own.clone(), InterfaceInput { ports: open, unit, doc, ..Default::default() });
                through.push(own);
            }
            if through.is_empty() {
                continue;
            }
            through.dedup();
            ports.extend(through.iter().map(|input| format!("{instance}.{input}")));
            let input = InterfaceInput { ports, ..input.clone() };
            self.all.push(Operation::SetInput { name: name.clone(), input: Some(input) });
        }
    }

    /// The cluster's output for a `node.port` inside.
    fn output(&mut self, address: &str) -> String {
        if let Some(name) = self.outputs.get(address) {
            return name.clone();
        }
        let (id, port) = split_port(address).unwrap_or((address, ""));
        let name = self.new_output(id, port);
        let output = InterfaceOutput { port: address.to_owned(), ..InterfaceOutput::default() };
        self.body.outputs.insert(name.clone(), output);
        self.outputs.insert(address.to_owned(), name.clone());
        name
    }

    /// Wires and outputs of the document that come from inside come from the instance.
    fn lead_out(&mut self, document: &Document, inside: &BTreeSet<&str>, instance: &str) {
        for (id, node) in document.nodes.iter().filter(|(id, _)| !inside.contains(id.as_str())) {
            for (port, wires) in &node.inputs {
                if wires.from.iter().any(|from| is_inside(inside, from)) {
                    let wires = self.led_from(wires, inside, instance);
                    self.all.push(Operation::PutWires { node: id.clone(), port: port.to_string(), wires: Some(wires) });
                }
            }
        }
        // What comes in may come from a node that something inside leads to.
        let inputs = std::mem::take(&mut self.instance.inputs);
        for (input, wires) in &inputs {
            let wires = self.led_from(wires, inside, instance);
            self.instance.inputs.insert(input.clone(), wires);
        }
        for (name, output) in document.outputs.iter().filter(|(_, o)| is_inside(inside, &o.port)) {
            let port = format!("{instance}.{}", self.output(&output.port));
            let output = Some(InterfaceOutput { port, ..output.clone() });
            self.all.push(Operation::SetOutput { name: name.clone(), output });
        }
    }

    fn led_from(&mut self, wires: &Wires, inside: &BTreeSet<&str>, instance: &str) -> Wires {
        let from = wires.from.iter().map(|from| {
            if is_inside(inside, from) { format!("{instance}.{}", self.output(from)).into() } else { from.clone() }
        });
        Wires { from: from.collect(), more: wires.more.clone() }
    }

    /// Groups that lie inside go along; in others the instance stands for the nodes that have gone.
    fn follow_groups(&mut self, document: &Document, inside: &BTreeSet<&str>, instance: &str) {
        for (name, group) in &document.groups {
            let Some(members) = group.get("nodes").and_then(Json::as_array) else { continue };
            let gone = |m: &&Json| m.as_str().is_some_and(|id| inside.contains(id));
            let count = members.iter().filter(gone).count();
            if count == 0 {
                continue;
            }
            if count == members.len() {
                self.body.groups.insert(name.clone(), group.clone());
                self.all.push(Operation::SetEntry { table: Table::Groups, key: name.clone(), value: None });
                continue;
            }
            let mut left: Vec<Json> = members.iter().filter(|m| !gone(m)).cloned().collect();
            left.push(instance.into());
            let mut group = group.clone();
            group["nodes"] = left.into();
            self.all.push(Operation::SetEntry { table: Table::Groups, key: name.clone(), value: Some(group) });
        }
    }
}

/// Whether a literal is, or holds, a formula over an interface input of the document.
fn names_input(document: &Document, json: &Json) -> bool {
    let items = match json {
        Json::Array(items) => items.as_slice(),
        one => std::slice::from_ref(one),
    };
    let formulas = items.iter().filter_map(Json::as_str).filter_map(|text| Expression::parse(text).ok());
    formulas.into_iter().any(|f| f.names().iter().any(|name| document.inputs.contains_key(name)))
}
