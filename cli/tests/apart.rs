//! Plugins in processes of their own: whatever they do to themselves is a diagnostic on their node.

#![cfg(target_os = "linux")]

use crate::plugin::{compile, hinges, root, shell_with};
use crate::tenon::{Ended, Folder};
use serde_json::{Value, json};
use std::sync::OnceLock;

fn misbehaving() -> &'static str {
    static LIBRARY: OnceLock<String> = OnceLock::new();
    let source = || root().join("plugin-sdk/examples/misbehaving-c/misbehaving.c");
    LIBRARY.get_or_init(|| compile(&source(), "misbehaving-apart", &["-pthread", "-DLOADABLE"]))
}

/// Three nodes: one that dies by its number, one beside it that does not, and one behind it.
fn doomed(x: &Value, need: &Value) -> String {
    let nodes = json!({
        "behind": { "type": "misbehaving.trusting", "inputs": { "x": { "from": ["doomed.y"] } } },
        "beside": { "type": "misbehaving.trusting", "params": { "x": 3 } },
        "doomed": { "type": "misbehaving.doomed", "params": { "x": x } },
    });
    json!({ "format": "tenon", "version": 1, "units": "mm", "requires": { "misbehaving": need }, "nodes": nodes })
        .to_string()
}

fn run(folder: &Folder, x: &Value, code: i32) -> Ended {
    let need = json!({ "isolation": "process", "timeout_s": 2, "memory_mib": 192 });
    folder.write("g.tenon.json", doomed(x, &need));
    folder.tenon(&["run", "g.tenon.json", "--plugin", misbehaving(), "--json"]).code(code)
}

#[test]
fn however_a_plugin_dies_its_node_says_so_and_the_rest_goes_on() {
    let folder = Folder::new();
    assert_eq!(run(&folder, &json!(1), 0).json()["ok"], true);
    for (x, words) in [
        (101, "ended by signal 11, a segmentation fault"),
        (102, "ended by signal 6"),
        (103, "did not answer and told no progress for 2 s"),
        (105, "exit code 3"),
        (107, "did not answer"),
        // Progress that does not rise is none.
        (109, "did not answer and told no progress for 2 s"),
    ] {
        let ended = run(&folder, &json!(x), 1);
        let report = ended.json();
        let told = report["diagnostics"].as_array().unwrap();
        let died: Vec<&Value> = told.iter().filter(|d| d["code"] == "plugin-died").collect();
        assert_eq!(died.len(), 1, "{x}: {report:#}");
        assert_eq!(died[0]["node"], "doomed");
        assert!(died[0]["message"].as_str().unwrap().contains(words), "{x}: {}", died[0]);
        let happened = |id: &str| {
            let node = report["nodes"].as_array().unwrap().iter().find(|n| n["id"] == id).cloned();
            node.map(|n| n["happened"].clone()).unwrap_or_default()
        };
        assert_eq!((happened("beside"), happened("behind")), (json!("executed"), json!("blocked")), "{report:#}");
    }
}

#[test]
fn memory_has_a_limit() {
    let ended = run(&Folder::new(), &json!(104), 1);
    // The plugin does not look whether it got what it asked for.
    ended.says(&["plugin-died", "signal 11", "MiB of the 192 that it may"]);
}

#[test]
fn the_next_evaluation_starts_a_new_process() {
    // The items of a list are evaluated one after the other, the second with what is left of the first.
    let folder = Folder::with("g.tenon.json", doomed(&json!([1, 101, 2, 105, 3]), &json!("*")));
    let ended = folder.tenon(&[
        "run",
        "g.tenon.json",
        "--plugin",
        misbehaving(),
        "--isolate",
        "misbehaving",
        "--get",
        "doomed.y",
    ]);
    assert_eq!(ended.code(1).json()["branches"]["{0}"], json!([1.0, null, 2.0, null, 3.0]));
}

#[test]
fn faults_are_told_as_they_are_without_a_process() {
    let folder = Folder::new();
    let told = |isolate: &[&str], node: &str, x: f64| {
        let graph = json!({ "format": "tenon", "version": 1, "units": "mm",
                            "nodes": { "n": { "type": node, "params": { "x": x } } } });
        folder.write("g.tenon.json", graph.to_string());
        let call = ["run", "g.tenon.json", "--plugin", misbehaving(), "--json"];
        let ended = folder.tenon(&[&call[..], isolate].concat());
        ended.json()["diagnostics"].clone()
    };
    for (node, x) in [
        // It calls back from another thread.
        ("misbehaving.doomed", 106.0),
        // It gives a buffer twice.
        ("misbehaving.doomed", 110.0),
        ("misbehaving.silent", 5.0),
        ("misbehaving.liar", 5.0),
        ("misbehaving.lazy", 5.0),
        ("misbehaving.divider", 5.0),
    ] {
        let here = told(&[], node, x);
        assert_eq!(here, told(&["--isolate", "all"], node, x), "{node} {x}");
        assert_eq!(here[0]["code"], "plugin-fault", "{here}");
    }
}

#[test]
fn a_fastener_apart_gives_the_same_bytes_as_here() {
    let wires = json!({ "panels": { "from": ["thicken.panels"] } });
    let folder = Folder::with(
        "g.tenon.json",
        shell_with(json!({ "type": "hinges.butt_hinge", "inputs": wires, "params": { "edges": "along rows" } })),
    );
    let run = |isolate: &[&str]| {
        let call = ["run", "g.tenon.json", "--plugin", hinges(), "--get", "more.features"];
        folder.tenon(&[&call[..], isolate].concat()).code(0).stdout
    };
    assert!(run(&[]) == run(&["--isolate", "hinges"]));
}

#[test]
fn policy_isolates_and_strangers_are_refused() {
    let folder = Folder::with("g.tenon.json", doomed(&json!(101), &json!("*")));
    let mut tenon = std::process::Command::new(env!("CARGO_BIN_EXE_tenon"));
    let call = ["run", "g.tenon.json", "--plugin", misbehaving()];
    let out = tenon.args(call).current_dir(&folder.0).env("TENON_PLUGIN_ISOLATION", "other, all").output().unwrap();
    assert_eq!(out.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&out.stderr).contains("plugin-died"));
    folder.tenon(&["plugin", "host", misbehaving(), "1000000"]).code(2).says(&["not by people"]);
    // A library that is no plugin is refused in the same words.
    folder.write("p.c", "int nothing;");
    let library = compile(&folder.0.join("p.c"), "nothing-apart", &[]);
    let ended = folder.tenon(&["run", "g.tenon.json", "--plugin", &library, "--isolate", "all"]);
    ended.code(2).says(&["does not export tenon_plugin_v1"]);
}
