//! Welding: vertices that lie within a tolerance become one, so that faces which touch also share vertices.

use super::{Mesh, MeshError};
use glam::DVec3;

const NONE: u32 = u32::MAX;

/// A welded mesh and what was done to it.
#[derive(Clone, Debug, PartialEq)]
pub struct Welded {
    /// The mesh; vertices keep their order, positions of kept vertices are bitwise those of the input.
    pub mesh: Mesh,
    /// New index of every input vertex.
    pub vertex: Vec<u32>,
    /// Input index of every remaining face.
    pub face: Vec<u32>,
    /// Number of vertices that were merged into another one.
    pub merged: usize,
    /// The greatest distance between a merged vertex and the one that it became, mm; at most the tolerance.
    pub moved: f64,
    /// Input faces that were left with fewer than three corners and so dropped, ascending.
    pub collapsed: Vec<u32>,
}

/// Merges vertices that lie within `tolerance` mm of each other (0: only equal positions).
///
/// In index order each vertex becomes the nearest kept vertex within the tolerance or else is kept itself. So kept
/// vertices are more than the tolerance apart, no vertex moves farther than the tolerance (there are no chains), and
/// welding twice changes nothing. Corners of a loop that fall together become one; faces left with fewer than three
/// are dropped and named. O(vertices + corners) by a hash grid: a cell can hold only so many kept vertices.
///
/// # Errors
/// `BadTolerance`; `TooLarge`, `NotFinite`, `BrokenRows`, `NoSuchVertex` as in [`Mesh::check_structure`].
pub fn weld(mesh: &Mesh, tolerance: f64) -> Result<Welded, MeshError> {
    if !(tolerance >= 0.0 && tolerance.is_finite()) {
        return Err(MeshError::BadTolerance { tolerance });
    }
    mesh.check_rows()?;
    let mut grid = Grid::new(mesh.points.len(), tolerance);
    let mut vertex = Vec::with_capacity(mesh.points.len());
    let mut moved = 0.0f64;
    for &p in &mesh.points {
        let (kept, distance) = grid.find_or_keep(p);
        moved = moved.max(distance);
        vertex.push(kept);
    }
    let merged = mesh.points.len() - grid.kept.len();

    let addressed = mesh.addresses.len() == mesh.face_count();
    let (mut face_start, mut face_vertices, mut addresses) = (vec![0], Vec::new(), Vec::new());
    let (mut face, mut collapsed) = (Vec::with_capacity(mesh.face_count()), Vec::new());
    for f in 0..mesh.face_count() {
        let from = face_vertices.len();
        for &v in mesh.face(f) {
            let v = vertex[v as usize];
            if face_vertices.len() == from || face_vertices.last() != Some(&v) {
                face_vertices.push(v);
            }
        }
        while face_vertices.len() > from + 1 && face_vertices.last() == Some(&face_vertices[from]) {
            face_vertices.pop();
        }
        if face_vertices.len() < from + 3 {
            face_vertices.truncate(from);
            collapsed.push(f as u32);
            continue;
        }
        face_start.push(face_vertices.len() as u32);
        face.push(f as u32);
        if addressed {
            addresses.push(mesh.addresses[f]);
        }
    }
    let (points, addresses) = (grid.kept.into(), addresses.into());
    let mesh = Mesh { points, face_start: face_start.into(), face_vertices: face_vertices.into(), addresses };
    Ok(Welded { mesh, vertex, face, merged, moved, collapsed })
}

/// Kept vertices in cells of twice the tolerance, chained per hash slot; no order of a hash map can leak out.
struct Grid {
    tolerance: f64,
    kept: Vec<DVec3>,
    slot: Vec<u32>,
    next: Vec<u32>,
}

impl Grid {
    fn new(capacity: usize, tolerance: f64) -> Self {
        let slots = (2 * capacity).next_power_of_two().max(16);
        Self { tolerance, kept: Vec::new(), slot: vec![NONE; slots], next: Vec::new() }
    }

    /// Index of the kept vertex that `p` becomes, and its distance.
    fn find_or_keep(&mut self, p: DVec3) -> (u32, f64) {
        let reach = DVec3::splat(self.tolerance);
        let (low, high) = (self.cell(p - reach), self.cell(p + reach));
        let mut best = (NONE, self.tolerance);
        let axis = |k: usize| [low[k], high[k]].into_iter().take(if low[k] == high[k] { 1 } else { 2 });
        for x in axis(0) {
            for y in axis(1) {
                for z in axis(2) {
                    let mut k = self.slot[self.hash([x, y, z])];
                    while k != NONE {
                        let distance = self.kept[k as usize].distance(p);
                        if distance < best.1 || (distance == best.1 && k < best.0) {
                            best = (k, distance);
                        }
                        k = self.next[k as usize];
                    }
                }
            }
        }
        if best.0 != NONE {
            return best;
        }
        let slot = self.hash(self.cell(p));
        let index = self.kept.len() as u32;
        self.kept.push(p);
        self.next.push(self.slot[slot]);
        self.slot[slot] = index;
        (index, 0.0)
    }

    fn cell(&self, p: DVec3) -> [u64; 3] {
        // Adding 0.0 makes -0.0 and 0.0 the same cell.
        let size = 2.0 * self.tolerance;
        p.to_array().map(|x| (if size > 0.0 { (x / size).floor() } else { x } + 0.0).to_bits())
    }

    fn hash(&self, cell: [u64; 3]) -> usize {
        let mut h = 0u64;
        for x in cell {
            h = (h.rotate_left(21) ^ x).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        }
        (h ^ (h >> 32)) as usize & (self.slot.len() - 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Adjacency;
    use proptest::prelude::*;

    #[test]
    fn loose_quads_become_neighbours() {
        let p = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let points = vec![p(0., 0.), p(1., 0.), p(1., 1.), p(0., 1.), p(1.0004, 0.), p(2., 0.), p(2., 1.), p(1., 1.)];
        let welded = weld(&Mesh::from_faces(points, &[[0, 1, 2, 3], [4, 5, 6, 7]]), 1e-3).unwrap();
        assert_eq!((welded.merged, welded.mesh.points.len()), (2, 6));
        assert!((welded.moved - 0.0004).abs() < 1e-12);
        assert_eq!(Adjacency::new(&welded.mesh).unwrap().neighbours(0).flatten().collect::<Vec<_>>(), [1]);
        assert_eq!(welded.vertex, [0, 1, 2, 3, 1, 4, 5, 2]);
    }

    #[test]
    fn collapsed_faces_are_named_and_the_rest_stays() {
        let p = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let points = vec![p(0., 0.), p(1., 0.), p(1., 1.), p(0., 1e-9), p(1e-9, 0.), p(-0.0, 0.)];
        let welded = weld(&Mesh::from_faces(points, &[[0, 3, 4, 5], [0, 1, 2, 3]]), 1e-6).unwrap();
        assert_eq!((welded.collapsed, welded.face), (vec![0], vec![1]));
        assert_eq!(welded.mesh.face(0), [0, 1, 2]);
    }

    #[test]
    fn zero_tolerance_merges_equal_positions_only() {
        let points = vec![DVec3::ZERO, -DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::X * 1e-300];
        let welded = weld(&Mesh::from_faces(points, &[[1, 2, 3], [4, 2, 3]]), 0.0).unwrap();
        assert_eq!((welded.merged, welded.moved), (1, 0.0));
    }

    #[test]
    fn a_senseless_tolerance_is_refused() {
        for tolerance in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(matches!(weld(&Mesh::default(), tolerance), Err(MeshError::BadTolerance { .. })));
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn welding_is_idempotent_and_moves_no_vertex_farther_than_the_tolerance(
            cloud in prop::collection::vec((-2.0..2.0f64, -2.0..2.0f64, -2.0..2.0f64), 3..120),
            tolerance in 0.0..1.5f64,
        ) {
            let points: Vec<DVec3> = cloud.into_iter().map(DVec3::from).collect();
            let faces: Vec<[u32; 3]> = (0..points.len() as u32 / 3).map(|f| [3 * f, 3 * f + 1, 3 * f + 2]).collect();
            let once = weld(&Mesh::from_faces(points.clone(), &faces), tolerance).unwrap();
            for (p, &v) in points.iter().zip(&once.vertex) {
                prop_assert!(p.distance(once.mesh.points[v as usize]) <= tolerance);
            }
            for (i, p) in once.mesh.points.iter().enumerate() {
                prop_assert!(once.mesh.points[..i].iter().all(|q| p.distance(*q) > tolerance));
            }
            let twice = weld(&once.mesh, tolerance).unwrap();
            prop_assert_eq!(twice.merged, 0);
            prop_assert_eq!(twice.mesh, once.mesh);
        }
    }
}
