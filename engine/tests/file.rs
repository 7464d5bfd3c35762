//! The file: one canonical form, nothing lost.

use crate::common::*;
use serde_json::json;
use tenon_engine::*;

const FILE: &str = r#"{
  "format": "tenon",
  "groups": {
    "g": { "nodes": ["a"] }
  },
  "interface": {
    "inputs": {
      "size": { "doc": "Both", "max": 9.5, "min": 1.0, "port": ["a.value", "b.value"], "unit": "mm" }
    },
    "outputs": {
      "sum": { "port": "c.sum" }
    }
  },
  "nodes": {
    "a": {
      "type": "number",
      "v": 1
    },
    "b": {
      "note": "second",
      "params": {
        "value": 0.1
      },
      "state": "frozen",
      "type": "number",
      "v": 1
    },
    "c": {
      "inputs": {
        "a": { "from": ["a.value"] },
        "b": { "from": ["b.value"], "match": "cross", "tree": ["graft", "reverse"] }
      },
      "match": "shortest",
      "type": "add",
      "v": 1
    }
  },
  "requires": {
    "tenon-x": "1.2"
  },
  "units": "mm",
  "version": 1,
  "x": {"kept":   [1, 2.50, 1e3,
 "as it is"], "a": 1}
}
"#;

#[test]
fn the_canonical_form_is_a_fixed_point() {
    let document = Document::from_slice(FILE.as_bytes()).unwrap_or_else(|e| panic!("{e:?}"));
    assert_eq!(document.to_string_canonical(), FILE);
}

#[test]
fn unknown_nodes_and_foreign_data_stay_byte_for_byte() {
    let node =
        "{ \"type\":\"plugin/thing\",  \"params\": {\"w\": 1.50,\n\"big\": 123456789012345678901234567890}, \"v\": 3 }";
    let text = format!("{{\"format\": \"tenon\", \"nodes\": {{\"u\": {node}}}, \"x\": [1.0,   2e0]}}");
    let document = Document::from_slice(text.as_bytes()).unwrap_or_else(|e| panic!("{e:?}"));
    let out = document.to_string_canonical_for(&registry());
    assert!(out.contains(node) && out.contains("\"x\": [1.0,   2e0]"), "{out}");
    let again = Document::from_slice(out.as_bytes()).unwrap_or_else(|e| panic!("{e:?}"));
    assert_eq!(again.to_string_canonical_for(&registry()), out);
    assert_eq!(again, document);
    // Nor does it matter what is done to others.
    let mut edited = document;
    let edits = [
        Operation::AddNode { id: "a".into(), node: Box::new(Node::new("number")) },
        Operation::SetParam { node: "a".into(), port: "value".into(), value: Some(json!(2.5)) },
        Operation::Rename { from: "a".into(), to: "z".into() },
    ];
    for edit in &edits {
        edit.apply(&mut edited).unwrap_or_else(|e| panic!("{e:?}"));
    }
    let out = edited.to_string_canonical_for(&registry());
    assert!(out.contains(node) && out.contains("\"x\": [1.0,   2e0]") && out.contains("\"z\": "), "{out}");
}

#[test]
fn keys_that_nobody_knows_stay() {
    let text = r#"{"format": "tenon", "nodes": {"a": {"type": "number", "colour": [1, 2]}}, "later": {"a": 1}}"#;
    let document = Document::from_slice(text.as_bytes()).unwrap_or_else(|e| panic!("{e:?}"));
    let out = document.to_string_canonical();
    assert!(out.contains("\"colour\": [1, 2]") && out.contains("\"later\": {"), "{out}");
}

#[test]
fn one_interface_input_sets_many_ports() {
    let mut s = Session::new(
        registry(),
        Document::from_slice(FILE.as_bytes()).unwrap_or_else(|e| panic!("{e:?}")),
        Options::default(),
    );
    s.set("size", json!(2)).expect("accepted");
    assert!(s.set("size", json!(10)).is_err_and(|d| d.message == "size = 10 mm is outside 1 to 9.5 mm"));
    assert!(s.set("siz", json!(1)).is_err_and(|d| d.hint.as_deref() == Some("did you mean \"size\"?")));
    assert!(!evaluate(&mut s, &[]).has_errors());
    assert_eq!(items(&s, "sum"), json!([4.0]));
    assert!(s.document().to_string_canonical().contains("\"value\": 2"));
    let report = evaluate(&mut s, &["summ"]);
    assert_eq!(lines(&report), ["error[unknown-name]: the graph has no output \"summ\" (did you mean \"sum\"?)"]);
}
