//! Every built-in node: thin typed faces on `tenon_geometry`, the value types they exchange, files and posts.

mod board;
mod codes;
mod curve;
pub mod disk;
pub mod exchange;
mod files;
pub mod host;
pub mod io;
mod joint;
mod machine;
mod mesh;
mod motion;
mod number;
mod panel;
mod params;
pub mod plugin;
pub mod post;
mod proof;
mod text;
mod tree;
pub mod value;

pub use codes::CODES;

use tenon_engine::{NodeType, Registry};

/// A registry with every built-in node and value type.
#[must_use]
pub fn registry() -> Registry {
    let mut registry = Registry::new();
    value::register(&mut registry);
    let folders: [fn() -> Vec<NodeType>; 13] = [
        params::nodes,
        number::nodes,
        text::nodes,
        tree::nodes,
        curve::nodes,
        mesh::nodes,
        panel::nodes,
        joint::nodes,
        board::nodes,
        machine::nodes,
        motion::nodes,
        proof::nodes,
        files::nodes,
    ];
    for node in folders.into_iter().flat_map(|nodes| nodes()) {
        let name = node.type_name().to_string();
        let registered = registry.register(node);
        debug_assert!(registered.is_ok(), "node type {name}: {registered:?}");
    }
    registry
}
