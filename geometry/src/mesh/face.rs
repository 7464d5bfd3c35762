//! Measures of single faces: corners, area vector (Newell), normal, centroid, fitted plane.

use super::Mesh;
use crate::plane::Plane;
use glam::DVec3;

impl Mesh {
    /// The corner positions of face `f`, counter-clockwise, mm.
    pub fn face_points(&self, f: usize) -> impl ExactSizeIterator<Item = DVec3> + Clone + '_ {
        self.face(f).iter().map(|&v| self.points[v as usize])
    }

    /// The area vector of face `f` (Newell 1972): along the normal, as long as the area, mm². On a face that is not
    /// planar its direction is the mean normal. Zero for a degenerate face. O(corners).
    #[must_use]
    pub fn face_area_vector(&self, f: usize) -> DVec3 {
        area_vector(self.face_points(f))
    }

    /// Unit normal of face `f` by Newell's method, on the side from which its loop runs counter-clockwise; `None` for
    /// a face without area. O(corners).
    #[must_use]
    pub fn face_normal(&self, f: usize) -> Option<DVec3> {
        self.face_area_vector(f).try_normalize()
    }

    /// Mean of the corners of face `f`, mm. O(corners).
    #[must_use]
    pub fn face_centre(&self, f: usize) -> DVec3 {
        centre(self.face_points(f))
    }

    /// The plane through the mean of the corners along Newell's normal; `None` for a face without area. O(corners).
    #[must_use]
    pub fn face_plane(&self, f: usize) -> Option<Plane> {
        Some(Plane::through(self.face_centre(f), self.face_normal(f)?))
    }
}

/// Half the sum of the cross products of consecutive corners, taken about the first corner so that faces far from the
/// origin lose no digits.
pub(crate) fn area_vector(points: impl Iterator<Item = DVec3> + Clone) -> DVec3 {
    let Some(origin) = points.clone().next() else { return DVec3::ZERO };
    let spokes = points.map(|p| p - origin);
    let twice: DVec3 = spokes.clone().zip(spokes.skip(1)).map(|(a, b)| a.cross(b)).sum();
    twice * 0.5
}

/// Mean of the points; zero for none.
pub(crate) fn centre(points: impl Iterator<Item = DVec3>) -> DVec3 {
    let (sum, n) = points.fold((DVec3::ZERO, 0u32), |(sum, n), p| (sum + p, n + 1));
    sum / f64::from(n.max(1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_far_away_keeps_its_digits() {
        let far = DVec3::new(1e6, -3e6, 2e6);
        let corners = [(0.0, 0.0), (3.0, 0.0), (3.0, 2.0), (0.0, 2.0)];
        let points = corners.map(|(x, y)| far + DVec3::new(x, y, 0.0)).to_vec();
        let mesh = Mesh::from_faces(points, &[[0, 1, 2, 3]]);
        assert_eq!(mesh.face_area_vector(0), DVec3::new(0.0, 0.0, 6.0));
        assert_eq!(mesh.face_normal(0), Some(DVec3::Z));
        assert_eq!(mesh.face_centre(0), far + DVec3::new(1.5, 1.0, 0.0));
        assert_eq!(mesh.face_plane(0).unwrap().distance(far + DVec3::Z), 1.0);
    }

    #[test]
    fn a_face_without_area_has_no_normal() {
        let points = (0..3).map(|i| DVec3::splat(f64::from(i))).collect();
        assert_eq!(Mesh::from_faces(points, &[[0, 1, 2]]).face_normal(0), None);
    }
}
