//! Values that a program gives to parameters in memory: meshes, panel sets, arrays that it shares. They have no written
//! form, so the document does not know them.

use super::session::Session;
use crate::document::operations::Operation;
use crate::plan::Slot;
use crate::value::{Json, Tree};

/// A value for a parameter, checked and converted: see [`crate::Draft::given`].
#[derive(Clone, Debug)]
pub struct Given {
    pub(crate) node: String,
    pub(crate) port: String,
    pub(crate) tree: Tree,
}

impl Session {
    /// Gives a parameter a value that stays in memory: it stands until the parameter is set otherwise or gets a wire, and is
    /// not part of the document. Nothing runs yet. Nothing happens if there is no such parameter any more.
    /// O(log nodes).
    pub fn give(&mut self, given: &Given) {
        self.given.insert((given.node.clone(), given.port.clone()), given.tree.clone());
        self.place_given(&given.node, &given.port, &given.tree);
    }

    fn place_given(&mut self, node: &str, port: &str, tree: &Tree) {
        let Ok(places) = self.plan.find_inputs(&format!("{node}.{port}")) else { return };
        let fits = |(n, p): &(usize, usize)| {
            let takes = self.plan.node_type(*n).and_then(|t| t.inputs.get(*p)).and_then(|port| port.item_type.id);
            let same = takes.is_none_or(|id| tree.branches().iter().all(|(_, c)| c.item_type() == id));
            same && !matches!(self.plan.slot(*n, *p), Slot::Wires { .. })
        };
        let places = places.into_iter().filter(fits).map(|(n, p)| (n, p, Some(tree.clone()))).collect();
        self.place(places, &Json::Null);
    }

    /// Puts what was given into a plan that was made anew.
    pub(super) fn place_all_given(&mut self) {
        let given = std::mem::take(&mut self.given);
        for ((node, port), tree) in &given {
            self.place_given(node, port, tree);
        }
        self.given = given;
    }

    /// Forgets what an operation replaces.
    pub(super) fn forget_given(&mut self, operation: &Operation) {
        if self.given.is_empty() {
            return;
        }
        for part in operation.parts() {
            match part {
                Operation::SetParam { node, port, .. } => {
                    self.given.remove(&(node.clone(), port.clone()));
                }
                Operation::RemoveNode { id } => self.given.retain(|(node, _), _| node != id),
                _ => {}
            }
        }
    }
}
