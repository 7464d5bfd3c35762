//! Contour of a chamfer with a flat end mill (000 §7.3.3-4, METHODS §8). The tool axis lies in the chamfer plane along
//! its steepest line, the cutter touches the plane from outside along one line, and every pass makes six moves.

use super::path::MoveKind;
use super::reach::{PathError, PathParams, Reach, sine};
use super::trace::Trace;
use crate::board::Facet;
use glam::DVec3;

/// Geometry of one contour: the tool's axis in the chamfer plane and the containing rectangle of the chamfer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contour {
    /// Outward unit normal n̂ of the chamfer.
    pub normal: DVec3,
    /// Unit tool axis â: the steepest line of the plane, upwards.
    pub axis: DVec3,
    /// Unit horizontal direction of the cut; the part lies to its right, so that a clockwise spindle mills in climb.
    pub along: DVec3,
    /// Point of the plane at z = 0 and position 0 along the cut.
    pub foot: DVec3,
    /// Extent of the chamfer along the cut, mm.
    pub from: f64,
    /// Extent of the chamfer along the cut, mm.
    pub to: f64,
}

impl Contour {
    /// The contour of a facet in a part frame; `None` if the facet lies flat.
    #[must_use]
    pub fn new(facet: &Facet) -> Option<Self> {
        let normal = facet.plane.normal;
        let along = normal.cross(DVec3::Z).try_normalize()?;
        let axis = along.cross(normal).normalize();
        let axis = if axis.z < 0.0 { -axis } else { axis };
        let first = facet.plane.project(*facet.points().first()?);
        // Below half a thousandth of a degree from flat the steepest line has no foot on the board.
        if axis.z < 1e-5 {
            return None;
        }
        let on_table = first - axis * (first.z / axis.z);
        let foot = on_table - along * along.dot(on_table);
        let spread = facet.points().iter().map(|p| along.dot(*p));
        let (from, to) = spread.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (a.min(s), b.max(s)));
        Some(Self { normal, axis, along, foot, from, to })
    }

    /// Tip centre of a cutter of radius `r` that touches the plane along the cut at `s` and ends `o` mm below the
    /// board along its axis: `v_b + r·n̂ − o·â`.
    #[must_use]
    pub fn tip(&self, s: f64, r: f64, o: f64) -> DVec3 {
        self.foot + self.along * s + self.normal * r - self.axis * o
    }
}

/// Cuts one facet in passes of equal depth. Each pass: rapid at the safe height, approach to just above the board,
/// plunge, cut, lift, up to the safe height.
///
/// The swept half-space is the outer side of the facet's plane, so a convex part is never gouged by its own contour
/// and the cut may run on beyond the corners. O(passes).
///
/// # Errors
/// A flat facet, a tilt beyond the machine's, a cut through the sacrificial layer (naming the largest tilt and radius
/// that would do), a tool that is too short or whose holder comes too near, a Z travel that is too short.
pub(super) fn cut(reach: &Reach, params: &PathParams, facet: &Facet, out: &mut Trace) -> Result<(), PathError> {
    let flat = || PathError::Flat { tilt: facet.plane.normal.z.abs().min(1.0).asin().to_degrees() };
    let c = Contour::new(facet).ok_or_else(flat)?;
    let (r, o) = (0.5 * reach.tool.diameter, params.overrun);
    let deepest = c.tip(c.from, r, o);
    below_board(reach, c.normal.z, c.axis, o)?;
    reach.check(deepest, c.axis)?;
    let slant = reach.top / c.axis.z + o;
    let passes = (slant / params.max_step - 1e-9).ceil().max(1.0);
    let (from, to) = (c.from - params.corner_overrun, c.to + params.corner_overrun);
    let lift = |tip: DVec3, z: f64| tip + c.axis * ((z - tip.z) / c.axis.z);
    let (safe, above) = (reach.tip_safe(c.axis), reach.tip_above(c.axis, params.clearance));
    let feeds = &reach.tool.feeds;
    out.axis = c.axis;
    for pass in 1..=passes as u32 {
        let depth = slant * f64::from(pass) / passes;
        let (b1, b2) = (c.tip(from, r, o - slant + depth), c.tip(to, r, o - slant + depth));
        out.go(MoveKind::Rapid, lift(b1, safe), 0.0);
        out.go(MoveKind::Approach, lift(b1, above), feeds.approach);
        out.go(MoveKind::Plunge, b1, feeds.plunge);
        out.go(MoveKind::Cut, b2, feeds.cut);
        out.go(MoveKind::Lift, lift(b2, above), feeds.lift);
        out.go(MoveKind::Approach, lift(b2, safe), feeds.approach);
    }
    Ok(())
}

/// Checks the lowest point of the flat end of a tool tilted for an undercut against the sacrificial layer:
/// `2 r sin β + o cos β` below v_b.
fn below_board(reach: &Reach, normal_z: f64, axis: DVec3, o: f64) -> Result<(), PathError> {
    let r = 0.5 * reach.tool.diameter;
    let (sin, cos) = (sine(axis), axis.z);
    // Without an undercut the lowest point lies on the plane, `o cos β` below: the overrun has been checked as such.
    if normal_z >= 0.0 {
        return Ok(());
    }
    let depth = 2.0 * r * sin + o * cos;
    let sacrificial = reach.machine.table.sacrificial;
    if depth <= sacrificial {
        return Ok(());
    }
    // 2 r sin β + o cos β = R sin(β + φ), R² = 4 r² + o², tan φ = o / 2 r.
    let largest_tilt = ((sacrificial / (2.0 * r).hypot(o)).clamp(-1.0, 1.0).asin() - o.atan2(2.0 * r)).max(0.0);
    let largest_radius = ((sacrificial - o * cos) / (2.0 * sin)).max(0.0);
    Err(PathError::TooDeep {
        tool: reach.tool.number,
        tilt: sin.atan2(cos).to_degrees(),
        depth,
        sacrificial,
        radius: r,
        largest_tilt: largest_tilt.to_degrees(),
        largest_radius,
    })
}
