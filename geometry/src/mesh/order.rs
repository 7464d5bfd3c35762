//! Order and address (000 §6.2.3, §6.2.4; METHODS §4): any soup of quads becomes rows and columns.

use super::patch::{Closing, Patch, Walked, patch_bounds, pieces, walk};
use super::{Address, Adjacency, Front, Mesh, MeshError, orient, weld};
use glam::DVec3;
use std::cmp::Ordering;

/// Which corner of a patch is its bottom left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Start {
    /// The corner with the least x + y + z (nearest to the lower end of the bounding box' diagonal). Of corners that
    /// tie within the welding tolerance: the least y, then x, then z.
    Lowest,
    /// The corner nearest to this point; ties as in `Lowest`.
    Near(DVec3),
}

/// What `order_faces` may be told.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrderParams {
    /// Vertices within this distance are one, mm.
    pub weld: f64,
    /// Which side is the front.
    pub front: Front,
    /// Where rows start.
    pub start: Start,
}

impl Default for OrderParams {
    fn default() -> Self {
        Self { weld: 1e-3, front: Front::AsGiven, start: Start::Lowest }
    }
}

/// Where the addresses of an ordered mesh come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OrderKind {
    /// The mesh brought its addresses; they stay.
    Kept,
    /// One rectangular grid.
    Grid,
    /// One grid that closes on itself, cut open at a seam.
    ClosedGrid,
    /// Several grid patches, between irregular vertices or loose from each other.
    Patches,
    /// No grid because of faces that are no quads: row 0, column = face index.
    PlainNotQuads,
    /// Quads that close on themselves askew (a twisted torus): row 0, column = face index.
    PlainNoRows,
}

/// Place of a face in the structure (000 §6.2.3), by the number of its neighbours on a plain grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FaceKind {
    /// Two border edges meet at one of its corners.
    Corner,
    /// It has a border edge.
    Border,
    /// It has a neighbour at every edge.
    Centre,
}

/// An ordered mesh.
#[derive(Clone, Debug, PartialEq)]
pub struct Ordered {
    /// The mesh: addressed, faces by (patch, row, column), every loop of a grid starting at its bottom left corner v1,
    /// counter-clockwise: edge 0 bottom, 1 right, 2 top, 3 left.
    pub mesh: Mesh,
    /// Its neighbours; that of face f at edge k is `adjacency.neighbour(f, k)`.
    pub adjacency: Adjacency,
    /// Where the addresses come from.
    pub kind: OrderKind,
    /// The grid patches; empty when plain or kept.
    pub patches: Vec<Patch>,
    /// Corner, border or centre per face.
    pub face_kind: Vec<FaceKind>,
    /// Input face of every face.
    pub source: Vec<u32>,
    /// New vertex of every input vertex.
    pub vertex: Vec<u32>,
    /// Number of vertices that welding merged.
    pub merged: usize,
    /// Input faces that welding collapsed and dropped.
    pub collapsed: Vec<u32>,
    /// Input faces that were turned over.
    pub flipped: Vec<u32>,
}

/// Welds, orients and orders a mesh. Rows run from the bottom left corner, see [`Start`]; it is the same corner for
/// any order of the faces, any rotation of the loops and any order of the vertices. With `Front::Facing` turned
/// loops do not matter either. The corner of a closed strip is the vertex of its rims that [`Start`] picks: there is the
/// seam, and columns run around. Patches are numbered by their bottom left corners in the same order. A mesh that
/// brings one different address per face keeps them, and its loops, as long as no face had to be turned. Linear in
/// the number of faces but for sorting patches.
///
/// # Errors
/// Those of [`weld`], [`orient`] and [`Adjacency::new`]; faults of single faces are left to `Mesh::face_faults`.
pub fn order_faces(mesh: &Mesh, params: &OrderParams) -> Result<Ordered, MeshError> {
    let welded = weld(mesh, params.weld)?;
    let oriented = orient(&welded.mesh, params.front)?;
    let flipped = oriented.flipped.iter().map(|&f| welded.face[f as usize]).collect();
    let soup = oriented.mesh;
    let adjacency = Adjacency::new(&soup)?;

    let grids = if is_addressed(&soup) {
        Err(OrderKind::Kept)
    } else if (0..soup.face_count()).any(|f| soup.face(f).len() != 4) {
        Err(OrderKind::PlainNotQuads)
    } else {
        find_grids(&soup, &adjacency, params).ok_or(OrderKind::PlainNoRows)
    };
    let (mesh, adjacency, patches, source, kind) = match grids {
        Ok(grids) => {
            let (mesh, patches, order) = lay_out(&soup, &adjacency, &grids);
            let kind = match patches.as_slice() {
                [one] if one.closing == Closing::Open => OrderKind::Grid,
                [_] => OrderKind::ClosedGrid,
                _ => OrderKind::Patches,
            };
            let adjacency = Adjacency::new(&mesh)?;
            (mesh, adjacency, patches, order.iter().map(|&f| welded.face[f as usize]).collect(), kind)
        }
        Err(kind) => {
            let mut mesh = soup;
            if kind != OrderKind::Kept {
                let columns = 0..mesh.face_count() as u32;
                mesh.addresses = columns.map(|column| Address { column, ..Address::default() }).collect();
            }
            (mesh, adjacency, Vec::new(), welded.face, kind)
        }
    };
    let face_kind = face_kinds(&mesh, &adjacency);
    let (vertex, merged, collapsed) = (welded.vertex, welded.merged, welded.collapsed);
    Ok(Ordered { mesh, adjacency, kind, patches, face_kind, source, vertex, merged, collapsed, flipped })
}

/// Whether every face has an address of its own.
fn is_addressed(mesh: &Mesh) -> bool {
    let mut addresses = mesh.addresses.to_vec();
    addresses.sort_unstable();
    addresses.dedup();
    !mesh.addresses.is_empty() && addresses.len() == mesh.face_count()
}

/// All pieces as walked grids, in patch order; `None` when one of them has no rows.
fn find_grids(mesh: &Mesh, adjacency: &Adjacency, params: &OrderParams) -> Option<Vec<Walked>> {
    let bound = patch_bounds(mesh, adjacency);
    let corner = CornerOrder { mesh, adjacency, start: params.start, tie: params.weld };
    let mut visited = vec![false; mesh.face_count()];
    let mut grids = Vec::new();
    for piece in pieces(adjacency, &bound) {
        let edges = || piece.iter().flat_map(|&f| adjacency.corners(f));
        let is_bound = |c: u32| bound[c as usize];
        // Rectangles start where two bounds meet, rings anywhere on a rim, tori anywhere.
        let mut starts: Vec<u32> = edges().filter(|&c| is_bound(c) && is_bound(adjacency.previous(c))).collect();
        if starts.is_empty() {
            starts = edges().filter(|&c| is_bound(c)).collect();
        }
        if starts.is_empty() {
            starts = edges().collect();
        }
        grids.push(walk(adjacency, &bound, corner.first(&starts)?, piece.len(), &mut visited)?);
    }
    grids.sort_by(|a, b| corner.compare(a.corners[0], b.corners[0]));
    Some(grids)
}

/// Faces in patch order, loops turned to their first corners. Returns the old index of each face as well.
fn lay_out(mesh: &Mesh, adjacency: &Adjacency, grids: &[Walked]) -> (Mesh, Vec<Patch>, Vec<u32>) {
    let faces = mesh.face_count();
    let (mut face_vertices, mut addresses) = (Vec::with_capacity(4 * faces), Vec::with_capacity(faces));
    let (mut patches, mut order) = (Vec::with_capacity(grids.len()), Vec::with_capacity(faces));
    for (patch, grid) in grids.iter().enumerate() {
        let (first, columns) = (order.len() as u32, grid.columns);
        patches.push(Patch { first, rows: grid.rows, columns, closing: grid.closing });
        for (k, &corner) in grid.corners.iter().enumerate() {
            let mut c = corner;
            for _ in 0..4 {
                face_vertices.push(mesh.face_vertices[c as usize]);
                c = adjacency.next(c);
            }
            let k = k as u32;
            addresses.push(Address { patch: patch as u32, row: k / columns, column: k % columns });
            order.push(adjacency.face_of(corner));
        }
    }
    let out = Mesh {
        points: mesh.points.clone(),
        face_start: (0..=faces as u32).map(|f| 4 * f).collect(),
        face_vertices: face_vertices.into(),
        addresses: addresses.into(),
    };
    (out, patches, order)
}

fn face_kinds(mesh: &Mesh, adjacency: &Adjacency) -> Vec<FaceKind> {
    let is_border = |c: u32| adjacency.twin(c).is_none();
    (0..mesh.face_count() as u32)
        .map(|f| {
            if adjacency.corners(f).any(|c| is_border(c) && is_border(adjacency.previous(c))) {
                FaceKind::Corner
            } else if adjacency.corners(f).any(is_border) {
                FaceKind::Border
            } else {
                FaceKind::Centre
            }
        })
        .collect()
}

/// Which of several corners rows should start from, by positions alone.
struct CornerOrder<'a> {
    mesh: &'a Mesh,
    adjacency: &'a Adjacency,
    start: Start,
    tie: f64,
}

impl CornerOrder<'_> {
    /// The bottom left corner of the candidates: one criterion after the other narrows them down.
    fn first(&self, candidates: &[u32]) -> Option<u32> {
        let mut left = candidates.to_vec();
        let criteria: [&dyn Fn(u32) -> f64; 7] = [
            &|c| self.key(self.at(c)),
            &|c| self.at(c).y,
            &|c| self.at(c).x,
            &|c| self.at(c).z,
            // One vertex, several faces: the bottom edge that runs most to the right.
            &|c| -self.edge(c).x,
            &|c| -self.edge(c).y,
            &|c| -self.edge(c).z,
        ];
        for criterion in criteria {
            let least = left.iter().map(|&c| criterion(c)).fold(f64::INFINITY, f64::min);
            left.retain(|&c| criterion(c) <= least + self.tie);
            if left.len() < 2 {
                break;
            }
        }
        left.first().copied()
    }

    /// A total order of corners by the same criteria without tolerance.
    fn compare(&self, c: u32, d: u32) -> Ordering {
        let rank = |c: u32| {
            let (p, e) = (self.at(c), self.edge(c));
            [self.key(p), p.y, p.x, p.z, -e.x, -e.y, -e.z]
        };
        rank(c).iter().zip(rank(d)).map(|(a, b)| a.total_cmp(&b)).find(|o| o.is_ne()).unwrap_or(c.cmp(&d))
    }

    fn key(&self, p: DVec3) -> f64 {
        match self.start {
            Start::Lowest => p.element_sum(),
            Start::Near(target) => p.distance(target),
        }
    }

    fn at(&self, c: u32) -> DVec3 {
        self.mesh.points[self.mesh.face_vertices[c as usize] as usize]
    }

    fn edge(&self, c: u32) -> DVec3 {
        self.at(self.adjacency.next(c)) - self.at(c)
    }
}

#[cfg(test)]
#[path = "order_tests.rs"]
mod tests;
