//! The order of a graph's evaluations: one after another as they were asked for, each with the changes until then.

use std::collections::{BTreeSet, VecDeque};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Turns, and changes `C` that wait for the next one.
pub(crate) struct Turns<C> {
    state: Mutex<State<C>>,
    changed: Condvar,
}

struct State<C> {
    /// The turn of who comes next.
    next: u64,
    /// Whose turn it is.
    serving: u64,
    /// Who has gone before it was their turn.
    gone: BTreeSet<u64>,
    /// Changes by the turn that is to see them first.
    changes: VecDeque<(u64, Vec<C>)>,
}

impl<C> Default for Turns<C> {
    fn default() -> Self {
        let state = State { next: 0, serving: 0, gone: BTreeSet::new(), changes: VecDeque::new() };
        Self { state: state.into(), changed: Condvar::new() }
    }
}

impl<C> Turns<C> {
    fn lock(&self) -> MutexGuard<'_, State<C>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The last turn so far. Whoever gets it must leave it, or nobody behind comes forward.
    pub(crate) fn enter(&self, changes: Vec<C>) -> u64 {
        let mut state = self.lock();
        let turn = state.next;
        state.next += 1;
        if !changes.is_empty() {
            state.changes.push_back((turn, changes));
        }
        turn
    }

    /// Waits for a turn and gives the changes that nobody has seen until then; `None` if it was cancelled before.
    pub(crate) fn wait(&self, turn: u64, cancel: &AtomicBool) -> Option<Vec<C>> {
        let mut state = self.lock();
        while state.serving != turn {
            if cancel.load(Ordering::Acquire) {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        let mut all = Vec::new();
        while let Some((_, changes)) = state.changes.pop_front_if(|(of, _)| *of <= turn) {
            all.extend(changes);
        }
        Some(all)
    }

    /// Ends a turn, or gives up waiting for it.
    pub(crate) fn leave(&self, turn: u64) {
        let mut state = self.lock();
        state.gone.insert(turn);
        loop {
            let serving = state.serving;
            if !state.gone.remove(&serving) {
                break;
            }
            state.serving += 1;
        }
        self.changed.notify_all();
    }

    /// Has those who wait look whether they were cancelled.
    pub(crate) fn wake(&self) {
        let _state = self.lock();
        self.changed.notify_all();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_gives_up_leaves_the_changes_to_the_next() {
        let (turns, go, stop) = (Turns::default(), AtomicBool::new(false), AtomicBool::new(true));
        let [a, b, c] = [vec![1], vec![2], vec![3]].map(|changes| turns.enter(changes));
        assert_eq!(turns.wait(b, &stop), None);
        turns.leave(b);
        assert_eq!(turns.wait(a, &go), Some(vec![1]));
        turns.leave(a);
        assert_eq!(turns.wait(c, &go), Some(vec![2, 3]));
        turns.leave(c);
        assert_eq!(turns.wait(turns.enter(Vec::new()), &go), Some(vec![]));
    }

    #[test]
    fn turns_come_in_order_from_many_threads() {
        let (turns, seen, go) = (Turns::default(), Mutex::new(Vec::new()), AtomicBool::new(false));
        let all: Vec<u64> = (0..20).map(|i| turns.enter(vec![i])).collect();
        std::thread::scope(|s| {
            for turn in all.into_iter().rev() {
                let (turns, seen, go) = (&turns, &seen, &go);
                s.spawn(move || {
                    let changes = turns.wait(turn, go).unwrap();
                    seen.lock().unwrap().extend(changes);
                    turns.leave(turn);
                });
            }
        });
        assert_eq!(seen.into_inner().unwrap(), (0..20).collect::<Vec<_>>());
    }
}
