//! Drawing the figure P · K_n (000 §4.1).
//!
//! Words are split into a head and a tail: the polygons of all heads are made level by level, the columns of all tails
//! once, and every point is one product of a head's polygon with a tail's column. That costs 4m multiplications a point,
//! written once into its final place, in any number of threads.

use super::basis::{Basis, Polygons};
use super::continuity::Continuity;
use super::curve::{Curve, Words, drawable};
use super::error::CurveError;
use super::scheme::{Scheme, combine};
use glam::{DVec4, Vec4Swizzles};
use rayon::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// Most segments of one curve: 2²⁶, two gigabytes of points.
pub const MAX_SEGMENTS: usize = 1 << 26;
/// Most iterations, whatever the scheme.
pub const MAX_ITERATIONS: u32 = 26;
/// Points of one tail: its columns stay in the first cache.
const TAIL: usize = 512;
/// Points between two looks at the caller's wish to stop: about a millisecond's work.
const SLAB: usize = 1 << 18;
/// Below this many points threads cost more than they save.
const SMALL: usize = 1 << 14;
/// Rounding of weights at the joint of two patches, relative.
const WEIGHT_ROUNDING: f64 = 1e-9;

/// Draws the figure of `scheme` after `iterations` on each of the control polygons `patches` (homogeneous points
/// (WX, WY, WZ, W), see [`super::homogeneous`]), chained in their order (000 §4.1, §5.2.2, §5.4.2).
///
/// A connected figure becomes one strip: each patch must start where the one before ends, within `tolerance` mm; where
/// the last patch ends at the first one's start, within `tolerance`, the curve is closed. A figure whose copies do not
/// meet becomes as many strips as it has pieces, and patches stay apart.
///
/// Which elements meet follows from the scheme's columns, never from coordinates; the drawing order follows the shared
/// points, so that the dragon, too, is one polyline. O(4 m patches kⁿ) time, one allocation of the result's size;
/// the result does not depend on the number of threads. `progress` gets the fraction done and returns false to cancel.
///
/// # Errors
/// [`CurveError`]: no or wrong number of control points, NaN or infinity, weights that sum to ≤ 0, a point with W ≤ 0
/// (with its element's word), a gap or a jump of weight between patches, too many segments, cancelled.
pub fn iterate(
    scheme: &Scheme,
    patches: &[Vec<DVec4>],
    iterations: u32,
    tolerance: f64,
    progress: &(dyn Fn(f64) -> bool + Sync),
) -> Result<Curve, CurveError> {
    if !(tolerance.is_finite() && tolerance >= 0.0) {
        return Err(CurveError::Tolerance { tolerance });
    }
    check_control(scheme, patches, tolerance)?;
    check_count(scheme, patches.len(), iterations)?;
    let continuity = Continuity::of(scheme, iterations);
    let figure = Figure::new(scheme, &continuity, patches, iterations);
    let points = figure.draw(progress)?;
    if figure.merged { figure.close(points, patches.len(), tolerance) } else { Ok(figure.split(points, &continuity)) }
}

fn check_control(scheme: &Scheme, patches: &[Vec<DVec4>], tolerance: f64) -> Result<(), CurveError> {
    for (patch, control) in patches.iter().enumerate() {
        if control.is_empty() {
            return Err(CurveError::Empty);
        }
        if control.len() != scheme.m {
            return Err(CurveError::ControlCount { patch, given: control.len(), needed: scheme.m });
        }
        if let Some(control) = control.iter().position(|p| !p.is_finite()) {
            return Err(CurveError::NotFinite { patch, control });
        }
        let sum: f64 = control.iter().map(|p| p.w).sum();
        if sum <= 0.0 {
            return Err(CurveError::WeightSum { patch, sum });
        }
    }
    let Some(&first) = patches.first().and_then(|p| p.first()) else { return Err(CurveError::Empty) };
    let place = |p: &DVec4| p.xyz() / p.w;
    if patches.iter().flatten().all(|p| place(p).distance(place(&first)) <= tolerance) {
        return Err(CurveError::OnePoint);
    }
    Ok(())
}

/// Whether so many segments may be drawn; the error names the most iterations that fit.
pub(crate) fn check_count(scheme: &Scheme, patches: usize, iterations: u32) -> Result<(), CurveError> {
    let k = scheme.transformation_count();
    let fits = |n: u32| {
        n <= MAX_ITERATIONS
            && k.checked_pow(n)
                .and_then(|e| e.checked_mul(scheme.germ_segments())?.checked_mul(patches))
                .is_some_and(|segments| segments <= MAX_SEGMENTS)
    };
    if fits(iterations) {
        return Ok(());
    }
    let largest = (0..=MAX_ITERATIONS).rev().find(|&n| fits(n)).unwrap_or(0);
    Err(CurveError::TooManySegments { iterations, limit: MAX_SEGMENTS, largest })
}

/// A figure about to be drawn: heads times tails.
struct Figure {
    m: usize,
    words: Words,
    heads: Polygons,
    tails: Basis,
    /// Whether the figure is connected, so that shared points stand once.
    merged: bool,
    /// Points that each head draws.
    block: usize,
}

impl Figure {
    fn new(scheme: &Scheme, continuity: &Continuity, patches: &[Vec<DVec4>], iterations: u32) -> Self {
        let (k, parts) = (scheme.transformation_count(), scheme.germ_segments());
        let mut tail = 0;
        while tail < iterations && k.pow(tail + 1) * parts <= TAIL {
            tail += 1;
        }
        let merged = continuity.connected();
        let tails = Basis::new(scheme, continuity, tail, merged);
        let mut heads = Polygons::default();
        for control in patches {
            heads.append(scheme, continuity, control, iterations - tail);
        }
        let block = if merged { tails.points - 1 } else { tails.points };
        let traversal = continuity.traversal.clone();
        let words = Words { base: k as u32, digits: iterations, parts: parts as u32, traversal };
        Self { m: scheme.m, words, heads, tails, merged, block }
    }

    /// Point `t` of head `head`, in drawing order; a merged head has `block + 1` of them.
    #[inline]
    fn point(&self, head: usize, t: usize) -> DVec4 {
        let at = if self.heads.backwards[head] { self.tails.points - 1 - t } else { t };
        combine(&self.heads.points[head * self.m..(head + 1) * self.m], self.tails.column(self.m, at))
    }

    /// All points, each patch without its last one when merged.
    fn draw(&self, progress: &(dyn Fn(f64) -> bool + Sync)) -> Result<Vec<DVec4>, CurveError> {
        let total = self.heads.backwards.len() * self.block;
        let bad = AtomicU32::new(u32::MAX);
        let block = self.block as u32;
        let point = |i: u32| {
            let p = self.point((i / block) as usize, (i % block) as usize);
            if !drawable(p) {
                bad.fetch_min(i, Ordering::Relaxed);
            }
            p
        };
        // One place more: an open curve gets its end point later.
        let mut points = Vec::with_capacity(total + 1);
        if total < SMALL {
            points.extend((0..total as u32).map(point));
        } else {
            for start in (0..total).step_by(SLAB) {
                if !progress(start as f64 / total as f64) {
                    return Err(CurveError::Cancelled);
                }
                let slab = start as u32..total.min(start + SLAB) as u32;
                points.par_extend(slab.into_par_iter().with_min_len(SMALL / 2).map(point));
            }
        }
        let bad = bad.into_inner() as usize;
        match points.get(bad) {
            Some(p) if self.merged => Err(self.undrawable(bad, *p)),
            Some(p) => {
                let parts = self.words.parts as usize;
                let within = (bad % (parts + 1)).min(parts - 1);
                Err(self.undrawable(bad / (parts + 1) * parts + within, *p))
            }
            None => Ok(points),
        }
    }

    fn undrawable(&self, segment: usize, p: DVec4) -> CurveError {
        let word = self.words.word(segment);
        if p.is_finite() && p.w <= 0.0 {
            CurveError::Weight { word, weight: p.w }
        } else {
            CurveError::Overflow { word }
        }
    }

    /// Joins the patches of a connected figure and closes or ends the curve.
    fn close(self, mut points: Vec<DVec4>, patches: usize, tolerance: f64) -> Result<Curve, CurveError> {
        let (heads, stride) = (self.heads.backwards.len() / patches, points.len() / patches);
        let mut closed = false;
        for patch in 1..=patches {
            let end = self.point(patch * heads - 1, self.block);
            if !drawable(end) {
                return Err(self.undrawable(patch * stride - 1, end));
            }
            let start = points[if patch < patches { patch * stride } else { 0 }];
            let gap = (end.xyz() / end.w).distance(start.xyz() / start.w);
            let same_weight = (end.w - start.w).abs() <= WEIGHT_ROUNDING * end.w.max(start.w);
            if patch == patches {
                closed = gap <= tolerance && same_weight && points.len() >= 3;
                if !closed {
                    points.push(end);
                }
            } else if gap > tolerance {
                return Err(CurveError::Gap { patch, gap, tolerance });
            } else if !same_weight {
                return Err(CurveError::WeightJump { patch, end: end.w, start: start.w });
            }
        }
        Ok(Curve { strip_start: vec![0, points.len() as u32].into(), points: points.into(), closed, words: self.words })
    }

    /// Divides a figure that is not connected into its strips; shared points of neighbours are merged.
    fn split(self, points: Vec<DVec4>, continuity: &Continuity) -> Curve {
        let size = self.words.parts as usize + 1;
        let count = points.len() / size;
        if continuity.scattered() {
            let strip_start = (0..=count).map(|e| (e * size) as u32).collect();
            return Curve { points: points.into(), strip_start, closed: false, words: self.words };
        }
        let elements = (self.words.base as usize).pow(self.words.digits);
        let (mut kept, mut strip_start) = (Vec::with_capacity(points.len()), Vec::new());
        let mut joined = false;
        for (e, element) in points.chunks_exact(size).enumerate() {
            if !joined {
                strip_start.push(kept.len() as u32);
            }
            kept.extend_from_slice(&element[usize::from(joined)..]);
            joined = continuity.joined_after(e % elements);
        }
        strip_start.push(kept.len() as u32);
        Curve { points: kept.into(), strip_start: strip_start.into(), closed: false, words: self.words }
    }
}
