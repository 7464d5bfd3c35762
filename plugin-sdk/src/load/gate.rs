//! The gate between an evaluation and other threads that call back: whoever looks at what lies behind it is counted, and
//! whoever closes it waits until nobody looks. Both sides write one word and read the other's, so each needs a full fence
//! between the two (Dekker's pattern). Nearly every evaluation is never looked at from elsewhere, so its side goes without
//! as long as nobody came: the first visitor makes all threads fence (membarrier), and evaluations after that fence
//! themselves.

use super::atomic::{AtomicPtr, AtomicUsize, Ordering, fence};

/// How the two sides agree on an order.
pub(super) trait Order {
    /// Whether evaluations fence themselves from now on.
    fn fences(&self) -> bool;
    /// What the closing side does in place of a fence: nothing but to keep the compiler from swapping the two.
    fn light(&self);
    /// Fences every thread of the process, and has later evaluations fence themselves. `false`: it cannot.
    fn heavy(&self) -> bool;
}

/// A pointer that other threads may look at while it is there.
#[derive(Debug)]
pub(super) struct Gate<T> {
    /// NULL: closed. The lowest bit says that who closes it fences.
    inside: AtomicPtr<T>,
    /// Who looks, or is about to.
    visitors: AtomicUsize,
}

const FENCES: usize = 1;

impl<T> Gate<T> {
    pub fn new() -> Self {
        const { assert!(align_of::<T>() > FENCES, "the lowest bit is taken") };
        Self { inside: AtomicPtr::new(std::ptr::null_mut()), visitors: AtomicUsize::new(0) }
    }

    /// Opens it. The result goes to [`Gate::close`].
    #[inline]
    pub fn open(&self, inside: *mut T, order: &impl Order) -> bool {
        let fences = order.fences();
        self.inside.store(inside.map_addr(|a| a | usize::from(fences)), Ordering::Release);
        fences
    }

    /// What lies behind it, for the thread that opened it, and until it closes it.
    #[inline]
    pub fn inside(&self) -> *mut T {
        self.inside.load(Ordering::Relaxed).map_addr(|a| a & !FENCES)
    }

    /// Closes it: when this returns, nobody looks any more.
    #[inline]
    pub fn close(&self, fences: bool, order: &impl Order) {
        self.inside.store(std::ptr::null_mut(), Ordering::Release);
        if fences {
            fence(Ordering::SeqCst)
        } else {
            order.light()
        }
        if self.visitors.load(Ordering::Acquire) != 0 {
            self.wait();
        }
    }

    #[cold]
    fn wait(&self) {
        while self.visitors.load(Ordering::Acquire) != 0 {
            super::atomic::yield_now();
        }
    }

    /// Lets any thread look; `None`: it is closed, or cannot be looked through safely. What is given stays until `look`
    /// returns.
    #[cold]
    pub fn visit<R>(&self, order: &impl Order, look: impl FnOnce(*mut T) -> R) -> Option<R> {
        self.visitors.fetch_add(1, Ordering::AcqRel);
        fence(Ordering::SeqCst);
        let mut inside = self.inside.load(Ordering::Acquire);
        if !inside.is_null() && inside.addr() & FENCES == 0 {
            // Who closes it does not fence, so it is made to: either its NULL is seen now, or it will see us.
            inside = if order.heavy() { self.inside.load(Ordering::Acquire) } else { std::ptr::null_mut() };
        }
        let done = (!inside.is_null()).then(|| look(inside.map_addr(|a| a & !FENCES)));
        self.visitors.fetch_sub(1, Ordering::Release);
        done
    }
}
