//! What planarizing costs apart from planarity: displacement (closeness), its unevenness (fairness), and barriers that
//! keep every vertex within its reach and every face convex and unfolded.

use glam::{DMat3, DVec3};

const FIXED: u32 = u32::MAX;

/// What weighs how much, and how far vertices may go.
pub(crate) struct Weights {
    /// On squared displacements.
    pub closeness: f64,
    /// On squared bends of displacements.
    pub fairness: f64,
    /// How far each mesh vertex may move.
    pub reach: Vec<f64>,
}

/// Where displacements are compared: each row says a vertex and those whose mean it should follow.
#[derive(Default)]
pub(crate) struct Bends {
    /// Where each row starts; the first vertex of a row is the middle one.
    start: Vec<u32>,
    vertex: Vec<u32>,
}

impl Bends {
    /// Adds the row "the first vertex follows the mean of the others".
    pub fn push(&mut self, row: &[u32]) {
        self.start.push(self.vertex.len() as u32);
        self.vertex.extend_from_slice(row);
    }

    /// Rows as vertices with their coefficients' common part: 1 for the first, minus the second value for the others.
    fn rows(&self) -> impl Iterator<Item = (&[u32], f64)> {
        let ends = self.start.iter().skip(1).copied().chain([self.vertex.len() as u32]);
        self.start.iter().zip(ends).map(|(&from, to)| {
            let row = &self.vertex[from as usize..to as usize];
            (row, 1.0 / (row.len() - 1) as f64)
        })
    }
}

/// A convex corner of a face that must stay convex seen along the face's first normal.
struct Corner {
    /// Before, at, after: mesh vertices.
    vertices: [u32; 3],
    /// First unit normal of the face over the corner's first double area.
    normal: DVec3,
}

/// A corner whose barrier is felt: gradient of its relative area by the three vertices, and the barrier's curvature.
struct Felt {
    vertices: [u32; 3],
    gradient: [DVec3; 3],
    curvature: f64,
}

/// The energy over the displacements of the free vertices. In units of the mean edge.
pub(crate) struct Energy {
    closeness: f64,
    fairness: f64,
    /// Weight of the barriers.
    wall: f64,
    /// Number of each mesh vertex among the free ones, or `FIXED`.
    number: Vec<u32>,
    /// Mesh vertex of each free one.
    vertex: Vec<u32>,
    origin: Vec<DVec3>,
    bends: Bends,
    corners: Vec<Corner>,
    /// Reach per free vertex.
    reach: Vec<f64>,
    gradient: Vec<DVec3>,
    block: Vec<DMat3>,
    felt: Vec<Felt>,
}

/// Barriers are felt beyond this part of the reach, squared.
const REACH_FELT: f64 = 0.75;
/// Barriers are felt below this part of a corner's first area.
const AREA_FELT: f64 = 0.5;

/// Smooth barrier on 0 < y < from (Li 2020): value and first two derivatives; nothing beyond, infinite at 0.
fn barrier(y: f64, from: f64) -> (f64, f64, f64) {
    if y >= from {
        return (0.0, 0.0, 0.0);
    }
    if y <= 0.0 {
        return (f64::INFINITY, 0.0, 0.0);
    }
    let (gap, log) = (y - from, (y / from).ln());
    let value = -gap * gap * log;
    let first = -2.0 * gap * log - gap * gap / y;
    let second = -2.0 * log - 4.0 * gap / y + gap * gap / (y * y);
    (value, first, second)
}

impl Energy {
    /// The energy about the points as they are. `free` lists the vertices that may move, `bends`
    /// whose displacements to compare, `faces` the loops that must stay convex.
    pub fn new(points: &[DVec3], free: Vec<u32>, bends: Bends, faces: &[Vec<u32>], weights: &Weights) -> Self {
        let mut number = vec![FIXED; points.len()];
        for (i, &v) in free.iter().enumerate() {
            number[v as usize] = i as u32;
        }
        let mut corners = Vec::new();
        for face in faces {
            let n = face.len();
            let Some(normal) = crate::mesh::area_vector(face.iter().map(|&v| points[v as usize])).try_normalize()
            else {
                continue;
            };
            for k in 0..n {
                let vertices = [face[(k + n - 1) % n], face[k], face[(k + 1) % n]];
                let [before, at, after] = vertices.map(|v| points[v as usize]);
                let (u, v) = (after - at, before - at);
                let area = normal.dot(u.cross(v));
                // Corners that are straight or concave already have nothing to keep.
                if area > 1e-3 * u.length() * v.length() && vertices.iter().any(|&v| number[v as usize] != FIXED) {
                    corners.push(Corner { vertices, normal: normal / area });
                }
            }
        }
        let n = free.len();
        Self {
            closeness: weights.closeness,
            fairness: weights.fairness,
            wall: weights.closeness + weights.fairness,
            reach: free.iter().map(|&v| weights.reach[v as usize]).collect(),
            number,
            vertex: free,
            origin: points.to_vec(),
            bends,
            corners,
            gradient: vec![DVec3::ZERO; n],
            block: vec![DMat3::ZERO; n],
            felt: Vec::new(),
        }
    }

    /// Number of a mesh vertex among the free ones.
    pub fn number(&self, vertex: u32) -> Option<usize> {
        let i = self.number[vertex as usize];
        (i != FIXED).then_some(i as usize)
    }

    /// Mesh vertices that may move.
    pub fn vertices(&self) -> &[u32] {
        &self.vertex
    }

    fn displacement(&self, points: &[DVec3], vertex: u32) -> DVec3 {
        points[vertex as usize] - self.origin[vertex as usize]
    }

    fn bend(&self, points: &[DVec3], row: &[u32], share: f64) -> DVec3 {
        let Some((&middle, ends)) = row.split_first() else { return DVec3::ZERO };
        let sum: DVec3 = ends.iter().map(|&v| self.displacement(points, v)).sum();
        self.displacement(points, middle) - sum * share
    }

    /// The energy at these points; infinite where a barrier is broken.
    pub fn value(&self, points: &[DVec3]) -> f64 {
        let mut sum = 0.0;
        for (&v, &reach) in self.vertex.iter().zip(&self.reach) {
            let square = self.displacement(points, v).length_squared();
            sum += 0.5 * self.closeness * square;
            sum += self.wall * barrier(1.0 - square / (reach * reach), REACH_FELT).0;
        }
        for (row, share) in self.bends.rows() {
            sum += 0.5 * self.fairness * self.bend(points, row, share).length_squared();
        }
        for corner in &self.corners {
            let [before, at, after] = corner.vertices.map(|v| points[v as usize]);
            let y = corner.normal.dot((after - at).cross(before - at));
            sum += self.wall * barrier(y, AREA_FELT).0;
        }
        sum
    }

    /// Stores gradient and curvature at these points.
    pub fn linearize(&mut self, points: &[DVec3]) {
        for i in 0..self.vertex.len() {
            let (v, reach) = (self.vertex[i], self.reach[i]);
            let d = self.displacement(points, v);
            let scale = -2.0 / (reach * reach);
            let (_, first, second) = barrier(1.0 - d.length_squared() / (reach * reach), REACH_FELT);
            self.gradient[i] = d * (self.closeness + self.wall * first * scale);
            let round = self.closeness + self.wall * first * scale;
            self.block[i] = DMat3::from_diagonal(DVec3::splat(round)) + outer(d, self.wall * second * scale * scale);
        }
        for (row, share) in self.bends.rows() {
            let pull = self.bend(points, row, share) * self.fairness;
            for (k, &v) in row.iter().enumerate() {
                let (i, weight) = (self.number[v as usize], if k == 0 { 1.0 } else { -share });
                if i != FIXED {
                    self.gradient[i as usize] += pull * weight;
                    self.block[i as usize] += DMat3::from_diagonal(DVec3::splat(self.fairness * weight * weight));
                }
            }
        }
        self.felt.clear();
        for corner in &self.corners {
            let [before, at, after] = corner.vertices.map(|v| points[v as usize]);
            let (u, v) = (after - at, before - at);
            let (_, first, second) = barrier(corner.normal.dot(u.cross(v)), AREA_FELT);
            if second == 0.0 {
                continue;
            }
            let (by_before, by_after) = (corner.normal.cross(u), v.cross(corner.normal));
            let gradient = [by_before, -by_before - by_after, by_after];
            let curvature = self.wall * second;
            for (&v, &g) in corner.vertices.iter().zip(&gradient) {
                let i = self.number[v as usize];
                if i != FIXED {
                    self.gradient[i as usize] += g * (self.wall * first);
                    self.block[i as usize] += outer(g, curvature);
                }
            }
            self.felt.push(Felt { vertices: corner.vertices, gradient, curvature });
        }
    }

    /// The stored gradient, per free vertex.
    pub fn gradient(&self) -> &[DVec3] {
        &self.gradient
    }

    /// The stored curvature's diagonal blocks, per free vertex.
    pub fn blocks(&self) -> &[DMat3] {
        &self.block
    }

    /// Curvature times a vector, into `out`.
    pub fn curve(&self, vector: &[DVec3], out: &mut [DVec3]) {
        for ((out, block), v) in out.iter_mut().zip(&self.block).zip(vector) {
            *out = *block * *v;
        }
        for (row, share) in self.bends.rows() {
            let weight = |k: usize| if k == 0 { 1.0 } else { -share };
            let at = |v: u32| self.number[v as usize] as usize;
            let mut bend = DVec3::ZERO;
            for (k, &v) in row.iter().enumerate() {
                bend += vector.get(at(v)).map_or(DVec3::ZERO, |d| *d * weight(k));
            }
            for (k, &v) in row.iter().enumerate() {
                if let Some(out) = out.get_mut(at(v)) {
                    // The diagonal blocks are in `block` already.
                    *out += (bend - vector[at(v)] * weight(k)) * (self.fairness * weight(k));
                }
            }
        }
        for felt in &self.felt {
            let numbers = felt.vertices.map(|v| self.number[v as usize]);
            let along =
                |k: usize| if numbers[k] == FIXED { 0.0 } else { felt.gradient[k].dot(vector[numbers[k] as usize]) };
            let each = [along(0), along(1), along(2)];
            let all = each[0] + each[1] + each[2];
            for k in 0..3 {
                if numbers[k] != FIXED {
                    // The diagonal blocks are in `block` already.
                    out[numbers[k] as usize] += felt.gradient[k] * (felt.curvature * (all - each[k]));
                }
            }
        }
    }
}

fn outer(v: DVec3, scale: f64) -> DMat3 {
    DMat3::from_cols(v * (v.x * scale), v * (v.y * scale), v * (v.z * scale))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn the_gradient_is_the_difference_of_the_value_and_the_curvature_is_symmetric(
            moves in prop::collection::vec((-0.5..0.5f64, -0.5..0.5f64, -0.5..0.5f64), 9),
            closeness in 0.1..2.0f64,
            fairness in 0.0..5.0f64,
        ) {
            let origin: Vec<DVec3> =
                (0..9u32).map(|i| DVec3::new(f64::from(i % 3), f64::from(i / 3), 0.2 * f64::from(i * i % 5))).collect();
            let faces: Vec<Vec<u32>> = [0, 1, 3, 4].map(|v| vec![v, v + 1, v + 4, v + 3]).to_vec();
            let mut bends = Bends::default();
            bends.push(&[4, 3, 5]);
            bends.push(&[4, 1, 7]);
            bends.push(&[1, 0, 2]);
            bends.push(&[4, 0, 2, 6]);
            let weights = Weights { closeness, fairness, reach: vec![1.0; 9] };
            let free: Vec<u32> = (1..9).collect();
            let mut energy = Energy::new(&origin, free.clone(), bends, &faces, &weights);
            let mut points = origin;
            free.iter().for_each(|&v| points[v as usize] += DVec3::from(moves[v as usize]));
            // Steps never leave the walls.
            if !energy.value(&points).is_finite() {
                return Ok(());
            }
            energy.linearize(&points);
            for (i, &v) in free.iter().enumerate() {
                for axis in 0..3 {
                    let at = |step: f64| {
                        let mut moved = points.clone();
                        moved[v as usize][axis] += step;
                        energy.value(&moved)
                    };
                    let difference = (at(1e-6) - at(-1e-6)) / 2e-6;
                    let gradient = energy.gradient()[i][axis];
                    // Near a wall the energy is too steep for differences.
                    if gradient.abs() < 100.0 {
                        prop_assert!((difference - gradient).abs() < 1e-4, "{difference} {gradient}");
                    }
                }
            }
            let unit = |k: usize| {
                let mut v = vec![DVec3::ZERO; 8];
                v[k / 3][k % 3] = 1.0;
                v
            };
            let mut columns = vec![vec![DVec3::ZERO; 8]; 24];
            (0..24).for_each(|k| energy.curve(&unit(k), &mut columns[k]));
            for j in 0..24 {
                prop_assert!(columns[j][j / 3][j % 3] > 0.0);
                for k in 0..j {
                    let (a, b) = (columns[j][k / 3][k % 3], columns[k][j / 3][j % 3]);
                    prop_assert!((a - b).abs() <= 1e-12 * (1.0 + a.abs()));
                    if j / 3 == k / 3 {
                        prop_assert!((a - energy.blocks()[j / 3].col(j % 3)[k % 3]).abs() <= 1e-9 * (1.0 + a.abs()));
                    }
                }
            }
        }
    }
}
