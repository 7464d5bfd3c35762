//! Polygon meshes: the shared type, welding, adjacency, order and address.

mod polygon;
pub use polygon::{Address, Mesh};
