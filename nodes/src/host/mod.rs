//! What hosts of the engine do with files alike: finding and reading graphs, giving nodes the files that they name, and
//! writing what a graph has made, whole or not at all, alone or as a row of a sweep.

pub mod graph;
pub mod made;
pub mod output;
pub mod sweep;
