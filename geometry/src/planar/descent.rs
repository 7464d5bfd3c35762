//! The iteration that planarizes: penalty continuation with second-order correction, then Newton's restoration.

use super::energy::Energy;
use super::flatness::Flatness;
use super::measure::{corner_distance, fit_distance};
use super::step::StepSolver;
use glam::DVec3;

/// Deviation (in mean edges) below which only planarity is restored: Newton's method converges from here.
const NEAR: f64 = 1e-3;
/// Hardest penalty of the continuation.
const HARDEST: f64 = 1e-9;
/// No vertex moves farther in one step than this, in mean edges.
const STRIDE: f64 = 0.3;
/// After this many steps without progress the iteration gives up.
const PATIENCE: usize = 25;

/// What the iteration found.
pub(crate) struct Found {
    /// The points of the least deviation.
    pub points: Vec<DVec3>,
    /// Deviation before the first step and after each, in mean edges.
    pub history: Vec<f64>,
}

/// Greatest distance of a corner of these loops from the plane of the others.
pub(crate) fn deviation(loops: &[Vec<u32>], points: &[DVec3]) -> f64 {
    let mut corners = Vec::new();
    loops.iter().fold(0.0, |worst: f64, face| {
        corners.clear();
        corners.extend(face.iter().map(|&v| points[v as usize]));
        worst.max(if corners.len() == 4 { corner_distance(&corners) } else { fit_distance(&corners) })
    })
}

/// Runs at most `iterations` steps until `loops` (of four or more corners) are planar to `threshold`; everything in
/// units of the mean edge. `None` when `progress` says so.
pub(crate) fn descend(
    origin: Vec<DVec3>,
    loops: &[Vec<u32>],
    mut energy: Energy,
    threshold: f64,
    iterations: u32,
    progress: &(dyn Fn(f64) -> bool + Sync),
) -> Option<Found> {
    let mut flat = Flatness::new(loops.to_vec());
    let mut solver = StepSolver::new(&flat, &energy, &origin);
    let mut points = origin;
    let mut now = deviation(loops, &points);
    let mut history = vec![now];
    let (mut best, mut best_at) = (points.clone(), 0);
    let mut softness = 1.0;
    while now > threshold && history.len() <= iterations as usize && history.len() - best_at <= PATIENCE {
        let done = (history[0] / now).ln() / (history[0] / threshold).ln();
        let done = done.max(history.len() as f64 / f64::from(iterations)).clamp(0.0, 0.99);
        if !progress(done) {
            return None;
        }
        flat.linearize(&points);
        energy.linearize(&points);
        let restoring = now < NEAR;
        // Redundant equations make the system singular; ever more softness makes it regular again.
        let mut soft = if restoring { 1e-13 } else { softness };
        while !solver.factorize(&flat, &energy, soft) && soft < 1.0 {
            soft *= 100.0;
        }
        let step = if restoring {
            solver.restore(&flat)
        } else {
            solver.descend(&flat, &energy, softness, &|| progress(done))?
        };
        let accepted = search(&mut points, &step, &solver, &mut flat, &energy, (!restoring).then_some(softness));
        match accepted {
            // Neither the step nor a thousandth of it helps: the walls are reached.
            None if softness <= HARDEST || restoring => break,
            None => softness *= 0.1,
            Some(alpha) if alpha > 0.4 && !restoring => softness = (softness * 0.1).max(HARDEST),
            Some(_) => {}
        }
        now = deviation(loops, &points);
        history.push(now);
        if now < 0.98 * history[best_at] {
            best.clone_from(&points);
            best_at = history.len() - 1;
        }
    }
    Some(Found { points: best, history })
}

/// Moves the points along the step as far as the merit falls; returns the part of the step taken. With a penalty the
/// merit is energy + ½ |h|² / softness, and each trial is also offered with its planarity restored to second order, or
/// the curved valley of a hard penalty would allow short steps only. Without, the merit is ½ |h|² within the walls.
fn search(
    points: &mut Vec<DVec3>,
    step: &[DVec3],
    solver: &StepSolver,
    flat: &mut Flatness,
    energy: &Energy,
    softness: Option<f64>,
) -> Option<f64> {
    let shift = |points: &mut [DVec3], step: &[DVec3], alpha: f64| {
        for (&v, s) in energy.vertices().iter().zip(step) {
            points[v as usize] += *s * alpha;
        }
    };
    let merit = |flat: &Flatness, points: &[DVec3]| {
        let cost = energy.value(points);
        match softness {
            Some(softness) => cost + flat.energy(points) / softness,
            None if cost.is_finite() => flat.energy(points),
            None => f64::INFINITY,
        }
    };
    let now = merit(flat, points);
    let longest = step.iter().map(|s| s.length()).fold(0.0, f64::max);
    if !(longest > 0.0 && longest.is_finite()) {
        return None;
    }
    let mut alpha = (STRIDE / longest).min(1.0);
    for _ in 0..12 {
        let mut trial = points.clone();
        shift(&mut trial, step, alpha);
        let plain = merit(flat, &trial);
        if softness.is_some() {
            flat.evaluate(&trial);
            let mut restored = trial.clone();
            shift(&mut restored, &solver.restore(flat), 1.0);
            let with = merit(flat, &restored);
            if with < now && with < plain {
                *points = restored;
                return Some(alpha);
            }
        }
        if plain < now {
            *points = trial;
            return Some(alpha);
        }
        alpha *= 0.5;
    }
    None
}
