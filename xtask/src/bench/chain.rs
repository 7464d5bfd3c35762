//! The suite `chain`: shell-256 from the graph's text to posted programs and their proof, and the chain by size.

use super::figure::{Figure, median_ms};
use super::shell::{Size, check_count, errors, evaluate, session, text};
use super::{memory, surface};
use serde_json::{Value, json};
use std::process::{Command, Stdio};
use std::sync::Arc;
use tenon_engine::{Registry, Session};

/// Where the programs are.
const PROGRAMS: &str = "post.programs";
const PANELS: &str = "thicken.panels";
const PROOF: &str = "prove.report";
/// The node that is left out of figures "without packing".
const PACK: &str = "pack";
/// A coordinate of a control point of the rough curve, and how far it is moved in each round, mm.
const MOVED: &str = "fold_2.x";
const STEP: f64 = 0.013;

/// Rounds of figures that take milliseconds.
const ROUNDS: usize = 15;

type Case = fn() -> Result<(), String>;

/// The cases by name, in the order in which they run.
const CASES: [(&str, Case); 4] = [("cold", cold), ("moved", moved), ("size", by_size), ("surface", surface::run)];

/// Runs the named cases, or all; one that fails does not keep the others from running.
pub fn run(names: &[&str]) -> Result<(), String> {
    if let Some(unknown) = names.iter().find(|n| CASES.iter().all(|(case, _)| case != *n)) {
        return Err(format!("no case {unknown}: there are {}", CASES.map(|(name, _)| name).join(", ")));
    }
    let mut failed = Vec::new();
    for (name, case) in CASES {
        if (names.is_empty() || names.contains(&name))
            && let Err(why) = case()
        {
            failed.push(format!("{name}: {why}"));
        }
    }
    if failed.is_empty() { Ok(()) } else { Err(failed.join("\n")) }
}

fn figure(case: &'static str, ours: f64, target: f64) -> Figure {
    let size = Size::ALL[0].panels();
    Figure { suite: "chain", case, size, ours, unit: "ms", peer: None, theirs: None, target: Some(target) }
}

fn registry() -> Arc<Registry> {
    Arc::new(tenon_nodes::registry())
}

/// From text to programs, every round from nothing; then with the proof.
fn cold() -> Result<(), String> {
    let (registry, text) = (registry(), text(Size::ALL[0])?);
    let run = |target: &'static str, rounds| {
        // The session outlives the clock: dropping it is not part of the work.
        median_ms(
            rounds,
            |_| Ok(None),
            |kept: &mut Option<Session>| {
                let mut session = session(&registry, &text)?;
                evaluate(&mut session, target)?;
                *kept = Some(session);
                Ok(())
            },
        )
    };
    figure("cold", run(PROGRAMS, ROUNDS)?, 60.0).print();
    figure("proven", run(PROOF, 3)?, 10_000.0).print();
    Ok(())
}

/// After one control point has moved: to panels, then to programs. Every place is new, so that nothing is remembered.
fn moved() -> Result<(), String> {
    let (registry, text) = (registry(), text(Size::ALL[0])?);
    for (case, target, aim) in [("moved_panels", PANELS, 8.0), ("moved", PROGRAMS, 25.0)] {
        let mut session = session(&registry, &text)?;
        evaluate(&mut session, target)?;
        let from = session.document().nodes().get("fold_2").and_then(|n| n.params.get("x")?.as_f64());
        let from = from.ok_or_else(|| format!("{MOVED} is not set in the graph"))?;
        let mut rounds = 0;
        let ms = median_ms(
            ROUNDS,
            |_| Ok(()),
            |()| {
                rounds += 1;
                session.set(MOVED, json!(from + STEP * f64::from(rounds))).map_err(|d| d.to_string())?;
                evaluate(&mut session, target)
            },
        )?;
        figure(case, ms, aim).print();
    }
    Ok(())
}

/// Tells the allocator to hand back pages at once: the memory measured is then the chain's, not the allocator's reserve,
/// which at 256 panels is twice as much.
const LEAN: [(&str, &str); 3] =
    [("MIMALLOC_PURGE_DELAY", "0"), ("MIMALLOC_EAGER_COMMIT", "0"), ("MIMALLOC_ARENA_EAGER_COMMIT", "0")];

/// Time and memory per panel at three sizes, each in a process of its own.
fn by_size() -> Result<(), String> {
    let program = std::env::current_exe().map_err(|e| e.to_string())?;
    let mut first: Option<(f64, Option<f64>)> = None;
    for (index, size) in Size::ALL.into_iter().enumerate() {
        let measure = |environment: &[(&str, &str)], errors: Stdio| -> Result<Value, String> {
            let mut child = Command::new(&program);
            child.args(["bench-child", &index.to_string()]).envs(environment.iter().copied()).stderr(errors);
            let output = child.output().map_err(|e| e.to_string())?;
            serde_json::from_slice(&output.stdout)
                .map_err(|_| format!("the process for {} panels ended without a figure", size.panels()))
        };
        let measured = measure(&[], Stdio::inherit())?;
        let lean = measure(&LEAN, Stdio::null())?;
        let total = measured["ms"].as_f64().ok_or("no time was measured")?;
        let panels = size.panels() as f64;
        let (time, memory) = (1e3 * total / panels, lean["bytes"].as_f64().map(|b| b / panels / 1024.0));
        let peer = first.is_some().then(|| format!("ours at {}", Size::ALL[0].panels()));
        let figure = |case, ours, unit, theirs: Option<f64>, target| Figure {
            suite: "chain",
            case,
            size: size.panels(),
            ours,
            unit,
            peer: peer.clone().filter(|_| theirs.is_some()),
            theirs,
            target,
        };
        figure("chain_time", time, "µs/panel", first.map(|f| f.0), first.map(|_| 1.5)).print();
        if let Some(memory) = memory {
            let smallest = first.and_then(|f| f.1);
            figure("chain_memory", memory, "KiB/panel", smallest, smallest.map(|_| 1.5)).print();
        }
        let target = (index + 1 == Size::ALL.len()).then_some(1500.0);
        figure("chain_total", total, "ms", None, target).print();
        figure("chain_pack", measured["pack_ms"].as_f64().unwrap_or(f64::NAN), "ms", None, None).print();
        first = first.or(Some((time, memory)));
    }
    Ok(())
}

/// One size, in a process of its own: `{"ms": chain without packing, "pack_ms", "bytes": peak above the start}`.
pub fn child(args: &[&str]) -> Result<(), String> {
    let size = args.first().and_then(|a| Size::ALL.get(a.parse::<usize>().ok()?)).ok_or("which size?")?;
    let (registry, graph) = (registry(), text(*size)?);
    // What every process pays once (threads, the allocator's own pages) belongs to no panel.
    let least = text(Size::LEAST)?;
    for _ in 0..3 {
        evaluate(&mut session(&registry, &least)?, PROGRAMS)?;
    }
    let start = memory::peak();
    let mut times = Vec::new();
    let mut peak = None;
    let mut last = tenon_engine::Report::default();
    // About as many panels in all at every size, so that small ones are no rougher than large ones.
    for _ in 0..(40 * Size::ALL[0].panels() / size.panels()).max(5) {
        let clock = std::time::Instant::now();
        let mut session = session(&registry, &graph)?;
        let report = evaluate(&mut session, PROGRAMS)?;
        let all = clock.elapsed();
        // The peak of the first round: later ones reuse its memory.
        peak = peak.or_else(memory::peak);
        let pack = report.node(PACK).map(|n| n.time).unwrap_or_default();
        check_count(&mut session, *size)?;
        times.push((all.saturating_sub(pack), pack));
        last = report;
    }
    let wrong = errors(&last).count();
    if let Some(first) = errors(&last).next() {
        eprintln!("{} panels: {wrong} errors, the first: {first}", size.panels());
    }
    times.sort();
    let (chain, pack) = times[times.len() / 2];
    let bytes = peak.zip(start).map(|(peak, start)| peak.saturating_sub(start));
    println!("{}", json!({ "ms": chain.as_secs_f64() * 1e3, "pack_ms": pack.as_secs_f64() * 1e3, "bytes": bytes }));
    Ok(())
}
