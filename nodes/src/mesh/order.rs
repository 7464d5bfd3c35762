//! `order_faces`: rows, columns and addresses.

use super::mesh_fail;
use crate::value::{Point, V, Vector};
use tenon_engine::{Column, Fail, NodeType, Path, Port, Text, Tree, Unit};
use tenon_geometry::mesh::{FaceKind, Front, Mesh, OrderKind, OrderParams, Start, order_faces};

pub(super) fn node() -> NodeType {
    NodeType::new("order_faces", 1)
        .name("Order faces")
        .category("Mesh")
        .doc(
            "Brings the faces of any quad mesh into rows and columns: welds vertices, turns faces until they agree, \
             finds neighbours through shared vertices and gives every face its address. Rows start at the bottom left \
             corner; edges are then bottom, right, top, left.",
        )
        .keywords(&["address", "sort", "weld", "neighbours", "grid"])
        .input(Port::item::<V<Mesh>>("mesh").doc("The mesh, in any order."))
        .input(
            Port::item::<f64>("weld")
                .unit(Unit::Length)
                .range(0.0, 1e6)
                .default(1e-3)
                .doc("Vertices within this distance are one."),
        )
        .input(
            Port::item::<Vector>("front")
                .optional()
                .doc("Direction that fronts should face; without it most faces decide."),
        )
        .input(
            Port::item::<Point>("start")
                .optional()
                .doc("Rows start at the corner nearest to this point; without it at the lowest x + y + z."),
        )
        .output(Port::item::<V<Mesh>>("mesh").doc("The mesh in order, with addresses."))
        .output(Port::list::<Text>("kinds").doc("Per face: corner, border or centre."))
        .output(Port::tree::<i64>("neighbours").doc(
            "Per face a branch with the face across each of its edges (bottom, right, top, left); empty on the border.",
        ))
        .output(
            Port::item::<Text>("order")
                .doc("Where the addresses come from: grid, closed grid, patches, kept, or plain."),
        )
        .run(|c| {
            let front = match c.optional::<Vector>("front") {
                Some(v) if v.0.length_squared() == 0.0 => {
                    return Err(
                        Fail::new("zero-vector", "the front direction must not be the zero vector").port("front")
                    );
                }
                Some(v) => Front::Facing(v.0),
                None => Front::AsGiven,
            };
            let start = c.optional::<Point>("start").map_or(Start::Lowest, |p| Start::Near(p.0));
            let params = OrderParams { weld: c.number("weld")?, front, start };
            let ordered = order_faces(c.item::<V<Mesh>>("mesh")?, &params).map_err(|e| mesh_fail(&e))?;
            if !ordered.flipped.is_empty() {
                c.note(
                    Fail::new(
                        "faces-turned",
                        format!("{} faces were turned over to agree with the others", ordered.flipped.len()),
                    )
                    .port("mesh"),
                );
            }
            if !ordered.collapsed.is_empty() {
                c.warn(
                    Fail::new(
                        "faces-collapsed",
                        format!(
                            "welding collapsed and dropped {} faces, the first is face {}",
                            ordered.collapsed.len(),
                            ordered.collapsed[0]
                        ),
                    )
                    .port("weld"),
                );
            }
            let order = match ordered.kind {
                OrderKind::Kept => "kept",
                OrderKind::Grid => "grid",
                OrderKind::ClosedGrid => "closed grid",
                OrderKind::Patches => "patches",
                OrderKind::PlainNotQuads => "plain: not all faces are quads",
                OrderKind::PlainNoRows => "plain: the quads form no rows",
            };
            let kinds = ordered.face_kind.iter().map(|k| {
                Text::from(match k {
                    FaceKind::Corner => "corner",
                    FaceKind::Border => "border",
                    FaceKind::Centre => "centre",
                })
            });
            let kinds = kinds.collect();
            c.set_list("kinds", kinds);
            let across = |f: usize| {
                let faces = ordered.adjacency.neighbours(f as u32).map(|n| n.map(i64::from)).collect();
                (Path::new(vec![f as i32]), Column::with_gaps::<i64>(faces))
            };
            c.set_tree("neighbours", Tree::from_branches((0..ordered.mesh.face_count()).map(across).collect()));
            c.set("order", Text::from(order));
            c.set("mesh", V::new(ordered.mesh));
            Ok(())
        })
}
