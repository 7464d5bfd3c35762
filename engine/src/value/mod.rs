//! Values: what flows on wires. Items in columns, columns in trees, each with its digest.

mod cells;
pub(crate) mod column;
pub(crate) mod digest;
pub(crate) mod item;
mod order;
mod pack;
pub(crate) mod tree;

pub use column::Column;
pub use digest::{Digester, digest_bytes};
pub use item::{File, Item, Json, Text};
pub use pack::{pack, unpack};
pub use tree::{Path, Tree};
