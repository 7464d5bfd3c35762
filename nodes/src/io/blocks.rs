//! Long texts under construction. One that grows in a piece is copied whole again and again, which takes tens of
//! milliseconds in which nobody can stop it.

use std::fmt;
use std::io;
use tenon_engine::stop;

/// Bytes of a block.
const BLOCK: usize = 1 << 18;

/// A text in blocks. Writing looks once per block whether to stop ([`stop::check`]).
#[derive(Default)]
pub struct Blocks {
    full: Vec<Vec<u8>>,
    last: Vec<u8>,
}

impl Blocks {
    /// Adds bytes.
    pub fn push(&mut self, bytes: &[u8]) {
        if self.last.len() + bytes.len() > BLOCK {
            stop::check();
            let room = Vec::with_capacity(BLOCK.max(bytes.len()));
            self.full.push(std::mem::replace(&mut self.last, room));
        }
        self.last.extend_from_slice(bytes);
    }

    /// Adds text.
    pub fn push_str(&mut self, text: &str) {
        self.push(text.as_bytes());
    }

    /// Adds all of another text. O(blocks).
    pub fn append(&mut self, other: Self) {
        self.full.push(std::mem::take(&mut self.last));
        self.full.extend(other.full);
        self.last = other.last;
    }

    /// Everything in one piece. O(bytes).
    #[must_use]
    pub fn into_bytes(self) -> Vec<u8> {
        let blocks = || self.full.iter().chain([&self.last]);
        let mut all = Vec::with_capacity(blocks().map(Vec::len).sum());
        for block in blocks() {
            stop::check();
            all.extend_from_slice(block);
        }
        all
    }
}

impl fmt::Write for Blocks {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.push_str(text);
        Ok(())
    }
}

impl io::Write for Blocks {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.push(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn blocks_come_to_what_was_written(pieces in proptest::collection::vec((0u8..=255, 0usize..BLOCK + 9), 0..9), cut in 0usize..9) {
            let written = |pieces: &[(u8, usize)]| {
                let mut blocks = Blocks::default();
                pieces.iter().for_each(|(byte, count)| blocks.push(&vec![*byte; *count]));
                blocks
            };
            let (head, tail) = pieces.split_at(cut.min(pieces.len()));
            let mut blocks = written(head);
            blocks.append(written(tail));
            let whole: Vec<u8> = pieces.iter().flat_map(|(byte, count)| vec![*byte; *count]).collect();
            prop_assert!(blocks.into_bytes() == whole);
        }
    }
}
