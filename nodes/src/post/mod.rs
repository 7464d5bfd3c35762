//! Posts: machine files, programs written from tool paths, programs read back.

mod error;
mod machine_file;
mod number;
mod parse;
mod read;
mod words;
mod write;

#[cfg(test)]
mod rejects;
pub use error::PostError;
pub use machine_file::{MachineFile, MachineFileError, machine_preset, machine_presets, read_machine};
pub use parse::{ProgramError, parse_program};
pub use words::Words;
pub use write::{PostParams, PostedProgram, post, post_parts};
