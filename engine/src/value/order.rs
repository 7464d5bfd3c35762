//! What can be done with a column of any type: split it into pieces, find the order of its items.

use super::column::Column;
use super::item::Text;
use crate::stop::{Pending, Stoppable, Ticker, drop_beside};
use std::cmp::Ordering;

impl Column {
    /// The items `from..to`, as far as they are there. O(to − from).
    #[must_use]
    pub fn part(&self, from: usize, to: usize) -> Self {
        if from == 0 && to >= self.len() {
            return self.clone();
        }
        let to = to.min(self.len());
        self.range(from.min(to)..to)
    }

    /// Pieces of the given sizes, which repeat; the last piece is what remains. `None` if there is no size or one is 0.
    /// O(n).
    #[must_use]
    pub fn split(&self, sizes: &[usize]) -> Option<Vec<Self>> {
        if sizes.is_empty() || sizes.contains(&0) {
            return None;
        }
        // A list that grows is copied as a whole, now and then.
        let round = sizes.iter().fold(0usize, |sum, size| sum.saturating_add(*size));
        let most = (self.len() / round + 1).saturating_mul(sizes.len()).min(self.len());
        let (mut pieces, mut from) = (Pending::new(Vec::with_capacity(most)), 0);
        let ticker = Ticker::new();
        for size in sizes.iter().cycle() {
            ticker.tick();
            if from >= self.len() {
                break;
            }
            let to = from.saturating_add(*size).min(self.len());
            pieces.push(self.part(from, to));
            from = to;
        }
        Some(pieces.take())
    }

    /// The indices of the items from the smallest to the largest: equal items keep their order, gaps come last. Numbers
    /// by value (−0 equals 0, NaN above all others), texts by code points, false before true. `None` for items that have
    /// no order. Stops early, with an order of no use, when `go` says no. O(n log n).
    #[must_use]
    pub fn ascending(&self, go: &dyn Fn() -> bool) -> Option<Vec<usize>> {
        self.order(|o| o, go)
    }

    /// As [`Column::ascending`] from the largest to the smallest; equal items keep their order, gaps come last.
    #[must_use]
    pub fn descending(&self, go: &dyn Fn() -> bool) -> Option<Vec<usize>> {
        self.order(Ordering::reverse, go)
    }

    fn order(&self, turn: fn(Ordering) -> Ordering, go: &dyn Fn() -> bool) -> Option<Vec<usize>> {
        if let Some(items) = self.slice::<f64>() {
            let nan_last = |a: &f64, b: &f64| a.partial_cmp(b).unwrap_or_else(|| a.is_nan().cmp(&b.is_nan()));
            return Some(self.sorted(items, |a, b| turn(nan_last(a, b)), go));
        }
        if let Some(items) = self.slice::<i64>() {
            return Some(self.sorted(items, |a, b| turn(a.cmp(b)), go));
        }
        if let Some(items) = self.slice::<Text>() {
            return Some(self.sorted(items, |a, b| turn(a.cmp(b)), go));
        }
        self.slice::<bool>().map(|items| self.sorted(items, |a, b| turn(a.cmp(b)), go))
    }

    /// Short runs are sorted, then neighbours merged, so that it can stop in between.
    fn sorted<T>(&self, items: &[T], compare: impl Fn(&T, &T) -> Ordering, go: &dyn Fn() -> bool) -> Vec<usize> {
        let compare = |i: usize, j: usize| match (self.is_valid(i), self.is_valid(j)) {
            (true, true) => compare(&items[i], &items[j]),
            (a, b) => b.cmp(&a),
        };
        let mut order: Vec<usize> = (0..items.len()).stoppable().collect();
        for run in order.chunks_mut(RUN).take_while(|_| go()) {
            run.sort_by(|&i, &j| compare(i, j));
        }
        let (mut length, mut merged) = (RUN, Vec::new());
        while length < items.len() && go() {
            merged.reserve_exact(items.len());
            for pair in order.chunks(2 * length) {
                let (left, right) = pair.split_at(length.min(pair.len()));
                merge(left, right, &mut merged, |i, j| compare(i, j).is_le(), go);
            }
            std::mem::swap(&mut order, &mut merged);
            merged.clear();
            length *= 2;
        }
        drop_beside::<usize>(merged.capacity(), merged);
        order
    }
}

/// Items sorted or merged before it is looked whether to go on.
const RUN: usize = 1 << 13;

/// Two sorted runs as one; of equal items the left ones come first. Stops early when `go` says no.
fn merge(
    mut left: &[usize],
    mut right: &[usize],
    into: &mut Vec<usize>,
    left_first: impl Fn(usize, usize) -> bool,
    go: &dyn Fn() -> bool,
) {
    while let ([l, left_rest @ ..], [r, right_rest @ ..]) = (left, right) {
        if into.len().is_multiple_of(RUN) && !go() {
            return;
        }
        if left_first(*l, *r) {
            into.push(*l);
            left = left_rest;
        } else {
            into.push(*r);
            right = right_rest;
        }
    }
    into.extend_from_slice(left);
    into.extend_from_slice(right);
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn order_is_stable_with_gaps_last() {
        let c = Column::with_gaps(vec![Some(2.0), None, Some(f64::NAN), Some(0.0), Some(-0.0), Some(2.0)]);
        assert_eq!(c.ascending(&|| true), Some(vec![3, 4, 0, 5, 2, 1]));
        assert_eq!(c.descending(&|| true), Some(vec![2, 0, 5, 3, 4, 1]));
        let words = Column::new(["b", "a", "B"].map(Text::from).to_vec());
        assert_eq!(words.ascending(&|| true), Some(vec![2, 1, 0]));
        assert_eq!(Column::new(vec![true, false]).ascending(&|| true), Some(vec![1, 0]));
    }

    #[test]
    fn sizes_that_lead_nowhere_are_refused() {
        let c = Column::new(vec![1i64, 2]);
        assert_eq!((c.split(&[]), c.split(&[1, 0])), (None, None));
    }

    proptest! {
        #[test]
        fn pieces_join_to_the_whole(n in 0usize..60, sizes in proptest::collection::vec(1usize..9, 1..5)) {
            let whole = Column::new((0..n as i64).collect());
            let pieces = whole.split(&sizes).unwrap();
            for (i, piece) in pieces.iter().enumerate() {
                let size = sizes[i % sizes.len()];
                prop_assert!(piece.len() == size || (i + 1 == pieces.len() && (1..size).contains(&piece.len())));
            }
            if n > 0 {
                prop_assert_eq!(Column::concat(&pieces), Some(whole));
            }
        }

        #[test]
        fn long_columns_are_sorted_as_short_ones(
            n in RUN - 2..3 * RUN,
            kinds in 1i64..1000,
        ) {
            let values: Vec<i64> = (0..n as i64).map(|i| i * 7919 % kinds).collect();
            let mut expected: Vec<usize> = (0..n).collect();
            expected.sort_by_key(|i| values[*i]);
            let column = Column::new(values);
            prop_assert!(column.ascending(&|| true) == Some(expected));
            // Asked to stop at once it gives what it has.
            prop_assert!(column.ascending(&|| false).is_some());
        }

        #[test]
        fn ascending_numbers_ascend(values in proptest::collection::vec(any::<i64>(), 0..60)) {
            let order = Column::new(values.clone()).ascending(&|| true).unwrap();
            prop_assert!(order.windows(2).all(|w| (values[w[0]], w[0]) < (values[w[1]], w[1])));
        }
    }
}
