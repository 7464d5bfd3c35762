//! A node in Rust that makes curves: a helix. See README.md.

use std::f64::consts::TAU;
use tenon_plugin::abi::value::tenon_vec4;
use tenon_plugin::author::{Call, Fail, Node, Plugin, Port};
use tenon_plugin::value::Curve;

fn plugin() -> Plugin {
    Plugin::new("curves", env!("CARGO_PKG_VERSION")).vendor("Tenon's examples").doc("More curves.").node(
        Node::new("curves.helix", 1)
            .name("Helix")
            .category("Curve")
            .doc("A helix about Z as a polyline.")
            .keywords("spiral, coil")
            .input(Port::number("radius").unit("mm").range(0.001, 1e6).default(1000).doc("Distance from the axis."))
            .input(Port::number("pitch").unit("mm").range(-1e6, 1e6).default(500).doc("Rise per turn."))
            .input(Port::number("turns").range(0.001, 1e3).default(1).doc("Number of turns."))
            .input(Port::integer("segments").range(1.0, 1e6).default(32).doc("Number of segments."))
            .output(Port::curve("curve").doc("The helix."))
            .output(Port::number("length").unit("mm").doc("Length of the helix, of which the polyline falls short."))
            .run(helix),
    )
}

tenon_plugin::export!(plugin);

fn helix(c: &mut Call<'_>) -> Result<(), Fail> {
    let (radius, pitch, turns) = (c.number("radius")?, c.number("pitch")?, c.number("turns")?);
    let segments = c.integer("segments")?;
    let point = |i: i64| {
        let turn = turns * i as f64 / segments as f64;
        let (sin, cos) = (TAU * turn).sin_cos();
        tenon_vec4 { x: radius * cos, y: radius * sin, z: pitch * turn, w: 1.0 }
    };
    let mut points: Vec<tenon_vec4> = Vec::new();
    for i in 0..=segments {
        // Long curves can be cancelled.
        if i % 4096 == 0 {
            c.progress(i as f64 / segments as f64)?;
        }
        points.push(point(i));
    }
    let strip_start = vec![0, points.len() as u32];
    c.set_curve("curve", Curve { points: points.into(), strip_start: strip_start.into(), closed: false })?;
    c.set_number("length", turns * (TAU * radius).hypot(pitch))
}
