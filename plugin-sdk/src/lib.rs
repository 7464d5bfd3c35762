//! The contract between Tenon and its plugins.
//!
//! The C types in [`abi`] are the contract; `include/*.h` is generated from them. [`value`] is the same without pointers,
//! for safe code on either side. [`author`] makes plugins in Rust, [`load`] (feature `host`) loads plugins of any
//! language, [`apart`] gives them processes of their own, [`check`] tests them.

pub mod abi;
#[cfg(feature = "host")]
pub mod apart;
pub mod author;
#[cfg_attr(not(feature = "host"), allow(dead_code, reason = "it is the host that makes buffers"))]
mod buffers;
#[cfg(feature = "host")]
pub mod check;
#[cfg_attr(not(feature = "host"), allow(dead_code, reason = "it is the host that says whether buffers go over"))]
mod from_c;
#[cfg(feature = "host")]
pub mod load;
mod sound;
mod to_c;
pub mod value;

pub use from_c::read_tree;
pub use sound::BadValue;
pub use to_c::CTree;
