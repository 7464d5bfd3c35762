//! Nodes: the candidates for the back corners, and how far a node is voided so that its panels do not overlap
//! (METHODS §5, 000 §6.3.5).

use super::issue::PanelIssue;
use super::thicken::{Nodes, Work};
use glam::DVec3;

/// Where a panel proposes that a back edge ends: `at` mm inwards along the edge, `per_depth` more for every mm of
/// thickness.
#[derive(Clone, Copy)]
pub(super) struct Inset {
    pub at: f64,
    pub per_depth: f64,
}

/// A circular cone with its apex in a node, around all candidates of that node.
#[derive(Clone, Copy)]
pub(super) struct Cone {
    axis: DVec3,
    /// Cosine of half its opening, positive.
    cos: f64,
}

impl Cone {
    /// The cone around the corner lines `sinks`; `None` if they do not lie within one half-space about their mean.
    fn around(sinks: impl Iterator<Item = DVec3> + Clone) -> Option<Self> {
        let axis = sinks.clone().map(DVec3::normalize).sum::<DVec3>().try_normalize()?;
        let cos = sinks.map(|s| axis.dot(s.normalize())).fold(1.0, f64::min);
        (cos > 0.0).then_some(Self { axis, cos })
    }

    /// Where the line `foot + s · along` leaves the cone, as s; `foot` is perpendicular to the unit vector `along`.
    /// `None` if it does not.
    fn exit(&self, foot: DVec3, along: DVec3) -> Option<f64> {
        // (f + s g)² = cos² (foot² + s²) on the side where f + s g > 0.
        let (f, g, c) = (self.axis.dot(foot), self.axis.dot(along), self.cos * self.cos);
        let (a, b, k) = (c - g * g, f * g, f * f - c * foot.length_squared());
        let root = (b * b + a * k).max(0.0).sqrt();
        let s = (b + root) / a;
        (a > 0.0 && s.is_finite() && f + s * g > 0.0).then_some(s)
    }
}

impl Work<'_> {
    /// Cones for nodes of five panels and more (three on the border): there the rule of two candidates leaves overlaps
    /// (measured: up to 100 mm³ at the nodes of a triangle mesh, 21 mm thick). Ends on a common circular cone around
    /// all candidates leave none: outside the polygon that they span the chamfers alone part the panels. O(corners).
    pub(super) fn widen_nodes(&mut self) {
        self.cone = vec![None; self.mesh.points.len()];
        for v in 0..self.mesh.points.len() as u32 {
            let corners = self.adjacency.corners_at(v);
            let living = corners.iter().filter(|&&c| self.alive[self.adjacency.face_of(c) as usize]);
            let border = corners.iter().any(|&c| self.adjacency.twin(c).is_none());
            if living.clone().count() < if border { 3 } else { 5 } {
                continue;
            }
            let sinks = living.clone().map(|&c| self.sink[c as usize]);
            let first = sinks.clone().next().unwrap_or_default();
            if sinks.clone().all(|s| s.distance(first) * self.params.thickness <= self.params.merge) {
                continue;
            }
            let cone = Cone::around(sinks).filter(|cone| {
                living.clone().all(|&c| {
                    let (sink, before) = (self.sink[c as usize], self.adjacency.previous(c));
                    [self.along[c as usize], -self.along[before as usize]]
                        .iter()
                        .all(|&along| cone.exit(sink - along * sink.dot(along), along).is_some())
                })
            });
            if cone.is_none() {
                let faces = living.map(|&c| self.adjacency.face_of(c)).collect();
                self.issues.push(PanelIssue::SharpNode { vertex: v, faces });
            }
            self.cone[v as usize] = cone;
        }
    }

    /// What the panel of corner `c` proposes for the start of edge `c`.
    fn start(&self, c: u32) -> Inset {
        let c = c as usize;
        let per_depth = self.sink[c].dot(self.along[c]);
        Inset { at: per_depth * (self.height[c] + self.params.thickness), per_depth }
    }

    /// What the panel of corner `c` proposes for the end of edge `c`.
    fn end(&self, c: u32) -> Inset {
        let n = self.adjacency.next(c) as usize;
        let per_depth = -self.sink[n].dot(self.along[c as usize]);
        Inset { at: per_depth * (self.height[n] + self.params.thickness), per_depth }
    }

    /// The candidates for both ends of edge `c`: the panel's own, and where nodes are voided the neighbour's or the
    /// node's cone's.
    pub(super) fn candidates(&self, c: u32, nodes: Nodes) -> [[Inset; 2]; 2] {
        let (start, end) = (self.start(c), self.end(c));
        if nodes == Nodes::Keep {
            return [[start; 2], [end; 2]];
        }
        let living = |t: &u32| self.alive[self.adjacency.face_of(*t) as usize];
        let twin = self.adjacency.twin(c).filter(living);
        let (along, next) = (self.along[c as usize], self.adjacency.next(c));
        [
            [start, self.cone_inset(c, along).or(twin.map(|t| self.end(t))).unwrap_or(start)],
            [end, self.cone_inset(next, -along).or(twin.map(|t| self.start(t))).unwrap_or(end)],
        ]
    }

    /// Where the back edge that runs from corner `c` in direction `along` leaves the node's cone.
    fn cone_inset(&self, c: u32, along: DVec3) -> Option<Inset> {
        let cone = self.cone.get(self.mesh.face_vertices[c as usize] as usize)?.as_ref()?;
        let sink = self.sink[c as usize];
        let per_depth = cone.exit(sink - along * sink.dot(along), along)?;
        Some(Inset { at: per_depth * (self.height[c as usize] + self.params.thickness), per_depth })
    }
}
