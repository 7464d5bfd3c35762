//! A fastener of a plugin as a node: the inputs that every fastener has are those of `detail`; the plugin gets the panels
//! and the edges selected for it, and what it gives is checked against panels and machine.

use super::node::{Collected, arriving, evaluate, fault};
use crate::exchange;
use crate::joint::detail;
use crate::value::{V, with_address};
use std::borrow::Cow;
use tenon_engine::{Call, Fail, NodeType, Port, Text, Tree, Unit};
use tenon_geometry::DVec3;
use tenon_geometry::joint::{FeatureSet, JointEdge, Misplaced, select_edges, take_misplaced};
use tenon_geometry::panel::{EdgeRef, PanelSet};
use tenon_plugin::abi::plugin::TENON_ITEM;
use tenon_plugin::abi::value::{TENON_FEATURES, TENON_TEXT, tenon_edge, tenon_edge_pair};
use tenon_plugin::load::{PluginNode, PortInfo};
use tenon_plugin::value::{Branch, Items};

/// How far outside its panel a feature may be given, mm: a hole through a chamfer begins beside it.
const TOLERANCE: f64 = 1.0;

/// The inputs that a fastener has besides its own.
pub(super) fn standard_inputs(mut t: NodeType) -> NodeType {
    let built_in = detail::node();
    for name in ["panels", "edges", "head", "machine", "out_of_reach", "up"] {
        if let Some(port) = built_in.inputs().iter().find(|p| p.name() == name) {
            t = t.input(port.clone());
        }
    }
    t
}

/// The inputs that a fastener declares and that are not the host's already. Its own "head" is the host's, which it sees.
pub(super) fn own_inputs(node: &PluginNode) -> Result<impl Iterator<Item = &PortInfo>, String> {
    match node.inputs.iter().find(|p| p.name == "head") {
        Some(p) if (p.kind, p.access) != (TENON_TEXT, TENON_ITEM) => {
            Err("a fastener's \"head\" is the host's: one text, by which panel is the first".into())
        }
        _ => Ok(node.inputs.iter().filter(|p| p.name != "head")),
    }
}

/// The outputs of every fastener.
pub(super) fn outputs(t: NodeType) -> NodeType {
    t.output(Port::item::<V<FeatureSet>>("features").doc("Features on both panels of every edge, and the hardware."))
        .output(Port::item::<i64>("count").unit(Unit::Count).doc("Number of purchased parts."))
}

fn pair(e: &JointEdge) -> tenon_edge_pair {
    let edge = |e: EdgeRef| tenon_edge { panel: e.panel, edge: e.edge };
    let v = |p: DVec3| bytemuck::cast(p);
    let second = e.second.map_or(tenon_edge::NONE, edge);
    tenon_edge_pair { first: edge(e.first), second, start: v(e.start), end: v(e.end), angle: e.angle }
}

pub(crate) fn run(c: &mut Call<'_>, node: &PluginNode) -> Result<(), Fail> {
    let panels = c.item::<V<PanelSet>>("panels")?;
    let selected = select_edges(panels, detail::edges(c)?, detail::head(c.text("head")?));
    let edges: Vec<tenon_edge_pair> = selected.iter().map(pair).collect();
    let mut trees = vec![Tree::item(panels.clone()), Tree::default(), Tree::item(Text::from(c.text("up")?))];
    for info in &node.inputs {
        trees.push(arriving(c, info)?);
    }
    let mut inputs: Vec<Vec<Branch<'_>>> = trees.iter().map(exchange::branches).collect();
    inputs[1] = vec![Branch::root(Items::Edges(Cow::Borrowed(&edges)))];
    let output = [PortInfo {
        name: "features".into(),
        doc: String::new(),
        kind: TENON_FEATURES,
        access: TENON_ITEM,
        unit: String::new(),
        default_json: String::new(),
        range: None,
        choices: Vec::new(),
        optional: false,
    }];
    let mut sink = Collected::new(&output, &trees);
    evaluate(c, node, &inputs, &mut sink)?;
    let given = sink.values.pop().flatten();
    let Some(given) = given.as_ref().and_then(|tree| tree.first::<V<FeatureSet>>()) else {
        return Err(fault(node, "it ended well without setting its features"));
    };
    let mut features = FeatureSet::clone(given);
    for issue in take_misplaced(panels, &selected, &mut features, TOLERANCE) {
        let code = match issue {
            Misplaced::Outside { .. } => "feature-outside-panel",
            Misplaced::Unselected { .. } => "feature-off-edges",
            Misplaced::Panel { .. } | Misplaced::Edge { .. } => "plugin-fault",
        };
        let message = with_address(panels, issue.panel(), &issue);
        c.report(Fail::new(code, message).port("panels").item(issue.panel() as usize));
    }
    let features = detail::reached(c, panels, features)?;
    c.set("count", features.hardware.iter().map(|h| h.count as i64).sum::<i64>());
    c.set("features", V::new(features));
    Ok(())
}
