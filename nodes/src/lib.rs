//! nodes
pub mod io;
pub mod post;
