//! Plugins in processes of their own, over shared memory: whatever such a plugin does to itself, the host goes on. It
//! contains crashes; it is no sandbox, since the plugin still does what the user may do.
//!
//! One process evaluates one node at a time, so there are as many as evaluations at once; those that are idle are used
//! again. What is small crosses as bytes through a socket, arrays lie in the shared memory. Linux only: elsewhere
//! [`start`] says so.

#[cfg(target_os = "linux")]
mod host;
#[cfg(target_os = "linux")]
mod memory;
#[cfg(target_os = "linux")]
mod serve;
#[cfg(target_os = "linux")]
mod wire;

use crate::load::{LoadError, Plugin};
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Duration;

#[cfg(target_os = "linux")]
pub(crate) use host::Processes;

/// What a plugin's process may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// The longest time without an answer or progress that rises.
    pub time: Duration,
    /// The most memory that the plugin may take of its own, and again as much in buffers of the host, bytes.
    pub memory: u64,
}

impl Default for Limits {
    fn default() -> Self {
        Self { time: Duration::from_secs(60), memory: 4 << 30 }
    }
}

/// The program that becomes a plugin's process.
#[derive(Clone, Debug)]
pub struct Program {
    /// The program.
    pub path: PathBuf,
    /// What it is called with; the library and its memory in bytes follow. It is to call [`serve`].
    pub arguments: Vec<OsString>,
}

/// Starts a plugin in a process of its own and asks it what it is. Its nodes then evaluate there.
///
/// # Errors
/// If the process cannot be started or the plugin is refused.
#[cfg(target_os = "linux")]
pub fn start(library: &Path, program: &Program, limits: Limits) -> Result<Plugin, LoadError> {
    host::start(library, program, limits)
}

/// Starts a plugin in a process of its own, where that can be done: here it cannot.
///
/// # Errors
/// Always.
#[cfg(not(target_os = "linux"))]
pub fn start(library: &Path, _: &Program, _: Limits) -> Result<Plugin, LoadError> {
    let why = crate::load::LoadFault::Process("plugins run in processes of their own on Linux only".into());
    Err(LoadError { path: library.to_owned(), why })
}

/// The life of a plugin's process: serves the host that started it, and ends with it.
///
/// # Errors
/// If no host started it.
#[cfg(target_os = "linux")]
pub fn serve(library: &Path, memory: u64) -> Result<std::convert::Infallible, String> {
    serve::serve(library, memory)
}

/// The life of a plugin's process, where there are such: here there are none.
///
/// # Errors
/// Always.
#[cfg(not(target_os = "linux"))]
pub fn serve(_: &Path, _: u64) -> Result<std::convert::Infallible, String> {
    Err("plugins run in processes of their own on Linux only".into())
}

/// No processes.
#[cfg(not(target_os = "linux"))]
#[derive(Debug)]
pub(crate) enum Processes {}

#[cfg(not(target_os = "linux"))]
impl Processes {
    pub(crate) fn evaluate(
        &self,
        _: u32,
        _: &[Vec<crate::value::Branch<'_>>],
        _: crate::load::Watch<'_>,
        _: &mut dyn crate::load::Sink,
    ) -> Result<(), crate::load::EvaluateError> {
        match *self {}
    }

    pub(crate) fn migrate(&self, _: u32, _: u32, _: &str) -> Result<String, String> {
        match *self {}
    }
}
