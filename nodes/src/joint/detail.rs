//! `detail`: fasteners along edges.

use crate::post::MachineFile;
use crate::value::{V, Vector, with_address};
use tenon_engine::{Call, Fail, NodeType, Port, Text, Unit};
use tenon_geometry::board::Up;
use tenon_geometry::joint::{
    Direction, EdgeSelection, Fastener, FastenerError, FastenerRule, FeatureSet, Head, Height, JointIssue, OutOfReach,
    Pin, PinKind, ReachRule, ShortEdge, Toe, ToeLength, check_reach, lay_all,
};
use tenon_geometry::panel::PanelSet;

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
    let rule = rule(c)?;
    let panels = c.item::<V<PanelSet>>("panels")?;
    let monitor = c.monitor();
    let laid = lay_all(panels, std::slice::from_ref(&rule), &|| !monitor.cancelled());
    let (features, issues) = laid.map_err(|e| rule_fail(&e))?;
    for issue in &issues {
        if issue.is_fatal() { c.report(issue_fail(panels, issue)) } else { c.warn(issue_fail(panels, issue)) }
    }
    let features = reached(c, panels, features)?;
    c.set("count", features.hardware.iter().map(|h| h.count as i64).sum::<i64>());
    c.set("features", V::new(features));
    Ok(())
}

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

fn rule(c: &Call) -> Result<FastenerRule, Fail> {
    let up = up(c)?;
    let angle = c.number("angle")?.to_radians();
    let (hole, diameter, length, depth) =
        (c.number("hole")?, c.number("diameter")?, c.number("length")?, c.number("depth")?);
    let kind = c.text("kind")?;
    let pin_kind = if kind.ends_with("dowel") { PinKind::Dowel } else { PinKind::Screw };
    let fastener = if kind.starts_with("toe") {
        let length = if length > 0.0 { ToeLength::Given(length) } else { ToeLength::Longest };
        let least_bite = c.number("least_depth")?;
        Fastener::Toe(Toe { kind: pin_kind, up, angle, hole, bite: depth, least_bite, diameter, length })
    } else {
        let direction = match c.text("direction")? {
            "section" => Direction::Section(angle),
            "given" => Direction::Given(c.item::<Vector>("vector")?.0),
            _ => Direction::ChamferNormal,
        };
        Fastener::Pin(Pin { kind: pin_kind, hole, depth: [depth; 2], direction, diameter, length })
    };
    let height = c.number("height")?;
    Ok(FastenerRule {
        edges: edges(c)?,
        fastener,
        head: head(c)?,
        height: if height < 0.0 { Height::Balanced } else { Height::At(height) },
        end_distance: c.number("end_distance")?,
        spacing: c.number("spacing")?,
        least_spacing: c.number("least_spacing")?,
        short_edge: if c.text("short_edge")? == "nothing" { ShortEdge::Nothing } else { ShortEdge::Middle },
        cover: c.number("cover")?,
        ..FastenerRule::toe_screws(up)
    })
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

/// Which panel "head" says.
pub(crate) fn head(c: &Call) -> Result<Head, Fail> {
    Ok(match c.text("head")? {
        "lower address" => Head::LowerAddress,
        "higher address" => Head::HigherAddress,
        _ => Head::Alternate,
    })
}

fn up(c: &Call) -> Result<Up, Fail> {
    Ok(if c.text("up")? == "front" { Up::Front } else { Up::Back })
}

fn issue_fail(panels: &PanelSet, issue: &JointIssue) -> Fail {
    let code = match issue {
        JointIssue::EdgeTooShort { .. } => "edge-too-short",
        JointIssue::ThinWood { .. } => "hole-thin-wood",
        JointIssue::TooDeep { .. } => "hole-too-deep",
        JointIssue::TooLong { .. } => "fastener-too-long",
        JointIssue::AlongChamfer { .. } => "fastener-along-chamfer",
        JointIssue::HolesMeet { .. } => "holes-meet",
    };
    let panel = issue.place().0;
    Fail::new(code, with_address(panels, panel, issue)).port("panels").item(panel as usize)
}

fn rule_fail(error: &FastenerError) -> Fail {
    match error {
        FastenerError::Cancelled => Fail::cancelled(),
        _ => Fail::new("bad-parameter", error.to_string()),
    }
}
