//! Every order of the steps of an evaluation that ends and of another thread that calls back.

/// The gate with atomics of which every order is tried. A membarrier makes every thread's place of `light` a full fence, so
/// both sides are tried with one.
mod atomic {
    pub use loom::sync::atomic::{AtomicPtr, AtomicUsize, Ordering, fence};
    pub use loom::thread::yield_now;
}
#[allow(dead_code, reason = "who evaluates looks too, but not here")]
#[expect(clippy::duplicate_mod, reason = "the same text over loom's atomics")]
#[path = "gate.rs"]
mod gate;

use atomic::{Ordering, fence};
use gate::{Gate, Order};
use loom::cell::UnsafeCell;
use loom::sync::Arc;
use loom::sync::atomic::AtomicBool;
use loom::thread;

struct Modelled {
    fences: AtomicBool,
    /// There is a membarrier.
    works: bool,
}

impl Order for Modelled {
    fn fences(&self) -> bool {
        self.fences.load(Ordering::Relaxed)
    }
    fn light(&self) {
        fence(Ordering::SeqCst);
    }
    fn heavy(&self) -> bool {
        self.fences.store(true, Ordering::Relaxed);
        fence(Ordering::SeqCst);
        self.works
    }
}

/// What an evaluation lends to visitors. The model sees whoever reads it while its owner writes.
type Lent = UnsafeCell<u64>;

/// One thread opens and closes the gate `times` while others look once each; gives how many were let in, at most.
fn most_let_in(fences: bool, works: bool, visitors: usize, times: u64) -> usize {
    let most = std::sync::Arc::new(std::sync::atomic::AtomicUsize::new(0));
    let seen = most.clone();
    let mut builder = loom::model::Builder::new();
    // Three threads have more orders than anybody waits for; faults of such gates show with fewer switches than this.
    builder.preemption_bound = (visitors > 1).then_some(3);
    builder.check(move || {
        let gate = Arc::new((Gate::<Lent>::new(), Modelled { fences: AtomicBool::new(fences), works }));
        let look = |gate: Arc<(Gate<Lent>, Modelled)>| {
            // SAFETY: the gate holds it there; that it does is what is tried.
            move || gate.0.visit(&gate.1, |lent| unsafe { (*lent).with(|lent| *lent) })
        };
        let others: Vec<_> = (0..visitors).map(|_| thread::spawn(look(gate.clone()))).collect();
        for evaluation in 1..=times {
            let lent = Lent::new(evaluation);
            let fences = gate.0.open((&raw const lent).cast_mut(), &gate.1);
            gate.0.close(fences, &gate.1);
            // SAFETY: nobody looks any more; that is what is tried.
            lent.with_mut(|lent| unsafe { *lent = 0 });
        }
        let looked: Vec<u64> = others.into_iter().filter_map(|other| other.join().unwrap()).collect();
        assert!(!looked.contains(&0), "what was looked at was gone");
        seen.fetch_max(looked.len(), std::sync::atomic::Ordering::Relaxed);
    });
    most.load(std::sync::atomic::Ordering::Relaxed)
}

#[test]
fn nobody_looks_once_the_gate_is_closed() {
    for fences in [true, false] {
        assert_eq!(most_let_in(fences, true, 1, 2), 1, "fences: {fences}");
    }
}

#[test]
fn two_visitors_at_once_see_what_is_there() {
    assert_eq!(most_let_in(false, true, 2, 1), 2);
}

#[test]
fn who_cannot_make_others_fence_is_let_in_where_they_do_anyway_only() {
    // The first evaluation does not fence, so nobody may look; the visit makes the second one fence.
    assert_eq!(most_let_in(true, false, 1, 2), 1);
    assert_eq!(most_let_in(false, false, 1, 1), 0);
    assert_eq!(most_let_in(false, false, 1, 2), 0);
}
