//! How the chain of shell-256 grows: time and peak memory per panel at a thousand, ten thousand and a hundred thousand
//! panels, of everything but packing.

use super::figure::Figure;
use super::memory;
use super::shell::{Size, check_count, errors, evaluate, session, text};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tenon_engine::{Control, Report};

/// The most that a figure per panel may be of the same at the smallest size.
const MOST: f64 = 1.5;

/// The stages that are measured, packing between the first two: case of the time, case of the memory, what is evaluated.
/// No target means every output and every file.
const STAGES: [(&str, &str, Option<&str>); 4] = [
    ("paths_time", "paths_memory", Some("paths.paths")),
    ("post_time", "post_memory", Some("post.programs")),
    ("proof_time", "proof_memory", Some("prove.report")),
    ("files_time", "files_memory", None),
];
const PACKED: &str = "pack.layout";

/// Tells the allocator to hand back pages at once: the memory measured is then the chain's, not the allocator's reserve,
/// which at 256 panels is twice as much.
const LEAN: [(&str, &str); 3] =
    [("MIMALLOC_PURGE_DELAY", "0"), ("MIMALLOC_EAGER_COMMIT", "0"), ("MIMALLOC_ARENA_EAGER_COMMIT", "0")];

/// One size as its process has measured it: milliseconds and bytes by stage, milliseconds of packing and of each node.
struct Measured {
    panels: f64,
    ms: Vec<f64>,
    bytes: Vec<Option<f64>>,
    pack_ms: f64,
    nodes: BTreeMap<String, f64>,
}

/// Prints the figures of all sizes, each measured in processes of its own.
pub fn run() -> Result<(), String> {
    let mut smallest: Option<Measured> = None;
    for (index, size) in Size::GROWTH.into_iter().enumerate() {
        let now = measure(index, size)?;
        let peer = smallest.as_ref().map(|s| format!("ours at {}", s.panels));
        let figure = |case, ours, unit, theirs: Option<f64>, target| {
            let peer = peer.clone().filter(|_| theirs.is_some());
            Figure { suite: "chain", case, size: size.panels(), ours, unit, peer, theirs, target }.print();
        };
        let most = smallest.as_ref().map(|_| MOST);
        for (k, (time, memory, _)) in STAGES.into_iter().enumerate() {
            let of = |m: &Measured| 1e3 * m.ms[k] / m.panels;
            figure(time, of(&now), "µs/panel", smallest.as_ref().map(of), most);
            let of = |m: &Measured| m.bytes[k].map(|b| b / m.panels / 1024.0);
            if let Some(memory_now) = of(&now) {
                let theirs = smallest.as_ref().and_then(of);
                figure(memory, memory_now, "KiB/panel", theirs, theirs.and(most));
            }
        }
        let total = |m: &Measured| m.ms[..2].iter().sum::<f64>();
        let per_panel = |m: &Measured| 1e3 * total(m) / m.panels;
        figure("chain_time", per_panel(&now), "µs/panel", smallest.as_ref().map(per_panel), most);
        figure("chain_total", total(&now), "ms", None, (index == 1).then_some(1500.0));
        figure("chain_pack", now.pack_ms, "ms", None, None);
        if let Some(before) = &smallest {
            tell_growth(before, &now);
        }
        smallest = smallest.or(Some(now));
    }
    Ok(())
}

/// Says on stderr which nodes cost more per panel than they may, and enough to matter.
fn tell_growth(before: &Measured, now: &Measured) {
    for (id, ms) in now.nodes.iter().filter(|(id, _)| PACKED.split('.').next() != Some(id)) {
        let of = |m: &Measured, ms: f64| 1e3 * ms / m.panels;
        let (was, is) = (of(before, before.nodes.get(id).copied().unwrap_or(0.0)), of(now, *ms));
        if is > MOST * was && is > 1.0 {
            eprintln!("{} panels: {id} takes {is:.1} µs a panel; at {} panels {was:.1} µs", now.panels, before.panels);
        }
    }
}

/// Measures a size twice: time with the allocator as people run it, memory without its reserve.
fn measure(index: usize, size: Size) -> Result<Measured, String> {
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let child = |environment: &[(&str, &str)], errors: Stdio| -> Result<Value, String> {
        let mut child = Command::new(&program);
        let what = if environment.is_empty() { "time" } else { "memory" };
        child.args(["bench-child", &index.to_string(), what]).envs(environment.iter().copied()).stderr(errors);
        let output = child.output().map_err(|e| e.to_string())?;
        serde_json::from_slice(&output.stdout)
            .map_err(|_| format!("the process for {} panels ended without a figure", size.panels()))
    };
    let (time, memory) = (child(&[], Stdio::inherit())?, child(&LEAN, Stdio::null())?);
    let list = |v: &Value| v.as_array().map(|l| l.iter().map(Value::as_f64).collect::<Vec<_>>()).unwrap_or_default();
    let ms: Option<Vec<f64>> = list(&time["ms"]).into_iter().collect();
    let (ms, bytes) = (ms.unwrap_or_default(), list(&memory["bytes"]));
    if ms.len() != STAGES.len() || bytes.len() != STAGES.len() {
        return Err(format!("the process for {} panels measured something else", size.panels()));
    }
    let pack_ms = time["pack_ms"].as_f64().unwrap_or(f64::NAN);
    let nodes = serde_json::from_value(time["nodes"].clone()).unwrap_or_default();
    Ok(Measured { panels: size.panels() as f64, ms, bytes, pack_ms, nodes })
}

/// One size, in a process of its own: `{"ms": [by stage], "pack_ms", "nodes": {id: ms}, "bytes": [by stage]}`. Times are
/// the least of several rounds; memory is the peak of the first round above the start: later ones reuse its pages.
pub fn child(args: &[&str]) -> Result<(), String> {
    let size = args.first().and_then(|a| Size::GROWTH.get(a.parse::<usize>().ok()?)).ok_or("which size?")?;
    let registry = Arc::new(tenon_nodes::registry());
    let graph = text(*size)?;
    // What every process pays once (threads, the allocator's own pages) belongs to no panel.
    let least = text(Size::LEAST)?;
    for _ in 0..3 {
        evaluate(&mut session(&registry, &least)?, "prove.report")?;
    }
    memory::forget_peak();
    let start = memory::peak();
    let mut best = [Duration::MAX; STAGES.len()];
    let mut bytes = Vec::new();
    let mut pack = Duration::MAX;
    let mut nodes: BTreeMap<String, f64> = BTreeMap::new();
    let rounds = if args.get(1) == Some(&"memory") { 1 } else { (20_480 / size.panels()).clamp(3, 20) };
    for round in 0..rounds {
        let mut clock = Instant::now();
        let mut session = session(&registry, &graph)?;
        for (k, (.., target)) in STAGES.into_iter().enumerate() {
            if k == 1 {
                let packing = Instant::now();
                evaluate(&mut session, PACKED)?;
                pack = pack.min(packing.elapsed());
            }
            if k > 0 {
                memory::forget_peak();
                clock = Instant::now();
            }
            let report = match target {
                Some(target) => evaluate(&mut session, target)?,
                None => session.evaluate(&[], &Control::default()),
            };
            best[k] = best[k].min(clock.elapsed());
            if round == 0 {
                let peak = memory::peak().zip(start).map(|(peak, start)| peak.saturating_sub(start));
                bytes.push(peak);
                tell_errors(&report, *size);
            }
            for node in report.nodes.iter().filter(|n| !n.time.is_zero()) {
                let ms = node.time.as_secs_f64() * 1e3;
                let least = nodes.entry(node.id.to_string()).or_insert(ms);
                *least = least.min(ms);
            }
        }
        check_count(&mut session, *size)?;
    }
    let ms = best.map(|t| t.as_secs_f64() * 1e3);
    println!("{}", json!({ "ms": ms, "pack_ms": pack.as_secs_f64() * 1e3, "nodes": nodes, "bytes": bytes }));
    Ok(())
}

fn tell_errors(report: &Report, size: Size) {
    let wrong = errors(report).count();
    if let Some(first) = errors(report).next() {
        eprintln!("{} panels: {wrong} errors, the first: {first}", size.panels());
    }
}
