//! How planar faces are, in every measure that METHODS §3 names, per face and summed up.

use super::fit_plane;
use crate::mesh::{Mesh, MeshError, inset};
use glam::DVec3;

/// Planarity of all faces, one entry per face in every column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Planarity {
    /// The thesis' planarity min(p1, p2), 1 is planar (000 §8.3.2): the least cosine between the normals of opposite
    /// corners. 1 for triangles; on n-gons the least over all pairs of corners. NaN where a corner has no normal.
    pub cosine: Vec<f64>,
    /// What a fabricator reads, mm: on quads the greatest distance of one corner from the plane of the other three, on
    /// n-gons the same as `fit`, 0 for triangles. Infinite where three corners have no plane.
    pub corner: Vec<f64>,
    /// Distance of the diagonals over their mean length (libigl's `quad_planarity`, there in per cent); 0 for other
    /// faces than quads.
    pub diagonal: Vec<f64>,
    /// Greatest distance of a corner from the plane of least squares, mm.
    pub fit: Vec<f64>,
    /// How deep the deepest concave corner lies inside the line between its neighbours, mm; 0 on convex faces.
    pub concave: Vec<f64>,
}

/// The worst and the mean of every measure.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlanaritySummary {
    /// Least `cosine`; faces without one (NaN) do not count.
    pub cosine_min: f64,
    /// Mean `cosine`.
    pub cosine_mean: f64,
    /// Greatest `corner`, mm.
    pub corner_max: f64,
    /// Mean `corner`, mm.
    pub corner_mean: f64,
    /// The first face that has the greatest `corner`.
    pub worst_face: u32,
    /// Greatest `diagonal`.
    pub diagonal_max: f64,
    /// Mean `diagonal`.
    pub diagonal_mean: f64,
    /// Greatest `fit`, mm.
    pub fit_max: f64,
    /// Mean `fit`, mm.
    pub fit_mean: f64,
    /// Number of concave faces (deeper than a millionth of a millimetre).
    pub concave_faces: u32,
}

impl Planarity {
    /// Measures every face. O(corners) for faces of bounded size; the cosine of an n-gon costs n².
    ///
    /// # Errors
    /// Any of [`Mesh::check_structure`].
    pub fn measure(mesh: &Mesh) -> Result<Self, MeshError> {
        mesh.check_structure()?;
        let mut out = Self::default();
        let mut corners = Vec::new();
        for f in 0..mesh.face_count() {
            corners.clear();
            corners.extend(mesh.face_points(f));
            let fit = fit_distance(&corners);
            out.cosine.push(cosine(&corners));
            out.corner.push(match corners.len() {
                3 => 0.0,
                4 => corner_distance(&corners),
                _ => fit,
            });
            out.diagonal.push(match *corners.as_slice() {
                [a, b, c, d] => diagonal_distance(a, b, c, d),
                _ => 0.0,
            });
            out.fit.push(fit);
            out.concave.push(concavity(&corners));
        }
        Ok(out)
    }

    /// The worst and the mean of every column; zeros for no faces (and cosine 1). O(faces).
    #[must_use]
    pub fn summary(&self) -> PlanaritySummary {
        let max = |column: &[f64]| column.iter().copied().fold(0.0, f64::max);
        let mean = |column: &[f64]| column.iter().sum::<f64>() / column.len().max(1) as f64;
        let corner_max = max(&self.corner);
        PlanaritySummary {
            cosine_min: self.cosine.iter().copied().fold(1.0, f64::min),
            cosine_mean: if self.cosine.is_empty() { 1.0 } else { mean(&self.cosine) },
            corner_max,
            corner_mean: mean(&self.corner),
            worst_face: self.corner.iter().position(|c| *c == corner_max).unwrap_or(0) as u32,
            diagonal_max: max(&self.diagonal),
            diagonal_mean: mean(&self.diagonal),
            fit_max: max(&self.fit),
            fit_mean: mean(&self.fit),
            concave_faces: self.concave.iter().filter(|c| **c > 1e-6).count() as u32,
        }
    }
}

/// Least cosine between corner normals: of opposite corners on a quad, of all pairs otherwise.
fn cosine(corners: &[DVec3]) -> f64 {
    let n = corners.len();
    let normal = |k: usize| {
        let at = corners[k];
        (corners[(k + 1) % n] - at).cross(corners[(k + n - 1) % n] - at).normalize()
    };
    let least = |least: f64, (i, j): (usize, usize)| {
        let c = normal(i).dot(normal(j)).clamp(-1.0, 1.0);
        // `min` would drop the NaN of a corner without a normal.
        if c.is_nan() || least.is_nan() { f64::NAN } else { least.min(c) }
    };
    match n {
        3 => 1.0,
        4 => [(0, 2), (1, 3)].into_iter().fold(1.0, least),
        _ => (0..n).flat_map(|i| (0..i).map(move |j| (i, j))).fold(1.0, least),
    }
}

/// Greatest distance of one corner of a quad from the plane of the other three, mm. The volume is the same for all
/// four; the smallest triangle gives the greatest height.
pub(crate) fn corner_distance(quad: &[DVec3]) -> f64 {
    let at = |k: usize| quad[k % 4];
    let volume = (at(1) - at(0)).dot((at(2) - at(0)).cross(at(3) - at(0))).abs();
    let double_area = |k: usize| (at(k + 1) - at(k)).cross(at(k + 3) - at(k)).length();
    let least = (0..4).map(double_area).fold(f64::INFINITY, f64::min);
    if least > 0.0 { volume / least } else { f64::INFINITY }
}

/// Distance of the diagonals' lines over their mean length.
fn diagonal_distance(a: DVec3, b: DVec3, c: DVec3, d: DVec3) -> f64 {
    let (ac, bd) = (c - a, d - b);
    let across = ac.cross(bd);
    let mean = 0.5 * (ac.length() + bd.length());
    if across.length() > 0.0 { (b - a).dot(across).abs() / (across.length() * mean) } else { 0.0 }
}

/// Greatest distance from the plane of least squares, mm; 0 for points on a line.
pub(crate) fn fit_distance(corners: &[DVec3]) -> f64 {
    if corners.len() < 4 {
        return 0.0;
    }
    let Some(plane) = fit_plane(corners.iter().copied()) else { return 0.0 };
    corners.iter().map(|p| plane.distance(*p).abs()).fold(0.0, f64::max)
}

/// Depth of the deepest concave corner, mm.
fn concavity(corners: &[DVec3]) -> f64 {
    let n = corners.len();
    let Some(normal) = crate::mesh::area_vector(corners.iter().copied()).try_normalize() else { return 0.0 };
    (0..n).map(|k| inset(corners[(k + n - 1) % n], corners[k], corners[(k + 1) % n], normal)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn quad(heights: [f64; 4]) -> Mesh {
        let [a, b, c, d] = heights;
        let points =
            vec![DVec3::new(0., 0., a), DVec3::new(300., 0., b), DVec3::new(300., 400., c), DVec3::new(0., 400., d)];
        Mesh::from_faces(points, &[[0, 1, 2, 3]])
    }

    #[test]
    fn a_lifted_corner_is_measured_in_every_measure() {
        let p = Planarity::measure(&quad([0., 0., 0., 12.])).unwrap().summary();
        // The plane of a, b, c is z = 0; that of the others leans, and the corners of the rectangle are as far from it.
        let leaning = 12.0 * 300.0 * 400.0 / (DVec3::new(0., 400., 12.).cross(DVec3::new(300., 0., 0.)).length());
        assert!((p.corner_max - 12.0).abs() < 1e-9 && leaning < 12.0, "{}", p.corner_max);
        // Diagonals cross 6 mm apart where seen from above; leaning shortens their distance.
        let n = DVec3::new(300., 400., 0.).cross(DVec3::new(-300., 400., 12.)).normalize();
        let distance = DVec3::new(300., 0., 0.).dot(n).abs();
        let mean = (500.0 + (500.0f64.powi(2) + 144.0).sqrt()) / 2.0;
        assert!((p.diagonal_max - distance / mean).abs() < 1e-12);
        assert!((p.fit_max - 3.0).abs() < 0.01, "{}", p.fit_max);
        let (p1, p2) = (
            (-DVec3::X)
                .cross(DVec3::Y)
                .dot(DVec3::new(0., -400., -12.).normalize().cross(DVec3::new(300., 0., -12.).normalize()).normalize())
                .abs(),
            DVec3::X
                .cross(DVec3::new(0., 400., 12.).normalize())
                .normalize()
                .dot(DVec3::new(-300., 0., 12.).normalize().cross(-DVec3::Y).normalize())
                .abs(),
        );
        assert!((p.cosine_min - p1.min(p2)).abs() < 1e-12, "{} {p1} {p2}", p.cosine_min);
        assert_eq!(p.concave_faces, 0);
    }

    #[test]
    fn a_planar_concave_quad_is_planar_but_concave() {
        let mut mesh = quad([0.; 4]);
        mesh.points.to_mut()[2] = DVec3::new(50., 60., 0.);
        let p = Planarity::measure(&mesh).unwrap();
        assert_eq!((p.corner[0], p.diagonal[0]), (0.0, 0.0));
        assert_eq!(p.cosine[0], -1.0);
        assert!((p.concave[0] - (1200.0 - 50.0 * 4.0 - 60.0 * 3.0) / 5.0).abs() < 1e-9, "{}", p.concave[0]);
    }

    #[test]
    fn triangles_are_planar_and_pentagons_are_fitted() {
        let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
        let mesh = Mesh {
            points: vec![p(0., 0., 0.), p(2., 0., 0.), p(3., 2., 0.5), p(1., 4., 0.), p(-1., 2., -0.5), p(9., 9., 9.)]
                .into(),
            face_start: vec![0, 3, 8].into(),
            face_vertices: vec![0, 1, 5, 0, 1, 2, 3, 4].into(),
            addresses: crate::shared::Shared::default(),
        };
        let measured = Planarity::measure(&mesh).unwrap();
        assert_eq!((measured.corner[0], measured.fit[0], measured.cosine[0]), (0.0, 0.0, 1.0));
        assert!(measured.corner[1] > 0.0 && measured.corner[1] == measured.fit[1]);
        assert!(measured.cosine[1] < 1.0);
        assert_eq!(measured.summary().worst_face, 1);
    }

    #[test]
    fn a_collapsed_quad_is_not_taken_for_planar() {
        let mut mesh = quad([0., 0., 7., 0.]);
        mesh.points.to_mut()[1] = mesh.points[0];
        let p = Planarity::measure(&mesh).unwrap();
        assert_eq!(p.corner[0], f64::INFINITY);
        assert!(p.cosine[0].is_nan());
    }
}
