//! Evaluation: demand-driven from the observed outputs, in order of height, without recursion.

pub(crate) mod cache;
pub(crate) mod commit;
pub(crate) mod gather;
pub(crate) mod given;
mod inspect;
mod jobs;
pub(crate) mod kept;
pub(crate) mod matching;
pub(crate) mod meter;
pub(crate) mod output;
mod pieces;
pub(crate) mod queue;
mod quick;
pub(crate) mod report;
pub(crate) mod run;
pub(crate) mod session;
pub(crate) mod simple;
pub(crate) mod state;
pub(crate) mod store;
