//! What faces come to, for colours: how flat they are, how they fold, how conical their corners are.

use rayon::prelude::*;
use tenon_geometry::DVec3;
use tenon_geometry::panel::PanelSet;

/// The largest angle between the normals of a panel and of its neighbours, degrees.
pub(super) fn fold(panels: &PanelSet, i: usize) -> f64 {
    let normal = panels.normal[i];
    let neighbours = panels.neighbour[panels.corners(i)].iter().filter_map(|n| n.get());
    let angles = neighbours.filter_map(|n| Some(panels.normal.get(n.panel as usize)?.angle_between(normal)));
    angles.fold(0.0, f64::max).to_degrees()
}

/// The largest distance of corners from the plane through their middle, square to their area, mm.
pub(super) fn off_plane(corners: &[DVec3]) -> f64 {
    let centre = corners.iter().sum::<DVec3>() / corners.len().max(1) as f64;
    let next = corners.iter().cycle().skip(1);
    let area: DVec3 = corners.iter().zip(next).map(|(a, b)| (*a - centre).cross(*b - centre)).sum();
    let normal = area.normalize_or_zero();
    corners.iter().map(|c| (*c - centre).dot(normal).abs()).fold(0.0, f64::max)
}

/// A vertex by its rounded place.
type Place = [i64; 3];

/// What a face is at one of its corners.
#[derive(Clone, Copy)]
struct Corner {
    at: Place,
    face: usize,
    /// Its angle there, degrees.
    angle: f64,
    /// The vertices before and after.
    beside: [Place; 2],
}

/// Of every face the largest difference of opposite angle sums around its corners, degrees (Liu et al. 2006: a vertex of four
/// faces is conical where they are equal). Corners that lie within a thousandth of a millimetre are one. O(corners · log
/// corners).
pub(super) fn conicity(faces: &[&[DVec3]]) -> Vec<f64> {
    let key = |p: DVec3| (p * 1e3).round().to_array().map(|c| c as i64);
    let corners = faces.par_iter().enumerate().flat_map_iter(|(f, face)| {
        let n = face.len();
        (0..n).map(move |i| {
            let (before, here, after) = (face[(i + n - 1) % n], face[i], face[(i + 1) % n]);
            let angle = (before - here).angle_between(after - here).to_degrees();
            Corner { at: key(here), face: f, angle, beside: [key(before), key(after)] }
        })
    });
    let mut corners: Vec<Corner> = corners.collect();
    corners.par_sort_by_key(|c| c.at);
    let mut worst = vec![0.0; faces.len()];
    for corners in corners.chunk_by(|a, b| a.at == b.at) {
        let [first, others @ ..] = corners else { continue };
        if others.len() != 3 {
            continue;
        }
        let touches = |o: &&Corner| o.beside.iter().any(|k| first.beside.contains(k));
        let Some(opposite) = others.iter().find(|o| !touches(o)) else { continue };
        let sides: f64 = others.iter().filter(touches).map(|o| o.angle).sum();
        let off = (first.angle + opposite.angle - sides).abs();
        if others.iter().filter(touches).count() == 2 {
            corners.iter().for_each(|c| worst[c.face] = f64::max(worst[c.face], off));
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_of_faces_are_those_of_their_corners() {
        let flat = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[x, y]| DVec3::new(x, y, 0.0));
        assert_eq!(off_plane(&flat), 0.0);
        let mut bent = flat;
        bent[2].z = 0.4;
        assert!((off_plane(&bent) - 0.1).abs() < 0.02);
        // Four squares around a vertex are conical; moved within their plane the vertex is not.
        let grid = |x: f64, y: f64| DVec3::new(x, y, 0.0);
        let four = |c: DVec3| {
            let [a, b, d, e] = [grid(0.0, -1.0), grid(1.0, 0.0), grid(0.0, 1.0), grid(-1.0, 0.0)];
            let quad = |p, q, r| vec![c, p, q, r];
            [
                quad(a, grid(1.0, -1.0), b),
                quad(b, grid(1.0, 1.0), d),
                quad(d, grid(-1.0, 1.0), e),
                quad(e, grid(-1.0, -1.0), a),
            ]
        };
        let of = |faces: &[Vec<DVec3>]| conicity(&faces.iter().map(Vec::as_slice).collect::<Vec<_>>());
        assert!(of(&four(DVec3::ZERO)).iter().all(|c| *c < 1e-9));
        assert!(of(&four(grid(0.3, 0.3))).iter().all(|c| *c > 10.0));
    }
}
