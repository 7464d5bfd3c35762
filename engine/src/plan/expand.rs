//! Clusters expanded: every instance replaced by the nodes of its definition, each under the path `instance/node`, so that
//! the plan is flat and instances share caches, order and threads like any other nodes.

use super::Plan;
use super::define::{DEEPEST, Definitions, Interface, MOST_NODES, MOST_TEXT, Size};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::literal::Literal;
use crate::document::model::{Document, Node, NodeState, Wires, split_port};
use std::borrow::Cow;
use std::collections::HashMap;
use std::sync::Arc;

/// The root's scope.
pub(crate) const ROOT: u32 = 0;

/// A node as the plan sees it.
pub(super) struct FlatNode<'a> {
    /// Its id with those of all instances around it.
    pub path: Cow<'a, str>,
    pub id: &'a str,
    pub node: &'a Node,
    /// The instance that it stands in.
    pub scope: u32,
    pub state: NodeState,
    /// Why an instance could not be expanded.
    pub problem: Option<Box<Diagnostic>>,
}

/// An instance that was expanded, or the root.
pub(super) struct Scope<'a> {
    /// Of the instance, with a slash at its end; empty for the root.
    pub path: String,
    definition: usize,
    parent: u32,
    /// Its id in the parent, and its node there.
    instance: Option<(&'a str, &'a Node)>,
    state: NodeState,
}

/// A value that comes to a port, with the scope in which it was written.
#[derive(Clone, Copy)]
pub(super) enum Given<'a> {
    Wires(&'a Wires, u32),
    Literal(&'a Literal, u32),
}

/// A document with all of its clusters expanded.
pub(super) struct Flat<'a> {
    /// By path.
    pub nodes: Vec<FlatNode<'a>>,
    pub scopes: Vec<Scope<'a>>,
    /// Scopes by the scope around them and the instance's id.
    inner: HashMap<(u32, &'a str), u32>,
    definitions: Definitions<'a>,
}

/// What the plan keeps of an instance.
#[derive(Debug)]
pub(crate) struct Instance {
    /// Levels of instances around it and itself.
    pub depth: u32,
    pub interface: Arc<Interface>,
}

impl<'a> Flat<'a> {
    /// O(n log n) in the number of nodes after expansion; O(n) without clusters.
    pub fn expand(document: &'a Document) -> Self {
        let mut definitions = Definitions::find(document);
        refuse_too_much(&mut definitions);
        let root = Scope { path: String::new(), definition: 0, parent: ROOT, instance: None, state: NodeState::On };
        let mut flat = Self { nodes: Vec::new(), scopes: vec![root], inner: HashMap::new(), definitions };
        flat.nodes.reserve_exact(document.nodes.len());
        let mut next = 0;
        while next < flat.scopes.len() {
            flat.open(next as u32);
            next += 1;
        }
        if flat.scopes.len() > 1 {
            flat.nodes.sort_unstable_by(|a, b| a.path.cmp(&b.path));
        }
        flat
    }

    /// Places the nodes of a scope, and a scope for each instance among them.
    fn open(&mut self, s: u32) {
        let scope = &self.scopes[s as usize];
        let (state, prefix) = (scope.state, scope.path.clone());
        let definition = &self.definitions.all[scope.definition];
        for (id, node) in &definition.body.nodes {
            let path = if prefix.is_empty() { Cow::Borrowed(id.as_str()) } else { Cow::Owned(format!("{prefix}{id}")) };
            let state = node.state.within(state);
            let problem = match definition.instances.get(id.as_str()) {
                Some(Ok(inner)) => {
                    self.inner.insert((s, id), self.scopes.len() as u32);
                    let path = format!("{path}/");
                    let instance = Some((id.as_str(), node));
                    self.scopes.push(Scope { path, definition: *inner, parent: s, instance, state });
                    continue;
                }
                Some(Err(problem)) => {
                    let mut problem = problem.clone();
                    problem.node = Some((*path).into());
                    Some(problem)
                }
                None => None,
            };
            self.nodes.push(FlatNode { path, id, node, scope: s, state, problem });
        }
    }

    /// The path of what is called `name` in a scope.
    pub fn path(&self, scope: u32, name: &'a str) -> Cow<'a, str> {
        let prefix = &self.scopes[scope as usize].path;
        if prefix.is_empty() { Cow::Borrowed(name) } else { Cow::Owned(format!("{prefix}{name}")) }
    }

    /// The ranges that the interfaces around a node give its ports beyond the ports' own.
    pub fn ranges(&self, at: &FlatNode<'a>) -> Vec<(&'a str, f64, f64)> {
        let mut all = Vec::new();
        for (port, input) in self.bound(at.scope, at.id) {
            let (mut min, mut max) = (f64::NEG_INFINITY, f64::INFINITY);
            let (mut scope, mut input) = (at.scope, *input);
            while let Some((id, _)) = self.scopes[scope as usize].instance {
                let definition = &self.definitions.all[self.scopes[scope as usize].definition];
                if let Some(said) = definition.body.inputs.get(input) {
                    (min, max) = (said.min.map_or(min, |v| v.max(min)), said.max.map_or(max, |v| v.min(max)));
                }
                scope = self.scopes[scope as usize].parent;
                match self.bound(scope, id).iter().find(|(p, _)| *p == input) {
                    Some((_, outer)) => input = outer,
                    None => break,
                }
            }
            if min > f64::NEG_INFINITY || max < f64::INFINITY {
                all.push((*port, min, max));
            }
        }
        all
    }

    pub fn folder(&self, scope: u32) -> &str {
        &self.definitions.all[self.scopes[scope as usize].definition].folder
    }

    /// What comes to a node's ports: what the node says itself, or, at ports that are inputs of the cluster around it, what
    /// its instance says. The outermost value wins; a wire inside a cluster wins over everything outside.
    pub fn given(&self, at: &FlatNode<'a>) -> Vec<(&'a str, Given<'a>)> {
        let wires = at.node.inputs.iter().map(|(port, w)| (port.as_str(), Given::Wires(w, at.scope)));
        let literals = at.node.params.iter().map(|(port, json)| (port.as_str(), Given::Literal(json, at.scope)));
        // Wires last: a wire overrules a literal.
        let mut all: Vec<(&str, Given)> = literals.chain(wires).collect();
        for (port, input) in self.bound(at.scope, at.id) {
            if let Some(given) = self.outer_value(at.scope, input) {
                all.retain(|(p, _)| *p != *port);
                all.push((port, given));
            }
        }
        all
    }

    fn bound(&self, scope: u32, id: &str) -> &[(&'a str, &'a str)] {
        let definition = &self.definitions.all[self.scopes[scope as usize].definition];
        definition.bound.get(id).map_or(&[], Vec::as_slice)
    }

    /// What instances say of an input of the scope's cluster, the outermost first.
    fn outer_value(&self, mut scope: u32, mut input: &'a str) -> Option<Given<'a>> {
        let mut found = None;
        // Up through the instances; at most as many as clusters nest.
        while let Some((id, node)) = self.scopes[scope as usize].instance {
            scope = self.scopes[scope as usize].parent;
            if let Some(wires) = node.inputs.get(input) {
                return Some(Given::Wires(wires, scope));
            }
            found = node.params.get(input).map(|json| Given::Literal(json, scope)).or(found);
            match self.bound(scope, id).iter().find(|(port, _)| *port == input) {
                Some((_, outer)) => input = outer,
                None => break,
            }
        }
        found
    }

    /// The `path.port` of the plan's node that `address` means in a scope: through the outputs of instances.
    pub fn source(&self, mut scope: u32, address: &'a str) -> Result<(Cow<'a, str>, &'a str), Diagnostic> {
        let mut address = address;
        loop {
            let (id, port) = split_port(address).unwrap_or((address, ""));
            let Some(inner) = self.inner.get(&(scope, id)) else {
                let path = self.path(scope, id);
                return Ok((path, port));
            };
            scope = *inner;
            let definition = &self.definitions.all[self.scopes[scope as usize].definition];
            match definition.body.outputs.get(port) {
                Some(output) => address = &output.port,
                None => return Err(no_output(&definition.interface, port)),
            }
        }
    }

    /// What is to be kept of the expansion when the plan is made, and the faults of definitions.
    pub fn finish(self, plan: &mut Plan) {
        let mut depths = vec![0u32];
        for scope in self.scopes.iter().skip(1) {
            let depth = depths[scope.parent as usize] + 1;
            depths.push(depth);
            let interface = self.definitions.all[scope.definition].interface.clone();
            plan.instances.insert(scope.path.trim_end_matches('/').into(), Instance { depth, interface });
        }
        plan.general.extend(self.definitions.faults);
    }
}

pub(super) fn no_output(interface: &Interface, port: &str) -> Diagnostic {
    let hint = did_you_mean(port, interface.outputs.keys().map(String::as_str));
    let message = format!("cluster \"{}\" has no output \"{port}\"", interface.name);
    Diagnostic::error("unknown-port", message).maybe_hint(hint)
}

/// Instances of the root that would make more than a plan can hold stay unexpanded and say so.
fn refuse_too_much(definitions: &mut Definitions<'_>) {
    let sizes: Vec<Size> = definitions.all.iter().map(|d| d.size).collect();
    let root = &mut definitions.all[0];
    let (mut nodes, mut text) = (0u64, 0u64);
    for (id, meaning) in &mut root.instances {
        let Ok(inner) = meaning else { continue };
        let size = sizes[*inner];
        let own = size.text.saturating_add(size.nodes.saturating_mul(id.len() as u64 + 1));
        let refused = if size.depth >= DEEPEST {
            let message = format!("clusters nest {} levels deep here, at most {DEEPEST} are allowed", size.depth + 1);
            Diagnostic::error("clusters-too-deep", message)
        } else if nodes.saturating_add(size.nodes) > MOST_NODES {
            let message = format!("with this instance, clusters come to more than {MOST_NODES} nodes");
            Diagnostic::error("too-many-nodes", message)
        } else if text.saturating_add(own) > MOST_TEXT {
            let message = format!("with this instance, paths of nodes come to more than {} MiB", MOST_TEXT >> 20);
            Diagnostic::error("too-many-nodes", message)
        } else {
            nodes += size.nodes;
            text += own;
            continue;
        };
        *meaning = Err(Box::new(refused));
    }
}
