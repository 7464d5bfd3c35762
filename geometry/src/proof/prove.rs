//! The proof of a layout's programs: runs every program, gives its sweeps to the parts that they come near, judges each
//! part. Nothing of the tool paths is known here, only parsed text, machine, parts and layout.

use super::judge::{AROUND, Judge};
use super::motion::Program;
use super::report::{Fault, PartVerdict, ProgramVerdict, ProofParams, ProofReport, Reason};
use super::run::{Cut, Runner};
use super::sweep::Aabb;
use super::workpiece::Workpiece;
use crate::board::{Layout, PartSet, Placement};
use crate::joint::Feature;
use crate::machine::Machine;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Why there is no proof at all.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ProofError {
    /// The caller ended it.
    #[error("cancelled")]
    Cancelled,
    /// A placement of a part that the set does not have.
    #[error("the layout places part {part}, but there are {count} parts")]
    UnknownPart {
        /// Part index.
        part: u32,
        /// Number of parts.
        count: usize,
    },
    /// A program or placement on a board that the layout does not have.
    #[error("board {} is named, but the layout has {count}", board + 1)]
    UnknownBoard {
        /// Board number, from 0.
        board: u32,
        /// Number of boards.
        count: u32,
    },
    /// Two programs for one board.
    #[error("there are two programs for board {}", board + 1)]
    TwoPrograms {
        /// Board number, from 0.
        board: u32,
    },
    /// A tolerance that is none.
    #[error("proof parameter {name} must be more than 0, not {value}")]
    Parameter {
        /// Its name.
        name: &'static str,
        /// Its value, as text.
        value: String,
    },
}

/// What a board needs besides its program.
struct BoardWork<'a> {
    placements: Vec<&'a Placement>,
    program: Option<&'a Program>,
}

/// Proves programs against the parts of a layout. Boards and parts run in parallel; the report is the same for any
/// number of threads. O(motions + sweeps near parts · faces); `progress` is told the fraction done and returns false
/// to cancel.
///
/// # Errors
/// Cancelled, or a layout and programs that do not belong together. A program that fails is no error: it is a verdict.
pub fn prove(
    programs: &[Program],
    machine: &Machine,
    parts: &PartSet,
    layout: &Layout,
    params: &ProofParams,
    progress: &(dyn Fn(f64) -> bool + Sync),
) -> Result<ProofReport, ProofError> {
    for (name, value) in
        [("gouge", params.gouge), ("leftover", params.leftover), ("sample", params.sample), ("turn", params.turn)]
    {
        if !(value > 0.0 && value.is_finite()) {
            return Err(ProofError::Parameter { name, value: value.to_string() });
        }
    }
    let mut boards: Vec<BoardWork> =
        (0..layout.boards).map(|_| BoardWork { placements: Vec::new(), program: None }).collect();
    for placement in &layout.placements {
        if placement.part as usize >= parts.panels.len() {
            return Err(ProofError::UnknownPart { part: placement.part, count: parts.panels.len() });
        }
        let (board, count) = (placement.board, layout.boards);
        boards.get_mut(board as usize).ok_or(ProofError::UnknownBoard { board, count })?.placements.push(placement);
    }
    for program in programs {
        let (board, count) = (program.board, layout.boards);
        let work = boards.get_mut(board as usize).ok_or(ProofError::UnknownBoard { board, count })?;
        if work.program.replace(program).is_some() {
            return Err(ProofError::TwoPrograms { board });
        }
    }
    let features = features_by_part(parts);
    let total = programs.iter().map(|p| p.motions.len()).sum::<usize>() + PART_COST * layout.placements.len();
    let done = AtomicUsize::new(0);
    let advance = |by: usize| {
        let now = done.fetch_add(by, Ordering::Relaxed) + by;
        progress(now as f64 / total.max(1) as f64)
    };
    let verdicts: Option<Vec<(ProgramVerdict, Vec<PartVerdict>)>> = boards
        .into_par_iter()
        .enumerate()
        .map(|(board, work)| {
            let job = Job { machine, parts, layout, params, features: &features, advance: &advance };
            job.board(board as u32, &work)
        })
        .collect();
    let mut report = ProofReport { programs: Vec::new(), parts: vec![None; parts.panels.len()] };
    for (program, judged) in verdicts.ok_or(ProofError::Cancelled)? {
        report.programs.push(program);
        for part in judged {
            let index = part.part as usize;
            report.parts[index] = Some(part);
        }
    }
    // In the order given; boards without a program last.
    let mut place = vec![usize::MAX; layout.boards as usize];
    for (k, program) in programs.iter().enumerate() {
        if let Some(place) = place.get_mut(program.board as usize) {
            *place = k;
        }
    }
    report.programs.sort_by_key(|v| place.get(v.board as usize).copied().unwrap_or(usize::MAX));
    Ok(report)
}

/// What a part costs, in motions, for the fraction done.
const PART_COST: usize = 200;

/// Feature indices by part, in order.
fn features_by_part(parts: &PartSet) -> Vec<Vec<(u32, &Feature)>> {
    let mut by_part = vec![Vec::new(); parts.panels.len()];
    for (index, feature) in parts.features.features.iter().enumerate() {
        if let Some(list) = by_part.get_mut(feature.panel as usize) {
            list.push((index as u32, feature));
        }
    }
    by_part
}

struct Job<'a> {
    machine: &'a Machine,
    parts: &'a PartSet,
    layout: &'a Layout,
    params: &'a ProofParams,
    features: &'a [Vec<(u32, &'a Feature)>],
    advance: &'a (dyn Fn(usize) -> bool + Sync),
}

impl Job<'_> {
    /// Verdicts on one board; `None` if cancelled.
    fn board(&self, board: u32, work: &BoardWork) -> Option<(ProgramVerdict, Vec<PartVerdict>)> {
        let (layout, params) = (self.layout, self.params);
        if !(self.advance)(0) {
            return None;
        }
        let mut runner = Runner::new(self.machine, &layout.board, params);
        let mut reasons = Vec::new();
        let whole = |fault| Reason { line: None, part: None, at: None, by: 0.0, fault };
        match work.program {
            Some(program) => {
                if let Some((line, problem)) = &program.refused {
                    reasons.push(Reason { line: Some(*line), ..whole(Fault::Unreadable(problem.clone())) });
                }
                let counted = AtomicUsize::new(0);
                let go_on = |k: usize| (self.advance)(k - counted.swap(k, Ordering::Relaxed));
                if !runner.run(program, &go_on) {
                    return None;
                }
            }
            None if work.placements.is_empty() => {}
            None => reasons.push(whole(Fault::NoProgram)),
        }
        reasons.append(&mut runner.reasons);
        let pieces: Vec<Workpiece> = work
            .placements
            .par_iter()
            .filter(|_| (self.advance)(0))
            .filter_map(|p| Workpiece::new(self.parts, p, &self.features[p.part as usize]))
            .collect();
        if !(self.advance)(0) {
            return None;
        }
        let near = near_parts(&pieces, &runner.cuts);
        let stock = Aabb { min: glam::DVec3::ZERO, max: layout.board.size.extend(layout.board.thickness) };
        let judged: Option<Vec<(PartVerdict, Vec<Reason>)>> = pieces
            .par_iter()
            .zip(&near)
            .map(|(piece, near)| {
                if !(self.advance)(0) {
                    return None;
                }
                let cuts = near.iter().map(|k| &runner.cuts[*k as usize]).collect();
                let address = self.parts.panels.address.get(piece.part as usize).copied().unwrap_or_default();
                let judge = Judge { machine: self.machine, params, stock, piece, cuts, address };
                let verdict = judge.verdict(board);
                (self.advance)(PART_COST).then_some(verdict)
            })
            .collect();
        let judged = judged?;
        let mut verdicts = Vec::with_capacity(judged.len());
        let mut omitted = runner.omitted;
        for (verdict, mut why) in judged {
            verdicts.push(verdict);
            reasons.append(&mut why);
        }
        // The worst of every part matters more than the hundredth line: keep what is listed short from the front.
        if reasons.len() > params.most_reasons {
            let by_line = reasons.len() - params.most_reasons;
            omitted += by_line;
            let keep_front = params.most_reasons / 2;
            reasons.drain(keep_front..keep_front + by_line);
        }
        let verdict = ProgramVerdict {
            name: work.program.map_or_else(|| format!("board {}", board + 1), |p| p.name.clone()),
            board,
            passed: reasons.is_empty() && omitted == 0,
            motions: work.program.map_or(0, |p| p.motions.len()),
            reasons,
            omitted,
        };
        Some((verdict, verdicts))
    }
}

/// For every part the sweeps near it, in order, through a uniform grid over the board. O(parts + sweeps · cells met).
fn near_parts(pieces: &[Workpiece], cuts: &[Cut]) -> Vec<Vec<u32>> {
    let mut near = vec![Vec::new(); pieces.len()];
    let boxes: Vec<Aabb> = pieces.iter().map(|p| p.aabb.grown(AROUND)).collect();
    let bounds = boxes.iter().fold(Aabb::EMPTY, |a, b| Aabb { min: a.min.min(b.min), max: a.max.max(b.max) });
    let size = bounds.max - bounds.min;
    if !size.is_finite() || pieces.is_empty() {
        return near;
    }
    // About one part a cell.
    let cell = (size.x * size.y / pieces.len() as f64).sqrt().max(1.0);
    let (columns, rows) = ((size.x / cell) as usize + 1, (size.y / cell) as usize + 1);
    let span = |b: &Aabb| {
        let index = |x: f64, low: f64, n: usize| ((x - low) / cell).floor().clamp(0.0, (n - 1) as f64) as usize;
        let x = index(b.min.x, bounds.min.x, columns)..=index(b.max.x, bounds.min.x, columns);
        let y = index(b.min.y, bounds.min.y, rows)..=index(b.max.y, bounds.min.y, rows);
        (x, y)
    };
    let mut cells: Vec<Vec<u32>> = vec![Vec::new(); columns * rows];
    for (k, b) in boxes.iter().enumerate() {
        let (x, y) = span(b);
        for row in y {
            for column in x.clone() {
                cells[row * columns + column].push(k as u32);
            }
        }
    }
    let mut seen = vec![u32::MAX; pieces.len()];
    for (k, cut) in cuts.iter().enumerate() {
        if !cut.aabb.meets(&bounds) {
            continue;
        }
        let (x, y) = span(&cut.aabb);
        for row in y {
            for column in x.clone() {
                for &part in &cells[row * columns + column] {
                    let part = part as usize;
                    if seen[part] != k as u32 && cut.aabb.meets(&boxes[part]) {
                        seen[part] = k as u32;
                        near[part].push(k as u32);
                    }
                }
            }
        }
    }
    near
}
