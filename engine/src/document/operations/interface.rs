//! Giving inputs and outputs of an interface other names: formulas over them follow, and so do the instances of a cluster.

use super::super::cluster::Cluster;
use super::super::fields::Name;
use super::super::model::{Document, InterfaceInput, Node, Wires};
use super::Operation;
use crate::diagnostic::Diagnostic;
use crate::expression::Expression;
use crate::registry::Registry;
use crate::value::Json;

impl Document {
    /// The operation that gives an input of this graph's interface, or of that of a cluster in this file, another name.
    /// Formulas that name it and instances of the cluster follow, so results stay the same. O(document).
    ///
    /// # Errors
    /// If there is no such input, or the name is taken or empty.
    pub fn rename_input(
        &self,
        cluster: Option<&str>,
        from: &str,
        to: &str,
        registry: &Registry,
    ) -> Result<Operation, Diagnostic> {
        let body = self.body(cluster)?;
        let Some(input) = body.inputs.get(from) else { return Err(unknown("input", from)) };
        check_name("input", to, body.inputs.contains_key(to))?;
        let put = |name: &str, input| Operation::SetInput { name: name.to_owned(), input };
        let mut all = vec![put(from, None), put(to, Some(input.clone()))];
        // Ports are looked up where clusters are known.
        let scope = cluster.and_then(|name| self.alone(name));
        for (id, node) in &body.nodes {
            for (port, literal) in &node.params {
                let address = format!("{id}.{port}");
                let known =
                    scope.as_ref().unwrap_or(self).input_port(registry, &address).map(|p| p.names_in(&literal.json()));
                if known.is_some_and(|names| names.iter().any(|name| name == from)) {
                    let (node, port) = (id.clone(), port.to_string());
                    all.push(Operation::SetParam { node, port, value: Some(renamed(&literal.json(), from, to)) });
                }
            }
        }
        let all = within(cluster, Operation::All(all));
        let follow = |node: &Node| {
            let mut new = node.clone();
            if let Some(value) = new.params.remove(from) {
                new.params.insert(to, value);
            }
            if let Some(wires) = new.inputs.remove(from) {
                new.inputs.insert(to, wires);
            }
            new
        };
        let mut all = vec![all];
        all.extend(self.instances_follow(cluster, follow, |wires, _| wires.clone()));
        // Inputs of graphs around it that lead to its instances.
        for (name, body) in self.all_bodies() {
            for (key, input) in &body.inputs {
                let of_cluster =
                    |id: &str| body.nodes.get(id).and_then(Node::cluster).is_some_and(|c| Some(c) == cluster);
                let lead = |address: &String| match address.split_once('.') {
                    Some((id, port)) if port == from && of_cluster(id) => format!("{id}.{to}"),
                    _ => address.clone(),
                };
                let ports: Vec<String> = input.ports.iter().map(lead).collect();
                if ports != input.ports {
                    let input = Some(InterfaceInput { ports, ..input.clone() });
                    all.push(within(name, Operation::SetInput { name: key.clone(), input }));
                }
            }
        }
        Ok(Operation::All(all))
    }

    /// The operation that gives an output another name; wires from instances of the cluster follow. O(document).
    ///
    /// # Errors
    /// If there is no such output, or the name is taken or empty.
    pub fn rename_output(&self, cluster: Option<&str>, from: &str, to: &str) -> Result<Operation, Diagnostic> {
        let body = self.body(cluster)?;
        let Some(output) = body.outputs.get(from) else { return Err(unknown("output", from)) };
        check_name("output", to, body.outputs.contains_key(to))?;
        let put = |name: &str, output| Operation::SetOutput { name: name.to_owned(), output };
        let all = within(cluster, Operation::All(vec![put(from, None), put(to, Some(output.clone()))]));
        let led = |wires: &Wires, is_instance: &dyn Fn(&str) -> bool| {
            let from = wires.from.iter().map(|address| match address.split_once('.') {
                Some((id, port)) if port == from && is_instance(id) => Name::from(format!("{id}.{to}")),
                _ => address.clone(),
            });
            Wires { from: from.collect(), more: wires.more.clone() }
        };
        let mut all = vec![all];
        all.extend(self.instances_follow(cluster, Node::clone, led));
        // Outputs of graphs around it that show what it gives.
        for (name, body) in self.all_bodies() {
            for (key, output) in &body.outputs {
                let Some((id, port)) = output.port.split_once('.') else { continue };
                let of_cluster = body.nodes.get(id).and_then(Node::cluster).is_some_and(|c| Some(c) == cluster);
                if of_cluster && port == from {
                    let mut output = output.clone();
                    output.port = format!("{id}.{to}");
                    all.push(within(name, Operation::SetOutput { name: key.clone(), output: Some(output) }));
                }
            }
        }
        Ok(Operation::All(all))
    }

    fn body(&self, cluster: Option<&str>) -> Result<&Self, Diagnostic> {
        match cluster.map(|name| (name, self.clusters.get(name))) {
            None => Ok(self),
            Some((_, Some(Cluster::Here(body)))) => Ok(body),
            Some((name, _)) => {
                Err(Diagnostic::error("unknown-cluster", format!("no cluster \"{name}\" stands in this file")))
            }
        }
    }

    /// The graph and all definitions of this file, with their names.
    fn all_bodies(&self) -> impl Iterator<Item = (Option<&str>, &Self)> {
        let inside = self.clusters.iter().filter_map(|(name, cluster)| match cluster {
            Cluster::Here(body) => Some((Some(name.as_str()), &**body)),
            Cluster::File(_) => None,
        });
        std::iter::once((None, self)).chain(inside)
    }

    /// Instances of a cluster as `follow` makes them, and all wires as `led` leads them, where that changes something.
    fn instances_follow(
        &self,
        cluster: Option<&str>,
        follow: impl Fn(&Node) -> Node,
        led: impl Fn(&Wires, &dyn Fn(&str) -> bool) -> Wires,
    ) -> Vec<Operation> {
        let Some(cluster) = cluster else { return Vec::new() };
        let mut all = Vec::new();
        for (name, body) in self.all_bodies() {
            let is_instance = |id: &str| body.nodes.get(id).and_then(Node::cluster) == Some(cluster);
            for (id, node) in &body.nodes {
                let mut new = if is_instance(id) { follow(node) } else { node.clone() };
                let wires: Vec<(Name, Wires)> =
                    new.inputs.iter().map(|(port, wires)| (port.clone(), led(wires, &is_instance))).collect();
                for (port, wires) in wires {
                    new.inputs.insert(port, wires);
                }
                if new != *node {
                    new.forget_source();
                    all.push(within(name, Operation::PutNode { id: id.clone(), node: Some(Box::new(new)) }));
                }
            }
        }
        all
    }
}

fn within(cluster: Option<&str>, operation: Operation) -> Operation {
    match cluster {
        Some(name) => operation.inside(name),
        None => operation,
    }
}

fn unknown(what: &str, name: &str) -> Diagnostic {
    Diagnostic::error("unknown-name", format!("there is no {what} \"{name}\""))
}

fn check_name(what: &str, name: &str, taken: bool) -> Result<(), Diagnostic> {
    if taken {
        return Err(Diagnostic::error("taken-id", format!("there is already an {what} \"{name}\"")));
    }
    if name.is_empty() || name.contains('.') {
        let message = format!("\"{name}\" cannot be the name of an {what}: it is empty or has a dot in it");
        return Err(Diagnostic::error("bad-id", message));
    }
    Ok(())
}

/// A literal with formulas that say `to` where they said `from`.
fn renamed(json: &Json, from: &str, to: &str) -> Json {
    let plain = Expression::parse(to).is_ok_and(|e| e.names() == [to]);
    let written = if plain { to.to_owned() } else { format!("'{to}'") };
    let one = |text: &str| {
        let formula = Expression::parse(text).ok()?;
        let name = |name: &str| {
            let own = || Expression::parse(name).is_ok_and(|e| e.names() == [name]);
            Ok(if name == from {
                written.clone()
            } else if own() {
                name.to_owned()
            } else {
                format!("'{name}'")
            })
        };
        formula.written_with(text, &name).ok()
    };
    match json {
        Json::String(text) => one(text).map_or_else(|| json.clone(), Json::from),
        Json::Array(items) => items.iter().map(|item| renamed(item, from, to)).collect(),
        other => other.clone(),
    }
}
