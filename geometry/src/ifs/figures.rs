//! Tests: the presets draw the figures that their names promise, point by point.

use super::{Curve, Move, Preset, Scheme, Traversal, homogeneous, iterate, patches};
use glam::{DVec3, DVec4, Vec4Swizzles};
use std::f64::consts::FRAC_1_SQRT_2;

const S3: f64 = 1.732_050_807_568_877_2;
const TRIANGLE: [[f64; 2]; 3] = [[0.0, 0.0], [0.5, 0.5], [1.0, 0.0]];
const KOCH: [[f64; 2]; 3] = [[0.0, 0.0], [0.5, S3 / 6.0], [1.0, 0.0]];

fn plane(points: &[[f64; 2]]) -> Vec<DVec4> {
    points.iter().map(|&[x, y]| homogeneous(DVec3::new(x, y, 0.0), 1.0)).collect()
}

fn draw_scheme(scheme: &Scheme, control: &[[f64; 2]], n: u32) -> Curve {
    iterate(scheme, &[plane(control)], n, 1e-6, &|_| true).unwrap()
}

fn draw(preset: Preset, control: &[[f64; 2]], n: u32) -> Curve {
    draw_scheme(&Scheme::preset(preset).unwrap(), control, n)
}

fn assert_points(curve: &Curve, expected: &[[f64; 2]]) {
    let points = curve.projected();
    assert_eq!(points.len(), expected.len());
    for (p, &[x, y]) in points.iter().zip(expected) {
        assert!(p.distance(DVec3::new(x, y, 0.0)) < 1e-14, "{p} is not ({x}, {y})");
    }
}

#[test]
fn koch_points_after_one_two_and_three_iterations() {
    assert_points(&draw(Preset::Koch, &KOCH, 1), &KOCH);
    let (third, apex) = (1.0 / 3.0, S3 / 6.0);
    let two = [[0.0, 0.0], [third, 0.0], [0.5, apex], [2.0 * third, 0.0], [1.0, 0.0]];
    assert_points(&draw(Preset::Koch, &KOCH, 2), &two);
    let three = [
        [0.0, 0.0],
        [third / 2.0, apex / 3.0],
        [third, 0.0],
        [third, apex * 2.0 / 3.0],
        [0.5, apex],
        [2.0 * third, apex * 2.0 / 3.0],
        [2.0 * third, 0.0],
        [1.0 - third / 2.0, apex / 3.0],
        [1.0, 0.0],
    ];
    assert_points(&draw(Preset::Koch, &KOCH, 3), &three);
}

#[test]
fn two_iterations_of_koch_are_one_classical_step() {
    // The classical step: a segment becomes four, of a third of its length, with the peak to its left.
    let mut classical = vec![DVec3::ZERO, DVec3::X];
    for _ in 0..4 {
        let mut next = vec![classical[0]];
        for pair in classical.windows(2) {
            let third = (pair[1] - pair[0]) / 3.0;
            let peak = third / 2.0 + DVec3::new(-third.y, third.x, 0.0) * (S3 / 2.0);
            next.extend([pair[0] + third, pair[0] + third + peak, pair[1] - third, pair[1]]);
        }
        classical = next;
    }
    let curve = draw(Preset::Koch, &KOCH, 8).projected();
    assert_eq!(curve.len(), classical.len());
    for (p, q) in curve.iter().zip(&classical) {
        assert!(p.distance(*q) < 1e-14);
    }
}

#[test]
fn takagi_values_at_dyadic_places() {
    let n = 12;
    let points = draw(Preset::Takagi, &TRIANGLE, n).projected();
    for (i, p) in points.iter().enumerate() {
        let x = i as f64 / f64::from(1 << n);
        let blancmange: f64 = (0..n)
            .map(|j| (x * f64::from(1 << j)).fract())
            .zip(0..n)
            .map(|(t, j)| t.min(1.0 - t) / f64::from(1 << j))
            .sum();
        assert!((p.x - x).abs() < 1e-14 && (p.y - blancmange).abs() < 1e-14);
    }
}

#[test]
fn parabola_passes_its_control_points_and_is_one() {
    let points = draw(Preset::Parabola, &[[0.0, 0.0], [0.5, 1.0], [1.0, 0.0]], 9).projected();
    assert_eq!(points[256], DVec3::new(0.5, 1.0, 0.0));
    for p in points {
        assert!((p.y - 4.0 * p.x * (1.0 - p.x)).abs() < 1e-14);
    }
}

#[test]
fn levy_has_equal_sides_and_the_turns_of_its_construction() {
    let n = 11;
    let points = draw(Preset::Levy, &TRIANGLE, n).projected();
    assert_eq!(points.len(), (1 << n) + 1);
    assert_eq!((points[0], points[1 << n]), (DVec3::ZERO, DVec3::X));
    let side = FRAC_1_SQRT_2.powi(n as i32);
    for (i, three) in points.windows(3).enumerate() {
        let (u, v) = (three[1] - three[0], three[2] - three[1]);
        assert!((u.length() - side).abs() < 1e-14);
        // The direction of side i is turned by 45° (n − 2 ones of i), so a joint turns by 90° (zeros passed − 1).
        let turn = f64::from((i + 1).trailing_zeros()) - 1.0;
        let angle = turn * std::f64::consts::FRAC_PI_2;
        assert!((u.dot(v) / side.powi(2) - angle.cos()).abs() < 1e-9);
        assert!((u.cross(v).z / side.powi(2) - angle.sin()).abs() < 1e-9);
    }
}

#[test]
fn dragon_is_one_polyline_in_the_order_of_its_shared_points() {
    let n = 12;
    let curve = draw(Preset::Dragon, &TRIANGLE, n);
    assert_eq!((curve.strip_count(), curve.segment_count()), (1, 1 << n));
    assert_eq!(curve.words.traversal, Traversal { letters: vec![0, 1], reversed: vec![false, true] });
    let points = curve.projected();
    let side = FRAC_1_SQRT_2.powi(n as i32);
    for (i, three) in points.windows(3).enumerate() {
        let (u, v) = (three[1] - three[0], three[2] - three[1]);
        assert!((u.length() - side).abs() < 1e-14);
        // Paper folding: the turn at point i is decided by the bit above the lowest one of i.
        let i = i + 1;
        let right = (i & i.wrapping_neg()) << 1 & i == 0;
        assert!((u.cross(v).z / side.powi(2) - if right { -1.0 } else { 1.0 }).abs() < 1e-9);
    }
    let words: Vec<String> = (0..4).map(|s| draw(Preset::Dragon, &TRIANGLE, 2).word(s).unwrap().to_string()).collect();
    assert_eq!(words, ["1/11", "1/12", "1/22", "1/21"]);
}

#[test]
fn cantor_is_left_in_pieces() {
    let curve = draw(Preset::Cantor, &[[0.0, 0.0], [9.0, 0.0]], 2);
    assert_eq!(curve.strip_start, [0, 2, 4, 6, 8]);
    let x = [0.0, 1.0, 2.0, 3.0, 6.0, 7.0, 8.0, 9.0];
    assert_points(&curve, &x.map(|x| [x, 0.0]));
    assert_eq!(curve.segment(2), Some((4, 5)));
    assert_eq!(curve.segment(4), None);
    assert_eq!(curve.word(2).unwrap().to_string(), "1/21");
}

#[test]
fn cantor_becomes_a_line_when_its_free_points_coincide() {
    let scheme = Scheme::preset(Preset::Cantor).unwrap();
    let control = [[0.0, 0.0], [8.0, 0.0]];
    let moves = [1, 2].map(|point| Move { point, position: DVec3::new(2.0, 0.0, 0.0), weight: None });
    let line = scheme.moved(&plane(&control), &moves, 1e-6).unwrap();
    assert_points(&draw_scheme(&line, &control, 2), &[[0.0, 0.0], [0.5, 0.0], [2.0, 0.0], [3.5, 0.0], [8.0, 0.0]]);
}

#[test]
fn one_object_reaches_takagi_koch_levy_and_parabola_by_subdivision_points_alone() {
    let takagi = Scheme::preset(Preset::Takagi).unwrap();
    for preset in [Preset::Koch, Preset::Levy, Preset::Parabola, Preset::Takagi] {
        let goal = Scheme::preset(preset).unwrap();
        let control = plane(&[[-3.0, 1.0], [40.0, 27.0], [110.0, -5.0]]);
        let points = goal.subdivision_points(&control).unwrap();
        let moves: Vec<Move> =
            points.iter().enumerate().map(|(point, s)| Move { point, position: s.xyz() / s.w, weight: None }).collect();
        let reached = takagi.moved(&control, &moves, 1e-6).unwrap();
        assert_eq!(reached.ties(), goal.ties());
        for (a, b) in reached.columns().iter().zip(goal.columns()) {
            assert!((a - b).abs() < 1e-13, "{preset:?}");
        }
    }
}

#[test]
fn reversed_order_draws_the_same_bezier_curve() {
    // 000 §5.3 b: p1 = s1, s3 = s6, s4 = p3.
    let bezier = Scheme::preset(Preset::Bezier { degree: 2 }).unwrap();
    let c = bezier.columns();
    let columns = [&c[..9], &c[15..], &c[12..15], &c[9..12]].concat();
    let reversed = Scheme::custom(3, columns).unwrap();
    let control = [[0.0, 0.0], [1.0, 3.0], [4.0, 0.0]];
    assert_eq!(draw_scheme(&reversed, &control, 6).points, draw_scheme(&bezier, &control, 6).points);
}

#[test]
fn b_spline_is_the_refined_polygon_of_a_long_row() {
    let row: Vec<[f64; 2]> = (0..9).map(|i| [f64::from(i), f64::from(i * i % 5)]).collect();
    let n = 5;
    let scheme = Scheme::preset(Preset::CubicBSpline).unwrap();
    let curve = iterate(&scheme, &patches(&plane(&row), 4, 3, false).unwrap(), n, 1e-9, &|_| true).unwrap();
    // Lane and Riesenfeld: double every point, average twice... three times for cubics.
    let mut polygon: Vec<DVec3> = row.iter().map(|&[x, y]| DVec3::new(x, y, 0.0)).collect();
    for _ in 0..n {
        polygon = polygon.iter().flat_map(|p| [*p, *p]).collect();
        for _ in 0..3 {
            polygon = polygon.windows(2).map(|w| (w[0] + w[1]) / 2.0).collect();
        }
    }
    let points = curve.projected();
    assert_eq!((curve.strip_count(), curve.closed, points.len()), (1, false, 6 * (1 << n) + 1));
    let first = polygon.iter().position(|p| p.distance(points[0]) < 1e-12).unwrap();
    for (p, q) in points.iter().zip(&polygon[first..]) {
        assert!(p.distance(*q) < 1e-12);
    }
    // As a closed row it comes back to its start.
    let closed = iterate(&scheme, &patches(&plane(&row), 4, 3, true).unwrap(), n, 1e-9, &|_| true).unwrap();
    assert!(closed.closed);
    assert_eq!((closed.points.len(), closed.segment_count()), (9 * (1 << n), 9 * (1 << n)));
}

#[test]
fn hilbert_visits_every_cell_once_from_its_u_shaped_germ() {
    // p1 = origin, p2 = x end, p3 = y end of the unit square.
    let column = |x: f64, y: f64| [1.0 - x - y, x, y];
    let map =
        |o: [f64; 2], x: [f64; 2], y: [f64; 2]| [column(o[0], o[1]), column(x[0], x[1]), column(y[0], y[1])].concat();
    let columns = [
        map([0.0, 0.0], [0.0, 0.5], [0.5, 0.0]),
        map([0.0, 0.5], [0.5, 0.5], [0.0, 1.0]),
        map([0.5, 0.5], [1.0, 0.5], [0.5, 1.0]),
        map([1.0, 0.5], [1.0, 0.0], [0.5, 0.5]),
    ];
    let germ = [column(0.25, 0.25), column(0.25, 0.75), column(0.75, 0.75), column(0.75, 0.25)].concat();
    let scheme = Scheme::custom(3, columns.concat()).unwrap().with_germ(germ).unwrap();
    let n = 4;
    let curve = draw_scheme(&scheme, &[[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]], n);
    let size = 2_usize.pow(n + 1);
    assert_eq!((curve.strip_count(), curve.points.len()), (4_usize.pow(n), size * size));
    let points = curve.projected();
    let mut seen = vec![false; size * size];
    for p in &points {
        let cell = (p.y * size as f64) as usize * size + (p.x * size as f64) as usize;
        assert!(!std::mem::replace(&mut seen[cell], true));
    }
    // The copies do not touch, but follow one another at the distance of a cell.
    for pair in points.windows(2) {
        assert!((pair[0].distance(pair[1]) - 1.0 / size as f64).abs() < 1e-14);
    }
    assert_eq!(curve.word(5).unwrap().to_string(), "1/1112#3");
}

#[test]
fn copies_that_meet_only_in_part_make_strips() {
    // Thirds of a segment, of which the first two meet and the last is apart.
    let column = |x: f64| [1.0 - x, x];
    let columns = [0.0, 0.25, 0.25, 0.5, 0.75, 1.0].map(column).concat();
    let scheme = Scheme::custom(2, columns).unwrap();
    let curve = draw_scheme(&scheme, &[[0.0, 0.0], [16.0, 0.0]], 2);
    // Only the last copy within a copy touches the next: 0.25 · 16 is shared by T1 T3 and T2 T1.
    let x = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 12.0, 13.0, 14.0, 15.0, 16.0];
    assert_points(&curve, &x.map(|x| [x, 0.0]));
    assert_eq!(curve.strip_start, [0, 3, 7, 9, 12, 14]);
    assert_eq!(curve.segment_count(), 9);
    let ends: Vec<_> = (0..9).map(|s| curve.segment(s).unwrap()).collect();
    assert_eq!(ends, [(0, 1), (1, 2), (3, 4), (4, 5), (5, 6), (7, 8), (9, 10), (10, 11), (12, 13)]);
}
