//! Grid patches of a quad mesh: cut along the lines that leave irregular vertices, then walk each piece in rows.

use super::{Adjacency, Mesh};

/// How a grid patch closes on itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Closing {
    /// Four sides.
    Open,
    /// The last column meets the first: a ring with a seam between them.
    Columns,
    /// Rows and columns close: a torus with two seams.
    RowsAndColumns,
}

/// A rectangular patch of an ordered mesh: faces `first .. first + rows · columns`, row by row from the bottom.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Patch {
    /// First face.
    pub first: u32,
    /// Number of rows.
    pub rows: u32,
    /// Number of columns.
    pub columns: u32,
    /// How it closes.
    pub closing: Closing,
}

/// Corners whose edge bounds a patch: on the border, or on a line that leaves an irregular vertex. Irregular is an
/// inner vertex without exactly four edges and a border vertex with three or more faces. O(corners).
pub(crate) fn patch_bounds(mesh: &Mesh, adjacency: &Adjacency) -> Vec<bool> {
    let corners = mesh.face_vertices.len() as u32;
    let mut bound: Vec<bool> = (0..corners).map(|c| adjacency.twin(c).is_none()).collect();
    let mut irregular = vec![false; mesh.points.len()];
    let mut leaving = Vec::new();
    for (vertex, irregular) in irregular.iter_mut().enumerate() {
        let fan = adjacency.corners_at(vertex as u32);
        let rims = fan.iter().filter(|&&c| adjacency.twin(c).is_none()).count();
        let regular = match rims {
            0 => fan.len() == 4 || fan.is_empty(),
            1 => fan.len() <= 2,
            // Pieces that touch in one vertex: nothing runs straight through it.
            _ => false,
        };
        if !regular {
            *irregular = true;
            leaving.extend_from_slice(fan);
        }
    }
    for mut c in leaving {
        // Follow the line until it ends or meets a line that was followed before.
        while let Some(twin) = adjacency.twin(c) {
            if bound[c as usize] {
                break;
            }
            bound[c as usize] = true;
            bound[twin as usize] = true;
            if irregular[mesh.face_vertices[twin as usize] as usize] {
                // `twin` starts where `c` ends.
                break;
            }
            let turn = adjacency.next(c);
            let Some(across) = adjacency.twin(turn) else { break };
            c = adjacency.next(across);
        }
    }
    bound
}

/// Faces that hang together across edges that are no bounds; pieces by their lowest face, faces ascending.
pub(crate) fn pieces(adjacency: &Adjacency, bound: &[bool]) -> Vec<Vec<u32>> {
    let mut seen = vec![false; adjacency.face_count()];
    let mut pieces = Vec::new();
    for seed in 0..adjacency.face_count() {
        if std::mem::replace(&mut seen[seed], true) {
            continue;
        }
        let mut piece = vec![seed as u32];
        let mut next = 0;
        while next < piece.len() {
            for c in adjacency.corners(piece[next]) {
                if let Some(t) = adjacency.twin(c).filter(|_| !bound[c as usize]) {
                    let g = adjacency.face_of(t);
                    if !std::mem::replace(&mut seen[g as usize], true) {
                        piece.push(g);
                    }
                }
            }
            next += 1;
        }
        piece.sort_unstable();
        pieces.push(piece);
    }
    pieces
}

/// A piece walked in rows: the first corner (v1) of every face, row by row.
pub(crate) struct Walked {
    pub corners: Vec<u32>,
    pub rows: u32,
    pub columns: u32,
    pub closing: Closing,
}

/// Walks the piece of `faces` quads from the face that has `start` as its v1; `None` when its faces are no full
/// rectangle of rows from there. `visited` holds one `false` per face, before and after. O(faces).
pub(crate) fn walk(
    adjacency: &Adjacency,
    bound: &[bool],
    start: u32,
    faces: usize,
    visited: &mut [bool],
) -> Option<Walked> {
    let across = |edge: u32| adjacency.twin(edge).filter(|_| !bound[edge as usize]);
    // The right neighbour's left edge is the twin of our right edge; its v1 comes after it.
    let right = |c: u32| across(adjacency.next(c)).map(|t| adjacency.next(t));
    // The upper neighbour's bottom edge is the twin of our top edge and starts at its v1.
    let up = |c: u32| across(adjacency.next(adjacency.next(c)));

    let mut corners = Vec::with_capacity(faces);
    let mut row_start = start;
    let (mut columns, mut ring, mut rows, mut torus) = (0usize, false, 0u32, false);
    let full = loop {
        let from = corners.len();
        let mut c = row_start;
        let closed = loop {
            if corners.len() == faces {
                break None;
            }
            corners.push(c);
            match right(c) {
                None => break Some(false),
                Some(next) if next == row_start => break Some(true),
                Some(next) => c = next,
            }
        };
        let Some(closed) = closed else { break false };
        if rows == 0 {
            (columns, ring) = (corners.len(), closed);
        } else if corners.len() - from != columns || closed != ring {
            break false;
        }
        rows += 1;
        match up(row_start) {
            None => break true,
            Some(next) if next == start => {
                torus = true;
                break true;
            }
            Some(next) => row_start = next,
        }
    };
    // Every face once, and every row exactly above the row below it.
    let once = full && corners.len() == faces && {
        let fresh =
            corners.iter().filter(|&&c| !std::mem::replace(&mut visited[adjacency.face_of(c) as usize], true)).count();
        corners.iter().for_each(|&c| visited[adjacency.face_of(c) as usize] = false);
        fresh == faces
    };
    let aligned = || {
        (0..corners.len()).all(|k| {
            let above = if torus { Some((k + columns) % faces) } else { Some(k + columns).filter(|&a| a < faces) };
            up(corners[k]) == above.map(|a| corners[a])
        })
    };
    let closing = match (ring, torus) {
        (false, false) => Closing::Open,
        (true, false) => Closing::Columns,
        (true, true) => Closing::RowsAndColumns,
        // Started along the wrong side of a ring.
        (false, true) => return None,
    };
    (once && aligned()).then_some(Walked { corners, rows, columns: columns as u32, closing })
}
