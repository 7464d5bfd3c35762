//! What an evaluation came to, kept apart from the session, so that it can be read while the next one runs.

use crate::document::model::split_port;
use crate::evaluate::report::Report;
use crate::evaluate::session::Session;
use crate::evaluate::state::{Status, Value};
use crate::plan::texts::Texts;
use crate::registry::NodeType;
use crate::value::{File, Tree};
use std::collections::BTreeMap;
use std::sync::Arc;

/// Where values are by name, for as long as the plan stays the same.
pub(crate) struct Names {
    /// Sorted.
    ids: Arc<Texts>,
    /// Type and first output slot of each node.
    nodes: Vec<(Option<Arc<NodeType>>, u32)>,
    /// Output slots of interface outputs and of outputs of instances.
    outputs: BTreeMap<String, u32>,
}

/// What one evaluation came to. Immutable; values share their data with the session and with other snapshots, so
/// keeping one costs memory only for what has changed since.
pub struct Snapshot {
    pub(super) revision: u64,
    pub(super) report: Report,
    values: Vec<Value>,
    files: Vec<(String, File)>,
    names: Arc<Names>,
}

impl std::fmt::Debug for Snapshot {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Snapshot").field("revision", &self.revision).finish_non_exhaustive()
    }
}

impl Snapshot {
    /// The revision that was evaluated: see [`super::Live`].
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Diagnostics of everything that was asked for, and what happened to the nodes that were looked at.
    #[must_use]
    pub fn report(&self) -> &Report {
        &self.report
    }

    /// The value of an interface output or of `node.port`. `None` if there is no such name, or it was not asked for and
    /// nothing asked for needs it, or failed, or was dropped from memory. O(log nodes).
    #[must_use]
    pub fn value(&self, name: &str) -> Option<&Tree> {
        let slot = match self.names.outputs.get(name) {
            Some(slot) => *slot as usize,
            None => {
                let (id, port) = split_port(name)?;
                let n = self.names.ids.find(id)?;
                let (node_type, first) = self.names.nodes.get(n)?;
                *first as usize + node_type.as_ref()?.output_index(port)?
            }
        };
        self.values.get(slot)?.tree()
    }

    /// Every value that there is: node, port, value, in order of node ids.
    pub fn values(&self) -> impl Iterator<Item = (&str, &str, &Tree)> {
        self.names.ids.iter().zip(&self.names.nodes).flat_map(move |(id, (node_type, first))| {
            let ports = node_type.iter().flat_map(|t| t.outputs()).enumerate();
            ports.filter_map(move |(o, port)| {
                let value = self.values.get(*first as usize + o)?.tree()?;
                Some((id, port.name(), value))
            })
        })
    }

    /// The files that the writers made, as [`Session::files`].
    #[must_use]
    pub fn files(&self) -> &[(String, File)] {
        &self.files
    }
}

impl Session {
    /// What the last evaluation came to. O(nodes).
    pub(super) fn snapshot(&self, names: Arc<Names>, revision: u64, report: Report) -> Snapshot {
        let mut values = vec![Value::Nothing; self.plan.output_node.len()];
        for (n, run) in self.nodes.iter().enumerate() {
            // What nobody asked for may be older than the rest.
            if run.needed && !run.dirty && run.status == Status::Good {
                let first = self.plan.nodes[n].outputs as usize;
                let outputs = self.outputs(n);
                values[first..first + outputs.len()].clone_from_slice(outputs);
            }
        }
        Snapshot { revision, report, values, files: self.files(), names }
    }

    /// Where values are by name until the plan is made anew. O(nodes).
    pub(super) fn names(&self) -> Names {
        let node = |n: usize| (self.plan.node_type(n).cloned(), self.plan.nodes[n].outputs);
        let slot = |address: &str| {
            let (n, o) = self.plan.find_output(address).ok()?;
            Some(self.plan.nodes[n].outputs + o as u32)
        };
        let outputs = self.document.outputs.iter().map(|(name, output)| (name.clone(), output.port.clone()));
        let outputs = outputs.chain(self.plan.instance_outputs().map(|address| (address.clone(), address)));
        Names {
            ids: self.plan.ids.clone(),
            nodes: (0..self.plan.nodes.len()).map(node).collect(),
            outputs: outputs.filter_map(|(name, address)| Some((name, slot(&address)?))).collect(),
        }
    }
}
