//! Bad geometry and bad numbers get a clear error that names the place, and nothing good is lost.

use crate::common::{run, run_on, shell, told, wire};
use serde_json::{Value, json};
use std::collections::HashMap;
use tenon_geometry::panel::PanelSet;
use tenon_nodes::value::V;

/// The shell with one parameter set.
fn with(node: &str, port: &str, value: Value) -> Value {
    let mut graph = shell();
    graph["nodes"][node]["params"][port] = value;
    graph
}

/// A graph of one mesh literal in an order_faces (when `order`) before thicken.
fn mesh_graph(mesh: Value, order: bool) -> Value {
    let mut nodes = json!({ "thicken": { "type": "thicken", "v": 1, "params": { "thickness": 10 } } });
    if order {
        nodes["order"] = json!({ "type": "order_faces", "v": 1, "params": { "mesh": mesh } });
        nodes["thicken"]["inputs"]["mesh"] = wire("order.mesh");
    } else {
        nodes["thicken"]["params"]["mesh"] = mesh;
    }
    json!({ "format": "tenon", "version": 1, "units": "mm", "nodes": nodes })
}

#[test]
fn the_good_shell_passes() {
    let (session, report) = run(&shell(), &["gcode.files", "prove.report"]);
    assert!(
        report.diagnostics.iter().all(|d| d.severity != tenon_engine::Severity::Error),
        "{:#?}",
        report.diagnostics
    );
    assert!(session.files().iter().all(|(_, f)| f.withheld.is_none() && f.name.ends_with(".ngc")));
}

#[test]
fn a_subdivision_point_out_of_reach_is_named() {
    let mut graph = with("zigzag", "subdivision_points", json!([[0, 100, 50]]));
    graph["nodes"]["zigzag"]["params"]["subdivision_numbers"] = json!([2]);
    let (_, report) = run(&graph, &["zigzag.curve"]);
    let d = told(&report, "subdivision-point-unreachable");
    assert!(d.message.contains("s2") && d.message.contains("50"), "{d}");
    assert_eq!(d.node.as_deref(), Some("zigzag"));
}

#[test]
fn weights_that_vanish_are_refused() {
    for weights in [json!([1, -3, 1]), json!([0, 0, 0])] {
        let (_, report) = run(&with("arc", "weights", weights), &["arc.curve"]);
        assert_eq!(told(&report, "curve-weight").port.as_deref(), Some("weights"));
    }
}

#[test]
fn empty_and_one_point_curves_are_refused() {
    let (_, report) = run(&with("arc", "points", json!([])), &["arc.curve"]);
    told(&report, "curve-too-few-points");
    for points in [json!([[1, 2, 3]]), json!([[1, 2, 3], [1, 2, 3], [1, 2, 3]])] {
        let (_, report) = run(&with("arc", "points", points), &["arc.curve"]);
        assert!(report.has_errors(), "{:#?}", report.diagnostics);
    }
}

#[test]
fn coordinates_that_are_no_numbers_are_refused() {
    for bad in ["nan", "inf", "-infinity", "1e999"] {
        let obj = format!("v 0 0 0\nv 1 0 0\nv 1 1 {bad}\nv 0 1 0\nf 1 2 3 4\n");
        let graph = json!({ "format": "tenon", "version": 1, "units": "mm", "nodes": {
            "mesh": { "type": "read_mesh", "v": 1, "params": { "path": "bad.obj" } } } });
        let (_, report) = run_on(&graph, &["mesh.mesh"], 1, HashMap::from([("bad.obj", obj.into_bytes())]));
        let d = told(&report, "bad-obj");
        assert!(d.message.contains("line 3") && d.message.contains("bad.obj"), "{d}");
    }
    // Finite in the file, but not any more on the surface: told, never let through.
    let huge = json!([[0, 0, 0], [1e308, 0, 0], [1.7e308, 0, 1.7e308]]);
    let mut graph = with("arc", "points", huge.clone());
    graph["nodes"]["zigzag"]["params"] = json!({ "points": huge, "iterations": 2 });
    let (session, report) = run(&graph, &["surface.mesh"]);
    assert!(report.has_errors() && session.value("surface.mesh").is_none(), "{:#?}", report.diagnostics);
}

#[test]
fn a_file_that_is_not_there_is_named() {
    let graph = json!({ "format": "tenon", "version": 1, "units": "mm", "nodes": {
        "mesh": { "type": "read_mesh", "v": 1, "params": { "path": "nowhere.obj" } } } });
    let (_, report) = run(&graph, &["mesh.mesh"]);
    assert!(told(&report, "unreadable-file").message.contains("nowhere.obj"));
}

#[test]
fn an_edge_of_three_faces_is_named_with_its_faces() {
    let mesh = json!({ "points": [[0, 0, 0], [100, 0, 0], [100, 100, 0], [0, 100, 0], [100, 0, 100], [0, 0, 100], [100, -100, 0], [0, -100, 0]],
                       "faces": [[0, 1, 2, 3], [1, 0, 5, 4], [0, 1, 6, 7]] });
    for order in [false, true] {
        let (_, report) = run(&mesh_graph(mesh.clone(), order), &["thicken.panels"]);
        let d = told(&report, "mesh-not-manifold");
        assert!(d.message.contains("vertices 0 and 1") && d.message.contains("0, 1, 2"), "{d}");
    }
}

#[test]
fn mixed_orientation_is_refused_by_thicken_and_mended_by_order_faces() {
    let mesh = json!({ "points": [[0, 0, 0], [100, 0, 0], [200, 0, 0], [0, 100, 0], [100, 100, 0], [200, 100, 0]],
                       "faces": [[0, 1, 4, 3], [1, 4, 5, 2]] });
    let (_, report) = run(&mesh_graph(mesh.clone(), false), &["thicken.panels"]);
    let d = told(&report, "mesh-mixed-orientation");
    assert!(d.message.contains("0 and 1") && d.hint.as_deref().is_some_and(|h| h.contains("order_faces")), "{d}");
    let (session, report) = run(&mesh_graph(mesh, true), &["thicken.panels"]);
    assert!(!report.has_errors(), "{:#?}", report.diagnostics);
    told(&report, "faces-turned");
    assert!(session.value("thicken.panels").is_some());
}

#[test]
fn concave_and_warped_faces_say_by_how_much() {
    let concave = json!({ "points": [[0, 0, 0], [100, 0, 0], [30, 30, 0], [0, 100, 0]], "faces": [[0, 1, 2, 3]] });
    let (_, report) = run(&mesh_graph(concave, false), &["thicken.panels"]);
    let d = told(&report, "face-concave");
    assert!(d.message.contains("face 0") && d.message.contains("corner 2") && d.item == Some(0), "{d}");

    let warped = json!({ "points": [[0, 0, 0], [100, 0, 0], [100, 100, 8], [0, 100, 0]], "faces": [[0, 1, 2, 3]] });
    let (_, report) = run(&mesh_graph(warped, false), &["thicken.panels"]);
    let d = told(&report, "face-not-planar");
    assert!(d.message.contains("1.99") && d.message.contains("planarize"), "{d}");
}

#[test]
fn a_thickness_that_flips_a_face_names_the_largest_that_works() {
    let (_, report) = run(&with("thicken", "thickness", json!(400)), &["thicken.panels"]);
    let d = told(&report, "thickness-flips-face");
    assert_eq!(d.port.as_deref(), Some("thickness"));
    let largest: f64 =
        d.message.split("a thickness below ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    let index = d.item.unwrap();
    let survives = |thickness: f64| {
        let (session, _) = run(&with("thicken", "thickness", json!(thickness)), &["thicken.panels"]);
        let set = session.value("thicken.panels").and_then(|t| t.first::<V<PanelSet>>().cloned());
        set.is_some_and(|s| s.is_valid(index))
    };
    assert!(survives(largest - 1e-3) && !survives(largest + 1e-2), "panel {index} at {largest}");
}

#[test]
fn edges_too_short_for_fasteners_are_reported() {
    let (_, report) = run(&with("screws", "end_distance", json!(90)), &["screws.features"]);
    let d = told(&report, "edge-too-short");
    assert!(d.message.contains("mm of line are too short") && d.item.is_some(), "{d}");
}

#[test]
fn holes_out_of_reach_are_refused_or_left_to_the_hand() {
    let mut graph = shell();
    graph["nodes"]["screws"]["params"] =
        json!({ "kind": "screw", "diameter": 3.5, "length": 25, "depth": 15, "cover": 0.5 });
    let (_, report) = run(&graph, &["screws.features"]);
    let d = told(&report, "feature-out-of-reach");
    assert!(d.message.contains('°') && d.severity == tenon_engine::Severity::Error, "{d}");
    graph["nodes"]["screws"]["params"]["out_of_reach"] = json!("by hand");
    let (session, report) = run(&graph, &["screws.features"]);
    assert_eq!(told(&report, "feature-out-of-reach").severity, tenon_engine::Severity::Warning);
    let features = session.value("screws.features").unwrap().to_json().to_string();
    assert!(features.contains("\"by_hand\":[{"), "{features:.200}");
}

#[test]
fn a_part_larger_than_the_board_is_left_out_alone() {
    let (session, report) = run(&with("pack", "board_x", json!(310)), &["pack.layout"]);
    let d = told(&report, "part-larger-than-board");
    assert!(d.message.contains("the usable board is 290.0") && d.item.is_some(), "{d}");
    let left_out = report.diagnostics.iter().filter(|d| d.code == "part-larger-than-board").count();
    let layout =
        session.value("pack.layout").and_then(|t| t.first::<V<tenon_geometry::board::Layout>>().cloned()).unwrap();
    assert!(left_out > 0 && left_out < 16 && layout.placements.len() == 16 - left_out, "{left_out} left out");
}

/// The default machine with one change to its file, and one to every end mill.
fn machine(change: impl Fn(&mut Value), tool: impl Fn(&mut Value)) -> HashMap<&'static str, Vec<u8>> {
    let mut file: Value = serde_json::from_str(include_str!("../machines/maka-mm7s.json")).unwrap();
    change(&mut file);
    for t in file["tools"].as_array_mut().unwrap().iter_mut().filter(|t| t["kind"] == "end_mill") {
        tool(t);
    }
    HashMap::from([("machine.json", serde_json::to_vec(&file).unwrap())])
}

fn on_machine(files: HashMap<&'static str, Vec<u8>>, thickness: f64) -> tenon_engine::Report {
    let mut graph = with("thicken", "thickness", json!(thickness));
    graph["nodes"]["machine"]["params"] = json!({ "path": "machine.json" });
    run_on(&graph, &["post.programs"], 1, files).1
}

#[test]
fn tools_too_short_too_long_or_too_thick_are_named() {
    let short = machine(|_| (), |t| t["cutting_length"] = json!(6.0));
    assert!(told(&on_machine(short, 10.0), "tool-too-short").message.contains("it cuts 6.0 mm of its length"));

    let long = machine(
        |_| (),
        |t| {
            t["length"] = json!(1195.0);
            t["holder"] = json!([{ "from": 1195.0, "to": 1230.0, "radius_from": 20.0, "radius_to": 20.0 }]);
        },
    );
    let report = on_machine(long, 10.0);
    let d = told(&report, "tool-too-long");
    assert!(d.message.contains("T10") && d.message.contains("mm shorter"), "{d}");

    let thick = machine(
        |m| m["table"]["sacrificial"] = json!(4.5),
        |t| {
            t["diameter"] = json!(140.0);
            t["shank_diameter"] = json!(140.0);
            t["holder"] = json!([{ "from": 95.0, "to": 170.0, "radius_from": 75.0, "radius_to": 75.0 }]);
        },
    );
    let report = on_machine(thick, 10.0);
    let d = told(&report, "below-sacrificial-layer");
    assert!(d.message.contains('°') && d.message.contains("mm"), "{d}");
}

#[test]
fn axis_limits_name_axis_and_excess() {
    let tilt = machine(
        |m| {
            m["secondary"]["min"] = json!(-2.0);
            m["secondary"]["max"] = json!(2.0);
        },
        |_| (),
    );
    let report = on_machine(tilt, 10.0);
    assert!(told(&report, "axis-limit").message.contains('B'), "{:#?}", report.diagnostics);
    let travel = machine(|m| m["linear"][0]["max"] = json!(120.0), |_| ());
    let report = on_machine(travel, 10.0);
    let d = told(&report, "axis-limit");
    assert!(d.message.contains('X') && d.message.contains("120"), "{d}");
}

#[test]
fn a_wrong_machine_file_names_the_key() {
    let report = on_machine(machine(|m| m["safe_height"] = json!("high"), |_| ()), 10.0);
    assert!(told(&report, "bad-machine").message.contains("safe_height"));
    let report = on_machine(HashMap::from([("machine.json", b"{".to_vec())]), 10.0);
    told(&report, "bad-machine");
}

#[test]
fn one_bad_face_among_256_leaves_255_panels_and_one_named_error() {
    let n = 16usize;
    let mut points: Vec<Value> = Vec::new();
    for j in 0..=n {
        for i in 0..=n {
            points.push(json!([i as f64 * 100.0, j as f64 * 100.0, 0.0]));
        }
    }
    // Corner 0 of face 0 moves inside the face: only that one face becomes concave.
    points[0] = json!([70.0, 70.0, 0.0]);
    let at = |i: usize, j: usize| j * (n + 1) + i;
    let faces: Vec<Value> = (0..n * n)
        .map(|f| (f % n, f / n))
        .map(|(i, j)| json!([at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)]))
        .collect();
    let (session, report) = run(&mesh_graph(json!({ "points": points, "faces": faces }), false), &["thicken.panels"]);
    let errors: Vec<_> = report.diagnostics.iter().filter(|d| d.severity == tenon_engine::Severity::Error).collect();
    assert_eq!(errors.len(), 1, "{errors:#?}");
    assert_eq!(
        (errors[0].code.as_ref(), errors[0].item, errors[0].node.as_deref()),
        ("face-concave", Some(0), Some("thicken"))
    );
    let set = session.value("thicken.panels").and_then(|t| t.first::<V<PanelSet>>().cloned()).unwrap();
    assert_eq!((set.len(), (0..set.len()).filter(|i| set.is_valid(*i)).count(), set.is_valid(0)), (256, 255, false));
}

#[test]
fn unproven_programs_are_withheld() {
    let mut graph = shell();
    graph["nodes"]["gcode"]["inputs"]["programs"] = wire("post.programs");
    let (session, report) = run(&graph, &["gcode.files"]);
    assert!(!report.has_errors(), "{:#?}", report.diagnostics);
    let files = session.files();
    assert!(!files.is_empty());
    for (_, file) in files {
        assert!(file.withheld.as_deref().is_some_and(|w| w.contains("not been proven")));
        let head = String::from_utf8_lossy(&file.bytes[..200]).into_owned();
        assert!(head.lines().nth(1).is_some_and(|l| l.contains("not proven")), "{head}");
    }
}
