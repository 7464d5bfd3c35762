//! Nodes for curves and the surfaces made of them.

mod area;
mod ifs_curve;
mod scheme;
mod tensor_product;
mod vector_sum;

use tenon_engine::{Fail, NodeType};
use tenon_geometry::ifs::CurveError;
use tenon_geometry::surface::SurfaceError;

pub(crate) fn nodes() -> Vec<NodeType> {
    vec![ifs_curve::node(), vector_sum::node(), tensor_product::node(), area::node()]
}

fn curve_fail(error: &CurveError) -> Fail {
    let (code, port) = match error {
        CurveError::Cancelled => return Fail::cancelled(),
        CurveError::Empty | CurveError::OnePoint | CurveError::TooFewPoints { .. } => {
            ("curve-too-few-points", "points")
        }
        CurveError::NotFinite { .. } => ("not-finite", "points"),
        CurveError::WeightSum { .. } | CurveError::Weight { .. } | CurveError::WeightJump { .. } => {
            ("curve-weight", "weights")
        }
        CurveError::Gap { .. } => ("curve-gap", "points"),
        CurveError::TooManySegments { .. } => ("curve-too-long", "iterations"),
        _ => ("curve-wrong", "points"),
    };
    Fail::new(code, error.to_string()).port(port)
}

fn surface_fail(error: &SurfaceError) -> Fail {
    let code = match error {
        SurfaceError::Cancelled => return Fail::cancelled(),
        SurfaceError::Weight { .. } => "surface-weight",
        SurfaceError::NotFinite { .. } => "not-finite",
        SurfaceError::Disconnected { .. } => "curve-in-pieces",
        SurfaceError::TooShort { .. } => "curve-too-few-points",
        _ => "surface-wrong",
    };
    Fail::new(code, error.to_string())
}
