//! The figure in barycentric coordinates: K_n itself, before any control point is known (000 §3.3.3).

use super::continuity::Continuity;
use super::scheme::{Scheme, combine};
use glam::DVec4;

/// Columns of K_n in drawing order.
pub(crate) struct Basis {
    /// m entries per point.
    pub(crate) columns: Vec<f64>,
    /// Number of points.
    pub(crate) points: usize,
}

impl Basis {
    /// K_n by K_{n+1} = ∪ T_i K_n. With `merge` the end of each copy is the start of the next one and stands once: only
    /// for connected figures. O(m² kⁿ) time, O(m kⁿ) memory.
    pub(crate) fn new(scheme: &Scheme, continuity: &Continuity, iterations: u32, merge: bool) -> Self {
        let m = scheme.m;
        let mut columns = scheme.germ.clone();
        for _ in 0..iterations {
            let points = columns.len() / m;
            let mut next = Vec::with_capacity(columns.len() * continuity.traversal.letters.len());
            for position in 0..continuity.traversal.letters.len() {
                let (letter, backwards) = continuity.traversal.step(position, false);
                let transformation = scheme.transformation(letter);
                for t in usize::from(merge && position > 0)..points {
                    let at = if backwards { points - 1 - t } else { t };
                    let start = next.len();
                    next.resize(start + m, 0.0);
                    for (a, &c) in columns[at * m..(at + 1) * m].iter().enumerate() {
                        let source = &transformation[a * m..(a + 1) * m];
                        next[start..].iter_mut().zip(source).for_each(|(sum, s)| *sum += s * c);
                    }
                }
            }
            columns = next;
        }
        Self { points: columns.len() / m, columns }
    }

    /// Column of point `i`.
    #[inline]
    pub(crate) fn column(&self, m: usize, i: usize) -> &[f64] {
        &self.columns[i * m..(i + 1) * m]
    }
}

/// The control polygons of all copies after some iterations, in drawing order, and which of them are drawn backwards.
#[derive(Default)]
pub(crate) struct Polygons {
    /// m points per polygon.
    pub(crate) points: Vec<DVec4>,
    /// One per polygon.
    pub(crate) backwards: Vec<bool>,
}

impl Polygons {
    /// Appends the polygons that `control` has after `iterations`, level by level. O(m² kⁿ).
    pub(crate) fn append(&mut self, scheme: &Scheme, continuity: &Continuity, control: &[DVec4], iterations: u32) {
        let (m, k) = (scheme.m, continuity.traversal.letters.len());
        let (mut points, mut flags) = (control.to_vec(), vec![false]);
        for _ in 0..iterations {
            let mut next_points = Vec::with_capacity(points.len() * k);
            let mut next_flags = Vec::with_capacity(flags.len() * k);
            for (polygon, &backwards) in points.chunks_exact(m).zip(&flags) {
                for position in 0..k {
                    let (letter, flag) = continuity.traversal.step(position, backwards);
                    let columns = scheme.transformation(letter).chunks_exact(m);
                    next_points.extend(columns.map(|c| combine(polygon, c)));
                    next_flags.push(flag);
                }
            }
            (points, flags) = (next_points, next_flags);
        }
        self.points.append(&mut points);
        self.backwards.append(&mut flags);
    }
}
