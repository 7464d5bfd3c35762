//! Clusters on the command line: ports inside instances, links and their pins.

use crate::tenon::{Folder, shipped};

/// A series, as a file to be linked: `count` numbers from `start`.
const PAIR: &str = r#"{
  "format": "tenon",
  "interface": {
    "version": 2,
    "inputs": {"start": {"port": "series.start", "max": 100}, "name": {"port": "label.value"}},
    "outputs": {"numbers": {"port": "series.numbers"}}
  },
  "nodes": {
    "series": {"type": "series", "v": 1, "params": {"count": 2}},
    "label": {"type": "text", "v": 1, "params": {"value": "a"}}
  }
}
"#;

const GRAPH: &str = r#"{
  "format": "tenon",
  "interface": {"outputs": {"numbers": {"port": "x.numbers"}}},
  "clusters": {"pair": {"file": "lib/pair.tenon.json"}},
  "nodes": {
    "n": {"type": "number", "v": 1, "params": {"value": 7}},
    "x": {"type": "cluster:pair", "v": 2, "inputs": {"start": {"from": ["n.value"]}}}
  }
}
"#;

fn folder() -> Folder {
    let folder = Folder::with("g.tenon.json", GRAPH);
    folder.write("lib/pair.tenon.json", PAIR);
    folder
}

#[test]
fn ports_inside_an_instance_have_paths() {
    let folder = folder();
    let value = |port: &str| folder.tenon(&["inspect", "g.tenon.json", port, "--json"]).code(0).json();
    let numbers = serde_json::json!({"{0}": [7.0, 8.0]});
    assert_eq!(value("x.numbers")["branches"], numbers);
    assert_eq!(value("x/series.numbers")["branches"], numbers);
    assert_eq!(value("x/series.start")["branches"]["{0}"], serde_json::json!([7.0]));
    folder.tenon(&["inspect", "g.tenon.json", "x/seris.numbers"]).code(2).says(&["did you mean \"x/series\"?"]);
    let set = ["run", "g.tenon.json", "--get", "x/label.value", "--set"];
    let named = folder.tenon(&[&set[..], &["x.name=12"]].concat()).code(0).json();
    assert_eq!(named["branches"]["{0}"], serde_json::json!(["12"]), "at a text port, 12 is a text");
    folder.tenon(&[&set[..], &["x/series.count=3"]].concat()).code(2).says(&["inside-cluster", "x/series.count"]);
    folder.tenon(&["run", "g.tenon.json", "--set", "n.value=101"]).code(1).says(&["x/series.start", "to 100"]);
}

#[test]
fn a_pinned_link_holds_until_it_is_updated() {
    let folder = folder();
    folder
        .tenon(&["fmt", "--update-links", "g.tenon.json"])
        .code(0)
        .says(&["cluster \"pair\" is now version 2, xxh3:"]);
    let pinned = folder.read("g.tenon.json");
    assert!(pinned.contains("\"version\": 2") && pinned.contains("\"digest\": \"xxh3:"), "{pinned}");
    let again = folder.tenon(&["fmt", "--update-links", "g.tenon.json"]).code(0);
    assert_eq!(again.stderr, "");
    folder.tenon(&["fmt", "lib/pair.tenon.json"]).code(0);
    folder.tenon(&["check", "g.tenon.json"]).code(0);

    folder.write("lib/pair.tenon.json", PAIR.replace("\"count\": 2", "\"count\": 3"));
    folder.tenon(&["check", "g.tenon.json"]).code(1).says(&["linked-digest", "tenon fmt --update-links"]);
    folder.tenon(&["run", "g.tenon.json"]).code(1).says(&["error[linked-digest]", "is pinned to xxh3:", "at x"]);
    folder.tenon(&["fmt", "--update-links", "g.tenon.json"]).code(0);
    let numbers = folder.tenon(&["run", "g.tenon.json", "--get", "numbers"]).code(0).json();
    assert_eq!(numbers["branches"]["{0}"].as_array().map(Vec::len), Some(3));
}

#[test]
fn a_missing_file_leaves_the_rest_running() {
    let folder = folder();
    std::fs::remove_file(folder.0.join("lib/pair.tenon.json")).unwrap();
    let rest = folder.tenon(&["run", "g.tenon.json", "--get", "n.value"]).code(1);
    assert_eq!(rest.json()["branches"]["{0}"], serde_json::json!([7.0]));
    folder.tenon(&["run", "g.tenon.json"]).code(1).says(&[
        "error[linked-file]",
        "cluster \"pair\": lib/pair.tenon.json",
        "at x",
    ]);
    let before = folder.read("g.tenon.json");
    folder.tenon(&["fmt", "--update-links", "g.tenon.json"]).code(2).says(&["lib/pair.tenon.json cannot be used"]);
    assert_eq!(folder.read("g.tenon.json"), before);
}

#[test]
fn a_sweep_varies_inputs_of_instances() {
    let graph = shipped("three-strips");
    let folder = Folder::new();
    let plan =
        ["sweep", "plan", &graph, "--vary", "low.fold=10,20", "--set", "low.iterations=1", "--out", "plan.jsonl"];
    folder.tenon(&plan).code(0);
    assert_eq!(folder.read("plan.jsonl").lines().count(), 2);
}

#[test]
fn a_cluster_is_described_like_a_node_type() {
    let folder = folder();
    let described = folder.tenon(&["nodes", "cluster:pair", "--graph", ".", "--json"]).code(0).json();
    assert_eq!((&described["version"], &described["category"]), (&2.into(), &"Clusters".into()));
    let (name, start) = (&described["inputs"][0], &described["inputs"][1]);
    assert_eq!((&name["name"], &name["type"], &name["default"]), (&"name".into(), &"text".into(), &"a".into()));
    assert_eq!((&start["name"], &start["max"]), (&"start".into(), &100.0.into()));
    assert_eq!(described["outputs"][0]["name"], "numbers");
    folder.tenon(&["nodes", "--graph", "."]).code(0);
}

#[test]
fn rows_of_a_sweep_are_of_the_linked_files_as_they_are() {
    let folder = folder();
    let plan = || folder.tenon(&["sweep", "plan", "g.tenon.json", "--vary", "n.value=1,2", "--out", "p.jsonl"]).code(0);
    let run = || folder.tenon(&["sweep", "run", "p.jsonl", "--out", "r", "--json"]);
    plan();
    let (planned, first) = (folder.read("p.jsonl"), run().code(0).json());
    assert_eq!(first["evaluated"], 2);
    assert_eq!(run().code(0).json()["evaluated"], 0);
    plan();
    assert_eq!(folder.read("p.jsonl"), planned, "nothing has changed");

    folder.write("lib/pair.tenon.json", PAIR.replace(r#""count": 2"#, r#""count": 3"#));
    run().code(2).says(&["is another than"]);
    plan();
    assert_ne!(folder.read("p.jsonl"), planned);
    assert_eq!(run().code(0).json()["evaluated"], 2);
    let table = folder.read("r/results.jsonl");
    let row: serde_json::Value = serde_json::from_str(table.lines().next().unwrap()).unwrap();
    assert_eq!(row["values"]["numbers"]["value"]["branches"]["{0}"], serde_json::json!([1.0, 2.0, 3.0]));
    folder.write("lib/pair.tenon.json", PAIR);
    plan();
    assert_eq!(folder.read("p.jsonl"), planned, "the file is what it was");
    assert_eq!(run().code(0).json()["finished_before"], 2);
}
