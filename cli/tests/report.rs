//! `--report`, `--json`, `--profile`: what a run says of itself.

use crate::tenon::{Folder, HALF_BROKEN, NUMBERS};
use serde_json::Value;

#[test]
fn the_report_has_diagnostics_nodes_and_files() {
    let folder = Folder::with("g.tenon.json", HALF_BROKEN);
    folder.tenon(&["run", ".", "--report", "r/report.json"]).code(1);
    let report: Value = serde_json::from_str(&folder.read("r/report.json")).unwrap();
    assert_eq!(report["ok"], false);
    let diagnostics = report["diagnostics"].as_array().unwrap();
    let error = diagnostics.iter().find(|d| d["severity"] == "error").unwrap();
    assert_eq!((error["code"].as_str(), error["node"].as_str()), (Some("series-too-far"), Some("broken")));
    assert!(diagnostics.iter().any(|d| d["code"] == "blocked" && d["node"] == "after"));
    let mut ids: Vec<&str> = report["nodes"].as_array().unwrap().iter().map(|n| n["id"].as_str().unwrap()).collect();
    ids.sort_unstable();
    assert_eq!(ids, ["after", "broken", "fine"]);
    assert!(report["files"].as_array().unwrap().is_empty());
}

#[test]
fn json_goes_to_stdout_and_words_to_stderr() {
    let folder = Folder::with("g.tenon.json", HALF_BROKEN);
    let ended = folder.tenon(&["run", ".", "--json"]).code(1).says(&["error[series-too-far]"]);
    assert_eq!(ended.json()["ok"], false);
    assert!(!ended.stderr.contains('\x1b'), "no colours where nobody sees them");
}

#[test]
fn the_profile_names_every_node() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let ended = folder.tenon(&["run", ".", "--profile", "--get", "numbers", "--get", "label.value"]).code(0);
    ended.says(&[" n ", " pair ", " label "]);
}

#[test]
fn the_digests_do_not_depend_on_the_threads() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let digests = |threads: &str| {
        let json = folder.tenon(&["run", ".", "--json", "--threads", threads]).code(0).json();
        let nodes = json["nodes"].as_array().unwrap().clone();
        nodes.iter().map(|n| n["digest"].clone()).collect::<Vec<_>>()
    };
    assert_eq!(digests("1"), digests("2"));
    assert!(digests("1").iter().any(|d| !d.is_null()));
}
