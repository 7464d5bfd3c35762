//! Ours, as a host uses it: a document, a session, targets; reports and the event log are taken after each evaluation.

use crate::graph::{Graph, Kind, Shape};
use crate::{Engine, least, micros, print};
use serde_json::json;
use std::sync::Arc;
use std::time::{Duration, Instant};
use tenon_engine::{Control, Document, Node, NodeType, Options, Port, Registry, Session};

fn registry() -> Arc<Registry> {
    let mut registry = Registry::new();
    let number = |name: &'static str| Port::item::<f64>(name);
    let nodes = [
        NodeType::new("number", 1).cheap().input(number("value").default(0.0)).output(number("value")).run(|c| {
            let v = c.number("value")?;
            c.set("value", v);
            Ok(())
        }),
        NodeType::new("quantise", 1).cheap().input(number("a")).output(number("value")).run(|c| {
            let v = (c.number("a")? / 1000.0).floor();
            c.set("value", v);
            Ok(())
        }),
        NodeType::new("add", 1).cheap().input(number("a")).input(number("b")).output(number("value")).run(|c| {
            let v = c.number("a")? + c.number("b")?;
            c.set("value", v);
            Ok(())
        }),
        NodeType::new("sum", 1).cheap().input(Port::list::<f64>("values")).output(number("value")).run(|c| {
            let v = c.list::<f64>("values")?.iter().sum::<f64>();
            c.set("value", v);
            Ok(())
        }),
        NodeType::new("millisecond", 1).input(number("a")).output(number("value")).slow().run(|c| {
            let start = Instant::now();
            while start.elapsed() < Duration::from_millis(1) {
                std::hint::spin_loop();
            }
            let v = c.number("a")?;
            c.set("value", v);
            Ok(())
        }),
    ];
    for node in nodes {
        registry.register(node).expect("sound node types");
    }
    Arc::new(registry)
}

fn id(i: usize) -> String {
    format!("n{i:07}")
}

/// The graph as a document.
pub fn document(graph: &Graph) -> Document {
    let mut document = Document::new();
    for (i, node) in graph.nodes.iter().enumerate() {
        let wire = |n: &usize| format!("{}.value", id(*n));
        let new = match (node.kind, node.inputs.as_slice()) {
            (Kind::Source, _) => Node::new("number").param("value", node.own),
            (Kind::Quantise, [a, ..]) => Node::new("quantise").wire("a", wire(a)),
            (Kind::Add, [a]) => Node::new("add").wire("a", wire(a)).param("b", node.own),
            (_, all) => all.iter().fold(Node::new("sum"), |n, a| n.wire("values", wire(a))),
        };
        document.insert(id(i), new).expect("a good id");
    }
    document
}

/// A session and what is asked of it.
pub struct Ours {
    session: Session,
    target: String,
}

impl Ours {
    pub fn new(document: Document, threads: usize) -> Self {
        let target = format!("{}.value", document.nodes().keys().last().expect("a node"));
        let session = Session::new(registry(), document, Options { threads, ..Options::default() });
        Self { session, target }
    }
}

impl Engine for Ours {
    fn set(&mut self, value: f64) {
        self.session.set("n0000000.value", json!(value)).expect("a number");
    }

    fn evaluate(&mut self) -> f64 {
        let report = self.session.evaluate(&[&self.target], &Control::default());
        assert!(!report.has_errors(), "{:?}", report.diagnostics);
        drop(self.session.take_events());
        let tree = self.session.value(&self.target).expect("a value");
        *tree.first::<f64>().expect("a number")
    }
}

const NAME: &str = "tenon";

/// A chain of a million nodes on a thread with 2 MiB of stack.
pub fn small_stack() {
    let size = 1_000_000;
    let run = move || {
        let graph = Graph::new(Shape::Chain, size);
        let mut ours = Ours::new(document(&graph), 1);
        let ms = micros(|| assert_eq!(ours.evaluate(), graph.expected(crate::graph::FIRST))) / 1e3;
        print(NAME, "small_stack", size, ms);
    };
    let small = std::thread::Builder::new().stack_size(2 << 20);
    small.spawn(run).expect("a thread").join().expect("the stack is large enough");
}

/// A list through a node that sees one item at a time; nanoseconds per item.
pub fn items() {
    let size = 10_000;
    let mut document = Document::new();
    let list = |first: f64| (0..size).map(|i| first + i as f64).collect::<Vec<f64>>();
    let node = Node::new("add").param("a", json!(list(0.0))).param("b", 1.0);
    document.insert("n0000000", node).expect("a good id");
    let mut session = Session::new(registry(), document, Options { threads: 1, ..Options::default() });
    let ns = least(50, |i| {
        session.set("n0000000.a", json!(list(i as f64))).expect("numbers");
        let us = micros(|| assert!(!session.evaluate(&["n0000000.value"], &Control::default()).has_errors()));
        us * 1e3 / size as f64
    });
    print(NAME, "items", size, ns);
}

/// From the text of a file of 10,000 nodes to a session that is ready to run, milliseconds.
pub fn load() {
    let size = 10_000;
    let text = document(&Graph::new(Shape::Chain, size)).to_string_canonical();
    let registry = registry();
    let ms = least(15, |_| {
        let mut kept = None;
        let us = micros(|| {
            let document = Document::from_slice(text.as_bytes()).expect("a good file");
            kept = Some(Session::new(registry.clone(), document, Options::default()));
        });
        drop(kept);
        us / 1e3
    });
    print(NAME, "load", size, ms);
}

/// 200 nodes of a millisecond each, side by side: how much faster two threads are than one.
pub fn threads() {
    let size = 200;
    let mut document = Document::new();
    for i in 0..size {
        document.insert(id(i), Node::new("millisecond").param("a", i as f64)).expect("a good id");
    }
    let time = |threads: usize| {
        least(3, |_| {
            let options = Options { threads, ..Options::default() };
            let mut session = Session::new(registry(), document.clone(), options);
            micros(|| assert!(!session.evaluate(&[], &Control::default()).has_errors()))
        })
    };
    print(NAME, "threads", size, time(1) / time(2));
}
