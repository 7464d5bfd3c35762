//! Files: the graph, its layout beside it, and the files that its nodes name. Written whole or not at all.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_engine::{DEFAULT_SIZE_LIMIT, Diagnostic, Document, Host};

/// How graph files end.
pub const ENDING: &str = ".tenon.json";

/// The largest file that a node may read, bytes.
const LARGEST_INPUT: u64 = 4 << 30;

/// Reads the files that nodes name, relative to the graph's folder.
pub struct Folder(pub PathBuf);

impl Host for Folder {
    fn read(&self, path: &str) -> io::Result<Arc<[u8]>> {
        read(&self.0.join(path), LARGEST_INPUT).map(Into::into)
    }
}

fn read(path: &Path, limit: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(limit + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > limit {
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, format!("larger than {} MiB", limit >> 20)));
    }
    Ok(bytes)
}

/// The graph file that a path means: itself, or the only graph of a folder.
///
/// # Errors
/// If there is none, or more than one.
pub fn find(path: &Path) -> Result<PathBuf, Diagnostic> {
    let wrong = |why: String| Diagnostic::error("no-graph", why);
    if !path.is_dir() {
        return Ok(path.to_owned());
    }
    let unreadable = |e: io::Error| wrong(format!("{} cannot be read: {e}", path.display()));
    let entries = path.read_dir().map_err(unreadable)?.collect::<Result<Vec<_>, _>>().map_err(unreadable)?;
    let mut graphs: Vec<PathBuf> = entries.iter().map(fs::DirEntry::path).collect();
    graphs.retain(|p| p.to_str().is_some_and(|n| n.ends_with(ENDING)));
    match graphs.len() {
        1 => Ok(graphs.remove(0)),
        0 => Err(wrong(format!("{} holds no file that ends in {ENDING}", path.display()))),
        n => Err(wrong(format!("{} holds {n} graphs; name one of them", path.display()))),
    }
}

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
pub fn load(path: &Path) -> Result<(Document, Vec<Diagnostic>), Vec<Diagnostic>> {
    let bytes = read(path, DEFAULT_SIZE_LIMIT as u64)
        .map_err(|e| vec![Diagnostic::error("unreadable", format!("{} cannot be read: {e}", path.display()))])?;
    let mut document = Document::from_slice(&bytes)?;
    let mut told = Vec::new();
    let layout = layout_path(path);
    match read(&layout, DEFAULT_SIZE_LIMIT as u64) {
        Ok(bytes) => told.extend(document.read_layout(&bytes).err()),
        Err(e) if e.kind() == io::ErrorKind::NotFound => {}
        Err(e) => told.push(Diagnostic::error("unreadable", format!("{} cannot be read: {e}", layout.display()))),
    }
    Ok((document, told))
}

/// Writes a file under another name and gives it its name; makes its folder. Whatever happens to this program, there is a
/// whole file; if the machine loses power, perhaps an old one.
///
/// # Errors
/// Those of the system; then the file is as it was.
pub fn write_quickly(path: &Path, bytes: &[u8]) -> io::Result<()> {
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder)?;
    }
    let name = path.file_name().and_then(|n| n.to_str()).unwrap_or("kept");
    let temporary = path.with_file_name(format!(".{name}-{}.tmp", std::process::id()));
    let written = fs::write(&temporary, bytes).and_then(|()| fs::rename(&temporary, path));
    if written.is_err() {
        let _ = fs::remove_file(&temporary);
    }
    written
}

/// Writes a file under another name, syncs it and gives it its name, so that there is always a whole one.
///
/// # Errors
/// Those of the system; then the file is as it was.
pub fn write_whole(path: &Path, bytes: &[u8]) -> io::Result<()> {
    let name = path.file_name().and_then(|n| n.to_str()).unwrap_or("graph");
    let temporary = path.with_file_name(format!(".{name}-{}.tmp", std::process::id()));
    let write = || {
        let mut file = File::create(&temporary)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        fs::rename(&temporary, path)
    };
    let written = write();
    if written.is_err() {
        let _ = fs::remove_file(&temporary);
    }
    written
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
}
