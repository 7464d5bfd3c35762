//! Where a `tenon_call` leads: to the evaluation under way, for the thread that it runs on; to little of it for others;
//! to a closed gate afterwards.

use super::call::{Running, callbacks};
use super::fences::Process;
use super::gate::Gate;
use crate::abi::plugin::tenon_call;
use std::cell::Cell;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Slots are used again and never freed, so that a plugin that calls back after its evaluation meets a closed gate and not
/// freed memory.
pub(super) struct Slot {
    pub call: tenon_call,
    /// The thread that evaluates, see [`here`]; 0: none does.
    owner: AtomicUsize,
    gate: Gate<Running<'static>>,
}

// SAFETY: `call` never changes; the rest is atomic, and what the gate leads to is guarded by `owned` and `visit`.
unsafe impl Sync for Slot {}
// SAFETY: see above.
unsafe impl Send for Slot {}

static LATE: AtomicU64 = AtomicU64::new(0);

/// Number of calls that plugins made after their evaluation had ended; each was refused.
#[must_use]
pub fn late_calls() -> u64 {
    LATE.load(Ordering::Relaxed)
}

/// Free slots of threads that ended.
static FREE: Mutex<Vec<&'static Slot>> = Mutex::new(Vec::new());

/// The free slot of a thread.
pub(super) struct Home(Cell<Option<&'static Slot>>);

/// Gives a thread's slot to others when it ends.
struct Leave;

impl Drop for Leave {
    fn drop(&mut self) {
        free(HOME.with(|home| home.0.take()));
    }
}

thread_local! {
    // Without a destructor, so that finding it is an addition.
    static HOME: Home = const { Home(Cell::new(None)) };
    static LEAVE: Leave = const { Leave };
}

#[cold]
fn free(slot: Option<&'static Slot>) {
    FREE.lock().unwrap_or_else(PoisonError::into_inner).extend(slot);
}

/// A number that no other thread has while this one lives.
#[inline]
fn here() -> usize {
    HOME.with(|home| std::ptr::from_ref(home).addr())
}

impl Slot {
    /// Runs `f` with a slot that leads to `running` meanwhile.
    #[inline]
    pub fn with<R>(running: &Running<'_>, f: impl FnOnce(&'static tenon_call) -> R) -> R {
        // SAFETY: it has no destructor, so it is there as long as this thread.
        let home = unsafe { &*HOME.with(std::ptr::from_ref) };
        let slot = home.0.take().unwrap_or_else(Self::fetch);
        let inside: *mut Running<'static> = std::ptr::from_ref(running).cast_mut().cast();
        let fences = slot.gate.open(inside, &Process);
        slot.owner.store(std::ptr::from_ref(home).addr(), Ordering::Relaxed);
        let done = f(&slot.call);
        slot.owner.store(0, Ordering::Relaxed);
        slot.gate.close(fences, &Process);
        if let Some(other) = home.0.replace(Some(slot)) {
            free(Some(other));
        }
        done
    }

    #[cold]
    fn fetch() -> &'static Self {
        // When the thread is ending already, its slot stays with it.
        let _ = LEAVE.try_with(|_| ());
        Process.prepare();
        let free = FREE.lock().unwrap_or_else(PoisonError::into_inner).pop();
        free.unwrap_or_else(|| {
            let (call, owner, gate) = (callbacks(), AtomicUsize::new(0), Gate::new());
            let slot = Box::into_raw(Box::new(Self { call, owner, gate }));
            // SAFETY: it is never freed, and nobody else has it yet.
            unsafe {
                (*slot).call.host = slot.cast();
                &*slot
            }
        })
    }

    /// The slot of a call; `None` for NULL.
    ///
    /// # Safety
    /// `call` is NULL or one that the host gave.
    #[inline]
    pub unsafe fn of<'a>(call: *const tenon_call) -> Option<&'a Self> {
        if call.is_null() || !call.is_aligned() {
            return None;
        }
        // SAFETY: a call that the host gave; its slot is never freed.
        unsafe { (*call).host.cast::<Self>().as_ref() }
    }

    /// The evaluation, if it is this thread's.
    #[inline]
    pub fn owned(&self) -> Option<&Running<'static>> {
        // SAFETY: an evaluation of this very thread is under way, so it is there until we return to it.
        (self.owner.load(Ordering::Relaxed) == here()).then(|| unsafe { &*self.gate.inside() })
    }

    /// What any thread may do while an evaluation is under way; afterwards it is late and gets `None`.
    #[cold]
    pub fn visit<R>(&self, look: impl FnOnce(&Running<'static>) -> R) -> Option<R> {
        // SAFETY: what is behind the gate stays until we have looked, and shared references are all that others have.
        let done = self.gate.visit(&Process, |running| look(unsafe { &*running }));
        if done.is_none() {
            LATE.fetch_add(1, Ordering::Relaxed);
        }
        done
    }
}
