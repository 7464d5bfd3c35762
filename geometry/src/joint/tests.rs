//! Fasteners on a real shell: matched, spaced, covered, counted.

use super::*;
use crate::board::Up;
use crate::mesh::Mesh;
use crate::panel::{BorderCut, BorderRule, PanelSet, ThickenParams, shells, thicken};
use glam::DVec3;

fn panels(mesh: &Mesh, d: f64) -> PanelSet {
    let (set, issues) = thicken(mesh, &ThickenParams::new(d)).unwrap();
    assert_eq!(issues, []);
    set
}

/// A shell that is folded gently enough for all its fasteners.
fn shell(d: f64) -> PanelSet {
    panels(&shells::vector_sum(&shells::arc(16, 4500.0, 1400.0), &shells::folded(16, 280.0, 25.0)), d)
}

/// (entry, axis, depth, diameter) of a drilled hole.
fn hole(f: &Feature) -> (DVec3, DVec3, f64, f64) {
    match f.machining {
        Machining::Drill { entry, axis, depth, diameter } => (entry, axis, depth, diameter),
        _ => panic!("no hole"),
    }
}

/// The features of each joint.
fn joints(features: &FeatureSet) -> Vec<Vec<&Feature>> {
    let count = features.features.iter().filter_map(|f| f.joint).max().map_or(0, |m| m + 1);
    let mut all = vec![Vec::new(); count as usize];
    for f in &features.features {
        all[f.joint.unwrap() as usize].push(f);
    }
    all
}

fn assert_coaxial(features: &FeatureSet) {
    for joint in joints(features) {
        let [a, b] = joint[..] else { panic!("{} holes", joint.len()) };
        let ((p, u, ..), (q, v, ..)) = (hole(a), hole(b));
        assert!(u.cross(v).length() < 1e-9);
        assert!((q - p).cross(u).length() < 1e-9);
        assert_ne!(a.panel, b.panel);
    }
}

/// Points all over the hole that must be wood's, with the cover to the panel's faces that the hole does not pass.
fn assert_inside(set: &PanelSet, f: &Feature, passed: usize, cover: f64) {
    let (entry, axis, depth, diameter) = hole(f);
    let solid = set.solid(f.panel as usize);
    let side = axis.any_orthonormal_vector();
    for k in 0..24 {
        let t = f64::from(k) * 15f64.to_radians();
        let out = (side * t.cos() + axis.cross(side) * t.sin()) * diameter * 0.5;
        let point = diameter * 0.5 / 59f64.to_radians().tan();
        let near: Vec<f64> = solid.planes.iter().map(|p| -p.distance(entry + out + axis * (depth - point))).collect();
        let tip: Vec<f64> = solid.planes.iter().map(|p| -p.distance(entry + axis * depth)).collect();
        for wood in [near, tip] {
            assert!(wood.iter().filter(|&&w| w < cover - 1e-9).count() <= passed, "{f:?}: {wood:?}");
        }
    }
}

#[test]
fn toe_screws_on_every_inner_edge_of_a_thin_shell() {
    let set = shell(10.0);
    let rule = FastenerRule::toe_screws(Up::Front);
    let (laid, issues) = lay_fasteners(&set, &rule).unwrap();
    assert_eq!(issues, []);
    assert_coaxial(&laid);
    let inner = set.neighbour.iter().filter_map(|n| n.get()).count() / 2;
    let all = joints(&laid);
    assert!(all.len() >= 2 * inner);
    assert_eq!(laid.hardware.iter().map(|h| h.count).sum::<u64>(), all.len() as u64);
    assert!(laid.features.is_sorted_by_key(|f| f.panel));
    for joint in all {
        // One hole starts on its panel's front at 45° to it, the other on the chamfer, where the first passes.
        let on_front = |f: &&Feature| {
            let plane = set.front_plane(f.panel as usize).unwrap();
            plane.distance(hole(f).0).abs() < 1e-9
        };
        let (heads, bites): (Vec<_>, Vec<_>) = joint.into_iter().partition(on_front);
        let ([head], [bite]) = (&heads[..], &bites[..]) else { panic!("{heads:?} {bites:?}") };
        let (entry, axis, depth, diameter) = hole(head);
        assert_eq!(diameter, 3.0);
        assert!((axis.dot(set.normal[head.panel as usize]) + std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-12);
        let chamfer = set.chamfer[set.corners(head.panel as usize).start + head.edge.unwrap() as usize];
        assert!(chamfer.distance(entry + axis * depth) > 0.0, "the hole goes through");
        let (mouth, ..) = hole(bite);
        assert!(chamfer.distance(mouth).abs() < 1e-9);
        let along = chamfer.normal.cross(set.normal[head.panel as usize]).normalize();
        assert!(axis.dot(along).abs() < 1e-12, "in the plane normal to the edge");
        assert_inside(&set, bite, 0, 1.0);
    }
}

#[test]
fn dowels_and_screws_on_a_thick_shell() {
    let set = shell(21.0);
    for direction in [Direction::ChamferNormal, Direction::Section(0.02)] {
        let rule = FastenerRule { end_distance: 50.0, ..FastenerRule::dowels(direction) };
        let (laid, issues) = lay_fasteners(&set, &rule).unwrap();
        assert_eq!(issues, []);
        assert_coaxial(&laid);
        for f in &laid.features {
            let (_, axis, depth, diameter) = hole(f);
            assert_eq!((depth, diameter, &*f.purpose), (21.0, 6.0, "dowel"));
            let c = set.corners(f.panel as usize).start + f.edge.unwrap() as usize;
            assert!(axis.dot(set.chamfer[c].normal) < -0.9);
            if direction == Direction::ChamferNormal {
                assert_eq!(axis.dot(set.chamfer[c].normal).round(), -1.0);
            }
            assert_inside(&set, f, 0, 2.0);
        }
        let [ref dowels] = laid.hardware[..] else { panic!("{:?}", laid.hardware) };
        assert_eq!(dowels.name, "Dowel 6 x 40");
        assert_eq!(dowels.count as usize * 2, laid.features.len());
    }
    let (laid, issues) = lay_fasteners(&set, &FastenerRule { end_distance: 60.0, ..FastenerRule::screws() }).unwrap();
    assert_eq!(issues, []);
    assert_eq!(laid.hardware[0].name, "Screw 5 x 60");
}

#[test]
fn balanced_holes_go_deeper() {
    let set = panels(&shells::shell(), 21.0);
    let rule = FastenerRule { end_distance: 60.0, ..FastenerRule::dowels(Direction::ChamferNormal) };
    let laid = [Height::At(0.5), Height::Balanced].map(|height| {
        let (laid, issues) = lay_fasteners(&set, &FastenerRule { height, ..rule }).unwrap();
        assert_coaxial(&laid);
        laid.features.iter().for_each(|f| assert_inside(&set, f, 0, 2.0));
        let fatal = issues.iter().filter(|i| i.is_fatal()).count();
        (joints(&laid).len(), fatal)
    });
    assert!(laid[1].0 > laid[0].0 && laid[1].1 < laid[0].1, "{laid:?}");
}

#[test]
fn spacing_follows_the_engineer() {
    // Two squares of 1000 mm side by side: L = 1000 - 2 · 50 = 900.
    let x: Vec<DVec3> = (0..3).map(|i| DVec3::X * 1000.0 * f64::from(i)).collect();
    let set = panels(&shells::vector_sum(&x, &[DVec3::ZERO, DVec3::Y * 1000.0]), 30.0);
    let rule = FastenerRule { end_distance: 50.0, ..FastenerRule::dowels(Direction::ChamferNormal) };
    for (spacing, count) in [(900.0, 2), (899.0, 3), (300.0, 4), (150.0, 7), (149.0, 8), (5000.0, 2)] {
        let (laid, issues) = lay_fasteners(&set, &FastenerRule { spacing, ..rule }).unwrap();
        assert_eq!(issues, []);
        let mut places: Vec<f64> = laid.features.iter().filter(|f| f.panel == 0).map(|f| hole(f).0.y).collect();
        places.sort_by(f64::total_cmp);
        assert_eq!(places.len(), count);
        assert!((places[0] - 50.0).abs() < 1e-9 && (places[count - 1] - 950.0).abs() < 1e-9);
        let step = 900.0 / (count - 1) as f64;
        assert!(places.windows(2).all(|w| (w[1] - w[0] - step).abs() < 1e-9 && step <= spacing));
        assert!(laid.features.iter().all(|f| (hole(f).0.z + 15.0).abs() < 1e-9), "in mid-height");
    }
}

#[test]
fn edges_and_heads_are_chosen_by_rule() {
    let x: Vec<DVec3> = (0..4).map(|i| DVec3::X * 500.0 * f64::from(i)).collect();
    let y: Vec<DVec3> = (0..3).map(|i| DVec3::Y * 500.0 * f64::from(i)).collect();
    let set = panels(&shells::vector_sum(&x, &y), 10.0);
    let rule = FastenerRule { spacing: 1000.0, ..FastenerRule::toe_screws(Up::Back) };
    let count = |edges| {
        let (laid, issues) = lay_fasteners(&set, &FastenerRule { edges, ..rule }).unwrap();
        assert_eq!(issues, []);
        laid.hardware.iter().map(|h| h.count).sum::<u64>()
    };
    // 3 × 2 panels: 3 inner edges along the rows, 4 across, 10 on the border, two fasteners each.
    assert_eq!(count(EdgeSelection::AlongRows), 6);
    assert_eq!(count(EdgeSelection::AcrossRows), 8);
    assert_eq!(count(EdgeSelection::Inner), 14);
    assert_eq!(count(EdgeSelection::Border), 20);
    assert_eq!(count(EdgeSelection::All), 34);
    let heads = |head| {
        let (laid, _) = lay_fasteners(&set, &FastenerRule { head, ..rule }).unwrap();
        let on_back = |f: &Feature| (hole(f).0.z + 10.0).abs() < 1e-9;
        let lower_first: Vec<bool> = joints(&laid)
            .iter()
            .map(|j| {
                let head = j.iter().find(|f| on_back(f)).unwrap();
                head.panel == j.iter().map(|f| f.panel).min().unwrap()
            })
            .collect();
        lower_first
    };
    assert!(heads(Head::LowerAddress).iter().all(|&l| l));
    assert!(heads(Head::HigherAddress).iter().all(|&l| !l));
    let alternate = heads(Head::Alternate);
    assert_eq!(alternate.iter().filter(|&&l| l).count() * 2, alternate.len());
}

#[test]
fn short_edges_are_reported() {
    let x: Vec<DVec3> = (0..3).map(|i| DVec3::X * 200.0 * f64::from(i)).collect();
    let set = panels(&shells::vector_sum(&x, &[DVec3::ZERO, DVec3::Y * 70.0]), 30.0);
    let rule = FastenerRule::dowels(Direction::ChamferNormal);
    for (short_edge, count) in [(ShortEdge::Middle, 1), (ShortEdge::Nothing, 0)] {
        let (laid, issues) = lay_fasteners(&set, &FastenerRule { short_edge, ..rule }).unwrap();
        let laid_one = count == 1;
        let [JointIssue::EdgeTooShort { panel: 0, edge: 1, length, needed, laid: reported }] = issues[..] else {
            panic!("{issues:?}")
        };
        assert!((length - 70.0).abs() < 1e-9 && needed == 100.0 && reported == laid_one);
        assert!(!issues[0].is_fatal());
        assert_eq!(joints(&laid).len(), count);
        assert!(laid.features.iter().all(|f| (hole(f).0.y - 35.0).abs() < 1e-9));
    }
}

#[test]
fn too_little_wood_is_named() {
    let x: Vec<DVec3> = (0..3).map(|i| DVec3::X * 300.0 * f64::from(i)).collect();
    let flat = |d| panels(&shells::vector_sum(&x, &[DVec3::ZERO, DVec3::Y * 400.0]), d);
    let dowels = FastenerRule::dowels(Direction::ChamferNormal);
    // 9 mm board, Ø 6 in mid-height: 1.5 mm remain, 2 are asked for.
    let (laid, issues) = lay_fasteners(&flat(9.0), &dowels).unwrap();
    assert!(laid.features.is_empty() && laid.hardware.is_empty());
    let JointIssue::ThinWood { panel: 0, edge: 1, number: 0, remains, .. } = issues[0] else { panic!("{}", issues[0]) };
    assert!((remains - 1.5).abs() < 1e-9);
    assert!(issues.iter().all(JointIssue::is_fatal));
    // A slanting dowel leaves through the back: the largest depth that is named works.
    let slanting = FastenerRule::dowels(Direction::Section(0.8));
    let (_, issues) = lay_fasteners(&flat(21.0), &slanting).unwrap();
    let JointIssue::TooDeep { largest, depth: 21.0, .. } = issues[0] else { panic!("{}", issues[0]) };
    let with = |depth: f64| {
        let Fastener::Pin(pin) = slanting.fastener else { panic!() };
        let pin = Pin { depth: [depth; 2], length: 2.0 * depth, ..pin };
        lay_fasteners(&flat(21.0), &FastenerRule { fastener: Fastener::Pin(pin), ..slanting }).unwrap().1
    };
    assert_eq!(with(largest - 1e-9), []);
    assert!(!with(largest + 1e-6).is_empty());
    // A screw too long for 10 mm.
    let mut toe = FastenerRule::toe_screws(Up::Front);
    let Fastener::Toe(screw) = &mut toe.fastener else { panic!() };
    screw.length = ToeLength::Given(40.0);
    let (laid, issues) = lay_fasteners(&flat(10.0), &toe).unwrap();
    assert!(laid.features.is_empty());
    let JointIssue::TooLong { length: 40.0, longest, .. } = issues[0] else { panic!("{}", issues[0]) };
    assert!((11.0..13.0).contains(&longest), "{longest}");
    // A direction along the chamfer.
    let along = FastenerRule::dowels(Direction::Given(DVec3::Y));
    let (_, issues) = lay_fasteners(&flat(21.0), &along).unwrap();
    assert!(matches!(issues[0], JointIssue::AlongChamfer { .. }));
}

#[test]
fn holes_that_meet_are_left_out() {
    // Deep dowels close to the ends of all edges cross at the corners.
    let x: Vec<DVec3> = (0..4).map(|i| DVec3::X * 150.0 * f64::from(i)).collect();
    let y: Vec<DVec3> = (0..4).map(|i| DVec3::Y * 150.0 * f64::from(i)).collect();
    let set = panels(&shells::vector_sum(&x, &y), 21.0);
    let rule = FastenerRule { end_distance: 15.0, ..FastenerRule::dowels(Direction::ChamferNormal) };
    let (laid, issues) = lay_fasteners(&set, &rule).unwrap();
    assert!(issues.iter().any(|i| matches!(i, JointIssue::HolesMeet { gap, .. } if *gap < 2.0)), "{issues:?}");
    assert_coaxial(&laid);
    let count: u64 = laid.hardware.iter().map(|h| h.count).sum();
    assert_eq!(count as usize * 2, laid.features.len());
    let (_, issues) = lay_fasteners(&set, &FastenerRule { end_distance: 40.0, ..rule }).unwrap();
    assert_eq!(issues, []);
}

#[test]
fn holes_meet_where_the_chamfers_of_both_panels_are() {
    // A foot cut in a plane: the border chamfers of neighbours end at different places on the shared edge.
    let mesh = shells::shell();
    let border = BorderRule::all(BorderCut::InPlane { normal: DVec3::Z });
    let (set, _) = thicken(&mesh, &ThickenParams { border, ..ThickenParams::new(21.0) }).unwrap();
    let rule = FastenerRule { end_distance: 0.0, cover: 0.0, ..FastenerRule::dowels(Direction::ChamferNormal) };
    let (laid, _) = lay_fasteners(&set, &rule).unwrap();
    assert_coaxial(&laid);
}

#[test]
fn wrong_rules_are_refused() {
    let set = PanelSet::default();
    let refused = |change: &dyn Fn(&mut FastenerRule)| {
        let mut rule = FastenerRule::dowels(Direction::ChamferNormal);
        change(&mut rule);
        lay_fasteners(&set, &rule).unwrap_err()
    };
    assert!(matches!(refused(&|r| r.spacing = 0.0), FastenerError::Parameter { name: "spacing", .. }));
    assert!(matches!(refused(&|r| r.end_distance = -1.0), FastenerError::Parameter { name: "end distance", .. }));
    assert!(matches!(refused(&|r| r.height = Height::At(1.5)), FastenerError::Parameter { name: "height", .. }));
    assert!(matches!(refused(&|r| r.cover = f64::NAN), FastenerError::Parameter { name: "cover", .. }));
    assert!(matches!(refused(&|r| r.least_crossing = 2.0), FastenerError::Angle { .. }));
    let with = |pin: &dyn Fn(&mut Pin)| {
        refused(&|r| {
            if let Fastener::Pin(p) = &mut r.fastener {
                pin(p);
            }
        })
    };
    assert!(matches!(with(&|p| p.length = 100.0), FastenerError::PinTooLong { .. }));
    assert!(matches!(with(&|p| p.direction = Direction::Given(DVec3::ZERO)), FastenerError::Parameter { .. }));
    assert!(matches!(with(&|p| p.direction = Direction::Section(2.0)), FastenerError::Angle { .. }));
    let (laid, issues) = lay_fasteners(&set, &FastenerRule::screws()).unwrap();
    assert!(laid == FeatureSet::default() && issues.is_empty());
}

#[test]
fn edges_selected_before_get_the_same_fasteners() {
    let set = shell(21.0);
    for head in [Head::LowerAddress, Head::HigherAddress, Head::Alternate] {
        for selection in [EdgeSelection::All, EdgeSelection::Inner, EdgeSelection::AlongRows] {
            let rule = FastenerRule { edges: selection, head, ..FastenerRule::toe_screws(Up::Back) };
            let selected = select_edges(&set, selection, head);
            let (all, again) =
                (lay_fasteners(&set, &rule).unwrap(), lay_edges(&set, &selected, &rule, &|| true).unwrap());
            assert!(!all.0.features.is_empty());
            assert_eq!(all, again);
            // Half of the edges, whatever the rule would select.
            let (half, _) = lay_edges(&set, &selected[..selected.len() / 2], &rule, &|| true).unwrap();
            assert!(half.features.len() < all.0.features.len());
            assert!(
                half.features.iter().all(|f| all.0.features.iter().any(|g| (g.panel, g.edge) == (f.panel, f.edge)))
            );
        }
    }
    let rule = FastenerRule::toe_screws(Up::Back);
    let selected = select_edges(&set, EdgeSelection::Inner, Head::Alternate);
    assert_eq!(lay_edges(&set, &selected, &rule, &|| false), Err(FastenerError::Cancelled));
    let mut strange = selected[0];
    (strange.first.panel, strange.second) = (set.len() as u32, None);
    let refused = lay_edges(&set, &[strange], &rule, &|| true).unwrap_err();
    assert_eq!(refused.to_string(), format!("there is no edge {} of a panel {}", strange.first.edge, set.len()));
}

#[test]
fn features_of_edges_that_were_not_selected_are_taken_out() {
    let set = shell(21.0);
    let all = lay_fasteners(&set, &FastenerRule::toe_screws(Up::Back)).unwrap().0;
    let rows = select_edges(&set, EdgeSelection::AlongRows, Head::Alternate);
    let across = select_edges(&set, EdgeSelection::AcrossRows, Head::Alternate);
    let (mut kept, both) = (all.clone(), [rows.clone(), across].concat());
    assert_eq!(take_misplaced(&set, &both, &mut kept, 1.0), []);
    assert_eq!(kept, all);
    let taken = take_misplaced(&set, &rows, &mut kept, 1.0);
    assert!(!taken.is_empty() && !kept.features.is_empty());
    assert_eq!(taken.len() + kept.features.len(), all.features.len());
    let Misplaced::Unselected { feature, panel, edge: Some(edge) } = taken[0] else { panic!("{:?}", taken[0]) };
    assert_eq!((all.features[feature].panel, all.features[feature].edge), (panel, Some(edge)));
    assert_eq!(taken[0].to_string(), format!("feature {feature}: edge {edge} of panel {panel} was not selected"));
    // One that names no edge may be anywhere at a panel that has one.
    let free = Feature { edge: None, ..all.features[0].clone() };
    let mut one = FeatureSet { by_hand: vec![free], ..FeatureSet::default() };
    assert_eq!(take_misplaced(&set, &both, &mut one, 1.0), []);
    let without = Misplaced::Unselected { feature: 0, panel: all.features[0].panel, edge: None };
    assert_eq!(take_misplaced(&set, &[], &mut one, 1.0), [without]);
    assert_eq!(one, FeatureSet::default());
}
