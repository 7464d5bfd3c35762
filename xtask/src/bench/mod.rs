//! Benchmarks: one file per suite, and what is common to them.

pub mod abi;
pub mod cancel;
pub mod chain;
pub mod engine;
mod figure;
pub mod growth;
mod host;
mod memory;
mod peer;
mod shell;
mod surface;
