//! A fastener in Rust: cam connectors along edges. Each takes one round bore for its housing in either panel, drilled from
//! the face that lies up on the machine. See README.md.

use tenon_plugin::abi::value::{tenon_edge, tenon_edge_pair, tenon_vec3};
use tenon_plugin::author::{Call, Fail, Node, Plugin, Port};
use tenon_plugin::value::{Feature, Features, Machining, Panels};

fn plugin() -> Plugin {
    Plugin::new("cams", env!("CARGO_PKG_VERSION")).vendor("Tenon's examples").doc("Connectors that can be taken apart.").node(
        Node::fastener("cams.cam_connector", 1)
            .name("Cam connector")
            .doc("Cam connectors along edges: one bore for the housing in either panel, and the connector on the piece list.")
            .keywords("cam, bayonet, fastener")
            .input(Port::number("distance").unit("mm").range(50.0, 1e4).default(250).doc("Greatest distance between connectors."))
            .input(Port::number("setback").unit("mm").range(1.0, 1e3).default(24).doc("From the edge to the bore's centre."))
            .input(Port::number("diameter").unit("mm").range(5.0, 60.0).default(15).doc("Diameter of the housing."))
            .input(Port::number("depth").unit("mm").range(1.0, 100.0).default(7).doc("Depth of the bore."))
            .run(lay),
    )
}

tenon_plugin::export!(plugin);

fn lay(c: &mut Call<'_>) -> Result<(), Fail> {
    let panels = c.panels("panels")?;
    let back = c.text("up")? == "back";
    let (distance, setback) = (c.number("distance")?, c.number("setback")?);
    let (diameter, depth) = (c.number("diameter")?, c.number("depth")?);
    if depth >= panels.thickness {
        let message = format!("a bore of {depth} mm goes through panels of {} mm", panels.thickness);
        return Err(Fail::new("bore-too-deep", message).port("depth"));
    }
    let (mut features, mut joint) = (Vec::new(), 0);
    let edges = c.edges()?;
    for (i, edge) in edges.iter().enumerate() {
        c.progress(i as f64 / edges.len() as f64)?;
        let length = length(sub(edge.end, edge.start));
        if edge.second == tenon_edge::NONE {
            continue;
        }
        let count = (length / distance).ceil().max(1.0) as u32;
        for k in 0..count {
            let t = (f64::from(k) + 0.5) / f64::from(count);
            let [first, second] = places(&panels, edge, back, t, setback);
            for (panel_edge, (entry, axis)) in [(edge.first, first), (edge.second, second)] {
                features.push(Feature {
                    panel: panel_edge.panel,
                    edge: Some(panel_edge.edge),
                    joint: Some(joint),
                    by_hand: false,
                    purpose: "cam".into(),
                    machining: Machining::Drill { entry, axis, depth, diameter },
                });
            }
            joint += 1;
        }
    }
    let hardware =
        if joint > 0 { vec![(format!("Cam connector {diameter}").into(), joint.into())] } else { Vec::new() };
    c.set_features("features", Features { features, hardware })
}

/// Where the bores of both panels begin, at `t` of the edge, and their directions into the wood.
fn places(
    panels: &Panels<'_>,
    edge: &tenon_edge_pair,
    back: bool,
    t: f64,
    setback: f64,
) -> [(tenon_vec3, tenon_vec3); 2] {
    // The neighbour's edge runs the other way.
    [(edge.first, t), (edge.second, 1.0 - t)].map(|(e, t)| {
        let corners = panels.corners(e.panel as usize);
        let (k, next) = (corners.start + e.edge as usize, corners.start + (e.edge as usize + 1) % corners.len());
        let (from, to) = match back {
            true => (panels.back_start[k], panels.back_end[k]),
            false => (panels.front[k], panels.front[next]),
        };
        let normal = panels.normal[e.panel as usize];
        let along = sub(to, from);
        let inward = cross(normal, scaled(along, 1.0 / length(along)));
        let entry = add(add(from, scaled(along, t)), scaled(inward, setback));
        (entry, if back { normal } else { scaled(normal, -1.0) })
    })
}

fn add(a: tenon_vec3, b: tenon_vec3) -> tenon_vec3 {
    tenon_vec3 { x: a.x + b.x, y: a.y + b.y, z: a.z + b.z }
}

fn sub(a: tenon_vec3, b: tenon_vec3) -> tenon_vec3 {
    add(a, scaled(b, -1.0))
}

fn scaled(a: tenon_vec3, s: f64) -> tenon_vec3 {
    tenon_vec3 { x: a.x * s, y: a.y * s, z: a.z * s }
}

fn cross(a: tenon_vec3, b: tenon_vec3) -> tenon_vec3 {
    tenon_vec3 { x: a.y * b.z - a.z * b.y, y: a.z * b.x - a.x * b.z, z: a.x * b.y - a.y * b.x }
}

fn length(a: tenon_vec3) -> f64 {
    (a.x * a.x + a.y * a.y + a.z * a.z).sqrt()
}
