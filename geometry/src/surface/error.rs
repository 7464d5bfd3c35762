//! What can be wrong with a surface made of curves. Indices in the data and in the words count from 0, as mesh
//! addresses do.

use crate::ifs::CurveError;
use thiserror::Error;

/// A surface that cannot be made.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SurfaceError {
    /// A curve in several pieces.
    #[error("curve {curve} has {strips} pieces; a surface needs it in one")]
    Disconnected {
        /// 'A' or 'B'.
        curve: char,
        /// Number of strips.
        strips: usize,
    },
    /// A curve without a segment, or a closed one of fewer than 3 points.
    #[error("curve {curve} has only {points} points")]
    TooShort {
        /// 'A' or 'B'.
        curve: char,
        /// Number of points.
        points: usize,
    },
    /// A vertex has no place in space.
    #[error(
        "vertex (A {a}, B {b}) has the weight {weight}: it lies at infinity or beyond; raise the weights of A near point {a} or of B near point {b}"
    )]
    Weight {
        /// Point of A: column.
        a: usize,
        /// Point of B: row.
        b: usize,
        /// W of the vertex; W_A + W_B − 1 for a vector sum.
        weight: f64,
    },
    /// A coordinate is NaN or infinite, or would become so.
    #[error("{what} is not finite")]
    NotFinite {
        /// Which.
        what: &'static str,
    },
    /// The control grid has another size than said.
    #[error("the control grid has {given} points; {rows} rows of {columns} need {}", rows * columns)]
    GridSize {
        /// Points given.
        given: usize,
        /// Rows.
        rows: usize,
        /// Columns.
        columns: usize,
    },
    /// A direction's control points or iterations do not fit its scheme.
    #[error("direction {direction}: {source}")]
    Direction {
        /// 'A' or 'B'.
        direction: char,
        /// What is wrong.
        source: CurveError,
    },
    /// Neighbouring patches do not meet for this scheme and number of shared points.
    #[error("direction {direction}: patches of this scheme that share {shared} control points do not meet")]
    PatchesApart {
        /// 'A' or 'B'.
        direction: char,
        /// Shared control points.
        shared: usize,
    },
    /// More vertices than a surface may have.
    #[error("the surface would have {vertices} vertices; {limit} is the most")]
    TooManyVertices {
        /// Vertices asked for.
        vertices: usize,
        /// The limit.
        limit: usize,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}
