//! What can be done with a column of any type: split it into pieces, find the order of its items.

use super::column::Column;
use super::item::Text;
use std::cmp::Ordering;

impl Column {
    /// The items `from..to`, as far as they are there. O(to − from).
    #[must_use]
    pub fn part(&self, from: usize, to: usize) -> Self {
        if from == 0 && to >= self.len() {
            return self.clone();
        }
        self.pick(&(from..to.min(self.len())).map(Some).collect::<Vec<_>>())
    }

    /// Pieces of the given sizes, which repeat; the last piece is what remains. `None` if there is no size or one is 0.
    /// O(n).
    #[must_use]
    pub fn split(&self, sizes: &[usize]) -> Option<Vec<Self>> {
        if sizes.is_empty() || sizes.contains(&0) {
            return None;
        }
        let (mut pieces, mut from) = (Vec::new(), 0);
        for size in sizes.iter().cycle() {
            if from >= self.len() {
                break;
            }
            let to = from.saturating_add(*size).min(self.len());
            pieces.push(self.part(from, to));
            from = to;
        }
        Some(pieces)
    }

    /// The indices of the items from the smallest to the largest: equal items keep their order, gaps come last. Numbers
    /// by value (−0 equals 0, NaN above all others), texts by code points, false before true. `None` for items that have
    /// no order. O(n log n).
    #[must_use]
    pub fn ascending(&self) -> Option<Vec<usize>> {
        self.order(|o| o)
    }

    /// As [`Column::ascending`] from the largest to the smallest; equal items keep their order, gaps come last.
    #[must_use]
    pub fn descending(&self) -> Option<Vec<usize>> {
        self.order(Ordering::reverse)
    }

    fn order(&self, turn: fn(Ordering) -> Ordering) -> Option<Vec<usize>> {
        if let Some(items) = self.slice::<f64>() {
            let nan_last = |a: &f64, b: &f64| a.partial_cmp(b).unwrap_or_else(|| a.is_nan().cmp(&b.is_nan()));
            return Some(self.sorted(items, |a, b| turn(nan_last(a, b))));
        }
        if let Some(items) = self.slice::<i64>() {
            return Some(self.sorted(items, |a, b| turn(a.cmp(b))));
        }
        if let Some(items) = self.slice::<Text>() {
            return Some(self.sorted(items, |a, b| turn(a.cmp(b))));
        }
        self.slice::<bool>().map(|items| self.sorted(items, |a, b| turn(a.cmp(b))))
    }

    fn sorted<T>(&self, items: &[T], compare: impl Fn(&T, &T) -> Ordering) -> Vec<usize> {
        let mut order: Vec<usize> = (0..items.len()).collect();
        order.sort_by(|&i, &j| match (self.is_valid(i), self.is_valid(j)) {
            (true, true) => compare(&items[i], &items[j]),
            (a, b) => b.cmp(&a),
        });
        order
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn order_is_stable_with_gaps_last() {
        let c = Column::with_gaps(vec![Some(2.0), None, Some(f64::NAN), Some(0.0), Some(-0.0), Some(2.0)]);
        assert_eq!(c.ascending(), Some(vec![3, 4, 0, 5, 2, 1]));
        assert_eq!(c.descending(), Some(vec![2, 0, 5, 3, 4, 1]));
        let words = Column::new(["b", "a", "B"].map(Text::from).to_vec());
        assert_eq!(words.ascending(), Some(vec![2, 1, 0]));
        assert_eq!(Column::new(vec![true, false]).ascending(), Some(vec![1, 0]));
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
        fn ascending_numbers_ascend(values in proptest::collection::vec(any::<i64>(), 0..60)) {
            let order = Column::new(values.clone()).ascending().unwrap();
            prop_assert!(order.windows(2).all(|w| (values[w[0]], w[0]) < (values[w[1]], w[1])));
        }
    }
}
