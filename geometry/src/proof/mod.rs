//! Proof: programs read back from their text, swept through stock, parts and table.

mod depth;
mod judge;
mod motion;
mod prove;
mod ray;
mod report;
mod run;
mod sweep;
mod workpiece;
pub use motion::{Motion, Program};
pub use prove::{ProofError, prove};
pub use report::{Body, Fault, Obstacle, PartFace, PartVerdict, ProgramVerdict, ProofParams, ProofReport, Reason};
