//! What can go wrong when faces become panels, in data and in words.

use crate::mesh::MeshError;

/// A trouble with one face. Fatal ones leave the panel empty at its index, the others are reported only.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PanelIssue {
    /// Fatal: the face's corners enclose no area.
    #[error("face {face} has no area")]
    NoArea {
        /// Mesh face.
        face: u32,
    },
    /// Fatal: an edge is shorter than the distance within which points count as one.
    #[error("face {face}, edge {edge}: only {length} mm long (corners closer than {merge} mm count as one)")]
    ShortEdge {
        /// Mesh face.
        face: u32,
        /// Edge of the face.
        edge: u32,
        /// Its length, mm.
        length: f64,
        /// The limit, mm.
        merge: f64,
    },
    /// Fatal: the face is concave or straight at a corner.
    #[error("face {face} is not convex at corner {corner}: the outline turns by {:.4}°, it must turn by more than {:.4}°", .turn.to_degrees(), .least.to_degrees())]
    Concave {
        /// Mesh face.
        face: u32,
        /// Corner of the face.
        corner: u32,
        /// Turn of the outline at that corner, radians; negative: concave.
        turn: f64,
        /// The least turn that is accepted, radians.
        least: f64,
    },
    /// Fatal: the outline crosses itself, although it turns the same way at every corner.
    #[error("face {face} crosses itself: its outline goes round {turns} times")]
    CrossesItself {
        /// Mesh face.
        face: u32,
        /// How often the outline goes round.
        turns: u32,
    },
    /// Fatal: an edge leaves the fitted plane too steeply, although its ends are near it.
    #[error("face {face}, edge {edge}: the edge leaves the face's fitted plane at {:.3}°, at most {:.3}° can be chamfered; planarize the mesh or weld the edge", .slope.to_degrees(), .most.to_degrees())]
    Slope {
        /// Mesh face.
        face: u32,
        /// Edge of the face.
        edge: u32,
        /// Angle between the edge and the fitted plane, radians.
        slope: f64,
        /// The greatest that is accepted, radians.
        most: f64,
    },
    /// Fatal: the face is too far from planar.
    #[error(
        "face {face} is not planar: a corner lies {mismatch:.6} mm off the fitted plane, up to {tolerance} mm would be projected; planarize the mesh first"
    )]
    NotPlanar {
        /// Mesh face.
        face: u32,
        /// Greatest distance of a corner from the fitted plane, mm.
        mismatch: f64,
        /// The greatest that is accepted, mm.
        tolerance: f64,
    },
    /// Reported: the face was projected to its fitted plane.
    #[error(
        "face {face} was made planar: its corners moved by up to {moved:.6} mm (out of plane by {mismatch:.6} mm), so it meets its neighbours with a step of that size"
    )]
    Projected {
        /// Mesh face.
        face: u32,
        /// Greatest distance of a corner from the fitted plane, mm.
        mismatch: f64,
        /// Greatest distance between a mesh vertex and its panel corner, mm.
        moved: f64,
    },
    /// Reported: a node of many panels is so sharp that no cone around it parts them all; they may overlap there.
    #[error("the panels of faces {faces:?} may overlap behind vertex {vertex}: the node is too sharp to be voided")]
    SharpNode {
        /// Mesh vertex.
        vertex: u32,
        /// Faces around it, ascending.
        faces: Vec<u32>,
    },
    /// Fatal: two faces are folded back onto each other.
    #[error("face {face}, edge {edge}: the fold to face {neighbour} is {:.3}°, at most {:.3}° can be chamfered", .angle.to_degrees(), .most.to_degrees())]
    Fold {
        /// Mesh face.
        face: u32,
        /// Edge of the face.
        edge: u32,
        /// Face across the edge.
        neighbour: u32,
        /// Angle between the normals, radians.
        angle: f64,
        /// The greatest that is accepted, radians.
        most: f64,
    },
    /// Fatal: a border cut lies nearly in the face, because its limit plane is nearly parallel to the face or because
    /// the given angle is too large.
    #[error("face {face}, edge {edge}: the border cut leans {:.3}° from square (90° is parallel to the face), at most {:.3}° can be cut", .lean.to_degrees(), .most.to_degrees())]
    BorderLean {
        /// Mesh face.
        face: u32,
        /// Edge of the face.
        edge: u32,
        /// Angle of the cut from square, radians.
        lean: f64,
        /// The greatest that is accepted, radians.
        most: f64,
    },
    /// Fatal: the chamfers meet before they reach the back, an edge of the back face vanishes or turns round.
    #[error(
        "face {face}, edge {edge}: at thickness {thickness} mm the back edge would be {length:.4} mm long; a thickness below {largest:.4} mm works"
    )]
    OffsetFlips {
        /// Mesh face.
        face: u32,
        /// The edge of the face that limits the thickness most.
        edge: u32,
        /// Length of that edge's back edge along the front edge, mm; zero or negative.
        length: f64,
        /// Wanted thickness, mm.
        thickness: f64,
        /// Thickness at which the first back edge of this face vanishes, mm.
        largest: f64,
    },
}

impl PanelIssue {
    /// The mesh face, which is also the panel index; for a node the first of its faces.
    #[must_use]
    pub fn face(&self) -> u32 {
        match self {
            Self::SharpNode { faces, .. } => faces.first().copied().unwrap_or(0),
            Self::NoArea { face }
            | Self::ShortEdge { face, .. }
            | Self::Concave { face, .. }
            | Self::CrossesItself { face, .. }
            | Self::Slope { face, .. }
            | Self::NotPlanar { face, .. }
            | Self::Projected { face, .. }
            | Self::Fold { face, .. }
            | Self::BorderLean { face, .. }
            | Self::OffsetFlips { face, .. } => *face,
        }
    }

    /// Whether the panel could not be made.
    #[must_use]
    pub fn is_fatal(&self) -> bool {
        !matches!(self, Self::Projected { .. } | Self::SharpNode { .. })
    }
}

/// A reason why no panel at all can be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ThickenError {
    /// The thickness is not a positive number.
    #[error("the thickness must be a positive number of millimetres, not {0}")]
    Thickness(f64),
    /// Another parameter is out of its range.
    #[error("{name} is {value}; it must be {range}")]
    Parameter {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be.
        range: &'static str,
    },
    /// The mesh itself is broken, not manifold or not consistently oriented.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A border cut is given for an edge that is no border edge.
    #[error("a border cut is given for face {face}, edge {edge}, which is no border edge")]
    NoBorderEdge {
        /// Mesh face.
        face: u32,
        /// Edge of the face.
        edge: u32,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}
