//! Order and planarity as the nodes tell them.

use crate::common::{run, told, wire};
use serde_json::json;

#[test]
fn every_face_knows_its_neighbours_by_side() {
    // Two by two quads, shuffled and turned.
    let points = json!([
        [0, 0, 0],
        [9, 0, 0],
        [18, 0, 0],
        [0, 9, 0],
        [9, 9, 0],
        [18, 9, 0],
        [0, 18, 0],
        [9, 18, 0],
        [18, 18, 0]
    ]);
    let mesh = json!({ "points": points, "faces": [[8, 7, 4, 5], [1, 4, 3, 0], [4, 7, 6, 3], [2, 5, 4, 1]] });
    let graph = json!({ "format": "tenon", "version": 1, "units": "mm", "nodes": {
        "order": { "type": "order_faces", "v": 1, "params": { "mesh": mesh, "front": [0, 0, 1] } } } });
    let (session, report) = run(&graph, &["order.neighbours", "order.kinds", "order.mesh"]);
    assert!(!report.has_errors(), "{:#?}", report.diagnostics);
    let branches = &session.value("order.neighbours").unwrap().to_json()["branches"];
    // Bottom, right, top, left.
    assert_eq!(branches["{0}"], json!([null, 1, 2, null]));
    assert_eq!(branches["{1}"], json!([null, null, 3, 0]));
    assert_eq!(branches["{2}"], json!([0, 3, null, null]));
    assert_eq!(branches["{3}"], json!([1, null, null, 2]));
    let kinds = session.value("order.kinds").unwrap().to_json();
    assert_eq!(kinds["branches"]["{0}"], json!(["corner", "corner", "corner", "corner"]));
}

#[test]
fn planarize_tells_all_measures_and_how_far_it_went() {
    // A dome: no face of it is planar.
    let height = |i: usize, j: usize| {
        let (u, v) = (i as f64 - 1.6, j as f64 - 1.4);
        200.0 - 12.0 * (u * u + 0.7 * v * v + 0.5 * u * v)
    };
    let points: Vec<_> =
        (0..16).map(|p| (p % 4, p / 4)).map(|(i, j)| json!([100 * i, 100 * j, height(i, j)])).collect();
    let faces: Vec<_> = (0..9).map(|f| (f / 3) * 4 + f % 3).map(|a| json!([a, a + 1, a + 5, a + 4])).collect();
    let graph = |params: serde_json::Value| {
        let mut graph = json!({ "format": "tenon", "version": 1, "units": "mm", "nodes": {
            "flat": { "type": "planarize", "v": 1, "params": params },
            "panels": { "type": "thicken", "v": 1, "inputs": { "mesh": wire("flat.mesh") } } } });
        graph["nodes"]["flat"]["params"]["mesh"] = json!({ "points": points, "faces": faces });
        graph
    };
    let (session, report) = run(&graph(json!({})), &["panels.panels"]);
    assert!(!report.has_errors(), "{:#?}", report.diagnostics);
    let number = |name: &str| *session.value(name).unwrap().first::<f64>().unwrap();
    for (measure, before) in [("corner", 4.0), ("diagonal", 0.01), ("fit", 1.0)] {
        assert!(
            number(&format!("flat.{measure}_before")) > before,
            "{measure} {}",
            number(&format!("flat.{measure}_before"))
        );
        assert!(number(&format!("flat.{measure}_after")) <= 1e-4, "{measure}");
    }
    assert!(number("flat.cosine_before") < 1.0 - 1e-5 && number("flat.cosine_after") > 1.0 - 1e-9);
    assert!(number("flat.moved_max") > 0.1 && number("flat.moved_rms") <= number("flat.moved_max"));

    let (_, report) = run(&graph(json!({ "iterations": 0 })), &["flat.mesh"]);
    let d = told(&report, "not-planar-yet");
    assert!(d.message.contains("out of plane after 0 steps") && d.item.is_some(), "{d}");
}
