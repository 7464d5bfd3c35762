//! Laws of thickening: parallel at exactly d, watertight and convex, no overlap at edges and nodes.

use super::shells::*;
use super::*;
use crate::mesh::Mesh;
use glam::DVec3;
use proptest::prelude::*;
use std::collections::{BTreeMap, BTreeSet};

/// Pairs of panels that share a vertex (and so all that share an edge).
fn neighbours(mesh: &Mesh) -> BTreeSet<(usize, usize)> {
    let mut at = vec![Vec::new(); mesh.points.len()];
    for f in 0..mesh.face_count() {
        mesh.face(f).iter().for_each(|&v| at[v as usize].push(f));
    }
    at.iter().flat_map(|fs| fs.iter().flat_map(|&f| fs.iter().map(move |&g| (f, g)))).filter(|(f, g)| f < g).collect()
}

/// The greatest volume shared by two neighbours: in mm³, and as a share of the smaller panel.
fn overlap(mesh: &Mesh, set: &PanelSet) -> (f64, f64) {
    let solids: Vec<Solid> = (0..set.len()).map(|i| set.solid(i)).collect();
    neighbours(mesh).into_iter().fold((0.0, 0.0), |(most, share), (f, g)| {
        let v = solids[f].shared_volume(&solids[g]);
        let smaller = solids[f].volume().min(solids[g].volume());
        (f64::max(most, v), if smaller > 0.0 { f64::max(share, v / smaller) } else { share })
    })
}

fn check_solid(set: &PanelSet, i: usize, rounding: f64) {
    let s = set.solid(i);
    let mut edges = BTreeMap::new();
    for f in 0..s.face_count() {
        let face = s.face(f);
        for (k, &a) in face.iter().enumerate() {
            *edges.entry((a, face[(k + 1) % face.len()])).or_insert(0) += 1;
        }
        for &v in face {
            assert!(s.planes[f].distance(s.points[v as usize]).abs() < rounding, "panel {i} face {f} is not planar");
        }
        for p in &s.points {
            assert!(s.planes[f].distance(*p) < rounding, "panel {i} is not convex at face {f}");
        }
    }
    for (&(a, b), &n) in &edges {
        assert_eq!((n, edges.get(&(b, a))), (1, Some(&1)), "panel {i} is not closed");
    }
    assert!(s.volume() > 0.0);
}

fn check_all(mesh: &Mesh, set: &PanelSet, d: f64) {
    let size = mesh.points.iter().map(|p| p.length()).fold(1.0, f64::max);
    for i in 0..set.len() {
        let plane = set.front_plane(i).unwrap();
        for c in set.corners(i) {
            assert!(plane.distance(set.front[c]).abs() < 1e-12 * size);
            for p in [set.back_start[c], set.back_end[c]] {
                assert!((plane.distance(p) + d).abs() < 1e-12 * size.max(d), "{}", plane.distance(p) + d);
            }
        }
        check_solid(set, i, 1e-11 * size);
    }
}

#[test]
fn the_shell_has_no_overlap_and_voiding_is_why() {
    let mesh = shell();
    for d in [10.0, 21.0] {
        let (set, issues) = thicken(&mesh, &ThickenParams::new(d)).unwrap();
        assert_eq!(issues, []);
        check_all(&mesh, &set, d);
        let (most, share) = overlap(&mesh, &set);
        assert!(share <= 1e-9, "{most} mm³, {share}");
        let (kept, _) = thicken(&mesh, &ThickenParams { nodes: Nodes::Keep, ..ThickenParams::new(d) }).unwrap();
        assert!(kept.voided.iter().all(|v| !v));
        let (most, share) = overlap(&mesh, &kept);
        assert!(share > 1e-9 && most > 1.0, "without voiding: {most} mm³, {share}");
    }
}

/// A triangulated height field: inner nodes of valence 6, not conical.
fn triangles(n: usize, step: f64, heights: &[f64]) -> Mesh {
    let quads = grid(n + 1, n + 1, |i, j| {
        let skew = step * (0.5 * j as f64 + 0.1 * (1.7 * (i * j) as f64).sin());
        DVec3::new(step * i as f64 + skew, step * 0.9 * j as f64, heights[(i + 7 * j) % heights.len()])
    });
    let faces: Vec<[u32; 3]> = (0..quads.face_count())
        .flat_map(|f| {
            let q = quads.face(f);
            [[q[0], q[1], q[3]], [q[1], q[2], q[3]]]
        })
        .collect();
    Mesh::from_faces(quads.points.to_vec(), &faces)
}

/// A projective image: planar faces stay planar, nothing stays parallel.
fn projected(mut mesh: Mesh) -> Mesh {
    for p in mesh.points.to_mut() {
        *p /= 1.0 + p.x * 2e-4 + p.y * 1e-4 + p.z * 3e-4;
    }
    mesh
}

/// Part of a sphere with meridians and parallels: every inner node is conical.
fn dome() -> Mesh {
    grid(9, 7, |i, j| {
        let (along, up) = (0.15 * i as f64, 0.2 + 0.15 * j as f64);
        2000.0 * DVec3::new(up.cos() * along.cos(), up.cos() * along.sin(), up.sin())
    })
}

#[test]
fn conical_nodes_are_not_voided() {
    let mesh = dome();
    let (set, issues) = thicken(&mesh, &ThickenParams::new(21.0)).unwrap();
    assert_eq!(issues, []);
    check_all(&mesh, &set, 21.0);
    let inner = |v: u32| (1..8).contains(&(v % 9)) && (1..6).contains(&(v / 9));
    let voided = (0..set.front.len()).filter(|&c| inner(set.vertex[c]) && set.voided[c]).count();
    assert_eq!(voided, 0);
    assert!(overlap(&mesh, &set).1 <= 1e-9);
}

#[test]
fn nodes_of_six_panels_do_not_overlap() {
    let heights: Vec<f64> = (0..49).map(|i| 40.0 * (5.3 * f64::from(i)).sin()).collect();
    let mesh = triangles(6, 250.0, &heights);
    let (set, issues) = thicken(&mesh, &ThickenParams::new(21.0)).unwrap();
    assert_eq!(issues, []);
    check_all(&mesh, &set, 21.0);
    assert!(overlap(&mesh, &set).1 <= 1e-9);
    let (kept, _) = thicken(&mesh, &ThickenParams { nodes: Nodes::Keep, ..ThickenParams::new(21.0) }).unwrap();
    assert!(overlap(&mesh, &kept).1 > 1e-6);
}

#[test]
fn chamfers_of_neighbours_coincide() {
    let mesh = shell();
    let (set, _) = thicken(&mesh, &ThickenParams::new(21.0)).unwrap();
    let mut inner = 0;
    for c in 0..set.front.len() {
        let Some(n) = set.neighbour[c].get() else { continue };
        let t = set.corners(n.panel as usize).start + n.edge as usize;
        inner += 1;
        assert_eq!(set.chamfer[c].normal, -set.chamfer[t].normal);
        assert_eq!(set.chamfer[c].offset, -set.chamfer[t].offset);
        assert!(set.back_start[c].distance(set.back_end[t]) < 1e-9);
    }
    assert_eq!(inner, 2 * 2 * 15 * 16);
}

#[test]
fn planarized_meshes_do_not_overlap() {
    use crate::planar::{PlanarizeParams, planarize};
    let dome = grid(9, 9, |i, j| {
        let (x, y) = (i as f64 / 4.0 - 1.0, j as f64 / 4.0 - 1.0);
        DVec3::new(2000.0 * x + 150.0 * y * y, 2000.0 * y, 700.0 * (1.0 - x * x) * (1.2 - y * y))
    });
    let planar = planarize(&dome, &PlanarizeParams::default(), &|_| true).unwrap();
    assert!(planar.reached);
    let (set, issues) = thicken(&planar.mesh, &ThickenParams::new(21.0)).unwrap();
    assert_eq!(issues, []);
    check_all(&planar.mesh, &set, 21.0);
    assert!(set.voided.iter().filter(|v| **v).count() > 100);
    assert!(overlap(&planar.mesh, &set).1 <= 1e-9);
}

#[test]
fn faces_at_the_edge_of_planar_do_not_overlap() {
    let mut mesh = shell();
    for (k, p) in mesh.points.to_mut().iter_mut().enumerate() {
        *p += 5e-5 * DVec3::new((k as f64 * 12.9).sin(), (k as f64 * 7.3).sin(), (k as f64 * 3.7).sin());
    }
    let (set, issues) = thicken(&mesh, &ThickenParams::new(21.0)).unwrap();
    assert_eq!(issues, []);
    check_all(&mesh, &set, 21.0);
    let (most, share) = overlap(&mesh, &set);
    assert!(share <= 1e-9, "{most} mm³, {share}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn random_vector_sums_do_not_overlap(
        a in prop::collection::vec((150.0..300.0, -90.0..90.0, -90.0..90.0), 4),
        b in prop::collection::vec((-90.0..90.0, 150.0..300.0, -90.0..90.0), 4),
        d in 5.0..25.0,
        project: bool,
    ) {
        let walk = |steps: &[(f64, f64, f64)]| {
            let mut out = vec![DVec3::ZERO];
            let mut p = DVec3::ZERO;
            for &(x, y, z) in steps {
                p += DVec3::new(x, y, z);
                out.push(p);
            }
            out
        };
        let mesh = vector_sum(&walk(&a), &walk(&b));
        let mesh = if project { projected(mesh) } else { mesh };
        let (set, issues) = thicken(&mesh, &ThickenParams::new(d)).unwrap();
        prop_assert_eq!(issues, vec![]);
        check_all(&mesh, &set, d);
        let (most, share) = overlap(&mesh, &set);
        prop_assert!(share <= 1e-9, "{} mm³, {}", most, share);
    }

    #[test]
    fn random_triangle_meshes_do_not_overlap(heights in prop::collection::vec(0.0..80.0, 25), d in 5.0..25.0) {
        let mesh = triangles(4, 250.0, &heights);
        let (set, issues) = thicken(&mesh, &ThickenParams::new(d)).unwrap();
        prop_assert_eq!(issues, vec![]);
        check_all(&mesh, &set, d);
        let (most, share) = overlap(&mesh, &set);
        prop_assert!(share <= 1e-9, "{} mm³, {}", most, share);
    }
}
