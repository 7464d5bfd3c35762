//! Editing while running: a document that is evaluated on a thread of its own, for editors and hosts.
//!
//! The side that edits owns the document and its history and never waits; operations travel to the thread, which owns a
//! [`Session`] over the same document. Every change makes a new revision, stops the evaluation under way and begins
//! anew; nodes that had finished are not run again as long as their inputs are the same.

mod desk;
mod draft;
mod snapshot;
mod worker;

/// What the desk is made of; its test puts others in their place.
mod sync {
    pub use std::sync::{Condvar, Mutex, MutexGuard};
}

pub use draft::Draft;
pub use snapshot::Snapshot;

use crate::diagnostic::Diagnostic;
use crate::document::History;
use crate::document::model::Document;
use crate::document::operations::Operation;
use crate::evaluate::report::Progress;
use crate::evaluate::session::{Options, Session};
use crate::registry::Registry;
use crate::value::Json;
use desk::Desk;
use std::sync::{Arc, PoisonError};
use std::thread::JoinHandle;
use worker::{Message, Told, Worker};

/// A document that can be edited while it is evaluated.
///
/// No method waits for an evaluation except [`Live::wait`] and dropping: a drop stops what runs and joins the thread.
/// What a method changes is in [`Live::document`] when it returns; what it leads to is in a later [`Snapshot`]. The
/// number that it gives is the new revision: the snapshot of that revision or of a later one contains the change.
/// Revisions that were overtaken by others have no snapshot.
///
/// ```
/// use std::sync::Arc;
/// use tenon_engine::*;
///
/// let mut registry = Registry::new();
/// let double = NodeType::new("double", 1)
///     .input(Port::item::<f64>("x").default(1.0))
///     .output(Port::item::<f64>("y"))
///     .run(|call| {
///         let x = call.number("x")?;
///         call.set("y", 2.0 * x);
///         Ok(())
///     });
/// registry.register(double).unwrap();
/// let mut document = Document::new();
/// document.insert("a", Node::new("double")).unwrap();
///
/// let mut live = Live::new(Arc::new(registry), document, Options::default(), || {}).unwrap();
/// live.set("a.x", 3.into()).unwrap();
/// let revision = live.set("a.x", 4.into()).unwrap();
/// let snapshot = live.wait(revision).unwrap();
/// assert_eq!(snapshot.value("a.y").unwrap().first::<f64>(), Some(&8.0));
///
/// // The old snapshot stays as it is while the next one is made.
/// let revision = live.undo().unwrap().unwrap();
/// assert_eq!(live.wait(revision).unwrap().value("a.y").unwrap().first::<f64>(), Some(&6.0));
/// assert_eq!(snapshot.value("a.y").unwrap().first::<f64>(), Some(&8.0));
/// ```
pub struct Live {
    draft: Draft,
    history: History,
    revision: u64,
    locked: bool,
    progress: Told,
    desk: Arc<Desk<Message, Snapshot>>,
    thread: Option<JoinHandle<()>>,
}

impl Live {
    /// Starts a thread that evaluates the document: its interface outputs and writers, until [`Live::set_goals`] names
    /// others. That is revision 1. Nodes of older versions are migrated, in [`Live::document`] too. O(nodes + wires).
    ///
    /// `wake` is called whenever there is something new to see (progress at most about 30 times a second, a snapshot, the
    /// end of an evaluation that was cancelled), from any thread, and must return soon: an editor asks for a repaint.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(
        registry: Arc<Registry>,
        document: Document,
        options: Options,
        wake: impl Fn() + Send + Sync + 'static,
    ) -> std::io::Result<Self> {
        let host = options.host.clone();
        let session = Session::new(registry.clone(), document, options);
        let revision = 1;
        let draft = Draft::new(registry, host, session.document().clone());
        let (desk, progress) = (Arc::new(Desk::new()), Told::default());
        let worker = Worker {
            session,
            desk: desk.clone(),
            progress: progress.clone(),
            wake: Box::new(wake),
            goals: Vec::new(),
            revision,
            locked: false,
            due: true,
            now: false,
            names: None,
            refused: Vec::new(),
        };
        let thread = std::thread::Builder::new().name("tenon-live".into()).spawn(move || worker.run())?;
        let history = History::default();
        Ok(Self { draft, history, revision, locked: false, progress, desk, thread: Some(thread) })
    }

    /// The document as it stands after the last change, whether evaluated or not.
    #[must_use]
    pub fn document(&self) -> &Document {
        self.draft.document()
    }

    /// The registry.
    #[must_use]
    pub fn registry(&self) -> &Arc<Registry> {
        self.draft.registry()
    }

    /// The revision of the document and the goals as they stand.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    fn send(&self, message: Message) {
        // Under the lock, changes are collected: what runs then was asked for by `evaluate_now`, of the state it had then.
        self.desk.send(message, !self.locked);
    }

    fn next_revision(&mut self) -> u64 {
        self.revision += 1;
        self.revision
    }

    /// Changes the document as one step that can be undone. A transaction is an [`Operation::All`]: applied as a whole and
    /// evaluated once. Gives the new revision.
    ///
    /// # Errors
    /// If the operation is refused; then nothing has changed.
    pub fn apply(&mut self, operation: Operation) -> Result<u64, Diagnostic> {
        let inverse = self.draft.apply(&operation)?;
        self.history.record(inverse);
        Ok(self.applied(operation))
    }

    /// Tells the thread of an operation that the document has seen.
    fn applied(&mut self, operation: Operation) -> u64 {
        let revision = self.next_revision();
        self.send(Message::Edit { revision, operation });
        revision
    }

    /// Sets an interface input or a parameter (`node.port`); `null` brings the default back.
    ///
    /// # Errors
    /// As [`Live::set_many`].
    pub fn set(&mut self, name: &str, value: Json) -> Result<u64, Diagnostic> {
        self.set_many([(name, value)])
    }

    /// Sets many interface inputs and parameters as one step, evaluated once.
    ///
    /// # Errors
    /// If there is no such name, a port has a wire, or a value is not accepted; then nothing has changed. Formulas are
    /// computed later: what is wrong with one stands in the snapshot's report.
    pub fn set_many<'a>(&mut self, values: impl IntoIterator<Item = (&'a str, Json)>) -> Result<u64, Diagnostic> {
        let all = self.draft.settings(values)?;
        if all.is_empty() { Ok(self.revision) } else { self.apply(Operation::All(all)) }
    }

    /// Makes the document what `document` is, as one step that can be undone: a file that was changed elsewhere. O(n).
    ///
    /// # Errors
    /// If it cannot become so; then nothing has changed.
    pub fn replace(&mut self, document: Document) -> Result<u64, Diagnostic> {
        let steps = self.draft.steps_to(document);
        if steps.is_empty() { Ok(self.revision) } else { self.apply(Operation::All(steps)) }
    }

    /// From here to [`Live::end_step`] everything is one step of the history; it is evaluated as it comes. So a slider
    /// that is dragged is undone at once.
    pub fn begin_step(&mut self) {
        self.history.begin();
    }

    /// Ends a step.
    pub fn end_step(&mut self) {
        self.history.commit();
    }

    /// Takes back the last step; `None` if there is none. Gives the new revision.
    ///
    /// # Errors
    /// As [`History::undo`].
    pub fn undo(&mut self) -> Result<Option<u64>, Diagnostic> {
        let (draft, mut done) = (&mut self.draft, None);
        self.history.undo_by(|step| {
            let inverse = draft.apply(step)?;
            done = Some(step.clone());
            Ok(inverse)
        })?;
        Ok(done.map(|step| self.applied(step)))
    }

    /// Does again what was last taken back; `None` if there is nothing. Gives the new revision.
    ///
    /// # Errors
    /// As [`History::redo`].
    pub fn redo(&mut self) -> Result<Option<u64>, Diagnostic> {
        let (draft, mut done) = (&mut self.draft, None);
        self.history.redo_by(|step| {
            let inverse = draft.apply(step)?;
            done = Some(step.clone());
            Ok(inverse)
        })?;
        Ok(done.map(|step| self.applied(step)))
    }

    /// Steps that can be taken back, and steps that can be done again.
    #[must_use]
    pub fn steps(&self) -> (usize, usize) {
        self.history.steps()
    }

    /// Forgets what could be taken back or done again.
    pub fn forget_steps(&mut self) {
        self.history = History::default();
    }

    /// What is to be evaluated (interface outputs or `node.port`); none means all interface outputs and writers, or every
    /// node if there are neither. Names that nobody knows are told in the report. Gives the new revision.
    pub fn set_goals(&mut self, goals: &[&str]) -> u64 {
        let revision = self.next_revision();
        let goals = goals.iter().map(|g| (*g).to_owned()).collect();
        self.send(Message::Goals { revision, goals });
        revision
    }

    /// Solver lock. While it is on, changes are collected and nothing runs but what [`Live::evaluate_now`] asks for; an
    /// evaluation under way is stopped. Taking it off evaluates what has been collected.
    pub fn lock(&mut self, on: bool) {
        self.desk.send(Message::Lock(on), on);
        self.locked = on;
    }

    /// True if the solver lock is on.
    #[must_use]
    pub fn is_locked(&self) -> bool {
        self.locked
    }

    /// Evaluates once, also under the lock and after [`Live::cancel`], and looks again at the files that nodes read.
    pub fn evaluate_now(&mut self) {
        self.send(Message::Now);
    }

    /// Stops the evaluation under way, if there is one. Nothing runs until the next change.
    pub fn cancel(&mut self) {
        self.desk.send(Message::Cancel, true);
    }

    /// The last evaluation that was finished; `None` before the first. Never waits.
    #[must_use]
    pub fn latest(&self) -> Option<Arc<Snapshot>> {
        self.desk.latest()
    }

    /// How far the evaluation under way is; `None` if none is, or it has told nothing yet. Never waits.
    #[must_use]
    pub fn progress(&self) -> Option<Progress> {
        self.progress.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    /// True if something runs or is about to. Never waits.
    #[must_use]
    pub fn is_busy(&self) -> bool {
        self.desk.is_busy()
    }

    /// Waits for the snapshot of a revision or of a later one; `None` if none is on its way: the solver is locked, the
    /// evaluation was cancelled, or the thread has come to an end.
    #[must_use]
    pub fn wait(&self, revision: u64) -> Option<Arc<Snapshot>> {
        self.desk.wait(revision)
    }
}

impl Drop for Live {
    fn drop(&mut self) {
        self.desk.close();
        if let Some(thread) = self.thread.take() {
            // It has panicked or not: it is over.
            let _ = thread.join();
        }
    }
}
