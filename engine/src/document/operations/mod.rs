//! Operations: every change that an editor or a host makes to a document, as a value. Applying one gives the operation that
//! takes it back, byte for byte.

mod apply;
mod cluster;
mod diff;
mod explode;
mod fragment;
mod gather;
mod history;
mod interface;

pub use fragment::{OuterWires, Paste};
pub use history::History;

use super::cluster::Cluster;
use super::layout::Look;
use super::model::{Document, InterfaceInput, InterfaceOutput, Node, NodeState, Wires};
use crate::diagnostic::Diagnostic;
use crate::evaluate::matching::Matching;
use crate::value::Json;

/// One change of a document. Operations that name what they do (`AddNode`, `Connect`, `Rename` …) refuse what makes no
/// sense, such as a wire from a node that is not there; `Put…` and `Set…` bring one place to one value and refuse only what
/// could not be written to a file and read back. Whether the graph can run is [`Document::validate`]'s matter.
#[derive(Clone, Debug, PartialEq)]
pub enum Operation {
    /// Adds a node under a free id.
    AddNode {
        /// Its id.
        id: String,
        /// The node.
        node: Box<Node>,
    },
    /// Removes a node with the wires from it, its interface bindings, its place in groups and its position. O(document).
    RemoveNode {
        /// Its id.
        id: String,
    },
    /// Puts a node at an id, or takes it away; everything else stays.
    PutNode {
        /// Its id.
        id: String,
        /// The node, or none.
        node: Option<Box<Node>>,
    },
    /// Gives a node another id; wires, interface, groups and position follow. O(document).
    Rename {
        /// Its id.
        from: String,
        /// The free id that it gets.
        to: String,
    },
    /// Adds a wire.
    Connect {
        /// The node that it goes to.
        node: String,
        /// The input that it goes to.
        port: String,
        /// `node.port` that it comes from.
        from: String,
        /// Its place among the wires of that input; at the end if none.
        at: Option<usize>,
    },
    /// Removes a wire.
    Disconnect {
        /// The node that it goes to.
        node: String,
        /// The input that it goes to.
        port: String,
        /// `node.port` that it comes from.
        from: String,
    },
    /// Everything that comes to one input by wire: sources, tree operations, matching.
    PutWires {
        /// The node.
        node: String,
        /// Its input.
        port: String,
        /// The wires, or none.
        wires: Option<Wires>,
    },
    /// Sets a parameter; without a value its default counts again.
    SetParam {
        /// The node.
        node: String,
        /// Its input.
        port: String,
        /// The literal, or none.
        value: Option<Json>,
    },
    /// How lists of different lengths meet at a node.
    SetMatching {
        /// The node.
        node: String,
        /// The rule, or none for the default.
        matching: Option<Matching>,
    },
    /// Whether a node runs, and what it gives if not: on, frozen, disabled, bypassed.
    SetState {
        /// The node.
        node: String,
        /// The state.
        state: NodeState,
    },
    /// A remark for people.
    SetNote {
        /// The node.
        node: String,
        /// The remark, or none.
        note: Option<String>,
    },
    /// Makes a group of nodes, gives a group other members (whatever else the file says of it stays), or dissolves it.
    SetGroup {
        /// Its name.
        name: String,
        /// Ids of its nodes, all of them there; none dissolves the group.
        nodes: Option<Vec<String>>,
    },
    /// A named input of the graph, or its removal.
    SetInput {
        /// Its name.
        name: String,
        /// The input, or none.
        input: Option<InterfaceInput>,
    },
    /// A named output of the graph, or its removal.
    SetOutput {
        /// Its name.
        name: String,
        /// The output, or none.
        output: Option<InterfaceOutput>,
    },
    /// One key of a table that the file keeps as it is.
    SetEntry {
        /// The table.
        table: Table,
        /// The key.
        key: String,
        /// The value, or none.
        value: Option<Json>,
    },
    /// Defines a cluster, links one from a file, or takes its definition away; instances stay. O(definition).
    SetCluster {
        /// Its name.
        name: String,
        /// The definition or the link, or none.
        cluster: Option<Box<Cluster>>,
    },
    /// Does something inside the definition of a cluster that stands in the file; all instances follow.
    InCluster {
        /// Its name.
        name: String,
        /// What is done, with ids as they are inside.
        operation: Box<Self>,
    },
    /// Foreign data (`x`): one JSON value as text, kept byte for byte.
    SetForeign {
        /// The text, or none.
        text: Option<String>,
    },
    /// Where a node stands on the canvas.
    Move {
        /// The node.
        node: String,
        /// x to the right and y down in points of the canvas, or none.
        to: Option<[f64; 2]>,
    },
    /// How a node looks on the canvas.
    SetLook {
        /// The node.
        node: String,
        /// How it looks; the default takes back what was said.
        look: Look,
    },
    /// All of them in order, or none of them if one is refused.
    All(Vec<Operation>),
}

/// Tables of the files whose values are kept as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// `requires`: plugins.
    Requires,
    /// `groups`.
    Groups,
    /// Unknown keys inside `interface`.
    Interface,
    /// Unknown keys at the top of the file.
    Top,
    /// Keys of the layout file that views keep there, of the whole graph.
    Layout,
}

impl Operation {
    /// Changes `document` and gives the operation that takes the change back: after both, the canonical text is the same
    /// byte for byte. O(log n) in the size of the document unless said otherwise at the operation.
    ///
    /// # Errors
    /// Says why the operation makes no sense for this document; then nothing has changed.
    pub fn apply(&self, document: &mut Document) -> Result<Self, Diagnostic> {
        apply::apply_at(self, document, 0)
    }

    /// The same inside the definition of a cluster of this file. What defines clusters, and what is done inside of them, stays at
    /// the top of the file. O(operations).
    #[must_use]
    pub fn inside(self, cluster: &str) -> Self {
        let within = |operation| Self::InCluster { name: cluster.to_owned(), operation: Box::new(operation) };
        if !self.parts().any(|part| matches!(part, Self::SetCluster { .. } | Self::InCluster { .. })) {
            return within(self);
        }
        let part = |part: &Self| match part {
            Self::SetCluster { .. } | Self::InCluster { .. } => part.clone(),
            part => within(part.clone()),
        };
        Self::All(self.parts().map(part).collect())
    }

    /// The operations it consists of, those inside `All` one by one. Without recursion: a caller may nest as it likes.
    pub fn parts(&self) -> impl Iterator<Item = &Self> {
        let mut open = vec![self];
        std::iter::from_fn(move || {
            loop {
                match open.pop()? {
                    Self::All(parts) => open.extend(parts.iter().rev()),
                    part => return Some(part),
                }
            }
        })
    }
}
