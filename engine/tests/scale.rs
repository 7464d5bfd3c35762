//! Large graphs: no recursion, the same bytes on any number of threads.

use crate::common::*;
use serde_json::json;
use tenon_engine::*;

fn chain(count: usize) -> Document {
    let mut document = Document::new();
    for i in 0..count {
        let node = Node::new("add").param("b", 1);
        let node = if i == 0 { node.param("a", 0) } else { node.wire("a", format!("n{:07}.sum", i - 1)) };
        document.insert(format!("n{i:07}"), node).expect("a good id");
    }
    document
}

#[test]
fn a_chain_of_a_million_nodes_runs_on_a_small_stack() {
    let small = std::thread::Builder::new().stack_size(2 << 20);
    let run = || {
        let count = 1_000_000;
        let mut s = Session::new(registry(), chain(count), Options { threads: 1, ..Options::default() });
        let last = format!("n{:07}.sum", count - 1);
        assert!(!s.evaluate(&[&last], &Control::default()).has_errors());
        assert_eq!(items(&s, &last), json!([1e6]));
    };
    small.spawn(run).expect("a thread").join().expect("no overflow");
}

#[test]
fn a_cycle_of_a_million_nodes_is_named_on_a_small_stack() {
    let small = std::thread::Builder::new().stack_size(2 << 20);
    let run = || {
        let count = 200_000;
        let mut document = chain(count);
        let last = format!("n{:07}.sum", count - 1);
        document.insert("n0000000", Node::new("add").wire("a", last)).expect("a good id");
        let found = document.validate(&registry());
        assert_eq!(found.len(), count);
        assert!(found.iter().all(|d| d.code == "cycle"));
    };
    small.spawn(run).expect("a thread").join().expect("no overflow");
}

#[test]
fn wide_graphs_give_the_same_on_one_and_many_threads() {
    let digests = |threads: usize| {
        let mut document = Document::new();
        for i in 0..3000 {
            let node = Node::new("root").param("a", i as f64 - 5.0);
            document.insert(format!("n{i:04}"), node).expect("a good id");
            let node = Node::new("add").wire("a", format!("n{i:04}.value"));
            document.insert(format!("m{i:04}"), node).expect("a good id");
        }
        let mut s = Session::new(registry(), document, Options { threads, ..Options::default() });
        let report = evaluate(&mut s, &[]);
        let nodes: Vec<_> = report.nodes.iter().map(|n| (n.id.to_owned(), n.happened, n.digest)).collect();
        (nodes, lines(&report), log(&mut s))
    };
    let one = digests(1);
    assert_eq!(one.0.len(), 6000);
    assert_eq!(one.1.len(), 10);
    assert!(one == digests(2) && one == digests(7));
}
