//! Which transformed copies meet, decided by the scheme alone (000 §5.2, §5.3).
//!
//! Every point of an iterated polygon is a combination of points of the polygon one level up. Two points are the same
//! when they are the same combination of the same points; then they coincide for all control points. No coordinate is
//! looked at. Between neighbours in drawing order only the letters after their common prefix matter, so (k − 1) · n
//! comparisons settle the whole figure.

use super::curve::Traversal;
use super::scheme::Scheme;
use std::collections::HashMap;

/// Drawing order of the copies, and which neighbours meet.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Continuity {
    pub(crate) traversal: Traversal,
    iterations: usize,
    /// Whether the copies at positions d and d + 1 meet when both are drawn q levels deeper; index d · n + q.
    joined: Vec<bool>,
}

/// Names of formal points: the control points first, then every new combination.
struct Names {
    known: HashMap<Vec<(u32, u64)>, u32>,
    next: u32,
}

impl Names {
    /// The name of the combination of the named points `polygon` by `column`.
    fn combination(&mut self, polygon: &[u32], column: &[f64]) -> u32 {
        let mut terms: Vec<(u32, f64)> =
            polygon.iter().copied().zip(column.iter().copied()).filter(|t| t.1 != 0.0).collect();
        terms.sort_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
        terms.dedup_by(|later, kept| {
            let same = later.0 == kept.0;
            if same {
                kept.1 += later.1;
            }
            same
        });
        if let [(name, 1.0)] = terms[..] {
            return name;
        }
        let next = self.next;
        let key = terms.iter().map(|t| (t.0, t.1.to_bits())).collect();
        let name = *self.known.entry(key).or_insert(next);
        self.next += u32::from(name == next);
        name
    }

    fn polygon(&mut self, scheme: &Scheme, parent: &[u32], letter: usize) -> Vec<u32> {
        scheme.transformation(letter).chunks_exact(scheme.m).map(|c| self.combination(parent, c)).collect()
    }

    fn germ_end(&mut self, scheme: &Scheme, polygon: &[u32], last: bool) -> u32 {
        let m = scheme.m;
        let at = if last { scheme.germ.len() - m } else { 0 };
        self.combination(polygon, &scheme.germ[at..at + m])
    }
}

impl Continuity {
    /// Settles order and joints of the figure after `iterations`. O(k n m²) expected.
    pub(crate) fn of(scheme: &Scheme, iterations: u32) -> Self {
        let (k, n) = (scheme.transformation_count(), iterations as usize);
        let mut names = Names { known: HashMap::new(), next: scheme.m as u32 };
        let root: Vec<u32> = (0..scheme.m as u32).collect();
        let children: Vec<Vec<u32>> = (0..k).map(|i| names.polygon(scheme, &root, i)).collect();
        let ends: Vec<[u32; 2]> =
            children.iter().map(|c| [false, true].map(|last| names.germ_end(scheme, c, last))).collect();
        let traversal = chain(&ends);
        let mut joined = vec![false; k.saturating_sub(1) * n];
        for d in 0..k.saturating_sub(1) {
            // The way out of copy d, and the way into copy d + 1, one level deeper each time.
            let start = |at: usize| {
                let (letter, backwards) = traversal.step(at, false);
                (children[letter].clone(), backwards)
            };
            let (mut out, mut into) = (start(d), start(d + 1));
            for q in 0..n {
                let end = names.germ_end(scheme, &out.0, !out.1);
                joined[d * n + q] = end == names.germ_end(scheme, &into.0, into.1);
                for (side, position) in [(&mut out, k - 1), (&mut into, 0)] {
                    let (letter, backwards) = traversal.step(position, side.1);
                    *side = (names.polygon(scheme, &side.0, letter), backwards);
                }
            }
        }
        Self { traversal, iterations: n, joined }
    }

    /// Whether the whole figure is one polyline.
    pub(crate) fn connected(&self) -> bool {
        self.joined.iter().all(|&j| j)
    }

    /// Number of pieces of one patch. O(k n).
    pub(crate) fn strip_count(&self) -> usize {
        let (k, n) = (self.traversal.letters.len(), self.iterations);
        // The joint q levels up from the finest stands once in every copy n − q − 1 levels down.
        let broken = |at: usize| if self.joined[at] { 0 } else { k.pow((n - at % n - 1) as u32) };
        1 + (0..self.joined.len()).map(broken).sum::<usize>()
    }

    /// Whether no two elements meet in drawing order.
    pub(crate) fn scattered(&self) -> bool {
        self.joined.iter().all(|&j| !j)
    }

    /// Whether element `position` (in drawing order, of one patch) meets the next one. O(n).
    pub(crate) fn joined_after(&self, position: usize) -> bool {
        let (k, n) = (self.traversal.letters.len(), self.iterations);
        let (mut q, mut prefix) = (0, position);
        while q < n && prefix % k == k - 1 {
            (q, prefix) = (q + 1, prefix / k);
        }
        if q == n {
            return false;
        }
        let (d, prefix) = (prefix % k, prefix / k);
        let (mut backwards, mut weight) = (false, k.pow((n - q - 1) as u32));
        let mut rest = prefix;
        for _ in 0..n - q - 1 {
            weight /= k;
            backwards = self.traversal.step(rest / weight, backwards).1;
            rest %= weight;
        }
        let d = if backwards { k - 2 - d } else { d };
        self.joined[d * n + q]
    }
}

/// Chains segments by their shared end points: from a free end on, always to the lowest unused segment that shares the
/// point reached. O(k²).
fn chain(ends: &[[u32; 2]]) -> Traversal {
    let k = ends.len();
    let mut traversal = Traversal { letters: Vec::with_capacity(k), reversed: vec![false; k] };
    // How many unused segments end in each point.
    let mut count: HashMap<u32, usize> = HashMap::new();
    for [a, b] in ends {
        *count.entry(*a).or_default() += 1;
        *count.entry(*b).or_default() += usize::from(a != b);
    }
    let mut unused: Vec<usize> = (0..k).collect();
    let mut reached = None;
    while !unused.is_empty() {
        let find = |wanted: &dyn Fn(u32) -> bool| {
            let sides = unused.iter().enumerate().flat_map(|(at, &i)| [(at, i, 0), (at, i, 1)]);
            sides.into_iter().find(|&(_, i, side)| wanted(ends[i][side]))
        };
        let next = find(&|end| Some(end) == reached).or_else(|| find(&|end| count.get(&end) == Some(&1)));
        let (at, i, side) = next.unwrap_or((0, unused[0], 0));
        unused.remove(at);
        let [a, b] = ends[i];
        count.entry(a).and_modify(|c| *c -= 1);
        count.entry(b).and_modify(|c| *c -= usize::from(a != b));
        traversal.letters.push(i as u32);
        traversal.reversed[i] = side == 1;
        reached = Some(ends[i][1 - side]);
    }
    traversal
}
