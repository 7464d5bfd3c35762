//! Bad input gets a clear error: what, where, and what would work.

use crate::common::*;
use serde_json::json;
use std::fmt::Write;
use tenon_engine::*;

fn validate(nodes: Json) -> Vec<String> {
    document(nodes).validate(&registry()).iter().map(ToString::to_string).collect()
}

fn refused(text: &[u8]) -> Vec<String> {
    match Document::from_slice(text) {
        Ok(_) => panic!("this was accepted"),
        Err(errors) => errors.iter().map(ToString::to_string).collect(),
    }
}

#[test]
fn unknown_node_with_the_nearest_name() {
    assert_eq!(
        validate(json!({"x": {"type": "flor", "params": {"a": 1}}})),
        ["error[unknown-node] x: no node type is called \"flor\" (did you mean \"floor\"?)"]
    );
}

#[test]
fn unknown_ports_with_the_nearest_name() {
    let found = validate(json!({
        "n": {"type": "number"},
        "s": {"type": "sum", "params": {"valves": [1]}, "inputs": {"values": {"from": ["n.valu", "m.value"]}}},
    }));
    assert_eq!(
        found,
        [
            "error[unknown-port] s.valves: \"sum\" has no input \"valves\" (did you mean \"values\"?)",
            "error[unknown-port] s.values: \"number\" (n) has no output \"valu\" (did you mean \"value\"?)",
            "error[unknown-source] s.values: the wire comes from \"m.value\", but there is no node \"m\" (did you mean \"n\"?)",
        ]
    );
}

#[test]
fn cycles_are_named_and_the_rest_of_the_graph_runs() {
    let nodes = json!({
        "a": {"type": "add", "inputs": {"a": {"from": ["b.sum"]}}},
        "b": {"type": "add", "inputs": {"a": {"from": ["a.sum"]}}},
        "behind": {"type": "floor", "inputs": {"a": {"from": ["b.sum"]}}},
        "good": {"type": "number", "params": {"value": 3}},
        "self": {"type": "add", "inputs": {"a": {"from": ["self.sum"]}}},
    });
    let found = validate(nodes.clone());
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found[0].starts_with("error[cycle] a: the node waits for itself: a.sum -> b.sum -> a.sum"), "{found:?}");
    assert!(found[2].contains("self.sum -> self.sum"), "{found:?}");
    let mut s = session(nodes);
    let report = evaluate(&mut s, &[]);
    assert_eq!(report.node("behind").map(|n| n.happened), Some(Happened::Blocked));
    assert_eq!(items(&s, "good.value"), json!([3.0]));
}

#[test]
fn a_long_cycle_is_named_in_short() {
    let mut nodes = serde_json::Map::new();
    for i in 0..5000 {
        let from = format!("n{:04}.sum", (i + 4999) % 5000);
        nodes.insert(format!("n{i:04}"), json!({"type": "add", "inputs": {"a": {"from": [from]}}}));
    }
    let found = validate(Json::Object(nodes));
    assert_eq!(found.len(), 5000);
    assert!(found[0].contains("n0000.sum -> n0001.sum -> ") && found[0].contains("… 4989 more"), "{}", found[0]);
    assert!(found[0].len() < 400);
}

#[test]
fn a_wrong_type_names_both_ends() {
    assert_eq!(
        validate(json!({"t": {"type": "text"}, "x": {"type": "add", "inputs": {"a": {"from": ["t.text"]}}}})),
        ["error[wrong-type] x.a: t.text gives text, but x.a takes number"]
    );
    // An integer fits a number.
    assert_eq!(
        validate(json!({"s": {"type": "series"}, "c": {"type": "count", "inputs": {"values": {"from": ["s.values"]}}},
            "x": {"type": "add", "inputs": {"a": {"from": ["c.count"]}}}})),
        [""; 0]
    );
}

#[test]
fn types_that_only_show_at_run_time_are_told_then() {
    let mut s = session(json!({
        "t": {"type": "text"},
        "p": {"type": "pass", "inputs": {"in": {"from": ["t.text"]}}},
        "x": {"type": "add", "inputs": {"a": {"from": ["p.out"]}}},
    }));
    let report = evaluate(&mut s, &[]);
    assert_eq!(lines(&report), ["error[wrong-type] x.a: \"a\" takes number, but text came in"]);
}

#[test]
fn numbers_out_of_range_and_texts_that_are_no_choice() {
    let found = validate(json!({
        "t": {"type": "thick", "params": {"t": 900}},
        "u": {"type": "text", "params": {"value": "plan"}},
        "v": {"type": "series", "params": {"count": 1.5}},
    }));
    assert_eq!(
        found,
        [
            "error[out-of-range] t.t: 900 mm is outside 0.1 to 500 mm (the nearest that works is 500)",
            "error[not-a-choice] u.value: \"plan\" is not one of square, plane (did you mean \"plane\"?)",
            "error[bad-literal] v.count: expected a whole number, found 1.5",
        ]
    );
}

#[test]
fn setting_a_bad_value_changes_nothing() {
    let mut s = session(json!({"t": {"type": "thick"}, "x": {"type": "add", "inputs": {"a": {"from": ["t.t"]}}}}));
    evaluate(&mut s, &[]);
    let told = |r: Result<(), Diagnostic>| r.map_err(|d| d.to_string()).expect_err("this was accepted");
    assert!(told(s.set("t.t", json!(0))).contains("the nearest that works is 0.1"));
    assert!(told(s.set("t.t", json!("thick"))).contains("expected a number"));
    assert!(told(s.set("t.tt", json!(1))).contains("did you mean \"t\"?"));
    assert!(told(s.set("tt.t", json!(1))).contains("there is no node \"tt\""));
    assert!(told(s.set("t", json!(1))).contains("the graph has no input \"t\""));
    assert!(told(s.set("x.a", json!(1))).contains("has a wire"));
    assert_eq!(evaluate(&mut s, &[]).nodes.len(), 0);
    assert_eq!(items(&s, "x.sum"), json!([10.0]));
}

#[test]
fn a_bad_parameter_can_be_mended() {
    let mut s = session(json!({"t": {"type": "thick", "params": {"t": -3}}}));
    assert!(evaluate(&mut s, &[]).has_errors());
    s.set("t.t", json!("2 cm")).expect("accepted");
    assert!(!evaluate(&mut s, &[]).has_errors());
    assert_eq!(items(&s, "t.t"), json!([20.0]));
}

#[test]
fn nan_and_infinity_are_no_literals() {
    assert!(
        refused(br#"{"format": "tenon", "nodes": {"n": {"type": "number", "params": {"value": NaN}}}}"#)[0]
            .contains("line 1, column")
    );
    assert!(
        refused(br#"{"format": "tenon", "nodes": {"n": {"type": "number", "params": {"value": 1e999}}}}"#)[0]
            .contains("out of range")
    );
}

#[test]
fn truncated_files_say_where_they_end() {
    let whole = document(json!({"a": {"type": "number", "params": {"value": [1, 2]}}})).to_string_canonical();
    assert!(Document::from_slice(whole.as_bytes()).is_ok());
    for cut in 0..whole.trim_end().len() {
        let errors = refused(&whole.as_bytes()[..cut]);
        assert_eq!(errors.len(), 1, "{errors:?}");
    }
    let errors = refused(&whole.as_bytes()[..whole.len() / 2]);
    assert!(errors[0].contains("cut off") && errors[0].contains("line "), "{errors:?}");
}

#[test]
fn huge_files_are_refused_at_once() {
    let start = std::time::Instant::now();
    let garbage = vec![b'#'; 200 << 20];
    let errors = refused(&garbage);
    assert_eq!(errors, ["error[file-too-large]: the file has 209.7 MB; a graph may have at most 67.1 MB"]);
    // Also if the caller allows the size: nothing is built from garbage.
    let Err(errors) = Document::from_slice_with_limit(&garbage, usize::MAX) else { panic!("this was accepted") };
    assert!(errors[0].message.contains("line 1, column 1"), "{}", errors[0]);
    // Generous: this machine is shared, and filling 200 MB is part of it.
    assert!(start.elapsed().as_secs() < 20);
}

#[test]
fn garbage_that_looks_like_json_is_refused() {
    let mut text = b"{\"format\": \"tenon\", \"nodes\": ".to_vec();
    text.extend((0..(8usize << 20)).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8));
    assert_eq!(refused(&text).len(), 1);
}

#[test]
fn a_ten_million_deep_array_costs_no_stack() {
    let deep = vec![b'['; 10_000_000];
    let small_stack = std::thread::Builder::new().stack_size(256 << 10);
    let errors = small_stack.spawn(move || refused(&deep)).map(|t| t.join().expect("no overflow")).expect("a thread");
    assert_eq!(errors, ["error[too-deep]: line 1, column 101: nested deeper than 100 levels"]);
    let mut inside = b"{\"x\": ".to_vec();
    inside.extend(vec![b'['; 10_000_000]);
    assert!(refused(&inside)[0].contains("too-deep"));
    // Brackets in a text are text.
    let text = format!("{{\"format\": \"tenon\", \"nodes\": {{}}, \"x\": \"{}\\\"\"}}", "[".repeat(1000));
    assert!(Document::from_slice(text.as_bytes()).is_ok());
}

#[test]
fn not_a_graph() {
    assert!(refused(b"")[0].contains("empty"));
    assert!(refused(b"hello")[0].contains("line 1, column 1"));
    assert!(refused(b"{}")[0].contains("\"format\": \"tenon\" is missing"));
    assert!(refused(b"[]")[0].contains("must be an object"));
    assert!(refused(b"{\"format\": \"tenon\", \"version\": 7}")[0].contains("version 7"));
    assert!(refused(b"{\"format\": \"tenon\", \"units\": \"in\"}")[0].contains("\"in\""));
    assert!(refused(b"{\"format\": \"tenon\"\n, \"a\": \"\xff\"}")[0].contains("line 2, column 9"));
}

#[test]
fn every_fault_of_form_is_told_with_its_line() {
    let text = r#"{
  "format": "tenon",
  "nodes": {
    "a": {"v": 1},
    "a": {"type": "add"},
    "b.c": {"type": "add"},
    "d": {"type": "add", "state": "onn", "inputs": {"a": {"from": "x"}, "b": {"from": ["e.f"], "tree": ["grft"]}}},
    "e": {"type": "add", "params": 3, "match": "diagonal", "v": 0}
  }
}"#;
    let errors = refused(text.as_bytes());
    for expected in [
        "line 4, column 10: node \"a\" has no \"type\"",
        "line 5, column 10: \"a\" stands twice in \"nodes\"",
        "line 6, column 12: \"b.c\" cannot be a node's id",
        "line 7, column 67: \"x\" is not of the form node.port",
        "line 7, column 96: \"grft\" is no tree operation",
        "did you mean \"graft\"?",
        "\"onn\" is no node state",
        "line 8, column 37: \"diagonal\"",
        "line 8, column 36: \"params\"",
    ] {
        let near = expected.split(": ").last().unwrap_or(expected);
        assert!(errors.iter().any(|e| e.contains(near)), "{expected}\n{}", errors.join("\n"));
    }
    for line in ["line 4", "line 5", "line 6", "line 7", "line 8"] {
        assert!(errors.iter().any(|e| e.contains(line)), "{line}");
    }
}

#[test]
fn a_file_wrong_everywhere_is_still_read_quickly() {
    let mut text = String::from("{\"format\": \"tenon\", \"nodes\": {");
    for i in 0..50_000 {
        let _ = writeln!(text, "{}\"n{i}\": {{\"v\": 1}}", if i > 0 { "," } else { "" });
    }
    text.push_str("}}");
    let start = std::time::Instant::now();
    assert!(refused(text.as_bytes()).len() <= 50);
    assert!(start.elapsed().as_secs() < 10);
}

#[test]
fn duplicate_wires_and_newer_nodes() {
    assert_eq!(
        validate(json!({
            "n": {"type": "number"},
            "s": {"type": "sum", "inputs": {"values": {"from": ["n.value", "n.value"]}}},
            "t": {"type": "thick", "v": 2},
        })),
        [
            "error[duplicate-wire] s.values: the wire from n.value comes in twice",
            "error[newer-node] t: written for version 2 of \"thick\"; this program has version 1"
        ]
    );
}

#[test]
fn an_interface_that_points_nowhere() {
    let text = br#"{"format": "tenon", "interface": {
        "inputs": {"t": {"port": "thick.tt"}, "n": {"port": ["thick.t", "none.t"]}},
        "outputs": {"o": {"port": "thick.out"}}},
        "nodes": {"thick": {"type": "thick"}}}"#;
    let document = Document::from_slice(text).expect("its form is right");
    let found: Vec<String> = document.validate(&registry()).iter().map(ToString::to_string).collect();
    assert_eq!(found.len(), 3, "{found:?}");
    assert!(found.iter().any(|f| f.contains("interface input \"t\": \"thick\" has no input \"tt\"")), "{found:?}");
    assert!(found.iter().any(|f| f.contains("interface input \"n\": there is no node \"none\"")), "{found:?}");
    assert!(found.iter().any(|f| f.contains("interface output \"o\": \"thick\" has no output \"out\"")), "{found:?}");
}
