//! The suite `engine`: ours beside salsa and a plain petgraph engine, on chains and fans of trivial nodes, by size.
//!
//! The peers live in `benches/engine`, a workspace of its own, so that ordinary builds do not compile them. It is built
//! and run here as a child, and prints raw numbers.

use super::figure::Figure;
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::{Command, Stdio};

/// The sizes at which figures are aimed at something; the others show how cost grows.
const AIMED: u64 = 10_000;
const SIZES: [&str; 4] = ["1000", "10000", "100000", "1000000"];
const OURS: &str = "tenon";

/// Case, unit, and what is aimed at for 10,000 nodes (at any size where a case has only one).
const CASES: [(&str, &str, Option<f64>); 10] = [
    ("chain_cut_off", "us", Some(1.0)),
    ("chain_full", "us", Some(1000.0)),
    ("chain_bytes", "bytes/node", Some(400.0)),
    ("fan_cut_off", "us", Some(1.0)),
    ("fan_full", "us", Some(1000.0)),
    ("fan_bytes", "bytes/node", Some(400.0)),
    ("small_stack", "ms", None),
    ("items", "ns/item", Some(100.0)),
    ("load", "ms", Some(60.0)),
    ("threads", "x", Some(1.7)),
];

/// One raw line of the child.
struct Raw {
    engine: String,
    case: String,
    size: u64,
    value: f64,
}

/// Runs the suite at the sizes given, or at all.
pub fn run(sizes: &[&str]) -> Result<(), String> {
    if let Some(other) = sizes.iter().find(|s| s.parse::<u64>().is_err()) {
        return Err(format!("\"{other}\" is not a number of nodes"));
    }
    let mut child = Command::new(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
        .args(["run", "--release", "--quiet", "--locked", "--manifest-path"])
        .arg(crate::root().join("benches/engine/Cargo.toml"))
        .arg("--target-dir")
        .arg(crate::root().join("target/engine-bench"))
        .arg("--")
        .args(if sizes.is_empty() { &SIZES } else { sizes })
        .stdout(Stdio::piped())
        .spawn()
        .map_err(|e| format!("cargo: {e}"))?;
    let out = child.stdout.take().ok_or("no output")?;
    let mut waiting: Vec<Raw> = Vec::new();
    for line in BufReader::new(out).lines() {
        let line = line.map_err(|e| e.to_string())?;
        let raw = read(&line).ok_or_else(|| format!("not a figure: {line}"))?;
        // The engines come one after another: when ours comes again, everything so far is complete.
        if raw.engine == OURS && waiting.iter().any(|w| w.engine != OURS || w.case == raw.case) {
            print(&waiting);
            waiting.clear();
        }
        waiting.push(raw);
    }
    print(&waiting);
    let status = child.wait().map_err(|e| e.to_string())?;
    if status.success() { Ok(()) } else { Err("the engines did not run to their end".to_owned()) }
}

fn read(line: &str) -> Option<Raw> {
    let json: Value = serde_json::from_str(line).ok()?;
    let text = |key: &str| json[key].as_str().map(str::to_owned);
    Some(Raw {
        engine: text("engine")?,
        case: text("case")?,
        size: json["size"].as_u64()?,
        value: json["value"].as_f64()?,
    })
}

/// One figure per number of ours and peer; a number that no peer has stands alone.
fn print(raw: &[Raw]) {
    for ours in raw.iter().filter(|r| r.engine == OURS) {
        let Some((case, unit, target)) = CASES.into_iter().find(|(case, ..)| *case == ours.case) else { continue };
        let by_size = case.starts_with("chain_") || case.starts_with("fan_");
        let target = target.filter(|_| !by_size || ours.size == AIMED);
        let figure = |peer: Option<&Raw>| Figure {
            suite: "engine",
            case,
            size: ours.size,
            ours: ours.value,
            unit,
            peer: peer.map(|p| p.engine.clone()),
            theirs: peer.map(|p| p.value),
            target,
        };
        let mut peers = raw.iter().filter(|r| r.engine != OURS && r.case == case && r.size == ours.size).peekable();
        if peers.peek().is_none() {
            figure(None).print();
        }
        peers.for_each(|peer| figure(Some(peer)).print());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_raw_line_is_read_whole_or_not_at_all() {
        let raw = read(r#"{"engine":"tenon","case":"items","size":10000,"value":81.5}"#).unwrap();
        assert_eq!((raw.engine.as_str(), raw.case.as_str(), raw.size, raw.value), (OURS, "items", 10_000, 81.5));
        assert!(read(r#"{"engine":"tenon","case":"items","size":10000}"#).is_none() && read("warning").is_none());
    }
}
