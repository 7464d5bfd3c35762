//! Operations on documents: each can be taken back byte for byte, and differences say what makes one into the other.

use crate::common::*;
use crate::laws::any_json;
use proptest::collection::{btree_map, vec};
use proptest::prelude::*;
use serde_json::json;
use tenon_engine::*;

const IDS: [&str; 6] = ["a", "b", "c", "d", "e", "a-2"];

fn id() -> impl Strategy<Value = String> {
    (0..IDS.len()).prop_map(|i| IDS[i].to_owned())
}

fn port() -> impl Strategy<Value = String> {
    prop_oneof![Just("a"), Just("b"), Just("value"), Just("sum")].prop_map(str::to_owned)
}

fn address() -> impl Strategy<Value = String> {
    (id(), port()).prop_map(|(n, p)| format!("{n}.{p}"))
}

fn type_name() -> impl Strategy<Value = &'static str> {
    prop_oneof![Just("number"), Just("add"), Just("floor"), Just("plugin/unknown"), Just("cluster:k")]
}

/// A file's JSON with everything in it that a file can have.
fn any_file() -> impl Strategy<Value = Json> {
    let wires = (vec(address(), 0..3), proptest::option::of(any_json())).prop_map(|(from, later)| match later {
        Some(later) => json!({"from": from, "tree": ["graft"], "later": later}),
        None => json!({"from": from}),
    });
    let node =
        (type_name(), btree_map(port(), any_json(), 0..3), btree_map(port(), wires, 0..3), any_json(), 0usize..4)
            .prop_map(|(t, params, inputs, later, kind)| {
                let mut node = json!({"type": t, "v": 1, "params": params, "inputs": inputs});
                if kind == 1 {
                    node["later"] = later;
                    node["note"] = "noted".into();
                } else if kind == 2 {
                    node["state"] = "frozen".into();
                    node["match"] = "cross".into();
                }
                node
            })
            .boxed();
    let cluster = (btree_map(id(), node.clone(), 0..3), address(), any_json(), 0usize..4);
    let cluster = cluster.prop_map(|(nodes, port, later, kind)| match kind {
        0 => json!({"file": "k.tenon.json", "version": 2, "later": later}),
        1 => json!({"nodes": nodes, "x": later, "later": later}),
        _ => json!({
            "nodes": nodes,
            "groups": {"g": {"nodes": ["a"]}},
            "interface": {"inputs": {"i": {"port": port, "max": 3}}, "outputs": {"o": {"port": port}}, "version": 2},
        }),
    });
    let clusters = btree_map("[kl]", cluster, 0..2);
    let groups = btree_map("[gh]", vec(id(), 0..3).prop_map(|nodes| json!({"nodes": nodes, "colour": 3})), 0..2);
    let inputs = btree_map("[ij]", vec(address(), 1..3), 0..2);
    let outputs = btree_map("[op]", address(), 0..2);
    let rest = (proptest::option::of(any_json()), proptest::option::of(any_json()), any_json());
    let all = (btree_map(id(), node, 0..5), groups, inputs, outputs, rest, clusters);
    all.prop_map(|(nodes, groups, inputs, outputs, rest, clusters)| {
        let inputs: serde_json::Map<String, Json> =
            inputs.into_iter().map(|(n, ports)| (n, json!({"port": ports, "min": -0.0, "later": [1]}))).collect();
        let outputs: serde_json::Map<String, Json> =
            outputs.into_iter().map(|(n, port)| (n, json!({"port": port, "unit": "mm"}))).collect();
        let interface = json!({"inputs": inputs, "outputs": outputs, "later": rest.2});
        let mut file = json!({"format": "tenon", "nodes": nodes, "groups": groups, "interface": interface});
        file["requires"] = json!({"plugin": rest.2});
        file["clusters"] = json!(clusters);
        if let Some(x) = rest.0 {
            file["x"] = x;
        }
        if let Some(later) = rest.1 {
            file["later"] = later;
        }
        file
    })
}

/// Read from compact text, from text with other spacing, or from canonical text, with some positions.
fn any_document() -> impl Strategy<Value = Document> {
    let point = (-1e3..1e3f64, -1e3..1e3f64).prop_map(|(x, y)| json!([x, y]));
    let positions = (btree_map(id(), point.clone(), 0..4), btree_map(id(), point, 0..4));
    (any_file(), 0usize..3, positions).prop_map(|(file, spacing, (positions, inside))| {
        let text = if spacing == 0 { file.to_string() } else { format!("{file:#}") };
        let mut document = read(&text);
        if spacing == 2 {
            document = read(&document.to_string_canonical());
        }
        let layout = json!({"format": "tenon-layout", "version": 1, "positions": positions, "clusters": {"k": inside}});
        let layout = layout.to_string();
        document.read_layout(layout.as_bytes()).expect("a layout");
        document
    })
}

fn any_operation() -> impl Strategy<Value = Operation> {
    use Operation as O;
    let node = (type_name(), any_json(), proptest::option::of(address())).prop_map(|(t, v, from)| {
        let node = Node::new(t).param("value", v);
        Box::new(if let Some(from) = from { node.wire("a", from) } else { node })
    });
    let node = node.boxed();
    let maybe_node = proptest::option::of(node.clone());
    let text = || proptest::option::of("[a-z \"]{0,5}");
    let value = || proptest::option::of(any_json());
    let nodes = prop_oneof![
        (id(), node).prop_map(|(id, node)| O::AddNode { id, node }),
        id().prop_map(|id| O::RemoveNode { id }),
        (id(), maybe_node).prop_map(|(id, node)| O::PutNode { id, node }),
        (id(), prop_oneof![id(), Just("x.y".to_owned())]).prop_map(|(from, to)| O::Rename { from, to }),
        (id(), -1e3..1e3f64).prop_map(|(node, x)| O::Move { node, to: (x > 0.0).then_some([x, 0.1]) }),
    ];
    let wires = prop_oneof![
        (id(), port(), address(), proptest::option::of(0usize..3))
            .prop_map(|(node, port, from, at)| { O::Connect { node, port, from, at } }),
        (id(), port(), address()).prop_map(|(node, port, from)| O::Disconnect { node, port, from }),
        (id(), port(), vec(address(), 0..3)).prop_map(|(node, port, from)| {
            let mut wires = Wires::default();
            wires.from.extend(from.into_iter().map(Name::from));
            wires.more.tree = vec![TreeOp::Flatten];
            O::PutWires { node, port, wires: Some(wires) }
        }),
    ];
    let fields = prop_oneof![
        3 => (id(), port(), value()).prop_map(|(node, port, value)| O::SetParam { node, port, value }),
        1 => id().prop_map(|node| O::SetMatching { node, matching: Some(Matching::Shortest) }),
        1 => id().prop_map(|node| O::SetState { node, state: NodeState::Disabled }),
        1 => (id(), text()).prop_map(|(node, note)| O::SetNote { node, note }),
    ];
    let tables = [Table::Requires, Table::Groups, Table::Interface, Table::Top, Table::Layout];
    let tables = proptest::sample::select(tables.to_vec());
    let whole = prop_oneof![
        ("[gh]", proptest::option::of(vec(id(), 0..3))).prop_map(|(name, nodes)| O::SetGroup { name, nodes }),
        ("[ij]", vec(address(), 0..3), any::<bool>()).prop_map(|(name, ports, some)| {
            let mut input = InterfaceInput::default();
            (input.ports, input.max, input.step) = (ports, Some(2.5), Some(0.25));
            O::SetInput { name, input: some.then_some(input) }
        }),
        ("[op]", prop_oneof![address(), Just("nowhere".to_owned())]).prop_map(|(name, port)| {
            let mut output = InterfaceOutput::default();
            output.port = port;
            O::SetOutput { name, output: Some(output) }
        }),
        (tables, "[gj]|later|nodes|inputs", value()).prop_map(|(table, key, value)| O::SetEntry { table, key, value }),
        proptest::option::of(prop_oneof![Just(" {\"a\":  1}"), Just("1, \"nodes\": {}"), Just("[1.0,2e0]")])
            .prop_map(|text| O::SetForeign { text: text.map(str::to_owned) }),
    ];
    let one = prop_oneof![3 => nodes, 2 => wires, 3 => fields, 2 => whole].boxed();
    let inside = prop_oneof![3 => one.clone(), 1 => vec(one.clone(), 0..3).prop_map(O::All)];
    let inside = ("[kl]", inside).prop_map(|(name, o)| O::InCluster { name, operation: Box::new(o) });
    let cluster = ("[kl]", any_file(), 0usize..4).prop_map(|(name, file, kind)| {
        let cluster = match kind {
            0 => None,
            1 => Some(Cluster::File(Link::new("l.tenon.json"))),
            _ => {
                let mut body = read(&file.to_string());
                if kind == 2 {
                    body.clusters.clear();
                }
                Some(Cluster::Here(Box::new(body)))
            }
        };
        O::SetCluster { name, cluster: cluster.map(Box::new) }
    });
    let one = prop_oneof![4 => one, 2 => inside, 1 => cluster].boxed();
    prop_oneof![4 => one.clone(), 1 => vec(one, 0..4).prop_map(O::All)]
}

fn read(text: &str) -> Document {
    Document::from_slice(text.as_bytes()).unwrap_or_else(|e| panic!("{e:?}\n{text}"))
}

/// Both files as they would be written.
fn texts(document: &Document) -> (String, String, String) {
    (document.to_string_canonical(), document.to_string_canonical_for(&registry()), document.layout_to_string())
}

/// What was written can be read, and is the same then.
fn reads_back(document: &Document) -> Result<(), TestCaseError> {
    let (_, kept, layout) = texts(document);
    let mut again = Document::from_slice(kept.as_bytes()).map_err(|e| TestCaseError::fail(format!("{e:?} {kept}")))?;
    again.read_layout(layout.as_bytes()).map_err(|e| TestCaseError::fail(format!("{e} {layout}")))?;
    prop_assert_eq!(texts(&again), texts(document));
    prop_assert_eq!(&again, document);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn every_operation_can_be_taken_back_byte_for_byte(document in any_document(), steps in vec(any_operation(), 1..12)) {
        let mut edited = document.clone();
        let (mut inverses, mut states) = (Vec::new(), vec![texts(&document)]);
        for step in &steps {
            match step.apply(&mut edited) {
                Ok(inverse) => {
                    reads_back(&edited)?;
                    inverses.push(inverse);
                    states.push(texts(&edited));
                }
                // Refused: nothing has changed, not even half of several operations.
                Err(_) => prop_assert_eq!(Some(&texts(&edited)), states.last()),
            }
        }
        for inverse in inverses.iter().rev() {
            prop_assert_eq!(Some(texts(&edited)), states.pop());
            prop_assert!(inverse.apply(&mut edited).is_ok(), "{inverse:?}");
        }
        prop_assert_eq!(Some(texts(&edited)), states.pop());
        prop_assert_eq!(edited, document);
    }

    #[test]
    fn undo_and_redo_walk_the_same_steps(document in any_document(), steps in vec((any_operation(), any::<bool>()), 1..9)) {
        let (mut edited, mut history, mut states) = (document.clone(), History::default(), vec![texts(&document)]);
        for (step, transaction) in &steps {
            if *transaction {
                history.begin();
                let first = history.apply(&mut edited, step, &registry());
                let second = history.apply(&mut edited, step, &registry());
                history.commit();
                if first.is_err() && second.is_err() { continue; }
            } else if history.apply(&mut edited, step, &registry()).is_err() {
                continue;
            }
            states.push(texts(&edited));
        }
        prop_assert_eq!(history.steps(), (states.len() - 1, 0));
        for state in states.iter().rev().skip(1) {
            prop_assert_eq!(history.undo(&mut edited), Ok(true));
            prop_assert_eq!(&texts(&edited), state);
        }
        prop_assert_eq!(history.undo(&mut edited), Ok(false));
        for state in states.iter().skip(1) {
            prop_assert_eq!(history.redo(&mut edited), Ok(true));
            prop_assert_eq!(&texts(&edited), state);
        }
        prop_assert_eq!(history.redo(&mut edited), Ok(false));
    }

    #[test]
    fn a_difference_makes_one_document_into_the_other(
        a in any_document(),
        other in any_document(),
        related in any::<bool>(),
        steps in vec(any_operation(), 0..6),
    ) {
        let mut b = if related { a.clone() } else { other };
        for step in &steps {
            let _ = step.apply(&mut b);
        }
        let mut made = a.clone();
        for operation in a.diff(&b) {
            prop_assert!(operation.apply(&mut made).is_ok(), "{operation:?}");
        }
        prop_assert_eq!(texts(&made), texts(&b));
        prop_assert_eq!(&made, &b);
        prop_assert_eq!(made.diff(&b), Vec::new());
    }

    #[test]
    fn a_session_that_is_edited_equals_a_fresh_one(steps in vec(any_operation(), 1..12)) {
        let nodes = json!({
            "a": {"type": "number", "params": {"value": 2}},
            "b": {"type": "add", "inputs": {"a": {"from": ["a.value"]}}, "params": {"b": 1}},
            "c": {"type": "add", "inputs": {"a": {"from": ["b.sum"]}, "b": {"from": ["a.value"]}}},
        });
        let mut s = session(nodes);
        evaluate(&mut s, &[]);
        let mut inverses = Vec::new();
        for step in &steps {
            let before = texts(s.document());
            match s.edit(step) {
                Ok(inverse) => inverses.push(inverse),
                Err(_) => prop_assert_eq!(texts(s.document()), before),
            }
            let report = evaluate(&mut s, &[]);
            let mut fresh = Session::new(registry(), s.document().clone(), Options::default());
            let fresh_report = evaluate(&mut fresh, &[]);
            prop_assert_eq!(lines(&report), lines(&fresh_report));
            for address in IDS.iter().flat_map(|n| ["value", "sum"].map(|p| format!("{n}.{p}"))) {
                prop_assert_eq!(s.value(&address).map(|t| t.digest()), fresh.value(&address).map(|t| t.digest()));
            }
        }
        for inverse in inverses.iter().rev() {
            prop_assert!(s.edit(inverse).is_ok());
        }
        evaluate(&mut s, &["c.sum"]);
        prop_assert_eq!(items(&s, "c.sum"), json!([5.0]));
    }

    #[test]
    fn what_is_pasted_has_the_wires_it_had(target in any_document(), source in any_document(), keep in any::<bool>()) {
        let ids: Vec<&str> = source.nodes().keys().map(String::as_str).take(3).collect();
        let fragment = source.copy(&ids).expect("its own nodes");
        let outer = if keep { OuterWires::Keep } else { OuterWires::Drop };
        let paste = target.paste(&fragment, outer, [10.0, 20.0]);
        let mut made = target.clone();
        let inverse = paste.operation.apply(&mut made).map_err(|d| TestCaseError::fail(d.to_string()))?;
        reads_back(&made)?;
        prop_assert_eq!(made.nodes().len(), target.nodes().len() + ids.len());
        for (old, new) in &paste.ids {
            prop_assert!(!target.nodes().contains_key(new));
            let (before, after) = (&source.nodes()[old], &made.nodes()[new]);
            prop_assert_eq!(&before.params, &after.params);
            for (port, wires) in &before.inputs {
                let expected: Vec<Name> = wires.from.iter().filter_map(|from| {
                    let (n, p) = from.split_once('.')?;
                    let outside = keep && target.nodes().contains_key(n);
                    paste.ids.get(n).map(|n| format!("{n}.{p}").into()).or_else(|| outside.then(|| from.clone()))
                }).collect();
                prop_assert_eq!(after.inputs.get(port).map(|w| w.from.to_vec()).unwrap_or_default(), expected);
            }
            let moved = source.position(old).map(|[x, y]| [x + 10.0, y + 20.0]);
            prop_assert_eq!(made.position(new), moved);
        }
        inverse.apply(&mut made).map_err(|d| TestCaseError::fail(d.to_string()))?;
        prop_assert_eq!(texts(&made), texts(&target));
    }
}

fn apply(document: &mut Document, operation: Operation) -> Result<Operation, String> {
    operation.apply(document).map_err(|d| d.to_string())
}

#[test]
fn removing_and_renaming_follow_every_name() {
    let text = r#"{"format": "tenon",
        "nodes": {"a": {"type": "number"}, "b": {"type": "add", "inputs": {"a": {"from": ["a.value"]}, "b": {"from": ["a.value", "b.sum"]}}}},
        "groups": {"g": {"nodes": ["a", "b"], "colour": "red"}},
        "interface": {"inputs": {"size": {"port": "a.value"}}, "outputs": {"o": {"port": "a.value"}, "sum": {"port": "b.sum"}}}}"#;
    let mut document = read(text);
    apply(&mut document, Operation::Move { node: "a".into(), to: Some([1.0, 2.5]) }).expect("it is there");
    let before = texts(&document);
    let back = apply(&mut document, Operation::Rename { from: "a".into(), to: "length".into() }).expect("free");
    let (kept, _, layout) = texts(&document);
    assert_eq!(kept.matches("length.value").count(), 4, "{kept}");
    assert!(
        kept.contains(r#""nodes": ["length", "b"]"#) && layout.contains(r#""length": [1.0, 2.5]"#),
        "{kept}{layout}"
    );
    apply(&mut document, back).expect("back");
    assert_eq!(texts(&document), before);

    let back = apply(&mut document, Operation::RemoveNode { id: "a".into() }).expect("it is there");
    let (kept, _, layout) = texts(&document);
    assert!(!kept.contains("a.value") && kept.contains(r#""b": { "from": ["b.sum"] }"#), "{kept}");
    assert!(
        kept.contains(r#""nodes": ["b"]"#) && !kept.contains("size") && !layout.contains("\"a\""),
        "{kept}{layout}"
    );
    apply(&mut document, back).expect("back");
    assert_eq!(texts(&document), before);
}

#[test]
fn a_renamed_node_shows_as_renamed() {
    let text = r#"{"format": "tenon",
        "nodes": {"a": {"type": "number", "params": {"value": 3}}, "b": {"type": "number", "params": {"value": 3}},
            "s": {"type": "add", "inputs": {"a": {"from": ["a.value"]}, "b": {"from": ["b.value"]}}},
            "t": {"type": "add", "inputs": {"a": {"from": ["s.sum"]}, "b": {"from": ["s.sum"]}}}},
        "groups": {"g": {"nodes": ["a", "s"]}},
        "interface": {"outputs": {"o": {"port": "t.sum"}}}}"#;
    let rename = |from: &str, to: &str| Operation::Rename { from: from.into(), to: to.into() };
    let before = read(text);
    // A chain of two renamed nodes.
    let mut after = before.clone();
    for step in [rename("s", "sum"), rename("t", "twice")] {
        apply(&mut after, step).expect("free");
    }
    assert_eq!(before.diff(&after), [rename("s", "sum"), rename("t", "twice")]);

    // Two that are alike are told apart by where they lie; where nothing tells them apart they are put anew.
    let (mut before, mut after) = (before.clone(), before);
    for step in [rename("a", "x"), rename("b", "y")] {
        apply(&mut after, step).expect("free");
    }
    let alike = before.diff(&after);
    assert!(!alike.iter().any(|o| matches!(o, Operation::Rename { .. })), "{alike:?}");
    for (document, [a, b]) in [(&mut before, ["a", "b"]), (&mut after, ["x", "y"])] {
        for (node, x) in [(a, 0.0), (b, 100.0)] {
            apply(document, Operation::Move { node: node.into(), to: Some([x, 0.0]) }).expect("there");
        }
    }
    assert_eq!(before.diff(&after), [rename("a", "x"), rename("b", "y")]);

    // What has changed besides comes after it, under the new name.
    apply(&mut after, Operation::SetParam { node: "t".into(), port: "c".into(), value: Some(json!(1)) })
        .expect("there");
    let found = before.diff(&after);
    assert_eq!(found[..2], [rename("a", "x"), rename("b", "y")]);
    assert_eq!(found.len(), 3, "{found:?}");
}

#[test]
fn refusals_say_what_is_wrong() {
    let mut d = document(json!({"number": {"type": "number"}, "b": {"type": "add"}}));
    let wire = |from: &str| Operation::Connect { node: "b".into(), port: "a".into(), from: from.into(), at: None };
    let wrong = apply(&mut d, wire("numbr.value"));
    assert_eq!(wrong, Err("error[unknown-name]: there is no node \"numbr\" (did you mean \"number\"?)".into()));
    assert_eq!(
        apply(&mut d, wire("number")),
        Err("error[bad-address]: \"number\" is not of the form node.port".into())
    );
    apply(&mut d, wire("number.value")).expect("there");
    assert_eq!(
        apply(&mut d, wire("number.value")),
        Err("error[duplicate-wire] b.a: the wire from number.value is already there".into())
    );
    let taken = Operation::AddNode { id: "b".into(), node: Box::new(Node::new("add")) };
    assert_eq!(apply(&mut d, taken), Err("error[taken-id]: there is already a node \"b\"".into()));
    let deep = |value: Json| Operation::SetParam { node: "b".into(), port: "b".into(), value: Some(value) };
    let mut most = json!(1);
    for _ in 0..96 {
        most = json!([most]);
    }
    apply(&mut d, deep(most.clone())).expect("as deep as can be");
    assert!(Document::from_slice(d.to_string_canonical().as_bytes()).is_ok());
    assert_eq!(
        apply(&mut d, deep(json!([most]))),
        Err("error[too-deep]: the file would nest deeper than 100 levels".into())
    );
}

#[test]
fn the_step_of_an_input_is_read_written_and_above_0() {
    let text = r#"{"format": "tenon", "nodes": {"a": {"type": "number"}},
        "interface": {"inputs": {"height": {"port": "a.value", "min": 1, "step": 0.5}}}}"#;
    let mut d = read(text);
    let input = d.inputs["height"].clone();
    assert_eq!(input.step, Some(0.5));
    let set = |step| {
        let mut input = input.clone();
        input.step = step;
        Operation::SetInput { name: "height".into(), input: Some(input) }
    };
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let refused = apply(&mut d, set(Some(wrong)));
        assert_eq!(refused, Err("error[bad-range]: the step of input \"height\" is not above 0".into()));
    }
    apply(&mut d, set(Some(2.0))).expect("it is above 0");
    assert_eq!(read(&d.to_string_canonical()).inputs["height"].step, Some(2.0));
}

#[test]
fn what_views_keep_in_the_layout_file_comes_back_and_is_of_the_whole_graph_only() {
    let text = r#"{"format": "tenon", "nodes": {"a": {"type": "number"}}, "clusters": {"c": {"nodes": {}}}}"#;
    let mut d = read(text);
    let (graph, plain) = (d.to_string_canonical(), d.layout_to_string());
    let set = |key: &str, value| Operation::SetEntry { table: Table::Layout, key: key.into(), value };
    let behind = json!([{ "file": "plan.png", "at": [1.5, 0.0, 2.0] }]);
    let back = apply(&mut d, set("references", Some(behind.clone()))).expect("a key of its own");
    assert_eq!(d.layout_entry("references"), Some(&behind));
    assert_eq!(d.to_string_canonical(), graph, "the graph's own file says nothing of it");
    let mut again = read(text);
    again.read_layout(d.layout_to_string().as_bytes()).expect("it is a layout");
    assert_eq!(again.layout_entry("references"), Some(&behind));
    assert_eq!(again.layout_to_string(), d.layout_to_string());
    let refused = apply(&mut d, set("positions", Some(behind.clone())));
    assert!(refused.is_err_and(|e| e.contains("reserved-key")));
    assert!(apply(&mut d, set("references", Some(behind)).inside("c")).is_err());
    apply(&mut d, back).expect("back");
    assert_eq!(d.layout_to_string(), plain);
}

#[test]
fn a_changed_copy_does_not_keep_the_text_of_its_original() {
    let mut d = document(json!({"u": {"type": "plugin/thing", "params": {"w": 1.5}}}));
    let mut copy = d.nodes()["u"].clone();
    copy.params.insert("w", json!(2.5));
    apply(&mut d, Operation::AddNode { id: "v".into(), node: Box::new(copy.clone()) }).expect("free");
    d.insert("w", copy).expect("free");
    assert_eq!(d.to_string_canonical_for(&registry()).matches("2.5").count(), 2);
}

#[test]
fn pasting_twice_counts_names_up() {
    let mut d =
        document(json!({"n": {"type": "number"}, "s": {"type": "floor", "inputs": {"a": {"from": ["n.value"]}}}}));
    let fragment = d.copy(&["n", "s"]).expect("there");
    for _ in 0..2 {
        let paste = d.paste(&fragment, OuterWires::Drop, [0.0; 2]);
        apply(&mut d, paste.operation).expect("free names");
    }
    assert_eq!(d.nodes().keys().collect::<Vec<_>>(), ["n", "n-2", "n-3", "s", "s-2", "s-3"]);
    assert_eq!(d.nodes()["s-3"].inputs.get("a").map(|w| w.from.to_vec()), Some(vec!["n-3.value".into()]));
    assert_eq!(d.copy(&["m"]).map_err(|e| e.code), Err("unknown-name".into()));
}

#[test]
fn many_edits_are_one_evaluation_and_a_slider_compiles_nothing() {
    let mut s = session(json!({
        "a": {"type": "number"}, "b": {"type": "number"}, "far": {"type": "number", "params": {"value": 7}},
        "sum": {"type": "add", "inputs": {"a": {"from": ["a.value"]}, "b": {"from": ["b.value"]}}},
    }));
    evaluate(&mut s, &[]);
    s.take_events();
    let set = |n: &str, v: f64| Operation::SetParam { node: n.into(), port: "value".into(), value: Some(json!(v)) };
    let mut history = History::with_limit(10);
    history.record(s.edit(&Operation::All(vec![set("a", 1.0), set("b", 2.0)])).expect("there"));
    evaluate(&mut s, &[]);
    assert_eq!(items(&s, "sum.sum"), json!([3.0]));
    assert_eq!(log(&mut s), "executed a, executed b, executed sum");
    assert_eq!(history.undo_by(|step| s.edit(step)), Ok(true));
    evaluate(&mut s, &[]);
    assert_eq!(items(&s, "sum.sum"), json!([0.0]));
    assert_eq!(history.redo_by(|step| s.edit(step)), Ok(true));
    evaluate(&mut s, &[]);
    assert_eq!(items(&s, "sum.sum"), json!([3.0]));
}

#[test]
fn looks_follow_their_node_and_come_back_with_it() {
    let text = r#"{"format": "tenon", "nodes": {"a": {"type": "number"}, "b": {"type": "number"}},
        "clusters": {"c": {"nodes": {"i": {"type": "number"}}}}}"#;
    let mut document = read(text);
    let plain = document.layout_to_string();
    let hidden = Look { shown: Some(false), open: true };
    let set = |node: &str, look| Operation::SetLook { node: node.into(), look };
    let inside = set("i", Look { shown: Some(true), open: false }).inside("c");
    apply(&mut document, inside).expect("it is there");
    let back = apply(&mut document, set("a", hidden)).expect("it is there");
    let layout = document.layout_to_string();
    let mut again = read(text);
    again.read_layout(layout.as_bytes()).expect("it is a layout");
    assert_eq!((again.look("a"), again.layout_to_string()), (hidden, layout.clone()));
    assert!(layout.contains("looks_inside"), "{layout}");

    apply(&mut document, Operation::Rename { from: "a".into(), to: "z".into() }).expect("free");
    assert_eq!((document.look("z"), document.look("a")), (hidden, Look::default()));
    let undo = apply(&mut document, Operation::RemoveNode { id: "z".into() }).expect("there");
    assert_eq!(document.look("z"), Look::default());
    apply(&mut document, undo).expect("back");
    assert_eq!(document.look("z"), hidden);
    let copy = document.copy(&["z"]).expect("there");
    assert_eq!(copy.look("z"), hidden);

    let mut changed = read(text);
    apply(&mut changed, set("a", hidden)).expect("it is there");
    for step in read(text).diff(&changed) {
        apply(&mut again, step).expect("it is a difference");
    }
    assert_eq!(again.look("a"), hidden);
    apply(&mut changed, back).expect("back");
    assert_eq!(changed.layout_to_string(), plain, "the default is not written");
    assert!(apply(&mut document, set("nobody", hidden)).is_err());
}

#[test]
fn each_step_of_a_history_says_what_is_wrong_with_the_graph_then() {
    let mut d = document(json!({"t": {"type": "text"}, "r": {"type": "root", "params": {"a": 4}}}));
    let (mut history, registry) = (History::with_limit(0), registry());
    let wire = Operation::Connect { node: "r".into(), port: "a".into(), from: "t.text".into(), at: None };
    let told = history.apply(&mut d, &wire, &registry).expect("types are no matter of operations");
    assert_eq!(told.iter().map(|d| &*d.code).collect::<Vec<_>>(), ["wrong-type"], "{told:?}");
    assert!(history.undo(&mut d).expect("it can be taken back"));
    assert_eq!(d.validate(&registry), []);
}
