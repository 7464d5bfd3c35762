//! `tenon sweep run`: every row of a plan that has no result yet, several at once, with one bar for all.

use super::plan;
use crate::args::SweepRunArgs;
use crate::progress::Bar;
use crate::words::{Voice, Wrong, print, print_json};
use crate::{End, cache, interrupt, output};
use std::num::NonZero;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use tenon_engine::{Control, Diagnostic, Json, Progress};
use tenon_nodes::host::sweep::{Bench, Found, Inputs, Lock, Planned, damage, finished, found};

/// One line per row of the plan, in its order.
const TABLE: &str = "results.jsonl";

/// Evaluates what is not finished. Killed at any moment, the next call goes on where this one was.
pub fn run(args: &SweepRunArgs) -> Result<End, Wrong> {
    let rows = plan::read(&args.plan)?;
    output::prepare_folder(&args.out)?;
    let _lock = Lock::alone(&args.out)?;
    let mut inputs = Inputs::default();
    let (mut pending, mut damaged): (Vec<&Planned>, usize) = (Vec::new(), 0);
    for row in &rows {
        match found(&args.out, row, &mut inputs) {
            Found::Finished(_) => continue,
            Found::Damaged(file) => {
                damaged += 1;
                Voice::new().say(&damage(row, &file));
            }
            Found::Nothing | Found::Outdated => {}
        }
        pending.push(row);
    }
    let before = rows.len() - pending.len();
    let cancel = interrupt::flag();
    let bar = Bar::new(args.json);
    let evaluated = evaluate(args, &pending, before, &cancel, &bar);
    bar.clear();
    let (evaluated, told) = evaluated?;
    let voice = Voice::new();
    voice.diagnostics(&told);
    if cancel.load(Ordering::SeqCst) {
        let done = before + evaluated;
        voice.say(&format!("interrupted: {done} of {} rows are finished; the same call goes on from here", rows.len()));
        return Ok(End::Interrupted);
    }

    let mut table = String::new();
    let mut faulty = 0;
    let mut inputs = Inputs::default();
    for row in &rows {
        // Gone again since: somebody has cleared the folder, or changed a file that the graph reads.
        let result = finished(&args.out, row, &mut inputs).unwrap_or(Json::Null);
        if result["ok"] != Json::Bool(true) {
            faulty += 1;
            voice.say(&fault(row, &result));
        }
        let line = serde_json::json!({ "key": row.row.key, "set": row.row.set, "ok": result["ok"], "values": result["values"] });
        table.push_str(&format!("{line}\n"));
    }
    output::write_whole(&args.out.join(TABLE), table.as_bytes())?;
    if args.json {
        print_json(&serde_json::json!({
            "ok": faulty == 0,
            "rows": rows.len(),
            "finished_before": before,
            "evaluated": evaluated,
            "damaged": damaged,
            "with_errors": faulty,
            "out": args.out.display().to_string(),
        }))?;
    } else {
        let table = args.out.join(TABLE);
        let rows = rows.len();
        print(&format!(
            "{rows} rows: {evaluated} evaluated, {before} finished before, {faulty} with errors\nwrote {}\n",
            table.display()
        ))?;
    }
    Ok(if faulty == 0 { End::Done } else { End::Errors })
}

/// Why a row is not well, in one line.
fn fault(planned: &Planned, result: &Json) -> String {
    let row = &planned.row;
    let set: Vec<String> = row.set.iter().map(|(name, value)| format!("{name}={value}")).collect();
    let diagnostics = result["diagnostics"].as_array().map_or(&[][..], Vec::as_slice);
    let mut errors = diagnostics.iter().filter(|d| d["severity"] == "error");
    let first = errors.next().and_then(|d| d["message"].as_str()).unwrap_or("its result has gone");
    let more = errors.count();
    let more = if more > 0 { format!(" (and {more} more)") } else { String::new() };
    format!("{} {}: {first}{more}", row.key, set.join(" "))
}

/// Evaluates the rows in order, `jobs` at a time, and says how many, and what went wrong with the cache.
fn evaluate(
    args: &SweepRunArgs,
    rows: &[&Planned],
    before: usize,
    cancel: &Arc<AtomicBool>,
    bar: &Bar,
) -> Result<(usize, Vec<Diagnostic>), Wrong> {
    let jobs = usize::from(args.jobs).min(rows.len());
    let threads = std::thread::available_parallelism().map_or(1, NonZero::get) / jobs.max(1);
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let first_fault = Mutex::new(None);
    let store = cache::store(&args.cache);
    let told: Mutex<Vec<Diagnostic>> = Mutex::default();
    let total = (before + rows.len()) as f64;
    let plugins = crate::plugins::sources()?;
    let work = || {
        let mut bench = Bench::new(plugins.clone(), threads.max(1), crate::run::CACHE / jobs, store.clone());
        while !cancel.load(Ordering::Relaxed) {
            if first_fault.lock().unwrap_or_else(PoisonError::into_inner).is_some() {
                return;
            }
            let Some(row) = rows.get(next.fetch_add(1, Ordering::Relaxed)) else { return };
            let show = |p: &Progress| {
                let so_far = before + done.load(Ordering::Relaxed);
                // With several rows at once, only whole ones count: their fractions would make the bar jump.
                let part = if jobs == 1 { p.fraction } else { 0.0 };
                bar.show((so_far as f64 + part) / total, &format!("{so_far}/{total} {}", p.node));
            };
            let control = Control { cancel: cancel.clone(), on_progress: Some(&show) };
            match bench.evaluate(row, &control, &args.out) {
                Ok(Some(made)) => {
                    let mut told = told.lock().unwrap_or_else(PoisonError::into_inner);
                    // A folder that cannot be used is the same in every row.
                    told.extend(made.cache);
                    told.dedup();
                    done.fetch_add(1, Ordering::Relaxed);
                }
                Ok(None) => return,
                Err(wrong) => {
                    first_fault.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(wrong);
                    return;
                }
            }
        }
    };
    std::thread::scope(|scope| {
        for _ in 0..jobs {
            scope.spawn(work);
        }
    });
    match first_fault.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(wrong) => Err(wrong.into()),
        None => Ok((done.into_inner(), told.into_inner().unwrap_or_else(PoisonError::into_inner))),
    }
}
