//! Clusters: instances of one definition, expanded into the plan under paths of their own.

use crate::common::*;
use serde_json::json;
use tenon_engine::*;

/// A graph with clusters.
pub fn graph(clusters: Json, nodes: Json) -> Document {
    let file = json!({"format": "tenon", "clusters": clusters, "nodes": nodes});
    Document::from_slice(file.to_string().as_bytes()).unwrap_or_else(|e| panic!("{e:?}"))
}

pub fn open(document: Document) -> Session {
    Session::new(registry(), document, Options::default())
}

/// `root(a + b)`, floored as well: inputs `a` and `b`, outputs `root` and `whole`.
pub fn rooted() -> Json {
    json!({
        "interface": {
            "inputs": {"a": {"port": "add.a", "min": -100, "max": 100}, "b": {"port": "add.b"}},
            "outputs": {"root": {"port": "root.value"}, "whole": {"port": "floor.value"}},
        },
        "nodes": {
            "add": {"type": "add", "params": {"b": 7}},
            "root": {"type": "root", "inputs": {"a": {"from": "add.sum"}}},
            "floor": {"type": "floor", "inputs": {"a": {"from": "root.value"}}},
        },
    })
}

#[test]
fn an_instance_is_the_graph_inlined() {
    let nodes = json!({
        "n": {"type": "number", "params": {"value": 9}},
        "x": {"type": "cluster:rooted", "inputs": {"a": {"from": "n.value"}}},
        "y": {"type": "cluster:rooted", "inputs": {"a": {"from": "x.root"}}, "params": {"b": 5}},
        "end": {"type": "add", "inputs": {"a": {"from": "x.root"}, "b": {"from": "y.whole"}}},
    });
    let mut s = open(graph(json!({"rooted": rooted()}), nodes));
    let report = evaluate(&mut s, &["end.sum", "x.root", "y/add.sum"]);
    assert!(report.diagnostics.is_empty(), "{:?}", report.diagnostics);
    assert_eq!(items(&s, "x.root"), json!([4.0]));
    assert_eq!(items(&s, "y/add.sum"), json!([9.0]));
    assert_eq!(items(&s, "end.sum"), json!([7.0]));
    let ids: Vec<&str> = report.nodes.iter().map(|n| n.id).collect();
    assert_eq!(ids, ["n", "x/add", "x/root", "y/add", "y/root", "y/floor", "end"]);
}

#[test]
fn equal_instances_compute_once() {
    let nodes = json!({
        "x": {"type": "cluster:rooted", "params": {"a": 2}},
        "y": {"type": "cluster:rooted", "params": {"a": 2}},
        "z": {"type": "cluster:rooted", "params": {"a": 9}},
    });
    let mut s = open(graph(json!({"rooted": rooted()}), nodes));
    evaluate(&mut s, &["x.root", "x.whole"]);
    s.take_events();
    evaluate(&mut s, &["y.root", "y.whole"]);
    assert_eq!(log(&mut s), "memo y/add, memo y/root, memo y/floor");
    evaluate(&mut s, &["z.whole"]);
    assert_eq!(log(&mut s), "executed z/add, executed z/root, executed z/floor");

    // Also when they are ready at the same moment, where neither can find the other's result beforehand.
    s.set("x.a", json!(18)).unwrap();
    s.set("y.a", json!(18)).unwrap();
    evaluate(&mut s, &["x.root", "y.root"]);
    assert_eq!(log(&mut s), "executed x/add, memo y/add, executed x/root, memo y/root");
}

#[test]
fn errors_inside_name_the_full_path() {
    let inner = json!({
        "interface": {"inputs": {"a": {"port": "r.a"}}, "outputs": {"whole": {"port": "r.whole"}}},
        "nodes": {"r": {"type": "cluster:rooted", "params": {"b": 1}}},
    });
    let nodes = json!({
        "x": {"type": "cluster:outer", "params": {"a": -5}},
        "y": {"type": "cluster:outer", "params": {"a": 8}},
        "w": {"type": "cluster:outer", "params": {"a": 800}},
        "z": {"type": "floor", "inputs": {"a": {"from": "x.whole"}}},
        "n": {"type": "cluster:outer"},
    });
    let mut s = open(graph(json!({"rooted": rooted(), "outer": inner}), nodes));
    let report = evaluate(&mut s, &["z.value", "y.whole", "w.whole", "n.whole"]);
    let told = lines(&report);
    assert_eq!(items(&s, "y.whole"), json!([3.0]));
    let expected = [
        "error[missing-input] n/r/add.a: \"a\" has neither a wire nor a value (connect a wire to n.a or set it)",
        "note[blocked] n/r/floor: blocked by n/r/add",
        "note[blocked] n/r/root: blocked by n/r/add",
        "error[out-of-range] w/r/add.a: 800 is outside -100 to 100 (the nearest that works is 100)",
        "note[blocked] w/r/floor: blocked by w/r/add",
        "note[blocked] w/r/root: blocked by w/r/add",
        "note[blocked] x/r/floor: blocked by x/r/root",
        "error[negative] x/r/root.a: -4 has no root (use 0 or more)",
        "note[blocked] z: blocked by x/r/root",
    ];
    assert_eq!(told, expected);
    assert_eq!(s.document().validate(&registry()).len(), 2);
}

#[test]
fn inputs_of_instances_are_set_like_parameters() {
    let nodes = json!({
        "x": {"type": "cluster:rooted", "params": {"a": 2}},
        "y": {"type": "cluster:rooted", "params": {"a": 2}},
    });
    let mut s = open(graph(json!({"rooted": rooted()}), nodes));
    evaluate(&mut s, &["x.root", "y.root"]);
    s.take_events();
    s.set("x.b", json!(14)).unwrap();
    evaluate(&mut s, &["x.root", "y.root"]);
    assert_eq!((items(&s, "x.root"), items(&s, "y.root")), (json!([4.0]), json!([3.0])));
    assert_eq!(log(&mut s), "executed x/add, executed x/root");
    assert_eq!(s.document().nodes()["x"].params.get("b").map(Literal::to_json), Some(json!(14)));
    s.edit(&Operation::SetParam { node: "x".into(), port: "b".into(), value: Some(json!(23)) }).unwrap();
    evaluate(&mut s, &["x.root", "y.root"]);
    assert_eq!(log(&mut s), "executed x/add, executed x/root");
    // Without a value of its own, what stands in the cluster counts again.
    s.set("x.b", Json::Null).unwrap();
    evaluate(&mut s, &["x.root", "y.root"]);
    assert_eq!(items(&s, "x.root"), json!([3.0]));
    let inside = s.set("x/add.a", json!(1)).unwrap_err().to_string();
    assert_eq!(
        inside,
        "error[inside-cluster] x/add.a: x/add.a is inside a cluster, whose instances share what stands in it (set x.a)"
    );
    assert!(s.set("x.c", json!(1)).unwrap_err().to_string().contains("cluster \"rooted\" has no input \"c\""));
    assert!(s.set("x.a", json!(101)).unwrap_err().to_string().contains("out-of-range"));
}

#[test]
fn the_state_of_an_instance_is_that_of_everything_inside() {
    let nodes = |state: &str| {
        json!({
            "x": {"type": "cluster:rooted", "params": {"a": 2}, "state": state},
            "y": {"type": "floor", "inputs": {"a": {"from": "x.root"}}},
        })
    };
    let mut s = open(graph(json!({"rooted": rooted()}), nodes("disabled")));
    let report = evaluate(&mut s, &["y.value"]);
    assert_eq!(lines(&report), ["warning[blocked] y: blocked by x/root, which is disabled"]);
    s.replace(graph(json!({"rooted": rooted()}), nodes("on")));
    evaluate(&mut s, &["y.value"]);
    s.replace(graph(json!({"rooted": rooted()}), nodes("frozen")));
    s.set("x.a", json!(42)).unwrap();
    evaluate(&mut s, &["y.value"]);
    assert_eq!(items(&s, "y.value"), json!([3.0]));
}

#[test]
fn clusters_that_contain_themselves_are_named_and_the_rest_runs() {
    let holds = |name: &str| json!({"nodes": {"in": {"type": format!("cluster:{name}")}, "n": {"type": "number"}}});
    let clusters = json!({"a": holds("b"), "b": holds("c"), "c": holds("b"), "d": holds("d"), "e": holds("nobody")});
    let nodes = json!({
        "n": {"type": "number"},
        "a": {"type": "cluster:a"},
        "d": {"type": "cluster:d"},
        "e": {"type": "cluster:e"},
        "f": {"type": "cluster:aa"},
    });
    let document = graph(clusters, nodes);
    let told: Vec<String> = document.validate(&registry()).iter().map(ToString::to_string).collect();
    let expected = [
        "error[cluster-cycle] a/in/in: the cluster contains itself: b > c > b (remove one of these instances)",
        "error[cluster-cycle] d/in: the cluster contains itself: d > d (remove one of these instances)",
        "error[unknown-cluster] e/in: no cluster is called \"nobody\"",
        "error[unknown-cluster] f: no cluster is called \"aa\" (did you mean \"a\"?)",
    ];
    assert_eq!(told, expected);
    let mut s = open(document);
    evaluate(&mut s, &["n.value", "a/n.value", "a/in/n.value"]);
    assert_eq!((items(&s, "n.value"), items(&s, "a/in/n.value")), (json!([0.0]), json!([0.0])));
}

/// Each cluster holds `width` instances of the next.
fn tower(levels: usize, width: usize) -> Document {
    let mut clusters = json!({"c0": {"nodes": {"n": {"type": "number"}}}});
    for level in 1..levels {
        let inner = (0..width).map(|i| (format!("i{i}"), json!({"type": format!("cluster:c{}", level - 1)})));
        clusters[format!("c{level}")] = json!({"nodes": inner.collect::<serde_json::Map<_, _>>()});
    }
    graph(clusters, json!({"top": {"type": format!("cluster:c{}", levels - 1)}, "n": {"type": "number"}}))
}

#[test]
fn depth_and_number_have_limits_that_are_known_before_anything_is_expanded() {
    let told = |document: &Document| document.validate(&registry()).iter().map(ToString::to_string).collect::<Vec<_>>();
    assert!(told(&tower(64, 1)).is_empty());
    let deep = told(&tower(65, 1));
    assert_eq!(deep, ["error[clusters-too-deep] top: clusters nest 65 levels deep here, at most 64 are allowed"]);
    let many = told(&tower(40, 10));
    assert_eq!(many, ["error[too-many-nodes] top: with this instance, clusters come to more than 2000000 nodes"]);
    let mut s = open(tower(40, 10));
    evaluate(&mut s, &["n.value"]);
    assert_eq!(items(&s, "n.value"), json!([0.0]));
}

#[test]
fn formulas_inside_see_the_inputs_of_their_cluster() {
    let cluster = json!({
        "interface": {
            "inputs": {"t": {"port": "thick.t"}},
            "outputs": {"t": {"port": "thick.t"}, "u": {"port": "twice.t"}},
        },
        "nodes": {"thick": {"type": "thick"}, "twice": {"type": "thick", "params": {"t": "t * 2 + 1 mm"}}},
    });
    let outer = json!({
        "interface": {"inputs": {"w": {"port": ["in.t"]}}, "outputs": {"u": {"port": "in.u"}}},
        "nodes": {"in": {"type": "cluster:c"}},
    });
    let file = json!({
        "format": "tenon",
        "interface": {"inputs": {"base": {"port": "b.t"}}},
        "clusters": {"c": cluster, "outer": outer},
        "nodes": {
            "b": {"type": "thick", "params": {"t": 3}},
            "x": {"type": "cluster:c", "params": {"t": "base * 2"}},
            "y": {"type": "cluster:c"},
            "z": {"type": "cluster:outer", "params": {"w": "base + 1 cm"}},
            "bad": {"type": "cluster:c", "params": {"t": "t * 2"}},
        },
    });
    let mut s = open(Document::from_slice(file.to_string().as_bytes()).unwrap());
    let report = evaluate(&mut s, &["x.u", "y.u", "z.u", "bad.t"]);
    assert_eq!((items(&s, "x.u"), items(&s, "y.u"), items(&s, "z.u")), (json!([13.0]), json!([21.0]), json!([27.0])));
    assert_eq!(report.diagnostics.len(), 1, "{:?}", lines(&report));
    assert!(lines(&report)[0].contains("bad/thick.t: \"t * 2\", column 1"), "{:?}", lines(&report));
    s.take_events();
    s.set("base", json!(5)).unwrap();
    evaluate(&mut s, &["x.u", "y.u", "z.u"]);
    assert_eq!((items(&s, "x.u"), items(&s, "y.u"), items(&s, "z.u")), (json!([21.0]), json!([21.0]), json!([31.0])));
    let mut ran = log(&mut s);
    assert!(!ran.contains(" y/"), "{ran}");
    s.set("x.t", json!(4)).unwrap();
    evaluate(&mut s, &["x.u", "y.u", "z.u"]);
    assert_eq!(items(&s, "x.u"), json!([9.0]));
    ran = log(&mut s);
    assert_eq!(ran, "executed x/twice");
}

#[test]
fn what_is_wrong_with_a_definition_is_told_once() {
    let cluster = json!({
        "interface": {
            "inputs": {"a": {"port": ["add.a", "nobody.x"]}, "b": {"port": "add.a"}, "c": {"port": "f.a"}},
            "outputs": {"o": {"port": "add.some"}},
        },
        "nodes": {"add": {"type": "add"}, "f": {"type": "floor", "inputs": {"a": {"from": "add.sum"}}}},
    });
    let nodes = json!({
        "x": {"type": "cluster:c", "params": {"a": 1}},
        "y": {"type": "cluster:c", "params": {"a": 1, "z": 2}},
        "z/add": {"type": "number"},
        "z": {"type": "cluster:c", "params": {"a": 1}},
        "end": {"type": "floor", "inputs": {"a": {"from": "x.p"}}},
    });
    let document = graph(json!({"c": cluster}), nodes);
    let told: Vec<String> = document.validate(&registry()).iter().map(ToString::to_string).collect();
    let expected = [
        "error[wired-input] cluster:c/add.a: inputs \"a\" and \"b\" of cluster \"c\" lead to the same port",
        "error[wired-input] cluster:c/f.a: input \"c\" of cluster \"c\" leads to a port that has a wire",
        "error[unknown-name] x: interface input \"a\": there is no node \"x/nobody\"",
        "error[unknown-port] x/add.some: interface output \"o\": \"add\" has no output \"some\" (did you mean \"sum\"?)",
        "error[unknown-port] end.a: cluster \"c\" has no output \"p\" (did you mean \"o\"?)",
        "error[unknown-port] y.z: cluster \"c\" has no input \"z\" (did you mean \"a\"?)",
        "error[taken-path] z: node \"z/add\" has a name that belongs to the inside of \"z\" (rename one of them)",
    ];
    assert_eq!(told, expected);
    assert!(!open(document).document().nodes().is_empty());
}

#[test]
fn wires_bring_their_tree_and_their_rule_across_the_border() {
    let cluster = json!({
        "interface": {"inputs": {"a": {"port": "add.a"}, "b": {"port": "add.b"}}, "outputs": {"o": {"port": "add.sum"}}},
        "nodes": {"add": {"type": "add"}},
    });
    let nodes = |add: Json| {
        let mut nodes = json!({"p": {"type": "series"}, "q": {"type": "series", "params": {"count": 2}}, "x": add});
        nodes["x"]["inputs"] = json!({
            "a": {"from": "p.values", "match": "cross"},
            "b": {"from": "q.values", "tree": ["reverse"]},
        });
        nodes
    };
    let mut inner = open(graph(json!({"c": cluster}), nodes(json!({"type": "cluster:c"}))));
    let mut flat = open(graph(json!({}), nodes(json!({"type": "add"}))));
    let (a, b) = (evaluate(&mut inner, &["x.o"]), evaluate(&mut flat, &["x.sum"]));
    assert!(!a.has_errors() && !b.has_errors());
    assert_eq!(items(&inner, "x.o"), items(&flat, "x.sum"));
    assert_eq!(inner.value("x.o").map(|t| t.digest()), flat.value("x.sum").map(|t| t.digest()));
}

#[test]
fn a_thousand_instances_run() {
    let list: Vec<f64> = (0..1000).map(f64::from).collect();
    let cluster = json!({
        "interface": {"outputs": {"o": {"port": "sum.sum"}}},
        "nodes": {"sum": {"type": "sum", "params": {"values": list}}},
    });
    let nodes = (0..1000).map(|i| (format!("i{i}"), json!({"type": "cluster:c"})));
    let nodes: serde_json::Map<String, Json> = nodes.collect();
    let mut s = open(graph(json!({"c": cluster}), nodes.into()));
    let targets: Vec<String> = (0..1000).map(|i| format!("i{i}.o")).collect();
    let targets: Vec<&str> = targets.iter().map(String::as_str).collect();
    let report = evaluate(&mut s, &targets);
    assert_eq!(report.nodes.len(), 1000);
    assert_eq!(items(&s, "i999.o"), json!([499500.0]));
}
