//! Meshes to test panels and joints on: vector sums of planar and bent curves, a cone, a planar-hexagon-like mesh.

use crate::mesh::{Address, Mesh};
use glam::DVec3;

/// `M_ij = A_i + B_j - c` with addresses; columns run along `a`, rows along `b`. Every face is a parallelogram.
pub(crate) fn vector_sum(a: &[DVec3], b: &[DVec3]) -> Mesh {
    let origin = a[0];
    grid(a.len(), b.len(), |i, j| a[i] + b[j] - origin)
}

/// An ordered grid of `columns` × `rows` points.
pub(crate) fn grid(columns: usize, rows: usize, point: impl Fn(usize, usize) -> DVec3) -> Mesh {
    let points = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j))).map(|(i, j)| point(i, j)).collect();
    let index = |i: usize, j: usize| (j * columns + i) as u32;
    let mut faces = Vec::new();
    let mut addresses = Vec::new();
    for j in 0..rows - 1 {
        for i in 0..columns - 1 {
            faces.push([index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)]);
            addresses.push(Address { patch: 0, row: j as u32, column: i as u32 });
        }
    }
    Mesh { addresses: addresses.into(), ..Mesh::from_faces(points, &faces) }
}

/// An arc over a span in x, rising in z.
pub(crate) fn arc(n: usize, span: f64, rise: f64) -> Vec<DVec3> {
    let radius = (span * span / 4.0 + rise * rise) / (2.0 * rise);
    let half = (span / 2.0 / radius).asin();
    (0..=n)
        .map(|i| {
            let t = half * (2.0 * i as f64 / n as f64 - 1.0);
            DVec3::new(radius * t.sin(), 0.0, radius * (t.cos() - half.cos()))
        })
        .collect()
}

/// A rough folded curve along y that swings in x and z, so that nodes are not conical.
pub(crate) fn folded(n: usize, step: f64, depth: f64) -> Vec<DVec3> {
    (0..=n)
        .map(|j| {
            let t = j as f64;
            DVec3::new(0.5 * depth * (2.1 * t).sin(), step * t, depth * (1.7 * t + 0.4).sin())
        })
        .collect()
}

/// The 16 × 16 shell of the laws: an arc swept along a folded curve.
pub(crate) fn shell() -> Mesh {
    vector_sum(&arc(16, 4500.0, 1400.0), &folded(16, 240.0, 90.0))
}
