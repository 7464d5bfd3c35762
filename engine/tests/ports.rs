//! Every parameter is a port with a default; many wires feed a list.

use crate::common::*;
use serde_json::json;
use tenon_engine::*;

#[test]
fn a_default_gives_way_to_a_literal_and_a_literal_to_a_wire() {
    let mut s = session(json!({
        "n": {"type": "number", "params": {"value": 3}},
        "d": {"type": "thick"},
        "l": {"type": "thick", "params": {"t": 20}},
        "w": {"type": "thick", "params": {"t": 20}, "inputs": {"t": {"from": ["n.value"]}}},
    }));
    assert!(!evaluate(&mut s, &[]).has_errors());
    assert_eq!((items(&s, "d.t"), items(&s, "l.t"), items(&s, "w.t")), (json!([10.0]), json!([20.0]), json!([3.0])));
}

#[test]
fn many_wires_append_in_the_order_of_from() {
    let mut s = session(json!({
        "a": {"type": "series", "params": {"count": 2, "from": 10}},
        "b": {"type": "number", "params": {"value": 5}},
        "p": {"type": "pass", "inputs": {"in": {"from": ["b.value", "a.values"]}}},
        "s": {"type": "sum", "inputs": {"values": {"from": ["a.values", "b.value"]}}},
    }));
    assert!(!evaluate(&mut s, &[]).has_errors());
    assert_eq!(items(&s, "p.out"), json!([5.0, 10.0, 11.0]));
    assert_eq!(items(&s, "s.sum"), json!([26.0]));
}

#[test]
fn what_wires_bring_can_be_put_together_without_a_session() {
    let r = Registry::new();
    let numbers = r.port("x", "number", Access::List).expect("there is such a type");
    let (whole, half) = (Tree::item(2_i64), Tree::item(0.5));
    let both = r.arriving(&numbers, &[whole.clone(), half.clone()], &[TreeOp::Reverse]).unwrap_or_default();
    assert_eq!(both, Tree::list(vec![0.5, 2.0]));
    assert_eq!(r.arriving(&numbers, &[], &[]).unwrap_or_default(), Tree::default());
    let any = r.port("x", "any", Access::Tree).expect("there is such a type");
    assert!(r.arriving(&any, &[whole, half.clone()], &[]).is_err_and(|e| e.to_string().contains("integer and number")));
    let text = Tree::item(Text::from("oak"));
    assert!(r.arriving(&numbers, &[half, text], &[]).is_err_and(|e| e.to_string().contains("takes number, but text")));
    assert!(r.port("x", "nothing like it", Access::Item).is_none());
}

#[test]
fn optional_ports_may_stay_empty() {
    let mut s = session(json!({"a": {"type": "maybe"}, "b": {"type": "maybe", "params": {"a": 2}}}));
    assert!(!evaluate(&mut s, &[]).has_errors());
    assert_eq!((items(&s, "a.value"), items(&s, "b.value")), (json!([-1.0]), json!([2.0])));
}

#[test]
fn descriptions_are_json() {
    let r = registry();
    let d = r.get("thick").map(|t| t.describe()).unwrap_or_default();
    assert_eq!(d["inputs"][0]["unit"], "mm");
    assert_eq!((d["inputs"][0]["min"].as_f64(), d["inputs"][0]["default"].as_f64()), (Some(0.1), Some(10.0)));
    assert!(r.iter().count() > 10);
}

#[test]
fn faults_of_a_node_are_named_not_panics() {
    let mut r = Registry::new();
    let node = NodeType::new("faulty", 1).input(Port::item::<f64>("a").default(1.0)).output(Port::item::<f64>("o"));
    r.register(node.run(|c| {
        c.set("o", Text::from("not a number"));
        Ok(())
    }))
    .expect("it can be registered");
    let node = NodeType::new("asks", 1).input(Port::item::<f64>("a").default(1.0)).output(Port::item::<f64>("o"));
    r.register(node.run(|c| {
        let v = c.integer("a")?;
        c.set("o", v as f64);
        Ok(())
    }))
    .expect("it can be registered");
    let nodes = document(json!({"f": {"type": "faulty"}, "g": {"type": "asks"}}));
    let mut s = Session::new(r.into(), nodes, Options::default());
    let report = evaluate(&mut s, &[]);
    assert_eq!(report.diagnostics.len(), 2);
    assert!(report.diagnostics.iter().all(|d| d.code == "node-bug"), "{:?}", lines(&report));
}

#[test]
fn calls_can_be_shared_with_other_threads() {
    fn shared<T: Sync>() {}
    shared::<Call<'_>>();
    shared::<Monitor<'_>>();
}
