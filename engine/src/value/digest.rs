//! Digests of values: 128 bit xxh3 over a canonical byte stream, the same for every way of feeding it.
//! Short values (most parameters) are hashed from a small buffer without building the big streaming state.

use crate::stop;
use xxhash_rust::xxh3::{Xxh3, xxh3_128};

const BUFFER: usize = 192;
/// So many bytes are digested before it is looked whether to stop.
const OFTEN: usize = 1 << 18;

/// A streaming 128-bit digest. Feeding the same values in the same order gives the same digest on every machine.
pub struct Digester {
    buffer: [u8; BUFFER],
    filled: usize,
    /// Bytes since it was last looked whether to stop.
    fed: usize,
    stream: Option<Box<Xxh3>>,
}

impl Default for Digester {
    fn default() -> Self {
        Self::new()
    }
}

impl Digester {
    /// An empty digest.
    #[must_use]
    #[inline]
    pub fn new() -> Self {
        Self { buffer: [0; BUFFER], filled: 0, fed: 0, stream: None }
    }

    /// Raw bytes, without their length. O(n).
    pub fn raw(&mut self, bytes: &[u8]) {
        if self.filled + bytes.len() <= BUFFER {
            self.buffer[self.filled..self.filled + bytes.len()].copy_from_slice(bytes);
            self.filled += bytes.len();
            return;
        }
        let stream = self.stream.get_or_insert_with(|| Box::new(Xxh3::new()));
        stream.update(&self.buffer[..self.filled]);
        self.fed += self.filled;
        self.filled = 0;
        if self.fed >= OFTEN {
            stop::check();
            self.fed = 0;
        }
        if bytes.len() >= OFTEN {
            for part in bytes.chunks(OFTEN) {
                stop::check();
                stream.update(part);
            }
        } else if bytes.len() >= BUFFER {
            stream.update(bytes);
            self.fed += bytes.len();
        } else {
            self.buffer[..bytes.len()].copy_from_slice(bytes);
            self.filled = bytes.len();
        }
    }

    /// As [`Digester::raw`]; a length that the compiler knows is a move or two.
    #[inline]
    fn fixed<const N: usize>(&mut self, bytes: [u8; N]) {
        match self.buffer.get_mut(self.filled..self.filled + N) {
            Some(room) => {
                room.copy_from_slice(&bytes);
                self.filled += N;
            }
            None => self.raw(&bytes),
        }
    }

    /// One byte.
    #[inline]
    pub fn u8(&mut self, v: u8) {
        self.fixed([v]);
    }

    /// An unsigned 32-bit number.
    #[inline]
    pub fn u32(&mut self, v: u32) {
        self.fixed(v.to_le_bytes());
    }

    /// An unsigned 64-bit number.
    #[inline]
    pub fn u64(&mut self, v: u64) {
        self.fixed(v.to_le_bytes());
    }

    /// Another digest.
    #[inline]
    pub fn u128(&mut self, v: u128) {
        self.fixed(v.to_le_bytes());
    }

    /// A signed 64-bit number.
    #[inline]
    pub fn i64(&mut self, v: i64) {
        self.fixed(v.to_le_bytes());
    }

    /// A float by its bits; every NaN counts as one value, and −0 differs from 0.
    #[inline]
    pub fn f64(&mut self, v: f64) {
        self.u64(bits(v));
    }

    /// A truth value.
    pub fn bool(&mut self, v: bool) {
        self.u8(u8::from(v));
    }

    /// A text with its length.
    pub fn str(&mut self, v: &str) {
        self.bytes(v.as_bytes());
    }

    /// Bytes with their length.
    pub fn bytes(&mut self, v: &[u8]) {
        self.u64(v.len() as u64);
        self.raw(v);
    }

    /// Many floats with their count; faster than one by one. O(n).
    pub fn f64s(&mut self, values: &[f64]) {
        self.u64(values.len() as u64);
        self.f64s_raw(values);
    }

    /// Many floats without their count.
    pub(crate) fn f64s_raw(&mut self, values: &[f64]) {
        if let [one] = values {
            return self.f64(*one);
        }
        let mut block = [0u8; 8 * 64];
        for chunk in values.chunks(64) {
            for (v, out) in chunk.iter().zip(block.chunks_exact_mut(8)) {
                out.copy_from_slice(&bits(*v).to_le_bytes());
            }
            self.raw(&block[..8 * chunk.len()]);
        }
    }

    /// The digest of everything fed so far.
    #[must_use]
    #[inline]
    pub fn finish(mut self) -> u128 {
        match &mut self.stream {
            None => xxh3_128(&self.buffer[..self.filled]),
            Some(stream) => {
                stream.update(&self.buffer[..self.filled]);
                stream.digest128()
            }
        }
    }
}

/// Puts digests together into one, in their order. It only holds for what is a digest already: everything else would have
/// to be hashed first. Each step is a bijection, so what differs in one place never comes to the same.
pub(crate) struct Mixer(u128);

/// Odd, so that multiplying with it can be undone; the bits of π.
const FACTOR: u128 = 0x2432_f6a8_885a_308d_3131_98a2_e037_0735;

/// Above the bits of a number.
const NUMBER: u128 = 0x4a40_9382_2299_f31d << 64;

impl Mixer {
    #[inline]
    pub fn new(first: u128) -> Self {
        Self(first)
    }

    #[inline]
    pub fn feed(&mut self, digest: u128) {
        let product = (self.0 ^ digest).wrapping_mul(FACTOR);
        self.0 = product ^ (product >> 67);
    }

    /// A number as it is: what stands above its bits keeps it apart from digests as well as chance keeps two of those.
    #[inline]
    pub fn feed_number(&mut self, v: f64) {
        self.feed(NUMBER | u128::from(bits(v)));
    }

    #[inline]
    pub fn finish(self) -> u128 {
        let product = self.0.wrapping_mul(FACTOR);
        product ^ (product >> 71)
    }
}

/// The digest of a number alone, which needs no bytes: two rounds of mixing spread 64 bits over 128.
#[inline]
pub(crate) fn digest_number(v: f64) -> u128 {
    let mut mixer = Mixer::new(0x4a40_9382_2299_f31d_0082_efa9_8ec4_e6c8);
    mixer.feed(u128::from(bits(v)));
    mixer.finish()
}

/// A digest in two halves: as `u128` it would be padded to 16 bytes wherever it stands.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Packed([u64; 2]);

impl From<u128> for Packed {
    #[inline]
    fn from(digest: u128) -> Self {
        Self([(digest >> 64) as u64, digest as u64])
    }
}

impl From<Packed> for u128 {
    #[inline]
    fn from(packed: Packed) -> Self {
        Self::from(packed.0[0]) << 64 | Self::from(packed.0[1])
    }
}

#[inline]
pub(crate) fn bits(v: f64) -> u64 {
    if v.is_nan() { f64::NAN.to_bits() } else { v.to_bits() }
}

/// Digest of one byte string.
#[must_use]
pub fn digest_bytes(bytes: &[u8]) -> u128 {
    xxh3_128(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn one_bit_more_or_less_changes_half_of_a_digest() {
        let digests: Vec<u128> = (0..64).map(|b| digest_number(f64::from_bits(1 << b))).collect();
        for (i, a) in digests.iter().enumerate() {
            for b in &digests[..i] {
                assert!((30..98).contains(&(a ^ b).count_ones()), "{a:x} {b:x}");
            }
        }
        let mixed = |words: &[u128]| {
            let mut mixer = Mixer::new(1);
            words.iter().for_each(|w| mixer.feed(*w));
            mixer.finish()
        };
        for bit in 0..128 {
            let change = (mixed(&[5, 7]) ^ mixed(&[5 ^ 1 << bit, 7])).count_ones();
            assert!((30..98).contains(&change), "bit {bit} changes {change}");
        }
        assert_ne!(mixed(&[5, 7]), mixed(&[7, 5]));
    }

    proptest! {
        #[test]
        fn feeding_in_pieces_gives_the_digest_of_the_whole(bytes in proptest::collection::vec(any::<u8>(), 0..900), cuts in proptest::collection::vec(0usize..900, 0..12)) {
            let mut cuts: Vec<usize> = cuts.into_iter().map(|c| c.min(bytes.len())).collect();
            cuts.sort_unstable();
            let mut d = Digester::new();
            let mut from = 0;
            for c in cuts {
                d.raw(&bytes[from..c]);
                from = c;
            }
            d.raw(&bytes[from..]);
            prop_assert_eq!(d.finish(), digest_bytes(&bytes));
        }

        #[test]
        fn many_floats_equal_one_by_one(values in proptest::collection::vec(any::<f64>(), 0..300)) {
            let (mut a, mut b) = (Digester::new(), Digester::new());
            a.f64s(&values);
            b.u64(values.len() as u64);
            values.iter().for_each(|v| b.f64(*v));
            prop_assert_eq!(a.finish(), b.finish());
        }
    }
}
