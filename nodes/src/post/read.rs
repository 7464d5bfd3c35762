//! A posted program read back for a proof.

use super::{PostedProgram, parse_program};
use tenon_geometry::machine::Machine;
use tenon_geometry::proof::Program;

impl PostedProgram {
    /// Reads the text back as the control would. A text that is no program has no motions and says why, which a proof
    /// turns into its verdict. O(bytes).
    #[must_use]
    pub fn read(&self, machine: &Machine) -> Program {
        let (motions, refused) = match parse_program(self.text.as_bytes(), machine) {
            Ok(motions) => (motions, None),
            Err(e) => (Vec::new(), Some((e.line, e.problem))),
        };
        Program { name: self.file_name(), board: self.board, motions, refused }
    }
}
