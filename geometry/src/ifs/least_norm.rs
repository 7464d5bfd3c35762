//! The solution of least norm of a system of four rows, by one-sided Jacobi rotations.
//!
//! Control points may be fewer, more or in worse position than a basis of space: the pseudo-inverse serves them all.

use glam::{DMat4, DVec4};

/// Rounds of rotations; four columns need five or six.
const SWEEPS: usize = 30;

/// The pseudo-inverse of a 4 × n matrix.
pub(crate) struct PseudoInverse {
    /// n rows of U · Σ⁻¹ and V transposed: x = scaled · (turn · r).
    scaled: Vec<DVec4>,
    turn: DMat4,
}

impl PseudoInverse {
    /// Of the matrix with the given columns; directions whose singular value is at most `cutoff` times the largest count
    /// as none. O(n).
    pub(crate) fn new(columns: &[DVec4], cutoff: f64) -> Self {
        // Rows of `u` are the matrix's columns; its four columns are rotated until they are orthogonal.
        let mut u: Vec<[f64; 4]> = columns.iter().map(DVec4::to_array).collect();
        let mut v = DMat4::IDENTITY.to_cols_array_2d();
        for _ in 0..SWEEPS {
            let mut rotated = false;
            for p in 0..3 {
                for q in p + 1..4 {
                    let (mut pp, mut qq, mut pq) = (0.0, 0.0, 0.0);
                    for row in &u {
                        pp += row[p] * row[p];
                        qq += row[q] * row[q];
                        pq += row[p] * row[q];
                    }
                    if pq.abs() <= f64::EPSILON * (pp * qq).sqrt() || pq == 0.0 {
                        continue;
                    }
                    rotated = true;
                    let zeta = (qq - pp) / (2.0 * pq);
                    let t = 1.0_f64.copysign(zeta) / (zeta.abs() + 1.0_f64.hypot(zeta));
                    let c = 1.0 / 1.0_f64.hypot(t);
                    let s = c * t;
                    let rotate = |row: &mut [f64; 4]| {
                        (row[p], row[q]) = (c * row[p] - s * row[q], s * row[p] + c * row[q]);
                    };
                    u.iter_mut().for_each(rotate);
                    v.iter_mut().for_each(rotate);
                }
            }
            if !rotated {
                break;
            }
        }
        let squares = u.iter().fold(DVec4::ZERO, |sum, row| sum + DVec4::from_array(*row) * DVec4::from_array(*row));
        let least = squares.max_element() * cutoff * cutoff;
        let inverse = squares.to_array().map(|s| if s > least { 1.0 / s } else { 0.0 });
        let scaled = u.iter().map(|row| DVec4::from_array(*row) * DVec4::from_array(inverse)).collect();
        // `v` holds V by rows, which is what glam takes for the columns of V transposed.
        Self { scaled, turn: DMat4::from_cols_array_2d(&v) }
    }

    /// The x of least norm that brings A·x nearest to `right`.
    pub(crate) fn solve(&self, right: DVec4) -> Vec<f64> {
        let turned = self.turn * right;
        self.scaled.iter().map(|row| row.dot(turned)).collect()
    }
}
