//! The desk between the thread that edits and the thread that evaluates: mail goes one way, the latest result the other.
//! It is all the synchronisation that [`super::Live`] has. The lock is held for moves of a few words only, so nobody
//! waits for an evaluation except who asks to. `tests/threads.rs` compiles this file against another `sync`, which tries
//! the threads' orders.

use super::sync::{Condvar, Mutex, MutexGuard};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

struct State<M, R> {
    mail: Vec<M>,
    /// The latest result and its revision.
    latest: Option<(u64, Arc<R>)>,
    /// The evaluating thread has read all mail and has nothing to do.
    idle: bool,
    /// One of the two threads has gone.
    closed: bool,
}

/// See the file's head. `M` is mail, `R` a result.
pub struct Desk<M, R> {
    state: Mutex<State<M, R>>,
    changed: Condvar,
    /// Set while mail is waiting that an evaluation should stop for. Changes only under the lock.
    stop: Arc<AtomicBool>,
}

impl<M, R> Desk<M, R> {
    pub fn new() -> Self {
        let state = State { mail: Vec::new(), latest: None, idle: false, closed: false };
        Self { state: Mutex::new(state), changed: Condvar::new(), stop: Arc::default() }
    }

    /// No state is ever left half-changed, so a lock that a panic has poisoned is as good as another.
    fn lock(&self) -> MutexGuard<'_, State<M, R>> {
        self.state.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }

    /// The flag that asks an evaluation to stop.
    pub fn stop(&self) -> Arc<AtomicBool> {
        self.stop.clone()
    }

    /// Leaves mail; with `interrupt` a running evaluation is asked to stop for it.
    pub fn send(&self, message: M, interrupt: bool) {
        let mut state = self.lock();
        state.mail.push(message);
        state.idle = false;
        if interrupt {
            self.stop.store(true, Ordering::Release);
        }
        self.changed.notify_all();
    }

    /// Takes all mail, which may be none if `busy`; else waits for some. From here on an evaluation may run until the next
    /// interruption. `None`: the other side has gone.
    pub fn take(&self, busy: bool) -> Option<Vec<M>> {
        let mut state = self.lock();
        while state.mail.is_empty() && !busy && !state.closed {
            if !state.idle {
                state.idle = true;
                self.changed.notify_all();
            }
            state = self.changed.wait(state).unwrap_or_else(std::sync::PoisonError::into_inner);
        }
        if state.closed {
            return None;
        }
        self.stop.store(false, Ordering::Release);
        Some(std::mem::take(&mut state.mail))
    }

    /// Puts a result where the one before was.
    pub fn publish(&self, revision: u64, result: Arc<R>) {
        let old = self.lock().latest.replace((revision, result));
        self.changed.notify_all();
        // Freeing may take long, so it happens without the lock.
        drop(old);
    }

    /// The latest result.
    pub fn latest(&self) -> Option<Arc<R>> {
        self.lock().latest.as_ref().map(|(_, result)| result.clone())
    }

    /// Waits for the result of a revision or a later one; `None` if none is on its way.
    pub fn wait(&self, revision: u64) -> Option<Arc<R>> {
        let mut state = self.lock();
        loop {
            match &state.latest {
                Some((of, result)) if *of >= revision => return Some(result.clone()),
                _ if state.idle || state.closed => return None,
                _ => state = self.changed.wait(state).unwrap_or_else(std::sync::PoisonError::into_inner),
            }
        }
    }

    /// True if mail or an evaluation is under way.
    pub fn is_busy(&self) -> bool {
        let state = self.lock();
        !state.idle && !state.closed
    }

    /// Ends the talk from either side; a running evaluation is asked to stop.
    pub fn close(&self) {
        self.lock().closed = true;
        self.stop.store(true, Ordering::Release);
        self.changed.notify_all();
    }
}
