//! Panels: the shared panel set, thickening, solids.

mod border;
mod clip;
mod issue;
mod node;
mod set;
mod solid;
mod thicken;

pub use border::{BorderCut, BorderRule, EdgeCut};
pub use issue::{PanelIssue, ThickenError};
pub use set::{EdgeRef, Neighbour, PanelSet, Side};
pub use solid::Solid;
pub use thicken::{Nodes, ThickenParams, thicken, thicken_while};

#[cfg(test)]
mod faults;
#[cfg(test)]
mod laws;
#[cfg(test)]
pub(crate) mod shells;
