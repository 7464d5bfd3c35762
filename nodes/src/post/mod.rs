//! Posts: machine files, programs written from tool paths, programs read back.

mod machine_file;
mod words;
pub use machine_file::{MachineFile, MachineFileError, machine_preset, machine_presets, read_machine};
pub use words::Words;
