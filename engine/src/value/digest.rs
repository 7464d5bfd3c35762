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

    /// One byte.
    pub fn u8(&mut self, v: u8) {
        self.raw(&[v]);
    }

    /// An unsigned 32-bit number.
    pub fn u32(&mut self, v: u32) {
        self.raw(&v.to_le_bytes());
    }

    /// An unsigned 64-bit number.
    pub fn u64(&mut self, v: u64) {
        self.raw(&v.to_le_bytes());
    }

    /// Another digest.
    pub fn u128(&mut self, v: u128) {
        self.raw(&v.to_le_bytes());
    }

    /// A signed 64-bit number.
    pub fn i64(&mut self, v: i64) {
        self.raw(&v.to_le_bytes());
    }

    /// A float by its bits; every NaN counts as one value, and −0 differs from 0.
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
    pub fn finish(self) -> u128 {
        match self.stream {
            None => xxh3_128(&self.buffer[..self.filled]),
            Some(mut stream) => {
                stream.update(&self.buffer[..self.filled]);
                stream.digest128()
            }
        }
    }
}

fn bits(v: f64) -> u64 {
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
