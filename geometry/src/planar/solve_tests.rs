//! Planarizing: real and made meshes reach the threshold within all bounds; what must stay stays; refusals.

use super::*;
use glam::{DAffine3, DQuat};
use proptest::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::{AtomicU32, Ordering};

fn go(_: f64) -> bool {
    true
}

fn run(mesh: &Mesh, params: &PlanarizeParams) -> Planarized {
    planarize(mesh, params, &go).unwrap()
}

/// An n × n grid over the square from -1 to 1.
fn grid(n: u32, point: impl Fn(f64, f64) -> DVec3) -> Mesh {
    let width = n + 1;
    let at = |i: u32| 2.0 * f64::from(i) / f64::from(n) - 1.0;
    let points = (0..width * width).map(|i| point(at(i % width), at(i / width))).collect();
    let faces: Vec<[u32; 4]> =
        (0..n * n).map(|f| f / n * width + f % n).map(|v| [v, v + 1, v + 1 + width, v + width]).collect();
    Mesh::from_faces(points, &faces)
}

fn dome(u: f64, v: f64) -> DVec3 {
    DVec3::new(2000.0 * u, 2000.0 * v, 800.0 * (1.0 - u * u) * (1.0 - v * v))
}

fn wave(u: f64, v: f64) -> DVec3 {
    let lift = 500.0 * (1.5 * u + 0.5 * v + 2.0).sin() + 50.0 * (u + 1.0) * (v + 1.0);
    DVec3::new(2000.0 * u + 150.0 * (1.5 * v + 1.5).sin(), 2000.0 * v, lift)
}

fn saddle(u: f64, v: f64) -> DVec3 {
    DVec3::new(2000.0 * u, 2000.0 * v, 300.0 * u * v)
}

fn rough(u: f64, v: f64) -> DVec3 {
    let noise = ((u * 129.898 + v * 782.33).sin() * 43758.5453).fract();
    DVec3::new(2000.0 * u, 2000.0 * v, 300.0 * u * u + 8.0 * noise)
}

/// What must hold of every result, reached or not.
fn assert_within_bounds(mesh: &Mesh, params: &PlanarizeParams, result: &Planarized) {
    assert!(result.moved_edges <= params.reach, "moved {} edges", result.moved_edges);
    assert!(result.turned < std::f64::consts::FRAC_PI_2, "a face turned by {}", result.turned);
    assert_eq!(result.after.summary().concave_faces, result.before.summary().concave_faces);
    assert_eq!(result.before, Planarity::measure(mesh).unwrap());
    assert_eq!(result.after, Planarity::measure(&result.mesh).unwrap());
    assert_eq!(result.reached, result.deviation <= params.threshold);
    assert_eq!(result.history.len(), result.iterations as usize + 1);
    assert_eq!(result.mesh.face_vertices, mesh.face_vertices);
}

#[test]
fn curved_meshes_become_planar_within_their_bounds() {
    for (name, shape) in [("dome", dome as fn(f64, f64) -> DVec3), ("wave", wave), ("saddle", saddle), ("rough", rough)]
    {
        for n in [8, 16, 32] {
            for reach in [0.5, 1.0, 4.0] {
                let mesh = grid(n, shape);
                let params = PlanarizeParams { reach, ..PlanarizeParams::default() };
                let result = run(&mesh, &params);
                assert_within_bounds(&mesh, &params, &result);
                assert!(result.reached, "{name} {n} reach {reach}: {} mm", result.deviation);
                // With room to move the smooth answer is found, without crumpling.
                if reach == 4.0 {
                    assert!(result.fold_after <= result.fold_before + 0.02, "{name} {n}: {}", result.fold_after);
                }
            }
        }
    }
}

/// The folder with data of others, beside the project; tests that need it say so where it is missing.
fn shared(name: &str, unit: f64) -> Option<Mesh> {
    let beside = PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared"));
    let folder = std::env::var_os("TENON_SHARED").map_or(beside, PathBuf::from);
    let path = folder.join("data/meshes").join(name);
    let Ok(text) = std::fs::read_to_string(&path) else {
        assert!(std::env::var_os("CI").is_none(), "{} must be there in CI", path.display());
        println!("skipped: no {}", path.display());
        return None;
    };
    let mut mesh = Mesh { face_start: vec![0].into(), ..Mesh::default() };
    for line in text.lines() {
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let x: Vec<f64> = words.map(|w| w.parse().unwrap()).collect();
                mesh.points.to_mut().push(DVec3::new(x[0], x[1], x[2]) * unit);
            }
            Some("f") => {
                let index = |w: &str| w.split('/').next().unwrap().parse::<u32>().unwrap() - 1;
                mesh.face_vertices.to_mut().extend(words.map(index));
                mesh.face_start.to_mut().push(mesh.face_vertices.len() as u32);
            }
            _ => {}
        }
    }
    Some(mesh)
}

#[test]
fn meshes_of_others_become_planar() {
    for (name, unit) in [("quadmesh.obj", 1000.0), ("rhinomesh.obj", 1000.0), ("faces.obj", 500.0)] {
        let Some(mesh) = shared(name, unit) else { continue };
        for params in [
            PlanarizeParams::default(),
            PlanarizeParams { reach: 0.5, ..PlanarizeParams::default() },
            PlanarizeParams { reach: 0.5, fairness: 0.0, ..PlanarizeParams::default() },
        ] {
            let result = run(&mesh, &params);
            assert_within_bounds(&mesh, &params, &result);
            assert!(result.reached, "{name}: {}", result.deviation);
            assert!(result.moved_edges < 0.25, "{name}: {}", result.moved_edges);
        }
        if name == "quadmesh.obj" {
            let before = Planarity::measure(&mesh).unwrap().summary();
            assert!((before.diagonal_max - 0.0329).abs() < 1e-4, "3.3 % out of plane: {}", before.diagonal_max);
        }
    }
}

#[test]
fn a_planar_mesh_comes_back_bit_by_bit() {
    // A folded surface of parallelograms: sum of two zigzags.
    let zigzag = |t: f64| 90.0 * (4.0 * t + 4.0).rem_euclid(2.0);
    let mesh = grid(8, |u, v| DVec3::new(1000.0 * u, 1200.0 * v + zigzag(u), zigzag(u) + 2.0 * zigzag(v)));
    let result = run(&mesh, &PlanarizeParams { threshold: 1e-9, ..PlanarizeParams::default() });
    assert_eq!((&result.mesh, result.iterations, result.moved_max), (&mesh, 0, 0.0));
    assert!(result.reached && result.fold_after > 0.1);
    // And one that was made planar stays as it is, too.
    let once = run(&grid(8, dome), &PlanarizeParams::default());
    assert_eq!(run(&once.mesh, &PlanarizeParams::default()).mesh, once.mesh);
}

/// A curved mesh of parallelograms (a sum of two parabolas), its vertices shaken where `shake` says so: even with the
/// others fixed there is a planar answer nearby.
fn shaken(n: u32, shake: impl Fn(u32, u32) -> bool) -> Mesh {
    let mut mesh = grid(n, |u, v| DVec3::new(1500.0 * u, 1500.0 * v, 400.0 * (u * u + 0.7 * v * v)));
    for (i, p) in mesh.points.to_mut().iter_mut().enumerate() {
        let (x, y) = (i as u32 % (n + 1), i as u32 / (n + 1));
        if shake(x, y) {
            let noise = |k: f64| ((i as f64 + k) * 12.9898).sin() * 12.0;
            *p += DVec3::new(noise(0.1), noise(0.2), noise(0.3));
        }
    }
    mesh
}

#[test]
fn what_is_fixed_stays_bit_by_bit() {
    let border = |x: u32, y: u32| [x, y].iter().any(|k| *k == 0 || *k == 10);
    let kept = |x: u32, y: u32| border(x, y) || (x, y) == (5, 5) || (x, y) == (6, 5);
    let mesh = shaken(10, |x, y| !kept(x, y));
    let params = PlanarizeParams { border: Rim::Fixed, fixed: vec![60, 61], ..PlanarizeParams::default() };
    let result = run(&mesh, &params);
    assert_within_bounds(&mesh, &params, &result);
    assert!(result.reached && result.history[0] > 10.0, "{} of {}", result.deviation, result.history[0]);
    for v in 0..121 {
        let moved = result.mesh.points[v as usize] != mesh.points[v as usize];
        assert_eq!(moved, !kept(v % 11, v / 11), "vertex {v}");
    }
}

#[test]
fn a_region_leaves_the_rest_alone() {
    let inside = |x: u32, y: u32| (4..9).contains(&x) && (4..9).contains(&y);
    let mesh = shaken(12, inside);
    let region: Vec<u32> = (0..144).filter(|f| (3..9).contains(&(f % 12)) && (3..9).contains(&(f / 12))).collect();
    let mut params = PlanarizeParams { region: Some(region.clone()), ..PlanarizeParams::default() };
    let held = run(&mesh, &params);
    assert_within_bounds(&mesh, &params, &held);
    assert!(held.reached && held.history[0] > 10.0, "{} of {}", held.deviation, held.history[0]);
    for v in 0..169 {
        let moved = held.mesh.points[v as usize] != mesh.points[v as usize];
        assert_eq!(moved, inside(v % 13, v / 13), "vertex {v}");
    }
    params.rim = Rim::Free;
    let free = run(&mesh, &params);
    assert_within_bounds(&mesh, &params, &free);
    assert!(free.reached && region.iter().all(|&f| free.after.corner[f as usize] <= params.threshold));
    assert!(free.moved_rms < held.moved_rms);
    // The rim may move, vertices that have no corner in the region may not.
    for v in 0..169 {
        let moved = free.mesh.points[v as usize] != mesh.points[v as usize];
        assert_eq!(moved, (3..10).contains(&(v % 13)) && (3..10).contains(&(v / 13)), "vertex {v}");
    }
}

#[test]
fn out_of_reach_is_said_and_nothing_is_broken() {
    let mesh = grid(8, saddle);
    let params = PlanarizeParams { reach: 0.02, ..PlanarizeParams::default() };
    let result = run(&mesh, &params);
    assert_within_bounds(&mesh, &params, &result);
    assert!(!result.reached && result.deviation > 1.0 && result.deviation <= result.history[0]);
    let all = PlanarizeParams { fixed: (0..81).collect(), ..PlanarizeParams::default() };
    let result = run(&mesh, &all);
    assert_eq!((&result.mesh, result.reached, result.iterations), (&mesh, false, 0));
    let short = PlanarizeParams { iterations: 2, ..PlanarizeParams::default() };
    assert_eq!(run(&mesh, &short).iterations, 2);
}

#[test]
fn fairness_spreads_the_move() {
    let mesh = grid(8, dome);
    let bend = |result: &Planarized| {
        let d = |i: usize| result.mesh.points[i] - mesh.points[i];
        (0..81)
            .filter(|i| (1..8).contains(&(i % 9)) && (1..8).contains(&(i / 9)))
            .map(|i| {
                (d(i - 1) + d(i + 1) - 2.0 * d(i)).length_squared()
                    + (d(i - 9) + d(i + 9) - 2.0 * d(i)).length_squared()
            })
            .sum::<f64>()
    };
    let with = |fairness| run(&mesh, &PlanarizeParams { fairness, ..PlanarizeParams::default() });
    let (close, fair) = (with(0.0), with(30.0));

    assert!(close.reached && fair.reached);
    assert!(bend(&fair) < 0.9 * bend(&close), "{} {}", bend(&fair), bend(&close));
    assert!(close.moved_rms < fair.moved_rms);
}

#[test]
fn hexagons_become_planar() {
    // A honeycomb on a dome: rows of hexagons that share vertices.
    let (mut points, mut faces) = (Vec::new(), Vec::new());
    for row in 0..5 {
        for column in 0..5 {
            for k in 0..6 {
                let (s, c) = (f64::from(k) * std::f64::consts::FRAC_PI_3 + std::f64::consts::FRAC_PI_6).sin_cos();
                let x = 3f64.sqrt() * (f64::from(column) + 0.5 * f64::from(row % 2)) + c - 4.0;
                let y = 1.5 * f64::from(row) + s - 3.0;
                points.push(DVec3::new(200.0 * x, 200.0 * y, -20.0 * (x * x + 0.5 * x * y + 0.1 * x * x * x)));
            }
            let first = points.len() as u32 - 6;
            faces.push([0, 1, 2, 3, 4, 5].map(|k| first + k));
        }
    }
    let mesh = crate::mesh::weld(&Mesh::from_faces(points, &faces), 1e-6).unwrap().mesh;
    let params = PlanarizeParams::default();
    let result = run(&mesh, &params);
    assert!(result.history[0] > 1.0);
    assert_within_bounds(&mesh, &params, &result);
    assert!(result.reached, "{}", result.deviation);
}

#[test]
fn a_turned_over_face_does_no_harm() {
    let mut mesh = grid(6, dome);
    mesh.face_vertices.to_mut()[40..44].reverse();
    let result = run(&mesh, &PlanarizeParams::default());
    assert!(result.reached && result.after.summary().concave_faces == 0);
}

#[test]
fn cancelling_ends_it() {
    let mesh = grid(16, dome);
    let calls = AtomicU32::new(0);
    let until = |n: u32| {
        calls.store(0, Ordering::Relaxed);
        planarize(&mesh, &PlanarizeParams::default(), &|_| calls.fetch_add(1, Ordering::Relaxed) < n)
    };
    assert_eq!(until(0), Err(PlanarizeError::Cancelled));
    assert_eq!(until(9), Err(PlanarizeError::Cancelled));
    assert!(until(u32::MAX).is_ok() && calls.load(Ordering::Relaxed) > 9);
}

#[test]
fn senseless_parameters_are_refused() {
    let mesh = grid(2, dome);
    let refuse = |params: PlanarizeParams| planarize(&mesh, &params, &go).unwrap_err();
    let base = PlanarizeParams::default;
    for params in [
        PlanarizeParams { threshold: 0.0, ..base() },
        PlanarizeParams { threshold: f64::NAN, ..base() },
        PlanarizeParams { reach: -1.0, ..base() },
        PlanarizeParams { reach: f64::INFINITY, ..base() },
        PlanarizeParams { closeness: -1.0, ..base() },
        PlanarizeParams { fairness: f64::NAN, ..base() },
        PlanarizeParams { closeness: 0.0, fairness: 0.0, ..base() },
    ] {
        assert!(matches!(refuse(params), PlanarizeError::BadParameter { .. }));
    }
    assert_eq!(
        refuse(PlanarizeParams { region: Some(vec![0, 4]), ..base() }),
        PlanarizeError::NoSuch { what: "face", index: 4, count: 4 }
    );
    assert_eq!(
        refuse(PlanarizeParams { fixed: vec![9], ..base() }),
        PlanarizeError::NoSuch { what: "vertex", index: 9, count: 9 }
    );
    assert!(run(&mesh, &PlanarizeParams { closeness: 0.0, ..base() }).reached);
}

#[test]
fn broken_meshes_are_refused() {
    let mut mesh = grid(3, dome);
    mesh.points.to_mut()[5] = mesh.points[0];
    mesh.points.to_mut()[1] = mesh.points[0];
    assert_eq!(planarize(&mesh, &PlanarizeParams::default(), &go), Err(PlanarizeError::NoArea { face: 0 }));
    mesh.points.to_mut()[5].x = f64::NAN;
    assert!(matches!(planarize(&mesh, &PlanarizeParams::default(), &go), Err(PlanarizeError::Mesh(_))));
    let empty = Mesh { face_start: vec![0].into(), ..Mesh::default() };
    assert!(run(&empty, &PlanarizeParams::default()).reached);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]
    #[test]
    fn a_rigid_motion_and_a_change_of_unit_go_through(
        axis in (-1.0..1.0f64, -1.0..1.0f64, -1.0..1.0f64),
        angle in -3.0..3.0f64,
        shift in (-1e4..1e4f64, -1e4..1e4f64, -1e4..1e4f64),
        scale in 0.01..100.0f64,
        height in 100.0..600.0f64,
        n in 2u32..7,
    ) {
        let Some(axis) = DVec3::from(axis).try_normalize() else { return Ok(()) };
        let turn = DQuat::from_axis_angle(axis, angle);
        let motion = DAffine3::from_scale_rotation_translation(DVec3::splat(scale), turn, DVec3::from(shift));
        let mesh = grid(n, |u, v| dome(u, v) * DVec3::new(1.0, 1.0, height / 800.0));
        let moved = Mesh { points: mesh.points.iter().map(|p| motion.transform_point3(*p)).collect(), ..mesh.clone() };
        let params = PlanarizeParams { threshold: 1e-6, ..PlanarizeParams::default() };
        let here = run(&mesh, &params);
        let there = run(&moved, &PlanarizeParams { threshold: 1e-6 * scale, ..params });
        prop_assert!(here.reached && there.reached);
        for (p, q) in here.mesh.points.iter().zip(&there.mesh.points) {
            prop_assert!(motion.transform_point3(*p).distance(*q) < 1e-4 * scale, "{p} {q}");
        }
    }

    #[test]
    fn a_sum_of_two_polylines_is_planar_already(
        a in prop::collection::vec((-200.0..200.0f64, -200.0..200.0f64, -200.0..200.0f64), 7),
        b in prop::collection::vec((-200.0..200.0f64, -200.0..200.0f64, -200.0..200.0f64), 7),
    ) {
        let index = |t: f64| (3.0 * t + 3.0).round() as usize;
        let mesh = grid(6, |u, v| {
            DVec3::new(900.0 * u, 900.0 * v, 0.0) + DVec3::from(a[index(u)]) + DVec3::from(b[index(v)])
        });
        let result = run(&mesh, &PlanarizeParams { threshold: 1e-6, ..PlanarizeParams::default() });
        prop_assert_eq!((&result.mesh, result.iterations, result.moved_max), (&mesh, 0, 0.0));
        prop_assert!(result.reached);
    }

    #[test]
    fn random_meshes_stay_within_their_bounds(
        bumps in prop::collection::vec((-60.0..60.0f64, -60.0..60.0f64, -120.0..120.0f64), 36),
        reach in 0.1..1.0f64,
        fairness in prop_oneof![Just(0.0), 0.1..50.0f64],
        border in prop_oneof![Just(Rim::Fixed), Just(Rim::Free)],
    ) {
        let mut mesh = grid(5, saddle);
        mesh.points.to_mut().iter_mut().zip(bumps).for_each(|(p, bump)| *p += DVec3::from(bump));
        let params = PlanarizeParams { reach, fairness, border, iterations: 60, ..PlanarizeParams::default() };
        let result = run(&mesh, &params);
        assert_within_bounds(&mesh, &params, &result);
        prop_assert!(result.deviation <= result.history[0] + 1e-9);
    }
}
