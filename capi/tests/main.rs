//! The host contract: its header, and hosts in C and C++.

#[path = "../../plugin-sdk/tests/golden.rs"]
mod golden;
mod header;
mod hosts;
mod layout;
