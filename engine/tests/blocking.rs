//! A failure blocks what depends on it and nothing else.

use crate::common::*;
use serde_json::json;
use std::sync::Arc;
use tenon_engine::*;

#[test]
fn a_failed_node_blocks_only_what_depends_on_it() {
    let mut s = session(json!({
        "bad": {"type": "root", "params": {"a": -1}},
        "c": {"type": "add", "inputs": {"a": {"from": ["bad.value"]}}},
        "d": {"type": "add", "params": {"b": 1}, "inputs": {"a": {"from": ["c.sum"]}}},
        "good": {"type": "add", "params": {"a": 1, "b": 2}},
    }));
    let report = evaluate(&mut s, &[]);
    assert_eq!(items(&s, "good.sum"), json!([3.0]));
    assert_eq!(
        lines(&report),
        [
            "error[negative] bad.a: -1 has no root (use 0 or more)",
            "note[blocked] c: blocked by bad",
            "note[blocked] d: blocked by bad"
        ]
    );
    assert_eq!(report.node("d").map(|n| n.happened), Some(Happened::Blocked));
    assert_eq!(log(&mut s), "failed bad, executed good, blocked c by bad, blocked d by bad");

    s.set("bad.a", json!(4)).expect("4 is fine");
    assert!(!evaluate(&mut s, &[]).has_errors());
    assert_eq!(items(&s, "d.sum"), json!([3.0]));
    assert_eq!(log(&mut s), "executed bad, executed c, executed d");
}

#[test]
fn an_error_stands_in_every_report_until_it_is_mended() {
    let mut s = session(json!({"bad": {"type": "root", "params": {"a": -1}}, "n": {"type": "number"}}));
    assert!(evaluate(&mut s, &[]).has_errors());
    s.set("n.value", json!(1)).expect("accepted");
    assert!(evaluate(&mut s, &[]).has_errors());
    assert!(!evaluate(&mut s, &["n.value"]).has_errors());
}

#[test]
fn a_panic_is_caught_and_named() {
    let mut s = session(json!({"p": {"type": "panic"}, "n": {"type": "number", "params": {"value": 7}}}));
    let report = evaluate(&mut s, &[]);
    assert_eq!(items(&s, "n.value"), json!([7.0]));
    let d = &report.diagnostics[0];
    assert_eq!((&*d.code, d.node.as_deref()), ("panic", Some("p")));
    assert!(d.message.contains("the sky fell"), "{d}");
}

/// An item that cannot be copied.
#[derive(Default)]
struct Brittle;

impl Clone for Brittle {
    fn clone(&self) -> Self {
        panic!("it broke")
    }
}

impl Item for Brittle {
    const TYPE: &'static str = "brittle";

    fn digest(&self, _: &mut Digester) {}

    fn to_json(&self) -> Json {
        Json::Null
    }

    fn from_json(_: &Json) -> Result<Self, String> {
        Ok(Self)
    }
}

/// A host whose disk panics.
struct Haunted;

impl Host for Haunted {
    fn read(&self, _: &str) -> std::io::Result<Arc<[u8]>> {
        panic!("boo")
    }
}

#[test]
fn a_panic_in_what_the_engine_does_with_items_and_files_is_caught_too() {
    let mut registry = Registry::new();
    registry.register_type::<Brittle>();
    let two = NodeType::new("two", 1).output(Port::list::<Brittle>("items")).run(|c| {
        c.set_list("items", vec![Brittle, Brittle]);
        Ok(())
    });
    let take =
        NodeType::new("take", 1).input(Port::tree::<Brittle>("in")).output(Port::tree::<Brittle>("out")).run(|c| {
            let tree = c.tree("in").clone();
            c.set_tree("out", tree);
            Ok(())
        });
    let read =
        NodeType::new("read", 1).input(Port::item::<Text>("path").file()).output(Port::item::<i64>("n")).run(|c| {
            c.set("n", 1i64);
            Ok(())
        });
    for node in [two, take, read] {
        registry.register(node).expect("sound");
    }
    let grafted = json!({"in": {"from": ["t.items"], "tree": ["graft"]}});
    let nodes = json!({
        "t": {"type": "two"},
        "x": {"type": "take", "inputs": grafted},
        "y": {"type": "take", "state": "bypassed", "inputs": grafted},
        "r": {"type": "read", "params": {"path": "a.txt"}},
        "good": {"type": "take", "inputs": {"in": {"from": ["t.items"]}}},
    });
    let options = Options { host: Arc::new(Haunted), ..Options::default() };
    let mut s = Session::new(Arc::new(registry), document(nodes), options);
    for _ in 0..2 {
        let report = evaluate(&mut s, &[]);
        let told: Vec<_> = report.diagnostics.iter().map(|d| (&*d.code, d.node.as_deref())).collect();
        assert_eq!(told, [("panic", Some("r")), ("panic", Some("x")), ("panic", Some("y"))]);
        assert!(report.diagnostics[0].message.contains("boo") && report.diagnostics[1].message.contains("it broke"));
        assert!(s.value("good.out").is_some() && s.value("x.out").is_none());
    }
}

#[test]
fn missing_inputs_are_named_and_block() {
    let mut s = session(json!({"a": {"type": "add"}, "b": {"type": "add", "inputs": {"a": {"from": ["a.sum"]}}}}));
    let report = evaluate(&mut s, &[]);
    assert!(lines(&report)[0].starts_with("error[missing-input] a.a:"), "{:?}", lines(&report));
    assert_eq!(report.diagnostics.len(), 2);
    s.set("a.a", json!(1)).expect("accepted");
    assert!(!evaluate(&mut s, &[]).has_errors());
    s.set("a.a", json!(null)).expect("the default is nothing");
    assert!(evaluate(&mut s, &[]).has_errors());
}

#[test]
fn unknown_nodes_block_their_successors_only() {
    let mut s = session(json!({
        "u": {"type": "from-a-plugin", "params": {"secret": 1}},
        "c": {"type": "add", "inputs": {"a": {"from": ["u.out"]}}},
        "n": {"type": "number"},
    }));
    let report = evaluate(&mut s, &[]);
    assert_eq!(report.node("u").map(|n| n.happened), Some(Happened::Blocked));
    assert_eq!(report.diagnostics.iter().filter(|d| d.severity == Severity::Error).count(), 1);
    assert_eq!(items(&s, "n.value"), json!([0.0]));
    assert_eq!(items(&s, "c.sum"), json!(null));
}

#[test]
fn disabled_nodes_give_nothing_and_frozen_ones_keep_their_last_output() {
    let nodes = |state: &str, v: f64| {
        json!({
            "n": {"type": "number", "params": {"value": v}, "state": state},
            "x": {"type": "add", "inputs": {"a": {"from": ["n.value"]}}},
        })
    };
    let mut s = session(nodes("on", 1.0));
    evaluate(&mut s, &[]);
    s.replace(document(nodes("frozen", 2.0)));
    assert!(!evaluate(&mut s, &[]).has_errors());
    assert_eq!(items(&s, "x.sum"), json!([1.0]));
    s.replace(document(nodes("disabled", 2.0)));
    let report = evaluate(&mut s, &[]);
    assert_eq!(lines(&report), ["warning[blocked] x: blocked by n, which is disabled"]);
    assert_eq!(items(&s, "x.sum"), json!(null));
    s.replace(document(nodes("on", 2.0)));
    evaluate(&mut s, &[]);
    assert_eq!(items(&s, "x.sum"), json!([2.0]));
}
