//! The suite `cancel`: how long an evaluation goes on after it was told to stop, at random moments of the longest jobs
//! that there are.

use super::figure::Figure;
use super::shell::{Size, text};
use serde_json::json;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tenon_engine::{Control, Document, Host, Options, Progress, Random, Registry, Session};

/// From being told to having stopped, ms.
const AIM: f64 = 50.0;

/// How often each job is cancelled: as often as fits into two minutes of work, between these.
const ROUNDS: (f64, f64) = (10.0, 40.0);
const PATIENCE: f64 = 120.0;

/// Numbers of the lists.
const LONG: u64 = 10_000_000;

/// A job: its name, its size, the graph.
type Job = (&'static str, u64, String);

/// Files of the working folder.
struct Disk;

impl Host for Disk {
    fn read(&self, path: &str) -> std::io::Result<Arc<[u8]>> {
        std::fs::read(path).map(Into::into)
    }
}

/// Runs the named cases, or all; OBJ files among the names are planarized.
pub fn run(names: &[&str]) -> Result<(), String> {
    let (files, names): (Vec<&str>, Vec<&str>) = names.iter().partition(|n| n.ends_with(".obj"));
    let wanted = |case: &str| (names.is_empty() && files.is_empty()) || names.contains(&case);
    let registry = Arc::new(tenon_nodes::registry());
    let mut jobs: Vec<Job> = Vec::new();
    for (case, size) in [("shell_256", Size::STANDS), ("shell_1024", Size::GROWTH[0]), ("shell_10240", Size::GROWTH[1])]
    {
        jobs.push((case, size.panels(), text(size)?));
    }
    jobs.extend(lists());
    jobs.retain(|(case, ..)| wanted(case));
    for file in files {
        let bytes = std::fs::metadata(Path::new(file)).map_err(|e| format!("{file}: {e}"))?.len();
        jobs.push(("planarize", bytes, planarize(file)));
    }
    if jobs.is_empty() {
        return Err(
            "no such case: there are shell_256, shell_1024, shell_10240, series, sort, shape, rows, FILE.obj".into()
        );
    }
    jobs.into_iter().try_for_each(|job| measure(&registry, &job))
}

fn graph(nodes: &serde_json::Value) -> String {
    json!({"format": "tenon", "version": 1, "units": "mm", "nodes": nodes}).to_string()
}

/// Long lists through the nodes that work on them.
fn lists() -> Vec<Job> {
    let series = json!({"type": "series", "v": 1, "params": {"count": LONG}});
    let random = json!({"type": "random", "v": 1, "params": {"count": LONG}});
    let from = |wire: &str| json!({"from": [wire]});
    vec![
        ("series", LONG, graph(&json!({"s": series}))),
        (
            "sort",
            LONG,
            graph(&json!({
                "r": random,
                "o": {"type": "sort", "v": 1, "inputs": {"keys": from("r.numbers")}},
                "u": {"type": "statistics", "v": 1, "inputs": {"numbers": from("r.numbers")}},
            })),
        ),
        (
            "shape",
            LONG,
            graph(&json!({
                "s": series,
                "p": {"type": "partition", "v": 1, "params": {"sizes": 10}, "inputs": {"tree": from("s.numbers")}},
                "x": {"type": "remap", "v": 1, "inputs": {"value": from("s.numbers")}},
            })),
        ),
        (
            "rows",
            LONG,
            graph(&json!({
                "s": series,
                "p": {"type": "partition", "v": 1, "params": {"sizes": 10}, "inputs": {"tree": from("s.numbers")}},
                "x": {"type": "remap", "v": 1, "inputs": {"value": from("p.tree")}},
            })),
        ),
    ]
}

/// As many steps as may be, towards what cannot be reached.
fn planarize(file: &str) -> String {
    graph(&json!({
        "m": {"type": "read_mesh", "v": 1, "params": {"path": file}},
        "p": {"type": "planarize", "v": 1, "params": {"threshold": 1e-9, "iterations": 2000}, "inputs": {"mesh": {"from": ["m.mesh"]}}},
    }))
}

fn session(registry: &Arc<Registry>, text: &str) -> Result<Session, String> {
    let document = Document::from_slice(text.as_bytes()).map_err(|d| format!("{d:?}"))?;
    let options = Options { threads: 2, cache_bytes: 1 << 30, host: Arc::new(Disk), ..Options::default() };
    Ok(Session::new(registry.clone(), document, options))
}

/// Cancels a job at moments spread over its length and prints the worst time that it went on, and in which nodes.
fn measure(registry: &Arc<Registry>, (case, size, text): &Job) -> Result<(), String> {
    let whole = Instant::now();
    let report = session(registry, text)?.evaluate(&[], &Control::default());
    let whole = whole.elapsed();
    for error in super::shell::errors(&report).take(1) {
        eprintln!("{case}: {error}");
    }
    let rounds = (PATIENCE / whole.as_secs_f64()).clamp(ROUNDS.0, ROUNDS.1) as u64;
    let mut random = Random::new(*size as i64);
    let mut times = Vec::new();
    let mut worst: BTreeMap<String, f64> = BTreeMap::new();
    for round in 0..rounds {
        // One moment in each of as many parts of the job.
        let part = (round as f64 + random.next().unwrap_or(0.5)) / rounds as f64;
        let Some((node, ms)) = cancel(registry, text, whole.mul_f64(part))? else { continue };
        times.push(ms);
        let most = worst.entry(node).or_insert(0.0);
        *most = most.max(ms);
    }
    times.sort_by(f64::total_cmp);
    for (node, ms) in worst.iter().filter(|(_, ms)| **ms > AIM / 2.0) {
        eprintln!("{case}: {ms:.0} ms in or after {node}");
    }
    let figure = |case, ours| Figure {
        suite: "cancel",
        case,
        size: *size,
        ours,
        unit: "ms",
        peer: None,
        theirs: None,
        target: Some(AIM),
    };
    figure(case, times.last().copied().unwrap_or(f64::NAN)).print();
    eprintln!(
        "{case}: {} cancellations in {:.1} s of work, median {:.2} ms",
        times.len(),
        whole.as_secs_f64(),
        times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
    );
    Ok(())
}

/// Starts a job, cancels it after `wait`, and gives how long it went on, with the node that had reported last; none if it
/// was done before.
fn cancel(registry: &Arc<Registry>, text: &str, wait: Duration) -> Result<Option<(String, f64)>, String> {
    let mut session = session(registry, text)?;
    let flag = Arc::new(AtomicBool::new(false));
    let last: Mutex<String> = Mutex::default();
    let note = |p: &Progress| *last.lock().unwrap_or_else(PoisonError::into_inner) = p.node.to_string();
    std::thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let report = session.evaluate(&[], &Control { cancel: flag.clone(), on_progress: Some(&note) });
            (report.cancelled, Instant::now())
        });
        std::thread::sleep(wait);
        let node = last.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let told = Instant::now();
        flag.store(true, Ordering::Relaxed);
        let (cancelled, end) = worker.join().map_err(|_| "the evaluation panicked".to_owned())?;
        Ok(cancelled.then(|| (node, (end - told).as_secs_f64() * 1e3)))
    })
}
