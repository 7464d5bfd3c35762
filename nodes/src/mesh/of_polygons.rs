//! `mesh_polygons`: a mesh whose faces are drawn as outlines.

use super::mesh_fail;
use crate::value::V;
use tenon_engine::{Fail, NodeType, Port, Unit};
use tenon_geometry::mesh::{Mesh, weld};
use tenon_geometry::polygon::Polygon;

pub(super) fn node() -> NodeType {
    NodeType::new("mesh_polygons", 1)
        .name("Mesh from polygons")
        .category("Mesh")
        .doc(
            "A mesh with one face per polygon; closed curves turn into polygons by themselves. Corners that lie within the \
             welding distance become one vertex, so that faces which touch are neighbours.",
        )
        .keywords(&["outline", "face", "boundary", "closed curve", "weld"])
        .input(Port::list::<V<Polygon>>("polygons").doc("One outline per face, all turning the same way round."))
        .input(
            Port::item::<f64>("weld")
                .unit(Unit::Length)
                .range(0.0, 1e6)
                .default(1e-3)
                .doc("Corners within this distance become one vertex."),
        )
        .output(Port::item::<V<Mesh>>("mesh").doc("The mesh; its faces in the order of the polygons."))
        .run(|c| {
            let polygons = c.list::<V<Polygon>>("polygons")?;
            let mut mesh = Mesh { face_start: vec![0].into(), ..Mesh::default() };
            for polygon in polygons {
                mesh.points.to_mut().extend_from_slice(polygon.corners());
                let corners = mesh.face_vertices.len() as u32..mesh.points.len() as u32;
                mesh.face_vertices.to_mut().extend(corners);
                mesh.face_start.to_mut().push(mesh.face_vertices.len() as u32);
            }
            let welded = weld(&mesh, c.number("weld")?).map_err(|e| mesh_fail(&e))?;
            for face in &welded.collapsed {
                let message = format!("polygon {face} has no area left after welding and is no face");
                c.warn(Fail::new("faces-collapsed", message).port("weld").item(*face as usize));
            }
            c.set("mesh", V::new(welded.mesh));
            Ok(())
        })
}
