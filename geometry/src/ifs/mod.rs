//! Iterated curves (000 §3.3, §4.1, §5): transformation schemes, their subdivision points, and the figures they draw.

mod basis;
mod continuity;
mod curve;
mod error;
#[cfg(test)]
mod figures;
mod iterate;
#[cfg(test)]
mod laws;
mod least_norm;
mod patches;
mod preset;
mod scheme;
mod subdivision;

pub(crate) use basis::Basis;
pub(crate) use continuity::Continuity;
pub use curve::{Curve, Traversal, Word, Words};
pub use error::{CurveError, SchemeError};
pub(crate) use iterate::check_count;
pub use iterate::{MAX_ITERATIONS, MAX_SEGMENTS, iterate};
pub(crate) use patches::patch_count;
pub use patches::{homogeneous, patches};
pub use preset::{MAX_DEGREE, Preset};
pub use scheme::{Scheme, Tie};
pub use subdivision::Move;
