//! `write_dxf`, `write_svg`, `write_layout`: the packed boards as drawings and as data.

use super::{set_file, writer};
use crate::io::{Drawing, draw, write_dxf, write_layout_json, write_svg};
use crate::value::V;
use tenon_engine::{Call, Fail, NodeType, Port, Text};
use tenon_geometry::DVec2;
use tenon_geometry::board::{Layout, PartSet};

pub(super) fn nodes() -> Vec<NodeType> {
    vec![
        inputs(writer("write_dxf", "Write DXF", "layout.dxf"))
            .doc("Draws the packed boards as DXF: boards, pieces, cleared outlines, holes and addresses on layers of their own.")
            .keywords(&["export", "drawing", "layout", "nesting"])
            .run(|c| {
                let drawing = drawing(c)?;
                let monitor = c.monitor();
                set_file(c, write_dxf(&drawing, &|| !monitor.cancelled()))
            }),
        inputs(writer("write_svg", "Write SVG", "layout.svg"))
            .doc("Draws the packed boards as SVG, to be looked at and printed.")
            .keywords(&["export", "drawing", "layout", "picture"])
            .input(Port::item::<Text>("grain").choices(&["x", "y", "none"]).default("x").doc("Direction of the boards' grain, drawn as an arrow."))
            .run(|c| {
                let drawing = drawing(c)?;
                let grain = match c.text("grain")? {
                    "x" => Some(DVec2::X),
                    "y" => Some(DVec2::Y),
                    _ => None,
                };
                let monitor = c.monitor();
                set_file(c, write_svg(&drawing, grain, &|| !monitor.cancelled()))
            }),
        inputs(writer("write_layout", "Write layout data", "layout.json"))
            .doc("Writes boards, places and outlines as JSON for other programs.")
            .keywords(&["export", "json", "nesting"])
            .run(|c| {
                let drawing = drawing(c)?;
                let monitor = c.monitor();
                set_file(c, write_layout_json(&drawing, &|| !monitor.cancelled()))
            }),
    ]
}

fn inputs(node: NodeType) -> NodeType {
    node.input(Port::item::<V<PartSet>>("parts").doc("The mapped parts."))
        .input(Port::item::<V<Layout>>("layout").doc("Where they lie."))
}

fn drawing(c: &Call) -> Result<Drawing, Fail> {
    draw(c.item::<V<PartSet>>("parts")?, c.item::<V<Layout>>("layout")?)
        .map_err(|e| Fail::new("layout-of-other-parts", e.to_string()).port("layout"))
}
