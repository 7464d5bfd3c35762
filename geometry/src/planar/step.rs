//! The linear systems of the planarizing steps: sparse Schur complement of the planarity equations, and conjugate
//! gradients for what couples the vertices besides them.

use super::cholesky::Cholesky;
use super::energy::Energy;
use super::flatness::Flatness;
use glam::{DMat3, DVec3};

/// Solves for steps. The equations' rows meet where faces share a free vertex, so their Schur complement J G⁻¹ Jᵀ has
/// nine entries a row on a grid, whatever number of vertices.
pub(crate) struct StepSolver {
    schur: Cholesky,
    entries: Vec<(u32, u32)>,
    values: Vec<f64>,
    /// Per free vertex the equations that it is in, as (equation, entry of the equations' gradient).
    at_start: Vec<u32>,
    at: Vec<(u32, u32)>,
    /// Place in `values` of each pair of equations at each free vertex.
    slots: Vec<u32>,
    /// G⁻¹ per free vertex.
    inverse: Vec<DMat3>,
}

impl StepSolver {
    /// Prepares for these equations; `points` only guide the order of elimination.
    pub fn new(flat: &Flatness, energy: &Energy, points: &[DVec3]) -> Self {
        let (rows, free) = (flat.value.len(), energy.vertices().len());
        let mut at_start = vec![0u32; free + 1];
        let mut centres = Vec::with_capacity(rows);
        for r in 0..rows {
            let vertices = &flat.vertex[flat.entries(r)];
            centres.push(crate::mesh::centre(vertices.iter().map(|&v| points[v as usize])));
            vertices.iter().filter_map(|&v| energy.number(v)).for_each(|i| at_start[i + 1] += 1);
        }
        for i in 0..free {
            at_start[i + 1] += at_start[i];
        }
        let mut fill = at_start.clone();
        let mut at = vec![(0, 0); at_start[free] as usize];
        for r in 0..rows {
            for e in flat.entries(r) {
                if let Some(i) = energy.number(flat.vertex[e]) {
                    at[fill[i] as usize] = (r as u32, e as u32);
                    fill[i] += 1;
                }
            }
        }
        let mut entries: Vec<(u32, u32)> = (0..rows as u32).map(|r| (r, r)).collect();
        for_pairs(&at_start, &at, |_, (r, _), (s, _)| entries.push((r, s)));
        entries.sort_unstable();
        entries.dedup();
        let mut slots = Vec::new();
        for_pairs(&at_start, &at, |_, (r, _), (s, _)| {
            slots.push(entries.binary_search(&(r, s)).unwrap_or_default() as u32);
        });
        let values = vec![0.0; entries.len()];
        let schur = Cholesky::new(&centres, &entries);
        Self { schur, entries, values, at_start, at, slots, inverse: vec![DMat3::ZERO; free] }
    }

    /// Factors `softness · I + J G⁻¹ Jᵀ` with G the diagonal blocks of the energy's curvature; `false` if it cannot.
    pub fn factorize(&mut self, flat: &Flatness, energy: &Energy, softness: f64) -> bool {
        for (inverse, block) in self.inverse.iter_mut().zip(energy.blocks()) {
            *inverse = block.inverse();
        }
        for (value, (r, s)) in self.values.iter_mut().zip(&self.entries) {
            *value = if r == s { softness } else { 0.0 };
        }
        let (values, inverse, mut slot) = (&mut self.values, &self.inverse, self.slots.iter());
        for_pairs(&self.at_start, &self.at, |i, (_, e), (_, f)| {
            if let Some(&slot) = slot.next() {
                values[slot as usize] += flat.gradient[e as usize].dot(inverse[i] * flat.gradient[f as usize]);
            }
        });
        self.schur.factorize(&self.values)
    }

    /// The least step (in the norm of G) that solves the linearized equations: −G⁻¹ Jᵀ (J G⁻¹ Jᵀ)⁻¹ h.
    pub fn restore(&self, flat: &Flatness) -> Vec<DVec3> {
        let mut multipliers = flat.value.clone();
        self.schur.solve(&mut multipliers);
        let mut step = vec![DVec3::ZERO; self.inverse.len()];
        self.add_transposed(flat, &multipliers, -1.0, &mut step);
        step.iter_mut().zip(&self.inverse).for_each(|(s, inverse)| *s = *inverse * *s);
        step
    }

    /// The Gauss-Newton step of energy + ½ |h|² / softness: conjugate gradients, whose preconditioner has the equations
    /// exactly, so that a few dozen rounds do on any mesh.
    /// `None` when `keep_going` says so.
    pub fn descend(
        &self,
        flat: &Flatness,
        energy: &Energy,
        softness: f64,
        keep_going: &dyn Fn() -> bool,
    ) -> Option<Vec<DVec3>> {
        let stiff = 1.0 / softness;
        let mut residual: Vec<DVec3> = energy.gradient().iter().map(|g| -*g).collect();
        self.add_transposed(flat, &flat.value, -stiff, &mut residual);
        let mut step = vec![DVec3::ZERO; residual.len()];
        let mut image = step.clone();
        let mut solved = self.precondition(flat, &residual);
        let mut direction = solved.clone();
        let mut rho = dot(&residual, &solved);
        let enough = 1e-4 * rho;
        for _ in 0..60 {
            if rho.is_nan() || rho <= enough {
                break;
            }
            if !keep_going() {
                return None;
            }
            energy.curve(&direction, &mut image);
            let rates = self.rates(flat, &direction);
            self.add_transposed(flat, &rates, stiff, &mut image);
            let alpha = rho / dot(&direction, &image);
            for i in 0..step.len() {
                step[i] += direction[i] * alpha;
                residual[i] -= image[i] * alpha;
            }
            solved = self.precondition(flat, &residual);
            let next = dot(&residual, &solved);
            let beta = next / rho;
            rho = next;
            direction.iter_mut().zip(&solved).for_each(|(d, s)| *d = *s + *d * beta);
        }
        Some(step)
    }

    /// (G + JᵀJ / softness)⁻¹ by Woodbury's formula.
    fn precondition(&self, flat: &Flatness, residual: &[DVec3]) -> Vec<DVec3> {
        let mut out: Vec<DVec3> = residual.iter().zip(&self.inverse).map(|(r, inverse)| *inverse * *r).collect();
        let mut multipliers = self.rates(flat, &out);
        self.schur.solve(&mut multipliers);
        let mut pull = vec![DVec3::ZERO; out.len()];
        self.add_transposed(flat, &multipliers, 1.0, &mut pull);
        out.iter_mut().zip(pull).zip(&self.inverse).for_each(|((out, pull), inverse)| *out -= *inverse * pull);
        out
    }

    /// J · vector.
    fn rates(&self, flat: &Flatness, vector: &[DVec3]) -> Vec<f64> {
        let mut out = vec![0.0; flat.value.len()];
        for (i, v) in vector.iter().enumerate() {
            for &(r, e) in &self.at[self.at_start[i] as usize..self.at_start[i + 1] as usize] {
                out[r as usize] += flat.gradient[e as usize].dot(*v);
            }
        }
        out
    }

    /// out += scale · Jᵀ · multipliers.
    fn add_transposed(&self, flat: &Flatness, multipliers: &[f64], scale: f64, out: &mut [DVec3]) {
        for (i, out) in out.iter_mut().enumerate() {
            for &(r, e) in &self.at[self.at_start[i] as usize..self.at_start[i + 1] as usize] {
                *out += flat.gradient[e as usize] * (scale * multipliers[r as usize]);
            }
        }
    }
}

fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

/// All pairs of equations (the first not below the second) that meet at each free vertex.
fn for_pairs(start: &[u32], at: &[(u32, u32)], mut visit: impl FnMut(usize, (u32, u32), (u32, u32))) {
    for (i, range) in start.windows(2).enumerate() {
        let here = &at[range[0] as usize..range[1] as usize];
        for (k, &first) in here.iter().enumerate() {
            for &second in &here[..=k] {
                visit(i, first, second);
            }
        }
    }
}
