//! The files that the graph makes, written into a folder as `tenon run --out` writes them.

use super::Model;
use std::path::Path;
use tenon_engine::Diagnostic;
use tenon_nodes::host::made;
use tenon_nodes::host::output::{Staged, WriteError, prepare_folder};

impl Model {
    /// Writes all files that the graph's writers made into a folder: whole or not at all, programs without a proof under
    /// another name. Says what was written.
    ///
    /// # Errors
    /// If the evaluation is not done, or a file cannot be written.
    pub fn export(&self, folder: &Path) -> Result<String, Diagnostic> {
        if !self.settled() || self.results.cancelled {
            let message = "the graph is still being evaluated";
            return Err(Diagnostic::error("not-done", message).hint("wait until it is done, then export again"));
        }
        let wrong = |e: WriteError| Diagnostic::error(e.code(), e.to_string());
        prepare_folder(folder).map_err(wrong)?;
        let mut staged = Staged::default();
        let all = made::stage(&mut staged, self.results.files.clone(), Some(folder), false).map_err(wrong)?;
        made::commit(staged, &all, Some(folder)).map_err(wrong)?;
        let withheld = all.iter().filter(|m| m.withheld).count();
        let unproven = match withheld {
            0 => String::new(),
            n => format!(", {n} of them without a proof and therefore called .unproven"),
        };
        Ok(format!("{} files written into {}{unproven}", all.len(), folder.display()))
    }
}
