//! Tool paths of whole boards, in two steps: every part in its own frame (which also tells the packer what it clears),
//! then every part in its place on its board.

use super::body::Envelope;
use super::contour;
use super::drill::{Hole, drill};
use super::engrave::{Text, engrave};
use super::path::{MoveKind, Operation, Purpose, ToolPaths};
use super::reach::{PathError, PathIssue, PathParams, Place, Reach};
use super::trace::Trace;
use crate::board::{Layout, PartSet, facets};
use crate::joint::{Feature, Machining};
use crate::machine::{Machine, ToolKind};
use bytemuck::allocation::zeroed_vec;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Tool paths of every part in its part frame (all on board 0), one part after the other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PartPaths {
    /// Operations and moves; a part's operations are ordered by purpose, then tool.
    pub paths: ToolPaths,
    /// First operation of each part; one entry more than there are parts.
    pub operation_start: Vec<u32>,
    /// Whether the part cannot be cut out and was left out as a whole.
    pub failed: Vec<bool>,
    /// What cannot be made, by part.
    pub issues: Vec<PathIssue>,
    /// Distance kept above the board by approaches, holder and spindle, mm ([`PathParams::clearance`]).
    pub clearance: f64,
}

impl PartPaths {
    /// Operations of part `i`.
    #[must_use]
    pub fn of_part(&self, i: usize) -> &[Operation] {
        match (self.operation_start.get(i), self.operation_start.get(i + 1)) {
            (Some(&a), Some(&b)) => &self.paths.operations[a as usize..b as usize],
            _ => &[],
        }
    }

    /// Features that the machine does not make although their part is cut: what is left to the hand
    /// ([`PartSet::leave_to_hand`]).
    pub fn unmade_features(&self) -> impl Iterator<Item = u32> {
        self.issues.iter().filter_map(|i| match i.place {
            Place::Feature(k) => Some(k),
            Place::Facet(_) | Place::Board(_) => None,
        })
    }
}

/// Tool paths of every part in its part frame: fixing holes, engraving, drilling, contour. A part that cannot be cut
/// out gets no paths, a feature that cannot be made is left out; both are named in [`PartPaths::issues`]. Parts run in
/// parallel. O(features · tools + passes).
///
/// # Errors
/// A parameter out of range, a machine without end mill or with a safe height inside the board, cancellation.
pub fn cut_parts(
    parts: &PartSet,
    machine: &Machine,
    params: &PathParams,
    progress: &(dyn Fn(f64) -> bool + Sync),
) -> Result<PartPaths, PathError> {
    let top = parts.panels.thickness;
    params.check(machine, top)?;
    let tools: Vec<Reach> = machine
        .tools
        .iter()
        .enumerate()
        .map(|(index, tool)| {
            let body = Envelope::new(machine, tool);
            Reach { machine, tool, index: index as u32, body, top, clearance: params.clearance }
        })
        .collect();
    let mill = end_mill(&tools, params)?;
    let n = parts.panels.len();
    let own = features_by_part(parts);
    let (done, cancelled) = (AtomicUsize::new(0), AtomicBool::new(false));
    let single: Vec<(Trace, Vec<PathIssue>, bool)> = (0..n)
        .into_par_iter()
        .map(|i| {
            let count = done.fetch_add(1, Ordering::Relaxed);
            // A callback per part would cost more than the part.
            if count.is_multiple_of(64) && !progress(count as f64 / n as f64) {
                cancelled.store(true, Ordering::Relaxed);
            }
            if cancelled.load(Ordering::Relaxed) || !parts.panels.is_valid(i) {
                return (Trace::default(), Vec::new(), false);
            }
            cut_part(parts, i, &own[i], &tools, mill, params)
        })
        .collect();
    if cancelled.into_inner() {
        return Err(PathError::Cancelled);
    }
    let mut all = PartPaths { operation_start: vec![0], clearance: params.clearance, ..PartPaths::default() };
    let (mut traces, mut operations) = (Vec::with_capacity(n), 0);
    for (trace, issues, failed) in single {
        operations += trace.paths.operations.len() as u32;
        all.operation_start.push(operations);
        all.issues.extend(issues);
        all.failed.push(failed);
        traces.push(trace.paths);
    }
    all.paths = join(traces, &|| progress(1.0)).ok_or(PathError::Cancelled)?;
    Ok(all)
}

/// Puts moves one after another, on all threads: they are much more than a cache holds. None if `go` says no.
fn join(parts: Vec<ToolPaths>, go: &(dyn Fn() -> bool + Sync)) -> Option<ToolPaths> {
    let moves = parts.iter().map(|p| p.tip.len()).sum();
    let mut all = ToolPaths {
        operations: Vec::with_capacity(parts.iter().map(|p| p.operations.len()).sum()),
        kind: vec![MoveKind::Rapid; moves],
        tip: zeroed_vec(moves),
        axis: zeroed_vec(moves),
        feed: zeroed_vec(moves),
    };
    let (mut kind, mut tip, mut axis, mut feed) =
        (&mut all.kind[..], &mut all.tip[..], &mut all.axis[..], &mut all.feed[..]);
    let (mut rooms, mut shift) = (Vec::with_capacity(parts.len()), 0);
    for part in &parts {
        let count = part.tip.len();
        let moved = |op: &Operation| Operation { moves: op.moves.start + shift..op.moves.end + shift, ..op.clone() };
        all.operations.extend(part.operations.iter().map(moved));
        rooms.push((cut(&mut kind, count), cut(&mut tip, count), cut(&mut axis, count), cut(&mut feed, count)));
        shift += count as u32;
    }
    let stopped = AtomicBool::new(false);
    rooms.into_par_iter().zip(parts).enumerate().for_each(|(i, ((kind, tip, axis, feed), part))| {
        if i.is_multiple_of(64) && !go() {
            stopped.store(true, Ordering::Relaxed);
        }
        if !stopped.load(Ordering::Relaxed) {
            kind.copy_from_slice(&part.kind);
            tip.copy_from_slice(&part.tip);
            axis.copy_from_slice(&part.axis);
            feed.copy_from_slice(&part.feed);
        }
    });
    (!stopped.into_inner()).then_some(all)
}

/// Takes the first items off a slice.
fn cut<'a, T>(slice: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    let (first, rest) = std::mem::take(slice).split_at_mut(count);
    *slice = rest;
    first
}

/// Indices of the machine's features per part.
fn features_by_part(parts: &PartSet) -> Vec<Vec<u32>> {
    let mut own = vec![Vec::new(); parts.panels.len()];
    for (k, f) in parts.features.features.iter().enumerate() {
        if let Some(list) = own.get_mut(f.panel as usize) {
            list.push(k as u32);
        }
    }
    own
}

/// The contour tool.
fn end_mill<'a, 'b>(tools: &'b [Reach<'a>], params: &PathParams) -> Result<&'b Reach<'a>, PathError> {
    let mills = || tools.iter().filter(|t| t.tool.kind == ToolKind::EndMill);
    let found = match params.contour_tool {
        Some(number) => mills().find(|t| t.tool.number == number),
        // The first of the widest.
        None => mills().fold(None, |best: Option<&Reach>, t| match best {
            Some(b) if b.tool.diameter >= t.tool.diameter => Some(b),
            _ => Some(t),
        }),
    };
    found.ok_or_else(|| PathError::NoTool {
        wanted: params.contour_tool.map_or("end mill".into(), |n| format!("end mill T{n}")),
        available: list(mills()),
    })
}

/// Tools for people.
fn list<'a, 'b: 'a>(tools: impl Iterator<Item = &'a Reach<'b>>) -> String {
    let names: Vec<String> = tools.map(|t| format!("T{} Ø{}", t.tool.number, t.tool.diameter)).collect();
    if names.is_empty() { "none".into() } else { names.join(", ") }
}

/// One part: all its operations, its issues and whether it failed as a whole.
fn cut_part(
    parts: &PartSet,
    i: usize,
    features: &[u32],
    tools: &[Reach],
    mill: &Reach,
    params: &PathParams,
) -> (Trace, Vec<PathIssue>, bool) {
    let part = i as u32;
    let mut issues = Vec::new();
    let mut out = Trace::default();
    // (purpose, tool, feature) sorts the features into machining order; tools are chosen by trying them.
    let mut made: Vec<(Purpose, u32, u32, Range<u32>)> = Vec::new();
    let mut draft = Trace::default();
    for &k in features {
        let from = draft.len();
        match make_feature(&parts.features.features[k as usize], tools, params, &mut draft) {
            Ok((purpose, tool)) => made.push((purpose, tool, k, from..draft.len())),
            Err(error) => {
                draft.truncate(from);
                issues.push(PathIssue { part, place: Place::Feature(k), error });
            }
        }
    }
    made.sort_by_key(|(purpose, tool, k, _)| (*purpose, *tool, *k));
    for (purpose, tool, _, moves) in made {
        let from = out.len();
        for m in moves.start as usize..moves.end as usize {
            out.axis = draft.paths.axis[m];
            out.go(draft.paths.kind[m], draft.paths.tip[m], draft.paths.feed[m]);
        }
        out.close(from, purpose, part, tool);
    }
    // Clockwise around the part, beginning with the first edge, so that each cut starts near the last one's end.
    let mut around = facets(&parts.panels, i);
    let heading = |n: glam::DVec3| n.y.atan2(n.x);
    let first = around.first().map_or(0.0, |f| heading(f.plane.normal));
    let after = |n: glam::DVec3| (first - heading(n)).rem_euclid(std::f64::consts::TAU);
    if let Some(rest) = around.get_mut(1..) {
        rest.sort_by(|a, b| after(a.plane.normal).total_cmp(&after(b.plane.normal)));
    }
    let mut failed = false;
    for facet in &around {
        let from = out.len();
        match contour::cut(mill, params, facet, &mut out) {
            Ok(()) => out.close(from, Purpose::Contour, part, mill.index),
            Err(error) => {
                failed = true;
                issues.push(PathIssue { part, place: Place::Facet(facet.name), error });
            }
        }
    }
    if failed {
        out = Trace::default();
    }
    (out, issues, failed)
}

/// Makes a feature with the first tool of the right kind and size that reaches it.
fn make_feature(
    feature: &Feature,
    tools: &[Reach],
    params: &PathParams,
    out: &mut Trace,
) -> Result<(Purpose, u32), PathError> {
    let from = out.len();
    let mut try_tools = |wanted: &dyn Fn(&Reach) -> bool,
                         named: &dyn Fn() -> (String, String),
                         make: &dyn Fn(&Reach, &mut Trace) -> Result<(), PathError>| {
        let mut last = None;
        for reach in tools.iter().filter(|t| wanted(t)) {
            match make(reach, out) {
                Ok(()) => return Ok(reach.index),
                Err(error) => {
                    out.truncate(from);
                    last = Some(error);
                }
            }
        }
        Err(last.unwrap_or_else(|| {
            let (wanted, available) = named();
            PathError::NoTool { wanted, available }
        }))
    };
    let no_operation = |what: &'static str| Err(PathError::NoOperation { what: what.into() });
    match &feature.machining {
        Machining::Drill { entry, axis, depth, diameter } => {
            let hole = Hole { entry: *entry, axis: *axis, depth: *depth };
            let is_drill = |t: &Reach| matches!(t.tool.kind, ToolKind::Drill { .. });
            let tool = try_tools(
                // Diameters are typed by people; a nanometre apart is the same number.
                &|t| is_drill(t) && (t.tool.diameter - diameter).abs() < 1e-6,
                &|| (format!("drill of Ø{diameter}"), list(tools.iter().filter(|t| is_drill(t)))),
                &|t, out| drill(t, params, &hole, out),
            )?;
            Ok((if feature.purpose == "fixing" { Purpose::Fixing } else { Purpose::Drilling }, tool))
        }
        Machining::Engraving { origin, along, axis, height, depth, text } => {
            let text = Text { origin: *origin, along: *along, axis: *axis, height: *height, depth: *depth, text };
            let tool = try_tools(
                &|t| matches!(t.tool.kind, ToolKind::Engraver { .. }),
                &|| ("engraving tool".into(), list(tools.iter())),
                &|t, out| engrave(t, params, &text, out),
            )?;
            Ok((Purpose::Engraving, tool))
        }
        Machining::Slot { .. } => no_operation("slot"),
        Machining::Pocket { .. } => no_operation("pocket"),
        Machining::Contour { .. } => no_operation("contour along a line"),
    }
}

/// Puts the paths of all placed parts on their boards and hands each board's to `work`, ordered by purpose, tool, then the
/// layout's order, all on that board; gives what `work` made, by board. A part whose moves leave the travel of X or Y is left
/// out and named, a board without operations has no work. Boards run in parallel, each in memory that the next one takes
/// over: no moves of all boards ever stand beside those of the parts. O(p log p + moves).
/// Stops early when `go` says no, and what there is then is of no use.
pub fn place_boards<R: Send>(
    paths: &PartPaths,
    layout: &Layout,
    machine: &Machine,
    go: &(dyn Fn() -> bool + Sync),
    work: &(dyn Fn(&ToolPaths) -> R + Sync),
) -> (Vec<R>, Vec<PathIssue>) {
    let mut ranks: Vec<u32> = (0..layout.placements.len() as u32).collect();
    ranks.sort_by_key(|rank| layout.placements[*rank as usize].board);
    let same = |a: &u32, b: &u32| layout.placements[*a as usize].board == layout.placements[*b as usize].board;
    let boards: Vec<&[u32]> = ranks.chunk_by(same).collect();
    let done: Vec<Board<R>> = boards
        .into_par_iter()
        .map_init(ToolPaths::default, |placed, ranks| {
            let issues = place_board(paths, layout, machine, ranks, placed, go);
            ((!placed.operations.is_empty() && go()).then(|| work(placed)), issues)
        })
        .collect();
    let (made, issues): (Vec<_>, Vec<_>) = done.into_iter().unzip();
    let mut issues: Vec<(u32, PathIssue)> = issues.into_iter().flatten().collect();
    issues.sort_by_key(|(rank, _)| *rank);
    (made.into_iter().flatten().collect(), issues.into_iter().map(|(_, issue)| issue).collect())
}

/// What was made of one board, and what of its parts is out of reach, by rank.
type Board<R> = (Option<R>, Vec<(u32, PathIssue)>);

/// Places the parts of one board, the placements `ranks`, in `out`, which it empties first; gives what is out of reach.
fn place_board(
    paths: &PartPaths,
    layout: &Layout,
    machine: &Machine,
    ranks: &[u32],
    out: &mut ToolPaths,
    go: &(dyn Fn() -> bool + Sync),
) -> Vec<(u32, PathIssue)> {
    out.operations.clear();
    out.kind.clear();
    out.tip.clear();
    out.axis.clear();
    out.feed.clear();
    let (mut issues, mut order) = (Vec::new(), Vec::new());
    for &rank in ranks.iter().take_while(|_| go()) {
        let place = &layout.placements[rank as usize];
        let ops = paths.of_part(place.part as usize);
        let moves = ops.first().map_or(0, |o| o.moves.start as usize)..ops.last().map_or(0, |o| o.moves.end as usize);
        let out_of_reach = paths.paths.tip[moves].iter().find_map(|p| {
            let p = place.point(*p);
            [p.x, p.y].into_iter().zip(&machine.linear).find(|(at, axis)| !(axis.min..=axis.max).contains(at))
        });
        if let Some((at, axis)) = out_of_reach {
            let error = PathError::Travel { letter: axis.letter, at, min: axis.min, max: axis.max };
            issues.push((rank, PathIssue { part: place.part, place: Place::Board(place.board), error }));
            continue;
        }
        order.extend(ops.iter().map(|op| (op.purpose, op.tool, rank, op)));
    }
    order.sort_by_key(|(purpose, tool, rank, _)| (*purpose, *tool, *rank));
    for (.., rank, op) in order.into_iter().take_while(|_| go()) {
        let place = &layout.placements[rank as usize];
        let from = out.tip.len() as u32;
        let moves = op.moves.start as usize..op.moves.end as usize;
        out.kind.extend_from_slice(&paths.paths.kind[moves.clone()]);
        out.feed.extend_from_slice(&paths.paths.feed[moves.clone()]);
        out.tip.extend(paths.paths.tip[moves.clone()].iter().map(|p| place.point(*p)));
        out.axis.extend(paths.paths.axis[moves].iter().map(|v| place.vector(*v)));
        out.operations.push(Operation { board: place.board, moves: from..out.tip.len() as u32, ..op.clone() });
    }
    issues
}

/// All boards of [`place_boards`] one after the other.
#[must_use]
pub fn place_paths(
    paths: &PartPaths,
    layout: &Layout,
    machine: &Machine,
    go: &(dyn Fn() -> bool + Sync),
) -> (ToolPaths, Vec<PathIssue>) {
    let (boards, issues) = place_boards(paths, layout, machine, go, &ToolPaths::clone);
    (join(boards, go).unwrap_or_default(), issues)
}
