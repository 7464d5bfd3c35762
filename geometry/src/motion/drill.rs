//! Drilling: fixing holes and fastener holes, straight down the tool axis.

use super::path::MoveKind;
use super::reach::{PathError, PathParams, Reach};
use super::trace::Trace;
use glam::DVec3;

/// A hole in a part frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hole {
    pub entry: DVec3,
    /// Into the wood.
    pub axis: DVec3,
    pub depth: f64,
}

/// Drills one hole: rapid to the safe height on its axis, approach to just above the board, plunge (through the waste
/// first where the hole enters on a chamfer; in steps of `peck`), lift. The point of the drill ends at the hole's
/// depth; a hole that reaches the underside goes on until its full diameter is `through` mm in the sacrificial layer.
/// O(pecks).
///
/// # Errors
/// A hole that opens downwards, goes through the sacrificial layer, or is out of the tool's or the machine's reach.
pub(super) fn drill(reach: &Reach, params: &PathParams, hole: &Hole, out: &mut Trace) -> Result<(), PathError> {
    if !(hole.entry.is_finite() && hole.axis.is_finite() && hole.depth.is_finite()) {
        return Err(PathError::NotFinite);
    }
    let axis = -hole.axis;
    // Nearly level holes have no place to start above the board.
    if axis.z < 1e-3 {
        return Err(PathError::FromBelow { angle: (-axis.z).clamp(-1.0, 1.0).asin().to_degrees() });
    }
    let mut tip = hole.entry + hole.axis * hole.depth;
    // A thousandth of a micrometre: rounding of the mapping must not decide whether a hole goes through.
    if tip.z < 1e-6 {
        tip += hole.axis * (reach.tool.tip_height() + params.through / axis.z);
    }
    let sacrificial = reach.machine.table.sacrificial;
    if -tip.z > sacrificial {
        let excess = (-tip.z - sacrificial) / axis.z;
        return Err(PathError::HoleTooDeep { depth: -tip.z, sacrificial, excess });
    }
    reach.check(tip, axis)?;
    let lift = |z: f64| tip + axis * ((z - tip.z) / axis.z);
    let (safe, above) = (lift(reach.tip_safe(axis)), lift(reach.tip_above(axis, params.clearance)));
    let feeds = &reach.tool.feeds;
    out.axis = axis;
    out.go(MoveKind::Rapid, safe, 0.0);
    out.go(MoveKind::Approach, above, feeds.approach);
    let travel = (above - tip).dot(axis);
    let pecks = params.peck.map_or(1.0, |p| (travel / p - 1e-9).ceil().max(1.0));
    let at = |peck: u32| above - axis * (travel * f64::from(peck) / pecks);
    for peck in 1..pecks as u32 {
        out.go(MoveKind::Plunge, at(peck), feeds.plunge);
        out.go(MoveKind::Lift, above, feeds.lift);
        // Back to a little above the ground of the hole, which is free.
        let ground = at(peck) + axis * params.clearance.min(travel / pecks);
        out.go(MoveKind::Approach, ground, feeds.approach);
    }
    out.go(MoveKind::Plunge, tip, feeds.plunge);
    out.go(MoveKind::Lift, above, feeds.lift);
    out.go(MoveKind::Approach, safe, feeds.approach);
    Ok(())
}
