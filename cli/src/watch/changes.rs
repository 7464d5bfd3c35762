//! Which files have changed since they were read. By looking at them again and again, not by asking the system to tell:
//! that works on every drive, also on those of a network, whose servers tell nobody, and for files that are not there
//! yet. Times and lengths are compared first, and contents where those cannot decide.

use crate::graph::Files;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, SystemTime};
use tenon_engine::{Host, digest_bytes};

/// A file that was changed so short ago may change again within the same tick of its time: the coarsest are two seconds.
const FRESH: Duration = Duration::from_secs(3);

/// When a file was changed last and how long it is; none if it is not there.
type Stamp = Option<(SystemTime, u64)>;

fn stamp(path: &Path) -> Stamp {
    let about = std::fs::metadata(path).ok()?;
    Some((about.modified().ok()?, about.len()))
}

/// Digest of what a file holds; none if it cannot be read.
fn digest(path: &Path) -> Option<u128> {
    let mut bytes = Vec::new();
    File::open(path).ok()?.take(crate::graph::LARGEST_INPUT).read_to_end(&mut bytes).ok()?;
    Some(digest_bytes(&bytes))
}

/// What is known of one file.
pub struct Look {
    /// What was made use of.
    used: Option<u128>,
    /// What it looked like last.
    stamp: Stamp,
    content: Option<u128>,
}

impl Look {
    /// What is there now counts as made use of.
    pub fn at(path: &Path) -> Self {
        let stamp = stamp(path);
        let content = digest(path);
        Self { used: content, stamp, content }
    }

    /// True if the file holds something else than what was made use of, and held the same when it was last looked at: then
    /// whoever writes it has come to an end. From then on that counts as made use of.
    pub fn has_changed(&mut self, path: &Path) -> bool {
        let stamp = stamp(path);
        let fresh = stamp.is_some_and(|(at, _)| at.elapsed().map_or(true, |age| age < FRESH));
        let content = if stamp == self.stamp && !fresh { self.content } else { digest(path) };
        let steady = content == self.content;
        (self.stamp, self.content) = (stamp, content);
        let changed = steady && content != self.used;
        if changed {
            self.used = content;
        }
        changed
    }
}

/// Reads files for nodes and remembers what was read.
pub struct Changes {
    files: Files,
    seen: Mutex<BTreeMap<PathBuf, Look>>,
}

impl Changes {
    /// Nothing has been read.
    pub fn new(files: Files) -> Self {
        Self { files, seen: Mutex::default() }
    }

    /// The files that have changed since they were read or named here.
    pub fn changed(&self) -> Vec<PathBuf> {
        let mut seen = self.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let changed = seen.iter_mut().filter_map(|(path, look)| look.has_changed(path).then(|| path.clone()));
        changed.collect()
    }
}

impl Host for Changes {
    fn read(&self, name: &str) -> io::Result<Arc<[u8]>> {
        let path = self.files.resolve(name);
        // Before it is read, so that what is written meanwhile is seen as a change.
        let stamp = stamp(&path);
        let read = self.files.read(name);
        let content = read.as_ref().ok().map(|bytes| digest_bytes(bytes));
        let look = Look { used: content, stamp, content };
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).insert(path, look);
        read
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn a_change_counts_once_and_only_when_it_is_steady() {
        let path = std::env::temp_dir().join(format!("tenon-watch-{}", std::process::id()));
        fs::write(&path, "one").unwrap();
        let mut look = Look::at(&path);
        assert!(!look.has_changed(&path) && !look.has_changed(&path));
        // As long and at the same time: only the content tells.
        let time = fs::metadata(&path).unwrap().modified().unwrap();
        fs::write(&path, "two").unwrap();
        File::options().write(true).open(&path).unwrap().set_modified(time).unwrap();
        assert!(!look.has_changed(&path), "somebody may still be writing");
        assert!(look.has_changed(&path) && !look.has_changed(&path));
        // Written anew with the same content, touched: nothing has changed.
        fs::write(&path, "two").unwrap();
        assert!(!look.has_changed(&path) && !look.has_changed(&path));
        // Gone for a moment only.
        fs::remove_file(&path).unwrap();
        assert!(!look.has_changed(&path));
        fs::write(&path, "two").unwrap();
        assert!(!look.has_changed(&path) && !look.has_changed(&path));
        fs::remove_file(&path).unwrap();
        assert!(!look.has_changed(&path) && look.has_changed(&path));
    }
}
