//! Geometry of free-form timber: curves, meshes, panels, joints, boards, tool motion, proof.
//!
//! All lengths are millimetres, all angles radians, all coordinates `f64`. Nothing here does I/O, knows a graph, a
//! node or a machine's dialect.

pub mod board;
pub mod ifs;
pub mod joint;
pub mod machine;
pub mod mesh;
pub mod motion;
pub mod panel;
pub mod planar;
pub mod plane;
pub mod polygon;
pub mod proof;
pub mod shared;
pub mod stock;
pub mod surface;

pub use glam::{DAffine3, DMat3, DVec2, DVec3, DVec4};
pub use plane::Plane;
pub use shared::Shared;
