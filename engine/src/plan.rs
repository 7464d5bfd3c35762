//! The plan: the document compiled to dense tables, so that evaluation follows numbers and never looks up a name.
//! Nodes are numbered in the order of their ids; slots, wires and successors lie in flat tables (CSR).

mod formula;
mod order;

use crate::diagnostic::{Diagnostic, Severity, did_you_mean};
use crate::document::model::{Document, NodeState, TreeOp, split_port};
use crate::evaluate::matching::Matching;
use crate::port::Port;
use crate::registry::{NodeType, Registry};
use crate::value::Tree;
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

/// No node type: the document names one that nobody knows.
pub(crate) const UNKNOWN: u32 = u32::MAX;

/// Where one input's value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slot {
    Missing,
    Default,
    Literal(u32),
    /// A range of `wires` and an index into `shapes`.
    Wires {
        from: u32,
        to: u32,
        shape: u32,
    },
}

pub(crate) struct PlanNode {
    pub node_type: u32,
    pub slots: u32,
    pub outputs: u32,
    pub output_count: u32,
    successors: u32,
    pub height: u32,
    pub matching: Matching,
    pub state: NodeState,
    pub has_files: bool,
    /// Some static error keeps it from running.
    sound: bool,
}

/// A document made ready to run.
pub(crate) struct Plan {
    pub ids: Vec<Arc<str>>,
    pub nodes: Vec<PlanNode>,
    pub types: Vec<Arc<NodeType>>,
    slots: Vec<Slot>,
    /// Output slot that each wire comes from.
    wires: Vec<u32>,
    /// Node that each output slot belongs to.
    pub output_node: Vec<u32>,
    pub literals: Vec<Tree>,
    /// Tree operations of inputs, each list once; 0 is none.
    shapes: Vec<Vec<TreeOp>>,
    successors: Vec<u32>,
    pub levels: usize,
    /// Errors and warnings of nodes; the port, if it is one parameter's fault that setting it would mend.
    errors: BTreeMap<u32, Vec<(Option<u32>, Diagnostic)>>,
    /// Parameters that are formulas, by node and port, with the names of the interface inputs in them.
    formulas: BTreeMap<(u32, u32), Vec<String>>,
    /// What concerns no single node.
    pub general: Vec<Diagnostic>,
}

impl Plan {
    /// O(nodes + ports + wires).
    pub fn compile(document: &Document, registry: &Registry) -> Self {
        let mut plan = Self {
            ids: document.nodes.keys().map(|id| Arc::from(id.as_str())).collect(),
            nodes: Vec::with_capacity(document.nodes.len()),
            types: Vec::new(),
            slots: Vec::new(),
            wires: Vec::new(),
            output_node: Vec::new(),
            literals: Vec::new(),
            shapes: vec![Vec::new()],
            successors: Vec::new(),
            levels: 0,
            errors: BTreeMap::new(),
            formulas: BTreeMap::new(),
            general: Vec::new(),
        };
        plan.place_nodes(document, registry);
        plan.connect(document, registry);
        plan.order();
        plan.compute_formulas(document);
        plan.check_interface(document);
        // They grew by doubling; a plan stays as it is for long.
        plan.slots.shrink_to_fit();
        plan.wires.shrink_to_fit();
        plan.output_node.shrink_to_fit();
        plan.literals.shrink_to_fit();
        plan
    }

    fn place_nodes(&mut self, document: &Document, registry: &Registry) {
        let mut known: HashMap<&str, u32> = HashMap::new();
        for (n, (id, node)) in document.nodes.iter().enumerate() {
            let node_type = match known.get(node.type_name.as_str()) {
                Some(t) => *t,
                None => {
                    let t = registry.get(&node.type_name).map_or(UNKNOWN, |t| {
                        self.types.push(t.clone());
                        self.types.len() as u32 - 1
                    });
                    known.insert(&node.type_name, t);
                    t
                }
            };
            let (slots, outputs) = (self.slots.len() as u32, self.output_node.len() as u32);
            let mut output_count = 0;
            if let Some(t) = self.types.get(node_type as usize).cloned() {
                output_count = t.outputs.len() as u32;
                self.slots.extend(t.defaults.iter().map(|d| if d.is_some() { Slot::Default } else { Slot::Missing }));
                self.output_node.extend((0..output_count).map(|_| n as u32));
                if node.version > t.version {
                    let message = format!(
                        "written for version {} of \"{}\"; this program has version {}",
                        node.version, node.type_name, t.version
                    );
                    self.error(n, None, Diagnostic::error("newer-node", message).at(id));
                } else if node.version < t.version {
                    let message = format!(
                        "written for version {} of \"{}\"; version {} may give other results",
                        node.version, node.type_name, t.version
                    );
                    self.error(
                        n,
                        None,
                        Diagnostic::error("older-node", message).with_severity(Severity::Warning).at(id),
                    );
                }
            } else {
                let hint = did_you_mean(&node.type_name, registry.iter().map(|t| &*t.type_name));
                let message = format!("no node type is called \"{}\"", node.type_name);
                self.error(n, None, Diagnostic::error("unknown-node", message).at(id).maybe_hint(hint));
            }
            let of_port = || node.inputs.values().find_map(|w| w.matching.filter(|m| *m != Matching::Longest));
            let has_files = self.types.get(node_type as usize).is_some_and(|t| t.inputs.iter().any(|p| p.file));
            self.nodes.push(PlanNode {
                node_type,
                slots,
                outputs,
                output_count,
                successors: 0,
                height: 0,
                matching: node.matching.or_else(of_port).unwrap_or_default(),
                state: node.state,
                has_files,
                sound: true,
            });
        }
        // Unknown nodes and nodes with errors so far are not sound; `error` could not yet mark the node under way.
        for (n, errors) in &self.errors {
            if errors.iter().any(|(_, d)| d.severity == Severity::Error) {
                self.nodes[*n as usize].sound = false;
            }
        }
    }

    fn connect(&mut self, document: &Document, registry: &Registry) {
        let mut shapes: HashMap<Vec<TreeOp>, u32> = HashMap::from([(Vec::new(), 0)]);
        for (n, (id, node)) in document.nodes.iter().enumerate() {
            let Some(t) = self.types.get(self.nodes[n].node_type as usize).cloned() else { continue };
            let base = self.nodes[n].slots;
            for (name, json) in &node.params {
                let Some(p) = t.input_index(name) else {
                    self.unknown_input(n, id, name, &t);
                    continue;
                };
                let names = t.inputs[p].names_in(json);
                if !names.is_empty() {
                    // Computed when every literal that it may name is in its place.
                    self.formulas.insert((n as u32, p as u32), names);
                    continue;
                }
                match t.inputs[p].literal(json) {
                    Ok(tree) => {
                        self.slots[base as usize + p] = Slot::Literal(self.literals.len() as u32);
                        self.literals.push(tree);
                    }
                    Err(fail) => self.error(n, Some(p as u32), fail.at(Severity::Error, id)),
                }
            }
            for (name, wires) in &node.inputs {
                let Some(p) = t.input_index(name) else {
                    self.unknown_input(n, id, name, &t);
                    continue;
                };
                let from = self.wires.len() as u32;
                let mut seen = HashSet::new();
                for source in &wires.from {
                    if wires.from.len() > 1 && !seen.insert(source) {
                        let message = format!("the wire from {source} comes in twice");
                        self.error(n, None, Diagnostic::error("duplicate-wire", message).at(id).port(name));
                        continue;
                    }
                    match self.source(source, registry, &t.inputs[p], id) {
                        Ok(slot) => self.wires.push(slot),
                        Err(Some(diagnostic)) => self.error(n, None, diagnostic.at(id).port(name)),
                        // The source is of an unknown type: it says so itself and blocks this node.
                        Err(None) => {
                            let message = format!("blocked: \"{source}\" is of an unknown type");
                            let diagnostic = Diagnostic::error("blocked", message).with_severity(Severity::Note);
                            self.error(n, None, diagnostic.at(id).port(name));
                            self.nodes[n].sound = false;
                        }
                    }
                }
                let to = self.wires.len() as u32;
                if to > from {
                    let next = shapes.len() as u32;
                    let shape = *shapes.entry(wires.tree.clone()).or_insert(next);
                    if shape == next {
                        self.shapes.push(wires.tree.clone());
                    }
                    self.slots[base as usize + p] = Slot::Wires { from, to, shape };
                    // The wire overrules the literal, so the literal's faults do not matter.
                    self.mend(n, p as u32);
                }
            }
        }
        self.find_successors();
    }

    fn unknown_input(&mut self, n: usize, id: &str, name: &str, t: &NodeType) {
        let hint = did_you_mean(name, t.inputs.iter().map(Port::name));
        let message = format!("\"{}\" has no input \"{name}\"", t.type_name);
        self.error(n, None, Diagnostic::error("unknown-port", message).at(id).port(name).maybe_hint(hint));
    }

    /// The output slot of `node.port`, if an input of this port can take it; `Err(None)`: its node is of an unknown type.
    fn source(&self, address: &str, registry: &Registry, port: &Port, id: &str) -> Result<u32, Option<Diagnostic>> {
        let (name, output) = split_port(address).unwrap_or((address, ""));
        let Some(n) = self.find(name) else {
            let hint = did_you_mean(name, self.ids.iter().take(10_000).map(|i| &**i));
            let message = format!("the wire comes from \"{address}\", but there is no node \"{name}\"");
            return Err(Some(Diagnostic::error("unknown-source", message).maybe_hint(hint)));
        };
        let Some(t) = self.node_type(n) else { return Err(None) };
        let Some(o) = t.output_index(output) else {
            let hint = did_you_mean(output, t.outputs.iter().map(Port::name));
            let message = format!("\"{}\" ({name}) has no output \"{output}\"", t.type_name);
            return Err(Some(Diagnostic::error("unknown-port", message).maybe_hint(hint)));
        };
        let (from, to) = (&t.outputs[o].item_type, &port.item_type);
        let converts = || from.id.zip(to.id).is_some_and(|(a, b)| registry.conversion(a, b).is_some());
        if !to.accepts(from) && !converts() {
            let message = format!("{address} gives {}, but {id}.{} takes {}", from.name, port.name, to.name);
            return Err(Some(Diagnostic::error("wrong-type", message)));
        }
        Ok(self.nodes[n].outputs + o as u32)
    }

    fn check_interface(&mut self, document: &Document) {
        for (name, input) in &document.inputs {
            for address in &input.ports {
                match self.find_input(address) {
                    Err(diagnostic) => self.general.push(in_interface("input", name, diagnostic)),
                    Ok((n, p)) if matches!(self.slot(n, p), Slot::Wires { .. }) => {
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
    }

    /// The node of that id. O(log n).
    pub fn find(&self, id: &str) -> Option<usize> {
        self.ids.binary_search_by(|i| (**i).cmp(id)).ok()
    }

    fn find_node(&self, address: &str) -> Result<(usize, &Arc<NodeType>, String), Diagnostic> {
        let Some((id, port)) = split_port(address) else {
            let message = format!("\"{address}\" is not of the form node.port");
            return Err(Diagnostic::error("bad-address", message));
        };
        let Some(n) = self.find(id) else {
            let hint = did_you_mean(id, self.ids.iter().take(10_000).map(|i| &**i));
            return Err(Diagnostic::error("unknown-name", format!("there is no node \"{id}\"")).maybe_hint(hint));
        };
        let Some(t) = self.node_type(n) else {
            let message = format!("the type of node \"{id}\" is not known");
            return Err(Diagnostic::error("unknown-node", message).at(id));
        };
        Ok((n, t, port.to_owned()))
    }

    /// Node and port index of `node.port` as an input.
    pub fn find_input(&self, address: &str) -> Result<(usize, usize), Diagnostic> {
        let (n, t, port) = self.find_node(address)?;
        let p = t.input_index(&port).ok_or_else(|| {
            let hint = did_you_mean(&port, t.inputs.iter().map(Port::name));
            let message = format!("\"{}\" has no input \"{port}\"", t.type_name);
            Diagnostic::error("unknown-port", message).at(&*self.ids[n]).port(port).maybe_hint(hint)
        })?;
        Ok((n, p))
    }

    /// Node and port index of `node.port` as an output.
    pub fn find_output(&self, address: &str) -> Result<(usize, usize), Diagnostic> {
        let (n, t, port) = self.find_node(address)?;
        let o = t.output_index(&port).ok_or_else(|| {
            let hint = did_you_mean(&port, t.outputs.iter().map(Port::name));
            let message = format!("\"{}\" has no output \"{port}\"", t.type_name);
            Diagnostic::error("unknown-port", message).at(&*self.ids[n]).port(port).maybe_hint(hint)
        })?;
        Ok((n, o))
    }

    pub fn node_type(&self, n: usize) -> Option<&Arc<NodeType>> {
        self.types.get(self.nodes[n].node_type as usize)
    }

    pub fn slot_count(&self, n: usize) -> usize {
        let end = self.nodes.get(n + 1).map_or(self.slots.len(), |next| next.slots as usize);
        end - self.nodes[n].slots as usize
    }

    pub fn slot(&self, n: usize, port: usize) -> Slot {
        self.slots[self.nodes[n].slots as usize + port]
    }

    pub fn node_slots(&self, n: usize) -> &[Slot] {
        let from = self.nodes[n].slots as usize;
        &self.slots[from..from + self.slot_count(n)]
    }

    /// Puts a literal at an input that has no wire, or takes it away.
    pub fn set_literal(&mut self, n: usize, port: usize, tree: Option<Tree>) {
        let at = self.nodes[n].slots as usize + port;
        let default = self.node_type(n).is_some_and(|t| t.defaults.get(port).is_some_and(Option::is_some));
        match (self.slots[at], tree) {
            (Slot::Wires { .. }, _) => return,
            (Slot::Literal(l), Some(tree)) => self.literals[l as usize] = tree,
            (_, Some(tree)) => {
                self.slots[at] = Slot::Literal(self.literals.len() as u32);
                self.literals.push(tree);
            }
            (_, None) => self.slots[at] = if default { Slot::Default } else { Slot::Missing },
        }
        self.mend(n, port as u32);
    }

    pub fn wire_sources(&self, from: u32, to: u32) -> &[u32] {
        &self.wires[from as usize..to as usize]
    }

    pub fn shape(&self, shape: u32) -> &[TreeOp] {
        &self.shapes[shape as usize]
    }

    /// Output slots that come in by wire.
    pub fn node_wires(&self, n: usize) -> impl Iterator<Item = u32> {
        self.node_slots(n).iter().flat_map(|slot| match slot {
            Slot::Wires { from, to, .. } => self.wire_sources(*from, *to).iter().copied(),
            _ => [].iter().copied(),
        })
    }

    /// Nodes that it depends on; one may come several times.
    pub fn predecessors(&self, n: usize) -> impl Iterator<Item = u32> {
        self.node_wires(n).map(|w| self.output_node[w as usize])
    }

    fn successor_range(&self, n: usize) -> std::ops::Range<usize> {
        let end = self.nodes.get(n + 1).map_or(self.successors.len(), |next| next.successors as usize);
        self.nodes[n].successors as usize..end
    }

    /// Nodes that depend on it, each once.
    pub fn successors(&self, n: usize) -> &[u32] {
        &self.successors[self.successor_range(n)]
    }

    /// Names of required inputs without any value.
    pub fn missing(&self, n: usize) -> impl Iterator<Item = &str> {
        let ports = self.node_type(n).map_or(&[] as &[Port], |t| &t.inputs);
        let slots = self.node_slots(n).iter().zip(ports);
        slots.filter(|(s, p)| **s == Slot::Missing && !p.optional).map(|(_, p)| p.name())
    }

    pub fn missing_diagnostic(id: &str, port: &str) -> Diagnostic {
        let message = format!("\"{port}\" has neither a wire nor a value");
        Diagnostic::error("missing-input", message).at(id).port(port).hint("connect a wire or set the parameter")
    }

    fn error(&mut self, n: usize, port: Option<u32>, diagnostic: Diagnostic) {
        if diagnostic.severity == Severity::Error
            && let Some(node) = self.nodes.get_mut(n)
        {
            node.sound = false;
        }
        self.errors.entry(n as u32).or_default().push((port, diagnostic));
    }

    /// Takes what was found before compiling: errors of nodes keep those from running.
    pub fn add(&mut self, diagnostics: Vec<Diagnostic>) {
        for diagnostic in diagnostics {
            let node = diagnostic.node.as_ref().filter(|_| diagnostic.severity == Severity::Error);
            match node.and_then(|id| self.find(id)) {
                Some(n) => self.error(n, None, diagnostic),
                None => self.general.push(diagnostic),
            }
        }
    }

    /// Forgets the errors of one parameter.
    fn mend(&mut self, n: usize, port: u32) {
        let Some(errors) = self.errors.get_mut(&(n as u32)) else { return };
        let before = errors.len();
        errors.retain(|(p, _)| *p != Some(port));
        if errors.len() < before {
            // Any other error or note kept it from running as well; only a warning does not.
            self.nodes[n].sound = errors.iter().all(|(_, d)| d.severity == Severity::Warning);
        }
    }

    /// True if nothing static keeps the node from running.
    pub fn is_sound(&self, n: usize) -> bool {
        self.nodes[n].sound
    }

    pub fn errors(&self, n: usize) -> impl Iterator<Item = &Diagnostic> {
        self.errors.get(&(n as u32)).into_iter().flatten().map(|(_, d)| d)
    }

    /// Nodes that have something to say before they run.
    pub fn nodes_with_errors(&self) -> impl Iterator<Item = usize> {
        self.errors.keys().map(|n| *n as usize)
    }
}

fn in_interface(kind: &str, name: &str, mut diagnostic: Diagnostic) -> Diagnostic {
    diagnostic.message = format!("interface {kind} \"{name}\": {}", diagnostic.message);
    diagnostic
}
