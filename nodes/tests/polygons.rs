//! Closed curves turn into polygons by themselves: measured, and made into panels.

use crate::common::*;
use serde_json::{Value, json};
use tenon_geometry::mesh::Mesh;
use tenon_geometry::panel::PanelSet;
use tenon_nodes::value::{Point, V};

/// A polyline of these corners as the iterated curve draws it.
fn outline(corners: Value, closed: bool) -> Value {
    json!({ "type": "ifs_curve", "v": 1, "params": { "points": corners, "degree": 1, "iterations": 0, "closed": closed } })
}

fn area_of(curve: Value) -> Value {
    json!({
        "format": "tenon", "version": 1, "units": "mm",
        "nodes": { "outline": curve, "area": { "type": "area", "v": 1, "inputs": { "polygon": wire("outline.curve") } } }
    })
}

#[test]
fn a_closed_curve_is_measured_as_a_polygon() {
    let l = json!([[0, 0, 7], [200, 0, 7], [200, 100, 7], [100, 100, 7], [100, 200, 7], [0, 200, 7]]);
    let (session, report) = run(&area_of(outline(l, true)), &["area.area", "area.circumference", "area.centroid"]);
    assert_eq!(report.diagnostics, []);
    let number = |port: &str| *session.value(port).unwrap().first::<f64>().unwrap();
    assert_eq!((number("area.area"), number("area.circumference")), (30_000.0, 800.0));
    let centroid = session.value("area.centroid").unwrap().first::<Point>().unwrap().0;
    assert!((centroid - Point([250.0 / 3.0, 250.0 / 3.0, 7.0].into()).0).length() < 1e-9, "{centroid}");
}

#[test]
fn an_open_curve_is_refused_with_its_gap() {
    let u = json!([[0, 0, 0], [300, 0, 0], [300, 400, 0]]);
    let (session, report) = run(&area_of(outline(u, false)), &["area.area"]);
    let found = told(&report, "not-convertible");
    assert_eq!((found.node.as_deref(), found.port.as_deref()), (Some("area"), Some("polygon")));
    assert!(found.message.contains("open") && found.message.contains("500.000 mm"), "{}", found.message);
    assert!(session.value("area.area").is_none_or(|t| t.first::<f64>().is_none()));
}

#[test]
fn a_polygon_that_is_not_flat_says_what_would_do() {
    let bent = json!([[0, 0, 0], [100, 0, 0], [100, 100, 2], [0, 100, 0]]);
    let mut graph = area_of(outline(bent, true));
    let (_, report) = run(&graph, &["area.area"]);
    let hint = told(&report, "polygon-not-flat").hint.clone().unwrap();
    let would_do: f64 = hint.split_whitespace().find_map(|w| w.parse().ok()).unwrap();
    graph["nodes"]["area"]["params"] = json!({ "planar_within": would_do });
    assert_eq!(run(&graph, &["area.area"]).1.diagnostics, []);
}

#[test]
fn outlines_become_panels_that_know_their_neighbours() {
    // A pentagon and a quad that share an edge, drawn a hair apart, folded along it.
    let pentagon = json!([[0, 0, 0], [0, -300, 0], [200, -500, 0], [400, -300, 0], [400, 0, 0]]);
    let quad = json!([[400, 0, 0.0004], [400, 300, 100], [0, 300, 100], [0, 0, 0]]);
    let graph = json!({
        "format": "tenon", "version": 1, "units": "mm",
        "nodes": {
            "a": outline(pentagon, true),
            "b": outline(quad, true),
            "mesh": { "type": "mesh_polygons", "v": 1, "inputs": { "polygons": { "from": ["a.curve", "b.curve"] } } },
            "thicken": { "type": "thicken", "v": 1, "params": { "thickness": 18 }, "inputs": { "mesh": wire("mesh.mesh") } }
        }
    });
    let (session, report) = run(&graph, &["thicken.panels", "mesh.mesh"]);
    assert!(!report.has_errors(), "{:#?}", report.diagnostics);
    let mesh = session.value("mesh.mesh").unwrap().first::<V<Mesh>>().unwrap().clone();
    assert_eq!((mesh.face_count(), mesh.points.len()), (2, 7));
    let panels = session.value("thicken.panels").unwrap().first::<V<PanelSet>>().unwrap().clone();
    assert!(panels.is_valid(0) && panels.is_valid(1));
    assert_eq!((panels.corners(0).len(), panels.corners(1).len()), (5, 4));
    let pairs = panels.neighbour.iter().filter_map(|n| n.get()).count();
    assert_eq!(pairs, 2, "one edge, seen from both sides");
}

#[test]
fn polygons_can_be_written_in_the_file() {
    let mut graph = area_of(outline(json!([[0, 0, 0], [1, 0, 0], [0, 1, 0]]), true));
    let area = graph["nodes"]["area"].as_object_mut().unwrap();
    area.remove("inputs");
    area.insert("params".into(), json!({ "polygon": { "corners": [[0, 0, 0], [3, 0, 0], [3, 4, 0]] } }));
    let (session, report) = run(&graph, &["area.area"]);
    assert_eq!(report.diagnostics, []);
    assert_eq!(session.value("area.area").unwrap().first::<f64>(), Some(&6.0));
    graph["nodes"]["area"]["params"] = json!({ "polygon": { "corners": [[0, 0, 0], [3, 0, 0]] } });
    let (_, report) = run(&graph, &["area.area"]);
    assert!(told(&report, "bad-literal").message.contains("at least 3"));
}
