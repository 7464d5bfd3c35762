//! What is left of a board while tools move through it: a grid of vertical lines, each with the stretches of wood that it
//! meets (dexels: Van Hook 1986). Made to be looked at: the proof judges exactly, and by other means.

mod column;
mod faces;
mod removal;

pub use column::Column;
pub use faces::Face;
pub use removal::{Region, Stock};
