//! nodes
pub mod post;
