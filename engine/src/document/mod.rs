//! The document: nodes by id, literals by parameter, wires by port; and the file it lives in.

pub(crate) mod cluster;
mod describe;
pub(crate) mod fields;
pub(crate) mod format;
pub(crate) mod layout;
pub(crate) mod link;
pub(crate) mod literal;
pub(crate) mod load;
pub(crate) mod migrate;
pub(crate) mod model;
pub(crate) mod operations;
pub(crate) mod seldom;
pub(crate) mod validate;

pub use cluster::{Cluster, Link};
pub use fields::{Fields, Name};
pub use layout::Look;
pub use literal::Literal;
pub use load::{DEFAULT_SIZE_LIMIT, DEPTH_LIMIT};
pub use model::{Document, InterfaceInput, InterfaceOutput, Node, NodeMore, NodeState, TreeOp, Wires, WiresMore};
pub use operations::{History, Operation, OuterWires, Paste, Table};
pub use seldom::{Nothing, Seldom};
