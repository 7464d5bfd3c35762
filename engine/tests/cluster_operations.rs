//! Making clusters of nodes, taking them apart, editing inside: results stay what they were, and everything can be undone.

use crate::clusters::{graph, open, rooted};
use crate::common::*;
use proptest::collection::vec;
use proptest::prelude::*;
use serde_json::json;
use tenon_engine::*;

/// A graph of `add` and `floor` nodes without circles: node i takes from nodes before it, a literal, or a formula.
fn any_graph() -> impl Strategy<Value = Document> {
    let port = (0usize..6, 0usize..9, -9i32..9);
    let node = (any::<bool>(), port.clone(), port, 0usize..12);
    vec(node, 2..9).prop_map(|all| {
        let mut nodes = serde_json::Map::new();
        for (i, (adds, a, b, state)) in all.iter().enumerate() {
            let (mut params, mut inputs) = (json!({}), json!({}));
            let ports = if *adds { vec![("a", a), ("b", b)] } else { vec![("a", a)] };
            for (port, (kind, from, value)) in ports {
                let of = |n: usize| format!("n{n}.{}", if all[n].0 { "sum" } else { "value" });
                match kind {
                    0 => params[port] = json!("base * 2 + 1"),
                    1 => params[port] = json!(value),
                    2 if i > 1 => inputs[port] = json!({"from": [of(from % i)], "tree": ["graft", "flatten"]}),
                    3 => params[port] = json!([value, 2.5, null]),
                    _ if i > 0 => inputs[port] = json!({"from": [of(from % i)]}),
                    _ => params[port] = json!(value),
                }
            }
            let name = if *adds { "add" } else { "floor" };
            let mut node = json!({"type": name, "params": params, "inputs": inputs});
            if *state == 0 {
                node["state"] = "disabled".into();
            }
            nodes.insert(format!("n{i}"), node);
        }
        nodes.insert("source".into(), json!({"type": "number", "params": {"value": 3}}));
        let last = format!("n{}", all.len() - 1);
        let (first, last_port) = ("n0.a", if all.last().is_some_and(|n| n.0) { "sum" } else { "value" });
        let file = json!({
            "format": "tenon",
            "interface": {
                "inputs": {"base": {"port": "source.value"}, "first": {"port": first, "doc": "The first."}},
                "outputs": {"end": {"port": format!("{last}.{last_port}")}},
            },
            "groups": {"g": {"nodes": ["n0", "n1"]}, "h": {"nodes": ["n1", "source"]}},
            "nodes": nodes,
        });
        Document::from_slice(file.to_string().as_bytes()).unwrap_or_else(|e| panic!("{e:?}"))
    })
}

/// The digest of every node's output, by the node's name without the instances around it.
fn values(document: &Document, name: impl Fn(&str) -> String) -> Vec<(String, Option<u128>)> {
    let mut s = Session::new(registry(), document.clone(), Options::default());
    let mut all = Vec::new();
    let report = s.evaluate(&[], &Control::default());
    assert!(!report.cancelled);
    for i in 0..10 {
        let id = name(&format!("n{i}"));
        s.evaluate(&[&format!("{id}.sum"), &format!("{id}.value")], &Control::default());
        let value = s.value(&format!("{id}.sum")).or_else(|| s.value(&format!("{id}.value")));
        all.push((format!("n{i}"), value.map(|t| t.digest())));
    }
    let end = s.value("end").map(|t| t.digest());
    all.push(("end".into(), end));
    all
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    /// The explode law: a graph, the same with some nodes in a cluster, and that taken apart again come to the same bytes.
    #[test]
    fn a_cluster_of_nodes_is_these_nodes(document in any_graph(), chosen in vec(0usize..9, 1..5), both in any::<bool>()) {
        let ids: Vec<String> = document.nodes().keys().filter(|id| {
            id.strip_prefix('n').and_then(|i| i.parse::<usize>().ok()).is_some_and(|i| chosen.contains(&i))
        }).cloned().collect();
        prop_assume!(!ids.is_empty());
        let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
        let flat = values(&document, str::to_owned);
        let mut edited = document.clone();
        let operation = document.gather(&ids, "c", "inst").unwrap_or_else(|d| panic!("{d}"));
        let undo = operation.apply(&mut edited).unwrap_or_else(|d| panic!("{d}"));
        let within = |id: &str| if ids.contains(&id) { format!("inst/{id}") } else { id.to_owned() };
        prop_assert_eq!(&values(&edited, within), &flat);

        // Two levels: the instance and one more node in a second cluster.
        let mut outer = String::new();
        if both {
            let operation = edited.gather(&["inst"], "d", "outer").unwrap_or_else(|d| panic!("{d}"));
            operation.apply(&mut edited).unwrap_or_else(|d| panic!("{d}"));
            outer = "outer/".into();
            let within = |id: &str| if ids.contains(&id) { format!("{outer}inst/{id}") } else { id.to_owned() };
            prop_assert_eq!(&values(&edited, within), &flat);
            let apart = edited.explode("outer", &registry()).unwrap_or_else(|d| panic!("{d}"));
            apart.operation.apply(&mut edited).unwrap_or_else(|d| panic!("{d}"));
            prop_assert_eq!(&apart.ids["inst"], "inst");
        }
        let before = edited.clone();
        let apart = edited.explode("inst", &registry()).unwrap_or_else(|d| panic!("{d}"));
        let back = apart.operation.apply(&mut edited).unwrap_or_else(|d| panic!("{d}"));
        let again = |id: &str| apart.ids.get(id).cloned().unwrap_or_else(|| id.to_owned());
        prop_assert_eq!(&values(&edited, again), &flat);
        prop_assert!(outer.is_empty() || !edited.nodes().contains_key("outer"));

        back.apply(&mut edited).unwrap_or_else(|d| panic!("{d}"));
        prop_assert_eq!(edited.to_string_canonical(), before.to_string_canonical());
        if !both {
            undo.apply(&mut edited).unwrap_or_else(|d| panic!("{d}"));
            prop_assert_eq!(edited.to_string_canonical(), document.to_string_canonical());
        }
        let (there, back) = (document.diff(&before), before.diff(&document));
        let mut edited = document.clone();
        Operation::All(there).apply(&mut edited).unwrap_or_else(|d| panic!("{d}"));
        prop_assert_eq!(edited.to_string_canonical(), before.to_string_canonical());
        Operation::All(back).apply(&mut edited).unwrap_or_else(|d| panic!("{d}"));
        prop_assert_eq!(edited.to_string_canonical(), document.to_string_canonical());
    }
}

#[test]
fn an_edit_of_a_definition_reruns_what_it_changes_in_all_instances() {
    let nodes = json!({
        "x": {"type": "cluster:rooted", "params": {"a": 2}},
        "y": {"type": "cluster:rooted", "params": {"a": 9, "b": 0}},
        "other": {"type": "number", "params": {"value": 1}},
    });
    let mut s = open(graph(json!({"rooted": rooted()}), nodes));
    let all = ["x.whole", "y.whole", "other.value"];
    evaluate(&mut s, &all);
    s.take_events();
    let inside = |operation| Operation::InCluster { name: "rooted".into(), operation: Box::new(operation) };
    let b = Operation::SetParam { node: "add".into(), port: "b".into(), value: Some(json!(14)) };
    let undo = s.edit(&inside(b)).unwrap();
    evaluate(&mut s, &all);
    assert_eq!((items(&s, "x.whole"), items(&s, "y.whole")), (json!([4.0]), json!([3.0])));
    // y has a value of its own there, so only x runs anew; the rest is known.
    let ran = log(&mut s);
    let executed: Vec<&str> = ran.split(", ").filter(|e| e.starts_with("executed")).collect();
    assert_eq!(executed, ["executed x/add", "executed x/root", "executed x/floor"], "{ran}");
    s.edit(&undo).unwrap();
    evaluate(&mut s, &all);
    assert_eq!(items(&s, "x.whole"), json!([3.0]));
    assert!(!log(&mut s).contains("executed"));
    // A remark inside makes nothing run.
    s.edit(&inside(Operation::SetNote { node: "add".into(), note: Some("adds".into()) })).unwrap();
    evaluate(&mut s, &all);
    assert_eq!(log(&mut s), "");
}

#[test]
fn what_makes_no_sense_is_refused() {
    let document = graph(
        json!({"rooted": rooted(), "far": {"file": "far.tenon.json"}}),
        json!({
            "n": {"type": "number"},
            "m": {"type": "number"},
            "sum": {"type": "sum", "inputs": {"values": {"from": ["n.value", "m.value"]}}},
            "x": {"type": "cluster:rooted"},
            "f": {"type": "cluster:far"},
        }),
    );
    let gather = |ids: &[&str], name: &str, instance: &str| {
        document.gather(ids, name, instance).map(|_| ()).unwrap_err().to_string()
    };
    assert_eq!(
        gather(&["n", "sum"], "c", "i"),
        "error[mixed-wires] sum.values: the port takes wires both from the cluster and from outside of it \
         (take all of its sources into the cluster, or none, or join them in a node of their own)"
    );
    assert_eq!(gather(&["n"], "rooted", "i"), "error[taken-id]: there is already a cluster \"rooted\"");
    assert_eq!(gather(&["n"], "c", "m"), "error[taken-id]: there is already a node \"m\"");
    assert_eq!(gather(&["nn"], "c", "i"), "error[unknown-name]: there is no node \"nn\" (did you mean \"n\"?)");
    let explode = |id: &str| document.explode(id, &registry()).map(|_| ()).unwrap_err().to_string();
    assert_eq!(explode("n"), "error[unknown-cluster] n: \"n\" is no instance of a cluster that can be used");
    assert_eq!(explode("f"), "error[unknown-cluster] f: \"f\" is no instance of a cluster that can be used");
    let inside = |name: &str, operation| {
        let operation = Operation::InCluster { name: name.into(), operation: Box::new(operation) };
        operation.apply(&mut document.clone()).unwrap_err().to_string()
    };
    let remove = || Operation::RemoveNode { id: "add".into() };
    assert_eq!(
        inside("far", remove()),
        "error[linked-cluster]: cluster \"far\" stands in far.tenon.json (edit that file, or take the cluster into this one)"
    );
    assert!(inside("near", remove()).contains("no cluster is called \"near\""));
    let nested = Operation::SetCluster { name: "c".into(), cluster: None };
    assert!(inside("rooted", nested).contains("clusters stand at the top of the file"));
}

#[test]
fn a_copied_instance_brings_its_clusters() {
    let outer = json!({"nodes": {"in": {"type": "cluster:rooted"}}});
    let nodes = json!({"x": {"type": "cluster:outer"}, "n": {"type": "number"}});
    let document = graph(json!({"rooted": rooted(), "outer": outer, "unused": {"nodes": {}}}), nodes);
    let fragment = document.copy(&["x"]).unwrap();
    assert_eq!(fragment.clusters.keys().collect::<Vec<_>>(), ["outer", "rooted"]);

    // Into the same document: the clusters are there already.
    let mut same = document.clone();
    document.paste(&fragment, OuterWires::Drop, [0.0; 2]).operation.apply(&mut same).unwrap();
    assert_eq!(same.clusters, document.clusters);
    assert_eq!(same.nodes()["x-2"].cluster(), Some("outer"));

    // Into one where another cluster has the name: both get new names, for the outer one uses the inner.
    let other = json!({"nodes": {"n": {"type": "number"}}});
    let target = graph(json!({"rooted": other, "outer": document_cluster(&document, "outer")}), json!({}));
    let mut pasted = target.clone();
    let undo = target.paste(&fragment, OuterWires::Drop, [0.0; 2]).operation.apply(&mut pasted).unwrap();
    assert_eq!(pasted.clusters.keys().collect::<Vec<_>>(), ["outer", "outer-2", "rooted", "rooted-2"]);
    assert_eq!(pasted.nodes()["x"].cluster(), Some("outer-2"));
    let Cluster::Here(body) = &pasted.clusters["outer-2"] else { panic!("it stands here") };
    assert_eq!(body.nodes()["in"].cluster(), Some("rooted-2"));
    assert!(pasted.validate(&registry()).iter().all(|d| d.code == "missing-input"));
    undo.apply(&mut pasted).unwrap();
    assert_eq!(pasted, target);
}

fn document_cluster(document: &Document, name: &str) -> Json {
    let file: Json = serde_json::from_str(&document.to_string_canonical()).unwrap();
    file["clusters"][name].clone()
}

#[test]
fn formulas_are_written_for_the_graph_outside() {
    let cluster = json!({
        "interface": {"inputs": {"t": {"port": "a.t"}, "the depth": {"port": "d.t"}}, "outputs": {"o": {"port": "b.t"}}},
        "nodes": {
            "a": {"type": "thick"},
            "b": {"type": "thick", "params": {"t": "min(t, 'the depth') * 2 + 1 mm"}},
            "d": {"type": "thick", "params": {"t": "2 cm"}},
        },
    });
    let file = json!({
        "format": "tenon",
        "clusters": {"c": cluster},
        "interface": {"inputs": {"base": {"port": "n.value"}}},
        "nodes": {"n": {"type": "number", "params": {"value": 4}}, "x": {"type": "cluster:c", "params": {"t": "base * 3"}}},
    });
    let mut document = Document::from_slice(file.to_string().as_bytes()).unwrap();
    let paste = document.explode("x", &registry()).unwrap();
    paste.operation.apply(&mut document).unwrap();
    let written = document.nodes()["b"].params.get("t").and_then(Literal::as_str).map(str::to_owned);
    assert_eq!(written.as_deref(), Some("min(((base * 3) * 1 mm), (20.0 mm)) * 2 + 1 mm"));
    let mut s = open(document);
    evaluate(&mut s, &["b.t"]);
    assert_eq!(items(&s, "b.t"), json!([25.0]));
    s.set("base", json!(1)).unwrap();
    evaluate(&mut s, &["b.t"]);
    assert_eq!(items(&s, "b.t"), json!([7.0]));
}

/// A node renamed inside a cluster is one renaming there, at whatever depth its text stands.
#[test]
fn a_node_renamed_in_a_cluster_shows_as_renamed() {
    let text = json!({"format": "tenon",
        "clusters": {"c": {
            "interface": {"outputs": {"o": {"port": "b.sum"}}},
            "nodes": {"a": {"type": "number", "params": {"value": 3}},
                "b": {"type": "add", "params": {"b": [1, 2]}, "inputs": {"a": {"from": ["a.value"]}}}}}},
        "nodes": {"x": {"type": "cluster:c"}}});
    for text in [text.to_string(), format!("{text:#}")] {
        let before = Document::from_slice(text.as_bytes()).unwrap_or_else(|e| panic!("{e:?}"));
        let rename = Operation::InCluster {
            name: "c".into(),
            operation: Box::new(Operation::Rename { from: "b".into(), to: "sum".into() }),
        };
        let mut after = before.clone();
        rename.apply(&mut after).unwrap_or_else(|d| panic!("{d}"));
        assert_eq!(before.diff(&after), [rename]);
        let mut again = before.clone();
        Operation::All(before.diff(&after)).apply(&mut again).unwrap_or_else(|d| panic!("{d}"));
        assert_eq!(again.to_string_canonical(), after.to_string_canonical());
    }
}

/// A graph of one cluster `outer`, whose two nodes work one behind the other, and one instance of it.
fn nested() -> Document {
    let file = json!({
        "format": "tenon",
        "clusters": {"outer": {
            "interface": {"inputs": {"x": {"port": "first.a"}}, "outputs": {"sum": {"port": "second.sum"}}},
            "nodes": {
                "first": {"type": "add", "params": {"a": 1, "b": 2}},
                "second": {"type": "add", "params": {"b": 10}, "inputs": {"a": {"from": ["first.sum"]}}},
            },
        }},
        "interface": {"outputs": {"end": {"port": "one.sum"}}},
        "nodes": {"one": {"type": "cluster:outer", "params": {"x": 5}}},
    });
    Document::from_slice(file.to_string().as_bytes()).unwrap_or_else(|e| panic!("{e:?}"))
}

fn end(document: &Document) -> u128 {
    let mut s = Session::new(registry(), document.clone(), Options::default());
    let report = s.evaluate(&[], &Control::default());
    assert!(report.diagnostics.is_empty(), "{:?}", report.diagnostics);
    s.value("end").unwrap().digest()
}

#[test]
fn a_cluster_is_made_inside_a_cluster_and_taken_apart_there() {
    let mut document = nested();
    let (before, value) = (document.to_string_canonical(), end(&document));
    let inside = document.alone("outer").unwrap();
    let make = inside.gather(&["first"], "inner", "part").unwrap().inside("outer");
    let back = make.apply(&mut document).unwrap();
    let text = document.to_string_canonical();
    assert!(text.contains("\"type\": \"cluster:inner\"") && document.clusters.contains_key("inner"), "{text}");
    assert_eq!(end(&document), value, "results stay");

    // An instance that is copied from inside brings what it needs into another file.
    let fragment = document.alone("outer").unwrap().copy(&["part"]).unwrap();
    let mut other = Document::new();
    other.paste(&fragment, OuterWires::Drop, [0.0; 2]).operation.apply(&mut other).unwrap();
    assert!(other.clusters.contains_key("inner") && other.nodes().contains_key("part"));
    // Brought into a definition, it stands there, and its definition at the top of the file.
    let mut third = nested();
    let paste = third.alone("outer").unwrap().paste(&fragment, OuterWires::Drop, [0.0; 2]);
    let undo = paste.operation.inside("outer").apply(&mut third).unwrap();
    assert!(third.clusters.contains_key("inner"));
    assert_eq!(end(&third), value);
    undo.apply(&mut third).unwrap();
    assert_eq!(third.to_string_canonical(), before);

    let apart = document.alone("outer").unwrap().explode("part", &registry()).unwrap().operation.inside("outer");
    apart.apply(&mut document).unwrap();
    assert_eq!(end(&document), value);
    let Some(Cluster::Here(body)) = document.clusters.get("outer") else { panic!("{:?}", document.clusters) };
    assert!(body.nodes().contains_key("first") && !body.nodes().contains_key("part"));

    let mut undone = nested();
    let make = undone.alone("outer").unwrap().gather(&["first"], "inner", "part").unwrap().inside("outer");
    make.apply(&mut undone).unwrap();
    back.apply(&mut undone).unwrap();
    assert_eq!(undone.to_string_canonical(), before, "byte for byte");
}

#[test]
fn ports_of_an_interface_stand_in_the_order_that_the_file_says() {
    let mut document = nested();
    let names = |d: &Document| -> Vec<String> {
        let t = d.cluster_type("outer", &registry()).unwrap();
        t.inputs().iter().map(|p| p.name().to_owned()).collect()
    };
    let set = |name: &str, port: &str, order: Option<i64>| {
        let mut input = InterfaceInput::default();
        (input.ports, input.order) = (vec![port.to_owned()], order);
        Operation::SetInput { name: name.into(), input: Some(input) }.inside("outer")
    };
    set("a", "first.b", None).apply(&mut document).unwrap();
    assert_eq!(names(&document), ["a", "x"], "by name");
    set("x", "first.a", Some(0)).apply(&mut document).unwrap();
    assert_eq!(names(&document), ["x", "a"], "those with a place go first");
    let text = document.to_string_canonical();
    assert!(text.contains("\"order\": 0"), "{text}");
    let read = Document::from_slice(text.as_bytes()).unwrap();
    assert_eq!((names(&read), read.to_string_canonical()), (names(&document), text.clone()));
    let wrong = text.replace("\"order\": 0", "\"order\": \"first\"");
    assert!(Document::from_slice(wrong.as_bytes()).is_err());
}

#[test]
fn a_renamed_input_is_followed_by_formulas_and_instances() {
    let file = json!({
        "format": "tenon",
        "clusters": {"c": {
            "interface": {
                "inputs": {"x": {"port": "p.a"}, "y": {"port": "p.b"}},
                "outputs": {"out": {"port": "q.sum"}},
            },
            "nodes": {
                "p": {"type": "add", "params": {"a": 1, "b": 2}},
                "q": {"type": "add", "params": {"b": "x * 3"}, "inputs": {"a": {"from": ["p.sum"]}}},
            },
        }},
        "interface": {
            "inputs": {"size": {"port": "one.x"}},
            "outputs": {"end": {"port": "last.sum"}, "same": {"port": "one.out"}},
        },
        "nodes": {
            "one": {"type": "cluster:c", "params": {"x": 4}},
            "two": {"type": "cluster:c", "params": {"x": 6}, "inputs": {"y": {"from": ["one.out"]}}},
            "last": {"type": "add", "params": {"b": "size + 1"}, "inputs": {"a": {"from": ["two.out"]}}},
        },
    });
    let mut document = Document::from_slice(file.to_string().as_bytes()).unwrap();
    let (value, text) = (end(&document), document.to_string_canonical());
    let mut undo = Vec::new();
    let next = document.rename_input(Some("c"), "x", "width of it", &registry()).unwrap();
    undo.push(next.apply(&mut document).unwrap());
    let next = document.rename_input(Some("c"), "y", "depth", &registry()).unwrap();
    undo.push(next.apply(&mut document).unwrap());
    let next = document.rename_output(Some("c"), "out", "total").unwrap();
    undo.push(next.apply(&mut document).unwrap());
    let next = document.rename_input(None, "size", "breadth", &registry()).unwrap();
    undo.push(next.apply(&mut document).unwrap());
    assert_eq!(end(&document), value);
    let now = document.to_string_canonical();
    for part in
        ["'width of it' * 3", "breadth + 1", "two.total", "one.total", "one.width of it", "\"depth\": { \"from\""]
    {
        assert!(now.contains(part), "{part} is missing in {now}");
    }
    for step in undo.iter().rev() {
        step.apply(&mut document).unwrap();
    }
    assert_eq!(document.to_string_canonical(), text);
    assert!(document.rename_input(None, "size", "", &registry()).is_err());
    assert!(document.rename_input(None, "nobody", "n", &registry()).is_err());
    assert!(document.rename_output(None, "end", "same").is_err());
}
