//! The document in memory. Everything that the file says is kept, also what this version does not understand.

use super::cluster::{Cluster, Linked};
use super::fields::{Fields, Name};
use super::layout::Layout;
use super::literal::Literal;
use super::seldom::{Nothing, Seldom};
use crate::diagnostic::Diagnostic;
use crate::evaluate::matching::Matching;
use crate::registry::Registry;
use crate::value::Json;
use smallvec::SmallVec;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A graph as its file says it. Evaluation never changes it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Document {
    /// Named inputs of the whole graph.
    pub inputs: BTreeMap<String, InterfaceInput>,
    /// Named outputs of the whole graph.
    pub outputs: BTreeMap<String, InterfaceOutput>,
    pub(crate) nodes: BTreeMap<String, Node>,
    /// Plugins that the graph needs, as the file says it.
    pub requires: BTreeMap<String, Json>,
    /// Groups, as the file says it.
    pub groups: BTreeMap<String, Json>,
    /// What nodes of type `cluster:NAME` are instances of.
    pub clusters: BTreeMap<String, Cluster>,
    pub(crate) linked: Linked,
    /// Foreign data, byte for byte.
    pub(crate) foreign: Option<Arc<str>>,
    /// Top-level keys that this version does not know.
    pub(crate) extra: BTreeMap<String, Json>,
    /// Keys inside `interface` that this version does not know.
    pub(crate) interface_extra: BTreeMap<String, Json>,
    /// Where nodes stand on a canvas; in a file of its own.
    pub(crate) layout: Layout,
}

/// A named input of the whole graph, bound to the parameters of one or more nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InterfaceInput {
    /// `node.port`, at least one.
    pub ports: Vec<String>,
    /// Sign of the unit, for people.
    pub unit: Option<String>,
    /// Smallest number accepted.
    pub min: Option<f64>,
    /// Largest number accepted.
    pub max: Option<f64>,
    /// By how much people slide it, above 0: from `min` on, if there is one.
    pub step: Option<f64>,
    /// What it means.
    pub doc: Option<String>,
    /// Its place among the others, the smallest first; those that say none follow by name.
    pub order: Option<i64>,
    pub(crate) extra: BTreeMap<String, Json>,
}

/// A named output of the whole graph.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InterfaceOutput {
    /// `node.port`.
    pub port: String,
    /// Sign of the unit, for people.
    pub unit: Option<String>,
    /// What it means.
    pub doc: Option<String>,
    /// Its place among the others, the smallest first; those that say none follow by name.
    pub order: Option<i64>,
    pub(crate) extra: BTreeMap<String, Json>,
}

/// What a node is asked to do.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NodeState {
    /// It runs when its inputs change.
    #[default]
    On,
    /// It keeps its last output.
    Frozen,
    /// It gives nothing; what depends on it is blocked.
    Disabled,
    /// It does not run: each output, in order, passes on the first input of its own type that comes in by wire and that
    /// no output before it has passed. An output for which there is none gives nothing, and blocks what depends on it.
    Bypassed,
}

impl NodeState {
    pub(crate) const ALL: [Self; 4] = [Self::On, Self::Frozen, Self::Disabled, Self::Bypassed];

    /// The state of a node inside an instance of this state: the stronger of both.
    #[must_use]
    pub fn within(self, outer: Self) -> Self {
        let strongest = [Self::Disabled, Self::Frozen, Self::Bypassed];
        strongest.into_iter().find(|state| self == *state || outer == *state).unwrap_or(Self::On)
    }

    /// Its name in the file.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::On => "on",
            Self::Frozen => "frozen",
            Self::Disabled => "disabled",
            Self::Bypassed => "bypassed",
        }
    }
}

/// A change of a tree's shape at an input.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TreeOp {
    /// Every item in its own branch.
    Graft,
    /// All items in one branch.
    Flatten,
    /// Paths without their common start.
    Simplify,
    /// Items of each branch in reverse order.
    Reverse,
}

impl TreeOp {
    pub(crate) const ALL: [Self; 4] = [Self::Graft, Self::Flatten, Self::Simplify, Self::Reverse];

    /// Its name in the file.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Graft => "graft",
            Self::Flatten => "flatten",
            Self::Simplify => "simplify",
            Self::Reverse => "reverse",
        }
    }
}

/// What comes to one input by wire.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wires {
    /// `node.port` of each source, in order.
    pub from: SmallVec<[Name; 1]>,
    /// What few inputs say beside that.
    pub more: Seldom<WiresMore>,
}

/// What is done to that which comes to one input by wire.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WiresMore {
    /// Applied in order to what arrives.
    pub tree: Vec<TreeOp>,
    /// How lists of different lengths meet; the node's own rule goes first.
    pub matching: Option<Matching>,
    pub(crate) extra: BTreeMap<String, Json>,
}

impl Nothing for WiresMore {
    fn nothing() -> &'static Self {
        static NOTHING: WiresMore = WiresMore { tree: Vec::new(), matching: None, extra: BTreeMap::new() };
        &NOTHING
    }

    fn is_nothing(&self) -> bool {
        *self == *Self::nothing()
    }
}

/// One node.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Node {
    /// Name of its node type.
    pub type_name: Name,
    /// Version of the node type that the file was written for.
    pub version: u32,
    /// Literals by port.
    pub params: Fields<Literal>,
    /// Wires by port.
    pub inputs: Fields<Wires>,
    /// How lists of different lengths meet.
    pub matching: Option<Matching>,
    /// Whether it runs, and what it gives if not.
    pub state: NodeState,
    /// What the file says of few nodes.
    pub more: Seldom<NodeMore>,
}

/// What the file says of few nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct NodeMore {
    /// A remark for people.
    pub note: Option<String>,
    pub(crate) extra: BTreeMap<String, Json>,
    /// The text it was loaded from, for node types that nobody knows; gone once the node was changed.
    pub(crate) raw: Raw,
}

impl Nothing for NodeMore {
    fn nothing() -> &'static Self {
        static NOTHING: NodeMore = NodeMore { note: None, extra: BTreeMap::new(), raw: Raw(None) };
        &NOTHING
    }

    fn is_nothing(&self) -> bool {
        self.note.is_none() && self.extra.is_empty() && self.raw.0.is_none()
    }
}

/// Source text that does not count when nodes are compared.
#[derive(Clone, Debug, Default)]
pub(crate) struct Raw(pub Option<Arc<str>>);

impl PartialEq for Raw {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Node {
    /// A node of version 1 without parameters and wires.
    #[must_use]
    pub fn new(type_name: impl Into<Name>) -> Self {
        Self { type_name: type_name.into(), version: 1, ..Self::default() }
    }

    /// Sets a parameter.
    #[must_use]
    pub fn param(mut self, port: impl Into<Name>, value: impl Into<Json>) -> Self {
        self.params.insert(port, Literal::from(value.into()));
        self
    }

    /// Adds a wire from `source` (`node.port`).
    #[must_use]
    pub fn wire(mut self, port: impl Into<Name>, source: impl Into<Name>) -> Self {
        let port = port.into();
        match self.inputs.get_mut(&port) {
            Some(wires) => wires.from.push(source.into()),
            None => {
                self.inputs.insert(port, Wires::from_sources([source.into()]));
            }
        }
        self
    }

    /// Forgets the text that it was loaded from: it is about to change.
    pub(crate) fn forget_source(&mut self) {
        if self.more.raw.0.is_some() {
            self.more.raw = Raw(None);
            self.more.shrink();
        }
    }
}

impl Wires {
    /// Wires from these sources (`node.port`), as they are.
    #[must_use]
    pub fn from_sources(sources: impl IntoIterator<Item = Name>) -> Self {
        Self { from: sources.into_iter().collect(), more: Seldom::default() }
    }
}

impl Document {
    /// A document without nodes.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// The nodes by id.
    #[must_use]
    pub fn nodes(&self) -> &BTreeMap<String, Node> {
        &self.nodes
    }

    /// Interface inputs in the order in which people see them. O(n log n).
    #[must_use]
    pub fn inputs_in_order(&self) -> Vec<(&str, &InterfaceInput)> {
        in_order(&self.inputs, |input| input.order)
    }

    /// Interface outputs in the order in which people see them. O(n log n).
    #[must_use]
    pub fn outputs_in_order(&self) -> Vec<(&str, &InterfaceOutput)> {
        in_order(&self.outputs, |output| output.order)
    }

    /// A node to change.
    pub fn node_mut(&mut self, id: &str) -> Option<&mut Node> {
        let node = self.nodes.get_mut(id)?;
        node.forget_source();
        Some(node)
    }

    /// Adds or replaces a node. Ids must not be empty or contain a dot: `node.port` could not be read back.
    ///
    /// # Errors
    /// If the id is not allowed.
    pub fn insert(&mut self, id: impl Into<String>, mut node: Node) -> Result<(), Diagnostic> {
        let id = id.into();
        if !valid_id(&id) {
            let message = format!("\"{id}\" cannot be a node's id: it is empty or has a dot in it");
            return Err(Diagnostic::error("bad-id", message));
        }
        node.check_source();
        self.nodes.insert(id, node);
        Ok(())
    }

    /// Removes a node; wires from it stay and are named by validation.
    pub fn remove(&mut self, id: &str) -> Option<Node> {
        self.layout.positions.remove(id);
        self.layout.looks.remove(id);
        self.nodes.remove(id)
    }

    /// Takes as little memory as it can: full tree nodes, and no source text of nodes whose type `registry` knows, which are
    /// written anew anyway. O(nodes).
    pub(crate) fn pack(&mut self, registry: &Registry) {
        let nodes = std::mem::take(&mut self.nodes).into_iter().map(|(id, mut node)| {
            if registry.get(&node.type_name).is_some() {
                node.forget_source();
            }
            (id, node)
        });
        self.nodes = nodes.collect();
    }

    /// Foreign data (`x`) as it stands in the file.
    #[must_use]
    pub fn foreign(&self) -> Option<&str> {
        self.foreign.as_deref()
    }
}

fn in_order<T>(all: &BTreeMap<String, T>, order: impl Fn(&T) -> Option<i64>) -> Vec<(&str, &T)> {
    let mut all: Vec<(&str, &T)> = all.iter().map(|(name, t)| (name.as_str(), t)).collect();
    all.sort_by_key(|(_, t)| (order(t).is_none(), order(t)));
    all
}

pub(crate) fn valid_id(id: &str) -> bool {
    !id.is_empty() && !id.contains('.') && !id.chars().any(char::is_control)
}

/// `node.port` taken apart.
pub(crate) fn split_port(address: &str) -> Option<(&str, &str)> {
    address.split_once('.').filter(|(n, p)| !n.is_empty() && !p.is_empty())
}
