//! The planarity equations of faces and their gradients: zero where a face is planar, smooth around it.

use crate::mesh::area_vector;
use glam::DVec3;

/// Equations of the faces to be planarized, as sparse rows. A quad has one: the signed distance of its diagonals. An
/// n-gon has n: the distances of its corners from the plane through their mean along Newell's normal.
pub(crate) struct Flatness {
    /// Value of each equation.
    pub value: Vec<f64>,
    /// Where each equation's entries start; one longer than `value`.
    pub start: Vec<u32>,
    /// Mesh vertex of each entry.
    pub vertex: Vec<u32>,
    /// Gradient by that vertex.
    pub gradient: Vec<DVec3>,
    faces: Vec<Vec<u32>>,
}

impl Flatness {
    /// Equations for these loops of four or more vertices, not yet evaluated.
    pub fn new(faces: Vec<Vec<u32>>) -> Self {
        let (mut start, mut vertex) = (vec![0], Vec::new());
        for face in &faces {
            for _ in 0..rows(face.len()) {
                vertex.extend_from_slice(face);
                start.push(vertex.len() as u32);
            }
        }
        let value = vec![0.0; start.len() - 1];
        let gradient = vec![DVec3::ZERO; vertex.len()];
        Self { value, start, vertex, gradient, faces }
    }

    /// The entries of equation `r`.
    pub fn entries(&self, r: usize) -> std::ops::Range<usize> {
        self.start[r] as usize..self.start[r + 1] as usize
    }

    /// Half the sum of squares at these points, without storing anything. Infinite for a face without a normal.
    pub fn energy(&self, points: &[DVec3]) -> f64 {
        let square = |face: &Vec<u32>| match *face.as_slice() {
            [a, b, c, d] => {
                let [a, b, c, d] = [a, b, c, d].map(|v| points[v as usize]);
                (c - a).cross(d - b).try_normalize().map_or(f64::INFINITY, |n| n.dot(b - a).powi(2))
            }
            _ => {
                let corners = face.iter().map(|&v| points[v as usize]);
                let centre = crate::mesh::centre(corners.clone());
                match area_vector(corners.clone()).try_normalize() {
                    Some(n) => corners.map(|p| n.dot(p - centre).powi(2)).sum(),
                    None => f64::INFINITY,
                }
            }
        };
        0.5 * self.faces.iter().map(square).sum::<f64>()
    }

    /// Values at these points; the gradients stay as they are.
    pub fn evaluate(&mut self, points: &[DVec3]) {
        let mut r = 0;
        for face in &self.faces {
            let n = rows(face.len());
            match *face.as_slice() {
                [a, b, c, d] => {
                    let [a, b, c, d] = [a, b, c, d].map(|v| points[v as usize]);
                    self.value[r] = (c - a).cross(d - b).try_normalize().map_or(0.0, |n| n.dot(b - a));
                }
                _ => {
                    let corners = face.iter().map(|&v| points[v as usize]);
                    let centre = crate::mesh::centre(corners.clone());
                    let normal = area_vector(corners.clone()).normalize_or_zero();
                    self.value[r..r + n].iter_mut().zip(corners).for_each(|(h, p)| *h = normal.dot(p - centre));
                }
            }
            r += n;
        }
    }

    /// Values and gradients at these points; a face without a normal gets zero rows.
    pub fn linearize(&mut self, points: &[DVec3]) {
        let mut r = 0;
        for face in &self.faces {
            let n = rows(face.len());
            let entries = self.start[r] as usize..self.start[r + n] as usize;
            let (value, gradient) = (&mut self.value[r..r + n], &mut self.gradient[entries]);
            match *face.as_slice() {
                [a, b, c, d] => quad_row([a, b, c, d].map(|v| points[v as usize]), value, gradient),
                _ => polygon_rows(&face.iter().map(|&v| points[v as usize]).collect::<Vec<_>>(), value, gradient),
            }
            r += n;
        }
    }
}

/// Number of equations of a face.
fn rows(corners: usize) -> usize {
    if corners == 4 { 1 } else { corners }
}

/// h = n · (b − a) with n = (c − a) × (d − b) normalized.
fn quad_row([a, b, c, d]: [DVec3; 4], value: &mut [f64], gradient: &mut [DVec3]) {
    let (ac, bd, ab) = (c - a, d - b, b - a);
    let across = ac.cross(bd);
    let Some(n) = across.try_normalize() else {
        value.fill(0.0);
        gradient.fill(DVec3::ZERO);
        return;
    };
    value[0] = n.dot(ab);
    // How h changes with the direction of `across`.
    let u = (ab - n * n.dot(ab)) / across.length();
    let (by_ac, by_bd) = (bd.cross(u), u.cross(ac));
    gradient.copy_from_slice(&[-n - by_ac, n - by_bd, by_ac, by_bd]);
}

/// r_i = n · (p_i − centre) with Newell's normal n.
fn polygon_rows(points: &[DVec3], value: &mut [f64], gradient: &mut [DVec3]) {
    let count = points.len();
    let area = area_vector(points.iter().copied());
    let centre = crate::mesh::centre(points.iter().copied());
    let Some(n) = area.try_normalize() else {
        value.fill(0.0);
        gradient.fill(DVec3::ZERO);
        return;
    };
    for i in 0..count {
        let arm = points[i] - centre;
        value[i] = n.dot(arm);
        let u = (arm - n * n.dot(arm)) / area.length();
        for j in 0..count {
            let chord = points[(j + 1) % count] - points[(j + count - 1) % count];
            let own = f64::from(u8::from(i == j)) - 1.0 / count as f64;
            gradient[i * count + j] = n * own + 0.5 * chord.cross(u);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn gradients_are_the_differences_of_the_values(
            n in 4usize..8,
            bumps in prop::collection::vec((-0.2..0.2f64, -0.2..0.2f64, -0.3..0.3f64), 8),
        ) {
            let round = |k: usize| (k as f64 * std::f64::consts::TAU / n as f64).sin_cos();
            let points: Vec<DVec3> =
                (0..n).map(|k| DVec3::new(round(k).1, round(k).0, 0.0) + DVec3::from(bumps[k])).collect();
            let mut flat = Flatness::new(vec![(0..n as u32).collect()]);
            flat.linearize(&points);
            prop_assert!((flat.energy(&points) - 0.5 * flat.value.iter().map(|v| v * v).sum::<f64>()).abs() < 1e-14);
            let (value, gradient) = (flat.value.clone(), flat.gradient.clone());
            for k in 0..n {
                for axis in 0..3 {
                    let step = 1e-6;
                    let mut moved = points.clone();
                    moved[k][axis] += step;
                    flat.linearize(&moved);
                    let plus = flat.value.clone();
                    moved[k][axis] -= 2.0 * step;
                    flat.linearize(&moved);
                    for r in 0..value.len() {
                        let difference = (plus[r] - flat.value[r]) / (2.0 * step);
                        prop_assert!((difference - gradient[r * n + k][axis]).abs() < 1e-8);
                    }
                }
            }
        }
    }
}
