//! `thicken`: faces become panels.

use crate::mesh::mesh_fail;
use crate::value::{V, Vector, with_address};
use tenon_engine::{Call, Fail, NodeType, Port, Text, Unit};
use tenon_geometry::mesh::Mesh;
use tenon_geometry::panel::{
    BorderCut, BorderRule, Nodes, PanelIssue, PanelSet, ThickenError, ThickenParams, thicken_while,
};

/// Sides with their three ports: how, limit plane, angle.
const SIDES: [(&str, &str, &str, &str); 5] = [
    ("bottom", "bottom_plane", "bottom_angle", "the bottom edges (v1 v2 of row 0)"),
    ("right", "right_plane", "right_angle", "the right edges (v2 v3 of the last column)"),
    ("top", "top_plane", "top_angle", "the top edges (v3 v4 of the last row)"),
    ("left", "left_plane", "left_angle", "the left edges (v4 v1 of column 0)"),
    ("other", "other_plane", "other_angle", "border edges of a mesh that is no ordered grid"),
];

pub(super) fn node() -> NodeType {
    let mut node = NodeType::new("thicken", 1)
        .name("Thicken")
        .category("Panel")
        .doc(
            "Makes a panel of every planar face: the back face is parallel at the thickness, inner edges are chamfered in \
             the bisector plane, border edges as asked, and nodes whose corners would collide are voided. A face that \
             cannot become a panel stays empty at its place and says why. (000 §6.3)",
        )
        .keywords(&["offset", "chamfer", "bisector", "plate", "solid"])
        .input(Port::item::<V<Mesh>>("mesh").doc("Planar faces; ordered, if sides are to be told apart."))
        .input(Port::item::<f64>("thickness").unit(Unit::Length).range(1e-3, 1e4).default(10.0).doc("Thickness of the panels. The wood lies behind the faces."));
    for (how, plane, angle, which) in SIDES {
        node = node
            .input(
                Port::item::<Text>(how)
                    .choices(&["square", "plane", "angle"])
                    .default("square")
                    .doc(format!("How {which} are cut: square to the face, in a limit plane, or leaning by an angle.")),
            )
            .input(
                Port::item::<Vector>(plane)
                    .default([0.0, 0.0, 1.0])
                    .doc(format!("Normal of the limit plane of {which}: [0, 0, 1] cuts horizontally.")),
            )
            .input(
                Port::item::<f64>(angle)
                    .unit(Unit::Angle)
                    .range(-89.0, 89.0)
                    .default(0.0)
                    .doc(format!("Lean of {which} from square; positive takes wood away.")),
            );
    }
    node.input(Port::item::<Text>("nodes").choices(&["void", "keep"]).default("void").doc("Nodes that are not conical: void them, or keep every panel's own corner (panels then overlap: for study only)."))
        .input(Port::item::<f64>("planar_within").unit(Unit::Length).range(0.0, 1e3).default(1e-4).doc("Faces further from planar than this are reported."))
        .input(Port::item::<f64>("project_up_to").unit(Unit::Length).range(0.0, 1e3).default(0.1).doc("Faces up to this far from planar are projected to their plane; beyond it is an error."))
        .output(Port::item::<V<PanelSet>>("panels").doc("The panels, one per face, at the face's index."))
        .output(Port::item::<f64>("area").unit(Unit::Area).doc("Net area of all front faces."))
        .output(Port::item::<i64>("voided").unit(Unit::Count).doc("Voided panel corners."))
        .run(run)
}

fn run(c: &mut Call) -> Result<(), Fail> {
    let mut params = ThickenParams::new(c.number("thickness")?);
    let [bottom, right, top, left, other] = [0, 1, 2, 3, 4].map(|side| cut(c, side));
    params.border =
        BorderRule { bottom: bottom?, right: right?, top: top?, left: left?, other: other?, edges: Vec::new() };
    params.nodes = if c.text("nodes")? == "keep" { Nodes::Keep } else { Nodes::Void };
    params.planar_within = c.number("planar_within")?;
    params.project_up_to = c.number("project_up_to")?;
    let monitor = c.monitor();
    let made = thicken_while(c.item::<V<Mesh>>("mesh")?, &params, &|| !monitor.cancelled());
    let (panels, issues) = made.map_err(|e| thicken_fail(&e))?;
    if !panels.is_empty() && issues.iter().filter(|i| i.is_fatal()).count() == panels.len() {
        // Nothing is left to go on with: the first reason is the node's error, the others are reported beside it.
        for issue in &issues[1..] {
            c.report(issue_fail(&panels, issue));
        }
        return Err(issue_fail(&panels, &issues[0]));
    }
    for issue in &issues {
        if issue.is_fatal() { c.report(issue_fail(&panels, issue)) } else { c.warn(issue_fail(&panels, issue)) }
    }
    c.set("area", panels.net_front_area());
    c.set("voided", panels.voided.iter().filter(|v| **v).count() as i64);
    c.set("panels", V::new(panels));
    Ok(())
}

fn cut(c: &Call, side: usize) -> Result<BorderCut, Fail> {
    let (how, plane, angle, _) = SIDES[side];
    Ok(match c.text(how)? {
        "plane" => {
            let normal = c.item::<Vector>(plane)?.0;
            if normal.try_normalize().is_none() {
                return Err(
                    Fail::new("zero-vector", "the normal of a limit plane must not be the zero vector").port(plane)
                );
            }
            BorderCut::InPlane { normal }
        }
        "angle" => BorderCut::Angle(c.number(angle)?.to_radians()),
        _ => BorderCut::Square,
    })
}

fn issue_fail(panels: &PanelSet, issue: &PanelIssue) -> Fail {
    let (code, port) = match issue {
        PanelIssue::NoArea { .. } => ("face-no-area", "mesh"),
        PanelIssue::ShortEdge { .. } => ("face-short-edge", "mesh"),
        PanelIssue::Concave { .. } => ("face-concave", "mesh"),
        PanelIssue::CrossesItself { .. } => ("face-crosses-itself", "mesh"),
        PanelIssue::Slope { .. } | PanelIssue::NotPlanar { .. } => ("face-not-planar", "mesh"),
        PanelIssue::Projected { .. } => ("face-projected", "mesh"),
        PanelIssue::SharpNode { .. } => ("node-too-sharp", "mesh"),
        PanelIssue::Fold { .. } => ("fold-too-sharp", "mesh"),
        PanelIssue::BorderLean { .. } => ("border-cut-too-flat", "mesh"),
        PanelIssue::OffsetFlips { .. } => ("thickness-flips-face", "thickness"),
    };
    Fail::new(code, with_address(panels, issue.face(), issue)).port(port).item(issue.face() as usize)
}

fn thicken_fail(error: &ThickenError) -> Fail {
    match error {
        ThickenError::Mesh(e) => mesh_fail(e),
        ThickenError::Cancelled => Fail::cancelled(),
        ThickenError::Thickness(_) => Fail::new("out-of-range", error.to_string()).port("thickness"),
        _ => Fail::new("bad-parameter", error.to_string()),
    }
}
