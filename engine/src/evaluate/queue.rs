//! The queue of nodes by height: an intrusive list per height, so that a node costs four bytes and no allocation.

const NONE: u32 = u32::MAX;

/// Nodes waiting to be looked at, lowest first.
pub(crate) struct Queue {
    head: Vec<u32>,
    next: Vec<u32>,
    waiting: Vec<bool>,
    count: usize,
    lowest: usize,
}

impl Queue {
    pub fn new(levels: usize, nodes: usize) -> Self {
        Self { head: vec![NONE; levels], next: vec![NONE; nodes], waiting: vec![false; nodes], count: 0, lowest: 0 }
    }

    pub fn len(&self) -> usize {
        self.count
    }

    /// Adds a node unless it waits already. O(1).
    pub fn push(&mut self, node: u32, height: u32) {
        let (n, h) = (node as usize, height as usize);
        if self.waiting[n] {
            return;
        }
        self.waiting[n] = true;
        self.next[n] = self.head[h];
        self.head[h] = node;
        self.lowest = if self.count == 0 { h } else { self.lowest.min(h) };
        self.count += 1;
    }

    /// Takes all nodes of the lowest height, in order of their number.
    pub fn pop_level(&mut self, into: &mut Vec<u32>) {
        into.clear();
        if self.count == 0 {
            return;
        }
        while self.head[self.lowest] == NONE {
            self.lowest += 1;
        }
        let mut n = std::mem::replace(&mut self.head[self.lowest], NONE);
        while n != NONE {
            into.push(n);
            self.waiting[n as usize] = false;
            n = self.next[n as usize];
        }
        self.count -= into.len();
        if !into.is_sorted() {
            into.sort_unstable();
        }
    }

    /// Takes everything.
    pub fn drain(&mut self, into: &mut Vec<u32>) {
        let mut level = Vec::new();
        while self.count > 0 {
            self.pop_level(&mut level);
            into.append(&mut level);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lowest_level_first_in_order_of_number() {
        let mut q = Queue::new(3, 5);
        for (n, h) in [(4, 2), (1, 1), (3, 1), (1, 1), (0, 1)] {
            q.push(n, h);
        }
        let mut level = Vec::new();
        q.pop_level(&mut level);
        assert_eq!(level, [0, 1, 3]);
        q.push(2, 0);
        q.pop_level(&mut level);
        assert_eq!(level, [2]);
        q.pop_level(&mut level);
        assert_eq!((level, q.len()), (vec![4], 0));
    }
}
