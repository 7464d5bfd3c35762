//! How the chain of shell-256 grows: time and peak memory per panel at a thousand, ten thousand and a hundred thousand
//! panels, of everything but packing.

use super::figure::Figure;
use super::memory;
use super::shell::{Size, check_count, errors, evaluate, session, text};
use serde_json::{Value, json};
use std::collections::BTreeMap;
use std::process::{Command, Stdio};
use std::sync::Arc;
use std::time::Instant;
use tenon_engine::{Control, Registry, Report};

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

/// Panels of a round, whatever the size: a hundred small shells one after another, or one large one. So every size is
/// measured as long and as often, on a machine that others use as well.
const ROUND: u64 = 102_400;
/// Rounds that are measured.
const ROUNDS: u32 = 3;

/// What one shell took: milliseconds of each stage, of packing and of each node.
#[derive(Clone, Default)]
struct Times {
    ms: [f64; STAGES.len()],
    pack_ms: f64,
    nodes: BTreeMap<String, f64>,
}

impl Times {
    /// Takes of each the least of both.
    fn least(mut self, other: &Self) -> Self {
        self.ms.iter_mut().zip(other.ms).for_each(|(a, b)| *a = a.min(b));
        self.pack_ms = self.pack_ms.min(other.pack_ms);
        self.nodes.iter_mut().for_each(|(id, a)| *a = other.nodes.get(id).map_or(*a, |b| a.min(*b)));
        self
    }

    fn divide(&mut self, count: f64) {
        self.ms.iter_mut().chain([&mut self.pack_ms]).chain(self.nodes.values_mut()).for_each(|ms| *ms /= count);
    }
}

/// One size, in a process of its own: `{"ms": [by stage], "pack_ms", "nodes": {id: ms}, "bytes": [by stage]}`. Times are
/// the least of several rounds, of each the mean; memory is the peak of the first shell above the start: later ones reuse
/// its pages.
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
    let mut bytes = Vec::new();
    let (rounds, shells) =
        if args.get(1) == Some(&"memory") { (1, 1) } else { (ROUNDS, (ROUND / size.panels()).max(1)) };
    let mut best: Option<Times> = None;
    for _ in 0..rounds {
        let mut round = Times::default();
        for _ in 0..shells {
            one(&registry, &graph, *size, start, &mut round, &mut bytes)?;
        }
        round.divide(shells as f64);
        best = Some(best.map_or(round.clone(), |best| best.least(&round)));
    }
    let Times { ms, pack_ms, nodes } = best.unwrap_or_default();
    println!("{}", json!({ "ms": ms, "pack_ms": pack_ms, "nodes": nodes, "bytes": bytes }));
    Ok(())
}

/// One shell: what it takes is added to the round's; what it takes of memory, once.
fn one(
    registry: &Arc<Registry>,
    graph: &str,
    size: Size,
    start: Option<u64>,
    round: &mut Times,
    bytes: &mut Vec<Option<u64>>,
) -> Result<(), String> {
    let ms = |clock: Instant| clock.elapsed().as_secs_f64() * 1e3;
    let first = bytes.is_empty();
    let mut clock = Instant::now();
    let mut session = session(registry, graph)?;
    for (k, (.., target)) in STAGES.into_iter().enumerate() {
        if k == 1 {
            let packing = Instant::now();
            evaluate(&mut session, PACKED)?;
            round.pack_ms += ms(packing);
        }
        if k > 0 {
            if first {
                memory::forget_peak();
            }
            clock = Instant::now();
        }
        let report = match target {
            Some(target) => evaluate(&mut session, target)?,
            None => session.evaluate(&[], &Control::default()),
        };
        round.ms[k] += ms(clock);
        if first {
            bytes.push(memory::peak().zip(start).map(|(peak, start)| peak.saturating_sub(start)));
            tell_errors(&report, size);
        }
        for node in report.nodes.iter().filter(|n| !n.time.is_zero()) {
            *round.nodes.entry(node.id.to_string()).or_default() += node.time.as_secs_f64() * 1e3;
        }
    }
    check_count(&mut session, size)
}

fn tell_errors(report: &Report, size: Size) {
    let wrong = errors(report).count();
    if let Some(first) = errors(report).next() {
        eprintln!("{} panels: {wrong} errors, the first: {first}", size.panels());
    }
}
