//! Files of a graph: it and its layout beside it, and what in it names other files.

use std::path::{Path, PathBuf};
use tenon_engine::{Diagnostic, Document};
use tenon_nodes::host::graph::{self, GraphError};

pub use tenon_nodes::host::graph::{ENDING, find};

/// The layout's file beside a graph's.
#[must_use]
pub fn layout_path(graph: &Path) -> PathBuf {
    let name = graph.file_name().and_then(|n| n.to_str()).unwrap_or("graph");
    let stem = name.strip_suffix(ENDING).or_else(|| name.strip_suffix(".json")).unwrap_or(name);
    graph.with_file_name(format!("{stem}.layout.json"))
}

/// Reads a graph and, if there is one, its layout. What is wrong with the layout is only told.
///
/// # Errors
/// What keeps the graph from being read, with line and column.
pub fn load(path: &Path) -> Result<(Document, Vec<Diagnostic>), GraphError> {
    let (path, mut document) = graph::load(path)?;
    let mut told = Vec::new();
    let layout = layout_path(&path);
    match graph::read(&layout) {
        Ok(bytes) => told.extend(document.read_layout(&bytes).err()),
        Err(GraphError::Unreadable { error, .. }) if error.kind() == std::io::ErrorKind::NotFound => {}
        Err(e) => told.push(e.diagnostic()),
    }
    Ok((document, told))
}

/// How a graph names a file: relative to its folder where the file lies below it, else by its whole path.
#[must_use]
pub fn name_in(graph: Option<&Path>, file: &Path) -> String {
    let whole = |p: &Path| p.canonicalize().unwrap_or_else(|_| p.to_owned());
    let folder = graph.and_then(Path::parent).map(whole);
    let file = whole(file);
    let name = folder.and_then(|f| file.strip_prefix(&f).map(Path::to_owned).ok()).unwrap_or(file);
    name.to_string_lossy().replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_layout_stands_beside_its_graph() {
        let layout = |p: &str| layout_path(Path::new(p)).display().to_string();
        assert_eq!(layout("a/shell.tenon.json"), "a/shell.layout.json");
        assert_eq!(layout("shell.json"), "shell.layout.json");
        assert_eq!(layout("shell"), "shell.layout.json");
    }

    #[test]
    fn files_below_the_graph_are_named_from_there() {
        let graph = Path::new("/a/b/g.tenon.json");
        assert_eq!(name_in(Some(graph), Path::new("/a/b/in/m.obj")), "in/m.obj");
        assert_eq!(name_in(Some(graph), Path::new("/a/m.obj")), "/a/m.obj");
        assert_eq!(name_in(None, Path::new("/a/m.obj")), "/a/m.obj");
    }
}
