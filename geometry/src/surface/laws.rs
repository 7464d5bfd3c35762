//! Tests: what holds for every surface made of curves, and what is refused.

use super::{Direction, SurfaceError, tensor_product, vector_sum, vector_sum_grid};
use crate::ifs::{Curve, Preset, Scheme, homogeneous, iterate, patches};
use crate::mesh::{Address, Mesh};
use glam::{DVec3, DVec4, Vec4Swizzles};
use proptest::prelude::*;
use std::collections::HashMap;

fn go(_: f64) -> bool {
    true
}

fn preset(preset: Preset) -> Scheme {
    Scheme::preset(preset).unwrap()
}

fn weighted(n: usize) -> impl Strategy<Value = Vec<DVec4>> {
    let point = [-1e3..1e3, -1e3..1e3, -1e3..1e3_f64].prop_map(DVec3::from_array);
    prop::collection::vec((point, 0.55..3.0_f64).prop_map(|(p, w)| homogeneous(p, w)), n)
}

fn plain(points: &[DVec4]) -> Vec<DVec4> {
    points.iter().map(|p| homogeneous(p.xyz() / p.w, 1.0)).collect()
}

/// Distance of a quad's corners from a plane through three of them, taking the three that span the most.
fn flatness(mesh: &Mesh, f: usize) -> f64 {
    let p: Vec<DVec3> = mesh.face(f).iter().map(|&v| mesh.points[v as usize]).collect();
    let volume = (p[1] - p[0]).dot((p[2] - p[0]).cross(p[3] - p[0])).abs();
    let area = (0..4).map(|i| (p[(i + 1) % 4] - p[i]).cross(p[(i + 3) % 4] - p[i]).length()).fold(0.0, f64::max);
    if area > 0.0 { volume / area } else { 0.0 }
}

fn extent(mesh: &Mesh) -> f64 {
    mesh.points.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max)
}

/// How many faces use each edge.
fn edge_uses(mesh: &Mesh) -> HashMap<(u32, u32), usize> {
    let mut uses = HashMap::new();
    for f in 0..mesh.face_count() {
        let face = mesh.face(f);
        for (i, &v) in face.iter().enumerate() {
            let w = face[(i + 1) % face.len()];
            *uses.entry((v.min(w), v.max(w))).or_default() += 1;
        }
    }
    uses
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn weighted_vector_sums_have_planar_faces(a in weighted(9), b in weighted(7), c in weighted(1)) {
        // All pairs of weights sum to more than 1.1: every vertex has a place.
        let (a, b) = (Curve::polyline(a, false).unwrap(), Curve::polyline(b, true).unwrap());
        let mesh = vector_sum(&a, &b, c[0].xyz() / c[0].w, &go).unwrap();
        prop_assert_eq!(mesh.face_count(), 8 * 7);
        for f in 0..mesh.face_count() {
            prop_assert!(flatness(&mesh, f) <= 1e-10 * extent(&mesh));
        }
    }

    #[test]
    fn plain_vector_sums_have_parallelograms(a in weighted(3), b in weighted(4), n in 1..5_u32) {
        let a = iterate(&preset(Preset::Koch), &[plain(&a)], n, 1e-6, &go).unwrap();
        let b = iterate(&preset(Preset::Bezier { degree: 3 }), &[plain(&b)], n + 1, 1e-6, &go).unwrap();
        let mesh = vector_sum(&a, &b, DVec3::new(3.0, -2.0, 8.0), &go).unwrap();
        for f in 0..mesh.face_count() {
            let p: Vec<DVec3> = mesh.face(f).iter().map(|&v| mesh.points[v as usize]).collect();
            prop_assert!((p[1] - p[0]).distance(p[2] - p[3]) <= 1e-12 * extent(&mesh));
        }
    }

    #[test]
    fn a_weight_that_is_too_low_is_named(a in weighted(5), b in weighted(6), i in 0..5_usize, j in 0..6_usize) {
        let (mut a, mut b) = (a, b);
        a[i] = homogeneous(DVec3::X, 0.3);
        b[j] = homogeneous(DVec3::Y, 0.45);
        let (a, b) = (Curve::polyline(a, false).unwrap(), Curve::polyline(b, false).unwrap());
        match vector_sum(&a, &b, DVec3::ZERO, &go) {
            Err(SurfaceError::Weight { a, b, weight }) => {
                prop_assert_eq!((a, b), (i, j));
                prop_assert!((weight + 0.25).abs() < 1e-15);
            }
            other => prop_assert!(false, "{:?}", other),
        }
    }

    #[test]
    fn a_bezier_patch_is_de_casteljaus(grid in weighted(12), n in 0..5_u32, k in 0..5_u32) {
        let (a, b) = (preset(Preset::Bezier { degree: 3 }), preset(Preset::Bezier { degree: 2 }));
        let along = |scheme, iterations| Direction { scheme, iterations, shared: 1, closed: false };
        let mesh = tensor_product(&grid, 4, along(&a, n), along(&b, k), &go).unwrap();
        let columns = (1 << n) + 1;
        prop_assert_eq!(mesh.points.len(), columns * ((1 << k) + 1));
        let middle = |row: &[DVec4], t: f64| {
            let mut row = row.to_vec();
            while row.len() > 1 {
                row = row.windows(2).map(|w| w[0] * (1.0 - t) + w[1] * t).collect();
            }
            row[0]
        };
        for (v, p) in mesh.points.iter().enumerate() {
            let (s, t) = ((v % columns) as f64 / f64::from(1 << n), (v / columns) as f64 / f64::from(1 << k));
            let ribs: Vec<DVec4> = grid.chunks(4).map(|row| middle(row, s)).collect();
            let q = middle(&ribs, t);
            prop_assert!(p.distance(q.xyz() / q.w) <= 1e-10);
        }
    }

    #[test]
    fn the_tensor_product_of_a_vector_sum_grid_is_the_vector_sum(a in weighted(3), b in weighted(3), n in 1..5_u32, k in 1..5_u32) {
        let (a, b, c) = (plain(&a), plain(&b), DVec3::new(1.0, 2.0, 3.0));
        let (levy, dragon) = (preset(Preset::Levy), preset(Preset::Dragon));
        let along = |scheme, iterations| Direction { scheme, iterations, shared: 1, closed: false };
        let product = tensor_product(&vector_sum_grid(&a, &b, c), 3, along(&levy, n), along(&dragon, k), &go).unwrap();
        let a = iterate(&levy, &[a], n, 1e-6, &go).unwrap();
        let b = iterate(&dragon, &[b], k, 1e-6, &go).unwrap();
        let sum = vector_sum(&a, &b, c, &go).unwrap();
        prop_assert_eq!(&product.face_vertices, &sum.face_vertices);
        prop_assert_eq!(&product.addresses, &sum.addresses);
        for (p, q) in product.points.iter().zip(&sum.points) {
            prop_assert!(p.distance(*q) <= 1e-9);
        }
    }
}

fn row(points: &[[f64; 3]]) -> Vec<DVec4> {
    points.iter().map(|p| homogeneous(DVec3::from_array(*p), 1.0)).collect()
}

#[test]
fn faces_lie_in_rows_of_b_and_columns_of_a_and_look_up() {
    let a = Curve::polyline(row(&[[0.0; 3], [1.0, 0.0, 0.0], [3.0, 0.0, 0.0]]), false).unwrap();
    let b = Curve::polyline(row(&[[0.0; 3], [0.0, 2.0, 0.0], [0.0, 5.0, 0.0], [0.0, 9.0, 0.0]]), false).unwrap();
    let mesh = vector_sum(&a, &b, DVec3::ZERO, &go).unwrap();
    assert_eq!((mesh.points.len(), mesh.face_count()), (12, 6));
    assert_eq!(mesh.addresses[3], Address { patch: 0, row: 1, column: 1 });
    assert_eq!(mesh.face(3), [4, 5, 8, 7]);
    assert_eq!(mesh.points[8], DVec3::new(3.0, 5.0, 0.0));
    for f in 0..6 {
        let p: Vec<DVec3> = mesh.face(f).iter().map(|&v| mesh.points[v as usize]).collect();
        assert!((p[1] - p[0]).cross(p[3] - p[0]).z > 0.0);
    }
}

/// Corners and tangent crossings of a circle of `2 · patches` control points, weights in turn 1 and the half angle's
/// cosine.
fn circle(radius: f64, count: usize) -> Vec<DVec4> {
    let half = std::f64::consts::PI / count as f64;
    let corner = |i: usize| {
        let w = if i.is_multiple_of(2) { 1.0 } else { half.cos() };
        let (s, c) = (i as f64 * half).sin_cos();
        homogeneous(DVec3::new(radius / w * c, radius / w * s, 0.0), w)
    };
    (0..2 * count).map(corner).collect()
}

#[test]
fn closed_curves_close_the_mesh_without_a_seam() {
    let quadratic = preset(Preset::Bezier { degree: 2 });
    let ring = |r| iterate(&quadratic, &patches(&circle(r, 3), 3, 1, true).unwrap(), 3, 1e-9, &go).unwrap();
    let profile = Curve::polyline(row(&[[0.0; 3], [0.0, 0.0, 4.0], [0.0, 0.0, 9.0]]), false).unwrap();
    let tube = vector_sum(&ring(100.0), &profile, DVec3::ZERO, &go).unwrap();
    assert_eq!((tube.points.len(), tube.face_count()), (24 * 3, 24 * 2));
    let uses = edge_uses(&tube);
    assert_eq!(uses.values().filter(|&&n| n == 1).count(), 48);
    assert_eq!(uses.values().filter(|&&n| n == 2).count(), 24 * 2 * 2 - 24);
    // Both ways round: a torus has no border and characteristic 0.
    let torus = vector_sum(&ring(100.0), &ring(10.0), DVec3::ZERO, &go).unwrap();
    let uses = edge_uses(&torus);
    assert!(uses.values().all(|&n| n == 2));
    assert_eq!(torus.points.len() + torus.face_count(), uses.len());
}

#[test]
fn closed_directions_of_a_tensor_product_close_the_mesh() {
    let (quadratic, spline) = (preset(Preset::Bezier { degree: 2 }), preset(Preset::CubicBSpline));
    let profile = row(&(0..7).map(|i| [0.0, 0.0, f64::from(i * 3)]).collect::<Vec<_>>());
    let grid = vector_sum_grid(&circle(50.0, 4), &profile, DVec3::ZERO);
    let around = Direction { scheme: &quadratic, iterations: 2, shared: 1, closed: true };
    let up = Direction { scheme: &spline, iterations: 2, shared: 3, closed: false };
    let tube = tensor_product(&grid, 8, around, up, &go).unwrap();
    assert_eq!((tube.points.len(), tube.face_count()), (16 * 17, 16 * 16));
    assert_eq!(edge_uses(&tube).values().filter(|&&n| n == 1).count(), 32);
    for p in &tube.points {
        assert!((p.truncate().length() - 50.0).abs() < 1e-11);
    }
    // The uniform spline reproduces the even spacing of its control points.
    assert!((tube.points[16].z - tube.points[0].z - 0.75).abs() < 1e-12);
    // End to end, the spline's patches do not meet.
    let wrong = Direction { shared: 1, ..up };
    let error = tensor_product(&grid, 8, around, wrong, &go).unwrap_err();
    assert_eq!(error, SurfaceError::PatchesApart { direction: 'B', shared: 1 });
}

#[test]
fn bad_surfaces_are_refused() {
    let line = Curve::polyline(row(&[[0.0; 3], [1.0, 0.0, 0.0]]), false).unwrap();
    let cantor = preset(Preset::Cantor);
    let dust = iterate(&cantor, &[row(&[[0.0; 3], [9.0, 0.0, 0.0]])], 3, 1e-6, &go).unwrap();
    let error = vector_sum(&line, &dust, DVec3::ZERO, &go).unwrap_err();
    assert_eq!(error, SurfaceError::Disconnected { curve: 'B', strips: 8 });
    assert!(matches!(vector_sum(&line, &line, DVec3::NAN, &go), Err(SurfaceError::NotFinite { .. })));
    assert_eq!(vector_sum(&line, &line, DVec3::ZERO, &|_| false), Err(SurfaceError::Cancelled));
    let far = Curve::polyline(row(&[[1.7e308, 0.0, 0.0], [1.0, 0.0, 0.0]]), false).unwrap();
    assert!(matches!(vector_sum(&far, &far, DVec3::ZERO, &go), Err(SurfaceError::NotFinite { .. })));

    let quadratic = preset(Preset::Bezier { degree: 2 });
    let along = |scheme, iterations| Direction { scheme, iterations, shared: 1, closed: false };
    let mut grid = row(&(0..9).map(|i| [f64::from(i % 3), f64::from(i / 3), 0.0]).collect::<Vec<_>>());
    let one = along(&quadratic, 2);
    let size = SurfaceError::GridSize { given: 8, rows: 3, columns: 3 };
    assert_eq!(tensor_product(&grid[..8], 3, one, one, &go), Err(size));
    let error = tensor_product(&grid, 3, one, Direction { iterations: 30, ..one }, &go).unwrap_err();
    assert!(error.to_string().starts_with("direction B: 30 iterations"), "{error}");
    let error = tensor_product(&grid, 3, along(&cantor, 2), one, &go).unwrap_err();
    assert_eq!(error, SurfaceError::Disconnected { curve: 'A', strips: 4 });
    grid[4].w = -20.0;
    let error = tensor_product(&grid, 3, one, one, &go).unwrap_err();
    assert!(matches!(error, SurfaceError::Weight { a: 1, b: 1, weight } if weight < 0.0), "{error}");
    grid[4].w = f64::NAN;
    assert!(matches!(tensor_product(&grid, 3, one, one, &go), Err(SurfaceError::NotFinite { .. })));
}
