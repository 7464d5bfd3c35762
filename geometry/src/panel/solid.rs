//! A panel as a closed convex polyhedron, its volume and areas.

use super::set::PanelSet;
use crate::plane::Plane;
use glam::DVec3;

/// A closed polyhedron. Face `f` is the loop `face_vertices[face_start[f]..face_start[f + 1]]`, counter-clockwise seen
/// from outside; every edge is run along twice, in opposite directions. The wood lies behind `planes[f]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solid {
    /// Vertices, mm.
    pub points: Vec<DVec3>,
    /// Where each face's loop starts; one longer than the number of faces, first entry 0.
    pub face_start: Vec<u32>,
    /// Vertex indices of all loops.
    pub face_vertices: Vec<u32>,
    /// Outward plane of each face.
    pub planes: Vec<Plane>,
}

impl Solid {
    /// Number of faces.
    #[must_use]
    pub fn face_count(&self) -> usize {
        self.planes.len()
    }

    /// Vertex indices of face `f`.
    #[must_use]
    pub fn face(&self, f: usize) -> &[u32] {
        &self.face_vertices[self.face_start[f] as usize..self.face_start[f + 1] as usize]
    }

    /// Volume, mm³; zero for no faces. O(corners).
    #[must_use]
    pub fn volume(&self) -> f64 {
        let Some(&origin) = self.points.first() else { return 0.0 };
        let mut six = 0.0;
        for f in 0..self.face_count() {
            six += fan(self.face(f), &self.points).map(|[a, b, c]| (a - origin).dot((b - a).cross(c - a))).sum::<f64>();
        }
        six / 6.0
    }

    /// Area of the whole surface, mm². O(corners).
    #[must_use]
    pub fn surface_area(&self) -> f64 {
        (0..self.face_count()).map(|f| self.face_area(f)).sum()
    }

    /// Area of face `f`, mm². O(corners).
    #[must_use]
    pub fn face_area(&self, f: usize) -> f64 {
        fan(self.face(f), &self.points).map(|[a, b, c]| (b - a).cross(c - a)).sum::<DVec3>().length() / 2.0
    }

    pub(super) fn push_face(&mut self, vertices: impl IntoIterator<Item = u32>, plane: Plane) {
        if self.face_start.is_empty() {
            self.face_start.push(0);
        }
        self.face_vertices.extend(vertices);
        self.face_start.push(self.face_vertices.len() as u32);
        self.planes.push(plane);
    }
}

/// The triangles of a loop, fanned from its first corner.
fn fan<'a>(face: &'a [u32], points: &'a [DVec3]) -> impl Iterator<Item = [DVec3; 3]> + 'a {
    let point = |i: u32| points[i as usize];
    let rest = face.get(1..).unwrap_or(&[]);
    rest.windows(2).map(move |w| [point(face[0]), point(w[0]), point(w[1])])
}

impl PanelSet {
    /// The plane of panel `i`'s front face; `None` for a failed panel.
    #[must_use]
    pub fn front_plane(&self, i: usize) -> Option<Plane> {
        self.front.get(self.corners(i)).and_then(<[DVec3]>::first).map(|&p| Plane::through(p, self.normal[i]))
    }

    /// The plane of panel `i`'s back face, its normal pointing away from the wood; `None` for a failed panel.
    #[must_use]
    pub fn back_plane(&self, i: usize) -> Option<Plane> {
        let front = self.front_plane(i)?;
        Some(Plane { normal: -front.normal, offset: self.thickness - front.offset })
    }

    /// Panel `i` as a solid with faces front, back, one per edge, one per voided node; empty for a failed panel. The
    /// back is an octagon at most for a quad: nodes that are not voided have one back vertex. O(corners).
    #[must_use]
    pub fn solid(&self, i: usize) -> Solid {
        let mut solid = Solid::default();
        let corners = self.corners(i);
        let (Some(front), Some(back)) = (self.front_plane(i), self.back_plane(i)) else { return solid };
        let (first, n) = (corners.start, corners.len());
        solid.points.extend_from_slice(&self.front[corners]);
        // On the back corner k has the ends of edge k - 1 and of edge k, one vertex where they agree.
        let mut ends = Vec::with_capacity(n);
        for k in 0..n {
            let end = solid.points.len() as u32;
            solid.points.push(self.back_end[first + (k + n - 1) % n]);
            if self.voided[first + k] {
                solid.points.push(self.back_start[first + k]);
            }
            ends.push([end, solid.points.len() as u32 - 1]);
        }
        solid.push_face(0..n as u32, front);
        let round = ends.iter().rev().flat_map(|&[a, b]| [Some(b), (a != b).then_some(a)]).flatten();
        solid.push_face(round, back);
        for k in 0..n {
            let next = (k + 1) % n;
            solid.push_face([next as u32, k as u32, ends[k][1], ends[next][0]], self.chamfer[first + k]);
        }
        for (k, &[a, b]) in ends.iter().enumerate() {
            if let Some((_, plane)) = self.facet(i, k) {
                solid.push_face([k as u32, a, b], plane);
            }
        }
        solid
    }

    /// The node facet of panel `i` at corner `k`: its triangle (front corner, end of edge `k - 1`, start of edge `k`)
    /// and its plane, normal away from the wood. `None` where the node is not voided. Facets that lie in one of the two
    /// chamfers, as on borders, have exactly that chamfer's plane. O(1).
    #[must_use]
    pub fn facet(&self, i: usize, k: usize) -> Option<([DVec3; 3], Plane)> {
        /// Far above the rounding of coordinates in the range of buildings, far below what any tool can cut, mm.
        const ROUNDING: f64 = 1e-9;
        let corners = self.corners(i);
        if k >= corners.len() || !self.voided[corners.start + k] {
            return None;
        }
        let (after, before) = (corners.start + k, corners.start + (k + corners.len() - 1) % corners.len());
        let [v, a, b] = [self.front[after], self.back_end[before], self.back_start[after]];
        let plane = if self.chamfer[after].distance(a).abs() < ROUNDING {
            self.chamfer[after]
        } else if self.chamfer[before].distance(b).abs() < ROUNDING {
            self.chamfer[before]
        } else {
            Plane::through(v, (a - v).cross(b - v).normalize())
        };
        Some(([v, a, b], plane))
    }

    /// Volume of panel `i`, mm³; zero for a failed panel. O(corners).
    #[must_use]
    pub fn volume(&self, i: usize) -> f64 {
        self.solid(i).volume()
    }

    /// Area of panel `i`'s front face, mm²; zero for a failed panel. O(corners).
    #[must_use]
    pub fn front_area(&self, i: usize) -> f64 {
        let front = &self.front[self.corners(i)];
        let Some(&origin) = front.first() else { return 0.0 };
        let twice: DVec3 = front.windows(2).map(|w| (w[0] - origin).cross(w[1] - origin)).sum();
        twice.length() / 2.0
    }

    /// Sum of all front areas: the net area of the structure, mm². O(corners).
    #[must_use]
    pub fn net_front_area(&self) -> f64 {
        (0..self.len()).map(|i| self.front_area(i)).sum()
    }
}
