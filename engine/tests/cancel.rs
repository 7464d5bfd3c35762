//! A cancelled evaluation publishes nothing.

use crate::common::*;
use serde_json::json;
use std::sync::Mutex;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};
use tenon_engine::*;

#[test]
fn cancelled_inside_a_node_within_50_ms_and_nothing_is_published() {
    let mut s = session(json!({
        "n": {"type": "number", "params": {"value": 1}},
        "z": {"type": "sleep", "inputs": {"ms": {"from": ["n.value"]}}},
    }));
    assert!(!evaluate(&mut s, &[]).has_errors());
    log(&mut s);
    s.set("n.value", json!(60_000)).expect("accepted");
    let control = Control::default();
    let cancel = control.cancel.clone();
    let report = std::thread::scope(|scope| {
        let worker = scope.spawn(|| s.evaluate(&[], &control));
        std::thread::sleep(Duration::from_millis(50));
        let start = Instant::now();
        cancel.store(true, Ordering::Relaxed);
        let report = worker.join().expect("no panic");
        assert!(start.elapsed() < Duration::from_millis(500), "{:?}", start.elapsed());
        report
    });
    assert!(report.cancelled && report.nodes.is_empty());
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
    assert!(s.evaluate(&[], &control).cancelled);
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
    s.evaluate(&[], &Control { on_progress: Some(&on_progress), ..Control::default() });
    let seen = seen.into_inner().expect("nobody panicked");
    assert!(seen.len() >= 3 && seen.len() <= 8, "{seen:?}");
    assert!(seen.windows(2).all(|w| w[0].0 <= w[1].0) && seen.iter().all(|s| s.1 == "z"), "{seen:?}");
}
