//! Files that the program writes: whole or not at all, and never outside the folder they belong to.
//!
//! A file is written under a temporary name beside its final one, synced, and renamed. [`Staged`] keeps several files at
//! that stage so that none gets its name unless all could be written.

use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Component, Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime};

/// Why a file could not be written.
#[derive(Debug)]
pub enum WriteError {
    /// The system refused.
    Io {
        /// The path that was to be written.
        path: PathBuf,
        /// The system's reason.
        error: io::Error,
    },
    /// The name leads out of the output folder.
    Escapes {
        /// The name as the graph gave it.
        name: String,
    },
    /// Two writers give a file the same name.
    SameName {
        /// The path.
        path: PathBuf,
        /// `node.port` of the one.
        first: String,
        /// `node.port` of the other.
        second: String,
    },
}

impl WriteError {
    /// Name of the kind of fault.
    #[must_use]
    pub fn code(&self) -> &'static str {
        if matches!(self, Self::SameName { .. }) { "same-file-name" } else { "unwritable" }
    }
}

impl std::error::Error for WriteError {}

impl std::fmt::Display for WriteError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Io { path, error } => write!(f, "{} cannot be written: {error}", path.display()),
            Self::Escapes { name } => {
                write!(f, "the file name \"{name}\" is refused: it does not stay inside the output folder")
            }
            Self::SameName { path, first, second } => {
                write!(f, "{first} and {second} both write {}; give one of the files another name", path.display())
            }
        }
    }
}

fn io_at(path: &Path) -> impl FnOnce(io::Error) -> WriteError + '_ {
    |error| WriteError::Io { path: path.to_owned(), error }
}

/// A new file under a temporary name that nobody else has: not another thread, and not another process, even one of the same
/// number on another machine that shares the folder. `what` tells what it is for.
fn temporary(folder: &Path, what: &str) -> io::Result<(PathBuf, File)> {
    static SERIAL: AtomicU64 = AtomicU64::new(0);
    loop {
        let serial = SERIAL.fetch_add(1, Ordering::Relaxed);
        let path = folder.join(format!(".tenon-{}-{serial}{what}.tmp", std::process::id()));
        match File::create_new(&path) {
            Ok(file) => return Ok((path, file)),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

/// The folder of a file.
fn folder_of(target: &Path) -> &Path {
    target.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Writes a file under another name and gives it its name, without waiting for the disk; makes its folder. Whatever
/// happens to this program, there is a whole file; if the machine loses power, perhaps an old one.
///
/// # Errors
/// Those of the system; then the file is as it was.
pub fn write_quickly(target: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let folder = folder_of(target);
    fs::create_dir_all(folder).map_err(io_at(target))?;
    let (temporary, mut file) = temporary(folder, "-quick").map_err(io_at(target))?;
    let written = file.write_all(bytes).and_then(|()| fs::rename(&temporary, target));
    if written.is_err() {
        let _ = fs::remove_file(&temporary);
    }
    written.map_err(io_at(target))
}

/// Files written under temporary names, waiting to be given their final ones. What is not committed is removed.
#[derive(Default)]
pub struct Staged {
    files: Vec<(PathBuf, PathBuf)>,
}

impl Staged {
    /// Writes and syncs `bytes` beside `target` under a temporary name; makes the folders above it.
    ///
    /// # Errors
    /// Those of the system; then nothing is left behind.
    pub fn add(&mut self, target: &Path, bytes: &[u8]) -> Result<(), WriteError> {
        if target.is_dir() {
            return Err(io_at(target)(io::ErrorKind::IsADirectory.into()));
        }
        let folder = folder_of(target);
        fs::create_dir_all(folder).map_err(io_at(target))?;
        let (temporary, mut file) = temporary(folder, "").map_err(io_at(target))?;
        if let Err(error) = file.write_all(bytes).and_then(|()| file.sync_all()) {
            let _ = fs::remove_file(&temporary);
            return Err(io_at(target)(error));
        }
        self.files.push((temporary, target.to_owned()));
        Ok(())
    }

    /// Gives all files their final names, in the order in which they were added.
    ///
    /// # Errors
    /// Those of the system; files before the one that was refused have their names.
    pub fn commit(mut self) -> Result<(), WriteError> {
        for (temporary, target) in &self.files {
            fs::rename(temporary, target).map_err(io_at(target))?;
            // The rename itself is durable once the folder is synced; systems that cannot sync folders say so here.
            if let Some(folder) = target.parent().filter(|p| !p.as_os_str().is_empty()) {
                let _ = File::open(folder).and_then(|f| f.sync_all());
            }
        }
        self.files.clear();
        Ok(())
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        for (temporary, _) in &self.files {
            let _ = fs::remove_file(temporary);
        }
    }
}

/// Writes one file whole or not at all.
///
/// # Errors
/// Those of the system; then the file is as it was.
pub fn write_whole(target: &Path, bytes: &[u8]) -> Result<(), WriteError> {
    let mut staged = Staged::default();
    staged.add(target, bytes)?;
    staged.commit()
}

/// Temporary files that nobody has written to for so long were left by a killed process.
const ABANDONED: Duration = Duration::from_secs(3600);

/// Removes temporary files of this program from a folder if they are clearly nobody's any more. What cannot be removed
/// stays.
fn clear(dir: &Path) {
    let (now, entries) = (SystemTime::now(), fs::read_dir(dir));
    for entry in entries.into_iter().flatten().flatten() {
        let name = entry.file_name();
        let ours = name.to_str().and_then(|n| n.strip_prefix(".tenon-")?.strip_suffix(".tmp")?.split_once('-'));
        let ours = ours.is_some_and(|(process, _)| process.parse::<u32>().is_ok());
        let modified = || entry.metadata().ok().filter(std::fs::Metadata::is_file)?.modified().ok();
        if ours && modified().is_some_and(|then| now.duration_since(then).is_ok_and(|age| age > ABANDONED)) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Makes the folder `dir` if it is not there, clears it of what killed processes have left, and tries that files can be made in it, so that a long run does not end
/// at a folder that cannot be written.
///
/// # Errors
/// Those of the system.
pub fn prepare_folder(dir: &Path) -> Result<(), WriteError> {
    fs::create_dir_all(dir).map_err(io_at(dir))?;
    clear(dir);
    let (probe, _) = temporary(dir, "-probe").map_err(io_at(dir))?;
    fs::remove_file(&probe).map_err(io_at(dir))
}

/// The path of the file `name` inside the folder `dir`. Absolute names, `..` and empty names are refused, and so is a
/// folder on the way that is a link out of `dir`.
///
/// # Errors
/// Says so, or what the system says.
pub fn inside(dir: &Path, name: &str) -> Result<PathBuf, WriteError> {
    let escapes = || WriteError::Escapes { name: name.to_owned() };
    let relative = Path::new(name);
    // Backslashes and colons are separators and drives on other systems: the same graph must be refused everywhere.
    let plain = !name.is_empty()
        && !name.ends_with('/')
        && !name.chars().any(|c| c.is_control() || c == '\\' || c == ':')
        && relative.components().all(|c| matches!(c, Component::Normal(_)));
    if !plain {
        return Err(escapes());
    }
    let target = dir.join(relative);
    let root = fs::canonicalize(dir).map_err(io_at(dir))?;
    let mut existing = target.parent();
    while let Some(folder) = existing {
        match fs::canonicalize(folder) {
            Ok(real) if real.starts_with(&root) => return Ok(target),
            Ok(_) => return Err(escapes()),
            // Not there yet: what is above it decides.
            Err(error) if error.kind() == io::ErrorKind::NotFound => existing = folder.parent(),
            Err(error) => return Err(io_at(&target)(error)),
        }
    }
    Err(escapes())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn folder(name: &str) -> PathBuf {
        let dir = std::env::temp_dir().join(format!("tenon-output-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&dir);
        fs::create_dir_all(&dir).unwrap();
        dir
    }

    #[test]
    fn names_that_leave_the_folder_are_refused() {
        let dir = folder("escape");
        for name in ["", "/etc/x", "../x", "a/../../x", "./x", "a\\b", "C:x", "a\nb", "a/", "a/.."] {
            assert!(matches!(inside(&dir, name), Err(WriteError::Escapes { .. })), "{name:?}");
        }
        assert_eq!(inside(&dir, "a/b.ngc").unwrap(), dir.join("a/b.ngc"));
        assert_eq!(inside(&dir, "..a").unwrap(), dir.join("..a"));
        fs::remove_dir_all(&dir).unwrap();
    }

    #[cfg(unix)]
    #[test]
    fn a_link_out_of_the_folder_is_not_followed() {
        let dir = folder("link");
        std::os::unix::fs::symlink(std::env::temp_dir(), dir.join("out")).unwrap();
        assert!(matches!(inside(&dir, "out/x"), Err(WriteError::Escapes { .. })));
        assert!(matches!(inside(&dir, "out/deeper/x"), Err(WriteError::Escapes { .. })));
        fs::remove_dir_all(&dir).unwrap();
    }

    #[test]
    fn what_killed_processes_have_left_is_cleared_once_it_is_old() {
        let dir = folder("clear");
        let aged = |name: &str, hours: u64| {
            let file = File::create(dir.join(name)).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(hours * 3600)).unwrap();
        };
        let (old, others) = ([".tenon-12-0.tmp", ".tenon-99999-probe.tmp"], [".tenon-x-0.tmp", ".tenon.tmp", "a.ngc"]);
        old.iter().chain(&others).for_each(|name| aged(name, 2));
        aged(".tenon-13-0.tmp", 0);
        fs::create_dir(dir.join(".tenon-14-0.tmp")).unwrap();
        prepare_folder(&dir).unwrap();
        let left: Vec<String> =
            fs::read_dir(&dir).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        assert!(old.iter().all(|name| !left.iter().any(|l| l == name)), "{left:?}");
        assert!(others.iter().chain(&[".tenon-13-0.tmp", ".tenon-14-0.tmp"]).all(|n| left.iter().any(|l| l == n)));
        fs::remove_dir_all(&dir).unwrap();
    }

    #[test]
    fn what_is_not_committed_leaves_nothing_behind() {
        let dir = folder("staged");
        fs::write(dir.join("a"), "old").unwrap();
        let mut staged = Staged::default();
        staged.add(&dir.join("a"), b"new").unwrap();
        assert!(staged.add(&dir.join("a/b"), b"below a file").is_err());
        drop(staged);
        assert_eq!(fs::read(dir.join("a")).unwrap(), b"old");
        assert_eq!(fs::read_dir(&dir).unwrap().count(), 1);
        write_whole(&dir.join("a"), b"new").unwrap();
        assert_eq!(fs::read(dir.join("a")).unwrap(), b"new");
        assert_eq!(fs::read_dir(&dir).unwrap().count(), 1);
        fs::remove_dir_all(&dir).unwrap();
    }
}
