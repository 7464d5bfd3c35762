//! `libtenon`: the engine in other programs, through C. `include/tenon.h` is generated from here and is the contract.
//!
//! Nothing panics or frees across the boundary. Handles are keys into a table, not addresses, so a handle that was freed
//! or is of another kind is an error and not a crash.

#![allow(non_camel_case_types)]

mod engine;
mod error;
mod give;
mod graph;
mod handle;
mod interface;
mod job;
mod preview;
mod read;
mod result;
mod sweep;
mod text;
mod turns;

pub use engine::*;
pub use error::*;
pub use give::*;
pub use graph::*;
pub use interface::*;
pub use job::*;
pub use preview::*;
pub use result::*;
pub use sweep::*;
pub use text::*;

/// Version of this interface: major in the upper 16 bits, minor in the lower. Another major does not fit; a greater
/// minor only adds. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_version() -> u32 {
    (1 << 16) | 1
}
