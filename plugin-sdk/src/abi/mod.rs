//! The C types of the contract, by the names that they have in the C headers, which are generated from here.

#![allow(non_camel_case_types)]

pub mod layout;
pub mod plugin;
pub mod value;

// Not where the headers are made from: in C++ it would be no constant.
impl value::tenon_edge {
    /// No edge.
    pub const NONE: Self = Self { panel: value::TENON_NONE, edge: value::TENON_NONE };
}
