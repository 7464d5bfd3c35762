//! The thread that evaluates: reads mail, brings its session up to date, leaves a snapshot.

use super::desk::Desk;
use super::snapshot::{Names, Snapshot};
use crate::diagnostic::Diagnostic;
use crate::document::operations::Operation;
use crate::evaluate::report::{Control, Progress};
use crate::evaluate::session::Session;
use std::sync::{Arc, Mutex, PoisonError};

/// What the other side wants.
pub(super) enum Message {
    /// The document was changed.
    Edit { revision: u64, operation: Operation },
    /// Other values are asked for.
    Goals { revision: u64, goals: Vec<String> },
    /// Nothing runs until it is taken back.
    Lock(bool),
    /// Evaluate once, locked or not, and look at files again.
    Now,
    /// Stop and stay stopped until the next change.
    Cancel,
}

/// How far the evaluation under way is.
pub(super) type Told = Arc<Mutex<Option<Progress>>>;

pub(super) struct Worker {
    pub session: Session,
    pub desk: Arc<Desk<Message, Snapshot>>,
    pub progress: Told,
    /// Called whenever there is something new to see.
    pub wake: Box<dyn Fn() + Send + Sync>,
    pub goals: Vec<String>,
    pub revision: u64,
    pub locked: bool,
    /// Something has changed since the last evaluation that was finished.
    pub due: bool,
    /// It is to be evaluated although the lock is on.
    pub now: bool,
    /// Until the plan is made anew.
    pub names: Option<(u64, Arc<Names>)>,
    /// Edits that the session refused.
    pub refused: Vec<Diagnostic>,
}

/// Whoever waits must not wait for a thread that has gone.
struct CloseAtEnd(Arc<Desk<Message, Snapshot>>);

impl Drop for CloseAtEnd {
    fn drop(&mut self) {
        self.0.close();
    }
}

impl Worker {
    pub fn run(mut self) {
        let _end = CloseAtEnd(self.desk.clone());
        while let Some(mail) = self.desk.take(self.is_ready()) {
            mail.into_iter().for_each(|message| self.read(message));
            if self.is_ready() {
                self.evaluate();
            }
        }
    }

    fn is_ready(&self) -> bool {
        self.due && (!self.locked || self.now)
    }

    fn read(&mut self, message: Message) {
        match message {
            Message::Edit { revision, operation } => {
                (self.revision, self.due) = (revision, true);
                // The other side has applied it to the same document, so that it cannot be refused here; if it is, then not
                // in silence.
                self.refused.extend(self.session.edit(&operation).err());
            }
            Message::Goals { revision, goals } => (self.revision, self.due, self.goals) = (revision, true, goals),
            Message::Lock(on) => self.locked = on,
            Message::Now => {
                self.session.refresh_links();
                (self.due, self.now) = (true, true);
            }
            Message::Cancel => (self.due, self.now) = (false, false),
        }
    }

    fn evaluate(&mut self) {
        let tell = |p: Option<&Progress>| {
            *self.progress.lock().unwrap_or_else(PoisonError::into_inner) = p.cloned();
            (self.wake)();
        };
        let goals: Vec<&str> = self.goals.iter().map(String::as_str).collect();
        let on_progress = |p: &Progress| tell(Some(p));
        let control = Control { cancel: self.desk.stop(), on_progress: Some(&on_progress) };
        let mut report = self.session.evaluate(&goals, &control);
        if report.cancelled {
            tell(None);
            return;
        }
        (self.due, self.now) = (false, false);
        report.diagnostics.append(&mut self.refused);
        let stamp = self.session.stamp;
        let names = match &self.names {
            Some((of, names)) if *of == stamp => names.clone(),
            _ => Arc::new(self.session.names()),
        };
        self.names = Some((stamp, names.clone()));
        let snapshot = self.session.snapshot(names, self.revision, report);
        // The log is read by nobody here and would grow for ever.
        self.session.take_events();
        self.desk.publish(self.revision, Arc::new(snapshot));
        tell(None);
    }
}
