//! The host contract: its header, and hosts in C and C++.

mod header;
mod hosts;
mod layout;
