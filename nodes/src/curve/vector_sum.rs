//! `vector_sum`: the surface of all sums of two curves.

use super::surface_fail;
use crate::value::{Point, V};
use tenon_engine::{NodeType, Port};
use tenon_geometry::ifs::Curve;
use tenon_geometry::mesh::Mesh;
use tenon_geometry::surface::vector_sum;

pub(super) fn node() -> NodeType {
    NodeType::new("vector_sum", 1)
        .name("Vector sum")
        .category("Surface")
        .doc(
            "The mesh M_ij = A_i + B_j − c of two curves, summed in homogeneous coordinates: its faces are planar \
             wherever W_A + W_B exceeds 1. Columns follow A, rows follow B; closed curves close the mesh. (000 §4.3)",
        )
        .keywords(&["translation surface", "sweep", "planar quads"])
        .input(Port::item::<V<Curve>>("a").doc("First curve: columns."))
        .input(Port::item::<V<Curve>>("b").doc("Second curve: rows."))
        .input(
            Port::item::<Point>("centre")
                .default([0.0, 0.0, 0.0])
                .doc("The point c that is taken away: where both curves meet."),
        )
        .output(Port::item::<V<Mesh>>("mesh").doc("Planar quads in rows and columns, with addresses."))
        .run(|c| {
            let (a, b) = (c.item::<V<Curve>>("a")?, c.item::<V<Curve>>("b")?);
            let monitor = c.monitor();
            let mesh = vector_sum(a, b, c.item::<Point>("centre")?.0, &|f| monitor.progress(f))
                .map_err(|e| surface_fail(&e))?;
            c.set("mesh", V::new(mesh));
            Ok(())
        })
}
