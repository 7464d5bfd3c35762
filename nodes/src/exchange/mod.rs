//! Values on their way to and from plugins and hosts: the engine's columns as the contract's arrays. Large arrays are
//! borrowed or change hands, they are not copied.

#[cfg(test)]
pub(crate) mod addresses;
mod give;
mod preview;
mod take;

pub use give::branches;
pub(crate) use give::features;
pub use preview::{Part, Preview, preview};
pub(crate) use take::{columns, panels};
pub use take::{lent_tree, tree};
