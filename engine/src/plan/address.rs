//! What addresses (`node.port`) mean in a plan, through instances of clusters: `facade.thickness` is an input of the instance
//! `facade`, `facade/thicken.panels` an output inside of it.

use super::Plan;
use super::expand::no_output;
use crate::diagnostic::{Diagnostic, Severity, did_you_mean};
use crate::document::cluster::PREFIX;
use crate::document::model::{Document, split_port};
use crate::port::Port;
use crate::registry::NodeType;
use smallvec::SmallVec;
use std::borrow::Cow;
use std::collections::{BTreeSet, HashSet};
use std::sync::Arc;

/// Nodes and port indices; most addresses lead to one.
pub(crate) type Places = SmallVec<[(usize, usize); 1]>;

impl Plan {
    pub(super) fn check_interface(&mut self, document: &Document) {
        for (name, input) in &document.inputs {
            for address in &input.ports {
                match self.find_inputs(address) {
                    Err(diagnostic) => self.general.push(in_interface("input", name, diagnostic)),
                    Ok(places) if places.iter().any(|(n, p)| self.slot(*n, *p).is_wired()) => {
                        let message = format!("interface input \"{name}\" is bound to {address}, which has a wire");
                        self.general.push(Diagnostic::error("wired-input", message));
                    }
                    Ok(_) => {}
                }
            }
        }
        for (name, output) in &document.outputs {
            if let Err(diagnostic) = self.find_output(&output.port) {
                self.general.push(in_interface("output", name, diagnostic));
            }
        }
        self.check_clusters();
    }

    /// Every definition once, at its first instance.
    fn check_clusters(&mut self) {
        let mut seen = BTreeSet::new();
        let mut faults = Vec::new();
        for (path, instance) in &self.instances {
            if !seen.insert(Arc::as_ptr(&instance.interface)) {
                continue;
            }
            let ports = instance.interface.inputs.iter().flat_map(|(name, i)| i.ports.iter().map(move |p| (name, p)));
            for (name, port) in ports {
                faults.extend(self.find_inputs(&format!("{path}/{port}")).err().map(|d| ("input", path, name, d)));
            }
            for (name, output) in &instance.interface.outputs {
                let found = self.find_output(&format!("{path}/{}", output.port));
                faults.extend(found.err().map(|d| ("output", path, name, d)));
            }
        }
        // A node of an unknown type, or an instance that could not be expanded, says so itself.
        faults.retain(|(.., fault)| !fault.node.as_deref().is_some_and(|id| self.is_strange(id)));
        let told = faults.into_iter().map(|(kind, path, name, fault)| {
            let fault = in_interface(kind, name, fault);
            if fault.node.is_none() { fault.at(&**path) } else { fault }
        });
        self.general.extend(told.collect::<Vec<_>>());
    }

    /// The node of that id or path. O(log n).
    pub fn find(&self, id: &str) -> Option<usize> {
        self.ids.find(id)
    }

    /// True if the node of that path is of an unknown type.
    fn is_strange(&self, path: &str) -> bool {
        self.find(path).is_some_and(|n| self.node_type(n).is_none())
    }

    /// True if there are clusters in the graph that are in use.
    pub fn has_instances(&self) -> bool {
        !self.instances.is_empty()
    }

    /// True if an instance of a cluster has that path.
    pub fn is_instance(&self, path: &str) -> bool {
        self.instances.contains_key(path)
    }

    fn find_node<'a>(&self, address: &'a str) -> Result<(usize, &Arc<NodeType>, &'a str), Diagnostic> {
        let Some((id, port)) = split_port(address) else {
            let message = format!("\"{address}\" is not of the form node.port");
            return Err(Diagnostic::error("bad-address", message));
        };
        let Some(n) = self.find(id) else {
            let instances = self.instances.keys().take(10_000).map(|i| &**i);
            let hint = did_you_mean(id, self.ids.iter().take(10_000).chain(instances));
            return Err(Diagnostic::error("unknown-name", format!("there is no node \"{id}\"")).maybe_hint(hint));
        };
        let Some(t) = self.node_type(n) else {
            if let Some(why) = self.errors(n).find(|d| d.code != "unknown-node") {
                return Err(why.clone());
            }
            let message = format!("the type of node \"{id}\" is not known");
            let hint = self.errors(n).find_map(|d| d.hint.as_deref()).map(str::to_owned);
            return Err(Diagnostic::error("unknown-node", message).at(id).maybe_hint(hint));
        };
        Ok((n, t, port))
    }

    /// Nodes and port indices of `node.port` as an input: one, or those that an input of an instance leads to, which may be
    /// none. O(places × log nodes).
    pub fn find_inputs(&self, address: &str) -> Result<Places, Diagnostic> {
        let mut places = Places::new();
        if !self.has_instances() {
            places.push(self.find_own_input(address)?);
            return Ok(places);
        }
        let mut open = vec![address.to_owned()];
        // Inputs of a faulty cluster may lead to one port by many ways.
        let mut seen = HashSet::new();
        while let Some(address) = open.pop() {
            if let Some((id, port)) = split_port(&address)
                && let Some(instance) = self.instances.get(id)
            {
                let Some(input) = instance.interface.inputs.get(port) else {
                    let hint = did_you_mean(port, instance.interface.inputs.keys().map(String::as_str));
                    let message = format!("cluster \"{}\" has no input \"{port}\"", instance.interface.name);
                    let fault = Diagnostic::error("unknown-port", message).at(id).port(port);
                    return Err(fault.maybe_hint(hint));
                };
                let inner = input.ports.iter().rev().map(|p| format!("{id}/{p}"));
                open.extend(inner.filter(|p| seen.insert(p.clone())));
                continue;
            }
            places.push(self.find_own_input(&address)?);
        }
        Ok(places)
    }

    /// As [`Plan::find_inputs`], of a node that is no instance.
    fn find_own_input(&self, address: &str) -> Result<(usize, usize), Diagnostic> {
        let (n, t, port) = self.find_node(address)?;
        let p = t.input_index(port).ok_or_else(|| {
            let hint = did_you_mean(port, t.inputs.iter().map(Port::name));
            let message = format!("\"{}\" has no input \"{port}\"", t.type_name);
            Diagnostic::error("unknown-port", message).at(&self.ids[n]).port(port).maybe_hint(hint)
        })?;
        Ok((n, p))
    }

    /// The first of [`Plan::find_inputs`].
    pub fn find_input(&self, address: &str) -> Result<(usize, usize), Diagnostic> {
        let first = self.find_inputs(address)?.into_iter().next();
        first.ok_or_else(|| Diagnostic::error("unknown-port", format!("{address} leads nowhere")))
    }

    /// Node and port index of `node.port` as an output, through outputs of instances.
    pub fn find_output(&self, address: &str) -> Result<(usize, usize), Diagnostic> {
        let mut address = Cow::Borrowed(address);
        // An output of an instance lies one level further inside, so this ends.
        while let Some((id, port)) = split_port(&address)
            && let Some(instance) = self.instances.get(id)
        {
            match instance.interface.outputs.get(port) {
                Some(output) => address = Cow::Owned(format!("{id}/{}", output.port)),
                None => return Err(no_output(&instance.interface, port).at(id).port(port)),
            }
        }
        let (n, t, port) = self.find_node(&address)?;
        let o = t.output_index(port).ok_or_else(|| {
            let hint = did_you_mean(port, t.outputs.iter().map(Port::name));
            let message = format!("\"{}\" has no output \"{port}\"", t.type_name);
            Diagnostic::error("unknown-port", message).at(&self.ids[n]).port(port).maybe_hint(hint)
        })?;
        Ok((n, o))
    }

    /// `node.port` of every output of every instance.
    pub fn instance_outputs(&self) -> impl Iterator<Item = String> {
        let all = self.instances.iter();
        all.flat_map(|(path, instance)| instance.interface.outputs.keys().map(move |port| format!("{path}.{port}")))
    }

    /// The instance around a path and what is left of it: the innermost.
    pub fn around<'a>(&self, path: &'a str) -> Option<(&'a str, &'a str)> {
        let mut slashes = path.rmatch_indices('/').map(|(at, _)| (&path[..at], &path[at + 1..]));
        slashes.find(|(outer, _)| self.instances.contains_key(*outer))
    }

    /// The outermost input of an instance that leads to this port.
    pub fn entrance(&self, path: &str, port: &str) -> Option<String> {
        let (mut path, mut port, mut found) = (path, port.to_owned(), None);
        while let Some((outer, inner)) = self.around(path) {
            let address = format!("{inner}.{port}");
            let interface = &self.instances.get(outer)?.interface;
            let Some((name, _)) = interface.inputs.iter().find(|(_, i)| i.ports.contains(&address)) else { break };
            found = Some(format!("{outer}.{name}"));
            (path, port) = (outer, name.clone());
        }
        found
    }

    /// The nodes in all instances that an error of a definition (`cluster:NAME/node`) is about.
    pub(super) fn in_instances(&self, diagnostic: &Diagnostic) -> Vec<usize> {
        let node = diagnostic.node.as_deref().filter(|_| diagnostic.severity == Severity::Error);
        let place = node.and_then(|node| node.strip_prefix(PREFIX));
        let Some(place) = place else { return Vec::new() };
        let inside = |(path, instance): (&Arc<str>, &super::Instance)| {
            let id = place.strip_prefix(&*instance.interface.name)?.strip_prefix('/')?;
            self.find(&format!("{path}/{id}"))
        };
        self.instances.iter().filter_map(inside).collect()
    }
}

fn in_interface(kind: &str, name: &str, mut diagnostic: Diagnostic) -> Diagnostic {
    diagnostic.message = format!("interface {kind} \"{name}\": {}", diagnostic.message);
    diagnostic
}
