//! What can be wrong with a mesh, said with the faces, edges and vertices that are to blame.

use thiserror::Error;

/// A mesh that cannot be worked on. Faces, corners and vertices are counted from 0.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum MeshError {
    /// `face_start` does not cut `face_vertices` into loops.
    #[error(
        "the mesh's face rows are broken at face {face}: its loop would run from {from} to {to} of {corners} corners"
    )]
    BrokenRows {
        /// Face whose row is broken.
        face: u32,
        /// Where its loop would start.
        from: u32,
        /// Where it would end.
        to: u32,
        /// Number of corners there are.
        corners: u32,
    },
    /// More corners or vertices than 32-bit indices can name.
    #[error("the mesh has {count} {what}, at most {limit} can be handled")]
    TooLarge {
        /// "corners" or "vertices".
        what: &'static str,
        /// How many there are.
        count: usize,
        /// How many there may be.
        limit: usize,
    },
    /// A face names a vertex that does not exist.
    #[error("face {face} uses vertex {vertex}, but the mesh has only {vertices} vertices")]
    NoSuchVertex {
        /// Face index.
        face: u32,
        /// The vertex index that it uses.
        vertex: u32,
        /// Number of vertices.
        vertices: u32,
    },
    /// A coordinate is NaN or infinite.
    #[error("vertex {vertex} has a coordinate that is no finite number")]
    NotFinite {
        /// Vertex index.
        vertex: u32,
    },
    /// A face of fewer than three corners.
    #[error("face {face} has {corners} corners, a face needs at least 3")]
    FewCorners {
        /// Face index.
        face: u32,
        /// Number of its corners.
        corners: u32,
    },
    /// A face passes the same vertex twice.
    #[error("face {face} passes vertex {vertex} twice")]
    RepeatedVertex {
        /// Face index.
        face: u32,
        /// The vertex.
        vertex: u32,
    },
    /// More than two faces share an edge.
    #[error("the edge between vertices {} and {} is shared by {} faces ({}); at most two may meet", .edge[0], .edge[1], .faces.len(), list(.faces))]
    NotManifold {
        /// The edge's vertices, the lower index first.
        edge: [u32; 2],
        /// All faces at the edge, ascending.
        faces: Vec<u32>,
    },
    /// Two neighbours run along their common edge in the same direction: one of them is turned over.
    #[error("faces {} and {} are oriented against each other along the edge {}-{}; orient the mesh first", .faces[0], .faces[1], .edge[0], .edge[1])]
    MixedOrientation {
        /// The edge as both faces run along it.
        edge: [u32; 2],
        /// The two faces, ascending.
        faces: [u32; 2],
    },
    /// No orientation can make all neighbours agree (a Möbius strip).
    #[error("the mesh has only one side: faces {} and {} cannot be oriented alike along the edge {}-{}", .faces[0], .faces[1], .edge[0], .edge[1])]
    OneSided {
        /// The edge where the contradiction shows, the lower index first.
        edge: [u32; 2],
        /// The two faces there, ascending.
        faces: [u32; 2],
    },
    /// A tolerance that is negative, NaN or infinite.
    #[error("a tolerance of {tolerance} mm makes no sense; it must be 0 or a positive number")]
    BadTolerance {
        /// The tolerance given, mm.
        tolerance: f64,
    },
    /// The caller cancelled the computation.
    #[error("cancelled")]
    Cancelled,
}

/// Names up to eight indices, for messages.
pub(crate) fn list(items: &[u32]) -> String {
    let mut words: Vec<String> = items.iter().take(8).map(u32::to_string).collect();
    if items.len() > 8 {
        words.push("…".into());
    }
    words.join(", ")
}
