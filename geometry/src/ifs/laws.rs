//! Tests: what holds for every curve, and what is refused.

use super::{Curve, CurveError, Move, Preset, Scheme, SchemeError, homogeneous, iterate, patches};
use glam::{DVec3, DVec4, Vec4Swizzles};
use proptest::prelude::*;

fn go(_: f64) -> bool {
    true
}

fn presets() -> impl Strategy<Value = Preset> {
    prop_oneof![
        (1..9_u32).prop_map(|degree| Preset::Bezier { degree }),
        Just(Preset::CubicBSpline),
        Just(Preset::Takagi),
        Just(Preset::Koch),
        Just(Preset::Levy),
        Just(Preset::Parabola),
        Just(Preset::Dragon),
        Just(Preset::Cantor),
    ]
}

fn point() -> impl Strategy<Value = DVec3> {
    [-1e3..1e3, -1e3..1e3, -1e3..1e3_f64].prop_map(DVec3::from_array)
}

/// Points and weights of 12 control points; tests take as many as they need.
fn control() -> impl Strategy<Value = Vec<DVec4>> {
    prop::collection::vec((point(), 0.2..4.0_f64).prop_map(|(p, w)| homogeneous(p, w)), 12)
}

fn place(p: DVec4) -> DVec3 {
    p.xyz() / p.w
}

fn de_casteljau(control: &[DVec4], t: f64) -> DVec4 {
    let mut row = control.to_vec();
    while row.len() > 1 {
        row = row.windows(2).map(|w| w[0] * (1.0 - t) + w[1] * t).collect();
    }
    row[0]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(96))]

    #[test]
    fn bezier_points_are_de_casteljaus_at_dyadic_parameters(control in control(), degree in 1..11_u32, n in 0..10_u32) {
        let scheme = Scheme::preset(Preset::Bezier { degree }).unwrap();
        let control = control[..=degree as usize].to_vec();
        let size = control.iter().map(|p| p.length()).fold(0.0, f64::max);
        let curve = iterate(&scheme, std::slice::from_ref(&control), n, 1e-6, &go).unwrap();
        prop_assert_eq!(curve.points.len(), (1 << n) + 1);
        for (i, p) in curve.points.iter().enumerate() {
            let q = de_casteljau(&control, i as f64 / f64::from(1 << n));
            prop_assert!(p.distance(q) <= 1e-12 * size);
        }
    }

    #[test]
    fn rational_quadratics_draw_exact_arcs(radius in 1.0..1e5_f64, turn in 0.1..3.0_f64, at in -3.0..3.0_f64, n in 0..12_u32) {
        let arc = |angle: f64, r: f64| DVec3::new(r * angle.cos(), r * angle.sin(), 0.0);
        let w = (turn / 2.0).cos();
        let control = vec![
            homogeneous(arc(at, radius), 1.0),
            homogeneous(arc(at + turn / 2.0, radius / w), w),
            homogeneous(arc(at + turn, radius), 1.0),
        ];
        let scheme = Scheme::preset(Preset::Bezier { degree: 2 }).unwrap();
        let curve = iterate(&scheme, &[control], n, 1e-6, &go).unwrap();
        for p in curve.projected() {
            prop_assert!((p.length() - radius).abs() <= 1e-12 * radius);
        }
    }

    #[test]
    fn columns_outlive_moved_control_points(preset in presets(), control in control(), moved in control()) {
        let scheme = Scheme::preset(preset).unwrap();
        for control in [control, moved] {
            let control = &control[..preset.control_count()];
            let points = scheme.subdivision_points(control).unwrap();
            for (s, tie) in points.iter().zip(scheme.ties()) {
                if let super::Tie::Control(p) = tie {
                    prop_assert_eq!(*s, control[*p as usize]);
                }
            }
            // Two points of one tie are one point.
            for (s, tie) in points.iter().zip(scheme.ties()) {
                for (t, other) in points.iter().zip(scheme.ties()) {
                    prop_assert!(tie != other || s == t);
                }
            }
        }
    }

    #[test]
    fn points_sent_where_they_are_change_nothing(preset in presets(), control in control()) {
        let scheme = Scheme::preset(preset).unwrap();
        let control = &control[..preset.control_count()];
        let points = scheme.subdivision_points(control).unwrap();
        // Barycentric combinations with negative columns and free weights may leave space; they are not points then.
        let moves: Vec<Move> = points
            .iter()
            .enumerate()
            .filter(|(_, s)| s.w > 0.1)
            .map(|(point, s)| Move { point, position: place(*s), weight: None })
            .collect();
        prop_assert_eq!(&scheme.moved(control, &moves, 1e-6).unwrap(), &scheme);
    }

    #[test]
    fn a_moved_point_arrives_and_takes_its_ties_along(control in control(), degree in 4..10_u32, at in 0..64_usize, to in point(), weight in 0.5..2.0_f64) {
        let scheme = Scheme::preset(Preset::Bezier { degree }).unwrap();
        let m = degree as usize + 1;
        let control = &control[..m];
        let point = at % (2 * m - 2) + 1;
        let moved = scheme.moved(control, &[Move { point, position: to, weight: Some(weight) }], 1e-6).unwrap();
        let points = moved.subdivision_points(control).unwrap();
        prop_assert!(place(points[point]).distance(to) < 1e-8);
        prop_assert!((points[point].w - weight).abs() < 1e-10);
        prop_assert_eq!(points[m - 1], points[m]);
        for (p, c) in moved.columns().chunks(m).enumerate() {
            let tied = p == point || (scheme.ties()[p] == scheme.ties()[point]);
            prop_assert_eq!(c != &scheme.columns()[p * m..(p + 1) * m], tied);
        }
        prop_assert_eq!(&moved.columns()[m * (m - 1)..m * m], &moved.columns()[m * m..m * (m + 1)]);
    }

    #[test]
    fn continuity_does_not_depend_on_where_points_lie(control in control(), to in point(), n in 1..10_u32) {
        let control = &control[..3];
        let plain: Vec<DVec4> = control.iter().map(|p| homogeneous(place(*p), 1.0)).collect();
        for (preset, free) in [(Preset::Bezier { degree: 2 }, vec![1, 2, 4]), (Preset::Takagi, vec![1, 4]), (Preset::Dragon, vec![1, 4])] {
            let scheme = Scheme::preset(preset).unwrap();
            // Any place in the control triangle's plane can be reached.
            let normal = (place(plain[1]) - place(plain[0])).cross(place(plain[2]) - place(plain[0])).normalize();
            let flat = |p: DVec3| p - normal * normal.dot(p - place(plain[0]));
            let moves: Vec<Move> = free.iter().map(|&point| Move { point, position: flat(to * point as f64), weight: None }).collect();
            let moved = scheme.moved(&plain, &moves, 1e-6).unwrap();
            let curve = iterate(&moved, std::slice::from_ref(&plain), n, 0.0, &go).unwrap();
            prop_assert_eq!((curve.strip_count(), curve.points.len()), (1, (1 << n) + 1));
        }
    }

    #[test]
    fn words_name_the_transformations_that_make_a_segment(preset in presets(), control in control(), n in 0..9_u32, at in 0..10_000_usize) {
        let scheme = Scheme::preset(preset).unwrap();
        let m = preset.control_count();
        let control: Vec<DVec4> = control.iter().map(|p| homogeneous(place(*p), 1.0)).take(m).collect();
        let curve = iterate(&scheme, std::slice::from_ref(&control), n, 0.0, &go).unwrap();
        prop_assert_eq!(curve.segment_count(), 1 << n);
        let segment = at % curve.segment_count();
        let mut polygon = control;
        for digit in curve.word(segment).unwrap().to_string().trim_start_matches("1/").bytes() {
            let letter = usize::from(digit - b'1');
            polygon = (0..m)
                .map(|a| (0..m).fold(DVec4::ZERO, |s, r| s + polygon[r] * scheme.columns()[(letter * m + a) * m + r]))
                .collect();
        }
        let ends = scheme.germ().chunks(m).map(|c| (0..m).fold(DVec4::ZERO, |s, r| s + polygon[r] * c[r]));
        let ends: Vec<DVec3> = ends.map(place).collect();
        let (a, b) = curve.segment(segment).unwrap();
        let (a, b) = (place(curve.points[a]), place(curve.points[b]));
        let near = |p: DVec3, q: DVec3| p.distance(q) < 1e-8;
        prop_assert!((near(a, ends[0]) && near(b, ends[1])) || (near(a, ends[1]) && near(b, ends[0])));
    }
}

fn row(points: &[[f64; 3]]) -> Vec<DVec4> {
    points.iter().map(|p| homogeneous(DVec3::from_array(*p), 1.0)).collect()
}

fn bezier(control: Vec<DVec4>, n: u32) -> Result<Curve, CurveError> {
    iterate(&Scheme::preset(Preset::Bezier { degree: control.len() as u32 - 1 }).unwrap(), &[control], n, 1e-6, &go)
}

/// A full circle of three rational quadratic patches, weights 1, ½, 1.
fn circle(radius: f64) -> Vec<Vec<DVec4>> {
    let turn = std::f64::consts::TAU / 6.0;
    let corner = |i: usize| {
        let (r, w) = if i.is_multiple_of(2) { (radius, 1.0) } else { (2.0 * radius, 0.5) };
        let (s, c) = (i as f64 * turn).sin_cos();
        homogeneous(DVec3::new(r * c, r * s, 0.0), w)
    };
    patches(&(0..6).map(corner).collect::<Vec<_>>(), 3, 1, true).unwrap()
}

#[test]
fn a_circle_of_three_patches_is_closed() {
    let scheme = Scheme::preset(Preset::Bezier { degree: 2 }).unwrap();
    let curve = iterate(&scheme, &circle(750.0), 6, 1e-9, &go).unwrap();
    assert!(curve.closed);
    assert_eq!((curve.points.len(), curve.segment_count(), curve.strip_count()), (192, 192, 1));
    assert_eq!(curve.segment(191), Some((191, 0)));
    assert_eq!(curve.word(64).unwrap().to_string(), "2/111111");
    let points = curve.projected();
    for (i, p) in points.iter().enumerate() {
        assert!((p.length() - 750.0).abs() <= 750e-12);
        assert!(p.distance(points[(i + 1) % 192]) > 1.0);
    }
}

#[test]
fn patches_that_do_not_meet_are_named() {
    let scheme = Scheme::preset(Preset::Bezier { degree: 2 }).unwrap();
    let mut apart = circle(100.0);
    apart[1][0] += DVec4::new(0.0, 0.25, 0.0, 0.0);
    match iterate(&scheme, &apart, 4, 1e-6, &go) {
        Err(CurveError::Gap { patch: 1, gap, .. }) => assert!((gap - 0.25).abs() < 1e-12),
        other => panic!("{other:?}"),
    }
    let mut heavy = circle(100.0);
    heavy[2].iter_mut().for_each(|p| *p *= 2.0);
    let jump = CurveError::WeightJump { patch: 2, end: 1.0, start: 2.0 };
    assert_eq!(iterate(&scheme, &heavy, 4, 1e-6, &go), Err(jump));
    // Within the tolerance a gap is closed, and a last patch that ends elsewhere leaves the curve open.
    assert!(iterate(&scheme, &apart, 4, 0.3, &go).unwrap().closed);
    let mut open = circle(100.0);
    open[2][2] += DVec4::new(0.0, 0.25, 0.0, 0.0);
    let open = iterate(&scheme, &open, 4, 1e-6, &go).unwrap();
    assert_eq!((open.closed, open.points.len()), (false, 49));
}

#[test]
fn rows_are_divided_into_whole_patches_only() {
    let points = row(&[[0.0; 3]; 9]);
    assert_eq!(patches(&points, 3, 1, false).unwrap().len(), 4);
    assert_eq!(patches(&points, 4, 3, false).unwrap().len(), 6);
    let error = patches(&points[..8], 3, 1, false).unwrap_err();
    assert_eq!(error, CurveError::NoWholePatches { given: 8, m: 3, shared: 1, fitting: 9 });
    let error = patches(&points[..2], 4, 3, false).unwrap_err();
    assert_eq!(error, CurveError::NoWholePatches { given: 2, m: 4, shared: 3, fitting: 4 });
    assert_eq!(patches(&points, 3, 3, false).unwrap_err(), CurveError::Shared { m: 3, shared: 3 });
    assert_eq!(patches(&[], 3, 1, true).unwrap_err(), CurveError::Empty);
}

#[test]
fn bad_control_points_are_refused() {
    let line = row(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 1.0, 0.0]]);
    let scheme = Scheme::preset(Preset::Bezier { degree: 2 }).unwrap();
    assert_eq!(iterate(&scheme, &[], 3, 1e-6, &go), Err(CurveError::Empty));
    assert_eq!(iterate(&scheme, &[vec![]], 3, 1e-6, &go), Err(CurveError::Empty));
    let count = CurveError::ControlCount { patch: 0, given: 2, needed: 3 };
    assert_eq!(iterate(&scheme, &[line[..2].to_vec()], 3, 1e-6, &go), Err(count));
    assert_eq!(bezier(row(&[[5.0; 3]; 3]), 3), Err(CurveError::OnePoint));
    for bad in [f64::NAN, f64::INFINITY] {
        let mut control = line.clone();
        control[1].y = bad;
        assert_eq!(bezier(control, 3), Err(CurveError::NotFinite { patch: 0, control: 1 }));
    }
    let mut control = line.clone();
    control[1].w = -2.0;
    assert_eq!(bezier(control, 3), Err(CurveError::WeightSum { patch: 0, sum: 0.0 }));
    assert!(matches!(iterate(&scheme, &[line], 3, f64::NAN, &go), Err(CurveError::Tolerance { .. })));
}

#[test]
fn a_point_beyond_infinity_is_named_by_its_word() {
    let mut control = row(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 1.0, 0.0]]);
    control[1] = homogeneous(DVec3::X, -1.5);
    let Err(CurveError::Weight { word, weight }) = bezier(control.clone(), 3) else { panic!() };
    // W(t) = (1 − t)² − 3 t (1 − t) + t² is 4/64 at t = 2/8 and −11/64 at t = 3/8, where element 122 starts.
    assert_eq!((word.to_string().as_str(), weight), ("1/122", -11.0 / 64.0));
    assert!(bezier(control, 1).is_err());
}

#[test]
fn too_many_segments_are_refused_with_the_number_that_works() {
    let line = row(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 1.0, 0.0]]);
    let error = bezier(line.clone(), 40).unwrap_err();
    assert_eq!(error, CurveError::TooManySegments { iterations: 40, limit: 1 << 26, largest: 26 });
    let scheme = Scheme::preset(Preset::Bezier { degree: 2 }).unwrap();
    assert_eq!(
        iterate(&scheme, &[line], 18, 1e-6, &|f| f < 0.5),
        Ok(bezier(row(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 1.0, 0.0]]), 18).unwrap())
    );
    let line = row(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 1.0, 0.0]]);
    assert_eq!(iterate(&scheme, &[line], 20, 1e-6, &|f| f < 0.5), Err(CurveError::Cancelled));
}

#[test]
fn expanding_transformations_overflow_with_a_name() {
    let scheme = Scheme::custom(2, vec![1.0, 0.0, -1e200, 1e200, 1e200, -1e200, 0.0, 1.0]).unwrap();
    let control = row(&[[0.0; 3], [1.0, 0.0, 0.0]]);
    assert!(matches!(
        iterate(&scheme, &[control], 4, 1e-6, &go),
        Err(CurveError::Overflow { .. } | CurveError::Weight { .. })
    ));
}

#[test]
fn the_same_bytes_from_one_thread_and_from_three() {
    let control = row(&[[0.0; 3], [10.0, 70.0, 3.0], [90.0, 50.0, -8.0], [120.0, 0.0, 5.0]]);
    let draw = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| bezier(control.clone(), 17).unwrap())
    };
    assert_eq!(draw(1), draw(3));
}

#[test]
fn unreachable_points_are_named_with_the_nearest_place() {
    // Four control points in one plane cannot leave it.
    let flat = row(&[[0.0; 3], [100.0, 0.0, 0.0], [100.0, 80.0, 0.0], [0.0, 90.0, 0.0]]);
    let scheme = Scheme::preset(Preset::Bezier { degree: 3 }).unwrap();
    let to = |position| [Move { point: 2, position, weight: None }];
    let Err(SchemeError::Unreachable { point: 2, residual, nearest }) =
        scheme.moved(&flat, &to(DVec3::new(30.0, 20.0, 7.0)), 1e-6)
    else {
        panic!()
    };
    assert!((residual - 7.0).abs() < 1e-12 && nearest.distance(DVec3::new(30.0, 20.0, 0.0)) < 1e-12);
    assert!(scheme.moved(&flat, &to(DVec3::new(30.0, 20.0, 0.0)), 1e-6).is_ok());
    // Two control points reach their line only.
    let cantor = Scheme::preset(Preset::Cantor).unwrap();
    let line = row(&[[0.0; 3], [10.0, 0.0, 0.0]]);
    let aside = [Move { point: 1, position: DVec3::new(5.0, 2.0, 0.0), weight: None }];
    assert!(
        matches!(cantor.moved(&line, &aside, 1e-6), Err(SchemeError::Unreachable { point: 1, residual, .. }) if (residual - 2.0).abs() < 1e-12)
    );
}

#[test]
fn the_correction_has_least_norm() {
    // Repeated control points must share the correction evenly; any other split is longer.
    let control = row(&[[0.0; 3], [100.0, 0.0, 0.0], [100.0, 0.0, 0.0], [0.0, 90.0, 0.0]]);
    let scheme = Scheme::preset(Preset::Bezier { degree: 3 }).unwrap();
    let moved = scheme
        .moved(&control, &[Move { point: 2, position: DVec3::new(60.0, 20.0, 0.0), weight: None }], 1e-6)
        .unwrap();
    let change: Vec<f64> = (8..12).map(|i| moved.columns()[i] - scheme.columns()[i]).collect();
    assert!((change[1] - change[2]).abs() < 1e-15 && change[1].abs() > 0.01);
    assert!(change.iter().sum::<f64>().abs() < 1e-14);
}

#[test]
fn bound_and_tied_points_stay_together() {
    let control = row(&[[0.0; 3], [50.0, 90.0, 0.0], [100.0, 0.0, 0.0]]);
    let bezier = Scheme::preset(Preset::Bezier { degree: 2 }).unwrap();
    let to = |point, x: f64| Move { point, position: DVec3::new(x, 20.0, 0.0), weight: None };
    let error = bezier.moved(&control, &[to(0, 0.0)], 1e-6).unwrap_err();
    assert_eq!(error, SchemeError::Fixed { point: 0, control: 0, distance: 20.0 });
    assert!(error.to_string().starts_with("s1 is the control point p1"), "{error}");
    let error = bezier.moved(&control, &[to(2, 40.0), to(3, 43.0)], 1e-6).unwrap_err();
    assert!(matches!(error, SchemeError::TiedApart { a: 2, b: 3, distance } if (distance - 3.0).abs() < 1e-9));
    assert!(bezier.moved(&control, &[to(2, 40.0), to(3, 40.0)], 1e-6).is_ok());
    let free = bezier.release(0).unwrap().moved(&control, &[to(0, 0.0)], 1e-6).unwrap();
    assert!(place(free.subdivision_points(&control).unwrap()[0]).distance(DVec3::new(0.0, 20.0, 0.0)) < 1e-12);
}

#[test]
fn an_edited_b_spline_stays_one_polyline() {
    let control = row(&[[0.0; 3], [10.0, 20.0, 0.0], [30.0, 20.0, 5.0], [40.0, 0.0, 30.0]]);
    let scheme = Scheme::preset(Preset::CubicBSpline).unwrap();
    // s2 belongs to p1, p2, p3: it reaches their plane and takes s4, s5, s7 along.
    let [a, b, c] = [place(control[0]), place(control[1]), place(control[2])];
    let position = a * 0.3 + b * 0.6 + c * 0.1;
    let moved = scheme.moved(&control, &[Move { point: 1, position, weight: None }], 1e-6).unwrap();
    let mask = [0.3, 0.6, 0.1];
    for (point, shift) in [(1, 0), (3, 1), (4, 0), (6, 1)] {
        for (r, v) in mask.iter().enumerate() {
            assert!((moved.columns()[point * 4 + r + shift] - v).abs() < 1e-12);
        }
    }
    let curve = iterate(&moved, std::slice::from_ref(&control), 9, 0.0, &go).unwrap();
    assert_eq!((curve.strip_count(), curve.points.len()), (1, 513));
    let off = position + (b - a).cross(c - a).normalize() * 3.0;
    let error = scheme.moved(&control, &[Move { point: 1, position: off, weight: None }], 1e-6).unwrap_err();
    assert!(matches!(error, SchemeError::Unreachable { point: 1, residual, .. } if (residual - 3.0).abs() < 1e-9));
}

#[test]
fn bad_schemes_are_refused() {
    assert_eq!(Scheme::preset(Preset::Bezier { degree: 0 }), Err(SchemeError::Degree { given: 0, largest: 50 }));
    assert_eq!(Scheme::custom(1, vec![1.0]), Err(SchemeError::TooFewControlPoints { given: 1 }));
    assert_eq!(Scheme::custom(2, vec![1.0; 6]), Err(SchemeError::ColumnCount { given: 6, m: 2 }));
    assert_eq!(Scheme::custom(2, vec![]), Err(SchemeError::ColumnCount { given: 0, m: 2 }));
    assert!(matches!(
        Scheme::custom(2, vec![1.0, f64::NAN, 0.0, 0.0]),
        Err(SchemeError::ColumnNotFinite { point: 0, row: 1, .. })
    ));
    let plain = Scheme::custom(2, vec![1.0, 0.0, 0.5, 0.5, 0.5, 0.5, 0.0, 1.0]).unwrap();
    assert_eq!(plain.clone().with_germ(vec![1.0, 0.0]), Err(SchemeError::GermCount { given: 2, m: 2 }));
    assert_eq!(plain.clone().fix(1, 0), Err(SchemeError::NotTheControl { point: 1, control: 0 }));
    assert_eq!(plain.clone().tie(&[0, 3]), Err(SchemeError::ColumnsDiffer { a: 0, b: 3, difference: 1.0 }));
    assert_eq!(plain.clone().tie(&[1, 9]), Err(SchemeError::NoSuchPoint { point: 9, count: 4 }));
    assert_eq!(plain.tie(&[1, 2]).unwrap().ties()[2], super::Tie::Class { class: 1, shift: 0 });
}

#[test]
fn a_polyline_is_checked_like_any_curve() {
    let points = row(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 1.0, 0.0]]);
    let curve = Curve::polyline(points.clone(), true).unwrap();
    assert_eq!((curve.segment_count(), curve.segment(2)), (3, Some((2, 0))));
    assert_eq!(curve.word(1).unwrap().to_string(), "1/#2");
    let few = CurveError::TooFewPoints { given: 1, needed: 2, closed: false };
    assert_eq!(Curve::polyline(points[..1].to_vec(), false), Err(few));
    let mut bad = points;
    bad[2].w = 0.0;
    assert!(matches!(Curve::polyline(bad, false), Err(CurveError::Weight { .. })));
}

#[test]
fn strips_are_checked_like_polylines() {
    let points = row(&[[0.0; 3], [1.0, 0.0, 0.0], [2.0, 1.0, 0.0], [3.0, 1.0, 0.0], [4.0, 1.0, 0.0]]);
    let curve = Curve::strips_of(points.clone(), vec![0, 2, 5], false).unwrap();
    assert_eq!((curve.strip_count(), curve.segment_count()), (2, 3));
    assert_eq!([0, 1, 2, 3].map(|i| curve.segment(i)), [Some((0, 1)), Some((2, 3)), Some((3, 4)), None]);
    assert_eq!(curve.word(2).unwrap().to_string(), "1/#3");
    let few = |given| Err(CurveError::TooFewPoints { given, needed: 2, closed: false });
    assert_eq!(Curve::strips_of(points.clone(), vec![0, 4, 5], false), few(1));
    assert_eq!(Curve::strips_of(points.clone(), vec![0, 4, 2, 5], false), few(0));
    for (starts, closed) in [(vec![0, 2, 5], true), (vec![0, 2], false), (vec![1, 5], false), (vec![], false)] {
        assert!(matches!(Curve::strips_of(points.clone(), starts, closed), Err(CurveError::Strips { .. })));
    }
}
