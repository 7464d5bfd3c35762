//! Nodes on meshes: read, order, planarize.

mod of_polygons;
mod order;
mod planarize;
mod read;

use tenon_engine::{Fail, NodeType};
use tenon_geometry::mesh::MeshError;

pub(crate) fn nodes() -> Vec<NodeType> {
    vec![read::node(), of_polygons::node(), order::node(), planarize::node()]
}

/// A mesh error in the words of a diagnostic.
pub(crate) fn mesh_fail(error: &MeshError) -> Fail {
    let code = match error {
        MeshError::NotManifold { .. } => "mesh-not-manifold",
        MeshError::MixedOrientation { .. } => "mesh-mixed-orientation",
        MeshError::NotFinite { .. } => "not-finite",
        _ => "mesh-broken",
    };
    let fail = Fail::new(code, error.to_string()).port("mesh");
    match error {
        MeshError::MixedOrientation { .. } => fail.hint("order_faces turns faces over until they agree"),
        _ => fail,
    }
}
