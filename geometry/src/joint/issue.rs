//! What can go wrong with fasteners, in data and in words.

/// A trouble with one edge or one fastener. Fatal ones leave the fastener out, on both panels.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum JointIssue {
    /// Reported: an edge is too short for two fasteners.
    #[error("panel {panel}, edge {edge}: {length:.1} mm of line are too short for two fasteners ({needed:.1} mm are needed); {}", if *.laid { "one is laid in the middle" } else { "none is laid" })]
    EdgeTooShort {
        /// Panel.
        panel: u32,
        /// Edge of the panel.
        edge: u32,
        /// Length of the fastener line, mm.
        length: f64,
        /// Length that would do for two, mm.
        needed: f64,
        /// Whether one fastener is laid in the middle.
        laid: bool,
    },
    /// Fatal: too little wood remains beside a hole, whatever its depth.
    #[error(
        "panel {panel}, edge {edge}, fastener {number}: {remains:.2} mm of wood would remain beside the hole of {diameter} mm, {cover} mm are asked for"
    )]
    ThinWood {
        /// Panel.
        panel: u32,
        /// Edge of the panel.
        edge: u32,
        /// Fastener along the edge, from 0.
        number: u32,
        /// Diameter of the hole, mm.
        diameter: f64,
        /// Wood that would remain, mm; negative: the hole breaks out.
        remains: f64,
        /// Wood asked for, mm.
        cover: f64,
    },
    /// Fatal: the hole is too deep for the panel.
    #[error(
        "panel {panel}, edge {edge}, fastener {number}: a hole {depth:.1} mm deep leaves less than {cover} mm of wood below it; up to {largest:.2} mm would work"
    )]
    TooDeep {
        /// Panel.
        panel: u32,
        /// Edge of the panel.
        edge: u32,
        /// Fastener along the edge, from 0.
        number: u32,
        /// Depth asked for (for toe fasteners the least), mm.
        depth: f64,
        /// Wood asked for, mm.
        cover: f64,
        /// Greatest depth that would work, mm.
        largest: f64,
    },
    /// Fatal: no fastener that is sold is short enough, or the given one is too long.
    #[error(
        "panel {panel}, edge {edge}, fastener {number}: a fastener of {length} mm is too long for its hole; up to {longest:.2} mm would work"
    )]
    TooLong {
        /// Panel of the head.
        panel: u32,
        /// Edge of the panel.
        edge: u32,
        /// Fastener along the edge, from 0.
        number: u32,
        /// Length asked for (or the shortest there is), mm.
        length: f64,
        /// Longest that would work, mm.
        longest: f64,
    },
    /// Fatal: the fastener runs along the chamfer instead of through it.
    #[error("panel {panel}, edge {edge}: the fastener crosses the chamfer at {:.1}°, at least {:.1}° are asked for", .angle.to_degrees(), .least.to_degrees())]
    AlongChamfer {
        /// First panel.
        panel: u32,
        /// Edge of the panel.
        edge: u32,
        /// Angle between fastener and chamfer, radians; negative: it would leave the wrong way.
        angle: f64,
        /// The least that is accepted, radians.
        least: f64,
    },
    /// Fatal: two holes come too close to each other in a panel; the later one is left out.
    #[error("panel {panel}: holes at its edges {} and {} come within {gap:.2} mm of each other, {cover} mm of wood are asked for; the one at edge {} is left out", .edges[0], .edges[1], .edges[1])]
    HolesMeet {
        /// Panel.
        panel: u32,
        /// Edges of the two holes.
        edges: [u32; 2],
        /// Wood between them, mm; negative: they meet.
        gap: f64,
        /// Wood asked for, mm.
        cover: f64,
    },
}

impl JointIssue {
    /// The panel and, where there is one, its edge.
    #[must_use]
    pub fn place(&self) -> (u32, Option<u32>) {
        match *self {
            Self::EdgeTooShort { panel, edge, .. }
            | Self::ThinWood { panel, edge, .. }
            | Self::TooDeep { panel, edge, .. }
            | Self::TooLong { panel, edge, .. }
            | Self::AlongChamfer { panel, edge, .. } => (panel, Some(edge)),
            Self::HolesMeet { panel, edges, .. } => (panel, Some(edges[1])),
        }
    }

    /// Whether a fastener was left out against the rule.
    #[must_use]
    pub fn is_fatal(&self) -> bool {
        !matches!(self, Self::EdgeTooShort { .. })
    }
}

/// A rule that no edge can follow.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FastenerError {
    /// A parameter is out of its range.
    #[error("{name} is {value}; it must be {range}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// An angle is out of its range.
    #[error("the {name} is {:.3}°; it must lie between {:.0}° and {:.0}°", .value.to_degrees(), .min.to_degrees(), .max.to_degrees())]
    Angle {
        /// Name of the parameter.
        name: &'static str,
        /// Its value, radians.
        value: f64,
        /// Lower bound, radians.
        min: f64,
        /// Upper bound, radians.
        max: f64,
    },
    /// The fastener is longer than its two holes.
    #[error("a fastener of {length} mm does not fit into holes of {} + {} mm", .depth[0], .depth[1])]
    PinTooLong {
        /// Length of the fastener, mm.
        length: f64,
        /// Depths of the two holes, mm.
        depth: [f64; 2],
    },
    /// An edge to be joined that the panel set does not have.
    #[error("there is no edge {edge} of a panel {panel}")]
    NoSuchEdge {
        /// Panel.
        panel: u32,
        /// Edge of the panel.
        edge: u32,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}
