//! `read_mesh`: a mesh from an OBJ file.

use crate::io::read_obj;
use crate::value::V;
use tenon_engine::{Fail, NodeType, Port, Text, Unit};
use tenon_geometry::mesh::Mesh;

pub(super) fn node() -> NodeType {
    NodeType::new("read_mesh", 1)
        .name("Read mesh")
        .category("Mesh")
        .doc("Reads vertices and polygons of a Wavefront OBJ file. OBJ files have no unit: say how long one of theirs is.")
        .keywords(&["obj", "import", "file"])
        .input(Port::item::<Text>("path").file().doc("The OBJ file, relative to the graph."))
        .input(Port::item::<f64>("unit").unit(Unit::Length).range(1e-6, 1e9).default(1.0).doc("Length of one unit of the file: 1000 mm for metres."))
        .output(Port::item::<V<Mesh>>("mesh").doc("The mesh."))
        .run(|c| {
            let bytes = c.file("path")?;
            let mesh = read_obj(&bytes, c.number("unit")?)
                .map_err(|e| Fail::new("bad-obj", format!("{}: {e}", c.text("path").unwrap_or_default())).port("path"))?;
            c.set("mesh", V::new(mesh));
            Ok(())
        })
}
