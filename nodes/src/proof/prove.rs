//! `prove`: programs read back and judged.

use crate::post::MachineFile;
use crate::value::{Program, Standing, V};
use rayon::prelude::*;
use std::collections::HashMap;
use std::sync::Arc;
use tenon_engine::{Call, Fail, NodeType, Port, Unit, stop};
use tenon_geometry::board::{Layout, PartSet};
use tenon_geometry::proof::{self, ProgramVerdict, ProofError, ProofParams, ProofReport, prove};

pub(super) fn node() -> NodeType {
    let d = ProofParams::default();
    let length = |name: &'static str, default: f64, doc: &'static str| {
        Port::item::<f64>(name).unit(Unit::Length).range(1e-6, 1e3).default(default).doc(doc)
    };
    NodeType::new("prove", 1)
        .name("Prove")
        .category("Machine")
        .doc(
            "Reads the posted text back, runs it through the machine's kinematics and sweeps cutter, shank, holder and \
             spindle through stock, parts, clamps and table. Passes a program only if nothing is touched that must not be \
             and nothing is left standing on a designed face.",
        )
        .keywords(&["verify", "simulate", "collision", "gouge", "check"])
        .slow()
        .input(Port::list::<Program>("programs").doc("Programs from post."))
        .input(Port::item::<V<PartSet>>("parts").doc("The parts that the programs must make."))
        .input(Port::item::<V<Layout>>("layout").doc("Where they lie."))
        .input(Port::item::<V<MachineFile>>("machine").doc("The machine that runs them."))
        .input(length("gouge", d.gouge, "Deepest that a cutter may go into a part."))
        .input(length("leftover", d.leftover, "Most stock that may stand on a designed face."))
        .input(length("sample", d.sample, "Spacing of sample points on faces that no single cut clears."))
        .output(Port::list::<Program>("programs").doc("The programs with their verdict; only those that passed may be called final."))
        .output(Port::item::<V<ProofReport>>("report").doc("Verdicts per program and per part."))
        .output(Port::item::<bool>("passed").doc("Whether every program passed."))
        .run(run)
}

fn run(c: &mut Call) -> Result<(), Fail> {
    let programs = c.list::<Program>("programs")?;
    let machine = c.item::<V<MachineFile>>("machine")?;
    let params = ProofParams {
        gouge: c.number("gouge")?,
        leftover: c.number("leftover")?,
        sample: c.number("sample")?,
        ..ProofParams::default()
    };
    let monitor = c.monitor();
    let read = |p: &Program| (!monitor.cancelled()).then(|| p.posted.read(&machine.machine));
    let read: Option<Vec<proof::Program>> = programs.par_iter().map(read).collect();
    let read = read.ok_or_else(Fail::cancelled)?;
    let (parts, layout) = (c.item::<V<PartSet>>("parts")?, c.item::<V<Layout>>("layout")?);
    let report =
        prove(&read, &machine.machine, parts, layout, &params, &|f| monitor.progress(f)).map_err(|e| proof_fail(&e))?;
    for verdict in report.programs.iter().filter(|v| !v.passed) {
        c.report(Fail::new("proof-failed", format!("{}: {}", verdict.name, why(verdict))).port("programs"));
    }
    let worst = worst_by_board(&report);
    let both = programs.iter().zip(&report.programs).inspect(|_| stop::check());
    let judged = both.map(|(p, v)| judged(p, v, &worst, machine)).collect();
    c.set_list("programs", judged);
    c.set("passed", report.passed());
    c.set("report", V::new(report));
    Ok(())
}

/// The first reason, and how many more there are.
fn why(verdict: &ProgramVerdict) -> String {
    let more = verdict.reasons.len() + verdict.omitted;
    match verdict.reasons.first() {
        Some(first) if more > 1 => format!("{first} (and {} more reasons)", more - 1),
        Some(first) => first.to_string(),
        None => "no reason given".into(),
    }
}

/// The largest gouge and the largest leftover on each board, mm. O(parts).
fn worst_by_board(report: &ProofReport) -> HashMap<u32, [f64; 2]> {
    let mut worst: HashMap<u32, [f64; 2]> = HashMap::new();
    for part in report.parts.iter().flatten() {
        let [gouge, leftover] = worst.entry(part.board).or_default();
        *gouge = gouge.max(part.gouge);
        *leftover = leftover.max(part.leftover);
    }
    worst
}

/// The program with its verdict in its header.
fn judged(
    program: &Program,
    verdict: &ProgramVerdict,
    worst: &HashMap<u32, [f64; 2]>,
    machine: &MachineFile,
) -> Program {
    let mut posted = (*program.posted).clone();
    let standing = if verdict.passed {
        let [gouge, leftover] = worst.get(&verdict.board).copied().unwrap_or_default();
        posted.set_status(
            &machine.words,
            &format!("proven, largest gouge {gouge:.4} mm, largest leftover {leftover:.4} mm"),
        );
        Standing::Passed
    } else {
        let why = why(verdict);
        posted.set_status(&machine.words, &format!("UNPROVEN, the proof failed: {why}"));
        Standing::Failed(why.into())
    };
    Program { posted: Arc::new(posted), standing }
}

fn proof_fail(error: &ProofError) -> Fail {
    match error {
        ProofError::Cancelled => Fail::cancelled(),
        ProofError::Parameter { name, .. } => Fail::new("out-of-range", error.to_string()).port(*name),
        _ => Fail::new("layout-of-other-parts", error.to_string()).port("layout"),
    }
}
