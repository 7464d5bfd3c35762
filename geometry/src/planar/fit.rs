//! The plane of least squares through points: the eigenvector of their scatter with the least eigenvalue.

use crate::plane::Plane;
use glam::{DMat3, DVec3};

/// The plane that minimises the sum of squared distances, through the mean of the points; `None` for points on a line.
/// Its normal may point either way. O(points), Jacobi's method on the 3 × 3 scatter matrix, which keeps full
/// precision for planar points.
#[must_use]
pub fn fit_plane(points: impl Iterator<Item = DVec3> + Clone) -> Option<Plane> {
    let centre = crate::mesh::centre(points.clone());
    let mut scatter = DMat3::ZERO;
    for p in points {
        let d = p - centre;
        scatter += DMat3::from_cols(d * d.x, d * d.y, d * d.z);
    }
    let (values, vectors) = symmetric_eigen(scatter);
    let least = (0..3).min_by(|&i, &j| values[i].total_cmp(&values[j]))?;
    let middle = 0.5 * (values[0] + values[1] + values[2] - values[least]);
    // On a line two eigenvalues vanish: any plane through it would do.
    let spread = values.iter().fold(0.0f64, |m, v| m.max(*v));
    (middle > 0.0 && 2.0 * middle - spread > 1e-20 * spread).then(|| Plane::through(centre, vectors.col(least)))
}

/// Eigenvalues and unit eigenvectors (columns) of a symmetric matrix by cyclic Jacobi rotations.
fn symmetric_eigen(mut a: DMat3) -> ([f64; 3], DMat3) {
    let mut vectors = DMat3::IDENTITY;
    for _ in 0..30 {
        let off = a.y_axis.x.abs() + a.z_axis.x.abs() + a.z_axis.y.abs();
        if off == 0.0 {
            break;
        }
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            let apq = a.col(q)[p];
            if apq == 0.0 {
                continue;
            }
            let theta = (a.col(q)[q] - a.col(p)[p]) / (2.0 * apq);
            let t = theta.signum() / (theta.abs() + theta.hypot(1.0));
            let c = 1.0 / t.hypot(1.0);
            let s = t * c;
            let mut turn = DMat3::IDENTITY;
            turn.col_mut(p)[p] = c;
            turn.col_mut(q)[q] = c;
            turn.col_mut(q)[p] = s;
            turn.col_mut(p)[q] = -s;
            a = turn.transpose() * a * turn;
            // Exactly symmetric and exactly zero, or rounding would keep the loop alive.
            a.col_mut(q)[p] = 0.0;
            a.col_mut(p)[q] = 0.0;
            vectors *= turn;
        }
    }
    ([a.x_axis.x, a.y_axis.y, a.z_axis.z], vectors)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_line_has_no_plane() {
        assert_eq!(fit_plane((0..4).map(|i| DVec3::new(f64::from(i), 0.0, 1.0))), None);
        assert_eq!(fit_plane([DVec3::ONE].into_iter()), None);
        assert_eq!(fit_plane([].into_iter()), None);
    }

    #[test]
    fn a_saddle_is_fitted_by_its_middle_plane() {
        let plane = fit_plane(
            [(1., 1., 1.), (-1., 1., -1.), (-1., -1., 1.), (1., -1., -1.)]
                .into_iter()
                .map(|(x, y, z)| DVec3::new(100.0 * x, 100.0 * y, 3.0 * z)),
        )
        .unwrap();
        assert!((plane.normal.z.abs() - 1.0).abs() < 1e-14 && plane.offset.abs() < 1e-12);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(128))]
        #[test]
        fn planar_points_lie_in_their_plane_and_noise_has_no_better_plane(
            normal in (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64),
            flat in prop::collection::vec((-500.0..500.0f64, -500.0..500.0f64, -1.0..1.0f64), 4..9),
            noise in prop_oneof![Just(0.0), 0.0..5.0f64],
            tilt in (-1e-3..1e-3f64, -1e-3..1e-3f64),
        ) {
            let Some(n) = DVec3::from(normal).try_normalize() else { return Ok(()) };
            let (u, v) = n.any_orthonormal_pair();
            let at = n * 1234.0;
            let points: Vec<DVec3> = flat.iter().map(|&(x, y, z)| at + u * x + v * y + n * z * noise).collect();
            let Some(plane) = fit_plane(points.iter().copied()) else { return Ok(()) };
            let square = |plane: &Plane| points.iter().map(|p| plane.distance(*p).powi(2)).sum::<f64>();
            if noise == 0.0 {
                prop_assert!(points.iter().all(|p| plane.distance(*p).abs() < 1e-9));
            }
            let centre = crate::mesh::centre(points.iter().copied());
            let other = Plane::through(centre, (plane.normal + u * tilt.0 + v * tilt.1).normalize());
            prop_assert!(square(&plane) <= square(&other) + 1e-9);
        }
    }
}
