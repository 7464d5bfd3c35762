//! Nodes written for older versions: brought forward step by step; each step has a file before and a file after it.

use crate::common::{evaluate, items, lines};
use serde_json::json;
use std::path::Path;
use std::sync::Arc;
use tenon_engine::*;

/// Version 1 of a beam had its length in centimetres, version 2 called its scale a factor.
fn registry() -> Registry {
    let mut r = Registry::new();
    let number = |n: &'static str| Port::item::<f64>(n);
    r.register(NodeType::new("number", 1).input(number("value")).output(number("value")).run(|c| {
        let v = c.number("value")?;
        c.set("value", v);
        Ok(())
    }))
    .expect("sound");
    let beam = NodeType::new("beam", 3).input(number("length")).input(number("scale").default(1.0));
    r.register(beam.output(number("length")).run(|c| {
        let v = c.number("length")? * c.number("scale")?;
        c.set("length", v);
        Ok(())
    }))
    .expect("sound");
    r.register_migration("beam", 1, |mut node| {
        let params = node["params"].as_object_mut().ok_or("there are no parameters")?;
        if let Some(length) = params.remove("length_cm") {
            let cm = length.as_f64().ok_or_else(|| format!("length_cm is {length}, not a number"))?;
            params.insert("length".into(), json!(cm * 10.0));
        }
        Ok(node)
    })
    .expect("the first");
    r.register_migration("beam", 2, |mut node| {
        for part in ["params", "inputs"] {
            if let Some(map) = node.get_mut(part).and_then(Json::as_object_mut)
                && let Some(factor) = map.remove("factor")
            {
                map.insert("scale".into(), factor);
            }
        }
        Ok(node)
    })
    .expect("the first");
    r
}

fn read(text: &str) -> Document {
    Document::from_slice(text.as_bytes()).unwrap_or_else(|e| panic!("{e:?}"))
}

#[test]
fn every_step_gives_what_its_file_says() {
    let registry = registry();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/migrations");
    let fixture = |name: String| std::fs::read_to_string(folder.join(&name)).unwrap_or_else(|e| panic!("{name}: {e}"));
    let steps: Vec<(&str, u32)> = registry.migrations().collect();
    assert_eq!(steps, [("beam", 1), ("beam", 2)]);
    for (node, from) in steps {
        let mut document = read(&fixture(format!("{node}-{from}.before.json")));
        let told = document.migrate(&registry);
        assert_eq!(told.iter().map(|d| &*d.code).collect::<Vec<_>>(), ["migrated-node"]);
        assert_eq!(document.to_string_canonical_for(&registry), fixture(format!("{node}-{from}.after.json")));
        assert_eq!(document.migrate(&registry), []);
    }
}

#[test]
fn a_session_runs_what_was_migrated_and_says_so() {
    let text =
        r#"{"format": "tenon", "nodes": {"b": {"type": "beam", "v": 1, "params": {"length_cm": 2.5, "factor": 2}}}}"#;
    let note = "note[migrated-node] b: brought from version 1 of \"beam\" to 3 (save the graph to keep it so)";
    let told = read(text).validate(&registry());
    assert_eq!(told.iter().map(ToString::to_string).collect::<Vec<_>>(), [note]);
    let mut s = Session::new(Arc::new(registry()), read(text), Options::default());
    assert_eq!(lines(&evaluate(&mut s, &[])), [note]);
    assert_eq!(items(&s, "b.length"), json!([50.0]));
    // What is set goes where today's version has it, and what is saved is today's.
    s.set("b.scale", json!(4)).expect("today's name");
    evaluate(&mut s, &[]);
    assert_eq!(items(&s, "b.length"), json!([100.0]));
    let saved = read(&s.document().to_string_canonical());
    assert_eq!((saved.nodes()["b"].version, saved.validate(&registry())), (3, Vec::new()));
    s.replace(read(text));
    evaluate(&mut s, &[]);
    assert_eq!(items(&s, "b.length"), json!([50.0]));
}

#[test]
fn a_step_that_fails_blocks_its_node_and_changes_nothing() {
    let text = r#"{"format": "tenon", "nodes": {
        "a": {"type": "beam", "v": 1, "params": {"length_cm": "long"}},
        "n": {"type": "number", "params": {"value": 3}},
        "z": {"type": "beam", "v": 3, "inputs": {"length": {"from": ["a.length"]}}}}}"#;
    let mut s = Session::new(Arc::new(registry()), read(text), Options::default());
    let report = evaluate(&mut s, &[]);
    let why = "error[migration-failed] a: version 1 of \"beam\" cannot be brought forward: length_cm is \"long\", not a number";
    assert!(lines(&report).iter().any(|l| l == why), "{:?}", lines(&report));
    assert_eq!((items(&s, "n.value"), items(&s, "z.length")), (json!([3.0]), Json::Null));
    assert_eq!(s.document(), &read(text));
}

#[test]
fn unknown_types_and_versions_without_a_step_stay() {
    let unknown = "{ \"type\":\"plugin/beam\",   \"v\": 1 }";
    let mut document = read(&format!("{{\"format\": \"tenon\", \"nodes\": {{\"u\": {unknown}}}}}"));
    assert_eq!(document.migrate(&registry()), []);
    assert!(document.to_string_canonical_for(&registry()).contains(unknown));

    let mut r = Registry::new();
    r.register(NodeType::new("gap", 4).run(|_| Ok(()))).expect("sound");
    r.register_migration("gap", 1, Ok).expect("the first");
    r.register_migration("gap", 3, Ok).expect("the first");
    let mut document = read(r#"{"format": "tenon", "nodes": {"g": {"type": "gap", "v": 1}}}"#);
    assert_eq!(document.migrate(&r).len(), 1);
    assert_eq!(document.nodes()["g"].version, 2);
    assert_eq!(document.validate(&r).iter().map(|d| &*d.code).collect::<Vec<_>>(), ["older-node"]);
}

#[test]
fn steps_that_lead_nowhere_are_refused() {
    let mut r = registry();
    for (node, from) in [("beam", 1), ("beam", 3), ("nothing", 1)] {
        let refused = r.register_migration(node, from, Ok);
        assert_eq!(refused, Err(RegistryError::Migration { node: node.into(), from }));
    }
    let mut r = Registry::new();
    r.register(NodeType::new("t", 2).run(|_| Ok(()))).expect("sound");
    r.register_migration("t", 1, |_| Ok(json!({"type": "other"}))).expect("the first");
    let mut document = read(r#"{"format": "tenon", "nodes": {"t": {"type": "t", "v": 1}}}"#);
    let told: Vec<String> = document.migrate(&r).iter().map(ToString::to_string).collect();
    assert_eq!(
        told,
        ["error[migration-failed] t: version 1 of \"t\" cannot be brought forward: the step changes the type"]
    );
}
