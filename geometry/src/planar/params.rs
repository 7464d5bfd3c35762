//! What `planarize` may be told, what it answers, and why it may refuse.

use super::Planarity;
use crate::mesh::{Mesh, MeshError};
use thiserror::Error;

/// Whether the vertices along a line may move.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Rim {
    /// They stay, bit by bit.
    Fixed,
    /// They move like any other.
    Free,
}

/// What `planarize` may be told.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanarizeParams {
    /// Faces to make planar; `None`: all. Vertices of other faces alone never move.
    pub region: Option<Vec<u32>>,
    /// The vertices that the region shares with other faces.
    pub rim: Rim,
    /// The vertices on the mesh's border.
    pub border: Rim,
    /// Further vertices that must stay.
    pub fixed: Vec<u32>,
    /// A face is planar when no corner is farther than this from the plane of the other three (from the plane of least
    /// squares on n-gons), mm.
    pub threshold: f64,
    /// Greatest number of steps.
    pub iterations: u32,
    /// Weight of the squared displacements.
    pub closeness: f64,
    /// Weight of the squared bends of the displacements: how smoothly the mesh gives way. Displacements are compared,
    /// not positions, so folds that are meant stay.
    pub fairness: f64,
    /// No vertex moves farther than this many times the mean length of its edges. Planarity is a matter of the whole
    /// shape: the finer a mesh, the more edge lengths a smooth answer needs (a dome: half an edge at 8 × 8, 0.7 at
    /// 16 × 16, 2.5 at 32 × 32). With less, neighbours tilt against each other to win planarity, which
    /// `Planarized::fold_after` shows; allow more reach, or planarize before subdividing.
    pub reach: f64,
}

impl Default for PlanarizeParams {
    fn default() -> Self {
        Self {
            region: None,
            rim: Rim::Fixed,
            border: Rim::Free,
            fixed: Vec::new(),
            threshold: 1e-4,
            iterations: 100,
            closeness: 1.0,
            fairness: 10.0,
            reach: 1.0,
        }
    }
}

/// A planarized mesh and the account of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Planarized {
    /// The mesh; only points differ from the given one.
    pub mesh: Mesh,
    /// Whether all faces of the region are planar to the threshold.
    pub reached: bool,
    /// Greatest `Planarity::corner` in the region, mm.
    pub deviation: f64,
    /// The face that has it.
    pub worst_face: u32,
    /// All faces before.
    pub before: Planarity,
    /// All faces after.
    pub after: Planarity,
    /// Greatest distance that a vertex moved, mm.
    pub moved_max: f64,
    /// Root mean square of the distances over the vertices that were free to move, mm; 0 if there were none.
    pub moved_rms: f64,
    /// Greatest move over the mean length of the vertex' edges, to be read against `reach`.
    pub moved_edges: f64,
    /// Greatest angle between the normals of two neighbours before, radians.
    pub fold_before: f64,
    /// The same after: growth means that planarity was won by crumpling.
    pub fold_after: f64,
    /// Greatest turn of a face's normal, radians.
    pub turned: f64,
    /// Number of steps.
    pub iterations: u32,
    /// `deviation` before the first step and after each, mm.
    pub history: Vec<f64>,
}

/// Why a mesh was not planarized.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum PlanarizeError {
    /// The mesh itself is broken.
    #[error(transparent)]
    Mesh(#[from] MeshError),
    /// A parameter is out of range.
    #[error("{name} is {value}, it must be {range}")]
    BadParameter {
        /// Its name.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it may be, in words.
        range: &'static str,
    },
    /// The region or the fixed vertices name something that does not exist.
    #[error("there is no {what} {index}, the mesh has {count}")]
    NoSuch {
        /// "face" or "vertex".
        what: &'static str,
        /// The index.
        index: u32,
        /// How many there are.
        count: usize,
    },
    /// A face has no normal, so nothing says what planar means there.
    #[error("face {face} has no area and cannot be planarized")]
    NoArea {
        /// The face.
        face: u32,
    },
    /// The caller cancelled.
    #[error("cancelled")]
    Cancelled,
}
