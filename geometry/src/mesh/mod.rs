//! Polygon meshes: the shared type, welding, adjacency, orientation, faults, order and address.

mod adjacency;
mod error;
mod face;
mod fault;
mod order;
mod orient;
mod patch;
mod polygon;
mod structure;
mod triangles;
mod weld;

pub use adjacency::Adjacency;
pub use error::MeshError;
pub(crate) use face::{area_vector, centre};
pub use fault::FaceFault;
pub(crate) use fault::inset;
pub use order::{FaceKind, OrderKind, OrderParams, Ordered, Start, order_faces};
pub use orient::{Front, Oriented, orient};
pub use patch::{Closing, Patch};
pub use polygon::{Address, Mesh};
pub use triangles::triangles;
pub use weld::{Welded, weld};
