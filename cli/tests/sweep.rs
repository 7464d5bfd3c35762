//! `tenon sweep`: plans, rows, all rows, and what a kill at any moment leaves.

use crate::tenon::{Folder, NUMBERS, shipped};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::path::Path;

/// Names of the rows' folders.
fn keys(folder: &Folder, plan: &str) -> Vec<String> {
    let rows = folder.read(plan);
    rows.lines().map(|l| serde_json::from_str::<Value>(l).unwrap()["key"].as_str().unwrap().to_owned()).collect()
}

/// Every file below `dir` with its content, temporary and hidden ones left out.
fn contents(folder: &Folder, dir: &str) -> BTreeMap<String, Vec<u8>> {
    let within = format!("{dir}/");
    let names = folder.files();
    let names = names.iter().filter_map(|n| n.strip_prefix(&within)).filter(|n| !n.starts_with('.'));
    names.map(|n| (n.to_owned(), std::fs::read(folder.0.join(dir).join(n)).unwrap())).collect()
}

fn planned() -> Folder {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let vary = ["--vary", "thickness=1,2.5", "--vary", "pair.step=0:2:3"];
    folder.tenon(&[&["sweep", "plan", ".", "--out", "p.jsonl"], &vary[..]].concat()).code(0);
    folder
}

#[test]
fn a_plan_holds_every_combination_once() {
    let folder = planned();
    let rows: Vec<Value> = folder.read("p.jsonl").lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    let sets: Vec<&Value> = rows.iter().map(|r| &r["set"]).collect();
    let row = |t: Value, s: u32| json!({"thickness": t, "pair.step": s});
    assert_eq!(sets[0], &row(json!(1), 0));
    assert_eq!(sets[1], &row(json!(1), 1));
    assert_eq!(sets[5], &row(json!(2.5), 2));
    assert_eq!(rows.len(), 6);
    assert_eq!(rows[0]["graph"], "g.tenon.json");
    let mut keys = keys(&folder, "p.jsonl");
    keys.sort();
    keys.dedup();
    assert_eq!(keys.len(), 6);
    let twice = ["sweep", "plan", ".", "--vary", "thickness=1,1,2", "--set", "pair.count=3", "--out", "twice.jsonl"];
    folder.tenon(&twice).code(0).says(&["1 rows were the same"]);
    assert_eq!(folder.read("twice.jsonl").lines().count(), 2);
}

#[test]
fn what_cannot_be_planned_is_refused() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let refused = |args: &[&str], words: &[&str]| {
        folder.tenon(&[&["sweep", "plan", ".", "--out", "p.jsonl"], args].concat()).code(2).says(words);
        assert_eq!(folder.files(), ["g.tenon.json"]);
    };
    refused(&["--vary", "thickness"], &["NAME=VALUES"]);
    refused(&["--vary", "thicknes=1"], &["thickness"]);
    refused(&["--vary", "thickness=1,,2"], &["empty value"]);
    refused(&["--vary", "thickness=1,thick"], &["\"thick\" cannot be done"]);
    refused(&["--vary", "thickness=1", "--set", "thickness=2"], &["given twice"]);
    refused(&["--vary", "thickness=0:1:2000", "--vary", "pair.step=0:1:2000"], &["4000000 rows"]);
    refused(&[], &["--vary"]);
}

#[test]
fn a_sweep_evaluates_every_row_and_none_again() {
    let folder = planned();
    let run = || folder.tenon(&["sweep", "run", "p.jsonl", "--out", "r", "--jobs", "2", "--json"]).code(0).json();
    let (first, before) = (run(), contents(&folder, "r"));
    assert_eq!((&first["rows"], &first["evaluated"], &first["finished_before"]), (&json!(6), &json!(6), &json!(0)));
    let again = run();
    assert_eq!((&again["evaluated"], &again["finished_before"]), (&json!(0), &json!(6)));
    assert_eq!(contents(&folder, "r"), before);

    let table: Vec<Value> = folder.read("r/results.jsonl").lines().map(|l| serde_json::from_str(l).unwrap()).collect();
    let numbers = |i: usize| table[i]["values"]["numbers"]["value"]["branches"]["{0}"].clone();
    assert_eq!(numbers(0), json!([1.0, 1.0]));
    assert_eq!(numbers(5), json!([2.5, 4.5]));
}

#[test]
fn a_row_alone_gives_the_same_bytes() {
    let folder = planned();
    folder.tenon(&["sweep", "run", "p.jsonl", "--out", "all"]).code(0);
    for key in keys(&folder, "p.jsonl") {
        folder.tenon(&["sweep", "run-row", "p.jsonl", &key, "--out", "one"]).code(0);
        folder.tenon(&["sweep", "run-row", "p.jsonl", &key, "--out", "one"]).code(0).says(&["finished already"]);
    }
    let mut all = contents(&folder, "all");
    all.remove("results.jsonl").unwrap();
    assert_eq!(contents(&folder, "one"), all);
    folder.tenon(&["sweep", "run-row", "p.jsonl", "0", "--out", "one"]).code(2).says(&["no row 0"]);
}

#[test]
fn a_frozen_node_does_not_carry_a_value_from_row_to_row() {
    let frozen = NUMBERS.replace(r#""pair": {"#, r#""pair": {"state": "frozen", "#);
    let folder = Folder::with("g.tenon.json", frozen);
    folder.tenon(&["sweep", "plan", ".", "--vary", "thickness=1,2,3", "--out", "p.jsonl"]).code(0);
    folder.tenon(&["sweep", "run", "p.jsonl", "--out", "all"]).code(0);
    for (key, first) in keys(&folder, "p.jsonl").iter().zip([1.0, 2.0, 3.0]) {
        let result: Value = serde_json::from_str(&folder.read(&format!("all/{key}/result.json"))).unwrap();
        assert_eq!(result["values"]["numbers"]["value"]["branches"]["{0}"][0], json!(first));
    }
}

#[test]
fn another_graph_than_the_planned_one_is_refused() {
    let folder = planned();
    folder.tenon(&["sweep", "run", "p.jsonl", "--out", "r"]).code(0);
    folder.write("g.tenon.json", NUMBERS.replace(r#""count": 2"#, r#""count": 3"#));
    let key = &keys(&folder, "p.jsonl")[0];
    folder.tenon(&["sweep", "run-row", "p.jsonl", key, "--out", "r"]).code(2).says(&["is another than"]);
    folder.tenon(&["sweep", "run", "p.jsonl", "--out", "other"]).code(2).says(&["is another than"]);
    folder.write("p.jsonl", "{}\n");
    folder.tenon(&["sweep", "run", "p.jsonl", "--out", "r"]).code(2).says(&["line 1"]);
}

#[test]
fn rows_with_errors_are_results_too() {
    let folder = planned();
    let plan = ["sweep", "plan", ".", "--vary", "pair.step=1,1e308", "--set", "pair.start=null", "--out", "p.jsonl"];
    // The start has a wire: it cannot be set.
    folder.tenon(&plan).code(2).says(&["wire"]);
    let plan = ["sweep", "plan", ".", "--vary", "pair.step=1,1e308", "--set", "pair.count=3", "--out", "p.jsonl"];
    folder.tenon(&plan).code(0);
    for evaluated in [2, 0] {
        let ended = folder.tenon(&["sweep", "run", "p.jsonl", "--out", "r", "--json"]).code(1).says(&["pair.step=1e"]);
        assert_eq!((&ended.json()["evaluated"], &ended.json()["with_errors"]), (&json!(evaluated), &json!(1)));
    }
}

#[test]
fn damaged_results_and_changed_input_files_are_evaluated_again() {
    let folder = Folder::new();
    let from = shipped("quad-mesh");
    for name in ["quad-mesh.tenon.json", "canopy.obj"] {
        folder.write(name, std::fs::read(Path::new(&from).join(name)).unwrap());
    }
    folder.tenon(&["sweep", "plan", ".", "--vary", "thickness=21,24", "--out", "p.jsonl"]).code(0);
    let run = || folder.tenon(&["sweep", "run", "p.jsonl", "--out", "r", "--json"]).json()["evaluated"].clone();
    assert_eq!((run(), run()), (json!(2), json!(0)));
    let before = contents(&folder, "r");
    let (name, bytes) = before.iter().find(|(name, _)| name.contains("/files/")).unwrap();
    let mut flipped = bytes.clone();
    flipped[bytes.len() / 2] ^= 1;
    folder.write(&format!("r/{name}"), flipped);
    assert_eq!((run(), run()), (json!(1), json!(0)));
    assert!(contents(&folder, "r") == before);

    // A number in a result that is still JSON; a result that was cut off; one that has gone.
    let result = before.keys().find(|name| name.ends_with("/result.json")).unwrap();
    let text = folder.read(&format!("r/{result}"));
    let changed = text.replacen("\"ok\": true", "\"ok\": false", 1);
    assert_ne!(changed, text);
    for damage in [changed.as_bytes(), &text.as_bytes()[..text.len() / 2], b""] {
        folder.write(&format!("r/{result}"), damage);
        let ended = folder.tenon(&["sweep", "run", "p.jsonl", "--out", "r", "--json"]).code(0);
        let ended = ended.says(&["result.json is damaged; the row is evaluated again"]).json();
        assert_eq!((&ended["evaluated"], &ended["damaged"]), (&json!(1), &json!(1)));
        assert!(contents(&folder, "r") == before);
    }
    assert_eq!(run(), json!(0));

    folder.write("canopy.obj", format!("# another file\n{}", folder.read("canopy.obj")));
    assert_eq!((run(), run()), (json!(2), json!(0)));
}

#[test]
fn two_sweeps_do_not_share_a_folder() {
    let folder = planned();
    std::fs::create_dir(folder.0.join("r")).unwrap();
    let lock = std::fs::File::create(folder.0.join("r/.tenon-sweep.lock")).unwrap();
    lock.lock_shared().unwrap();
    let run = || folder.tenon(&["sweep", "run", "p.jsonl", "--out", "r"]);
    run().code(2).says(&["another sweep"]);
    // Rows alone go side by side.
    folder.tenon(&["sweep", "run-row", "p.jsonl", &keys(&folder, "p.jsonl")[0], "--out", "r"]).code(0);
    drop(lock);
    run().code(0);
}

#[cfg(unix)]
#[test]
fn a_killed_sweep_goes_on_where_it_was() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    let folder = Folder::new();
    let graph = shipped("shell-256");
    let plan = ["sweep", "plan", &graph, "--vary", "thickness=12:16:9", "--set", "iterations=3", "--out", "p.jsonl"];
    folder.tenon(&plan).code(0);
    let whole = folder.tenon(&["sweep", "run", "p.jsonl", "--out", "whole", "--jobs", "2"]);
    let keys = keys(&folder, "p.jsonl");
    let there = || keys.iter().filter(|k| folder.0.join("r").join(k).exists()).count();
    let stamp = |key: &String| std::fs::metadata(folder.0.join("r").join(key).join("result.json")).unwrap().modified();
    let (mut stamps, mut killed) = (BTreeMap::<String, _>::new(), 0);
    for round in 0..4_u64 {
        let mut child = Command::new(env!("CARGO_BIN_EXE_tenon"))
            .args(["sweep", "run", "p.jsonl", "--out", "r", "--jobs", "2"])
            .current_dir(&folder.0)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let (start, had) = (Instant::now(), there());
        while there() == had && child.try_wait().unwrap().is_none() {
            assert!(start.elapsed() < Duration::from_secs(120), "no row is ever finished");
            std::thread::sleep(Duration::from_millis(1));
        }
        // At another place of the work each time.
        std::thread::sleep(Duration::from_millis(7 * round));
        // SIGKILL; fails only if it has come to its end.
        let _ = child.kill();
        killed += usize::from(child.wait().unwrap().code().is_none());
        for key in keys.iter().filter(|k| folder.0.join("r").join(k).exists()) {
            // What has its name is whole, and is not made a second time.
            let (mine, other) = (contents(&folder, &format!("r/{key}")), contents(&folder, &format!("whole/{key}")));
            assert!(mine == other, "{key} is half-written");
            let now = stamp(key).unwrap();
            assert_eq!(*stamps.entry(key.clone()).or_insert(now), now, "{key} was evaluated twice");
        }
    }
    assert!(!stamps.is_empty() && killed > 0, "{} rows: the kills came too late", stamps.len());
    let last = folder.tenon(&["sweep", "run", "p.jsonl", "--out", "r"]);
    assert_eq!(last.code, whole.code);
    assert!(contents(&folder, "r") == contents(&folder, "whole"));
    for (key, then) in &stamps {
        assert_eq!(stamp(key).unwrap(), *then);
    }
    assert!(!folder.files().iter().any(|n| n.contains(".tmp")), "{:?}", folder.files());
}
