//! Panels: the shared panel set, thickening, solids.

mod set;
pub use set::{EdgeRef, PanelSet, Side};
