//! Engraving of text in single strokes.

use super::glyph::text_strokes;
use super::path::MoveKind;
use super::reach::{PathError, PathParams, Reach};
use super::trace::Trace;
use glam::{DVec2, DVec3};

/// A line of text in a part frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Text<'a> {
    pub origin: DVec3,
    pub along: DVec3,
    /// Into the wood.
    pub axis: DVec3,
    pub height: f64,
    pub depth: f64,
    pub text: &'a str,
}

/// Engraves a text stroke by stroke, the tool square to the surface and its point at the strokes' depth. O(points).
///
/// # Errors
/// A character without a glyph; a surface that faces down or is out of reach.
pub(super) fn engrave(reach: &Reach, params: &PathParams, text: &Text, out: &mut Trace) -> Result<(), PathError> {
    let strokes = text_strokes(text.text, text.height).map_err(PathError::Glyph)?;
    let axis = -text.axis;
    if !(text.axis.is_finite() && axis.z >= 1e-3) {
        return Err(PathError::FromBelow { angle: (-axis.z).clamp(-1.0, 1.0).asin().to_degrees() });
    }
    let up = text.along.cross(text.axis);
    let point = |p: &DVec2| text.origin + text.along * p.x + up * p.y + text.axis * text.depth;
    let lift = |tip: DVec3, z: f64| tip + axis * ((z - tip.z) / axis.z);
    let (safe, above) = (reach.tip_safe(axis), reach.tip_above(axis, params.clearance));
    for p in strokes.iter().flatten() {
        reach.check(point(p), axis)?;
    }
    let feeds = &reach.tool.feeds;
    out.axis = axis;
    let mut last = None;
    for stroke in &strokes {
        let Some((first, rest)) = stroke.split_first() else { continue };
        let start = point(first);
        if last.is_none() {
            out.go(MoveKind::Rapid, lift(start, safe), 0.0);
        }
        // From stroke to stroke just above the board, at feed: rapids are for the safe height.
        out.go(MoveKind::Approach, lift(start, above), feeds.approach);
        out.go(MoveKind::Plunge, start, feeds.plunge);
        let mut end = start;
        for p in rest {
            end = point(p);
            out.go(MoveKind::Cut, end, feeds.cut);
        }
        out.go(MoveKind::Lift, lift(end, above), feeds.lift);
        last = Some(end);
    }
    if let Some(end) = last {
        out.go(MoveKind::Approach, lift(end, safe), feeds.approach);
    }
    Ok(())
}
