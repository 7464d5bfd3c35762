//! Every caching rule by the log of events: states, blocking, transactions, matching, files, eviction, cancelling. Cut-off,
//! memo and demand stand in `cache.rs`.

use crate::common::*;
use serde_json::json;
use std::sync::atomic::Ordering;
use tenon_engine::*;

fn chain() -> Json {
    json!({
        "a": {"type": "number", "params": {"value": 1}},
        "b": {"type": "add", "params": {"b": 1}, "inputs": {"a": {"from": ["a.value"]}}},
        "c": {"type": "floor", "inputs": {"a": {"from": ["b.sum"]}}},
    })
}

fn evaluated(nodes: Json) -> Session {
    let mut s = session(nodes);
    evaluate(&mut s, &[]);
    log(&mut s);
    s
}

fn state(s: &mut Session, node: &str, state: NodeState) -> Operation {
    s.edit(&Operation::SetState { node: node.into(), state }).expect("accepted")
}

#[test]
fn a_frozen_node_keeps_its_output_and_nothing_behind_it_runs() {
    let mut s = evaluated(chain());
    state(&mut s, "b", NodeState::Frozen);
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "cut off a, cut off c");
    s.set("a.value", json!(5)).expect("accepted");
    let report = evaluate(&mut s, &[]);
    assert_eq!((log(&mut s), items(&s, "c.value")), ("executed a".to_owned(), json!([2.0])));
    assert_eq!(report.node("b").map(|n| n.happened), Some(Happened::Frozen));
    state(&mut s, "b", NodeState::On);
    evaluate(&mut s, &[]);
    assert_eq!((log(&mut s), items(&s, "c.value")), ("cut off a, executed b, executed c".to_owned(), json!([6.0])));
}

#[test]
fn a_node_that_is_frozen_after_other_edits_still_keeps_what_it_had_last() {
    let mut s = evaluated(chain());
    s.edit(&Operation::SetParam { node: "a".into(), port: "value".into(), value: Some(json!(5)) }).expect("accepted");
    let wires = Operation::Disconnect { node: "c".into(), port: "a".into(), from: "b.sum".into() };
    let back = s.edit(&wires).expect("accepted");
    s.edit(&back).expect("accepted");
    state(&mut s, "b", NodeState::Frozen);
    evaluate(&mut s, &[]);
    assert_eq!((log(&mut s), items(&s, "c.value")), ("executed a, cut off c".to_owned(), json!([2.0])));
}

#[test]
fn a_node_that_is_frozen_before_it_ever_ran_runs_once() {
    let mut nodes = chain();
    nodes["b"]["state"] = json!("frozen");
    let mut s = session(nodes);
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "executed a, executed b, executed c");
    s.set("a.value", json!(5)).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "executed a");
}

#[test]
fn a_disabled_node_blocks_and_comes_back_from_the_memo() {
    let mut s = evaluated(chain());
    let back = state(&mut s, "b", NodeState::Disabled);
    let report = evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "cut off a, blocked c by b");
    assert_eq!(lines(&report), ["warning[blocked] c: blocked by b, which is disabled"]);
    s.edit(&back).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!((log(&mut s), items(&s, "c.value")), ("cut off a, memo b, memo c".to_owned(), json!([2.0])));
}

#[test]
fn a_bypassed_node_passes_on_what_comes_in_and_cuts_off_like_any_other() {
    let mut s = evaluated(chain());
    state(&mut s, "b", NodeState::Bypassed);
    let report = evaluate(&mut s, &[]);
    assert_eq!((log(&mut s), items(&s, "c.value")), ("cut off a, executed c".to_owned(), json!([1.0])));
    assert_eq!(report.node("b").map(|n| n.happened), Some(Happened::Bypassed));
    // A parameter that is not passed on changes nothing behind it.
    s.set("b.b", json!(7)).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "");
    s.set("a.value", json!(4)).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!((log(&mut s), items(&s, "c.value")), ("executed a, executed c".to_owned(), json!([4.0])));
    state(&mut s, "b", NodeState::On);
    evaluate(&mut s, &[]);
    assert_eq!((log(&mut s), items(&s, "c.value")), ("cut off a, executed b, executed c".to_owned(), json!([11.0])));
}

/// Two outputs of one type and one of another; three inputs.
fn twins() -> Registry {
    let mut r = Registry::new();
    let number = |name: &'static str| Port::item::<f64>(name);
    let nodes = [
        NodeType::new("number", 1).input(number("value").default(0.0)).output(number("value")).run(|c| {
            let v = c.number("value")?;
            c.set("value", v);
            Ok(())
        }),
        NodeType::new("twins", 1)
            .input(Port::item::<Text>("name").default("x"))
            .input(number("x").default(1.0))
            .input(Port::list::<f64>("y").default(json!([2.0])))
            .output(number("p"))
            .output(number("q"))
            .output(number("r"))
            .run(|_| Ok(())),
    ];
    for node in nodes {
        r.register(node).expect("sound");
    }
    r
}

#[test]
fn outputs_of_a_bypassed_node_take_the_wires_of_their_type_in_order() {
    let nodes = |wired: &[&str]| {
        let wires = wired.iter().map(|port| ((*port).to_owned(), json!({"from": [format!("{port}.value")]})));
        json!({
            "x": {"type": "number", "params": {"value": 10}},
            "y": {"type": "number", "params": {"value": 20}},
            "t": {"type": "twins", "state": "bypassed", "inputs": wires.collect::<serde_json::Map<_, _>>()},
            "p": {"type": "number", "inputs": {"value": {"from": ["t.p"]}}},
            "q": {"type": "number", "inputs": {"value": {"from": ["t.q"]}}},
            "r": {"type": "number", "inputs": {"value": {"from": ["t.r"]}}},
        })
    };
    let run = |wired: &[&str]| {
        let mut s = Session::new(std::sync::Arc::new(twins()), document(nodes(wired)), Options::default());
        let report = evaluate(&mut s, &[]);
        let values = ["p.value", "q.value", "r.value"].map(|name| items(&s, name));
        (values, lines(&report))
    };
    let none = |node| {
        format!("warning[blocked] {node}: blocked by t, which is bypassed and has no wire of that type to pass on")
    };
    assert_eq!(run(&["x", "y"]), ([json!([10.0]), json!([20.0]), json!(null)], vec![none("r")]));
    // Literals and defaults are not passed, so the wire at y goes to the first output.
    assert_eq!(run(&["y"]), ([json!([20.0]), json!(null), json!(null)], vec![none("q"), none("r")]));
}

#[test]
fn what_was_blocked_runs_once_the_failure_is_mended() {
    let mut s = session(json!({
        "bad": {"type": "root", "params": {"a": -1}},
        "c": {"type": "floor", "inputs": {"a": {"from": ["bad.value"]}}},
    }));
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "failed bad, blocked c by bad");
    // Still blocked by the same node: nothing to tell those behind.
    s.set("bad.a", json!(-2)).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "failed bad, cut off bad");
    s.set("bad.a", json!(4)).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "executed bad, executed c");
}

#[test]
fn a_transaction_is_evaluated_once() {
    let mut s = evaluated(chain());
    let param = |node: &str, port: &str, value: f64| Operation::SetParam {
        node: node.into(),
        port: port.into(),
        value: Some(json!(value)),
    };
    let all = Operation::All(vec![param("a", "value", 2.0), param("b", "b", 5.0), param("a", "value", 3.0)]);
    let back = s.edit(&all).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!((log(&mut s), items(&s, "c.value")), ("executed a, executed b, executed c".to_owned(), json!([8.0])));
    s.edit(&back).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!((log(&mut s), items(&s, "c.value")), ("memo a, memo b, memo c".to_owned(), json!([2.0])));
}

#[test]
fn another_matching_is_another_input() {
    let lists = |count| json!({"type": "series", "params": {"count": count}});
    let mut s = evaluated(json!({
        "p": lists(3),
        "q": lists(2),
        "x": {"type": "add", "inputs": {"a": {"from": ["p.values"]}, "b": {"from": ["q.values"]}}},
    }));
    let shortest = Operation::SetMatching { node: "x".into(), matching: Some(Matching::Shortest) };
    let back = s.edit(&shortest).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!((log(&mut s), items(&s, "x.sum")), ("cut off p, cut off q, executed x".to_owned(), json!([0.0, 2.0])));
    s.edit(&back).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!((log(&mut s), items(&s, "x.sum")), ("cut off p, cut off q, memo x".to_owned(), json!([0.0, 2.0, 3.0])));
}

#[test]
fn a_formula_follows_the_input_that_an_operation_sets() {
    let text = json!({
        "format": "tenon", "version": 1, "units": "mm",
        "interface": {"inputs": {"t": {"port": "a.value"}}},
        "nodes": {
            "a": {"type": "number", "params": {"value": 1}},
            "b": {"type": "floor", "params": {"a": "t * 2"}},
        },
    });
    let document = Document::from_slice(text.to_string().as_bytes()).expect("sound");
    let mut s = Session::new(registry(), document, Options::default());
    evaluate(&mut s, &[]);
    log(&mut s);
    let set = |value: f64| Operation::SetParam { node: "a".into(), port: "value".into(), value: Some(json!(value)) };
    s.edit(&set(3.0)).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!((log(&mut s), items(&s, "b.value")), ("executed a, executed b".to_owned(), json!([6.0])));
}

/// A quick node, and one behind it that takes as long as it is told.
fn slow() -> Json {
    json!({
        "a": {"type": "number", "params": {"value": 1}},
        "b": {"type": "add", "params": {"b": 60_000}, "inputs": {"a": {"from": ["a.value"]}}},
        "y": {"type": "sleep", "params": {"ms": 3}},
        "z": {"type": "sleep", "inputs": {"ms": {"from": ["b.sum"]}}},
    })
}

/// Evaluates and cancels once `z` runs.
fn cancel_in_z(s: &mut Session) {
    let control = Control::default();
    let cancel = control.cancel.clone();
    let stop = |p: &Progress| {
        if &*p.node == "z" {
            cancel.store(true, Ordering::Relaxed);
        }
    };
    let report = s.evaluate(&[], &Control { on_progress: Some(&stop), ..control.clone() });
    assert!(report.cancelled);
}

#[test]
fn what_had_finished_before_a_cancellation_is_not_done_again() {
    let mut s = session(slow());
    cancel_in_z(&mut s);
    assert_eq!((log(&mut s), items(&s, "a.value")), ("cancelled".to_owned(), json!(null)));
    s.set("y.ms", json!(4)).expect("accepted");
    cancel_in_z(&mut s);
    log(&mut s);
    s.set("b.b", json!(0)).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "memo a, memo y, executed b, executed z");
}

#[test]
fn a_small_budget_does_not_lose_what_a_cancelled_evaluation_had_finished() {
    let mut s = Session::new(registry(), document(slow()), Options { cache_bytes: 0, ..Options::default() });
    cancel_in_z(&mut s);
    log(&mut s);
    s.set("z.ms", json!(0)).expect_err("it has a wire");
    s.set("b.b", json!(0)).expect("accepted");
    evaluate(&mut s, &["z.ms"]);
    assert_eq!(log(&mut s), "memo a, executed b, executed z, evicted a, evicted b");
    assert_eq!(s.cache_bytes(), 0);
}

#[test]
fn a_frozen_node_that_is_renamed_keeps_its_output() {
    let mut s = session(json!({
        "n": {"type": "number", "params": {"value": 1}},
        "a": {"type": "add", "inputs": {"a": {"from": ["n.value"]}}, "params": {"b": 10}},
        "b": {"type": "number", "inputs": {"value": {"from": ["a.sum"]}}},
    }));
    evaluate(&mut s, &[]);
    let rename = |from: &str, to: &str| Operation::Rename { from: from.into(), to: to.into() };
    s.edit(&Operation::SetState { node: "a".into(), state: NodeState::Frozen }).expect("it is there");
    s.set("n.value", json!(2)).expect("accepted");
    // Through a third name, while another node takes the first.
    let there = Operation::All(vec![rename("a", "c"), rename("n", "a"), rename("c", "kept")]);
    let back = s.edit(&there).expect("all names are free then");
    evaluate(&mut s, &[]);
    assert_eq!(
        (items(&s, "a.value"), items(&s, "kept.sum"), items(&s, "b.value")),
        (json!([2.0]), json!([11.0]), json!([11.0]))
    );
    s.edit(&back).expect("it was so before");
    evaluate(&mut s, &[]);
    assert_eq!(
        (items(&s, "n.value"), items(&s, "a.sum"), items(&s, "b.value")),
        (json!([2.0]), json!([11.0]), json!([11.0]))
    );
    // Once it is on again, it is what comes in.
    s.edit(&Operation::SetState { node: "a".into(), state: NodeState::On }).expect("it is there");
    evaluate(&mut s, &[]);
    assert_eq!(items(&s, "b.value"), json!([12.0]));
}

/// A session with two types more: `negative` says that it is cheap, and `dear` takes a while.
fn with_cheap_and_dear(nodes: Json, cache_bytes: usize) -> Session {
    let number = |n: &'static str| Port::item::<f64>(n);
    let mut all = Registry::new();
    let types = [
        NodeType::new("negative", 1).cheap().input(number("a").default(1.0)).output(number("value")).run(|c| {
            let v = -c.number("a")?;
            c.set("value", v);
            Ok(())
        }),
        NodeType::new("dear", 1).input(number("a").default(1.0)).output(number("value")).run(|c| {
            std::thread::sleep(std::time::Duration::from_millis(30));
            let v = c.number("a")?;
            c.set("value", v);
            Ok(())
        }),
        NodeType::new("long", 1).input(number("a").default(1.0)).output(Port::list::<f64>("values")).run(|c| {
            let v = c.number("a")?;
            c.set_list("values", (0..20_000).map(|i| v + f64::from(i)).collect());
            Ok(())
        }),
    ];
    for t in types {
        all.register(t).expect("test nodes are sound");
    }
    Session::new(std::sync::Arc::new(all), document(nodes), Options { cache_bytes, ..Options::default() })
}

#[test]
fn cheap_nodes_run_again_rather_than_being_remembered_and_keep_what_they_gave() {
    for budget in [1 << 30, 0] {
        let mut s = with_cheap_and_dear(json!({"n": {"type": "negative"}}), budget);
        for (a, expected) in [(1, "executed n"), (2, "executed n"), (1, "executed n")] {
            s.set("n.a", json!(a)).expect("accepted");
            evaluate(&mut s, &[]);
            assert_eq!((log(&mut s), items(&s, "n.value")), (expected.to_owned(), json!([-f64::from(a)])));
        }
        assert_eq!(s.cache_bytes(), 0);
    }
}

#[test]
fn what_is_dear_and_small_stays_longer_than_what_is_quick_and_large() {
    // Room for one list and some numbers.
    let mut s = with_cheap_and_dear(json!({"a": {"type": "dear"}, "b": {"type": "long"}}), 250_000);
    for v in [1, 2] {
        s.set("a.a", json!(v)).expect("accepted");
        s.set("b.a", json!(v)).expect("accepted");
        evaluate(&mut s, &[]);
        assert_eq!(log(&mut s), "executed a, executed b");
    }
    s.set("a.a", json!(1)).expect("accepted");
    s.set("b.a", json!(1)).expect("accepted");
    evaluate(&mut s, &[]);
    // Which of the lists went depends on how long each took.
    let said = log(&mut s);
    assert!(said.starts_with("memo a, ") && s.cache_bytes() <= 250_000, "{said}, {}", s.cache_bytes());
}

#[test]
fn a_frozen_node_is_never_evicted() {
    let mut nodes = json!({"a": {"type": "dear"}, "b": {"type": "long", "inputs": {"a": {"from": ["a.value"]}}}});
    nodes["a"]["state"] = json!("frozen");
    let mut s = with_cheap_and_dear(nodes, 0);
    evaluate(&mut s, &["b.values"]);
    assert_eq!(log(&mut s), "executed a, executed b");
    s.edit(&Operation::SetParam { node: "a".into(), port: "a".into(), value: Some(json!(5)) }).expect("accepted");
    evaluate(&mut s, &["b.values"]);
    assert_eq!((log(&mut s), items(&s, "a.value")), (String::new(), json!([1.0])));
}
