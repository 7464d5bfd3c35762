//! Undo and redo: the operations that take back what was done, and those that do it again.

use super::Operation;
use crate::diagnostic::Diagnostic;
use crate::document::Document;
use crate::registry::Registry;
use std::collections::VecDeque;

/// What was done to one document, step by step.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// Each takes back one step; the last step last.
    undo: VecDeque<Operation>,
    redo: Vec<Operation>,
    /// Inverses of the open transaction in the order they were done, and how often it was opened.
    open: Vec<Operation>,
    depth: usize,
    /// Most steps kept; 0: all.
    limit: usize,
}

impl History {
    /// A history that forgets what is more than `limit` steps ago; 0 keeps everything.
    #[must_use]
    pub fn with_limit(limit: usize) -> Self {
        Self { limit, ..Self::default() }
    }

    /// Applies an operation as one step and says what is wrong with the graph now. O(nodes + wires).
    ///
    /// # Errors
    /// If the operation is refused; then nothing has changed.
    pub fn apply(
        &mut self,
        document: &mut Document,
        operation: &Operation,
        registry: &Registry,
    ) -> Result<Vec<Diagnostic>, Diagnostic> {
        self.record(operation.apply(document)?);
        Ok(document.validate(registry))
    }

    /// Notes what takes back a step that was done elsewhere, as by [`crate::Session::edit`]. What could be redone no
    /// longer can.
    pub fn record(&mut self, inverse: Operation) {
        self.redo.clear();
        if self.depth > 0 {
            self.open.push(inverse);
        } else {
            self.push(inverse);
        }
    }

    fn push(&mut self, inverse: Operation) {
        self.undo.push_back(inverse);
        if self.limit > 0 && self.undo.len() > self.limit {
            self.undo.pop_front();
        }
    }

    /// From here to [`History::commit`] everything is one step. May be nested; the outermost counts.
    pub fn begin(&mut self) {
        self.depth += 1;
    }

    /// Whether a transaction is open.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.depth > 0
    }

    /// Ends a transaction.
    pub fn commit(&mut self) {
        self.depth = self.depth.saturating_sub(1);
        if self.depth == 0 && !self.open.is_empty() {
            let step = self.take_open();
            self.push(step);
        }
    }

    /// Ends all open transactions and gives what takes back everything done in them.
    #[must_use]
    pub fn abandon(&mut self) -> Operation {
        self.depth = 0;
        self.take_open()
    }

    fn take_open(&mut self) -> Operation {
        Operation::All(self.open.drain(..).rev().collect())
    }

    /// Takes back the last step; false if there is none. An open transaction counts as a step and ends.
    ///
    /// # Errors
    /// If the document was changed behind the history's back and cannot go back; the step stays.
    pub fn undo(&mut self, document: &mut Document) -> Result<bool, Diagnostic> {
        self.undo_by(|operation| operation.apply(document))
    }

    /// Does again what was last taken back; false if there is nothing.
    ///
    /// # Errors
    /// As [`History::undo`].
    pub fn redo(&mut self, document: &mut Document) -> Result<bool, Diagnostic> {
        self.redo_by(|operation| operation.apply(document))
    }

    /// [`History::undo`] through whatever holds the document: `history.undo_by(|step| session.edit(step))`.
    ///
    /// # Errors
    /// Those of `apply`.
    pub fn undo_by(
        &mut self,
        apply: impl FnOnce(&Operation) -> Result<Operation, Diagnostic>,
    ) -> Result<bool, Diagnostic> {
        while self.depth > 0 {
            self.commit();
        }
        let Some(step) = self.undo.back() else { return Ok(false) };
        let inverse = apply(step)?;
        self.undo.pop_back();
        self.redo.push(inverse);
        Ok(true)
    }

    /// [`History::redo`] through whatever holds the document.
    ///
    /// # Errors
    /// Those of `apply`.
    pub fn redo_by(
        &mut self,
        apply: impl FnOnce(&Operation) -> Result<Operation, Diagnostic>,
    ) -> Result<bool, Diagnostic> {
        let Some(step) = self.redo.last() else { return Ok(false) };
        let inverse = apply(step)?;
        self.redo.pop();
        self.push(inverse);
        Ok(true)
    }

    /// Steps that can be taken back, and steps that can be done again.
    #[must_use]
    pub fn steps(&self) -> (usize, usize) {
        (self.undo.len() + usize::from(!self.open.is_empty()), self.redo.len())
    }
}
