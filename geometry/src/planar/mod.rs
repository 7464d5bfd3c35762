//! Planarity: measuring faces, and moving vertices until faces are planar.

mod cholesky;
mod descent;
mod energy;
mod fit;
mod flatness;
mod measure;
mod params;
mod solve;
mod step;

pub use fit::fit_plane;
pub use measure::{Planarity, PlanaritySummary};
pub use params::{PlanarizeError, PlanarizeParams, Planarized, Rim};
pub use solve::planarize;
