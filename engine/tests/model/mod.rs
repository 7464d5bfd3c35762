//! The model test: sessions go through random edit scripts, and after each evaluation have to be what a session is that has
//! never seen anything but the document as it is then: values, digests, diagnostics, files. Every real call of a node is
//! counted, and no event and no report may claim less. A script that fails is shrunk and printed.
//!
//! `TENON_MODEL_STEPS` sets how many steps are taken (20,000), `TENON_MODEL_SEED` at which script to begin (0).

mod lane;
mod live;
mod oracle;
mod script;
mod world;

use lane::{Kind, Lane};
use script::{Step, script};
use std::fmt::Write;

/// Steps of one script.
const LENGTH: usize = 60;

const KINDS: [Kind; 4] = [
    Kind { threads: 1, cache_bytes: 1 << 30 },
    Kind { threads: 3, cache_bytes: 1 << 30 },
    Kind { threads: 1, cache_bytes: 0 },
    Kind { threads: 2, cache_bytes: 1500 },
];

/// What was compared, and what could not be.
#[derive(Default)]
struct Tally {
    compared: usize,
    skipped: usize,
    evicted: usize,
    cancelled: usize,
}

/// Takes a script through all lanes; says at which step and how it went wrong.
fn run(steps: &[Step], tally: &mut Tally) -> Result<(), String> {
    let mut lanes: Vec<Lane> = KINDS.into_iter().map(Lane::new).collect();
    let mut logs_agree = true;
    for (i, step) in steps.iter().enumerate() {
        let mut logs = Vec::new();
        for lane in &mut lanes {
            let log = lane.step(step).map_err(|e| format!("step {i}, {:?}: {e}", lane.kind))?;
            logs.push(log);
        }
        // What is remembered after a cancellation depends on what ran at the same time.
        logs_agree &= !matches!(step, Step::Cancel(..));
        if logs_agree && logs[0] != logs[1] {
            return Err(format!("step {i}: one thread logs\n  {:?}\nthree\n  {:?}", logs[0], logs[1]));
        }
    }
    for lane in &mut lanes {
        lane.finish().map_err(|e| format!("the end, {:?}: {e}", lane.kind))?;
        tally.compared += lane.compared;
        tally.skipped += lane.skipped;
        tally.evicted += lane.evicted;
        tally.cancelled += lane.cancelled;
    }
    Ok(())
}

/// Takes steps out as long as it still goes wrong; at most some hundred runs.
fn shrink(mut steps: Vec<Step>) -> (Vec<Step>, String) {
    let fails = |steps: &[Step]| {
        let run = std::panic::AssertUnwindSafe(|| run(steps, &mut Tally::default()));
        std::panic::catch_unwind(run).unwrap_or_else(|_| Err("it panics".into())).err()
    };
    let mut why = fails(&steps).unwrap_or_else(|| "it fails only sometimes".into());
    let mut size = steps.len() / 2;
    while size > 0 {
        let mut at = 0;
        while at < steps.len() {
            let mut fewer = steps.clone();
            fewer.drain(at..(at + size).min(steps.len()));
            match fails(&fewer) {
                Some(reason) => (steps, why) = (fewer, reason),
                None => at += size,
            }
        }
        size /= 2;
    }
    (steps, why)
}

fn number(name: &str, default: usize) -> usize {
    std::env::var(name).ok().and_then(|v| v.parse().ok()).unwrap_or(default)
}

#[test]
fn after_any_script_a_session_is_what_a_fresh_one_is() {
    let first = number("TENON_MODEL_SEED", 0);
    let scripts = number("TENON_MODEL_STEPS", 20_000).div_ceil(LENGTH);
    let mut tally = Tally::default();
    for seed in first..first + scripts {
        let steps = script(seed as i64, LENGTH);
        let run = std::panic::AssertUnwindSafe(|| run(&steps, &mut tally));
        let Ok(Ok(())) = std::panic::catch_unwind(run) else {
            let (steps, why) = shrink(steps);
            let mut words = format!("script {seed} goes wrong: {why}\n");
            for (i, step) in steps.iter().enumerate() {
                let _ = writeln!(words, "{i:3} {step:?}");
            }
            panic!("{words}");
        };
    }
    println!("{scripts} scripts, {} evaluations compared, {} not", tally.compared, tally.skipped);
    assert!(tally.compared > 40 * scripts && tally.skipped * 20 < tally.compared, "too little was compared");
    println!("{} results dropped, {} evaluations cancelled", tally.evicted, tally.cancelled);
    assert!(tally.evicted > scripts && 4 * tally.cancelled > scripts, "too little was dropped or cancelled");
}

#[test]
fn whatever_is_edited_while_it_runs_the_last_snapshot_is_what_a_fresh_session_comes_to() {
    let first = number("TENON_MODEL_SEED", 0);
    // It waits for other threads most of the time.
    let scripts = number("TENON_MODEL_STEPS", 20_000).div_ceil(4 * LENGTH);
    let mut compared = 0;
    for seed in first..first + scripts {
        let steps = script(seed as i64, LENGTH);
        match live::run(&steps, seed as i64) {
            Ok(more) => compared += more,
            Err(why) => {
                let steps: Vec<String> = steps.iter().enumerate().map(|(i, s)| format!("{i:3} {s:?}")).collect();
                panic!("script {seed} goes wrong: {why}\n{}", steps.join("\n"));
            }
        }
    }
    assert!(compared > 5 * scripts, "too little was compared: {compared} in {scripts} scripts");
}
