//! The machine description: what a post and a proof must know of a machine besides its words.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A length of a solid of revolution about the tool axis, measured from the tool tip towards the spindle.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Revolved {
    /// Start, mm above the tip.
    pub from: f64,
    /// End, mm above the tip.
    pub to: f64,
    /// Radius at `from`, mm.
    pub radius_from: f64,
    /// Radius at `to`, mm.
    pub radius_to: f64,
}

/// How a tool's tip looks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ToolKind {
    /// Flat end mill.
    EndMill,
    /// Twist drill; `point_angle` is the full angle of its point, degrees (180: flat).
    Drill {
        /// Full point angle, degrees.
        point_angle: f64,
    },
    /// Conical engraving tool; `tip_angle` is the full angle of its cone, degrees.
    Engraver {
        /// Full tip angle, degrees.
        tip_angle: f64,
    },
}

/// Feeds, mm/min.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Feeds {
    /// From the safe height to the material.
    pub approach: f64,
    /// Into the material along the axis.
    pub plunge: f64,
    /// Through the material.
    pub cut: f64,
    /// Out of the material.
    pub lift: f64,
}

/// A tool in its holder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Tool {
    /// Number in the magazine (T word).
    pub number: u32,
    /// Name for people.
    pub name: String,
    /// Kind of tip.
    pub kind: ToolKind,
    /// Cutting diameter, mm.
    pub diameter: f64,
    /// Length that cuts, from the tip, mm.
    pub cutting_length: f64,
    /// From the tip to the holder's nose, mm; between `cutting_length` and here the shank has `shank_diameter`.
    pub length: f64,
    /// Shank diameter, mm.
    pub shank_diameter: f64,
    /// The holder, from its nose up, measured from the tip.
    pub holder: Vec<Revolved>,
    /// Spindle speed, 1/min.
    pub speed: f64,
    /// Feeds.
    pub feeds: Feeds,
}

/// A linear axis with its travel, mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Address letter.
    pub letter: char,
    /// Least position of the tool tip in board coordinates, mm.
    pub min: f64,
    /// Greatest position, mm.
    pub max: f64,
}

/// A rotary axis: turning by the programmed angle `q` rotates by `sign · q` about `about` (right-hand rule).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Rotary {
    /// Address letter.
    pub letter: char,
    /// Unit direction of the axis when all angles are zero.
    pub about: DVec3,
    /// +1 or -1.
    pub sign: f64,
    /// Least angle, degrees.
    pub min: f64,
    /// Greatest angle, degrees.
    pub max: f64,
}

/// The table under the board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Table {
    /// Extent of the table from the board's origin, mm.
    pub min: DVec3,
    /// Extent of the table from the board's origin, mm; `max.z` is below `-sacrificial`.
    pub max: DVec3,
    /// Depth of the sacrificial layer below the board (z = 0), into which tools may cut, mm.
    pub sacrificial: f64,
}

/// A clamp or stop on the table: an axis-aligned box in board coordinates, never to be touched.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Clamp {
    /// Name for people.
    pub name: String,
    /// Lower corner, mm.
    pub min: DVec3,
    /// Upper corner, mm.
    pub max: DVec3,
}

/// A five-axis machine with two rotary axes in the head. The tool axis (from tip to spindle) is
/// `R(primary) · R(secondary) · Z`: the primary carries the secondary. Coordinates are the tip's where `tip_control`
/// is on; otherwise those of the pivot, `pivot` mm above the tip's end of the spindle nose plus tool length.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Machine {
    /// Name for people.
    pub name: String,
    /// X, Y, Z.
    pub linear: [Axis; 3],
    /// The rotary axis next to the frame (about Z).
    pub primary: Rotary,
    /// The rotary axis that tilts the tool.
    pub secondary: Rotary,
    /// Whether the control keeps the tip in place while the head turns (RTCP).
    pub tip_control: bool,
    /// Distance from the spindle nose to the crossing of the rotary axes, mm; used without `tip_control`.
    pub pivot: f64,
    /// Height above the board's underside at which the tip may travel rapidly, mm.
    pub safe_height: f64,
    /// Greatest height of the spindle nose above the board's underside, mm: what a long tool runs out of.
    pub headroom: f64,
    /// The table.
    pub table: Table,
    /// Clamps and stops.
    pub clamps: Vec<Clamp>,
    /// The spindle, measured from the spindle nose (= end of the holder) upwards.
    pub spindle: Vec<Revolved>,
    /// Tools.
    pub tools: Vec<Tool>,
}
