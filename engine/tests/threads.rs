//! The desk between the editing and the evaluating thread, in every order that two threads' steps can have (loom).

/// What `desk.rs` finds as `super::sync`: loom's, which tries the orders.
mod sync {
    pub use loom::sync::{Condvar, Mutex, MutexGuard};
}

#[path = "../src/live/desk.rs"]
#[allow(dead_code)]
mod desk;

use desk::Desk;
use std::sync::Arc;
use std::sync::atomic::Ordering;

/// An evaluation: stops if it is asked to while it runs, else publishes. Gives whether there is still work.
fn evaluate(desk: &Desk<u64, u64>, revision: u64) -> bool {
    loom::thread::yield_now();
    if desk.stop().load(Ordering::Acquire) {
        return true;
    }
    desk.publish(revision, Arc::new(revision));
    false
}

fn work(desk: &Desk<u64, u64>) {
    let (mut revision, mut due) = (0, false);
    while let Some(mail) = desk.take(due) {
        if let Some(last) = mail.last() {
            (revision, due) = (*last, true);
        }
        if due {
            due = evaluate(desk, revision);
        }
    }
}

#[test]
fn the_last_edit_is_always_evaluated_and_waiting_always_ends() {
    loom::model(|| {
        let desk = Arc::new(Desk::new());
        let worker = loom::thread::spawn({
            let desk = desk.clone();
            move || work(&desk)
        });
        desk.send(1, true);
        desk.send(2, true);
        // Each edit may cost one interrupted evaluation, but none is lost.
        assert_eq!(desk.wait(2).as_deref(), Some(&2));
        assert_eq!(desk.latest().as_deref(), Some(&2));
        desk.close();
        worker.join().unwrap();
    });
}

#[test]
fn waiting_for_what_nobody_asked_for_ends_too() {
    loom::model(|| {
        let desk = Arc::new(Desk::new());
        let worker = loom::thread::spawn({
            let desk = desk.clone();
            move || work(&desk)
        });
        desk.send(1, false);
        assert_eq!(desk.wait(3), None);
        desk.close();
        worker.join().unwrap();
    });
}

#[test]
fn a_thread_that_goes_wakes_whoever_waits() {
    loom::model(|| {
        let desk = Arc::new(Desk::<u64, u64>::new());
        let worker = loom::thread::spawn({
            let desk = desk.clone();
            move || {
                let _ = desk.take(false);
                desk.close();
            }
        });
        desk.send(1, true);
        assert_eq!(desk.wait(1), None);
        worker.join().unwrap();
    });
}
