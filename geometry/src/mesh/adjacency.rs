//! Who meets whom: the half-edge twin table of a mesh and the corners around each vertex, both as flat columns.

use super::{Mesh, MeshError};
use crate::shared::Shared;

const NONE: u32 = u32::MAX;

/// Neighbours of a manifold, consistently oriented polygon mesh. A *corner* is an index into `Mesh::face_vertices`; its
/// edge runs from its vertex to the vertex of the next corner of the same face. Inner edges have two corners, twins,
/// that run against each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Adjacency {
    twin: Vec<u32>,
    face: Vec<u32>,
    start: Shared<u32>,
    fan_start: Vec<u32>,
    fan: Vec<u32>,
}

impl Adjacency {
    /// Builds the tables. Time O(n log k) for n corners and at most k edges at a vertex, memory O(n).
    ///
    /// # Errors
    /// Any of [`Mesh::check_structure`]; `NotManifold` where more than two faces share an edge; `MixedOrientation`
    /// where two neighbours run along their edge in the same direction (see `orient`).
    pub fn new(mesh: &Mesh) -> Result<Self, MeshError> {
        mesh.check_structure()?;
        let pairs = EdgePairs::new(mesh)?;
        if let Some(c) = (0..pairs.twin.len()).find(|&c| pairs.twin[c] != NONE && !pairs.opposite[c]) {
            let t = pairs.twin[c] as usize;
            let mut faces = [pairs.face[c], pairs.face[t]];
            faces.sort_unstable();
            let edge = [mesh.face_vertices[c], mesh.face_vertices[pairs.next(mesh, c as u32) as usize]];
            return Err(MeshError::MixedOrientation { edge, faces });
        }
        let (fan_start, fan) = corners_by_vertex(mesh);
        Ok(Self { twin: pairs.twin, face: pairs.face, start: mesh.face_start.clone(), fan_start, fan })
    }

    /// The corner across the edge of `corner`, in the neighbouring face; `None` on the border. O(1).
    #[must_use]
    pub fn twin(&self, corner: u32) -> Option<u32> {
        let t = self.twin[corner as usize];
        (t != NONE).then_some(t)
    }

    /// The face that `corner` belongs to. O(1).
    #[must_use]
    pub fn face_of(&self, corner: u32) -> u32 {
        self.face[corner as usize]
    }

    /// The next corner counter-clockwise in the same face. O(1).
    #[must_use]
    pub fn next(&self, corner: u32) -> u32 {
        let f = self.face_of(corner) as usize;
        if corner + 1 == self.start[f + 1] { self.start[f] } else { corner + 1 }
    }

    /// The corner before, in the same face. O(1).
    #[must_use]
    pub fn previous(&self, corner: u32) -> u32 {
        let f = self.face_of(corner) as usize;
        if corner == self.start[f] { self.start[f + 1] - 1 } else { corner - 1 }
    }

    /// The corners of face `f`, counter-clockwise. O(1).
    #[must_use]
    pub fn corners(&self, f: u32) -> std::ops::Range<u32> {
        self.start[f as usize]..self.start[f as usize + 1]
    }

    /// The face across edge `edge` of face `f`; `None` on the border. On an ordered grid edge 0 is the bottom, 1 the right,
    /// 2 the top, 3 the left one. O(1).
    #[must_use]
    pub fn neighbour(&self, f: u32, edge: u32) -> Option<u32> {
        self.twin(self.corners(f).start + edge).map(|t| self.face_of(t))
    }

    /// The neighbours of face `f`, one per edge, in the order of its corners; `None` on the border.
    pub fn neighbours(&self, f: u32) -> impl Iterator<Item = Option<u32>> + '_ {
        self.corners(f).map(|c| self.twin(c).map(|t| self.face_of(t)))
    }

    /// All corners whose vertex is `vertex`, ascending (so: by face), not turning around the vertex. O(1).
    #[must_use]
    pub fn corners_at(&self, vertex: u32) -> &[u32] {
        let v = vertex as usize;
        &self.fan[self.fan_start[v] as usize..self.fan_start[v + 1] as usize]
    }

    /// One corner per edge, ascending: of two twins the lower.
    pub fn edges(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.twin.len() as u32).filter(|&c| self.twin[c as usize] >= c)
    }

    /// The corners whose edges lie on the border, ascending.
    pub fn border(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.twin.len() as u32).filter(|&c| self.twin[c as usize] == NONE)
    }

    /// Number of faces.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.start.len().saturating_sub(1)
    }
}

/// Corners paired along their edges, whichever way they run: what orientation starts from.
pub(crate) struct EdgePairs {
    /// Partner of each corner, `u32::MAX` on the border.
    pub twin: Vec<u32>,
    /// Whether the partner runs the other way, as it should.
    pub opposite: Vec<bool>,
    /// Face of each corner.
    pub face: Vec<u32>,
}

impl EdgePairs {
    /// Pairs the corners of a mesh that has passed `check_structure`; an edge of three or more faces is an error.
    pub fn new(mesh: &Mesh) -> Result<Self, MeshError> {
        let n = mesh.face_vertices.len();
        let mut face = Vec::with_capacity(n);
        for f in 0..mesh.face_count() {
            face.resize(mesh.face_start[f + 1] as usize, f as u32);
        }
        let mut pairs = Self { twin: vec![NONE; n], opposite: vec![false; n], face };
        // Edges are sorted into buckets by their lower vertex; within a bucket equal edges become neighbours.
        let ends = |c: u32| {
            let (a, b) = (mesh.face_vertices[c as usize], mesh.face_vertices[pairs.next(mesh, c) as usize]);
            (a.min(b), a.max(b))
        };
        let mut bucket_start = vec![0u32; mesh.points.len() + 1];
        for c in 0..n as u32 {
            bucket_start[ends(c).0 as usize + 1] += 1;
        }
        for v in 0..mesh.points.len() {
            bucket_start[v + 1] += bucket_start[v];
        }
        let mut fill = bucket_start.clone();
        let mut bucket = vec![(0u32, 0u32); n];
        for c in 0..n as u32 {
            let (low, high) = ends(c);
            let slot = &mut fill[low as usize];
            bucket[*slot as usize] = (high, c);
            *slot += 1;
        }
        for low in 0..mesh.points.len() {
            let edges = &mut bucket[bucket_start[low] as usize..bucket_start[low + 1] as usize];
            edges.sort_unstable();
            for same in edges.chunk_by(|x, y| x.0 == y.0) {
                match *same {
                    [_] => {}
                    [(_, c), (_, d)] => {
                        let opposite = mesh.face_vertices[c as usize] != mesh.face_vertices[d as usize];
                        for (c, d) in [(c, d), (d, c)] {
                            pairs.twin[c as usize] = d;
                            pairs.opposite[c as usize] = opposite;
                        }
                    }
                    _ => {
                        let faces = same.iter().map(|&(_, c)| pairs.face[c as usize]).collect();
                        return Err(MeshError::NotManifold { edge: [low as u32, same[0].0], faces });
                    }
                }
            }
        }
        Ok(pairs)
    }

    pub fn next(&self, mesh: &Mesh, corner: u32) -> u32 {
        let f = self.face[corner as usize] as usize;
        if corner + 1 == mesh.face_start[f + 1] { mesh.face_start[f] } else { corner + 1 }
    }
}

/// Compressed rows vertex → corners, ascending.
fn corners_by_vertex(mesh: &Mesh) -> (Vec<u32>, Vec<u32>) {
    let mut start = vec![0u32; mesh.points.len() + 1];
    for &v in &mesh.face_vertices {
        start[v as usize + 1] += 1;
    }
    for v in 0..mesh.points.len() {
        start[v + 1] += start[v];
    }
    let mut fill = start.clone();
    let mut fan = vec![0u32; mesh.face_vertices.len()];
    for (c, &v) in mesh.face_vertices.iter().enumerate() {
        let slot = &mut fill[v as usize];
        fan[*slot as usize] = c as u32;
        *slot += 1;
    }
    (start, fan)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    fn points(n: usize) -> Vec<DVec3> {
        (0..n).map(|i| DVec3::new(i as f64, (i * i) as f64, 0.0)).collect()
    }

    #[test]
    fn two_quads_share_one_edge() {
        let mesh = Mesh::from_faces(points(6), &[[0, 1, 4, 3], [1, 2, 5, 4]]);
        let a = Adjacency::new(&mesh).unwrap();
        assert_eq!(a.twin(1), Some(7));
        assert_eq!(a.twin(7), Some(1));
        assert_eq!(a.border().count(), 6);
        assert_eq!(a.edges().count(), 7);
        assert_eq!(a.neighbours(0).collect::<Vec<_>>(), [None, Some(1), None, None]);
        assert_eq!((a.neighbour(0, 1), a.neighbour(1, 3), a.neighbour(0, 0)), (Some(1), Some(0), None));
        assert_eq!(a.corners_at(4), [2, 7]);
        for c in 0..8 {
            assert_eq!(a.previous(a.next(c)), c);
            assert_eq!(a.face_of(a.next(c)), a.face_of(c));
        }
    }

    #[test]
    fn three_faces_at_an_edge_are_named() {
        let mesh = Mesh::from_faces(points(5), &[[0, 1, 2], [1, 0, 3], [0, 1, 4]]);
        let error = Adjacency::new(&mesh).unwrap_err();
        assert_eq!(error, MeshError::NotManifold { edge: [0, 1], faces: vec![0, 1, 2] });
        assert_eq!(
            error.to_string(),
            "the edge between vertices 0 and 1 is shared by 3 faces (0, 1, 2); at most two may meet"
        );
    }

    #[test]
    fn a_face_turned_over_is_named() {
        let mesh = Mesh::from_faces(points(4), &[[0, 1, 2], [0, 1, 3]]);
        assert_eq!(Adjacency::new(&mesh).unwrap_err(), MeshError::MixedOrientation { edge: [0, 1], faces: [0, 1] });
    }

    #[test]
    fn broken_meshes_are_refused() {
        let refuse = |mesh: &Mesh| Adjacency::new(mesh).unwrap_err();
        let mut mesh = Mesh::from_faces(points(3), &[[0, 1, 7]]);
        assert_eq!(refuse(&mesh), MeshError::NoSuchVertex { face: 0, vertex: 7, vertices: 3 });
        mesh.face_vertices.to_mut()[2] = 1;
        assert_eq!(refuse(&mesh), MeshError::RepeatedVertex { face: 0, vertex: 1 });
        mesh.face_vertices.to_mut()[2] = 2;
        mesh.points.to_mut()[1].y = f64::NAN;
        assert_eq!(refuse(&mesh), MeshError::NotFinite { vertex: 1 });
        mesh.points.to_mut()[1].y = f64::INFINITY;
        assert_eq!(refuse(&mesh), MeshError::NotFinite { vertex: 1 });
        mesh.points.to_mut()[1].y = 0.0;
        mesh.face_start = vec![0, 2, 3].into();
        assert_eq!(refuse(&mesh), MeshError::FewCorners { face: 0, corners: 2 });
        mesh.face_start = vec![0, 9].into();
        assert_eq!(refuse(&mesh), MeshError::BrokenRows { face: 0, from: 0, to: 9, corners: 3 });
        mesh.face_start = vec![].into();
        assert!(matches!(refuse(&mesh), MeshError::BrokenRows { .. }));
        assert!(Adjacency::new(&Mesh::default()).is_ok());
    }
}
