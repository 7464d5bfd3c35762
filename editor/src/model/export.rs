//! The files that the graph makes, written into a folder as `tenon run --out` writes them: beside the window, since it waits
//! for the disk.

use super::Model;
use super::beside::spawn;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError};
use std::thread::JoinHandle;
use tenon_engine::{Diagnostic, File};
use tenon_nodes::host::made;
use tenon_nodes::host::output::{Staged, WriteError, prepare_folder};

/// Files that are being written. What was begun comes to its end, also where the window is closed meanwhile.
pub(super) struct Exporting {
    folder: PathBuf,
    done: Receiver<Result<String, Diagnostic>>,
    thread: Option<JoinHandle<()>>,
}

impl Drop for Exporting {
    fn drop(&mut self) {
        if let Some(thread) = self.thread.take() {
            // A panic there is told by its silence.
            let _ = thread.join();
        }
    }
}

impl Model {
    /// Begins to write all files that the graph's writers made into a folder; [`Model::exported`] tells what came of it.
    ///
    /// # Errors
    /// If the evaluation is not done, or files are still being written.
    pub fn export(&mut self, folder: &Path) -> Result<(), Diagnostic> {
        if !self.settled() || self.results.cancelled {
            let message = "the graph is still being evaluated";
            return Err(Diagnostic::error("not-done", message).hint("wait until it is done, then export again"));
        }
        if let Some(other) = self.exporting() {
            let message = format!("files are still being written into {}", other.display());
            return Err(Diagnostic::error("not-done", message).hint("wait until it is done, then export again"));
        }
        let (files, to, wake) = (self.results.files.clone(), folder.to_owned(), self.wake.clone());
        let begun = spawn("export", move || wake(), move || write(files, &to));
        let (thread, done) = begun.map_err(|e| Diagnostic::error("unwritable", e.to_string()))?;
        self.exporting = Some(Exporting { folder: folder.to_owned(), done, thread: Some(thread) });
        Ok(())
    }

    /// Where files are being written; none if none are.
    #[must_use]
    pub fn exporting(&self) -> Option<&Path> {
        self.exporting.as_ref().map(|e| e.folder.as_path())
    }

    /// What came of the files that were being written, once: what was written, or why it was not.
    pub fn exported(&mut self) -> Option<Result<String, Diagnostic>> {
        let exporting = self.exporting.as_ref()?;
        let done = match exporting.done.try_recv() {
            Ok(done) => done,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => {
                let message = format!("the files were not written into {}", exporting.folder.display());
                Err(Diagnostic::error("unwritable", message))
            }
        };
        self.exporting = None;
        Some(done)
    }
}

/// Writes files whole or not at all, programs without a proof under another name. Says what was written.
fn write(files: Vec<(String, File)>, folder: &Path) -> Result<String, Diagnostic> {
    let wrong = |e: WriteError| Diagnostic::error(e.code(), e.to_string());
    prepare_folder(folder).map_err(wrong)?;
    let mut staged = Staged::default();
    let all = made::stage(&mut staged, files, Some(folder), false).map_err(wrong)?;
    made::commit(staged, &all, Some(folder)).map_err(wrong)?;
    let withheld = all.iter().filter(|m| m.withheld).count();
    let unproven = match withheld {
        0 => String::new(),
        n => format!(", {n} of them without a proof and therefore called .unproven"),
    };
    Ok(format!("{} files written into {}{unproven}", all.len(), folder.display()))
}
