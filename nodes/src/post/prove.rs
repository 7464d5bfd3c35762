//! From posted text to proof: reads every program back and proves what was read, never what was meant.

use super::parse::parse_program;
use super::words::Words;
use super::write::PostedProgram;
use rayon::prelude::*;
use tenon_geometry::board::{Layout, PartSet};
use tenon_geometry::machine::Machine;
use tenon_geometry::proof::{Program, ProofError, ProofParams, ProofReport, prove};

/// Reads the programs' text back (a text that is no program is a verdict, not an error) and proves them against parts,
/// layout and machine. O(bytes) and [`prove`]; the report is the same for any number of threads.
///
/// # Errors
/// Those of [`prove`].
pub fn prove_programs(
    programs: &[PostedProgram],
    machine: &Machine,
    parts: &PartSet,
    layout: &Layout,
    params: &ProofParams,
    progress: &(dyn Fn(f64) -> bool + Sync),
) -> Result<ProofReport, ProofError> {
    let read: Vec<Program> = programs
        .par_iter()
        .map(|p| {
            let (motions, refused) = match parse_program(p.text.as_bytes(), machine) {
                Ok(motions) => (motions, None),
                Err(e) => (Vec::new(), Some((e.line, e.problem))),
            };
            Program { name: p.file_name(), board: p.board, motions, refused }
        })
        .collect();
    prove(&read, machine, parts, layout, params, progress)
}

/// Writes into every program's head what the proof found of it: its figures, or that it failed.
pub fn stamp(programs: &mut [PostedProgram], words: &Words, report: &ProofReport) {
    for program in programs {
        let Some(verdict) = report.programs.iter().find(|v| v.board == program.board) else { continue };
        let parts = || report.parts.iter().flatten().filter(|p| p.board == program.board);
        let status = if verdict.passed {
            let gouge = parts().map(|p| p.gouge).fold(0.0, f64::max);
            let leftover = parts().map(|p| p.leftover).fold(0.0, f64::max);
            format!("proven, gouge {gouge:.4} mm, leftover {leftover:.4} mm at most")
        } else {
            let count = verdict.reasons.len() + verdict.omitted;
            format!("PROOF FAILED, {count} reason{}", if count == 1 { "" } else { "s" })
        };
        program.set_status(words, &status);
    }
}
