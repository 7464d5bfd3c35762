//! Behaviour of the engine, by subject.

mod bad_input;
mod blocking;
mod cache;
mod cancel;
mod cluster_operations;
mod clusters;
mod common;
mod event_log;
mod expressions;
mod file;
mod given;
mod lanes;
mod laws;
mod links;
mod live;
mod migrations;
mod model;
mod operations;
mod ports;
mod scale;
mod store;
mod threads;
