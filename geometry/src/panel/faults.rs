//! Border conditions, and bad faces: each is named, none costs its neighbours.

use super::shells::*;
use super::*;
use crate::mesh::{Mesh, MeshError};
use glam::DVec3;

fn quad(points: [(f64, f64, f64); 4]) -> Mesh {
    Mesh::from_faces(points.map(|(x, y, z)| DVec3::new(x, y, z)).to_vec(), &[[0, 1, 2, 3]])
}

fn square(side: f64) -> Mesh {
    quad([(0.0, 0.0, 0.0), (side, 0.0, 0.0), (side, side, 0.0), (0.0, side, 0.0)])
}

fn only_issue(mesh: &Mesh, params: &ThickenParams) -> PanelIssue {
    let (set, mut issues) = thicken(mesh, params).unwrap();
    assert_eq!(issues.len(), 1, "{issues:?}");
    assert_eq!(set.is_valid(issues[0].face() as usize), !issues[0].is_fatal());
    issues.remove(0)
}

#[test]
fn a_square_board_is_a_cuboid() {
    let (set, issues) = thicken(&square(100.0), &ThickenParams::new(10.0)).unwrap();
    assert_eq!(issues, []);
    let solid = set.solid(0);
    assert_eq!((solid.points.len(), solid.face_count()), (8, 6));
    assert!((set.volume(0) - 1e5).abs() < 1e-9);
    assert!((set.net_front_area() - 1e4).abs() < 1e-9);
    assert!((solid.surface_area() - 2.4e4).abs() < 1e-9);
    assert!(solid.points[4..].iter().all(|p| p.z == -10.0));
}

#[test]
fn each_side_has_its_own_cut() {
    // A vault whose feet (left and right sides) stand on the ground.
    let mesh = vector_sum(&arc(12, 4000.0, 1200.0), &[DVec3::ZERO, DVec3::Y * 300.0, DVec3::Y * 650.0]);
    let foot = BorderCut::InPlane { normal: DVec3::Z * 3.0 };
    let lean = 0.2f64;
    let mut border = BorderRule { left: foot, right: foot, top: BorderCut::Angle(lean), ..BorderRule::default() };
    border.edges.push(EdgeCut { face: 3, edge: 0, cut: BorderCut::Angle(-0.1) });
    let (set, issues) = thicken(&mesh, &ThickenParams { border, ..ThickenParams::new(21.0) }).unwrap();
    assert_eq!(issues, []);
    let mut seen = [0; 4];
    for i in 0..set.len() {
        for (k, c) in set.corners(i).enumerate() {
            if set.neighbour[c].get().is_some() {
                continue;
            }
            let (rise, ends) = (set.chamfer[c].normal.dot(set.normal[i]), [set.back_start[c], set.back_end[c]]);
            match set.side[c] {
                Side::Left | Side::Right => {
                    assert!((set.chamfer[c].normal.z + 1.0).abs() < 1e-14);
                    assert!(ends.iter().all(|p| p.z.abs() < 1e-12 * 4000.0));
                    seen[0] += 1;
                }
                Side::Top => {
                    assert!((rise + lean.sin()).abs() < 1e-14);
                    let inward = ends[0].y - 650.0;
                    assert!((inward + 21.0 * lean.tan()).abs() < 1e-10, "{inward}");
                    seen[1] += 1;
                }
                Side::Bottom if (i, k) == (3, 0) => {
                    assert!((rise - 0.1f64.sin()).abs() < 1e-14);
                    seen[2] += 1;
                }
                Side::Bottom => {
                    assert!(rise.abs() < 1e-14);
                    seen[3] += 1;
                }
                Side::Other => panic!("the mesh is a grid"),
            }
        }
    }
    assert_eq!(seen, [4, 12, 1, 11]);
}

#[test]
fn a_limit_plane_parallel_to_the_face_is_refused() {
    let border = BorderRule::all(BorderCut::InPlane { normal: DVec3::Z });
    let issue = only_issue(&square(100.0), &ThickenParams { border, ..ThickenParams::new(10.0) });
    let PanelIssue::BorderLean { face: 0, edge: 0, lean, .. } = issue else { panic!("{issue}") };
    assert!((lean - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
}

#[test]
fn a_flat_fold_is_refused_and_its_neighbour_lives() {
    // Three flaps: 1 is folded back onto 0, 2 stands upright.
    let p = |x, y, z| DVec3::new(x, y, z);
    let points = vec![
        p(0.0, 0.0, 0.0),
        p(100.0, 0.0, 0.0),
        p(100.0, 100.0, 0.0),
        p(0.0, 100.0, 0.0),
        p(0.0, 10.0, 0.0),
        p(100.0, 10.0, 0.0),
        p(0.0, 10.0, 100.0),
        p(100.0, 10.0, 100.0),
    ];
    let mesh = Mesh::from_faces(points, &[[0, 1, 2, 3], [3, 2, 5, 4], [4, 5, 7, 6]]);
    let (set, issues) = thicken(&mesh, &ThickenParams::new(5.0)).unwrap();
    let [PanelIssue::Fold { face: 0, edge: 2, neighbour: 1, angle, .. }, PanelIssue::Fold { face: 1, edge: 0, .. }] =
        issues[..]
    else {
        panic!("{issues:?}")
    };
    assert_eq!(angle, std::f64::consts::PI);
    assert_eq!([0, 1, 2].map(|i| set.is_valid(i)), [false, false, true]);
    assert!(set.neighbour.iter().all(|n| n.get().is_none()), "nobody meets a panel that could not be made");
}

#[test]
fn concave_straight_and_crossed_faces_are_named() {
    let params = ThickenParams::new(5.0);
    let arrow = quad([(0.0, 0.0, 0.0), (100.0, 0.0, 0.0), (20.0, 20.0, 0.0), (0.0, 100.0, 0.0)]);
    let issue = only_issue(&arrow, &params);
    let PanelIssue::Concave { face: 0, corner: 2, turn, .. } = issue else { panic!("{issue}") };
    assert!(turn < -0.1);
    let straight = quad([(0.0, 0.0, 0.0), (50.0, 0.0, 0.0), (100.0, 0.0, 0.0), (0.0, 100.0, 0.0)]);
    assert!(matches!(only_issue(&straight, &params), PanelIssue::Concave { corner: 1, .. }));
    let star = (0..5).map(|k| 2.0 * std::f64::consts::TAU * f64::from(k) / 5.0);
    let star = star.map(|t| DVec3::new(100.0 * t.cos(), 100.0 * t.sin(), 0.0)).collect();
    let star = Mesh::from_faces(star, &[[0, 1, 2, 3, 4]]);
    assert_eq!(only_issue(&star, &params), PanelIssue::CrossesItself { face: 0, turns: 2 });
}

#[test]
fn degenerate_faces_are_named() {
    let params = ThickenParams::new(5.0);
    let short = quad([(0.0, 0.0, 0.0), (100.0, 0.0, 0.0), (100.0, 1e-7, 0.0), (0.0, 100.0, 0.0)]);
    assert!(matches!(only_issue(&short, &params), PanelIssue::ShortEdge { face: 0, edge: 1, .. }));
    let line = quad([(0.0, 0.0, 0.0), (10.0, 0.0, 0.0), (30.0, 0.0, 0.0), (20.0, 0.0, 0.0)]);
    assert_eq!(only_issue(&line, &params), PanelIssue::NoArea { face: 0 });
}

#[test]
fn a_twisted_face_is_projected_up_to_the_tolerance() {
    let twisted = |z| quad([(0.0, 0.0, z), (100.0, 0.0, -z), (100.0, 100.0, z), (0.0, 100.0, -z)]);
    let params = ThickenParams::new(5.0);
    let issue = only_issue(&twisted(0.05), &params);
    let PanelIssue::Projected { face: 0, mismatch, moved } = issue else { panic!("{issue}") };
    assert!((mismatch - 0.05).abs() < 1e-12 && (moved - 0.05).abs() < 1e-4);
    let (set, _) = thicken(&twisted(0.05), &params).unwrap();
    assert!(set.front.iter().all(|p| p.z.abs() < 1e-15) && set.back_start.iter().all(|p| (p.z + 5.0).abs() < 1e-14));
    let issue = only_issue(&twisted(0.2), &params);
    let PanelIssue::NotPlanar { face: 0, mismatch, tolerance } = issue else { panic!("{issue}") };
    assert!((mismatch - 0.2).abs() < 1e-12 && tolerance == 0.1);
    let (_, issues) = thicken(&twisted(0.5e-4), &params).unwrap();
    assert_eq!(issues, []);
}

#[test]
fn too_thick_names_the_largest_thickness_that_works() {
    // A frustum: the back shrinks by d · tan(lean) on every side.
    let border = BorderRule::all(BorderCut::Angle(0.5));
    let params = |d| ThickenParams { border: border.clone(), ..ThickenParams::new(d) };
    let issue = only_issue(&square(30.0), &params(40.0));
    let PanelIssue::OffsetFlips { face: 0, largest, length, .. } = issue else { panic!("{issue}") };
    assert!((largest - 15.0 / 0.5f64.tan()).abs() < 1e-9);
    assert!(length < 0.0);
    assert_eq!(thicken(&square(30.0), &params(largest * 0.999_999)).unwrap().1, []);
    assert!(!thicken(&square(30.0), &params(largest * 1.000_001)).unwrap().1.is_empty());
}

#[test]
fn largest_thickness_holds_where_nodes_are_voided() {
    let mesh = shell();
    let flips = |d: f64| {
        let (set, issues) = thicken(&mesh, &ThickenParams::new(d)).unwrap();
        assert_eq!(set.len(), 256);
        issues
    };
    let thick = flips(2000.0);
    assert!(!thick.is_empty());
    let largest = |issue: &PanelIssue| match issue {
        PanelIssue::OffsetFlips { largest, .. } => *largest,
        other => panic!("{other}"),
    };
    // The tightest of all panels: just below everything works, just above something does not.
    let limit = thick.iter().map(largest).fold(f64::INFINITY, f64::min);
    assert_eq!(flips(limit * (1.0 - 1e-6)), []);
    assert!(!flips(limit * (1.0 + 1e-6)).is_empty());
}

#[test]
fn one_bad_panel_leaves_255_good_ones() {
    let mut mesh = shell();
    // The middle of one border edge is pulled inwards: a concave pentagon.
    let f = 5;
    let corners: Vec<Vec<u32>> = (0..256).map(|g| mesh.face(g).to_vec()).collect();
    let centre = mesh.face_centre(f);
    mesh.points.to_mut().push(centre);
    let extra = mesh.points.len() as u32 - 1;
    mesh.face_vertices.to_mut().clear();
    mesh.face_start = vec![0].into();
    for (g, face) in corners.iter().enumerate() {
        mesh.face_vertices.to_mut().push(face[0]);
        if g == f {
            mesh.face_vertices.to_mut().push(extra);
        }
        mesh.face_vertices.to_mut().extend(&face[1..]);
        mesh.face_start.to_mut().push(mesh.face_vertices.len() as u32);
    }
    let issue = only_issue(&mesh, &ThickenParams::new(10.0));
    assert!(matches!(issue, PanelIssue::Concave { face: 5, corner: 1, .. }), "{issue}");
    let (set, _) = thicken(&mesh, &ThickenParams::new(10.0)).unwrap();
    assert_eq!((0..256).filter(|&i| set.is_valid(i)).count(), 255);
    assert!(set.neighbour.iter().filter_map(|n| n.get()).all(|n| n.panel != 5));
    let (whole, _) = thicken(&shell(), &ThickenParams::new(10.0)).unwrap();
    for far in [100, 255] {
        assert_eq!(set.back_start[set.corners(far)], whole.back_start[whole.corners(far)]);
    }
    assert_eq!((set.volume(5), set.front_area(5), set.solid(5).face_count()), (0.0, 0.0, 0));
}

#[test]
fn wrong_parameters_and_meshes_are_refused() {
    for d in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(thicken(&square(1.0), &ThickenParams::new(d)), Err(ThickenError::Thickness(_))));
    }
    let bad = |change: &dyn Fn(&mut ThickenParams)| {
        let mut params = ThickenParams::new(5.0);
        change(&mut params);
        thicken(&square(100.0), &params).unwrap_err()
    };
    assert!(matches!(bad(&|p| p.max_lean = 2.0), ThickenError::Parameter { name: "max_lean", .. }));
    assert!(matches!(bad(&|p| p.merge = f64::NAN), ThickenError::Parameter { name: "merge", .. }));
    let zero = BorderCut::InPlane { normal: DVec3::ZERO };
    assert!(matches!(bad(&|p| p.border.top = zero), ThickenError::Parameter { .. }));
    let cut = EdgeCut { face: 0, edge: 4, cut: BorderCut::Square };
    assert_eq!(bad(&|p| p.border.edges.push(cut)), ThickenError::NoBorderEdge { face: 0, edge: 4 });
    let mut mesh = square(100.0);
    mesh.points.to_mut()[2].y = f64::NAN;
    assert_eq!(
        thicken(&mesh, &ThickenParams::new(5.0)).unwrap_err(),
        ThickenError::Mesh(MeshError::NotFinite { vertex: 2 })
    );
    let (set, issues) = thicken(&Mesh::default(), &ThickenParams::new(5.0)).unwrap();
    assert!(set.is_empty() && issues.is_empty());
}
