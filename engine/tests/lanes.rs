//! Items meet in lanes; a failed item stays empty at its index.

use crate::common::*;
use serde_json::json;
use tenon_engine::*;

#[test]
fn a_failed_item_leaves_a_gap_and_its_neighbours_stay_in_place() {
    let mut s = session(json!({
        "r": {"type": "root", "params": {"a": [4, -1, 9]}},
        "x": {"type": "add", "params": {"b": [10, 20, 30]}, "inputs": {"a": {"from": ["r.value"]}}},
    }));
    let report = evaluate(&mut s, &[]);
    assert_eq!(items(&s, "r.value"), json!([2.0, null, 3.0]));
    assert_eq!(items(&s, "x.sum"), json!([12.0, null, 33.0]));
    assert_eq!(lines(&report), ["error[negative] r.a item 1: -1 has no root (use 0 or more)"]);
}

#[test]
fn what_is_told_of_many_faults_does_not_depend_on_how_lanes_are_shared_out() {
    let mut registry = Registry::new();
    let number = |name: &'static str| Port::item::<f64>(name);
    let series =
        NodeType::new("series", 1).input(Port::item::<i64>("count")).output(Port::list::<f64>("values")).run(|c| {
            let n = c.integer("count")?;
            c.set_list("values", (0..n).map(|i| i as f64).collect());
            Ok(())
        });
    let divide = NodeType::new("divide", 1).input(number("a")).input(number("b")).output(number("c")).run(|c| {
        let (a, b) = (c.number("a")?, c.number("b")?);
        if b < 100.0 {
            return Err(Fail::new("too-small", format!("{a} cannot be divided by {b}")));
        }
        c.set("c", a / b);
        Ok(())
    });
    registry.register(series).and_then(|()| registry.register(divide)).expect("sound");
    let registry = std::sync::Arc::new(registry);
    let from = |wire: &str| json!({"from": [wire]});
    let nodes = |count: i64| {
        let series = json!({"type": "series", "params": {"count": count}});
        let divide =
            json!({"type": "divide", "match": "cross", "inputs": {"a": from("s.values"), "b": from("s.values")}});
        document(json!({"s": series, "d": divide}))
    };
    let told = |small_before: usize, threads: usize| {
        let mut s = Session::new(registry.clone(), nodes(3), Options { threads, ..Options::default() });
        for i in 0..small_before {
            // The engine learns that the node is cheap, and then runs it in one piece.
            s.set("s.count", json!(3 + i as i64)).expect("accepted");
            evaluate(&mut s, &[]);
        }
        s.set("s.count", json!(1100)).expect("accepted");
        lines(&evaluate(&mut s, &[]))
    };
    let fresh = told(0, 2);
    assert_eq!(fresh[0], "error[too-small] d item 0: 0 cannot be divided by 0");
    let (last, few) = (&fresh[fresh.len() - 1], fresh.len() - 1);
    assert!(last.contains(&format!("{} more items", 1100 * 100 - few)), "{last}");
    assert!((10_000..20_000).contains(&few), "{few} of 110,000 are told");
    assert_eq!((told(5, 2), told(5, 1)), (fresh.clone(), fresh));
}

#[test]
fn longest_repeats_the_last_shortest_stops_and_cross_combines() {
    let nodes = |m: &str| json!({"x": {"type": "add", "params": {"a": [1, 2, 3], "b": [10, 20]}, "match": m}});
    for (rule, expected) in [
        ("longest", json!([11.0, 22.0, 23.0])),
        ("shortest", json!([11.0, 22.0])),
        ("cross", json!([11.0, 21.0, 12.0, 22.0, 13.0, 23.0])),
    ] {
        let mut s = session(nodes(rule));
        assert!(!evaluate(&mut s, &[]).has_errors());
        assert_eq!(items(&s, "x.sum"), expected, "{rule}");
    }
}

#[test]
fn lists_of_several_lanes_become_branches() {
    let mut s = session(json!({
        "one": {"type": "series", "params": {"count": 2}},
        "many": {"type": "series", "params": {"count": [1, 2]}},
        "sums": {"type": "sum", "inputs": {"values": {"from": ["many.values"]}}},
        "flat": {"type": "sum", "inputs": {"values": {"from": ["many.values"], "tree": ["flatten"]}}},
        "each": {"type": "sum", "inputs": {"values": {"from": ["one.values"], "tree": ["graft"]}}},
    }));
    assert!(!evaluate(&mut s, &[]).has_errors());
    assert_eq!(items(&s, "one.values"), json!([0.0, 1.0]));
    assert_eq!(items(&s, "many.values"), json!({"{0;0}": [0.0], "{0;1}": [0.0, 1.0]}));
    assert_eq!(items(&s, "sums.sum"), json!({"{0;0}": [0.0], "{0;1}": [1.0]}));
    assert_eq!(items(&s, "flat.sum"), json!([1.0]));
    assert_eq!(items(&s, "each.sum"), json!({"{0;0}": [0.0], "{0;1}": [1.0]}));
}

#[test]
fn a_list_with_a_gap_fails_and_says_which_item() {
    let mut s = session(json!({
        "r": {"type": "root", "params": {"a": [4, -1]}},
        "s": {"type": "sum", "inputs": {"values": {"from": ["r.value"]}}},
        "n": {"type": "count", "inputs": {"values": {"from": ["r.value"]}}},
    }));
    let report = evaluate(&mut s, &[]);
    assert!(lines(&report).iter().any(|l| l.starts_with("error[list-gap] s.values item 1")), "{:?}", lines(&report));
    assert_eq!(items(&s, "n.count"), json!([2]));
}

#[test]
fn an_empty_list_gives_empty_results_not_errors() {
    let mut s = session(json!({
        "e": {"type": "series", "params": {"count": 0}},
        "x": {"type": "add", "inputs": {"a": {"from": ["e.values"]}}},
        "s": {"type": "sum", "inputs": {"values": {"from": ["e.values"]}}},
    }));
    assert!(!evaluate(&mut s, &[]).has_errors());
    assert_eq!(items(&s, "x.sum"), json!([]));
    assert_eq!(items(&s, "s.sum"), json!([0.0]));
}

#[test]
fn not_a_number_on_a_wire_is_refused_item_by_item() {
    let mut s = session(json!({
        "inv": {"type": "reciprocal", "params": {"a": [2, 0]}},
        "x": {"type": "add", "inputs": {"a": {"from": ["inv.value"]}}},
    }));
    let report = evaluate(&mut s, &[]);
    assert_eq!(lines(&report), ["error[not-finite] x.a item 1: inf is not a finite number"]);
    assert_eq!(items(&s, "x.sum"), json!([0.5, null]));
}

#[test]
fn many_lanes_are_the_same_on_any_number_of_threads() {
    let digest = |threads| {
        let nodes = json!({
            "s": {"type": "series", "params": {"count": 10_000, "from": -3}},
            "r": {"type": "root", "inputs": {"a": {"from": ["s.values"]}}},
        });
        let options = tenon_engine::Options { threads, ..Default::default() };
        let mut s = tenon_engine::Session::new(registry(), document(nodes), options);
        let report = evaluate(&mut s, &[]);
        (s.value("r.value").map(|t| t.digest()), lines(&report))
    };
    let one = digest(1);
    assert_eq!(one.1.len(), 3);
    assert_eq!(one, digest(4));
}

#[test]
fn a_cross_over_many_branches_is_refused_before_it_fills_the_memory() {
    // Each branch alone would pass.
    let mut s = session(json!({
        "s": {"type": "series", "params": {"count": 20_000}},
        "x": {"type": "add", "match": "cross", "inputs": {
            "a": {"from": ["s.values"], "tree": ["graft"]}, "b": {"from": ["s.values"]}}},
    }));
    let report = evaluate(&mut s, &[]);
    assert_eq!(
        lines(&report),
        ["error[too-many-lanes] x: 2501 of 20000 branches come to 50020000 runs; the most is 50000000"]
    );
}

/// Nothing is made here, only asked for.
fn modest() -> std::sync::Arc<tenon_engine::Registry> {
    use tenon_engine::{NodeType, Port, Registry};
    let mut r = Registry::new();
    let count = Port::item::<i64>("count");
    let node = NodeType::new("modest", 1).input(count).output(Port::item::<i64>("count")).run(|c| {
        let count = c.integer("count")?;
        c.reserve(usize::try_from(count).unwrap_or(usize::MAX))?;
        c.set("count", count);
        Ok(())
    });
    r.register(node).expect("test nodes are sound");
    std::sync::Arc::new(r)
}

#[test]
fn lists_that_are_too_long_together_are_refused_with_their_sum_on_any_number_of_threads() {
    for (counts, told) in [
        (json!(50_000_000), None),
        (json!(50_000_001), Some(50_000_001)),
        (json!(vec![24_999; 2000]), None),
        (json!(vec![25_001; 2000]), Some(50_002_000)),
    ] {
        for threads in [1, 4] {
            let nodes = json!({"x": {"type": "modest", "params": {"count": counts}}});
            let options = tenon_engine::Options { threads, ..Default::default() };
            let mut s = tenon_engine::Session::new(modest(), document(nodes), options);
            let report = evaluate(&mut s, &[]);
            let expected: Vec<String> = told
                .iter()
                .map(|n| {
                    format!(
                        "error[too-many-items] x: the lists that this node makes would come to {n} items; the most is \
                         50000000 (make shorter lists, or match them by longest instead of cross)"
                    )
                })
                .collect();
            assert_eq!(lines(&report), expected);
            assert_eq!(s.value("x.count").is_some(), told.is_none());
        }
    }
}

#[test]
fn of_very_many_faults_some_are_told_and_the_others_counted() {
    let number = tenon_engine::MOST_ITEMS.min((1 << 20) + 1);
    let mut s = session(json!({
        "s": {"type": "series", "params": {"count": number, "from": -2_000_000}},
        "r": {"type": "root", "inputs": {"a": {"from": ["s.values"]}}},
        "t": {"type": "thick", "inputs": {"t": {"from": ["s.values"]}}},
    }));
    let report = evaluate(&mut s, &[]);
    let count = |code: &str, node: &str| {
        report.diagnostics.iter().filter(|d| d.code == code && d.node.as_deref() == Some(node)).count()
    };
    let last = |node: &str| report.diagnostics.iter().rfind(|d| d.node.as_deref() == Some(node)).map(|d| &*d.message);
    // 1025 pieces of up to 1024 lanes; of the last, one lane.
    let told = 1024 * 16 + 1;
    assert_eq!((count("negative", "r"), count("out-of-range", "t")), (told, 10_000));
    let rest = format!("{} more items have something to say; there are too many of them to tell it all", number - told);
    assert_eq!(last("r"), Some(&*rest));
    let rest = format!("the port refuses {} more items like the 10000 that are told", number - 10_000);
    assert_eq!(last("t"), Some(&*rest));
}
