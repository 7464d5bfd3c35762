//! Plain numbers: a seeded random sequence that is the same everywhere, and the statistics of a list.

use crate::stop::{Stoppable, Ticker};

/// Random numbers in 0 ≤ x < 1: SplitMix64 (Steele, Lea, Flood 2014) started at `seed`, of every 64-bit number the upper
/// 53 bits over 2⁵³. Integer arithmetic and one exact division: the same on every machine, and for ever.
#[derive(Clone, Debug)]
pub struct Random {
    state: u64,
}

impl Random {
    /// The sequence of that seed.
    #[must_use]
    pub fn new(seed: i64) -> Self {
        Self { state: seed as u64 }
    }

    fn bits(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

impl Iterator for Random {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        Some((self.bits() >> 11) as f64 / (1u64 << 53) as f64)
    }
}

/// What is said of a list of numbers in short.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Statistics {
    /// Sum.
    pub sum: f64,
    /// Sum over count.
    pub mean: f64,
    /// Smallest.
    pub min: f64,
    /// Largest.
    pub max: f64,
    /// The middle one in order, or the mean of the two in the middle.
    pub median: f64,
    /// Standard deviation of the list itself (divided by the count, not by one less).
    pub deviation: f64,
}

impl Statistics {
    /// The statistics of `numbers`; `None` if there is none. O(n log n).
    #[must_use]
    pub fn of(numbers: &[f64]) -> Option<Self> {
        if numbers.is_empty() {
            return None;
        }
        let (mut sorted, ticker): (Vec<f64>, _) = (numbers.iter().stoppable().copied().collect(), Ticker::new());
        sorted.sort_by(|a, b| {
            ticker.tick();
            a.total_cmp(b)
        });
        let n = sorted.len();
        let sum: f64 = numbers.iter().stoppable().sum();
        let mean = sum / n as f64;
        // From the mean: sums of squares would cancel where the numbers are large and near each other.
        let variance = numbers.iter().stoppable().map(|x| (x - mean).powi(2)).sum::<f64>() / n as f64;
        let median = if n % 2 == 1 { sorted[n / 2] } else { sorted[n / 2 - 1].midpoint(sorted[n / 2]) };
        Some(Self { sum, mean, min: sorted[0], max: sorted[n - 1], median, deviation: variance.sqrt() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_generator_is_splitmix64() {
        // The reference implementation's first numbers from the seed 1234567.
        let mut r = Random::new(1_234_567);
        let bits = [r.bits(), r.bits(), r.bits()];
        assert_eq!(bits, [6_457_827_717_110_365_317, 3_203_168_211_198_807_973, 9_817_491_932_198_370_423]);
        assert!(Random::new(-1).take(1000).all(|x| (0.0..1.0).contains(&x)));
    }

    #[test]
    fn statistics_of_a_few_numbers() {
        let s = Statistics::of(&[2.0, 4.0, 4.0, 4.0, 5.0, 5.0, 7.0, 9.0]).unwrap();
        assert_eq!(s, Statistics { sum: 40.0, mean: 5.0, min: 2.0, max: 9.0, median: 4.5, deviation: 2.0 });
        assert_eq!(Statistics::of(&[1e9 + 1.0, 1e9 + 3.0]).map(|s| s.deviation), Some(1.0));
        assert_eq!(Statistics::of(&[3.0]).map(|s| (s.median, s.deviation)), Some((3.0, 0.0)));
        assert_eq!(Statistics::of(&[]), None);
    }
}
