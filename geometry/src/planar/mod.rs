//! Planarity: measuring faces, and moving vertices until faces are planar.

mod fit;
mod measure;

pub use fit::fit_plane;
pub use measure::{Planarity, PlanaritySummary};
