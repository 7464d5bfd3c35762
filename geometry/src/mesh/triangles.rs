//! A polygon as triangles: a fan where it is convex, ear clipping (Meisters 1975) where it is not.

use glam::DVec3;

/// The triangles of a loop of corners that runs counter-clockwise against `normal`, by corner number: two fewer than there
/// are corners. A loop that crosses itself is covered somehow. O(corners) if it is convex, else O(corners³) at worst.
#[must_use]
pub fn triangles(corners: &[DVec3], normal: DVec3) -> Vec<[u32; 3]> {
    let turn = |a: usize, b: usize, c: usize| (corners[b] - corners[a]).cross(corners[c] - corners[b]).dot(normal);
    let n = corners.len();
    if n < 3 {
        return Vec::new();
    }
    if (0..n).all(|k| turn(k, (k + 1) % n, (k + 2) % n) >= 0.0) {
        return (1..n as u32 - 1).map(|k| [0, k, k + 1]).collect();
    }
    let mut left: Vec<usize> = (0..n).collect();
    let mut out = Vec::with_capacity(n - 2);
    while left.len() > 3 {
        let m = left.len();
        let at = |k: usize| [left[(k + m - 1) % m], left[k], left[(k + 1) % m]];
        let is_ear = |k: &usize| {
            let [a, b, c] = at(*k);
            let inside = |p: usize| turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
            turn(a, b, c) > 0.0 && !left.iter().any(|p| ![a, b, c].contains(p) && inside(*p))
        };
        // Without an ear the loop crosses itself or has no area.
        let ear = (0..m).find(is_ear).unwrap_or(0);
        out.push(at(ear).map(|k| k as u32));
        left.remove(ear);
    }
    out.push([left[0] as u32, left[1] as u32, left[2] as u32]);
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(points: &[[f64; 2]]) -> (usize, f64, f64) {
        let points: Vec<DVec3> = points.iter().map(|[x, y]| DVec3::new(*x, *y, 0.0)).collect();
        let found = triangles(&points, DVec3::Z);
        let areas = found.iter().map(|t| {
            let [a, b, c] = t.map(|k| points[k as usize]);
            (b - a).cross(c - a).z / 2.0
        });
        let areas: Vec<f64> = areas.collect();
        (found.len(), areas.iter().sum(), areas.iter().copied().fold(f64::INFINITY, f64::min))
    }

    #[test]
    fn convex_and_concave_loops_are_covered_once() {
        assert_eq!(area(&[[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]]), (2, 2.0, 1.0));
        // An arrow: the fan from its first corner would leave it.
        assert_eq!(area(&[[0.0, 0.0], [4.0, -3.0], [1.0, 0.0], [4.0, 3.0]]), (2, 3.0, 1.5));
        // A U of 3 by 3 without the middle of 1 by 2.
        let u = [[0.0, 0.0], [3.0, 0.0], [3.0, 3.0], [2.0, 3.0], [2.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]];
        let (count, whole, least) = area(&u);
        assert_eq!((count, whole), (6, 7.0));
        assert!(least > 0.0);
    }

    #[test]
    fn loops_without_sense_come_to_an_end() {
        assert!(triangles(&[DVec3::ZERO, DVec3::X], DVec3::Z).is_empty());
        let bow = [DVec3::ZERO, DVec3::new(1.0, 1.0, 0.0), DVec3::X, DVec3::Y];
        assert_eq!(triangles(&bow, DVec3::Z).len(), 2);
        assert_eq!(triangles(&[DVec3::ZERO; 7], DVec3::Z).len(), 5);
        assert_eq!(triangles(&[DVec3::NAN; 5], DVec3::Z).len(), 3);
    }
}
