//! Taking clusters apart: an instance replaced by the nodes that it stands for, and a linked file taken into the graph.

use super::super::cluster::{Cluster, Link};
use super::super::fields::Name;
use super::super::link::{folder_of, join};
use super::super::literal::Literal;
use super::super::model::{Document, Node, Wires, split_port};
use super::fragment::{Names, OuterWires, Paste};
use super::{InterfaceInput, InterfaceOutput, Operation, Table};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::expression::Expression;
use crate::plan::Plan;
use crate::registry::Registry;
use crate::value::Json;
use std::collections::{BTreeMap, BTreeSet};

impl Document {
    /// The operation that puts the nodes of a cluster in the place of one of its instances, with what the instance says of
    /// them; says which id each of them gets. The definition and other instances stay. Results stay the same; ranges that
    /// only the cluster's interface gave are no longer checked. O(document after expansion).
    ///
    /// # Errors
    /// If there is no such instance, its definition cannot be used, or a formula inside cannot be written for the graph
    /// outside.
    pub fn explode(&self, instance: &str, registry: &Registry) -> Result<Paste, Diagnostic> {
        let Some(node) = self.nodes.get(instance) else {
            let hint = did_you_mean(instance, self.nodes.keys().take(10_000).map(String::as_str));
            let fault = Diagnostic::error("unknown-name", format!("there is no node \"{instance}\""));
            return Err(fault.maybe_hint(hint));
        };
        let plan = Plan::compile(self, registry);
        let name = node.cluster().filter(|_| plan.is_instance(instance));
        let Some(cluster) = name.and_then(|name| self.clusters.get(name)) else {
            let message = format!("\"{instance}\" is no instance of a cluster that can be used");
            return Err(Diagnostic::error("unknown-cluster", message).at(instance));
        };
        let mut fragment = match cluster {
            Cluster::Here(body) => Self::clone(body),
            Cluster::File(link) => self.unlinked(link, registry)?,
        };
        for (id, inner) in &mut fragment.nodes {
            if inner.state.within(node.state) != inner.state {
                inner.state = inner.state.within(node.state);
                inner.forget_source();
            }
            write_out(self, &plan, instance, id, inner)?;
        }
        let (inputs, outputs) = (std::mem::take(&mut fragment.inputs), std::mem::take(&mut fragment.outputs));
        for (name, input) in &inputs {
            let Some(value) = node.params.get(name) else { continue };
            for (id, port) in input.ports.iter().filter_map(|p| split_port(p)) {
                if let Some(inner) = fragment.node_mut(id) {
                    inner.params.insert(port, value.clone());
                }
            }
        }
        let Paste { operation, ids } = self.paste(&fragment, OuterWires::Drop, self.beside(instance, &fragment));
        let mut all: Vec<Operation> = operation.parts().cloned().collect();
        let there = |address: &String| {
            let (id, port) = split_port(address)?;
            Some(format!("{}.{port}", ids.get(id)?))
        };
        // An output of the instance, or anything else as it stands.
        let source = |address: &str| match split_port(address) {
            Some((id, port)) if id == instance => {
                outputs.get(port).and_then(|o| there(&o.port)).unwrap_or_else(|| address.to_owned())
            }
            _ => address.to_owned(),
        };
        let lead = |wires: &Wires| Wires {
            from: wires.from.iter().map(|f| source(f).into()).collect(),
            more: wires.more.clone(),
        };
        for (name, wires) in &node.inputs {
            for place in inputs.get(name.as_str()).into_iter().flat_map(|i| &i.ports).filter_map(there) {
                let Some((id, port)) = split_port(&place) else { continue };
                let wires = Some(lead(wires));
                all.push(Operation::PutWires { node: id.into(), port: port.into(), wires });
            }
        }
        for (id, other) in self.nodes.iter().filter(|(id, _)| *id != instance) {
            for (port, wires) in &other.inputs {
                if wires.from.iter().any(|f| split_port(f).is_some_and(|(n, _)| n == instance)) {
                    let wires = Some(lead(wires));
                    all.push(Operation::PutWires { node: id.clone(), port: port.to_string(), wires });
                }
            }
        }
        for (name, output) in &self.outputs {
            let port = source(&output.port);
            if port != output.port {
                let output = Some(InterfaceOutput { port, ..output.clone() });
                all.push(Operation::SetOutput { name: name.clone(), output });
            }
        }
        for (name, input) in &self.inputs {
            let ports = input.ports.iter().flat_map(|p| match split_port(p) {
                Some((id, port)) if id == instance => {
                    inputs.get(port).into_iter().flat_map(|i| &i.ports).filter_map(there).collect()
                }
                _ => vec![p.clone()],
            });
            let ports: Vec<String> = ports.collect();
            if ports != input.ports {
                let input = Some(InterfaceInput { ports, ..input.clone() });
                all.push(Operation::SetInput { name: name.clone(), input });
            }
        }
        self.regroup(instance, &ids, &mut all);
        all.push(Operation::PutNode { id: instance.into(), node: None });
        Ok(Paste { operation: Operation::All(all), ids })
    }

    /// The operation that takes a linked cluster into this file, with the clusters that it needs. O(linked file).
    ///
    /// # Errors
    /// If it is no linked cluster, or its file has not been read.
    pub fn embed(&self, name: &str, registry: &Registry) -> Result<Operation, Diagnostic> {
        let Some(Cluster::File(link)) = self.clusters.get(name) else {
            return Err(Diagnostic::error("unknown-cluster", format!("no linked cluster is called \"{name}\"")));
        };
        let mut body = self.unlinked(link, registry)?;
        let mut all = self.bring(&mut body, &mut Names::default());
        body.clusters.clear();
        body.extra.retain(|key, _| !super::cluster::CLUSTER_KEYS.contains(&key.as_str()));
        let cluster = Some(Box::new(Cluster::Here(Box::new(body))));
        all.push(Operation::SetCluster { name: name.into(), cluster });
        Ok(Operation::All(all))
    }

    /// What a link leads to, as it would stand in this file: paths in it as seen from here.
    fn unlinked(&self, link: &Link, registry: &Registry) -> Result<Self, Diagnostic> {
        let path = join("", &link.file);
        let Some(Ok(file)) = self.linked.0.get(&path) else {
            let message = format!("{path} has not been read");
            return Err(Diagnostic::error("linked-file", message).hint("read the graph's links first"));
        };
        let mut document = file.document.clone();
        let folder = folder_of(&path);
        if folder.is_empty() {
            return Ok(document);
        }
        from_folder(&mut document, folder, registry);
        for cluster in document.clusters.values_mut() {
            match cluster {
                Cluster::Here(body) => from_folder(body, folder, registry),
                Cluster::File(link) => link.file = join(folder, &link.file),
            }
        }
        Ok(document)
    }

    /// How far the fragment has to be moved to stand where the instance stood.
    fn beside(&self, instance: &str, fragment: &Self) -> [f64; 2] {
        let (Some(to), false) = (self.position(instance), fragment.layout.positions.is_empty()) else {
            return [0.0; 2];
        };
        let count = fragment.layout.positions.len() as f64;
        let mean = |i: usize| fragment.layout.positions.values().map(|p| p[i]).sum::<f64>() / count;
        [to[0] - mean(0), to[1] - mean(1)]
    }

    /// Groups of the instance become groups of its nodes.
    fn regroup(&self, instance: &str, ids: &BTreeMap<String, String>, all: &mut Vec<Operation>) {
        for (name, group) in &self.groups {
            let Some(members) = group.get("nodes").and_then(Json::as_array) else { continue };
            if !members.iter().any(|m| m.as_str() == Some(instance)) {
                continue;
            }
            let left = members.iter().filter(|m| m.as_str() != Some(instance)).cloned();
            let mut group = group.clone();
            group["nodes"] = left.chain(ids.values().map(|id| Json::from(id.as_str()))).collect();
            all.push(Operation::SetEntry { table: Table::Groups, key: name.clone(), value: Some(group) });
        }
    }

    /// Makes room in a fragment's names for its clusters and gives the operations that add those which are not here
    /// already. A cluster whose name is taken by another, or that uses one such, gets the next free name.
    pub(super) fn bring(&self, fragment: &mut Self, names: &mut Names) -> Vec<Operation> {
        let differs = |name: &String, cluster: &Cluster| self.clusters.get(name).is_some_and(|own| own != cluster);
        let mut renamed: BTreeSet<String> =
            fragment.clusters.iter().filter(|(n, c)| differs(n, c)).map(|(n, _)| n.clone()).collect();
        let mut grows = !renamed.is_empty();
        while grows {
            let uses = |cluster: &Cluster| match cluster {
                Cluster::Here(body) => body.nodes.values().filter_map(Node::cluster).any(|n| renamed.contains(n)),
                Cluster::File(_) => false,
            };
            let taken = |name: &String| self.clusters.contains_key(name) && !renamed.contains(name);
            let more: Vec<String> =
                fragment.clusters.iter().filter(|(n, c)| taken(n) && uses(c)).map(|(n, _)| n.clone()).collect();
            grows = !more.is_empty();
            renamed.extend(more);
        }
        let mut to = BTreeMap::new();
        for name in renamed {
            let taken = |n: &str| self.clusters.contains_key(n) || fragment.clusters.contains_key(n);
            let free = names.next(&name, taken);
            to.insert(name, free);
        }
        rename(&mut fragment.nodes, &to);
        let mut all = Vec::new();
        for (name, cluster) in &mut fragment.clusters {
            if let Cluster::Here(body) = cluster {
                rename(&mut body.nodes, &to);
            }
            let key = to.get(name).unwrap_or(name);
            if !self.clusters.contains_key(key) {
                let cluster = Some(Box::new(cluster.clone()));
                all.push(Operation::SetCluster { name: key.clone(), cluster });
            }
        }
        all
    }
}

fn rename(nodes: &mut BTreeMap<String, Node>, to: &BTreeMap<String, String>) {
    for node in nodes.values_mut() {
        if let Some(name) = node.cluster().and_then(|name| to.get(name)) {
            node.type_name = Node::instance(name).type_name;
            node.forget_source();
        }
    }
}

/// Literals of file ports as seen from the folder above.
fn from_folder(document: &mut Document, folder: &str, registry: &Registry) {
    for node in document.nodes.values_mut() {
        let Some(t) = registry.get(&node.type_name) else { continue };
        for port in t.inputs.iter().filter(|p| p.file) {
            let Some(literal) = node.params.get_mut(port.name()) else { continue };
            let one = |path: &Json| path.as_str().map_or_else(|| path.clone(), |path| join(folder, path).into());
            let new: Json = match literal.to_json() {
                Json::Array(paths) => paths.iter().map(one).collect(),
                path => one(&path),
            };
            *literal = new.into();
            node.forget_source();
        }
    }
}

/// Writes the formulas of a node inside an instance so that they mean the same outside of it.
fn write_out(document: &Document, plan: &Plan, instance: &str, id: &str, node: &mut Node) -> Result<(), Diagnostic> {
    let ports: Vec<Name> = node.params.keys().cloned().collect();
    for port in ports {
        let Some(json) = node.params.get(&port).map(Literal::json) else { continue };
        let Ok((n, p)) = plan.find_input(&format!("{instance}/{id}.{port}")) else { continue };
        let Some(t) = plan.node_type(n) else { continue };
        // What the instance or a wire overrules goes as it is.
        if t.inputs[p].names_in(&json).is_empty() || !plan.is_formula_of(n, p, instance) {
            continue;
        }
        let wrong = |why: String| {
            let message = format!("a formula inside cannot be written for the graph outside: {why}");
            Diagnostic::error("formula-in-cluster", message).at(format!("{instance}/{id}")).port(port.as_str())
        };
        let write = |text: &str| -> Result<String, Diagnostic> {
            let formula = Expression::parse(text).map_err(|e| wrong(e.to_string()))?;
            let written = formula.written_with(text, &|name| plan.input_text(document, instance, name));
            written.map_err(wrong)
        };
        let new: Json = match &*json {
            Json::String(text) => Json::from(write(text)?),
            Json::Array(items) => items
                .iter()
                .map(|item| item.as_str().map_or_else(|| Ok(item.clone()), |text| write(text).map(Json::from)))
                .collect::<Result<Vec<Json>, _>>()?
                .into(),
            _ => continue,
        };
        let before = plan.value_at(n, p);
        let after = plan.literal(document, n, p, &new).map_err(|fail| wrong(fail.to_string()))?;
        if before.is_none_or(|tree| tree.digest() != after.digest()) {
            return Err(wrong(format!("{new} is not the same number")));
        }
        node.params.insert(port, new);
        node.forget_source();
    }
    Ok(())
}
