//! One orientation for all: neighbours run along their common edge against each other, and fronts face as asked.

use super::adjacency::EdgePairs;
use super::{Mesh, MeshError};
use crate::shared::Shared;
use glam::DVec3;

/// Which side of a connected piece of mesh becomes its front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Front {
    /// As most of its faces lie already; at a tie as its first face lies. A consistent mesh stays as it is.
    AsGiven,
    /// The side whose mean normal leans towards this direction; at a tie (a closed body) as most faces lie.
    Facing(DVec3),
}

/// A consistently oriented mesh and what was turned.
#[derive(Clone, Debug, PartialEq)]
pub struct Oriented {
    /// The mesh. A turned face keeps its first vertex.
    pub mesh: Mesh,
    /// Faces that were turned over, ascending.
    pub flipped: Vec<u32>,
    /// Number of pieces that hang together by edges.
    pub pieces: u32,
}

/// Turns faces over until all neighbours agree. Addresses go with their faces, unless one was turned: then the side
/// order of its loop is lost and the addresses are dropped. O(n log k) as [`super::Adjacency::new`].
///
/// # Errors
/// Any of [`Mesh::check_structure`], `NotManifold`, and `OneSided` for a mesh that cannot be oriented.
pub fn orient(mesh: &Mesh, front: Front) -> Result<Oriented, MeshError> {
    mesh.check_structure()?;
    let pairs = EdgePairs::new(mesh)?;
    let faces = mesh.face_count();
    // 0: not seen, else 1 + (turned relative to the first face of its piece).
    let mut state = vec![0u8; faces];
    let mut flip = vec![false; faces];
    let mut pieces = 0;
    let mut piece: Vec<u32> = Vec::new();
    for seed in 0..faces {
        if state[seed] != 0 {
            continue;
        }
        pieces += 1;
        piece.clear();
        piece.push(seed as u32);
        state[seed] = 1;
        let mut next = 0;
        while next < piece.len() {
            let f = piece[next];
            next += 1;
            for c in mesh.face_start[f as usize]..mesh.face_start[f as usize + 1] {
                let t = pairs.twin[c as usize];
                if t == u32::MAX {
                    continue;
                }
                let g = pairs.face[t as usize];
                let turned = (state[f as usize] == 2) == pairs.opposite[c as usize];
                let expected = 1 + u8::from(turned);
                if state[g as usize] == 0 {
                    state[g as usize] = expected;
                    piece.push(g);
                } else if state[g as usize] != expected {
                    let mut edge = [mesh.face_vertices[c as usize], mesh.face_vertices[pairs.next(mesh, c) as usize]];
                    let mut at = [f, g];
                    edge.sort_unstable();
                    at.sort_unstable();
                    return Err(MeshError::OneSided { edge, faces: at });
                }
            }
        }
        let turned = piece.iter().filter(|&&f| state[f as usize] == 2).count();
        let mut turn_first = 2 * turned > piece.len();
        if let Front::Facing(direction) = front {
            // In index order, so that the sum does not depend on the path of the search.
            piece.sort_unstable();
            let lean: f64 = piece
                .iter()
                .map(|&f| {
                    let area = mesh.face_area_vector(f as usize).dot(direction);
                    if state[f as usize] == 2 { -area } else { area }
                })
                .sum();
            let size: f64 = piece.iter().map(|&f| mesh.face_area_vector(f as usize).length()).sum();
            if lean.abs() > 1e-9 * size * direction.length() {
                turn_first = lean < 0.0;
            }
        }
        for &f in &piece {
            flip[f as usize] = (state[f as usize] == 2) != turn_first;
        }
    }
    let mut out = mesh.clone();
    let vertices = out.face_vertices.to_mut();
    for (f, _) in flip.iter().enumerate().filter(|(_, flip)| **flip) {
        let loop_ = mesh.face_start[f] as usize..mesh.face_start[f + 1] as usize;
        vertices[loop_][1..].reverse();
    }
    let flipped: Vec<u32> = (0..faces as u32).filter(|&f| flip[f as usize]).collect();
    if !flipped.is_empty() {
        out.addresses = Shared::default();
    }
    Ok(Oriented { mesh: out, flipped, pieces })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Adjacency;
    use proptest::prelude::*;

    fn strip(n: u32) -> Mesh {
        let points =
            (0..2 * n + 2).map(|i| DVec3::new(f64::from(i / 2), f64::from(i % 2), f64::from(i / 2 % 3))).collect();
        let faces: Vec<[u32; 4]> = (0..n).map(|i| [2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1]).collect();
        Mesh::from_faces(points, &faces)
    }

    #[test]
    fn the_minority_is_turned() {
        let mut mesh = strip(5);
        mesh.face_vertices.to_mut()[8..12].reverse();
        assert!(matches!(Adjacency::new(&mesh), Err(MeshError::MixedOrientation { edge: _, faces: [1, 2] })));
        let oriented = orient(&mesh, Front::AsGiven).unwrap();
        assert_eq!((oriented.flipped, oriented.pieces), (vec![2], 1));
        assert!(Adjacency::new(&oriented.mesh).is_ok());
    }

    #[test]
    fn a_moebius_strip_has_one_side() {
        let mut mesh = strip(5);
        let last = mesh.face_vertices.len() - 4;
        mesh.face_vertices.to_mut()[last + 1] = 1;
        mesh.face_vertices.to_mut()[last + 2] = 0;
        assert!(matches!(orient(&mesh, Front::AsGiven), Err(MeshError::OneSided { .. })));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn any_flips_come_out_alike_when_the_front_is_said(flips in prop::collection::vec(any::<bool>(), 12)) {
            let straight = strip(12);
            let mut mesh = straight.clone();
            for (f, _) in flips.iter().enumerate().filter(|(_, flip)| **flip) {
                mesh.face_vertices.to_mut()[4 * f + 1..4 * f + 4].reverse();
            }
            let up = orient(&mesh, Front::Facing(DVec3::Z)).unwrap();
            prop_assert_eq!(&up.mesh.face_vertices, &straight.face_vertices);
            let down = orient(&mesh, Front::Facing(-DVec3::Z)).unwrap();
            prop_assert_eq!(up.flipped.len() + down.flipped.len(), 12);
        }
    }
}
