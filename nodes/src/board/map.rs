//! `map`: panels to the machine plane.

use crate::value::{V, Vector, with_address};
use tenon_engine::{Call, Fail, NodeType, Port, Text, Unit};
use tenon_geometry::board::{AddressMark, Align, FixingHoles, GrainAxis, MapIssue, MapParams, PartSet, Up, map_parts};
use tenon_geometry::joint::FeatureSet;
use tenon_geometry::panel::PanelSet;

pub(super) fn node() -> NodeType {
    let (fixing, address) = (FixingHoles::default(), AddressMark::default());
    let length = |name: &'static str, default: f64, doc: &'static str| {
        Port::item::<f64>(name).unit(Unit::Length).range(0.0, 1e4).default(default).doc(doc)
    };
    NodeType::new("map", 1)
        .name("Map")
        .category("Board")
        .doc(
            "Lays every panel into the machine plane by a rigid motion (never a mirror), with its features, and adds fixing \
             holes and the address to be engraved. (000 §7.1)",
        )
        .keywords(&["orient", "lay flat", "grain", "address", "engraving", "fixing"])
        .input(Port::item::<V<PanelSet>>("panels").doc("The panels."))
        .input(Port::list::<V<FeatureSet>>("features").optional().doc("Features on them; wires from several details add up."))
        .input(Port::item::<Text>("align").choices(&["first edge", "last edge", "grain"]).default("first edge").doc("What lies along the board's grain: the bottom edge v1 v2, the left edge v1 v4, or a direction in the model."))
        .input(Port::item::<Vector>("grain").default([1.0, 0.0, 0.0]).doc("The direction in the model, if align is grain; it is projected to each face."))
        .input(Port::item::<Text>("axis").choices(&["x", "y"]).default("x").doc("The board's grain axis."))
        .input(Port::item::<Text>("up").choices(&["front", "back"]).default("back").doc("Which face lies up."))
        .input(Port::item::<i64>("fixing_holes").unit(Unit::Count).range(0.0, 16.0).default(fixing.count).doc("Holes by which each part is screwed to the table."))
        .input(length("fixing_diameter", fixing.diameter, "Diameter of fixing holes."))
        .input(length("fixing_edge", fixing.edge, "Least wood between a fixing hole and a chamfer."))
        .input(length("address_height", address.height, "Height of the engraved address, smaller where the face is small; 0: none."))
        .input(length("address_depth", address.depth, "Depth of the engraved address."))
        .output(Port::item::<V<PartSet>>("parts").doc("Parts with all their features, in the machine plane."))
        .run(run)
}

fn run(c: &mut Call) -> Result<(), Fail> {
    let features = FeatureSet::merged(c.list::<V<FeatureSet>>("features")?.iter().map(|f| &**f));
    let height = c.number("address_height")?;
    let fixing = FixingHoles {
        count: c.integer("fixing_holes")? as u32,
        diameter: c.number("fixing_diameter")?,
        edge: c.number("fixing_edge")?,
        ..FixingHoles::default()
    };
    let address = AddressMark { height, depth: c.number("address_depth")?, ..AddressMark::default() };
    let params = MapParams {
        align: match c.text("align")? {
            "last edge" => Align::LastEdge,
            "grain" => Align::Grain(c.item::<Vector>("grain")?.0),
            _ => Align::FirstEdge,
        },
        axis: if c.text("axis")? == "y" { GrainAxis::Y } else { GrainAxis::X },
        up: if c.text("up")? == "front" { Up::Front } else { Up::Back },
        fixing: Some(fixing).filter(|f| f.count > 0),
        address: Some(address).filter(|a| a.height > 0.0),
    };
    let monitor = c.monitor();
    let (parts, issues) = map_parts(c.item::<V<PanelSet>>("panels")?, &features, &params, &|| !monitor.cancelled());
    if c.cancelled() {
        return Err(Fail::cancelled());
    }
    for issue in &issues {
        let (panel, code) = match issue {
            MapIssue::NoDirection { panel, .. } => (*panel, "map-no-direction"),
            MapIssue::Mark { panel, .. } => (*panel, "mark-does-not-fit"),
        };
        c.warn(Fail::new(code, with_address(&parts.panels, panel, issue)).port("panels").item(panel as usize));
    }
    c.set("parts", V::new(parts));
    Ok(())
}
