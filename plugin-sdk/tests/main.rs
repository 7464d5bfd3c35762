//! The contract: its headers, and what crosses.

mod headers;
mod layout;
