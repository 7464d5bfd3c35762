//! Laws of thickening: parallel at exactly d, watertight and convex, no overlap at edges and nodes.

use super::shells::*;
use super::*;
use crate::mesh::Mesh;
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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn random_vector_sums_do_not_overlap(
        a in prop::collection::vec((150.0..300.0, -60.0..60.0, -60.0..60.0), 4),
        b in prop::collection::vec((-60.0..60.0, 150.0..300.0, -60.0..60.0), 4),
        d in 5.0..25.0,
    ) {
        let walk = |steps: &[(f64, f64, f64)]| {
            let mut p = glam::DVec3::ZERO;
            let mut out = vec![p];
            for &(x, y, z) in steps {
                p += glam::DVec3::new(x, y, z);
                out.push(p);
            }
            out
        };
        let mesh = vector_sum(&walk(&a), &walk(&b));
        let (set, issues) = thicken(&mesh, &ThickenParams::new(d)).unwrap();
        prop_assert_eq!(issues, vec![]);
        check_all(&mesh, &set, d);
        let (most, share) = overlap(&mesh, &set);
        prop_assert!(share <= 1e-9, "{} mm³, {}", most, share);
    }
}
