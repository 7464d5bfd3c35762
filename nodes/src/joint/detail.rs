//! `detail`: fasteners along edges. The node is the host's part of every fastener; what it lays is [`super::laid`]'s.

use super::laid;
use crate::plugin::fastener;
use crate::post::MachineFile;
use crate::value::{V, Vector, with_address};
use std::sync::LazyLock;
use tenon_engine::{Call, Fail, NodeType, Port, Text, Unit};
use tenon_geometry::board::Up;
use tenon_geometry::joint::{EdgeSelection, FeatureSet, Head, OutOfReach, ReachRule, check_reach};
use tenon_geometry::panel::PanelSet;
use tenon_plugin::load::{LoadFault, Plugin};

pub(crate) fn node() -> NodeType {
    let length = |name: &'static str, default: f64, doc: &'static str| {
        Port::item::<f64>(name).unit(Unit::Length).range(0.0, 1e4).default(default).doc(doc)
    };
    NodeType::new("detail", 1)
        .name("Detail")
        .category("Joint")
        .doc(
            "Lays fasteners along edges by a rule, once per edge, so that the holes of both panels meet on one axis; checks \
             the wood around them and whether the machine reaches them; counts the hardware. (000 §6.4)",
        )
        .keywords(&["screw", "toe screw", "dowel", "fastener", "joint", "holes", "hardware"])
        .input(Port::item::<V<PanelSet>>("panels").doc("The panels."))
        .input(Port::item::<Text>("kind").choices(&["toe screw", "toe dowel", "screw", "dowel"]).default("toe screw").doc(
            "Toe screw, toe dowel: from one face obliquely through the chamfer into the neighbour, also in thin panels. \
             Screw, dowel: straight through both chamfers, for thick panels.",
        ))
        .input(Port::item::<V<MachineFile>>("machine").optional().doc("The machine that drills; without it reach is not checked here (the proof does)."))
        .input(Port::item::<Text>("out_of_reach").choices(&["refuse", "by hand"]).default("refuse").doc("What is done with holes that the machine cannot reach: an error, or a line on the list of hand work."))
        .input(Port::item::<Text>("edges").choices(&["all", "inner", "border", "along rows", "across rows"]).default("inner").doc("Which edges."))
        .input(Port::item::<Text>("up").choices(&["front", "back"]).default("back").doc("The face that lies up on the machine; the same as for map. Toe screws are driven from it."))
        .input(Port::item::<Text>("head").choices(&["lower address", "higher address", "alternate"]).default("alternate").doc("Which of the two panels is the first: it holds the head."))
        .input(length("spacing", 150.0, "Greatest distance between fasteners along an edge."))
        .input(length("end_distance", 40.0, "Distance of the outermost fasteners from the ends of their line."))
        .input(length("least_spacing", 20.0, "An edge that leaves less for two fasteners counts as short."))
        .input(Port::item::<Text>("short_edge").choices(&["middle", "nothing"]).default("middle").doc("What a short edge gets: one fastener in the middle, or none."))
        .input(Port::item::<f64>("height").unit(Unit::Ratio).range(-1.0, 1.0).default(0.5).doc("Height of the fastener line on the chamfer: 0 at the front edge, 1 at the back edge; -1: where most wood remains."))
        .input(Port::item::<f64>("angle").unit(Unit::Angle).range(-89.0, 89.0).default(45.0).doc("Angle between fastener and face in the plane normal to the edge."))
        .input(Port::item::<Text>("direction").choices(&["chamfer normal", "section", "given"]).default("chamfer normal").doc("Screws and dowels: perpendicular to the chamfer, at angle to the face, or along vector."))
        .input(Port::item::<Vector>("vector").default([0.0, 0.0, 1.0]).doc("The given direction, in the model."))
        .input(length("hole", 3.0, "Diameter of the holes."))
        .input(length("diameter", 3.5, "Diameter of the fastener."))
        .input(length("length", 0.0, "Length of the fastener; 0: the longest trade length that fits (toe screws and toe dowels)."))
        .input(length("depth", 20.0, "Depth of the hole in the second panel (toe screws and toe dowels, which stop short of the far face by the cover), or in both."))
        .input(length("least_depth", 2.0, "Toe screws and toe dowels: least depth of the hole in the second panel."))
        .input(length("cover", 1.0, "Least wood between a hole and any face that it does not go through."))
        .output(Port::item::<V<FeatureSet>>("features").doc("Holes on both panels of every edge, and the hardware."))
        .output(Port::item::<i64>("count").unit(Unit::Count).doc("Number of fasteners."))
        .run(run)
}

fn run(c: &mut Call) -> Result<(), Fail> {
    match &*BUILT_IN {
        Ok(plugin) => plugin.nodes.iter().try_for_each(|node| fastener::run(c, node)),
        Err(e) => Err(Fail::new("plugin-fault", e.to_string())),
    }
}

/// The fastener itself, which knows no more than a plugin's.
static BUILT_IN: LazyLock<Result<Plugin, LoadFault>> = LazyLock::new(|| Plugin::built_in(laid::plugin()));

/// Sorts out what the machine cannot reach, if there is one at "machine", as "out_of_reach" says.
pub(crate) fn reached(c: &mut Call, panels: &PanelSet, features: FeatureSet) -> Result<FeatureSet, Fail> {
    let Some(machine) = c.optional::<V<MachineFile>>("machine") else { return Ok(features) };
    let monitor = c.monitor();
    let by_hand = c.text("out_of_reach")? == "by hand";
    let reach = ReachRule {
        out_of_reach: if by_hand { OutOfReach::ByHand } else { OutOfReach::Refuse },
        ..ReachRule::new(up(c)?)
    };
    let (features, issues) = check_reach(panels, features, &machine.machine, &reach, &|| !monitor.cancelled());
    if c.cancelled() {
        return Err(Fail::cancelled());
    }
    for issue in &issues {
        let message = with_address(panels, issue.panel, issue);
        let fail = Fail::new("feature-out-of-reach", message).port("machine").item(issue.panel as usize);
        if issue.by_hand { c.warn(fail) } else { c.report(fail) }
    }
    Ok(features)
}

/// Which edges "edges" says.
pub(crate) fn edges(c: &Call) -> Result<EdgeSelection, Fail> {
    Ok(match c.text("edges")? {
        "all" => EdgeSelection::All,
        "border" => EdgeSelection::Border,
        "along rows" => EdgeSelection::AlongRows,
        "across rows" => EdgeSelection::AcrossRows,
        _ => EdgeSelection::Inner,
    })
}

/// Which panel a text at "head" says.
pub(crate) fn head(text: &str) -> Head {
    match text {
        "lower address" => Head::LowerAddress,
        "higher address" => Head::HigherAddress,
        _ => Head::Alternate,
    }
}

fn up(c: &Call) -> Result<Up, Fail> {
    Ok(if c.text("up")? == "front" { Up::Front } else { Up::Back })
}
