//! A cancelled evaluation publishes nothing.

use crate::common::*;
use serde_json::json;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};
use tenon_engine::*;

// How soon is measured by `cargo xtask bench cancel`; here only that it does not wait for the node.
#[test]
fn cancelled_inside_a_node_nothing_is_published() {
    let mut s = session(json!({
        "n": {"type": "number", "params": {"value": 1}},
        "z": {"type": "sleep", "inputs": {"ms": {"from": ["n.value"]}}},
    }));
    assert!(!evaluate(&mut s, &[]).has_errors());
    log(&mut s);
    s.set("n.value", json!(60_000)).expect("accepted");
    let control = Control::default();
    let midway = |p: &Progress| control.cancel.store(&*p.node == "z" && p.fraction > 0.0, Ordering::Relaxed);
    let start = Instant::now();
    let report = s.evaluate(&[], &Control { cancel: control.cancel.clone(), on_progress: Some(&midway) });
    assert!(start.elapsed() < Duration::from_secs(30), "{:?}", start.elapsed());
    assert!(report.cancelled && report.nodes.is_empty());
    assert_eq!(report.stopped_at.as_deref(), Some("z"));
    assert_eq!((items(&s, "n.value"), items(&s, "z.ms")), (json!([1.0]), json!([1.0])));
    assert_eq!(log(&mut s), "cancelled");
    // What was to be done is still to be done.
    s.set("n.value", json!(2)).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!(items(&s, "z.ms"), json!([2.0]));
}

#[test]
fn cancelled_before_it_begins() {
    let mut s = session(json!({"n": {"type": "number"}}));
    let control = Control::default();
    control.cancel.store(true, Ordering::Relaxed);
    let report = s.evaluate(&[], &control);
    assert!(report.cancelled && report.stopped_at.is_none());
    assert!(s.value("n.value").is_none());
    evaluate(&mut s, &[]);
    assert_eq!(items(&s, "n.value"), json!([0.0]));
}

#[test]
fn progress_grows_and_names_the_node() {
    let mut s = session(json!({"z": {"type": "sleep", "params": {"ms": 150}}}));
    let seen = Mutex::new(Vec::new());
    let on_progress = |p: &Progress| {
        if let Ok(mut seen) = seen.lock() {
            seen.push((p.fraction, p.node.to_string()));
        }
    };
    let start = Instant::now();
    s.evaluate(&[], &Control { on_progress: Some(&on_progress), ..Control::default() });
    let seen = seen.into_inner().expect("nobody panicked");
    // About 30 times a second.
    let most = 2 + start.elapsed().as_millis() as usize / 30;
    assert!(seen.len() >= 3 && seen.len() <= most, "{} of {most}: {seen:?}", seen.len());
    assert!(seen.windows(2).all(|w| w[0].0 <= w[1].0) && seen.iter().all(|s| s.1 == "z"), "{seen:?}");
}

#[test]
fn progress_is_by_what_nodes_of_a_type_have_taken_before() {
    let mut nodes = json!({"s0": {"type": "series", "params": {"count": 3}}});
    for i in 1..=10 {
        let from = format!("s{}.values", i - 1);
        nodes[format!("s{i}")] =
            json!({"type": "series", "inputs": {"from": {"from": [from]}}, "params": {"count": 1}});
    }
    nodes["z"] = json!({"type": "sleep", "params": {"ms": 120}});
    let mut s = session(nodes);
    evaluate(&mut s, &[]);
    s.set("s0.from", json!(7)).expect("accepted");
    s.set("z.ms", json!(150)).expect("accepted");
    let seen = Mutex::new(Vec::new());
    let on_progress = |p: &Progress| seen.lock().expect("nobody panicked").push((p.fraction, p.node.to_string()));
    s.evaluate(&[], &Control { on_progress: Some(&on_progress), ..Control::default() });
    let seen = seen.into_inner().expect("nobody panicked");
    // Eleven nodes of thirteen are done when it is not yet half-way through the one that takes long.
    let halves = seen.iter().filter(|(fraction, node)| node == "z" && (0.05..0.6).contains(fraction)).count();
    assert!(halves >= 2, "{seen:?}");
}

#[test]
fn progress_counts_no_work_that_was_remembered() {
    let mut s = session(json!({
        "a": {"type": "sleep", "params": {"ms": 120}},
        "more": {"type": "add", "params": {"b": 1}, "inputs": {"a": {"from": ["a.ms"]}}},
        "b": {"type": "sleep", "inputs": {"ms": {"from": ["more.sum"]}}},
        "still": {"type": "add", "params": {"b": 1}, "inputs": {"a": {"from": ["b.ms"]}}},
        "c": {"type": "sleep", "inputs": {"ms": {"from": ["still.sum"]}}},
    }));
    // The first two are done and remembered, though the whole was cancelled.
    let control = Control::default();
    let stop = |p: &Progress| control.cancel.store(&*p.node == "c", Ordering::Relaxed);
    let watched = Control { cancel: control.cancel.clone(), on_progress: Some(&stop) };
    assert_eq!(s.evaluate(&[], &watched).stopped_at.as_deref(), Some("c"));
    let seen = Mutex::new(Vec::new());
    let on_progress = |p: &Progress| seen.lock().expect("nobody panicked").push((p.fraction, p.node.to_string()));
    s.evaluate(&[], &Control { on_progress: Some(&on_progress), ..Control::default() });
    let seen = seen.into_inner().expect("nobody panicked");
    assert!(seen.iter().all(|(_, node)| node == "c"), "{seen:?}");
    let (first, last) = (seen[0].0, seen[seen.len() - 1].0);
    assert!(first < 0.4 && last > 0.6, "all that is left to do is c: {seen:?}");
}

/// Every item of the list that carries the fuse counts its copies; one of them stops the evaluation.
static FUSE: Mutex<Option<(usize, Arc<AtomicBool>)>> = Mutex::new(None);
static COPIES: AtomicUsize = AtomicUsize::new(0);

#[derive(Default)]
struct Fused(u64);

impl Clone for Fused {
    fn clone(&self) -> Self {
        let copies = COPIES.fetch_add(1, Ordering::Relaxed) + 1;
        if copies.is_multiple_of(128)
            && let Some((at, flag)) = &*FUSE.lock().expect("nobody panics with it")
            && copies >= *at
        {
            flag.store(true, Ordering::Relaxed);
        }
        Self(self.0)
    }
}

impl Item for Fused {
    const TYPE: &'static str = "fused";

    fn digest(&self, d: &mut Digester) {
        d.u64(self.0);
    }

    fn to_json(&self) -> Json {
        json!(self.0)
    }

    fn from_json(_: &Json) -> Result<Self, String> {
        Ok(Self::default())
    }
}

const MANY: u64 = 200_000;

fn fused_registry() -> Arc<Registry> {
    let mut r = Registry::new();
    r.register_type::<Fused>();
    let tree = |name: &'static str| Port::tree::<Fused>(name);
    for node in [
        NodeType::new("many", 1).output(Port::list::<Fused>("items")).run(|c| {
            c.set_list("items", (0..MANY).map(Fused).collect());
            Ok(())
        }),
        NodeType::new("rows", 1).output(tree("tree")).run(|c| {
            let row = |i: u64| (Path::new(vec![i as i32]), Column::new(vec![Fused(2 * i), Fused(2 * i + 1)]));
            c.set_tree("tree", Tree::from_branches((0..MANY / 2).map(row).collect()));
            Ok(())
        }),
        NodeType::new("take", 1).input(tree("in")).output(tree("tree")).run(|c| {
            let tree = c.tree("in").clone();
            c.set_tree("tree", tree);
            Ok(())
        }),
        NodeType::new("each", 1).input(Port::item::<Fused>("in")).output(Port::item::<Fused>("out")).run(|c| {
            let item = c.item::<Fused>("in")?.clone();
            c.set("out", item);
            Ok(())
        }),
        NodeType::new("pick", 1).input(Port::any("in", Access::List)).output(Port::any("out", Access::List)).run(|c| {
            let list = c.column("in")?;
            let picked = list.pick(&(0..list.len()).map(Some).collect::<Vec<_>>());
            c.set_column("out", picked);
            Ok(())
        }),
    ] {
        r.register(node).expect("test nodes are sound");
    }
    Arc::new(r)
}

#[test]
fn long_work_of_the_engine_itself_is_left_in_the_middle_and_leaves_nothing_behind() {
    let port =
        |from: &str, shape: &str| json!({"x": {"type": "take", "inputs": {"in": {"from": [from], "tree": [shape]}}}});
    let cases = [
        port("many.items", "graft"),
        port("rows.tree", "flatten"),
        port("many.items", "reverse"),
        json!({"x": {"type": "take", "inputs": {"in": {"from": ["many.items", "rows.tree"]}}}}),
        json!({"x": {"type": "each", "inputs": {"in": {"from": ["many.items"]}}}}),
        json!({"x": {"type": "each", "inputs": {"in": {"from": ["rows.tree"]}}}}),
        json!({"x": {"type": "pick", "inputs": {"in": {"from": ["many.items"]}}}}),
        json!({"x": {"type": "take", "state": "bypassed", "inputs": {"in": {"from": ["many.items"], "tree": ["graft"]}}}}),
    ];
    for mut nodes in cases {
        nodes["many"] = json!({"type": "many"});
        nodes["rows"] = json!({"type": "rows"});
        let options = Options { threads: 2, ..Options::default() };
        let mut s = Session::new(fused_registry(), document(nodes.clone()), options.clone());
        let inputs = ["many.items", "rows.tree"];
        assert!(!evaluate(&mut s, &inputs).has_errors());
        log(&mut s);

        let control = Control::default();
        let at = 20_000;
        COPIES.store(0, Ordering::Relaxed);
        *FUSE.lock().expect("nobody panics with it") = Some((at, control.cancel.clone()));
        let report = s.evaluate(&[], &control);
        *FUSE.lock().expect("nobody panics with it") = None;
        let copies = COPIES.load(Ordering::Relaxed);
        assert!(report.cancelled && report.nodes.is_empty(), "{nodes}: {copies} copied, {:?}", lines(&report));
        // Two threads may each be in the middle of a stride.
        assert!((at..at + 128 + 2 * stop::STRIDE).contains(&copies), "{nodes}: {copies} of {MANY} were copied");
        let of_x = if nodes["x"]["type"] == "take" { "x.tree" } else { "x.out" };
        assert!(s.value(of_x).is_none() && inputs.iter().all(|i| s.value(i).is_some()), "{nodes}");
        assert_eq!(log(&mut s), "cancelled", "{nodes}");

        // Nothing of it was remembered: it runs, and comes to what a fresh session comes to.
        let again = evaluate(&mut s, &[of_x]);
        let ran = again.node("x").map(|n| n.happened);
        assert!(matches!(ran, Some(Happened::Executed | Happened::Bypassed)), "{nodes}: {ran:?}");
        let mut fresh = Session::new(fused_registry(), document(nodes.clone()), options);
        evaluate(&mut fresh, &[of_x]);
        assert!(!again.has_errors() && s.value(of_x).is_some() && s.value(of_x) == fresh.value(of_x), "{nodes}");
    }
}
