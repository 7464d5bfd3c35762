//! The engine of dataflow graphs: document and file, values, registry, plan, evaluator, cache and diagnostics.
//! It knows no geometry, and besides asking its host for the files that nodes name it does no input or output.

mod call;
mod diagnostic;
mod document;
mod evaluate;
mod expect;
mod expression;
mod live;
mod numeric;
mod plan;
mod port;
mod registry;
mod schema;
pub mod stop;
pub mod sweep;
mod value;

pub use call::{Call, MOST_ITEMS, Monitor};
pub use diagnostic::{CODES, Code, Diagnostic, Fail, Severity, nearest};
pub use document::{
    Cluster, DEFAULT_SIZE_LIMIT, DEPTH_LIMIT, Document, Fields, History, InterfaceInput, InterfaceOutput, Link,
    Literal, Look, Name, Node, NodeMore, NodeState, Nothing, Operation, OuterWires, Paste, Seldom, Table, TreeOp,
    Wires, WiresMore,
};
pub use evaluate::given::Given;
pub use evaluate::kept::{Kept, NotKept};
pub use evaluate::matching::Matching;
pub use evaluate::report::{Control, Event, Events, Happened, NodeReport, NodeReports, Progress, Report};
pub use evaluate::session::{Host, NoHost, Options, Session};
pub use evaluate::store::{Store, StoreFault};
pub use expect::{Expectations, Outcome, Tolerance};
pub use expression::{Dimension, Expression, ExpressionError, ExpressionFault, Quantity};
pub use live::{Draft, Live, Snapshot};
pub use numeric::{Random, Statistics};
pub use port::{Access, Port, Unit};
pub use registry::{Conversion, NodeType, Registry, RegistryError};
pub use schema::{schema, schema_with_nodes};
pub use value::{Column, Digester, File, Item, Json, Path, Text, Tree, digest_bytes, pack, unpack};
