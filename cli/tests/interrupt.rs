//! Ctrl-C ends a run soon and leaves nothing half-written.
#![cfg(unix)]

use crate::tenon::{Folder, shipped};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

#[test]
fn an_interrupted_run_writes_nothing() {
    let folder = Folder::new();
    let graph = shipped("shell-256");
    // 4096 panels: the work goes on for seconds.
    let mut child = Command::new(env!("CARGO_BIN_EXE_tenon"))
        .args(["run", &graph, "--set", "iterations=6", "--out", "out", "--report", "report.json"])
        .current_dir(&folder.0)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let start = Instant::now();
    // The folder is made just before the work begins.
    while !folder.0.join("out").exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "the run does not begin");
        std::thread::sleep(Duration::from_millis(1));
    }
    std::thread::sleep(Duration::from_millis(200));
    let interrupted = Instant::now();
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let status = child.wait().unwrap();
    assert_eq!(status.code(), Some(130));
    // Generous: the machine may be busy with other tests.
    assert!(interrupted.elapsed() < Duration::from_secs(5), "{:?}", interrupted.elapsed());
    assert!(folder.files().is_empty(), "{:?}", folder.files());
}
