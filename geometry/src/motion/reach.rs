//! Reach: can the machine hold this tool in this pose and stay clear of table, board and its own limits?

use super::body::{Envelope, flat_radius};
use crate::board::FacetName;
use crate::machine::{KinematicsError, Machine, Tool};
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Parameters of tool paths, mm. The defaults suit plywood of 8 to 30 mm on a 19 mm sacrificial layer.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathParams {
    /// Number of the end mill for contours; `None`: the widest end mill of the machine.
    pub contour_tool: Option<u32>,
    /// How far a contour cut reaches below the part along the tool axis (METHODS §8: o).
    pub overrun: f64,
    /// How far a contour cut goes on beyond the ends of its chamfer.
    pub corner_overrun: f64,
    /// Greatest depth of one pass along the tool axis.
    pub max_step: f64,
    /// Distance kept above the board: end of the approach, and least height of holder and spindle.
    pub clearance: f64,
    /// How far through holes go into the sacrificial layer at full diameter.
    pub through: f64,
    /// Greatest depth of drilling between two lifts; `None`: in one go.
    pub peck: Option<f64>,
}

impl Default for PathParams {
    fn default() -> Self {
        Self {
            contour_tool: None,
            overrun: 1.0,
            corner_overrun: 1.0,
            max_step: 8.0,
            clearance: 2.0,
            through: 3.0,
            peck: None,
        }
    }
}

/// Where on a part something cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Place {
    /// A chamfer or node facet: the part cannot be cut out.
    Facet(FacetName),
    /// A feature, by its index in the part set's features: the rest of the part can be made.
    Feature(u32),
    /// The part where it lies on its board.
    Board(u32),
}

/// Something that cannot be made.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathIssue {
    /// Part index.
    pub part: u32,
    /// Where on the part.
    pub place: Place,
    /// Why.
    pub error: PathError,
}

impl std::fmt::Display for PathIssue {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.place {
            Place::Facet(name) => write!(f, "part {}, {name}: {}", self.part, self.error),
            Place::Feature(k) => write!(f, "part {}, feature {k}: {}", self.part, self.error),
            Place::Board(b) => write!(f, "part {} on board {b}: {}", self.part, self.error),
        }
    }
}

impl std::error::Error for PathIssue {}

/// Why a path cannot be made. Lengths mm, angles in degrees as they are for people.
#[derive(Clone, Debug, PartialEq, thiserror::Error, Serialize, Deserialize)]
pub enum PathError {
    /// A parameter is out of its range.
    #[error("`{name}` is {value}; it must be {must}")]
    Parameter {
        /// Field of [`PathParams`].
        name: Cow<'static, str>,
        /// Its value.
        value: f64,
        /// What would do.
        must: Cow<'static, str>,
    },
    /// The machine has no tool for it.
    #[error("the machine has no {wanted}; it has {available}")]
    NoTool {
        /// What is needed.
        wanted: String,
        /// What there is.
        available: String,
    },
    /// A facet that lies flat has no steepest line.
    #[error("the facet lies {tilt:.2}° from upright, flat on the machine; it cannot be contoured")]
    Flat {
        /// Angle from upright.
        tilt: f64,
    },
    /// The tool would cut through the sacrificial layer.
    #[error(
        "T{tool} (Ø{:.1}) tilted {tilt:.2}° reaches {depth:.2} mm below the board, the sacrificial layer is \
         {sacrificial:.2} mm: with this tool {largest_tilt:.2}° would do, at this tilt Ø{:.1}",
        2.0 * radius, 2.0 * largest_radius
    )]
    TooDeep {
        /// Tool number.
        tool: u32,
        /// Tilt of the tool.
        tilt: f64,
        /// Depth of the lowest point of the tool below the board.
        depth: f64,
        /// Thickness of the sacrificial layer.
        sacrificial: f64,
        /// Radius of the tool.
        radius: f64,
        /// Largest tilt that would do with this tool.
        largest_tilt: f64,
        /// Largest radius that would do at this tilt; 0: none.
        largest_radius: f64,
    },
    /// A hole reaches too deep.
    #[error(
        "the hole reaches {depth:.2} mm below the board, the sacrificial layer is {sacrificial:.2} mm: it must be \
         {excess:.2} mm shorter"
    )]
    HoleTooDeep {
        /// Depth below the board.
        depth: f64,
        /// Thickness of the sacrificial layer.
        sacrificial: f64,
        /// What it must be shorter by along its axis.
        excess: f64,
    },
    /// The tool's edges are shorter than the cut.
    #[error("T{tool} is too short: it cuts {has:.1} mm of its length, {needed:.1} mm stand in the material")]
    TooShort {
        /// Tool number.
        tool: u32,
        /// Length in the material.
        needed: f64,
        /// Cutting length.
        has: f64,
    },
    /// The tool is longer than the head can be lifted.
    #[error(
        "T{tool} is too long: at the safe height it lifts the spindle nose to {nose:.1} mm, the machine has {headroom:.1} mm; \
         it must be {excess:.1} mm shorter"
    )]
    TooLong {
        /// Tool number.
        tool: u32,
        /// Height of the spindle nose above the board's underside.
        nose: f64,
        /// Greatest height that the machine has.
        headroom: f64,
        /// What the tool must be shorter by.
        excess: f64,
    },
    /// Holder or spindle would touch the board.
    #[error("shank, holder or spindle of T{tool} at a tilt of {tilt:.2}° come {shortfall:.1} mm too near to the board")]
    Holder {
        /// Tool number.
        tool: u32,
        /// Tilt of the tool.
        tilt: f64,
        /// What is missing to the wanted clearance.
        shortfall: f64,
    },
    /// The head cannot hold the tool so.
    #[error("{0}")]
    Head(#[from] KinematicsError),
    /// The feature can only be reached from below.
    #[error("the feature opens downwards ({angle:.2}° below the horizontal); from above it cannot be reached")]
    FromBelow {
        /// Angle of the tool axis below the horizontal.
        angle: f64,
    },
    /// A linear axis is too short.
    #[error("the tool tip must go to {letter} {at:.1} mm, the axis allows {min:.1} to {max:.1} mm")]
    Travel {
        /// Axis letter.
        letter: char,
        /// Where it must go.
        at: f64,
        /// Least position.
        min: f64,
        /// Greatest position.
        max: f64,
    },
    /// The safe height is too low.
    #[error("the safe height of {safe:.1} mm is not above the board: it must be more than {least:.1} mm")]
    SafeHeight {
        /// The machine's safe height.
        safe: f64,
        /// Least that would do.
        least: f64,
    },
    /// A feature that has no operation here.
    #[error("a {what} has no machining operation")]
    NoOperation {
        /// The kind of feature.
        what: Cow<'static, str>,
    },
    /// A character without a glyph.
    #[error("the character {0:?} has no glyph for engraving")]
    Glyph(char),
    /// A number of the part or its feature is not finite.
    #[error("a coordinate is not a finite number")]
    NotFinite,
    /// The caller cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// A tool ready for use: what paths need to know of it and of the machine around it.
#[derive(Clone, Debug)]
pub(super) struct Reach<'a> {
    pub machine: &'a Machine,
    pub tool: &'a Tool,
    /// Index into `Machine::tools`.
    pub index: u32,
    pub body: Envelope,
    /// Upper side of the board, mm.
    pub top: f64,
    pub clearance: f64,
}

impl Reach<'_> {
    /// Height of the tip at which the lowest point of the tool's end is `above` mm over the board.
    pub fn tip_above(&self, axis: DVec3, above: f64) -> f64 {
        self.top + above + self.drop(axis)
    }

    /// Height of the tip for rapids with this axis.
    pub fn tip_safe(&self, axis: DVec3) -> f64 {
        self.machine.safe_height + self.drop(axis)
    }

    /// How far the lowest point of the tool's end lies below its tip.
    fn drop(&self, axis: DVec3) -> f64 {
        flat_radius(self.tool) * sine(axis)
    }

    /// Checks the deepest pose of a cut: tilt, length of the edges in the material, holder, spindle and Z travel.
    pub fn check(&self, tip: DVec3, axis: DVec3) -> Result<(), PathError> {
        if !(tip.is_finite() && axis.is_finite()) {
            return Err(PathError::NotFinite);
        }
        let tilt = sine(axis).atan2(axis.z).to_degrees();
        self.machine.angles(axis, [0.0, 0.0])?;
        // The edge on the upper side of a tilted tool leaves the board last.
        let needed = (self.top - tip.z + 0.5 * self.tool.diameter * sine(axis)) / axis.z;
        if needed > self.tool.cutting_length {
            let (tool, has) = (self.tool.number, self.tool.cutting_length);
            return Err(PathError::TooShort { tool, needed, has });
        }
        let shortfall = self.top + self.clearance - self.body.holder_height(tip, axis);
        if shortfall > 0.0 {
            return Err(PathError::Holder { tool: self.tool.number, tilt, shortfall });
        }
        let (nose, headroom) = (self.tip_safe(axis) + self.tool.gauge() * axis.z, self.machine.headroom);
        if nose > headroom {
            let excess = (nose - headroom) / axis.z;
            return Err(PathError::TooLong { tool: self.tool.number, nose, headroom, excess });
        }
        let (z, at) = (&self.machine.linear[2], self.tip_safe(axis));
        for at in [at, tip.z] {
            if !(z.min..=z.max).contains(&at) {
                return Err(PathError::Travel { letter: z.letter, at, min: z.min, max: z.max });
            }
        }
        Ok(())
    }
}

/// Sine of the angle between a unit axis and the vertical.
pub(super) fn sine(axis: DVec3) -> f64 {
    axis.x.hypot(axis.y)
}

impl PathParams {
    /// Checks ranges and the machine's safe height over boards of thickness `top`.
    pub(super) fn check(&self, machine: &Machine, top: f64) -> Result<(), PathError> {
        let refused = |name: &'static str, value, must: &'static str| PathError::Parameter {
            name: name.into(),
            value,
            must: must.into(),
        };
        let positive = [("max_step", self.max_step), ("peck", self.peck.unwrap_or(top.max(1.0)))];
        let not_negative = [
            ("overrun", self.overrun),
            ("corner_overrun", self.corner_overrun),
            ("clearance", self.clearance),
            ("through", self.through),
        ];
        for (name, value) in positive {
            if !(value > 0.0 && value.is_finite()) {
                return Err(refused(name, value, "more than 0"));
            }
            // No board is cut in more steps, and a slip of the decimal point must not fill the memory.
            if value < 1e-3 * top {
                let must = "at least a thousandth of the board's thickness";
                return Err(refused(name, value, must));
            }
        }
        for (name, value) in not_negative {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(refused(name, value, "0 or more"));
            }
        }
        if self.overrun > machine.table.sacrificial {
            let must = "at most the thickness of the sacrificial layer";
            return Err(refused("overrun", self.overrun, must));
        }
        let least = top + self.clearance;
        if machine.safe_height.is_nan() || machine.safe_height <= least {
            return Err(PathError::SafeHeight { safe: machine.safe_height, least });
        }
        Ok(())
    }
}
