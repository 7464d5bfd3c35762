//! The C types of the contract, by the names that they have in the C headers, which are generated from here.

#![allow(non_camel_case_types)]

pub mod layout;
pub mod plugin;
pub mod value;
