//! One vertical line through a board: where there is wood on it.

/// Most stretches of wood on a line.
const MOST: usize = 3;

/// The stretches of wood on a vertical line, from the top down, in 65535ths of the board's thickness.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Column([[u16; 2]; MOST]);

impl Column {
    /// A line that nothing has cut.
    pub const WHOLE: Self = Self([[0, u16::MAX], [0, 0], [0, 0]]);

    /// The stretches, lower and upper end of each, from the top down.
    pub fn stretches(&self) -> impl Iterator<Item = [u16; 2]> + '_ {
        self.0.iter().copied().take_while(|[a, b]| a < b)
    }

    /// The upper end of the uppermost stretch; none where nothing is left.
    #[must_use]
    pub fn top(&self) -> Option<u16> {
        self.stretches().next().map(|s| s[1])
    }

    /// Takes away what lies between two heights; true if there was something. Where more stretches would be left than are
    /// kept, the thinnest gap is filled.
    pub fn cut(&mut self, from: u16, to: u16) -> bool {
        if self.stretches().all(|[a, b]| to <= a || from >= b) || from >= to {
            return false;
        }
        let mut left = [[0; 2]; MOST + 1];
        let mut count = 0;
        let mut push = |a: u16, b: u16| {
            if a < b {
                left[count] = [a, b];
                count += 1;
            }
        };
        for [a, b] in self.stretches() {
            if to <= a || from >= b {
                push(a, b);
            } else {
                push(to.max(a), b);
                push(a, from.min(b));
            }
        }
        if count > MOST {
            let gap = |i: &usize| left[*i][0] - left[*i + 1][1];
            let thinnest = (0..MOST).min_by_key(gap).unwrap_or(0);
            left[thinnest][0] = left[thinnest + 1][0];
            left[thinnest + 1..].rotate_left(1);
        }
        self.0.copy_from_slice(&left[..MOST]);
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn left(c: &Column) -> Vec<[u16; 2]> {
        c.stretches().collect()
    }

    #[test]
    fn cuts_take_stretches_away_from_the_top_the_middle_and_below() {
        let mut c = Column::WHOLE;
        assert!(c.cut(60_000, u16::MAX) && !c.cut(61_000, 62_000));
        assert_eq!(left(&c), [[0, 60_000]]);
        assert!(c.cut(20_000, 30_000));
        assert_eq!(left(&c), [[30_000, 60_000], [0, 20_000]]);
        assert!(c.cut(0, 25_000));
        assert_eq!((left(&c), c.top()), (vec![[30_000, 60_000]], Some(60_000)));
        assert!(c.cut(0, u16::MAX));
        assert_eq!(c.top(), None);
    }

    #[test]
    fn of_more_gaps_than_are_kept_the_thinnest_is_filled() {
        let mut c = Column::WHOLE;
        for [a, b] in [[10_000, 12_000], [30_000, 30_500], [50_000, 53_000]] {
            assert!(c.cut(a, b));
        }
        assert_eq!(left(&c), [[53_000, u16::MAX], [12_000, 50_000], [0, 10_000]]);
    }
}
