//! `tenon run --out` killed at any moment: what has its name is whole, and all of it is of this run or of the one before.
#![cfg(unix)]

use crate::tenon::{Folder, shipped};
use std::collections::BTreeMap;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

/// Files under their final names, with their content.
fn named(folder: &Folder, dir: &str) -> BTreeMap<String, Vec<u8>> {
    let within = format!("{dir}/");
    let names = folder.files().into_iter().filter_map(|n| n.strip_prefix(&within).map(str::to_owned));
    let names = names.filter(|n| !n.ends_with(".tmp") && !n.ends_with(".stale"));
    names.filter_map(|n| Some((n.clone(), std::fs::read(folder.0.join(dir).join(&n)).ok()?))).collect()
}

fn arguments<'a>(graph: &'a str, thickness: &'a str, out: &'a str) -> Vec<&'a str> {
    vec!["run", graph, "--set", "iterations=3", "--set", thickness, "--out", out]
}

#[test]
fn nothing_half_written_has_a_name() {
    let folder = Folder::new();
    let graph = shipped("shell-256");
    folder.tenon(&arguments(&graph, "thickness=12", "old"));
    let start = Instant::now();
    folder.tenon(&arguments(&graph, "thickness=14", "new"));
    let takes = start.elapsed();
    let (old, new) = (named(&folder, "old"), named(&folder, "new"));
    assert!(!new.is_empty() && old != new);

    let mut cut_short = 0;
    for round in 0..24_u32 {
        // Over what the run before has left, as users do.
        for (name, bytes) in &old {
            folder.write(&format!("out/{name}"), bytes);
        }
        let mut child = Command::new(env!("CARGO_BIN_EXE_tenon"))
            .args(arguments(&graph, "thickness=14", "out"))
            .current_dir(&folder.0)
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let writes =
            || folder.files().iter().any(|n| n.starts_with("out/") && n.ends_with(".tmp") && !n.contains("probe"));
        let start = Instant::now();
        if round % 4 == 0 {
            std::thread::sleep(takes * round / 24);
        } else {
            // Files are written at the end, in a moment: wait for the first, then strike at other places of it.
            while !writes() && child.try_wait().unwrap().is_none() && start.elapsed() < Duration::from_secs(120) {
                std::thread::sleep(Duration::from_micros(200));
            }
            std::thread::sleep(Duration::from_micros(700) * (round / 4 * round));
        }
        // SIGKILL; it may have come to its end.
        let _ = child.kill();
        cut_short += u32::from(child.wait().unwrap().code().is_none());
        let left = named(&folder, "out");
        for (name, bytes) in &left {
            let whole = [&old, &new].iter().any(|all| all.get(name) == Some(bytes));
            assert!(whole, "round {round}: {name} with {} bytes is half-written", bytes.len());
        }
        // The list of files comes last, and is that of the run before until then.
        let of = |all: &BTreeMap<String, Vec<u8>>| {
            left.iter().filter(|(name, _)| *name != ".tenon-files").all(|(name, bytes)| all.get(name) == Some(bytes))
        };
        assert!(of(&old) || of(&new), "round {round}: files of two runs stand side by side");
        std::fs::remove_dir_all(folder.0.join("out")).unwrap();
    }
    assert!(cut_short >= 4, "only {cut_short} of the runs were killed before their end");
}
