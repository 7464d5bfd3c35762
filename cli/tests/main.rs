//! Behaviour of the program `tenon` as a user meets it: the real binary, real files, exit codes, words.

mod apart;
mod cache;
mod call;
mod check;
mod clusters;
mod explain;
mod fmt;
mod get;
mod graphs;
mod inspect;
mod interrupt;
mod kill;
mod newcomer;
mod nodes;
mod plugin;
mod report;
mod schema;
mod set;
mod sweep;
mod tenon;
mod test;
mod watch;
mod write;
