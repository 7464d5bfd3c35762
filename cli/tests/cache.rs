//! `--cache`: the same bytes with it and without, whatever happens to the folder.

use crate::tenon::{Ended, Folder, shipped};
use serde_json::Value;
use std::collections::BTreeMap;
use std::process::{Command, Stdio};

/// Every file below `dir` with its content.
fn contents(folder: &Folder, dir: &str) -> BTreeMap<String, Vec<u8>> {
    let within = format!("{dir}/");
    let names = folder.files();
    let names = names.iter().filter_map(|n| n.strip_prefix(&within));
    names.map(|n| (n.to_owned(), std::fs::read(folder.0.join(dir).join(n)).unwrap())).collect()
}

/// Runs shell-256 with three iterations (64 panels); more `args` after it.
fn run(folder: &Folder, out: &str, args: &[&str]) -> Ended {
    let graph = shipped("shell-256");
    let report = format!("{out}.json");
    folder.tenon(&[&["run", &graph, "--set", "iterations=3", "--out", out, "--report", &report], args].concat())
}

fn report_of(folder: &Folder, out: &str) -> Value {
    serde_json::from_str(&folder.read(&format!("{out}.json"))).unwrap()
}

/// What came of each node, without times.
fn digests(report: &Value) -> BTreeMap<String, Value> {
    let nodes = report["nodes"].as_array().unwrap();
    nodes.iter().map(|n| (n["id"].as_str().unwrap().to_owned(), n["digest"].clone())).collect()
}

fn happened<'a>(report: &'a Value, id: &str) -> &'a Value {
    &report["nodes"].as_array().unwrap().iter().find(|n| n["id"] == id).unwrap()["happened"]
}

fn warnings(report: &Value) -> Vec<&Value> {
    report["diagnostics"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|d| d["code"].as_str().unwrap().starts_with("cache"))
        .collect()
}

/// A shipped graph as it is, without, with an empty and with a filled cache; what ran in the last.
fn thrice(folder: &Folder, name: &str) -> Value {
    let graph = shipped(name);
    let run = |out: &str, args: &[&str]| {
        let report = format!("{out}.json");
        folder.tenon(&[&["run", &graph, "--out", out, "--report", &report], args].concat()).code(0);
        (report_of(folder, out), contents(folder, out))
    };
    let (plain, files) = run(&format!("{name}-without"), &[]);
    let (first, of_first) = run(&format!("{name}-first"), &["--cache", "c", "--threads", "1"]);
    let (second, of_second) = run(&format!("{name}-second"), &["--cache", "c", "--threads", "2"]);
    assert!(of_first == files && of_second == files, "{name}");
    for report in [&first, &second] {
        assert_eq!(digests(report), digests(&plain));
        assert_eq!(report["diagnostics"], plain["diagnostics"]);
    }
    second
}

#[test]
fn with_and_without_it_a_run_gives_the_same_bytes() {
    let folder = Folder::new();
    let shell = thrice(&folder, "shell-256");
    assert_eq!(happened(&shell, "prove"), "disk");
    let quads = thrice(&folder, "quad-mesh");
    assert_eq!(happened(&quads, "prove"), "disk");
    assert!(folder.files().iter().filter(|n| n.starts_with("c/")).all(|n| n.ends_with(".kept")));
    // Other commands meet the same folder.
    let graph = shipped("shell-256");
    let plain = folder.tenon(&["inspect", &graph, "proof", "--json"]).code(0).stdout;
    assert_eq!(folder.tenon(&["inspect", &graph, "proof", "--json", "--cache", "c"]).code(0).stdout, plain);
    folder.tenon(&["test", &graph, "--cache", "c"]).code(0);
}

#[test]
fn damage_is_told_repaired_and_changes_nothing() {
    let folder = Folder::new();
    run(&folder, "first", &["--cache", "c"]).code(0);
    let before = contents(&folder, "c");
    for (i, (name, bytes)) in before.iter().enumerate() {
        let mut spoilt = bytes.clone();
        match i % 3 {
            0 => spoilt.truncate(bytes.len() / 2),
            1 => spoilt[bytes.len() - 1] ^= 1,
            _ => spoilt.clear(),
        }
        folder.write(&format!("c/{name}"), spoilt);
    }
    let ended = run(&folder, "second", &["--cache", "c"]).code(0).says(&["warning[cache-damaged]", ".kept"]);
    let told = report_of(&folder, "second");
    assert_eq!(warnings(&told).len(), before.len(), "{ended:?}");
    assert!(contents(&folder, "second") == contents(&folder, "first"));
    run(&folder, "third", &["--cache", "c"]).code(0);
    assert!(warnings(&report_of(&folder, "third")).is_empty());
    assert!(contents(&folder, "third") == contents(&folder, "first"));
}

#[test]
fn a_folder_that_cannot_be_written_is_one_warning() {
    let folder = Folder::with("c", "a file");
    let ended = run(&folder, "out", &["--cache", "c"]).code(0).says(&["warning[cache-failed]"]);
    assert_eq!(warnings(&report_of(&folder, "out")).len(), 1, "{ended:?}");
    run(&folder, "none", &["--cache-size", "1"]).code(2).says(&["--cache"]);
}

#[test]
fn a_sweeps_rows_do_not_depend_on_it() {
    let folder = Folder::new();
    let graph = shipped("shell-256");
    let plan = ["sweep", "plan", &graph, "--vary", "thickness=12,14", "--set", "iterations=2", "--out", "p.jsonl"];
    folder.tenon(&plan).code(0);
    let without = folder.tenon(&["sweep", "run", "p.jsonl", "--out", "without"]).code;
    for out in ["first", "second"] {
        folder.tenon(&["sweep", "run", "p.jsonl", "--out", out, "--cache", "c", "--jobs", "2"]).code(without);
        assert!(contents(&folder, out) == contents(&folder, "without"));
    }
    assert!(folder.files().iter().any(|n| n.ends_with(".kept")));
    // Damage is of no matter to a row either.
    for name in folder.files().iter().filter(|n| n.ends_with(".kept")) {
        folder.write(name, "");
    }
    let run = ["sweep", "run", "p.jsonl", "--out", "third", "--cache", "c"];
    folder.tenon(&run).code(without).says(&["warning[cache-damaged]"]);
    assert!(contents(&folder, "third") == contents(&folder, "without"));
}

fn start(folder: &Folder, out: &str) -> std::process::Child {
    Command::new(env!("CARGO_BIN_EXE_tenon"))
        .args(["run", &shipped("shell-256"), "--set", "iterations=3", "--out", out, "--cache", "c"])
        .current_dir(&folder.0)
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

#[test]
fn two_processes_share_a_folder() {
    let folder = Folder::new();
    let mut both = ["a", "b"].map(|out| start(&folder, out));
    for child in &mut both {
        assert!(child.wait().unwrap().success());
    }
    run(&folder, "alone", &[]).code(0);
    run(&folder, "after", &["--cache", "c"]).code(0);
    assert!(warnings(&report_of(&folder, "after")).is_empty());
    for out in ["a", "b", "after"] {
        assert!(contents(&folder, out) == contents(&folder, "alone"));
    }
    assert!(!folder.files().iter().any(|n| n.contains(".tmp")), "{:?}", folder.files());
}

#[cfg(unix)]
#[test]
fn what_a_killed_process_leaves_is_whole_or_not_there() {
    use std::time::{Duration, Instant};
    let folder = Folder::new();
    run(&folder, "alone", &[]).code(0);
    // Only names: what is being written may have another one by the time that it is read.
    let names = || folder.files().iter().filter(|n| n.starts_with("c/") && n.ends_with(".kept")).count();
    let mut killed = 0;
    for round in 0..6_u64 {
        let mut child = start(&folder, "killed");
        let (begun, had) = (Instant::now(), if folder.0.join("c").exists() { names() } else { 0 });
        // As soon as it has kept one more, a little later each time.
        while (!folder.0.join("c").exists() || names() == had) && child.try_wait().unwrap().is_none() {
            assert!(begun.elapsed() < Duration::from_secs(120), "nothing is ever kept");
            std::thread::sleep(Duration::from_millis(1));
        }
        std::thread::sleep(Duration::from_millis(2 * round));
        // SIGKILL; fails only if it has come to its end.
        let _ = child.kill();
        killed += usize::from(!child.wait().unwrap().success());
    }
    assert!(killed > 0, "the kills came too late");
    run(&folder, "after", &["--cache", "c"]).code(0);
    let after = report_of(&folder, "after");
    assert!(warnings(&after).is_empty(), "{:?}", warnings(&after));
    assert!(contents(&folder, "after") == contents(&folder, "alone"));
}
