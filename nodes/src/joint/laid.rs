//! The built-in fasteners, screws and dowels, as a plugin that needs no library: panels, edges and measures come and features
//! go by the same contract, so whatever they can do a plugin can.

use super::detail::head;
use crate::exchange;
use crate::value::with_address;
use tenon_geometry::board::Up;
use tenon_geometry::joint::{
    Direction, Fastener, FastenerError, FastenerRule, Height, JointEdge, JointIssue, Pin, PinKind, ShortEdge, Toe,
    ToeLength, lay_edges,
};
use tenon_geometry::panel::{EdgeRef, PanelSet};
use tenon_plugin::abi::value::{tenon_edge, tenon_edge_pair};
use tenon_plugin::author::{Call, Fail, Node, Plugin, Port};

/// Makes the port of a name.
type Make = fn(&'static str) -> Port;

/// What it takes besides what every fastener gets. What they mean stands at the ports of `detail`.
const INPUTS: [(&str, Make); 16] = [
    ("kind", Port::text),
    ("head", Port::text),
    ("spacing", Port::number),
    ("end_distance", Port::number),
    ("least_spacing", Port::number),
    ("short_edge", Port::text),
    ("height", Port::number),
    ("angle", Port::number),
    ("direction", Port::text),
    ("vector", Port::vector),
    ("hole", Port::number),
    ("diameter", Port::number),
    ("length", Port::number),
    ("depth", Port::number),
    ("least_depth", Port::number),
    ("cover", Port::number),
];

pub(super) fn plugin() -> Plugin {
    let node = Node::fastener("tenon.detail", 1).name("Detail").doc("Lays screws and dowels along edges.");
    let node = INPUTS.iter().fold(node, |node, (name, kind)| node.input(kind(name).doc("As at the node.")));
    let doc = "The fasteners that Tenon brings.";
    Plugin::new("tenon", env!("CARGO_PKG_VERSION")).vendor("Tenon").doc(doc).node(node.run(run))
}

fn run(c: &mut Call<'_>) -> Result<(), Fail> {
    let rule = rule(c)?;
    let panels = exchange::panels(c.panels("panels")?).map_err(|why| Fail::new("plugin-fault", why))?;
    let edges: Vec<JointEdge> = c.edges()?.iter().map(edge).collect();
    let laid = lay_edges(&panels, &edges, &rule, &|| !c.cancelled());
    let (features, issues) = laid.map_err(|e| rule_fail(&e))?;
    for issue in &issues {
        if issue.is_fatal() { c.error(&issue_fail(&panels, issue)) } else { c.warn(&issue_fail(&panels, issue)) }
    }
    c.set_features("features", exchange::features(&features))
}

fn edge(pair: &tenon_edge_pair) -> JointEdge {
    let edge = |e: tenon_edge| EdgeRef { panel: e.panel, edge: e.edge };
    JointEdge {
        first: edge(pair.first),
        second: (pair.second != tenon_edge::NONE).then(|| edge(pair.second)),
        start: bytemuck::cast(pair.start),
        end: bytemuck::cast(pair.end),
        angle: pair.angle,
    }
}

fn rule(c: &Call<'_>) -> Result<FastenerRule, Fail> {
    let up = if c.text("up")? == "front" { Up::Front } else { Up::Back };
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
        let direction = match &*c.text("direction")? {
            "section" => Direction::Section(angle),
            "given" => Direction::Given(bytemuck::cast(c.vector("vector")?)),
            _ => Direction::ChamferNormal,
        };
        Fastener::Pin(Pin { kind: pin_kind, hole, depth: [depth; 2], direction, diameter, length })
    };
    let height = c.number("height")?;
    Ok(FastenerRule {
        fastener,
        head: head(&c.text("head")?),
        height: if height < 0.0 { Height::Balanced } else { Height::At(height) },
        end_distance: c.number("end_distance")?,
        spacing: c.number("spacing")?,
        least_spacing: c.number("least_spacing")?,
        short_edge: if c.text("short_edge")? == "nothing" { ShortEdge::Nothing } else { ShortEdge::Middle },
        cover: c.number("cover")?,
        ..FastenerRule::toe_screws(up)
    })
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
