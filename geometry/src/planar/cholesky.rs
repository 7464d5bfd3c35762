//! Sparse Cholesky factors of a symmetric matrix whose pattern stays while its values change (Davis 2006, ch. 4), with
//! an order by nested dissection of positions.

use glam::DVec3;

const NONE: u32 = u32::MAX;

/// The factor of a symmetric positive definite matrix. On meshes a row meets few others, and n rows cost O(n log n)
/// memory and O(n^1.5) time to factor: less than everything else up to some ten thousand faces.
pub(crate) struct Cholesky {
    /// New place of each row, and the row at each place.
    place: Vec<u32>,
    row: Vec<u32>,
    /// Entries above the diagonal of the permuted matrix by columns, as (place, index into the values).
    upper_start: Vec<u32>,
    upper: Vec<(u32, u32)>,
    /// Index of each diagonal value, by place.
    diagonal: Vec<u32>,
    parent: Vec<u32>,
    column_start: Vec<usize>,
    factor_row: Vec<u32>,
    factor: Vec<f64>,
}

impl Cholesky {
    /// Prepares for matrices of `positions.len()` rows with values at `entries` (each pair of rows once, every diagonal
    /// entry present), in that order.
    pub fn new(positions: &[DVec3], entries: &[(u32, u32)]) -> Self {
        let n = positions.len();
        let row = dissect(positions, entries);
        let mut place = vec![0u32; n];
        for (k, &r) in row.iter().enumerate() {
            place[r as usize] = k as u32;
        }
        let mut diagonal = vec![0u32; n];
        let mut upper_start = vec![0u32; n + 1];
        let places = |&(i, j): &(u32, u32)| {
            let (a, b) = (place[i as usize], place[j as usize]);
            (a.min(b), a.max(b))
        };
        for (value, entry) in entries.iter().enumerate() {
            let (a, b) = places(entry);
            if a == b {
                diagonal[a as usize] = value as u32;
            } else {
                upper_start[b as usize + 1] += 1;
            }
        }
        for k in 0..n {
            upper_start[k + 1] += upper_start[k];
        }
        let mut fill = upper_start.clone();
        let mut upper = vec![(0, 0); upper_start[n] as usize];
        for (value, entry) in entries.iter().enumerate() {
            let (a, b) = places(entry);
            if a != b {
                upper[fill[b as usize] as usize] = (a, value as u32);
                fill[b as usize] += 1;
            }
        }
        let mut out = Self {
            parent: elimination_tree(&upper_start, &upper),
            place,
            row,
            upper_start,
            upper,
            diagonal,
            column_start: vec![0; n + 1],
            factor_row: Vec::new(),
            factor: Vec::new(),
        };
        let mut reach = Reach::new(n);
        for k in 0..n {
            out.column_start[k + 1] += 1;
            for &i in reach.of(k, &out) {
                out.column_start[i as usize + 1] += 1;
            }
        }
        for k in 0..n {
            out.column_start[k + 1] += out.column_start[k];
        }
        out.factor_row = vec![0; out.column_start[n]];
        out.factor = vec![0.0; out.column_start[n]];
        out
    }

    /// Factors the matrix with these values; `false` if it is not positive definite.
    pub fn factorize(&mut self, values: &[f64]) -> bool {
        let n = self.row.len();
        let mut next = self.column_start.clone();
        let mut x = vec![0.0; n];
        let mut reach = Reach::new(n);
        for k in 0..n {
            for &(i, value) in self.upper_column(k) {
                x[i as usize] = values[value as usize];
            }
            let mut d = values[self.diagonal[k] as usize];
            for &i in reach.of(k, self) {
                let i = i as usize;
                let column = self.column_start[i]..next[i];
                let l = x[i] / self.factor[column.start];
                x[i] = 0.0;
                let below = column.start + 1..column.end;
                for (&r, &v) in self.factor_row[below.clone()].iter().zip(&self.factor[below]) {
                    x[r as usize] -= v * l;
                }
                d -= l * l;
                self.factor_row[next[i]] = k as u32;
                self.factor[next[i]] = l;
                next[i] += 1;
            }
            if d.is_nan() || d <= 0.0 {
                return false;
            }
            self.factor_row[next[k]] = k as u32;
            self.factor[next[k]] = d.sqrt();
            next[k] += 1;
        }
        true
    }

    /// Solves for one right side in place, with the last factor.
    pub fn solve(&self, b: &mut [f64]) {
        let mut x: Vec<f64> = self.row.iter().map(|&r| b[r as usize]).collect();
        for k in 0..x.len() {
            let column = self.column_start[k]..self.column_start[k + 1];
            x[k] /= self.factor[column.start];
            let xk = x[k];
            for p in column.start + 1..column.end {
                x[self.factor_row[p] as usize] -= self.factor[p] * xk;
            }
        }
        for k in (0..x.len()).rev() {
            let column = self.column_start[k]..self.column_start[k + 1];
            let mut xk = x[k];
            for p in column.start + 1..column.end {
                xk -= self.factor[p] * x[self.factor_row[p] as usize];
            }
            x[k] = xk / self.factor[column.start];
        }
        for (b, &place) in b.iter_mut().zip(&self.place) {
            *b = x[place as usize];
        }
    }

    fn upper_column(&self, k: usize) -> &[(u32, u32)] {
        &self.upper[self.upper_start[k] as usize..self.upper_start[k + 1] as usize]
    }
}

/// Parent of each column in the elimination tree.
fn elimination_tree(upper_start: &[u32], upper: &[(u32, u32)]) -> Vec<u32> {
    let n = upper_start.len() - 1;
    let (mut parent, mut ancestor) = (vec![NONE; n], vec![NONE; n]);
    for k in 0..n {
        for &(mut i, _) in &upper[upper_start[k] as usize..upper_start[k + 1] as usize] {
            while i != NONE && i < k as u32 {
                let next = std::mem::replace(&mut ancestor[i as usize], k as u32);
                if next == NONE {
                    parent[i as usize] = k as u32;
                }
                i = next;
            }
        }
    }
    parent
}

/// Rows of the factor, one at a time: the columns that reach row k along the elimination tree, in the tree's order.
struct Reach {
    seen: Vec<u32>,
    path: Vec<u32>,
    stack: Vec<u32>,
}

impl Reach {
    fn new(n: usize) -> Self {
        Self { seen: vec![NONE; n], path: Vec::new(), stack: vec![0; n] }
    }

    fn of(&mut self, k: usize, matrix: &Cholesky) -> &[u32] {
        let mut top = self.stack.len();
        self.seen[k] = k as u32;
        for &(mut i, _) in matrix.upper_column(k) {
            self.path.clear();
            while self.seen[i as usize] != k as u32 {
                self.seen[i as usize] = k as u32;
                self.path.push(i);
                i = matrix.parent[i as usize];
            }
            while let Some(i) = self.path.pop() {
                top -= 1;
                self.stack[top] = i;
            }
        }
        &self.stack[top..]
    }
}

/// Order by nested dissection: halve the rows at the median of their widest extent, number both halves first and the
/// rows of the second that touch the first last. O(n log² n).
fn dissect(positions: &[DVec3], entries: &[(u32, u32)]) -> Vec<u32> {
    let n = positions.len();
    let mut start = vec![0u32; n + 1];
    for &(i, j) in entries {
        start[i as usize + 1] += 1;
        start[j as usize + 1] += 1;
    }
    for k in 0..n {
        start[k + 1] += start[k];
    }
    let mut fill = start.clone();
    let mut near = vec![0u32; start[n] as usize];
    for &(i, j) in entries {
        for (i, j) in [(i, j), (j, i)] {
            near[fill[i as usize] as usize] = j;
            fill[i as usize] += 1;
        }
    }

    enum Task {
        Split(Vec<u32>),
        Number(Vec<u32>),
    }
    let mut order = Vec::with_capacity(n);
    let mut first = vec![false; n];
    let mut tasks = vec![Task::Split((0..n as u32).collect())];
    while let Some(task) = tasks.pop() {
        let mut rows = match task {
            Task::Split(rows) if rows.len() > 16 => rows,
            Task::Split(rows) | Task::Number(rows) => {
                order.extend(rows);
                continue;
            }
        };
        let at = |r: u32| positions[r as usize];
        let low = rows.iter().fold(DVec3::INFINITY, |low, &r| low.min(at(r)));
        let high = rows.iter().fold(DVec3::NEG_INFINITY, |high, &r| high.max(at(r)));
        let axis = (high - low).max_position();
        let half = rows.len() / 2;
        rows.select_nth_unstable_by(half, |&a, &b| at(a)[axis].total_cmp(&at(b)[axis]).then(a.cmp(&b)));
        let mut second = rows.split_off(half);
        rows.sort_unstable();
        second.sort_unstable();
        rows.iter().for_each(|&r| first[r as usize] = true);
        let touches = |r: &u32| {
            let r = *r as usize;
            near[start[r] as usize..start[r + 1] as usize].iter().any(|&q| first[q as usize])
        };
        let (separator, second): (Vec<u32>, Vec<u32>) = second.iter().partition(|r| touches(r));
        rows.iter().for_each(|&r| first[r as usize] = false);
        tasks.push(Task::Number(separator));
        tasks.push(Task::Split(second));
        tasks.push(Task::Split(rows));
    }
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]
        #[test]
        fn solutions_fit_random_matrices(
            n in 1usize..60,
            links in prop::collection::vec((any::<u32>(), any::<u32>(), -1.0..1.0f64), 0..150),
            places in prop::collection::vec((0.0..1.0f64, 0.0..1.0f64), 60),
        ) {
            let mut matrix = vec![vec![0.0; n]; n];
            for (i, j, v) in links {
                let (i, j) = (i as usize % n, j as usize % n);
                if i != j {
                    matrix[i][j] = v;
                    matrix[j][i] = v;
                }
            }
            for (i, row) in matrix.iter_mut().enumerate() {
                row[i] = 0.5 + row.iter().map(|v| v.abs()).sum::<f64>();
            }
            let entries: Vec<(u32, u32)> = (0..n as u32)
                .flat_map(|i| (0..=i).map(move |j| (i, j)))
                .filter(|&(i, j)| matrix[i as usize][j as usize] != 0.0)
                .collect();
            let values: Vec<f64> = entries.iter().map(|&(i, j)| matrix[i as usize][j as usize]).collect();
            let positions: Vec<DVec3> = places[..n].iter().map(|&(x, y)| DVec3::new(x, y, 0.0)).collect();
            let mut cholesky = Cholesky::new(&positions, &entries);
            prop_assert!(cholesky.factorize(&values));
            let solution: Vec<f64> = (0..n).map(|i| (i as f64 * 0.7).sin()).collect();
            let mut b: Vec<f64> = matrix.iter().map(|row| row.iter().zip(&solution).map(|(a, x)| a * x).sum()).collect();
            cholesky.solve(&mut b);
            for (found, wanted) in b.iter().zip(&solution) {
                prop_assert!((found - wanted).abs() < 1e-11, "{found} {wanted}");
            }
            let mut negative = values;
            let last = entries.iter().position(|e| *e == (n as u32 - 1, n as u32 - 1)).unwrap();
            negative[last] = -1.0;
            prop_assert!(!cholesky.factorize(&negative));
        }
    }

    #[test]
    fn a_grid_fills_in_little() {
        let side = 64u32;
        let positions: Vec<DVec3> =
            (0..side * side).map(|i| DVec3::new(f64::from(i % side), f64::from(i / side), 0.0)).collect();
        let mut entries = Vec::new();
        for i in 0..side * side {
            entries.push((i, i));
            let (x, y) = (i % side, i / side);
            for (dx, dy) in [(1i32, 0i32), (-1, 1), (0, 1), (1, 1)] {
                let (x, y) = (x as i32 + dx, y as i32 + dy);
                if (0..side as i32).contains(&x) && y < side as i32 {
                    entries.push(((y * side as i32 + x) as u32, i));
                }
            }
        }
        let cholesky = Cholesky::new(&positions, &entries);
        // Row by row the factor would hold 64 entries a row.
        assert!(cholesky.factor.len() < 30 * (side * side) as usize, "{}", cholesky.factor.len());
    }
}
