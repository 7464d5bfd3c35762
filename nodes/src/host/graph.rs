//! Finding and reading graph files, and the files that a graph names.

use std::collections::HashSet;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_engine::{DEFAULT_SIZE_LIMIT, Diagnostic, Document, Host};

/// The ending by which a folder's graph is found.
pub const ENDING: &str = ".tenon.json";

/// The largest file that a node may read, bytes.
pub const LARGEST_INPUT: u64 = 4 << 30;

/// Why a graph cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum GraphError {
    /// The system refused.
    #[error("{} cannot be read: {error}", .path.display())]
    Unreadable {
        /// The file or folder.
        path: PathBuf,
        /// The system's reason.
        error: io::Error,
    },
    /// The folder holds no graph.
    #[error("{} holds no file that ends in {ENDING}", .folder.display())]
    NoGraph {
        /// The folder.
        folder: PathBuf,
    },
    /// The folder holds several graphs.
    #[error("{} holds {count} graphs", .folder.display())]
    WhichGraph {
        /// The folder.
        folder: PathBuf,
        /// How many.
        count: usize,
        /// One of them.
        such_as: PathBuf,
    },
    /// The file is too large.
    #[error("{} is larger than a graph may be ({} MiB)", .file.display(), DEFAULT_SIZE_LIMIT >> 20)]
    TooLarge {
        /// The file.
        file: PathBuf,
    },
    /// What the file says is no graph.
    #[error("{} is not a readable graph", .file.display())]
    NotAGraph {
        /// The file.
        file: PathBuf,
        /// Why, with lines and columns.
        because: Vec<Diagnostic>,
    },
}

impl GraphError {
    /// Name of the kind of fault.
    #[must_use]
    pub fn code(&self) -> &'static str {
        match self {
            Self::Unreadable { .. } => "unreadable",
            Self::NoGraph { .. } | Self::NotAGraph { .. } => "no-graph",
            Self::WhichGraph { .. } => "which-graph",
            Self::TooLarge { .. } => "file-too-large",
        }
    }

    /// What would help, where it is known.
    #[must_use]
    pub fn hint(&self) -> Option<String> {
        match self {
            Self::WhichGraph { such_as, .. } => Some(format!("name one of them, such as {}", such_as.display())),
            _ => None,
        }
    }

    /// It as a diagnostic, with its first reason.
    #[must_use]
    pub fn diagnostic(&self) -> Diagnostic {
        let message = match self {
            Self::NotAGraph { because, .. } if !because.is_empty() => {
                let more = if because.len() > 1 { format!(" (and {} more)", because.len() - 1) } else { String::new() };
                format!("{self}: {}{more}", because[0].message)
            }
            _ => self.to_string(),
        };
        let diagnostic = Diagnostic::error(self.code(), message);
        match self.hint() {
            Some(hint) => diagnostic.hint(hint),
            None => diagnostic,
        }
    }
}

fn unreadable(path: &Path) -> impl Fn(io::Error) -> GraphError + '_ {
    |error| GraphError::Unreadable { path: path.to_owned(), error }
}

/// The graph file that `path` names: itself, or the one `*.tenon.json` of a folder.
///
/// # Errors
/// If it cannot be read, or a folder holds none or several.
pub fn find(path: &Path) -> Result<PathBuf, GraphError> {
    if !path.metadata().map_err(unreadable(path))?.is_dir() {
        return Ok(path.to_owned());
    }
    let mut found = Vec::new();
    for entry in path.read_dir().map_err(unreadable(path))? {
        let file = entry.map_err(unreadable(path))?.path();
        if file.to_str().is_some_and(|name| name.ends_with(ENDING)) && !file.is_dir() {
            found.push(file);
        }
    }
    found.sort();
    let folder = path.to_owned();
    match found.len() {
        1 => Ok(found.remove(0)),
        0 => Err(GraphError::NoGraph { folder }),
        count => Err(GraphError::WhichGraph { folder, count, such_as: found.remove(0) }),
    }
}

/// Reads the bytes of a graph file; never more than the limit, whatever the file is.
///
/// # Errors
/// If the system refuses or the file is too large.
pub fn read(file: &Path) -> Result<Vec<u8>, GraphError> {
    let mut bytes = Vec::new();
    let limit = DEFAULT_SIZE_LIMIT as u64 + 1;
    let open = File::open(file).map_err(unreadable(file))?;
    open.take(limit).read_to_end(&mut bytes).map_err(unreadable(file))?;
    if bytes.len() > DEFAULT_SIZE_LIMIT {
        return Err(GraphError::TooLarge { file: file.to_owned() });
    }
    Ok(bytes)
}

/// Finds, reads and parses a graph.
///
/// # Errors
/// Says what keeps it from being read.
pub fn load(path: &Path) -> Result<(PathBuf, Document), GraphError> {
    let file = find(path)?;
    let document =
        Document::from_slice(&read(&file)?).map_err(|because| GraphError::NotAGraph { file: file.clone(), because })?;
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
    #[must_use]
    pub fn new(graph: &Path, from_command_line: HashSet<String>) -> Self {
        Self { folder: graph.parent().map(Path::to_owned).unwrap_or_default(), from_command_line }
    }

    /// Where the file is that is called `name`.
    #[must_use]
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
