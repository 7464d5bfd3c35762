//! `write_pieces`, `write_hardware`: lists for workshop and purchase.

use super::{set_file, writer};
use crate::io::{write_hardware_csv, write_pieces_csv, write_pieces_json};
use crate::value::V;
use tenon_engine::{Fail, NodeType, Port, Text};
use tenon_geometry::board::{Layout, PartSet};
use tenon_geometry::joint::FeatureSet;

pub(super) fn nodes() -> Vec<NodeType> {
    vec![
        writer("write_pieces", "Write piece list", "pieces.csv")
            .doc("One line per piece: address, board, place, area, volume, edges, chamfer angles, neighbours, holes.")
            .keywords(&["csv", "json", "bill of quantities", "export"])
            .input(Port::item::<V<PartSet>>("parts").doc("The mapped parts."))
            .input(Port::item::<V<Layout>>("layout").doc("Where they lie."))
            .input(
                Port::item::<Text>("format")
                    .choices(&["csv", "json"])
                    .default("csv")
                    .doc("A table for people, or JSON with everything."),
            )
            .run(|c| {
                let (parts, layout) = (c.item::<V<PartSet>>("parts")?, c.item::<V<Layout>>("layout")?);
                let bytes = if c.text("format")? == "json" {
                    write_pieces_json(parts, layout)
                } else {
                    write_pieces_csv(parts, layout)
                };
                set_file(c, bytes.map_err(|e| Fail::new("layout-of-other-parts", e.to_string()).port("layout"))?)
            }),
        writer("write_hardware", "Write hardware list", "hardware.csv")
            .doc("Purchased parts and how many.")
            .keywords(&["csv", "screws", "dowels", "export"])
            .input(Port::item::<V<FeatureSet>>("features").doc("Features with their hardware."))
            .run(|c| {
                let bytes = write_hardware_csv(c.item::<V<FeatureSet>>("features")?);
                set_file(c, bytes)
            }),
    ]
}
