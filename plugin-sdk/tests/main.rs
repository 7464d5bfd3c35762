//! The contract: its headers, and what crosses.

mod golden;
mod headers;
mod layout;
