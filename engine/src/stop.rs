//! Stopping in the middle of long work on values: copying, digesting, reshaping. Such work is done deep down, in places that
//! know no node and no evaluation, so it asks the thread that it runs on. If the evaluation was told to stop it unwinds
//! to the engine, which drops everything half-made: no value that is not whole ever comes to be.

use std::any::Any;
use std::cell::{Cell, RefCell};
use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// So many items are worked on before it is looked whether to stop: a good part of a millisecond of the dearest.
pub const STRIDE: usize = 1 << 12;

/// Lists longer than this are given back to the memory by a thread of their own, if their items have something to drop.
const LONG: usize = 1 << 14;
/// ... and those of more bytes whatever they hold: unmapping so many pages takes milliseconds.
const LARGE: usize = 16 << 20;

/// Carried by the unwinding.
struct Stopped;

thread_local! {
    /// The flag of the evaluation that this thread works for.
    static FLAG: RefCell<Option<Arc<AtomicBool>>> = const { RefCell::new(None) };
}

/// Sets the thread's flag back when it is dropped.
struct Restore(Option<Arc<AtomicBool>>);

impl Drop for Restore {
    fn drop(&mut self) {
        FLAG.set(self.0.take());
    }
}

/// Runs `work` such that [`check`] on this thread looks at `flag`; `None` if it stopped there. Other panics go through.
pub(crate) fn within<R>(flag: &Arc<AtomicBool>, work: impl FnOnce() -> R) -> Option<R> {
    let _restore = Restore(FLAG.replace(Some(flag.clone())));
    caught(work)
}

/// Whether a caught panic is none but [`check`]'s way out.
pub(crate) fn is_stop(payload: &(dyn Any + Send)) -> bool {
    payload.is::<Stopped>()
}

/// Whether the evaluation that this thread works for was told to stop; false outside of evaluations.
#[must_use]
pub fn is_asked() -> bool {
    FLAG.with_borrow(|flag| flag.as_ref().is_some_and(|f| f.load(Ordering::Relaxed)))
}

/// Leaves the node that is being run if the evaluation was told to stop, by unwinding, and does nothing otherwise, as
/// outside of evaluations. For loops over many items, every [`STRIDE`] of them; on other threads than the one that the
/// node was called on it does nothing.
pub fn check() {
    if is_asked() {
        resume_unwind(Box::new(Stopped));
    }
}

/// Runs `work` such that [`check`] goes no further than here; `None` if it stopped there. For what foreign code calls back,
/// through whose stack nothing may unwind; call [`check`] again once that has returned.
pub fn caught<R>(work: impl FnOnce() -> R) -> Option<R> {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(done) => Some(done),
        Err(payload) if is_stop(&*payload) => None,
        Err(payload) => resume_unwind(payload),
    }
}

/// Calls [`check`] once in so many steps.
pub(crate) struct Ticker(Cell<usize>);

impl Ticker {
    pub fn new() -> Self {
        Self(Cell::new(0))
    }

    pub fn tick(&self) {
        let n = self.0.get() + 1;
        self.0.set(n);
        if n.is_multiple_of(STRIDE) {
            check();
        }
    }
}

/// Iterators that can be left in the middle.
pub trait Stoppable: Iterator + Sized {
    /// The same items; every [`STRIDE`] of them it calls [`check`].
    fn stoppable(self) -> impl Iterator<Item = Self::Item> {
        let ticker = Ticker::new();
        self.inspect(move |_| ticker.tick())
    }
}

impl<I: Iterator> Stoppable for I {}

/// Drops a list, a long or large one on another thread.
pub(crate) fn let_go<T: Send + 'static>(list: Vec<T>) {
    drop_beside::<T>(list.len(), list);
}

/// Drops what holds so many items.
pub(crate) fn drop_beside<T>(count: usize, items: impl Send + 'static) {
    if (count > LONG && std::mem::needs_drop::<T>()) || count * size_of::<T>() > LARGE {
        // Where there is no thread to be had, it is dropped with the closure.
        let _ = std::thread::Builder::new().name("tenon drop".into()).spawn(move || drop(items));
    }
}

/// A list under construction. If it never becomes anything and is long, it is dropped on another thread: millions of small
/// pieces take long to give back, and nobody need wait for that.
pub struct Pending<T: Send + 'static>(Vec<T>);

impl<T: Send + 'static> Pending<T> {
    /// What there is of it.
    #[must_use]
    pub fn new(list: Vec<T>) -> Self {
        Self(list)
    }

    /// The list, done.
    #[must_use]
    pub fn take(mut self) -> Vec<T> {
        std::mem::take(&mut self.0)
    }

    /// Its items one after another; what is left of them when the iterator goes is dropped in the same way.
    #[must_use]
    pub fn each(self) -> Each<T> {
        Each(self.take().into_iter())
    }
}

/// The items of a [`Pending`] list.
pub struct Each<T: Send + 'static>(std::vec::IntoIter<T>);

impl<T: Send + 'static> Iterator for Each<T> {
    type Item = T;

    fn next(&mut self) -> Option<T> {
        self.0.next()
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        self.0.size_hint()
    }
}

impl<T: Send + 'static> Drop for Each<T> {
    fn drop(&mut self) {
        let rest = std::mem::take(&mut self.0);
        drop_beside::<T>(rest.len(), rest);
    }
}

impl<T: Send + 'static> std::ops::Deref for Pending<T> {
    type Target = Vec<T>;

    fn deref(&self) -> &Vec<T> {
        &self.0
    }
}

impl<T: Send + 'static> std::ops::DerefMut for Pending<T> {
    fn deref_mut(&mut self) -> &mut Vec<T> {
        &mut self.0
    }
}

impl<T: Send + 'static> Drop for Pending<T> {
    fn drop(&mut self) {
        let_go(std::mem::take(&mut self.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_left_in_the_middle_and_only_where_it_was_asked_to() {
        let flag = Arc::new(AtomicBool::new(false));
        let count = |to: usize| (0..to).stoppable().count();
        assert_eq!(within(&flag, || count(10 * STRIDE)), Some(10 * STRIDE));
        flag.store(true, Ordering::Relaxed);
        assert_eq!(within(&flag, || count(STRIDE)), None);
        // Too short to be looked at, and outside nobody has asked.
        assert_eq!(within(&flag, || count(STRIDE - 1)), Some(STRIDE - 1));
        assert_eq!((count(10 * STRIDE), is_asked()), (10 * STRIDE, false));
    }

    #[test]
    fn an_inner_evaluation_leaves_the_outer_one_its_flag() {
        let (outer, inner) = (Arc::new(AtomicBool::new(true)), Arc::new(AtomicBool::new(false)));
        let seen = within(&outer, || {
            let within_inner = within(&inner, is_asked);
            (within_inner, is_asked())
        });
        assert_eq!(seen, Some((Some(false), true)));
        let other = catch_unwind(AssertUnwindSafe(|| within(&inner, || resume_unwind(Box::new("another")))));
        assert!(other.is_err_and(|payload| !is_stop(&*payload)) && !is_asked());
    }
}
