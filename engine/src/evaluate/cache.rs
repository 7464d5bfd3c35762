//! The memo: results by digest of node type and inputs, within a budget of bytes. What is dear to compute and small to
//! keep stays longest (GreedyDual-Size: cost over bytes, aged by what has been evicted).

use crate::diagnostic::{Fail, Severity};
use crate::value::Tree;
use std::collections::HashMap;
use std::hash::{BuildHasherDefault, Hasher};
use std::sync::Arc;

/// What a node said while it ran.
pub(crate) type Reports = Option<Arc<[(Severity, Fail)]>>;

/// A remembered result. Without outputs: the node failed.
pub(crate) struct Entry {
    pub outputs: Box<[Tree]>,
    pub reports: Reports,
    pub failed: bool,
    bytes: usize,
    /// Nanoseconds per byte to compute it again.
    worth: f32,
    score: f32,
    /// The evaluation that made it or used it last.
    round: u32,
}

/// Keys are digests already.
#[derive(Default)]
pub(crate) struct AsItIs(u64);

impl Hasher for AsItIs {
    fn finish(&self) -> u64 {
        self.0
    }

    fn write(&mut self, bytes: &[u8]) {
        for b in bytes {
            self.0 = self.0.rotate_left(8) ^ u64::from(*b);
        }
    }

    fn write_u128(&mut self, v: u128) {
        self.0 = v as u64;
    }
}

#[derive(Default)]
pub(crate) struct Memo {
    entries: HashMap<u128, Entry, BuildHasherDefault<AsItIs>>,
    pub bytes: usize,
    age: f32,
    round: u32,
}

/// What an entry costs beside its values.
const OVERHEAD: usize = 96;

impl Memo {
    /// Begins an evaluation.
    pub fn begin(&mut self) {
        self.round = self.round.wrapping_add(1);
    }

    pub fn get(&mut self, key: u128) -> Option<&Entry> {
        let entry = self.entries.get_mut(&key)?;
        entry.score = self.age + entry.worth;
        entry.round = self.round;
        Some(entry)
    }

    pub fn contains(&self, key: u128) -> bool {
        self.entries.contains_key(&key)
    }

    pub fn put(&mut self, key: u128, outputs: Box<[Tree]>, reports: Reports, failed: bool, nanoseconds: u64) {
        let bytes = OVERHEAD + outputs.iter().map(Tree::bytes).sum::<usize>();
        let worth = nanoseconds as f32 / bytes as f32;
        let entry = Entry { outputs, reports, failed, bytes, worth, score: self.age + worth, round: self.round };
        self.bytes += bytes;
        if let Some(old) = self.entries.insert(key, entry) {
            self.bytes -= old.bytes;
        }
    }

    /// Brings the memo below `budget`; true if something was dropped. O(n log n), but a tenth is freed at once.
    pub fn shrink(&mut self, budget: usize) -> bool {
        self.shrink_those(budget, |_| true)
    }

    /// Brings the memo below `budget` as far as that goes without what the evaluation under way has made or used: after it
    /// was cancelled, the next one goes on from there. So the memo never has more than the budget and one evaluation's
    /// results. As [`Memo::shrink`].
    pub fn shrink_older(&mut self, budget: usize) -> bool {
        let now = self.round;
        self.shrink_those(budget, |e| e.round != now)
    }

    fn shrink_those(&mut self, budget: usize, may_go: impl Fn(&Entry) -> bool) -> bool {
        if self.bytes <= budget {
            return false;
        }
        let entries = self.entries.iter().filter(|(_, e)| may_go(e));
        let mut order: Vec<(f32, u128)> = entries.map(|(k, e)| (e.score, *k)).collect();
        order.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let goal = budget - budget / 10;
        for (score, key) in order {
            if self.bytes <= goal {
                break;
            }
            if let Some(entry) = self.entries.remove(&key) {
                self.bytes -= entry.bytes;
                self.age = self.age.max(score);
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cheap_and_big_goes_first() {
        let mut memo = Memo::default();
        let big = || vec![Tree::list(vec![0.0; 10_000])].into_boxed_slice();
        memo.put(1, big(), None, false, 1_000_000_000);
        memo.put(2, big(), None, false, 1_000);
        memo.put(3, big(), None, false, 1_000_000_000);
        let budget = memo.bytes - 1;
        assert!(memo.shrink(budget));
        assert!(memo.contains(1) && !memo.contains(2) && memo.contains(3));
        assert!(memo.shrink(0) && memo.bytes == 0);
    }
}
