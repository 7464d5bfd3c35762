//! `tensor_product`: a surface from a control grid.

use super::{scheme, surface_fail};
use crate::value::{Point, V};
use tenon_engine::{Call, Fail, NodeType, Port, Unit};
use tenon_geometry::ifs::MAX_ITERATIONS;
use tenon_geometry::mesh::Mesh;
use tenon_geometry::surface::{Direction, tensor_product, vector_sum_grid};

pub(super) fn node() -> NodeType {
    let mut node = NodeType::new("tensor_product", 1)
        .name("Tensor product")
        .category("Surface")
        .doc(
            "A surface subdivided by T_ij = T_i^A ⊗ T_j^B: from a control grid, or from two control polygons whose vector \
             sum is the grid. Its faces are in general not planar: planarize follows. (000 §5.4.1)",
        )
        .keywords(&["bezier surface", "b-spline surface", "control grid", "patch"])
        .input(Port::list::<Point>("points").doc("The control grid row by row (rows along A); or control polygon A, if points_b is given."))
        .input(Port::list::<f64>("weights").optional().doc("One weight per point of points; without any all are 1."))
        .input(Port::item::<i64>("row_length").unit(Unit::Count).range(0.0, 1e6).default(0).doc("Points per row of the grid; not needed with points_b."))
        .input(Port::list::<Point>("points_b").optional().doc("Control polygon B: the grid is then the vector sum of both polygons."))
        .input(Port::list::<f64>("weights_b").optional().doc("One weight per point of points_b; without any all are 1."))
        .input(Port::item::<Point>("centre").default([0.0, 0.0, 0.0]).doc("The point that the vector sum of two polygons takes away."));
    for suffix in ["_a", "_b"] {
        node = scheme::ports(node, suffix)
            .input(
                Port::item::<i64>(format!("iterations{suffix}"))
                    .unit(Unit::Count)
                    .range(0.0, f64::from(MAX_ITERATIONS))
                    .default(3)
                    .doc("Iterations in this direction."),
            )
            .input(
                Port::item::<bool>(format!("closed{suffix}"))
                    .default(false)
                    .doc("Whether the points go round in this direction."),
            );
    }
    node.output(Port::item::<V<Mesh>>("mesh").doc("Quads in rows and columns, with addresses.")).run(run)
}

fn run(c: &mut Call) -> Result<(), Fail> {
    let a = scheme::control(c, "points", "weights")?;
    let b = scheme::control(c, "points_b", "weights_b")?;
    let (grid, row_length) = if b.is_empty() {
        let row_length = c.integer("row_length")? as usize;
        if row_length == 0 {
            return Err(Fail::new("missing-input", "a control grid needs its row length")
                .port("row_length")
                .hint("or wire a second control polygon to points_b"));
        }
        (a, row_length)
    } else {
        let row_length = a.len();
        (vector_sum_grid(&a, &b, c.item::<Point>("centre")?.0), row_length)
    };
    let rows = grid.len() / row_length.max(1);
    let (chosen_a, chosen_b) = (scheme::chosen(c, "_a", row_length)?, scheme::chosen(c, "_b", rows)?);
    let monitor = c.monitor();
    let mesh = tensor_product(
        &grid,
        row_length,
        Direction {
            scheme: &chosen_a.scheme,
            iterations: c.integer("iterations_a")? as u32,
            shared: chosen_a.shared,
            closed: c.boolean("closed_a")?,
        },
        Direction {
            scheme: &chosen_b.scheme,
            iterations: c.integer("iterations_b")? as u32,
            shared: chosen_b.shared,
            closed: c.boolean("closed_b")?,
        },
        &|f| monitor.progress(f),
    )
    .map_err(|e| surface_fail(&e))?;
    c.set("mesh", V::new(mesh));
    Ok(())
}
