//! The planes that bound a part between its two faces: chamfers and the node facets of voided corners.

use crate::panel::PanelSet;
use crate::plane::Plane;
use glam::{DVec2, DVec3};

/// Which bounding plane of a panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum FacetName {
    /// The chamfer of edge `k`.
    Edge(u32),
    /// The node facet of voided corner `k`.
    Node(u32),
}

impl std::fmt::Display for FacetName {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Edge(k) => write!(f, "edge {k}"),
            Self::Node(k) => write!(f, "node facet {k}"),
        }
    }
}

/// A plane to be contoured and the polygon of the part that lies in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    /// Whose plane it is.
    pub name: FacetName,
    /// The plane, normal away from the wood.
    pub plane: Plane,
    points: [DVec3; 8],
    count: usize,
}

impl Facet {
    fn new(name: FacetName, plane: Plane, corners: &[DVec3]) -> Self {
        let mut facet = Self { name, plane, points: [DVec3::ZERO; 8], count: 0 };
        facet.extend(corners);
        facet
    }

    /// Adds points as long as there is room: a chamfer has four of its own and two from each of two nodes.
    fn extend(&mut self, more: &[DVec3]) {
        for (slot, p) in self.points[self.count..].iter_mut().zip(more) {
            *slot = *p;
            self.count += 1;
        }
    }

    /// Corners of the part in this plane, in no order.
    #[must_use]
    pub fn points(&self) -> &[DVec3] {
        &self.points[..self.count]
    }
}

/// All planes that bound panel `i` between its two faces: one per chamfer, in the order of the edges, then one per node
/// facet that has a plane of its own; a node facet that lies in a chamfer's plane belongs to that chamfer. O(corners).
#[must_use]
pub fn facets(panels: &PanelSet, i: usize) -> Vec<Facet> {
    let range = panels.corners(i);
    let n = range.len();
    let mut out = Vec::with_capacity(2 * n);
    for k in 0..n {
        let (at, next) = (range.start + k, range.start + (k + 1) % n);
        let corners = [panels.front[at], panels.front[next], panels.back_end[at], panels.back_start[at]];
        out.push(Facet::new(FacetName::Edge(k as u32), panels.chamfer[at], &corners));
    }
    for k in 0..n {
        let Some((corners, plane)) = panels.facet(i, k) else { continue };
        match [k, (k + n - 1) % n].into_iter().find(|e| out[*e].plane == plane) {
            Some(edge) => out[edge].extend(&corners[1..]),
            // A triangle too thin to have a normal holds no wood.
            None if !plane.normal.is_finite() => {}
            None => out.push(Facet::new(FacetName::Node(k as u32), plane, &corners)),
        }
    }
    out
}

/// Work-piece outline `P_i`: the convex hull of both faces seen from above, counter-clockwise; empty for a failed
/// panel. O(n log n).
#[must_use]
pub fn piece_outline(panels: &PanelSet, i: usize) -> Vec<DVec2> {
    let r = panels.corners(i);
    let columns = [&panels.front[r.clone()], &panels.back_start[r.clone()], &panels.back_end[r]];
    super::convex::hull(&columns.into_iter().flatten().map(|p| p.truncate()).collect::<Vec<_>>())
}
