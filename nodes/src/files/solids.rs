//! `write_obj`, `write_panels`: geometry for other programs.

use super::{set_file, writer};
use crate::io::{write_obj, write_panels_obj};
use crate::value::V;
use tenon_engine::{NodeType, Port};
use tenon_geometry::mesh::Mesh;
use tenon_geometry::panel::PanelSet;

pub(super) fn nodes() -> Vec<NodeType> {
    vec![
        writer("write_obj", "Write OBJ", "mesh.obj")
            .doc("Writes a mesh as Wavefront OBJ, in mm.")
            .keywords(&["export", "mesh"])
            .input(Port::item::<V<Mesh>>("mesh").doc("The mesh."))
            .run(|c| {
                let monitor = c.monitor();
                let bytes = write_obj(c.item::<V<Mesh>>("mesh")?, &|| !monitor.cancelled());
                set_file(c, bytes)
            }),
        writer("write_panels", "Write panels", "panels.obj")
            .doc("Writes every panel as a closed solid of its own, named by its address, as Wavefront OBJ in mm.")
            .keywords(&["export", "solids", "obj"])
            .input(Port::item::<V<PanelSet>>("panels").doc("The panels."))
            .run(|c| {
                let monitor = c.monitor();
                let bytes = write_panels_obj(c.item::<V<PanelSet>>("panels")?, &|| !monitor.cancelled());
                set_file(c, bytes)
            }),
    ]
}
