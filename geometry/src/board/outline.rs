//! Cleared outlines `C_i`: what tools, holders and the spindle sweep below the board's upper side while they make a
//! part, taken from the part's real moves.

use super::convex::hull;
use crate::machine::Machine;
use crate::motion::{Envelope, MoveKind, PartPaths};
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Sides of the polygon drawn around each tool circle.
const SIDES: usize = 24;

/// Cleared outline per part in its part frame: the convex hull of its piece outline and of everything that cutter,
/// shank, holder and spindle sweep at heights up to `top` in all of the part's feed moves, tool circles drawn from
/// outside (at most 0.9 % of their radius too wide). Empty for parts without a piece outline.
///
/// Rapids stay above `top` and are left out. O(moves + p log p) per part for `p` distinct deep poses.
/// Stops early when `go` says no, and what there is then is of no use.
#[must_use]
pub fn cleared_outlines(
    piece: &[Vec<DVec2>],
    paths: &PartPaths,
    machine: &Machine,
    top: f64,
    go: &(dyn Fn() -> bool + Sync),
) -> Vec<Vec<DVec2>> {
    let ring: [(f64, f64); SIDES] =
        std::array::from_fn(|s| (s as f64 * std::f64::consts::TAU / SIDES as f64).sin_cos());
    let bodies: Vec<Envelope> = machine.tools.iter().map(|t| Envelope::new(machine, t)).collect();
    piece
        .par_iter()
        .enumerate()
        .map(|(i, own)| {
            if own.len() < 3 || !go() {
                return Vec::new();
            }
            let borders = borders(own);
            let mut points = own.clone();
            for op in paths.of_part(i) {
                let body = &bodies[op.tool as usize];
                for (tip, axis) in deep_poses(paths, op.moves.start as usize..op.moves.end as usize) {
                    if !lies_within(&borders, body, tip, axis, top) {
                        shadow(body, &ring, tip, axis, top, &mut points);
                    }
                }
            }
            hull(&points)
        })
        .collect()
}

/// Poses of an operation that no other pose covers: those in the material, and of several along one tool axis only
/// the deepest, because a body that never narrows upwards (see [`Envelope`]) covers itself when drawn back.
fn deep_poses(paths: &PartPaths, moves: std::ops::Range<usize>) -> Vec<(DVec3, DVec3)> {
    let mut kept: Vec<(DVec3, DVec3)> = Vec::new();
    for k in moves {
        if !matches!(paths.paths.kind[k], MoveKind::Plunge | MoveKind::Cut) {
            continue;
        }
        let (tip, axis) = (paths.paths.tip[k], paths.paths.axis[k]);
        // Passes of one cut follow each other, so the pose above or below is among the last few.
        let from = kept.len().saturating_sub(4);
        let same = kept[from..].iter_mut().find(|(t, a)| *a == axis && (tip - *t).cross(axis).length() < 1e-9);
        match same {
            Some((t, _)) if (tip - *t).dot(axis) < 0.0 => *t = tip,
            Some(_) => {}
            None => kept.push((tip, axis)),
        }
    }
    kept
}

/// Borders of a convex polygon: a point of each and its unit inward normal.
fn borders(polygon: &[DVec2]) -> Vec<(DVec2, DVec2)> {
    let ends = polygon.iter().zip(polygon.iter().cycle().skip(1));
    ends.filter_map(|(a, b)| Some((*a, (*b - *a).try_normalize()?.perp()))).collect()
}

/// Whether all of the body up to `top` surely stands over the piece: then it clears nothing beside it. Most holes and
/// all engravings do.
fn lies_within(borders: &[(DVec2, DVec2)], body: &Envelope, tip: DVec3, axis: DVec3, top: f64) -> bool {
    let lean = axis.truncate().length();
    for piece in body.pieces() {
        let radius = piece.radius_from.max(piece.radius_to);
        // Above this height along the axis even the lowest side of the body is over `top`.
        let end = piece.to.min((top - tip.z + radius * lean) / axis.z.max(f64::MIN_POSITIVE));
        if piece.from > end {
            continue;
        }
        for h in [piece.from, end] {
            let centre = (tip + axis * h).truncate();
            if borders.iter().any(|(from, inward)| inward.dot(centre - *from) < radius) {
                return false;
            }
        }
    }
    true
}

/// Adds the outline of the body's part at heights up to `top` as seen from above.
fn shadow(body: &Envelope, ring: &[(f64, f64); SIDES], tip: DVec3, axis: DVec3, top: f64, points: &mut Vec<DVec2>) {
    let (u, v) = axis.any_orthonormal_pair();
    let outside = 1.0 / (std::f64::consts::PI / SIDES as f64).cos();
    for piece in body.pieces() {
        let lowest = |h: f64, r: f64| tip.z + h * axis.z - r * (1.0 - axis.z * axis.z).max(0.0).sqrt();
        if lowest(piece.from, piece.radius_from).min(lowest(piece.to, piece.radius_to)) > top {
            continue;
        }
        for (sin, cos) in ring {
            let ray = (u * *cos + v * *sin) * outside;
            let a = tip + axis * piece.from + ray * piece.radius_from;
            let b = tip + axis * piece.to + ray * piece.radius_to;
            let (low, high) = if a.z <= b.z { (a, b) } else { (b, a) };
            if low.z > top {
                continue;
            }
            points.push(low.truncate());
            let cut = if high.z > top { low.lerp(high, (top - low.z) / (high.z - low.z)) } else { high };
            points.push(cut.truncate());
        }
    }
}
