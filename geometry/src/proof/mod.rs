//! Proof: programs read back from their text, swept through stock, parts and table.

mod motion;
pub use motion::{Motion, Program};
