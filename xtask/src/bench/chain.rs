//! The suite `chain`: shell-256 from the graph's text to posted programs and their proof, and the chain by size.

use super::figure::{Figure, median_ms};
use super::shell::{Size, evaluate, session, text};
use super::{growth, surface};
use serde_json::json;
use std::sync::Arc;
use tenon_engine::{Registry, Session};

/// Where the programs are.
const PROGRAMS: &str = "post.programs";
const PANELS: &str = "thicken.panels";
const PROOF: &str = "prove.report";
/// A coordinate of a control point of the rough curve, and how far it is moved in each round, mm.
const MOVED: &str = "fold_2.x";
const STEP: f64 = 0.013;

/// Rounds of figures that take milliseconds.
const ROUNDS: usize = 15;

type Case = fn() -> Result<(), String>;

/// The cases by name, in the order in which they run.
const CASES: [(&str, Case); 4] = [("cold", cold), ("moved", moved), ("size", growth::run), ("surface", surface::run)];

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
    let size = Size::STANDS.panels();
    Figure { suite: "chain", case, size, ours, unit: "ms", peer: None, theirs: None, target: Some(target) }
}

fn registry() -> Arc<Registry> {
    Arc::new(tenon_nodes::registry())
}

/// From text to programs, every round from nothing; then with the proof.
fn cold() -> Result<(), String> {
    let (registry, text) = (registry(), text(Size::STANDS)?);
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
    let (registry, text) = (registry(), text(Size::STANDS)?);
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
