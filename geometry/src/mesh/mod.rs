//! Polygon meshes: the shared type, welding, adjacency, order and address.

mod adjacency;
mod error;
mod face;
mod polygon;
mod structure;

pub use adjacency::Adjacency;
pub use error::MeshError;
pub use polygon::{Address, Mesh};
