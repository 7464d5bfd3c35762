//! What a proof says: a verdict per program and per part, and for every failure where, what and by how much.

use crate::mesh::Address;
use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::fmt;

/// Tolerances and densities of a proof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProofParams {
    /// Deepest that a cutter may go into a part, and that anything may dip into what it must not touch, mm.
    pub gouge: f64,
    /// Most stock that may stand on a designed face, measured along its normal, and that may be missing to a hole's
    /// depth, mm.
    pub leftover: f64,
    /// Spacing of sample points on faces that no single cut clears, mm.
    pub sample: f64,
    /// Largest turn of the head taken as one step, radians.
    pub turn: f64,
    /// Reasons kept per program; the rest is counted.
    pub most_reasons: usize,
}

impl Default for ProofParams {
    fn default() -> Self {
        Self { gouge: 0.005, leftover: 0.05, sample: 2.0, turn: 2f64.to_radians(), most_reasons: 100 }
    }
}

/// A face of a part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum PartFace {
    /// The designed surface.
    Front,
    /// The face parallel to it.
    Back,
    /// The chamfer of an edge.
    Edge(u32),
    /// The node facet of a corner.
    Node(u32),
}

/// Which part of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Body {
    /// What cuts.
    Cutter,
    /// Between cutter and holder.
    Shank,
    /// Holder.
    Holder,
    /// Spindle.
    Spindle,
}

/// What must not be touched.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Obstacle {
    /// The board.
    Stock,
    /// The layer under the board, which only a cutter at feed may enter.
    Sacrificial,
    /// The table below it.
    Table,
    /// A clamp or stop, by name.
    Clamp(String),
}

/// What is wrong.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Fault {
    /// The text is not a program.
    Unreadable(String),
    /// Parts lie on this board, but no program was given for it.
    NoProgram,
    /// The first position is reached from anywhere, so all of the tool must be above stock and clamps there.
    FirstMove,
    /// A tool is changed while it is not above stock and clamps.
    ToolChange,
    /// A tool number that is not in the tool table.
    UnknownTool(u32),
    /// A move at feed while the spindle stands.
    SpindleStopped,
    /// Another speed than the tool table's.
    Speed {
        /// Programmed, 1/min.
        programmed: f64,
        /// In the tool table, 1/min.
        table: f64,
    },
    /// An axis beyond its limits (the machine's own, whoever posted).
    Limit {
        /// Letter of the axis.
        axis: char,
        /// Programmed, mm or degrees.
        value: f64,
        /// Least, mm or degrees.
        min: f64,
        /// Greatest, mm or degrees.
        max: f64,
    },
    /// A drill that is moved across its axis in the stock.
    DrillSideways,
    /// A body of the machine where it must not be.
    Collision {
        /// At full speed.
        rapid: bool,
        /// Which body.
        body: Body,
        /// What it enters.
        obstacle: Obstacle,
    },
    /// A cutter in a part.
    Gouge,
    /// Stock left on a face.
    Leftover(PartFace),
    /// A designed hole that is not drilled to its depth with its diameter.
    MissingHole {
        /// Index of the feature in the part set.
        feature: u32,
        /// Diameter, mm.
        diameter: f64,
        /// Depth, mm.
        depth: f64,
    },
    /// A designed engraving that is not engraved all along.
    MissingEngraving {
        /// Index of the feature in the part set.
        feature: u32,
        /// Its text.
        text: String,
    },
    /// A feature of a kind that this proof does not follow.
    UnprovenFeature {
        /// Index of the feature in the part set.
        feature: u32,
    },
    /// A part that is placed beyond the board.
    OffBoard,
}

/// One failure: what, where, by how much.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Reason {
    /// Line of the program, where one is to blame.
    pub line: Option<u32>,
    /// Part index and address.
    pub part: Option<(u32, Address)>,
    /// Place in board coordinates, mm.
    pub at: Option<DVec3>,
    /// By how much, mm (degrees for a rotary axis; 0 where that has no meaning).
    pub by: f64,
    /// What.
    pub fault: Fault,
}

/// What was found of one program.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProgramVerdict {
    /// Its name.
    pub name: String,
    /// Its board.
    pub board: u32,
    /// Whether it may be run.
    pub passed: bool,
    /// Number of motions.
    pub motions: usize,
    /// Why not: by line, then by part.
    pub reasons: Vec<Reason>,
    /// Further reasons that are not listed.
    pub omitted: usize,
}

/// What was found of one part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartVerdict {
    /// Part index.
    pub part: u32,
    /// Board that it lies on.
    pub board: u32,
    /// Whether the program makes it.
    pub passed: bool,
    /// Largest depth of any cut into it, mm; an upper bound, exact where it exceeds the tolerance.
    pub gouge: f64,
    /// Line of that cut.
    pub gouge_line: Option<u32>,
    /// Point of that cut in board coordinates, mm.
    pub gouge_at: DVec3,
    /// Most stock left on any of its faces, along the face's normal, mm.
    pub leftover: f64,
    /// That face.
    pub leftover_face: Option<PartFace>,
    /// Point of that face in board coordinates, mm.
    pub leftover_at: DVec3,
}

/// The proof of all programs of a layout.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ProofReport {
    /// Per program, in the order given; then boards without one.
    pub programs: Vec<ProgramVerdict>,
    /// Per part of the set; `None` for a part that was not made or is not placed.
    pub parts: Vec<Option<PartVerdict>>,
}

impl ProofReport {
    /// Whether every program may be run.
    #[must_use]
    pub fn passed(&self) -> bool {
        self.programs.iter().all(|p| p.passed)
    }

    /// Largest gouge of all parts, mm.
    #[must_use]
    pub fn gouge(&self) -> f64 {
        self.parts.iter().flatten().map(|p| p.gouge).fold(0.0, f64::max)
    }

    /// Largest leftover of all parts, mm.
    #[must_use]
    pub fn leftover(&self) -> f64 {
        self.parts.iter().flatten().map(|p| p.leftover).fold(0.0, f64::max)
    }
}

impl fmt::Display for PartFace {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Front => f.write_str("front"),
            Self::Back => f.write_str("back"),
            Self::Edge(k) => write!(f, "chamfer of edge {k}"),
            Self::Node(k) => write!(f, "node facet {k}"),
        }
    }
}

impl fmt::Display for Body {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Cutter => "cutter",
            Self::Shank => "shank",
            Self::Holder => "holder",
            Self::Spindle => "spindle",
        })
    }
}

impl fmt::Display for Obstacle {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stock => f.write_str("the stock"),
            Self::Sacrificial => f.write_str("the sacrificial layer"),
            Self::Table => f.write_str("the table"),
            Self::Clamp(name) => write!(f, "clamp \"{name}\""),
        }
    }
}

impl fmt::Display for Reason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let Some(line) = self.line {
            write!(f, "line {line}: ")?;
        }
        if let Some((_, address)) = &self.part {
            write!(f, "part {address}: ")?;
        }
        let by = self.by;
        match &self.fault {
            Fault::Unreadable(problem) => f.write_str(problem)?,
            Fault::NoProgram => f.write_str("parts lie on this board, but it has no program")?,
            Fault::FirstMove => {
                write!(
                    f,
                    "the first position lies {by:.3} mm below the top of stock and clamps, or is reached at feed"
                )?;
            }
            Fault::ToolChange => write!(f, "the tool is changed {by:.3} mm below the top of stock and clamps")?,
            Fault::UnknownTool(number) => write!(f, "tool T{number} is not in the tool table")?,
            Fault::SpindleStopped => f.write_str("a move at feed while the spindle stands")?,
            Fault::Speed { programmed, table } => {
                write!(f, "the spindle turns at {programmed} 1/min, the tool table says {table}")?;
            }
            Fault::Limit { axis, value, min, max } => {
                write!(f, "axis {axis} would go to {value:.3}, it reaches from {min} to {max}")?;
            }
            Fault::DrillSideways => f.write_str("a drill is moved sideways in the stock")?,
            Fault::Collision { rapid, body, obstacle } => {
                let how = if *rapid { "in a rapid move " } else { "" };
                write!(f, "{how}the {body} enters {obstacle} by {by:.3} mm")?;
            }
            Fault::Gouge => write!(f, "cut {by:.3} mm into the part")?,
            Fault::Leftover(face) => write!(f, "{by:.3} mm of stock are left on the {face}")?,
            Fault::MissingHole { diameter, depth, .. } => {
                write!(f, "the hole of {diameter} mm is not drilled to {depth:.3} mm: {by:.3} mm are missing")?;
            }
            Fault::MissingEngraving { text, .. } => {
                write!(f, "{by:.3} mm of a stroke of \"{text}\" are not engraved")?;
            }
            Fault::UnprovenFeature { feature } => write!(f, "feature {feature} is of a kind that is not proven")?,
            Fault::OffBoard => write!(f, "lies {by:.3} mm beyond the board")?,
        }
        match self.at {
            Some(p) => write!(f, " at ({:.3}, {:.3}, {:.3})", p.x, p.y, p.z),
            None => Ok(()),
        }
    }
}
