//! Things that take long to make from values, made on threads of their own: until the new one is there the old one is
//! shown, and the window never waits.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::thread::JoinHandle;

/// Makes something on a thread of its own. `wake` is called from there in the end, also if it has panicked: then nothing comes.
///
/// # Errors
/// If the system gives no thread.
pub(super) fn spawn<T: Send + 'static>(
    name: &str,
    wake: impl FnOnce() + Send + 'static,
    make: impl FnOnce() -> T + Send + 'static,
) -> std::io::Result<(JoinHandle<()>, Receiver<T>)> {
    let (tell, told) = channel();
    let work = move || {
        if let Ok(made) = catch_unwind(AssertUnwindSafe(make)) {
            // Nobody listens any more once the window is closed.
            let _ = tell.send(made);
        }
        // That nothing comes is told, too.
        drop(tell);
        wake();
    };
    Ok((std::thread::Builder::new().name(name.into()).spawn(work)?, told))
}

/// Something made from values, with the key that says which.
pub struct Beside<T> {
    made: Option<(u128, Arc<T>)>,
    /// What is being made, one at a time.
    coming: Option<(u128, Receiver<T>)>,
    wanted: Option<u128>,
    /// What could not be made.
    failed: Option<u128>,
}

impl<T> Default for Beside<T> {
    fn default() -> Self {
        Self { made: None, coming: None, wanted: None, failed: None }
    }
}

impl<T: Send + 'static> Beside<T> {
    /// Asks for what belongs to a key, to be called every frame: nothing happens if it is there or being made. `wake` is
    /// called from the other thread once it is made.
    pub fn want(&mut self, key: u128, wake: impl FnOnce() + Send + 'static, make: impl FnOnce() -> T + Send + 'static) {
        self.want_by(key, wake, || make);
    }

    /// The same; `maker` gives what makes it, and is called only if it is not there.
    pub fn want_by<M: FnOnce() -> T + Send + 'static>(
        &mut self,
        key: u128,
        wake: impl FnOnce() + Send + 'static,
        maker: impl FnOnce() -> M,
    ) {
        self.wanted = Some(key);
        self.poll();
        if self.coming.is_some()
            || self.failed == Some(key)
            || self.made.as_ref().is_some_and(|(made_for, _)| *made_for == key)
        {
            return;
        }
        if let Ok((_, told)) = spawn("beside", wake, maker()) {
            self.coming = Some((key, told));
        }
    }

    /// Nothing is wanted any more.
    pub fn forget(&mut self) {
        *self = Self::default();
    }

    /// Takes what is made by now, also where it is not asked for any more.
    pub fn poll(&mut self) {
        let Some((key, told)) = &self.coming else { return };
        match told.try_recv() {
            Ok(made) => self.made = Some((*key, Arc::new(made))),
            Err(TryRecvError::Empty) => return,
            // It has panicked: asked for again it would only do so again.
            Err(TryRecvError::Disconnected) => self.failed = Some(*key),
        }
        self.coming = None;
    }

    /// What was made last, of whichever key.
    #[must_use]
    pub fn last(&self) -> Option<&Arc<T>> {
        self.made.as_ref().map(|(_, made)| made)
    }

    /// What was made of the key that was asked for last; none until it is there.
    #[must_use]
    pub fn now(&self) -> Option<&Arc<T>> {
        self.made.as_ref().filter(|(key, _)| Some(*key) == self.wanted).map(|(_, made)| made)
    }

    /// Whether what was asked for last could not be made.
    #[must_use]
    pub fn failed(&self) -> bool {
        self.failed.is_some() && self.failed == self.wanted
    }

    /// Whether nothing is being made.
    #[must_use]
    pub fn settled(&self) -> bool {
        self.coming.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::channel;
    use std::time::Duration;

    #[test]
    fn the_old_is_shown_until_the_new_is_made_and_nothing_is_made_twice() {
        let mut b = Beside::default();
        let (woken, wakes) = channel();
        let wake = move || woken.send(()).unwrap_or(());
        let woken = || wakes.recv_timeout(Duration::from_secs(20)).unwrap();
        b.want(1, wake.clone(), || "one");
        assert!(b.now().is_none() && !b.settled());
        woken();
        b.want(1, wake.clone(), || panic!("it is there"));
        assert_eq!(b.now().map(|t| **t), Some("one"));
        let (go, gone) = channel();
        b.want(2, wake.clone(), move || gone.recv().unwrap());
        // While the second is made a third is wanted: the first is still shown.
        b.want(3, wake.clone(), || panic!("one at a time"));
        assert_eq!((b.last().map(|t| **t), b.now().is_none()), (Some("one"), true));
        go.send("two").unwrap();
        woken();
        b.want(3, wake, || "three");
        assert_eq!(b.last().map(|t| **t), Some("two"));
        woken();
        b.want(3, || (), || panic!("it is there"));
        assert_eq!(b.now().map(|t| **t), Some("three"));
    }

    #[test]
    fn what_cannot_be_made_is_told_and_not_tried_again() {
        let mut b = Beside::<()>::default();
        let (woken, wakes) = channel();
        b.want(1, move || woken.send(()).unwrap_or(()), || panic!("on purpose"));
        assert!(!b.failed());
        wakes.recv_timeout(Duration::from_secs(20)).unwrap();
        b.want_by(1, || (), || -> fn() { panic!("it would only fail again") });
        assert!(b.failed() && b.settled() && b.now().is_none());
        b.want(2, || (), || ());
        assert!(!b.failed());
    }
}
