//! Finding and reading graph files, and the files that a graph names.

use crate::words::Wrong;
use std::collections::HashSet;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_engine::{DEFAULT_SIZE_LIMIT, Document, Host};

/// The ending by which a folder's graph is found.
const ENDING: &str = ".tenon.json";

/// The largest file that a node may read, bytes.
pub const LARGEST_INPUT: u64 = 4 << 30;

/// The graph file that `path` names: itself, or the one `*.tenon.json` of a folder.
pub fn find(path: &Path) -> Result<PathBuf, Wrong> {
    let unreadable = |error: io::Error| Wrong::new("unreadable", format!("{} cannot be read: {error}", path.display()));
    if !path.metadata().map_err(unreadable)?.is_dir() {
        return Ok(path.to_owned());
    }
    let mut found = Vec::new();
    for entry in path.read_dir().map_err(unreadable)? {
        let file = entry.map_err(unreadable)?.path();
        if file.to_str().is_some_and(|name| name.ends_with(ENDING)) && !file.is_dir() {
            found.push(file);
        }
    }
    found.sort();
    match found.len() {
        1 => Ok(found.remove(0)),
        0 => Err(Wrong::new("no-graph", format!("{} holds no file that ends in {ENDING}", path.display()))),
        n => Err(Wrong::new("which-graph", format!("{} holds {n} graphs", path.display()))
            .hint(format!("name one of them, such as {}", found[0].display()))),
    }
}

/// Reads the bytes of a graph file; never more than the limit, whatever the file is.
pub fn read(file: &Path) -> Result<Vec<u8>, Wrong> {
    let unreadable = |error: io::Error| Wrong::new("unreadable", format!("{} cannot be read: {error}", file.display()));
    let mut bytes = Vec::new();
    let limit = DEFAULT_SIZE_LIMIT as u64 + 1;
    File::open(file).map_err(unreadable)?.take(limit).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() > DEFAULT_SIZE_LIMIT {
        return Err(Wrong::new(
            "file-too-large",
            format!("{} is larger than a graph may be ({} MiB)", file.display(), DEFAULT_SIZE_LIMIT >> 20),
        ));
    }
    Ok(bytes)
}

/// Finds, reads and parses a graph.
pub fn load(path: &Path) -> Result<(PathBuf, Document), Wrong> {
    let file = find(path)?;
    let document = Document::from_slice(&read(&file)?).map_err(|diagnostics| {
        Wrong::new("no-graph", format!("{} is not a readable graph", file.display())).because(diagnostics)
    })?;
    Ok((file, document))
}

/// Gives the nodes the files that they name: relative to the graph's folder, or, for names that were given on the
/// command line, relative to the current folder first.
pub struct Files {
    folder: PathBuf,
    from_command_line: HashSet<String>,
}

impl Files {
    /// The files of the graph at `graph`; `from_command_line` are the texts given by `--set`.
    pub fn new(graph: &Path, from_command_line: HashSet<String>) -> Self {
        Self { folder: graph.parent().map(Path::to_owned).unwrap_or_default(), from_command_line }
    }

    /// Where the file is that is called `name`.
    pub fn resolve(&self, name: &str) -> PathBuf {
        let here = Path::new(name);
        if self.from_command_line.contains(name) && here.exists() { here.to_owned() } else { self.folder.join(name) }
    }
}

impl Host for Files {
    fn read(&self, path: &str) -> io::Result<Arc<[u8]>> {
        let mut bytes = Vec::new();
        File::open(self.resolve(path))?.take(LARGEST_INPUT + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > LARGEST_INPUT {
            return Err(io::Error::new(
                io::ErrorKind::FileTooLarge,
                format!("larger than {} GiB", LARGEST_INPUT >> 30),
            ));
        }
        Ok(bytes.into())
    }
}
