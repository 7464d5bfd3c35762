//! The plan: the document compiled to dense tables, so that evaluation follows numbers and never looks up a name.
//! Nodes are numbered in the order of their ids; slots, wires and successors lie in flat tables (CSR).

pub(crate) mod address;
mod compile;
pub(crate) mod define;
mod expand;
mod formula;
mod order;
pub(crate) mod texts;

use crate::diagnostic::{Diagnostic, Severity};
use crate::document::model::{NodeState, TreeOp};
use crate::evaluate::matching::Matching;
use crate::port::Port;
use crate::registry::NodeType;
use crate::value::Tree;
use expand::Instance;
use formula::Formula;
use std::collections::BTreeMap;
use std::sync::Arc;
use texts::Texts;

/// No node type: the document names one that nobody knows.
pub(crate) const UNKNOWN: u32 = u32::MAX;

/// Where one input's value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slot {
    Missing,
    Default,
    Literal(u32),
    /// One wire, from this output slot, whose tree arrives as it is.
    Wire(u32),
    /// An index into `bundles`.
    Wires(u32),
}

impl Slot {
    pub fn is_wired(self) -> bool {
        matches!(self, Self::Wire(_) | Self::Wires(_))
    }
}

/// Several wires into one input, or one whose tree is changed.
struct Bundle {
    /// A range of `wires`.
    from: u32,
    to: u32,
    shape: Vec<TreeOp>,
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
    /// No static error keeps it from running.
    sound: bool,
}

/// A document made ready to run.
pub(crate) struct Plan {
    pub ids: Arc<Texts>,
    pub nodes: Vec<PlanNode>,
    pub types: Vec<Arc<NodeType>>,
    /// Their names.
    pub type_names: Arc<Texts>,
    slots: Vec<Slot>,
    bundles: Vec<Bundle>,
    /// Output slots that the wires of bundles come from.
    wires: Vec<u32>,
    /// Node that each output slot belongs to.
    pub output_node: Vec<u32>,
    pub literals: Vec<Tree>,
    successors: Vec<u32>,
    pub levels: usize,
    /// Errors and warnings of nodes; the port, if it is one parameter's fault that setting it would mend.
    errors: BTreeMap<u32, Vec<(Option<u32>, Diagnostic)>>,
    /// Parameters that are formulas, by node and port.
    formulas: BTreeMap<(u32, u32), Formula>,
    /// Instances of clusters by path; their nodes are among the others.
    instances: BTreeMap<Arc<str>, Instance>,
    /// Nodes that cannot run because the other one is of an unknown type.
    pub strangers: Vec<(u32, u32)>,
    /// What concerns no single node.
    pub general: Vec<Diagnostic>,
}

impl Plan {
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
            (Slot::Wire(_) | Slot::Wires(_), _) => return,
            (Slot::Literal(l), Some(tree)) => self.literals[l as usize] = tree,
            (_, Some(tree)) => {
                self.slots[at] = Slot::Literal(self.literals.len() as u32);
                self.literals.push(tree);
            }
            (_, None) => self.slots[at] = if default { Slot::Default } else { Slot::Missing },
        }
        self.mend(n, port as u32);
    }

    /// Output slots that wires into an input come from, and what is done to what arrives; none without wires.
    pub fn wires<'a>(&'a self, slot: &'a Slot) -> (&'a [u32], &'a [TreeOp]) {
        match slot {
            Slot::Wire(source) => (std::slice::from_ref(source), &[]),
            Slot::Wires(bundle) => {
                let bundle = &self.bundles[*bundle as usize];
                (&self.wires[bundle.from as usize..bundle.to as usize], &bundle.shape)
            }
            Slot::Missing | Slot::Default | Slot::Literal(_) => (&[], &[]),
        }
    }

    /// Output slots that come in by wire.
    pub fn node_wires(&self, n: usize) -> impl Iterator<Item = u32> {
        self.node_slots(n).iter().flat_map(|slot| self.wires(slot).0.iter().copied())
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

    /// A required input of a node without any value.
    pub fn missing_diagnostic(&self, n: usize, port: &str) -> Diagnostic {
        let id = &self.ids[n];
        let message = format!("\"{port}\" has neither a wire nor a value");
        let hint = match self.entrance(id, port) {
            Some(outer) => format!("connect a wire to {outer} or set it"),
            None => "connect a wire or set the parameter".into(),
        };
        Diagnostic::error("missing-input", message).at(id).port(port).hint(hint)
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
                None => {
                    for n in self.in_instances(&diagnostic) {
                        self.nodes[n].sound = false;
                    }
                    self.general.push(diagnostic);
                }
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
