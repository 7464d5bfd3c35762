//! A tool in its holder and spindle as one widening solid of revolution, as reach and clearance need it.

use crate::machine::{Machine, Revolved, Tool, ToolKind};
use glam::DVec3;

/// Cutter, shank, holder and spindle about the tool axis, measured from the tip upwards; the tip of a drill or an
/// engraver is its point. Radii are widened so that they never shrink upwards: a body drawn back along its own axis
/// then stays within the space that it has cleared.
#[derive(Clone, Debug, PartialEq)]
pub struct Envelope {
    pieces: Vec<Revolved>,
    /// Pieces from here on must stay out of the material.
    holder: usize,
}

impl Envelope {
    /// The envelope of `tool` in `machine`. O(pieces).
    #[must_use]
    pub fn new(machine: &Machine, tool: &Tool) -> Self {
        let body = machine.body(tool);
        let mut pieces = body.cutter;
        // A shank no wider than the cutter follows it into the material; a wider one may not.
        let follows = tool.shank_diameter <= tool.diameter;
        let before_shank = pieces.len();
        pieces.extend(body.shank);
        let holder = if follows { pieces.len() } else { before_shank };
        pieces.extend(body.holder);
        pieces.extend(body.spindle);
        let mut widest: f64 = 0.0;
        for piece in &mut pieces {
            piece.radius_from = piece.radius_from.max(widest);
            piece.radius_to = piece.radius_to.max(piece.radius_from);
            widest = piece.radius_to;
        }
        Self { pieces, holder }
    }

    /// All pieces, from the tip up.
    #[must_use]
    pub fn pieces(&self) -> &[Revolved] {
        &self.pieces
    }

    /// Height of the lowest point of all that must stay out of the material (a shank wider than the cutter, holder,
    /// spindle) when the tip stands at `tip`, mm. Infinite for a bare tool.
    #[must_use]
    pub fn holder_height(&self, tip: DVec3, axis: DVec3) -> f64 {
        let side = (1.0 - axis.z * axis.z).max(0.0).sqrt();
        let height = |h: f64, r: f64| tip.z + h * axis.z - r * side;
        self.pieces[self.holder..]
            .iter()
            .map(|p| height(p.from, p.radius_from).min(height(p.to, p.radius_to)))
            .fold(f64::INFINITY, f64::min)
    }
}

/// Radius of the flat end of a tool, mm: how far its lowest point may lie beside the tip when it tilts.
#[must_use]
pub fn flat_radius(tool: &Tool) -> f64 {
    match tool.kind {
        ToolKind::EndMill => 0.5 * tool.diameter,
        // The cone carries the flat part of a blunt point up with it.
        ToolKind::Drill { .. } | ToolKind::Engraver { .. } if tool.tip_height() > 0.0 => 0.0,
        ToolKind::Drill { .. } | ToolKind::Engraver { .. } => 0.5 * tool.diameter,
    }
}
