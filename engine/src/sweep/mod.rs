//! Sweeps: one graph, many values of its inputs. A row is one variant and has a key that names its result for ever; an
//! evaluator computes row after row; a sealed result tells whether it is whole. Where plans and results lie, and how
//! they get there, is the host's matter.

mod evaluator;
mod result;
mod row;

pub use evaluator::RowEvaluator;
pub use result::{seal, unseal};
pub use row::{Row, combinations, document_digest};
