//! Small random graphs of the nodes for lists, trees, numbers and texts, with parameters that nobody would write: every
//! fault is told, none is ours, and two threads give what one gives.

use super::bytes::Bytes;
use super::{check_report, registry};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, Once, PoisonError};
use std::time::{Duration, Instant};
use tenon_engine::{
    Control, Document, Json, Matching, Name, Node, NodeState, NodeType, Operation, Options, Report, Session, TreeOp,
    Wires,
};

/// Folders of the catalogue whose nodes cost little, whatever comes in.
const CATEGORIES: [&str; 4] = ["Parameters", "Numbers", "Trees", "Text"];

fn literal(b: &mut Bytes<'_>) -> Json {
    match b.below(12) {
        0 => Json::from(b.byte() % 8),
        1 => Json::from(-i64::from(b.byte() % 8)),
        2 => Json::from(*b.of(&[0.5, -0.0, 1e308, -1e308, 5e-324, 2.5, 1e-9])),
        3 => Json::from(*b.of(&[i64::MAX, i64::MIN, 1 << 53, -(1 << 53)])),
        4 => Json::from(*b.of(&[
            "",
            "a",
            "a * 2",
            "{a} {b:05.2}",
            "{}",
            "sum",
            "ä\u{1F332}",
            "max(a, b)",
            "a / b",
            "x^y",
        ])),
        5 => Json::from(b.below(2) == 0),
        6 => (0..b.below(7)).map(|_| Json::from(i64::from(b.byte() % 9) - 3)).collect(),
        7 => (0..b.below(5)).map(|i| if b.below(3) == 0 { Json::Null } else { Json::from(i) }).collect(),
        8 => (0..b.below(4)).map(|_| Json::from(vec![f64::from(b.byte()), 0.0, 1e300])).collect(),
        9 => serde_json::json!({"value": b.byte() % 9, "unit": b.of(&["mm", "deg", "kg", ""])}),
        10 => serde_json::json!({"{0;1}": [1, 2], "{3}": [3], "{-1}": []}),
        _ => Json::Null,
    }
}

fn node(b: &mut Bytes<'_>, types: &[&NodeType], earlier: &[(String, &NodeType)]) -> Node {
    let t = b.of(types);
    let mut node = Node::new(t.type_name());
    node.version = t.version();
    for port in t.inputs() {
        match b.below(4) {
            0 | 1 if !earlier.is_empty() => {
                let mut wires = Wires::default();
                for _ in 0..1 + b.below(2) {
                    let (id, from) = b.of(earlier);
                    let from = Name::from(format!("{id}.{}", b.of(from.outputs()).name()));
                    if !wires.from.contains(&from) {
                        wires.from.push(from);
                    }
                }
                if b.below(3) == 0 {
                    let ops = [TreeOp::Graft, TreeOp::Flatten, TreeOp::Simplify, TreeOp::Reverse];
                    wires.more.tree.push(*b.of(&ops));
                }
                node.inputs.insert(port.name(), wires);
            }
            2 => {
                node.params.insert(port.name(), literal(b));
            }
            _ => {}
        }
    }
    node.matching = [None, Some(Matching::Cross), Some(Matching::Shortest), None][b.below(4)];
    if b.below(12) == 0 {
        node.state = if b.below(2) == 0 { NodeState::Disabled } else { NodeState::Frozen };
    }
    node
}

fn told(report: &Report) -> Vec<String> {
    report.diagnostics.iter().map(ToString::to_string).collect()
}

/// Flags that go up once an evaluation takes this long: crossed lists may come to hours of work.
const LONGEST: Duration = Duration::from_secs(2);

/// The evaluation, unless it took too long and was cancelled.
fn evaluate(session: &mut Session) -> Option<Report> {
    static RUNNING: Mutex<Option<(Instant, Arc<AtomicBool>)>> = Mutex::new(None);
    static WATCH: Once = Once::new();
    WATCH.call_once(|| {
        std::thread::spawn(|| {
            loop {
                std::thread::sleep(Duration::from_millis(100));
                let running = RUNNING.lock().unwrap_or_else(PoisonError::into_inner);
                if let Some((start, flag)) = &*running
                    && start.elapsed() > LONGEST
                {
                    flag.store(true, Ordering::Relaxed);
                }
            }
        });
    });
    let control = Control::default();
    let tell = |running| *RUNNING.lock().unwrap_or_else(PoisonError::into_inner) = running;
    tell(Some((Instant::now(), control.cancel.clone())));
    let report = session.evaluate(&[], &control);
    tell(None);
    (!report.cancelled).then_some(report)
}

pub fn check(bytes: &[u8]) {
    let mut b = Bytes(bytes);
    let types: Vec<&NodeType> =
        registry().iter().map(|t| &**t).filter(|t| CATEGORIES.contains(&t.category_name())).collect();
    assert!(types.len() > 20);
    let mut document = Document::new();
    let mut earlier: Vec<(String, &NodeType)> = Vec::new();
    while !b.is_empty() && earlier.len() < 7 {
        let node = node(&mut b, &types, &earlier);
        let Some(t) = registry().get(&node.type_name) else { return };
        let id = format!("n{}", document.nodes().len());
        let added = Operation::AddNode { id: id.clone(), node: Box::new(node) }.apply(&mut document);
        added.unwrap_or_else(|e| panic!("{e}"));
        if !t.outputs().is_empty() {
            earlier.push((id, t));
        }
    }
    if std::env::var_os("TENON_FUZZ_SHOW").is_some() {
        println!("{}", document.to_string_canonical());
    }
    let mut session = Session::new(registry().clone(), document.clone(), Options { threads: 1, ..Options::default() });
    let Some(report) = evaluate(&mut session) else { return };
    check_report(&report);
    let mut more =
        Session::new(registry().clone(), document, Options { threads: 2, cache_bytes: 0, ..Options::default() });
    let Some(other) = evaluate(&mut more) else { return };
    assert_eq!(told(&report), told(&other));
    for (id, t) in &earlier {
        for port in t.outputs() {
            let name = format!("{id}.{}", port.name());
            let (a, b) = (session.value(&name), more.value(&name));
            assert_eq!(a.as_ref().map(|t| t.digest()), b.map(|t| t.digest()), "{name}");
            if let Some(tree) = a.filter(|t| t.len() < 10_000) {
                assert!(!tree.summary().is_empty() && tree.to_json()["branches"].is_object());
            }
        }
        for port in t.inputs() {
            let _ = session.input(&format!("{id}.{}", port.name()));
        }
    }
}
