//! Laws of tool paths on real shells and on hand-made parts.

use super::*;
use crate::board::convex::area;
use crate::board::testing::{Shape, panel_set, random_pose, slanted_quad};
use crate::board::{
    Align, Board, Bounds, FacetName, Goods, Grain, GrainAxis, MapParams, Packer, PartSet, RowPacker, Up, check_layout,
    facets, map_parts,
};
use crate::joint::{Feature, FeatureSet, Machining};
use crate::machine::{Machine, test_machine};
use crate::panel::shells::{arc, folded, vector_sum};
use crate::panel::{ThickenParams, thicken};
use glam::{DAffine3, DVec2, DVec3};
use proptest::prelude::*;

fn go(_: f64) -> bool {
    true
}

fn bare(up: Up) -> MapParams {
    MapParams { up, fixing: None, address: None, ..MapParams::default() }
}

/// One voided, leaning part on the machine plane.
fn part(lean: [f64; 4], void: f64, up: Up, thickness: f64) -> PartSet {
    let shape = Shape { void: vec![void; 4], ..slanted_quad(300.0, 110.0, 40.0, lean) };
    map_parts(&panel_set(&[shape], thickness, DAffine3::IDENTITY), &FeatureSet::default(), &bare(up), &|| true).0
}

/// The passes of a part's contour: (plunge, cut) tips and axis.
fn passes(paths: &PartPaths, part: usize) -> Vec<(DVec3, DVec3, DVec3)> {
    let ops = paths.of_part(part).iter().filter(|o| o.purpose == Purpose::Contour);
    ops.flat_map(|o| o.moves.clone())
        .map(|k| k as usize)
        .filter(|k| paths.paths.kind[*k] == MoveKind::Cut)
        .map(|k| (paths.paths.tip[k - 1], paths.paths.tip[k], paths.paths.axis[k]))
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    /// The swept cylinder touches each plane exactly, from outside, along the whole facet and below it.
    #[test]
    fn cutter_touches_every_facet_and_never_enters_the_part(
        lean in prop::array::uniform4(-0.6..0.6f64),
        void in prop::sample::select(vec![0.0, 4.0]),
        up in prop::sample::select(vec![Up::Front, Up::Back]),
        thickness in 8.0..22.0f64,
    ) {
        let parts = part(lean, void, up, thickness);
        let params = PathParams { overrun: 0.5, corner_overrun: 0.7, ..PathParams::default() };
        let machine = Machine { table: crate::machine::Table { sacrificial: 40.0, ..test_machine().table }, ..test_machine() };
        let mut machine = machine;
        machine.linear[2].min = -40.0;
        let paths = cut_parts(&parts, &machine, &params, &go).unwrap();
        prop_assert!(paths.issues.is_empty(), "{:?}", paths.issues);
        let planes = facets(&parts.panels, 0);
        prop_assert_eq!(planes.len(), if void > 0.0 { 8 } else { 4 });
        let all = passes(&paths, 0);
        for f in &planes {
            let c = Contour::new(f).unwrap();
            let own: Vec<_> = all.iter().filter(|(a, b, v)| {
                v.dot(f.plane.normal).abs() < 1e-12
                    && (f.plane.distance(*a) - 10.0).abs() < 1e-9
                    && (f.plane.distance(*b) - 10.0).abs() < 1e-9
            }).collect();
            let slant = thickness / c.axis.z + params.overrun;
            prop_assert_eq!(own.len(), (slant / params.max_step).ceil() as usize);
            // The last pass ends at the tip formula with the overrun, runs beyond both ends, and no pass is too deep.
            let last = own.last().unwrap();
            prop_assert!((last.0 - c.tip(c.from - 0.7, 10.0, 0.5)).length() < 1e-9);
            prop_assert!((last.1 - c.tip(c.to + 0.7, 10.0, 0.5)).length() < 1e-9);
            let mut before = slant - params.overrun;
            for p in &own {
                let height = (p.0 - c.tip(c.from - 0.7, 10.0, 0.0)).dot(c.axis);
                prop_assert!(before - height <= params.max_step + 1e-9);
                before = height;
            }
            for q in f.points() {
                let s = c.along.dot(*q);
                prop_assert!(s >= c.from - 1e-9 && s <= c.to + 1e-9);
                let foot = c.tip(s, 0.0, 0.0);
                let height = (*q - foot).dot(c.axis);
                prop_assert!((*q - foot - c.axis * height).length() < 1e-9, "facet point in the plane");
                prop_assert!(height >= -1e-9 && height <= thickness / c.axis.z + 1e-9);
            }
        }
        // Every pose keeps the whole cutter outside at least one plane of the part.
        for k in 0..paths.paths.tip.len() {
            let (tip, axis) = (paths.paths.tip[k], paths.paths.axis[k]);
            let outside = planes.iter().map(|f| {
                let (d, lean) = (f.plane.distance(tip), f.plane.normal.dot(axis));
                let side = (1.0 - lean * lean).max(0.0).sqrt();
                d + (65.0 * lean).min(0.0) - 10.0 * side
            }).fold(f64::NEG_INFINITY, f64::max);
            prop_assert!(outside >= -1e-9, "{outside}");
        }
    }

    /// Six moves per pass, rapids only at the safe height, lifts along the axis.
    #[test]
    fn moves_of_a_pass_are_those_of_the_method(lean in prop::array::uniform4(-0.3..0.3f64)) {
        let machine = test_machine();
        let parts = part(lean, 0.0, Up::Back, 10.0);
        let paths = cut_parts(&parts, &machine, &PathParams::default(), &go).unwrap();
        use MoveKind::{Approach, Cut, Lift, Plunge, Rapid};
        let p = &paths.paths;
        prop_assert_eq!(p.tip.len() % 6, 0);
        for k in (0..p.tip.len()).step_by(6) {
            prop_assert_eq!(&p.kind[k..k + 6], &[Rapid, Approach, Plunge, Cut, Lift, Approach]);
            prop_assert_eq!(&p.feed[k..k + 6], &[0.0, 5000.0, 1500.0, 3000.0, 4000.0, 5000.0]);
            let end_drop = 10.0 * p.axis[k].truncate().length();
            prop_assert!((p.tip[k].z - end_drop - machine.safe_height).abs() < 1e-9);
            prop_assert!((p.tip[k + 5].z - end_drop - machine.safe_height).abs() < 1e-9);
            prop_assert!((p.tip[k + 1].z - end_drop - 12.0).abs() < 1e-9);
            for (a, b) in [(k, k + 1), (k + 1, k + 2), (k + 3, k + 4), (k + 4, k + 5)] {
                prop_assert!((p.tip[a] - p.tip[b]).cross(p.axis[k]).length() < 1e-9);
            }
            prop_assert!((p.tip[k + 2].z - p.tip[k + 3].z).abs() < 1e-9);
        }
    }

    /// Whatever the cutter sweeps below the board's upper side lies in the cleared outline.
    #[test]
    fn cleared_outline_holds_all_that_is_swept(lean in prop::array::uniform4(-0.5..0.5f64), pose in random_pose()) {
        let machine = test_machine();
        let set = panel_set(&[slanted_quad(200.0, 90.0, -30.0, lean)], 10.0, pose);
        let parts = map_parts(&set, &FeatureSet::default(), &MapParams::default(), &|| true).0;
        let params = PathParams::default();
        let paths = cut_parts(&parts, &machine, &params, &go).unwrap();
        let goods = Goods::of_parts(&parts, &paths, &machine, &|| true);
        let c = &goods.cleared[0];
        let inside = |p: DVec2| (0..c.len()).all(|k| {
            let (a, b) = (c[k], c[(k + 1) % c.len()]);
            (b - a).normalize().perp_dot(p - a) >= -1e-9
        });
        for op in paths.of_part(0) {
            let tool = &machine.tools[op.tool as usize];
            for k in op.moves.start as usize + 1..op.moves.end as usize {
                for s in 0..5 {
                    let tip = paths.paths.tip[k - 1].lerp(paths.paths.tip[k], f64::from(s) / 4.0);
                    let axis = paths.paths.axis[k];
                    let (u, v) = axis.any_orthonormal_pair();
                    for ring in 0..16 {
                        let (sin, cos) = (f64::from(ring) * 0.4).sin_cos();
                        for h in 0..24 {
                            let h = f64::from(h) * tool.cutting_length / 23.0;
                            let r = if h < tool.tip_height() { 0.5 * tool.diameter * h / tool.tip_height() } else { 0.5 * tool.diameter };
                            let p = tip + axis * h + (u * cos + v * sin) * r;
                            if p.z <= 12.0 {
                                prop_assert!(inside(p.truncate()), "{p}");
                            }
                        }
                    }
                }
            }
        }
    }
}

/// A shell of the size of the thesis' prototype 3, 256 panels of about 320 × 110 mm, mapped.
fn shell_parts() -> PartSet {
    let mesh = vector_sum(&arc(16, 4500.0, 1200.0), &folded(16, 105.0, 40.0));
    let (panels, issues) = thicken(&mesh, &ThickenParams::new(10.0)).unwrap();
    assert!(issues.iter().all(|i| !i.is_fatal()));
    let (parts, issues) = map_parts(&panels, &FeatureSet::default(), &MapParams::default(), &|| true);
    assert!(issues.is_empty(), "{issues:?}");
    parts
}

#[test]
fn the_shell_fits_on_four_boards_and_every_layout_is_valid() {
    let machine = test_machine();
    let parts = shell_parts();
    let params = PathParams::default();
    let paths = cut_parts(&parts, &machine, &params, &go).unwrap();
    assert!(paths.issues.is_empty(), "{}", paths.issues[0]);
    let board = Board { size: DVec2::new(1500.0, 3000.0), thickness: 10.0, margin: 5.0 };
    for grain in [Grain::Directed, Grain::Axis, Grain::Free] {
        let goods = Goods { grain, ..Goods::of_parts(&parts, &paths, &machine, &|| true) };
        let packed = RowPacker::default().pack(&goods, &board, &go).unwrap();
        assert!(packed.left_out.is_empty());
        assert_eq!(packed.layout.placements.len(), 256);
        let used: f64 = goods.piece.iter().map(|p| area(p)).sum();
        println!(
            "{grain:?}: {} boards, {:.3} used",
            packed.layout.boards,
            used / f64::from(packed.layout.boards) / 4.5e6
        );
        assert!(packed.layout.boards <= 4);
        assert_eq!(check_layout(&packed.layout, Bounds::Cleared, 1e-6), []);
        if grain == Grain::Directed {
            let (placed, issues) = place_paths(&paths, &packed.layout, &machine, &|| true);
            assert!(issues.is_empty());
            let key = |o: &Operation| (o.board, o.purpose, o.tool);
            assert!(
                placed.operations.windows(2).all(|w| key(&w[0]) <= key(&w[1]) && w[0].moves.end == w[1].moves.start)
            );
            assert!(placed.operations.iter().all(|o| placed.kind[o.moves.start as usize] == MoveKind::Rapid));
            println!("{} operations, {} moves", placed.operations.len(), placed.tip.len());
        }
    }
}

#[test]
fn same_bytes_for_any_number_of_threads() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let (machine, parts, params) = (test_machine(), shell_parts(), PathParams::default());
            let paths = cut_parts(&parts, &machine, &params, &go).unwrap();
            let goods = Goods::of_parts(&parts, &paths, &machine, &|| true);
            let board = Board { size: DVec2::new(1500.0, 3000.0), thickness: 10.0, margin: 5.0 };
            let packed = RowPacker::default().pack(&goods, &board, &go).unwrap();
            let (placed, _) = place_paths(&paths, &packed.layout, &machine, &|| true);
            (parts, packed, placed)
        })
    };
    assert!(run(1) == run(2));
}

#[test]
fn an_undercut_too_deep_names_what_would_do() {
    let mut machine = test_machine();
    machine.table.sacrificial = 6.0;
    // The front is up and chamfer 2 leans so that the part is narrower below: the tool comes in from under it.
    let parts = part([0.0, 0.0, -20f64.to_radians(), 0.0], 0.0, Up::Front, 10.0);
    let paths = cut_parts(&parts, &machine, &PathParams::default(), &go).unwrap();
    assert!(paths.failed[0] && paths.of_part(0).is_empty());
    assert_eq!(paths.issues.len(), 1);
    assert_eq!(paths.issues[0].place, Place::Facet(FacetName::Edge(2)));
    let PathError::TooDeep { depth, largest_tilt, largest_radius, .. } = paths.issues[0].error else { panic!() };
    let below = |r: f64, tilt: f64| 2.0 * r * tilt.to_radians().sin() + tilt.to_radians().cos();
    assert!((depth - below(10.0, 20.0)).abs() < 1e-9);
    assert!((below(10.0, largest_tilt) - 6.0).abs() < 1e-9);
    assert!((below(largest_radius, 20.0) - 6.0).abs() < 1e-9);
    // Turned over, the same chamfer is no undercut.
    let parts = part([0.0, 0.0, -20f64.to_radians(), 0.0], 0.0, Up::Back, 10.0);
    assert!(cut_parts(&parts, &machine, &PathParams::default(), &go).unwrap().issues.is_empty());
}

#[test]
fn tools_too_short_too_thick_or_too_long_are_named() {
    let parts = part([0.3; 4], 0.0, Up::Back, 10.0);
    let first = |change: &dyn Fn(&mut Machine)| {
        let mut machine = test_machine();
        change(&mut machine);
        cut_parts(&parts, &machine, &PathParams::default(), &go).unwrap().issues.remove(0).error
    };
    assert!(
        matches!(first(&|m| m.tools[3].cutting_length = 9.0), PathError::TooShort { tool: 10, needed, has: 9.0 } if needed > 11.0)
    );
    assert!(matches!(
        first(&|m| m.tools[3].holder[0] = crate::machine::Revolved { from: 95.0, to: 140.0, radius_from: 300.0, radius_to: 300.0 }),
        PathError::Holder { tool: 10, shortfall, .. } if shortfall > 0.0
    ));
    assert!(matches!(first(&|m| m.tools[3].shank_diameter = 500.0), PathError::Holder { .. }));
    assert!(matches!(first(&|m| m.linear[2].max = 61.0), PathError::Travel { letter: 'Z', .. }));
    assert!(matches!(first(&|m| (m.secondary.min, m.secondary.max) = (-10.0, 10.0)), PathError::Head(_)));
}

#[test]
fn a_bad_machine_or_parameter_is_refused_as_a_whole() {
    let parts = part([0.0; 4], 0.0, Up::Back, 10.0);
    let run = |m: &Machine, p: &PathParams| cut_parts(&parts, m, p, &go).unwrap_err();
    let (machine, params) = (test_machine(), PathParams::default());
    assert!(matches!(run(&Machine { safe_height: 11.0, ..machine.clone() }, &params), PathError::SafeHeight { .. }));
    let no_mill = Machine { tools: machine.tools[..3].to_vec(), ..machine.clone() };
    assert!(matches!(run(&no_mill, &params), PathError::NoTool { .. }));
    let missing = PathParams { contour_tool: Some(7), ..params.clone() };
    assert_eq!(run(&machine, &missing).to_string(), "the machine has no end mill T7; it has T10 Ø20");
    for max_step in [0.0, f64::NAN, 1e-9] {
        let step = PathParams { max_step, ..params.clone() };
        assert!(matches!(run(&machine, &step), PathError::Parameter { name, .. } if name == "max_step"));
    }
    let overrun = PathParams { overrun: 19.5, ..params.clone() };
    assert!(matches!(run(&machine, &overrun), PathError::Parameter { name, .. } if name == "overrun"));
    let peck = PathParams { peck: Some(1e-9), ..params.clone() };
    assert!(matches!(run(&machine, &peck), PathError::Parameter { name, .. } if name == "peck"));
    assert_eq!(cut_parts(&parts, &machine, &params, &|_| false).unwrap_err(), PathError::Cancelled);
}

/// A drilled part: the feature's axis points down by `tilt` from level.
fn drilled(entry: DVec3, axis: DVec3, depth: f64, diameter: f64) -> PartSet {
    let mut parts = part([0.0; 4], 0.0, Up::Front, 10.0);
    let machining = Machining::Drill { entry, axis, depth, diameter };
    parts.features.features.push(Feature { panel: 0, edge: None, joint: None, purpose: "toe screw".into(), machining });
    parts
}

#[test]
fn a_hole_is_drilled_along_its_axis_to_its_depth() {
    let machine = test_machine();
    let axis = DVec3::new(0.0, -1.0, -1.0).normalize();
    let entry = DVec3::new(100.0, 3.0, 10.0);
    let paths = cut_parts(&drilled(entry, axis, 12.0, 3.0), &machine, &PathParams::default(), &go).unwrap();
    assert!(paths.issues.is_empty(), "{}", paths.issues[0]);
    let op = &paths.of_part(0)[0];
    assert_eq!((op.purpose, machine.tools[op.tool as usize].number), (Purpose::Drilling, 3));
    let k = op.moves.start as usize;
    let p = &paths.paths;
    assert_eq!(
        &p.kind[k..k + 5],
        &[MoveKind::Rapid, MoveKind::Approach, MoveKind::Plunge, MoveKind::Lift, MoveKind::Approach]
    );
    assert!((p.tip[k + 2] - (entry + axis * 12.0)).length() < 1e-12);
    assert!(p.tip[k..k + 5].iter().all(|t| (*t - entry).cross(axis).length() < 1e-9));
    assert!((p.axis[k] + axis).length() < 1e-15);
    // In pecks: the same deepest point, no step deeper than asked.
    let params = PathParams { peck: Some(5.0), ..PathParams::default() };
    let pecked = cut_parts(&drilled(entry, axis, 12.0, 3.0), &machine, &params, &go).unwrap().paths;
    let plunges: Vec<f64> = (0..pecked.operations[0].moves.end as usize)
        .filter(|k| pecked.kind[*k] == MoveKind::Plunge)
        .map(|k| (pecked.tip[k] - entry).dot(axis))
        .collect();
    assert!(plunges.len() > 2 && plunges.windows(2).all(|w| w[1] > w[0] && w[1] - w[0] <= 5.0 + 1e-9));
    assert!((plunges.last().unwrap() - 12.0).abs() < 1e-9);
}

#[test]
fn holes_out_of_reach_are_named_and_the_part_is_still_cut() {
    let machine = test_machine();
    let entry = DVec3::new(100.0, 50.0, 10.0);
    let error = |axis: DVec3, depth, diameter| {
        let parts = drilled(entry, axis, depth, diameter);
        let paths = cut_parts(&parts, &machine, &PathParams::default(), &go).unwrap();
        assert_eq!((paths.failed[0], paths.issues[0].place), (false, Place::Feature(0)));
        assert_eq!(passes(&paths, 0).len(), 8);
        paths.issues[0].error.clone()
    };
    assert_eq!(error(DVec3::NEG_Z, 5.0, 7.0).to_string(), "the machine has no drill of Ø7; it has T1 Ø4, T3 Ø3");
    assert!(matches!(error(DVec3::Z, 5.0, 3.0), PathError::FromBelow { angle } if (angle - 90.0).abs() < 1e-9));
    assert!(matches!(error(DVec3::NEG_Z, 40.0, 4.0), PathError::HoleTooDeep { depth, .. } if depth > 30.0));
    let shallow = DVec3::new(1.0, 0.0, -0.05).normalize();
    assert!(matches!(error(shallow, 9.0, 3.0), PathError::TooShort { .. } | PathError::Holder { .. }));
}

#[test]
fn through_holes_go_into_the_sacrificial_layer_at_full_diameter() {
    let machine = test_machine();
    let entry = DVec3::new(100.0, 50.0, 10.0);
    let paths = cut_parts(&drilled(entry, DVec3::NEG_Z, 10.0, 4.0), &machine, &PathParams::default(), &go).unwrap();
    let point = machine.tools[0].tip_height();
    assert!((paths.paths.tip[2].z + 3.0 + point).abs() < 1e-12);
}

#[test]
fn marks_become_fixing_holes_and_engraving_before_the_contour() {
    let parts = map_parts(
        &panel_set(&[slanted_quad(300.0, 110.0, 40.0, [0.1; 4])], 10.0, DAffine3::IDENTITY),
        &FeatureSet::default(),
        &MapParams { align: Align::FirstEdge, axis: GrainAxis::Y, ..MapParams::default() },
        &|| true,
    )
    .0;
    let machine = test_machine();
    let paths = cut_parts(&parts, &machine, &PathParams::default(), &go).unwrap();
    assert!(paths.issues.is_empty());
    let order: Vec<_> = paths.of_part(0).iter().map(|o| (o.purpose, machine.tools[o.tool as usize].number)).collect();
    assert_eq!(order, [(Purpose::Fixing, 1), (Purpose::Engraving, 2), (Purpose::Contour, 10)]);
    let engraving = &paths.of_part(0)[1];
    let deepest = engraving.moves.clone().map(|k| paths.paths.tip[k as usize].z).fold(f64::INFINITY, f64::min);
    assert!((deepest - 9.5).abs() < 1e-9);
}

#[test]
fn a_part_that_leaves_the_travel_is_named_and_left_out() {
    let machine = test_machine();
    let parts = part([0.0; 4], 0.0, Up::Front, 10.0);
    let params = PathParams::default();
    let paths = cut_parts(&parts, &machine, &params, &go).unwrap();
    let goods = Goods::of_parts(&parts, &paths, &machine, &|| true);
    let board = Board { size: DVec2::new(1500.0, 3000.0), thickness: 10.0, margin: 5.0 };
    let mut layout = RowPacker::default().pack(&goods, &board, &go).unwrap().layout;
    layout.placements[0].offset.x = 1500.0;
    let (placed, issues) = place_paths(&paths, &layout, &machine, &|| true);
    assert!(placed.tip.is_empty());
    assert!(matches!(issues[0].error, PathError::Travel { letter: 'X', .. }));
}
