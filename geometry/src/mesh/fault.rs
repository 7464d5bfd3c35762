//! Faults of single faces that keep them from becoming panels: no area, short edges, concave corners, crossing loops.

use super::Mesh;
use glam::DVec3;
use thiserror::Error;

/// A face that cannot become a panel.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum FaceFault {
    /// An edge is shorter than asked.
    #[error("face {face}: edge {edge} is {length:.4} mm long, at least {least} mm are needed")]
    ShortEdge {
        /// Face index.
        face: u32,
        /// Edge index in the face.
        edge: u32,
        /// Its length, mm.
        length: f64,
        /// The least length, mm.
        least: f64,
    },
    /// The corners lie on a line, or the loop crosses itself so that its areas cancel.
    #[error("face {face} has no area")]
    NoArea {
        /// Face index.
        face: u32,
    },
    /// A corner turns inwards.
    #[error(
        "face {face} is concave: corner {corner} (vertex {vertex}) lies {depth:.4} mm inside the line between its neighbours"
    )]
    Concave {
        /// Face index.
        face: u32,
        /// Corner index in the face.
        corner: u32,
        /// Its vertex.
        vertex: u32,
        /// How far it lies inside, mm.
        depth: f64,
    },
    /// The loop winds more than once around its middle.
    #[error("face {face} crosses itself")]
    Crossing {
        /// Face index.
        face: u32,
    },
}

impl FaceFault {
    /// The face that is at fault.
    #[must_use]
    pub fn face(&self) -> u32 {
        match *self {
            Self::ShortEdge { face, .. }
            | Self::NoArea { face }
            | Self::Concave { face, .. }
            | Self::Crossing { face } => face,
        }
    }
}

impl Mesh {
    /// The first fault of every face that has one, by face. Edges shorter than `least_edge` mm and corners that lie more
    /// than `concavity` mm inside the line between their neighbours count. Needs a mesh that passes
    /// [`Mesh::check_structure`]. O(corners).
    #[must_use]
    pub fn face_faults(&self, least_edge: f64, concavity: f64) -> Vec<FaceFault> {
        (0..self.face_count()).filter_map(|f| self.face_fault(f, least_edge, concavity)).collect()
    }

    /// The first fault of face `f`; see [`Mesh::face_faults`].
    #[must_use]
    pub fn face_fault(&self, f: usize, least_edge: f64, concavity: f64) -> Option<FaceFault> {
        let face = f as u32;
        let corners = self.face(f);
        let n = corners.len();
        let p = |k: usize| self.points[corners[k % n] as usize];
        for k in 0..n {
            let length = p(k).distance(p(k + 1));
            if length <= least_edge {
                return Some(FaceFault::ShortEdge { face, edge: k as u32, length, least: least_edge });
            }
        }
        let area = self.face_area_vector(f);
        let perimeter: f64 = (0..n).map(|k| p(k).distance(p(k + 1))).sum();
        // An area that rounding alone could make.
        if area.length() <= 1e-13 * perimeter * perimeter {
            return Some(FaceFault::NoArea { face });
        }
        let normal = area.normalize();
        let mut turning = 0.0;
        for (k, &vertex) in corners.iter().enumerate() {
            let (before, at, after) = (p(k + n - 1), p(k), p(k + 1));
            let depth = inset(before, at, after, normal);
            if depth > concavity {
                return Some(FaceFault::Concave { face, corner: k as u32, vertex, depth });
            }
            let (u, v) = (at - before, after - at);
            turning += u.cross(v).dot(normal).atan2(u.dot(v));
        }
        (turning > 3.0 * std::f64::consts::PI).then_some(FaceFault::Crossing { face })
    }
}

/// How far `at` lies on the inner side of the line from `before` to `after`, mm; negative at a convex corner.
pub(crate) fn inset(before: DVec3, at: DVec3, after: DVec3, normal: DVec3) -> f64 {
    let chord = after - before;
    let across = normal.cross(chord);
    let length = across.length();
    if length > 0.0 { across.dot(at - before) / length } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fault(corners: &[(f64, f64)]) -> Option<FaceFault> {
        let points: Vec<DVec3> = corners.iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect();
        let n = points.len() as u32;
        let mesh = Mesh {
            points: points.into(),
            face_start: vec![0, n].into(),
            face_vertices: (0..n).collect(),
            addresses: crate::shared::Shared::default(),
        };
        mesh.face_fault(0, 1e-3, 1e-6)
    }

    #[test]
    fn convex_faces_have_no_fault() {
        assert_eq!(fault(&[(0., 0.), (4., 0.), (5., 3.), (0., 2.)]), None);
        // A corner in the middle of an edge is not concave.
        assert_eq!(fault(&[(0., 0.), (2., 0.), (4., 0.), (4., 3.), (0., 3.)]), None);
    }

    #[test]
    fn a_concave_corner_is_named_with_its_depth() {
        let Some(FaceFault::Concave { corner: 2, vertex: 2, depth, .. }) =
            fault(&[(0., 0.), (4., 0.), (1., 1.), (0., 4.)])
        else {
            panic!("the arrow is concave");
        };
        assert!((depth - 2f64.sqrt()).abs() < 1e-12, "{depth}");
    }

    #[test]
    fn degenerate_faces_are_told_apart() {
        assert_eq!(fault(&[(0., 0.), (1., 1.), (3., 3.)]), Some(FaceFault::NoArea { face: 0 }));
        assert_eq!(fault(&[(0., 0.), (2., 2.), (2., 0.), (0., 2.)]), Some(FaceFault::NoArea { face: 0 }));
        assert!(matches!(
            fault(&[(0., 0.), (1., 0.), (1., 1e-4), (0., 1.)]),
            Some(FaceFault::ShortEdge { edge: 1, .. })
        ));
        let star: Vec<(f64, f64)> =
            (0..5).map(|k| (f64::from(2 * k) * std::f64::consts::TAU / 5.0).sin_cos()).map(|(s, c)| (c, s)).collect();
        assert_eq!(fault(&star), Some(FaceFault::Crossing { face: 0 }));
    }
}
