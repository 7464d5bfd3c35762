//! Editing while running: nothing waits, nothing is lost, and what had finished is not done again.

use crate::common::*;
use proptest::prelude::*;
use serde_json::json;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use tenon_engine::*;

fn live(nodes: Json) -> Live {
    Live::new(registry(), document(nodes), Options::default(), || {}).expect("a thread")
}

fn number(s: &Snapshot, name: &str) -> Option<f64> {
    s.value(name).and_then(|t| t.first::<f64>().copied())
}

/// Waits until a node that shows its progress runs.
fn until_runs(live: &Live, node: &str) {
    while live.progress().is_none_or(|p| &*p.node != node) {
        std::thread::yield_now();
    }
}

/// A quick branch, and a slow node that would take a minute behind a node of its own.
fn slow() -> Json {
    json!({
        "a": {"type": "series", "params": {"count": 3}},
        "b": {"type": "sum", "inputs": {"values": {"from": ["a.values"]}}},
        "n": {"type": "add", "params": {"b": 60_000}, "inputs": {"a": {"from": ["b.sum"]}}},
        "z": {"type": "sleep", "inputs": {"ms": {"from": ["n.sum"]}}},
    })
}

#[test]
fn an_edit_stops_what_runs_and_begins_anew_without_repeating_what_had_finished() {
    let mut live = live(slow());
    until_runs(&live, "z");
    assert!(live.is_busy() && live.latest().is_none());
    let revision = live.set("n.b", json!(1)).expect("accepted");
    let snapshot = live.wait(revision).expect("it comes");
    assert_eq!((snapshot.revision(), number(&snapshot, "z.ms")), (revision, Some(4.0)));
    let happened: Vec<String> =
        snapshot.report().nodes.iter().map(|n| format!("{} {}", n.happened.as_str(), n.id)).collect();
    assert_eq!(happened, ["memo a", "memo b", "executed n", "executed z"]);
}

#[test]
fn the_last_snapshot_stays_while_the_next_one_is_made() {
    let mut live = live(slow());
    let revision = live.set("n.b", json!(0)).expect("accepted");
    let before = live.wait(revision).expect("it comes");
    live.set("n.b", json!(60_000)).expect("accepted");
    until_runs(&live, "z");
    assert_eq!(live.document().nodes()["n"].params.get("b").map(Literal::to_json), Some(json!(60_000)));
    let shown = live.latest().expect("the last one");
    assert!(Arc::ptr_eq(&before, &shown) && number(&shown, "n.sum") == Some(3.0));
    let values: Vec<String> = shown.values().map(|(id, port, _)| format!("{id}.{port}")).collect();
    assert_eq!(values, ["a.values", "b.sum", "n.sum", "z.ms"]);
}

#[test]
fn a_cancelled_evaluation_comes_back_with_the_next_change_only() {
    let mut live = live(slow());
    until_runs(&live, "z");
    live.cancel();
    assert!(live.wait(1).is_none() && !live.is_busy() && live.latest().is_none() && live.progress().is_none());
    let revision = live.set("n.b", json!(0)).expect("accepted");
    assert_eq!(live.wait(revision).and_then(|s| number(&s, "z.ms")), Some(3.0));
}

#[test]
fn under_the_lock_edits_are_collected() {
    let mut live = live(json!({"n": {"type": "number"}, "m": {"type": "number"}}));
    assert!(live.wait(1).is_some());
    live.lock(true);
    live.set("n.value", json!(1)).expect("accepted");
    let revision = live.set("m.value", json!(2)).expect("accepted");
    assert!(live.is_locked() && live.wait(revision).is_none());
    assert_eq!(live.latest().map(|s| s.revision()), Some(1));
    // Once, although the lock is on.
    live.evaluate_now();
    assert_eq!(live.wait(revision).map(|s| s.revision()), Some(revision));
    let next = live.set("n.value", json!(3)).expect("accepted");
    assert!(live.wait(next).is_none());
    live.lock(false);
    let snapshot = live.wait(next).expect("it comes");
    assert_eq!((number(&snapshot, "n.value"), number(&snapshot, "m.value")), (Some(3.0), Some(2.0)));
}

#[test]
fn many_values_are_one_step_and_one_evaluation() {
    let mut live = live(json!({"n": {"type": "number"}, "s": {"type": "add", "params": {"b": 1},
        "inputs": {"a": {"from": ["n.value"]}}}}));
    assert!(live.wait(1).is_some());
    let refused = live.set_many([("n.value", json!(5)), ("s.a", json!(1))]).expect_err("s.a has a wire");
    assert_eq!((&*refused.code, live.revision()), ("wired-input", 1));
    assert!(live.set("n.value", json!("north")).is_err() && live.set("x.value", json!(1)).is_err());
    let revision = live.set_many([("n.value", json!(5)), ("s.b", json!(10))]).expect("accepted");
    assert_eq!(revision, 2);
    assert_eq!(live.wait(2).and_then(|s| number(&s, "s.sum")), Some(15.0));
    assert_eq!((live.steps(), live.undo().expect("fits")), ((1, 0), Some(3)));
    assert_eq!(live.wait(3).and_then(|s| number(&s, "s.sum")), Some(1.0));
    assert_eq!(live.redo().expect("fits"), Some(4));
    assert_eq!(live.wait(4).and_then(|s| number(&s, "s.sum")), Some(15.0));
    assert_eq!(live.redo().expect("fits"), None);
}

#[test]
fn goals_decide_what_runs_and_unknown_ones_are_told() {
    let mut live = live(json!({"n": {"type": "number"}, "p": {"type": "panic"}}));
    let revision = live.set_goals(&["n.value", "q.value"]);
    let snapshot = live.wait(revision).expect("it comes");
    assert!(snapshot.value("p.value").is_none() && snapshot.value("n.value").is_some());
    assert_eq!(snapshot.report().diagnostics.iter().map(|d| &*d.code).collect::<Vec<_>>(), ["unknown-name"]);
    // A node that panics is that node's error; the thread goes on.
    let revision = live.set_goals(&["p.value"]);
    assert_eq!(live.wait(revision).map(|s| s.report().diagnostics[0].code.to_string()), Some("panic".into()));
    let revision = live.set("p.a", json!(-1)).expect("accepted");
    assert_eq!(live.wait(revision).and_then(|s| number(&s, "p.value")), Some(1.0));
}

#[test]
fn a_document_changed_elsewhere_is_one_step() {
    let mut live = live(slow());
    let mut nodes = slow();
    nodes["n"]["params"]["b"] = json!(2);
    nodes["c"] = json!({"type": "floor", "inputs": {"a": {"from": ["n.sum"]}}});
    let revision = live.replace(document(nodes.clone())).expect("accepted");
    assert_eq!(live.wait(revision).and_then(|s| number(&s, "c.value")), Some(5.0));
    assert_eq!(live.replace(document(nodes)).expect("the same"), revision);
    assert!(live.undo().expect("fits").is_some());
    assert_eq!(live.document().to_string_canonical(), document(slow()).to_string_canonical());
}

#[test]
fn whoever_watches_is_woken() {
    let woken = Arc::new(AtomicUsize::new(0));
    let count = woken.clone();
    let wake = move || {
        count.fetch_add(1, Ordering::SeqCst);
    };
    let live =
        Live::new(registry(), document(json!({"n": {"type": "number"}})), Options::default(), wake).expect("a thread");
    assert!(live.wait(1).is_some());
    drop(live);
    assert!(woken.load(Ordering::SeqCst) > 0);
}

#[test]
fn dropping_stops_what_runs() {
    let live = live(slow());
    until_runs(&live, "z");
    // It would take a minute.
    drop(live);
}

#[derive(Clone, Debug)]
enum Step {
    Set(usize, i32),
    Wire(usize, usize),
    Unwire(usize),
    Remove(usize),
    Add(usize),
    State(usize, NodeState),
    Goal(usize),
    AllGoals,
    Undo,
    Redo,
    Cancel,
    Lock,
    Unlock,
    Wait,
    Pause(u64),
}

const SPAN: usize = 8;

fn step() -> impl Strategy<Value = Step> {
    let state = prop_oneof![Just(NodeState::On), Just(NodeState::Disabled)];
    prop_oneof![
        6 => (0..SPAN, -2..3).prop_map(|(n, v)| Step::Set(n, v)),
        4 => (0..SPAN, 0..SPAN).prop_map(|(a, b)| Step::Wire(a, b)),
        1 => (0..SPAN).prop_map(Step::Unwire),
        1 => (0..SPAN).prop_map(Step::Remove),
        2 => (0..SPAN).prop_map(Step::Add),
        1 => (0..SPAN, state).prop_map(|(n, s)| Step::State(n, s)),
        1 => (0..SPAN).prop_map(Step::Goal),
        1 => Just(Step::AllGoals),
        1 => Just(Step::Undo),
        1 => Just(Step::Redo),
        1 => Just(Step::Cancel),
        1 => Just(Step::Lock),
        1 => Just(Step::Unlock),
        1 => Just(Step::Wait),
        3 => (0..2000_u64).prop_map(Step::Pause),
    ]
}

fn id(n: usize) -> String {
    format!("n{n}")
}

/// A chain whose nodes take about a millisecond each, so that edits come while it runs.
fn millisecond(n: usize) -> Node {
    Node::new("sleep").param("ms", 1.0 + n as f64 / 8.0)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn whatever_is_edited_while_it_runs_the_end_is_as_if_it_were_evaluated_afresh(
        steps in proptest::collection::vec(step(), 1..60),
    ) {
        let mut start = Document::new();
        for n in 0..SPAN {
            start.insert(id(n), millisecond(n)).expect("an id");
        }
        let mut live = Live::new(registry(), start, Options { threads: 2, ..Options::default() }, || {}).expect("a thread");
        let mut goals = Vec::new();
        for step in steps {
            // Some are refused: a wire from a node that is gone.
            match step {
                Step::Set(n, v) => drop(live.set(&format!("n{n}.ms"), json!(v))),
                Step::Wire(a, b) => {
                    let (from, to) = (a.min(b), a.max(b));
                    let wire = Operation::Connect { node: id(to), port: "ms".into(), from: format!("n{from}.ms"), at: None };
                    drop(live.apply(wire));
                }
                Step::Unwire(n) => drop(live.apply(Operation::PutWires { node: id(n), port: "ms".into(), wires: None })),
                Step::Remove(n) => drop(live.apply(Operation::RemoveNode { id: id(n) })),
                Step::Add(n) => drop(live.apply(Operation::AddNode { id: id(n), node: Box::new(millisecond(n)) })),
                Step::State(n, state) => drop(live.apply(Operation::SetState { node: id(n), state })),
                Step::Goal(n) => {
                    goals = vec![format!("n{n}.ms")];
                    live.set_goals(&[&goals[0]]);
                }
                Step::AllGoals => {
                    goals.clear();
                    live.set_goals(&[]);
                }
                Step::Undo => drop(live.undo().expect("the history fits")),
                Step::Redo => drop(live.redo().expect("the history fits")),
                Step::Cancel => live.cancel(),
                Step::Lock => live.lock(true),
                Step::Unlock => live.lock(false),
                Step::Wait => drop(live.wait(live.revision())),
                Step::Pause(us) => std::thread::sleep(std::time::Duration::from_micros(us)),
            }
        }
        live.lock(false);
        live.evaluate_now();
        let last = live.wait(live.revision()).expect("it comes");
        prop_assert_eq!(last.revision(), live.revision());
        let mut fresh = Session::new(registry(), live.document().clone(), Options::default());
        let goals: Vec<&str> = goals.iter().map(String::as_str).collect();
        let report = evaluate(&mut fresh, &goals);
        prop_assert_eq!(&last.report().diagnostics, &report.diagnostics);
        for id in live.document().nodes().keys() {
            let name = format!("{id}.ms");
            let digest = |t: Option<&Tree>| t.map(Tree::digest);
            prop_assert_eq!(digest(last.value(&name)), digest(fresh.value(&name).as_ref()), "{}", name);
        }
    }
}
