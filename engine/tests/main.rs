//! Behaviour of the engine, by subject.

mod blocking;
mod cache;
mod cancel;
mod common;
mod lanes;
