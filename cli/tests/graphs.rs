//! The graphs that are shipped, by the real binary: checked, formatted, run, proven, withheld.

use crate::tenon::{Ended, Folder, shipped};

/// The shell with 4 × 4 panels: the whole chain in a moment.
const SMALL: [&str; 4] = ["--set", "iterations=2", "--out", "out"];

fn small_shell(folder: &Folder, more: &[&str]) -> Ended {
    let graph = shipped("shell-256");
    folder.tenon(&[&["run", graph.as_str()], &SMALL[..], more].concat())
}

#[test]
fn every_shipped_graph_is_without_errors_and_in_canonical_form() {
    let folder = Folder::new();
    let mut files = Vec::new();
    for entry in std::fs::read_dir(shipped("")).unwrap() {
        let path = entry.unwrap().path();
        if !path.is_dir() {
            continue; // what is told of the graphs
        }
        let inside = path.read_dir().unwrap().map(|e| e.unwrap().path().to_str().unwrap().to_owned());
        files.extend(inside.filter(|f| f.ends_with(".tenon.json")));
    }
    assert!(files.len() >= 18, "{files:?}");
    for file in &files {
        folder.tenon(&["check", file]).code(0);
        let expected = file.replace(".tenon.json", ".expect.json");
        assert!(std::path::Path::new(&expected).exists(), "no {expected}");
    }
    let all: Vec<&str> = ["fmt", "--check"].into_iter().chain(files.iter().map(String::as_str)).collect();
    folder.tenon(&all).code(0);
}

#[test]
fn a_shell_becomes_proven_programs() {
    let folder = Folder::new();
    let ended = small_shell(&folder, &["--report", "report.json"]).code(0);
    assert!(ended.stdout.contains("wrote out/board-1.ngc"), "{ended:#?}");
    assert!(ended.stdout.contains("programs passed"), "the proof's figures are printed: {ended:#?}");
    let files = folder.files();
    for name in ["layout.dxf", "layout.svg", "pieces.csv", "panels.obj", "proof.json", "board-1.ngc"] {
        assert!(files.contains(&format!("out/{name}")), "no {name} in {files:?}");
    }
    let report: serde_json::Value = serde_json::from_str(&folder.read("report.json")).unwrap();
    assert_eq!(report["ok"], true);
    for file in report["files"].as_array().unwrap() {
        let written = folder.read(file["path"].as_str().unwrap());
        assert_eq!(file["bytes"], written.len());
    }
}

#[test]
fn threads_and_repetition_do_not_change_a_byte() {
    let bytes = |threads: &str| {
        let folder = Folder::new();
        small_shell(&folder, &["--threads", threads]).code(0);
        folder.files().iter().map(|f| (f.clone(), folder.read(f))).collect::<Vec<_>>()
    };
    let one = bytes("1");
    assert!(one.len() > 5);
    assert_eq!(one, bytes("2"));
    assert_eq!(one, bytes("2"));
}

#[test]
fn a_program_that_fails_its_proof_does_not_get_its_final_name() {
    // No program leaves less than a nanometre of wood.
    let strict = ["--set", "prove.leftover=0.000001", "--set", "prove.gouge=0.000001"];
    let folder = Folder::new();
    small_shell(&folder, &strict).code(1).says(&["error[withheld]", "board-1.ngc", "--unproven"]);
    let files = folder.files();
    assert!(files.contains(&"out/board-1.ngc.unproven".to_owned()), "{files:?}");
    assert!(!files.contains(&"out/board-1.ngc".to_owned()), "{files:?}");

    let insisted = Folder::new();
    small_shell(&insisted, &[&strict[..], &["--unproven"]].concat());
    let text = insisted.read("out/board-1.ngc");
    assert!(text.lines().take(20).any(|line| line.to_lowercase().contains("proof failed")), "{}", &text[..400]);
}

#[test]
fn a_later_run_leaves_no_program_of_an_earlier_one() {
    let folder = Folder::new();
    small_shell(&folder, &["--set", "board_y=2000"]).code(0);
    let before = folder.files().iter().filter(|f| f.ends_with(".ngc")).count();
    small_shell(&folder, &["--set", "iterations=1"]);
    let files = folder.files();
    let programs = files.iter().filter(|f| f.ends_with(".ngc")).count();
    let stale = files.iter().filter(|f| f.ends_with(".ngc.stale")).count();
    assert!(stale > 0 && programs + stale == before, "{files:?}");
}

#[test]
fn a_range_holds_in_every_unit() {
    let folder = Folder::new();
    for thick in ["50", "50 mm", "5 cm", "3 mm"] {
        let ended = small_shell(&folder, &["--set", &format!("thickness={thick}")]).code(2);
        ended.says(&["out-of-range", "4 to 30 mm"]);
    }
    small_shell(&folder, &["--set", "thickness=1.2 cm"]).code(0);
}

#[test]
fn a_moved_point_reaches_the_programs() {
    let folder = Folder::new();
    small_shell(&folder, &[]).code(0);
    let before = folder.read("out/board-1.ngc");
    small_shell(&folder, &["--set", "fold_depth=20"]).code(0);
    assert_ne!(before, folder.read("out/board-1.ngc"));
}
