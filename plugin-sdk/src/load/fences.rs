//! How evaluations and visitors from other threads agree on an order in this process (see [`super::gate`]): by Linux's
//! membarrier, or, where there is none, by fences on both sides from the start.

use super::gate::Order;
use std::sync::Once;
use std::sync::atomic::{AtomicBool, Ordering, compiler_fence};

/// Whether evaluations fence themselves: there is no other way, or a visitor came once.
static FENCES: AtomicBool = AtomicBool::new(true);

/// The order of this process.
#[derive(Clone, Copy, Debug)]
pub(super) struct Process;

impl Process {
    /// Finds out what the system can do. To be called before the first gate is opened; fences are used if not.
    pub fn prepare(self) {
        static ONCE: Once = Once::new();
        ONCE.call_once(|| FENCES.store(!(membarrier::register() && membarrier::all()), Ordering::Relaxed));
    }
}

impl Order for Process {
    #[inline]
    fn fences(&self) -> bool {
        FENCES.load(Ordering::Relaxed)
    }

    #[inline]
    fn light(&self) {
        compiler_fence(Ordering::SeqCst);
    }

    fn heavy(&self) -> bool {
        FENCES.store(true, Ordering::Relaxed);
        membarrier::all()
    }
}

#[cfg(all(target_os = "linux", not(miri)))]
mod membarrier {
    /// From `linux/membarrier.h`, which libc does not name.
    const PRIVATE_EXPEDITED: libc::c_int = 1 << 3;
    const REGISTER_PRIVATE_EXPEDITED: libc::c_int = 1 << 4;

    fn call(command: libc::c_int) -> bool {
        // SAFETY: it takes numbers only and changes no memory.
        unsafe { libc::syscall(libc::SYS_membarrier, command, 0, 0) == 0 }
    }

    /// Asks for it; `false`: this system has none.
    pub fn register() -> bool {
        call(REGISTER_PRIVATE_EXPEDITED)
    }

    /// Fences every thread of this process that runs; others were fenced when they were taken off.
    pub fn all() -> bool {
        call(PRIVATE_EXPEDITED)
    }
}

#[cfg(not(all(target_os = "linux", not(miri))))]
mod membarrier {
    pub fn register() -> bool {
        false
    }

    pub fn all() -> bool {
        false
    }
}
