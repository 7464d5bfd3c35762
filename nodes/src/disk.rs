//! A folder in which results outlive the process: one file per result, named by its key, whole or not at all, checked at
//! every reading. Processes may share it, and it keeps itself below a size. For every program that runs graphs.

use std::fs::{self, File, OpenOptions};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, SystemTime};
use tenon_engine::{Store, StoreFault, stop};

/// First bytes of every entry.
const MAGIC: [u8; 8] = *b"tenonkpt";
/// Version of the frame around a result; what is inside has its own.
const VERSION: u32 = 1;
/// Magic, version, key, length: what the digest covers besides the result.
const COVERED: usize = 8 + 4 + 16 + 8;
/// With the digest.
const HEAD: usize = COVERED + blake3::OUT_LEN;
/// Ending of an entry's name; before it stands the key in 32 hexadecimal digits.
const ENDING: &str = ".kept";
/// Ending of a name under which an entry is written.
const TEMPORARY: &str = ".tmp";
/// Temporary files that nobody has written to for so long were left by a killed process.
const ABANDONED: Duration = Duration::from_secs(3600);
/// So many bytes are read, digested or written before it is looked whether to stop.
const OFTEN: usize = 1 << 20;
/// No entry is larger, bytes.
const LARGEST: u64 = 4 << 30;

/// The folder. Nothing is done with it before the first result is kept.
#[derive(Debug)]
pub struct DiskCache {
    folder: PathBuf,
    limit: u64,
    /// Bytes that may still be written before the folder has to be looked through.
    room: AtomicU64,
    serial: AtomicU64,
}

impl DiskCache {
    /// The cache in `folder`, which is made when something is kept. All entries together stay below `limit` bytes, by and
    /// large: what was used longest ago goes first. Other files in the folder are left alone.
    #[must_use]
    pub fn new(folder: impl Into<PathBuf>, limit: u64) -> Self {
        Self { folder: folder.into(), limit, room: AtomicU64::new(0), serial: AtomicU64::new(0) }
    }

    /// The file of the entry under `key`, which need not be there.
    #[must_use]
    pub fn path(&self, key: u128) -> PathBuf {
        self.folder.join(format!("{key:032x}{ENDING}"))
    }

    /// Removes the entries used longest ago until the rest takes less than nine tenths of the limit, if all of them take
    /// more than the limit, and what killed processes have left. O(n log n) in entries. Gives the bytes that are left.
    ///
    /// # Errors
    /// If the folder cannot be listed.
    pub fn trim(&self) -> io::Result<u64> {
        let (now, mut entries) = (SystemTime::now(), Vec::new());
        for found in fs::read_dir(&self.folder)? {
            // Others may be removing files as well: what is gone is gone.
            let Ok((path, data)) = found.and_then(|f| Ok((f.path(), f.metadata()?))) else { continue };
            let used = data.modified().unwrap_or(now);
            let name = path.file_name().and_then(|n| n.to_str()).unwrap_or_default();
            let abandoned = || now.duration_since(used).is_ok_and(|age| age > ABANDONED);
            if is_named(name, ENDING) {
                entries.push((used, path, data.len()));
            } else if name.strip_prefix('.').is_some_and(|n| is_named(n, TEMPORARY)) && abandoned() {
                let _ = fs::remove_file(path);
            }
        }
        let mut total: u64 = entries.iter().map(|(_, _, len)| len).sum();
        if total > self.limit {
            entries.sort();
            for (_, path, len) in entries {
                if total <= self.limit / 10 * 9 {
                    break;
                }
                if fs::remove_file(path).is_ok() {
                    total -= len;
                }
            }
        }
        Ok(total)
    }

    /// Writes an entry beside its place and gives it its name. It is not synced: whatever a power cut leaves of it is
    /// found out by its digest.
    fn write(&self, key: u128, bytes: &[u8]) -> io::Result<()> {
        fs::create_dir_all(&self.folder)?;
        let head = head(key, bytes);
        let (mut file, temporary) = self.temporary(key)?;
        // Gone with it, unless the entry has got its name by then.
        let temporary = Temporary(temporary);
        file.write_all(&head)?;
        for part in bytes.chunks(OFTEN) {
            stop::check();
            file.write_all(part)?;
        }
        fs::rename(&temporary.0, self.path(key))
    }

    /// A file that no other process or thread writes, whatever its number is.
    fn temporary(&self, key: u128) -> io::Result<(File, PathBuf)> {
        loop {
            let serial = self.serial.fetch_add(1, Ordering::Relaxed);
            let name = format!(".{key:032x}-{}-{serial}{TEMPORARY}", std::process::id());
            let path = self.folder.join(name);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
                made => return made.map(|file| (file, path)),
            }
        }
    }

    /// Keeps the folder below its limit: looks it through at the first entry, and then each time that a sixteenth of the
    /// limit has been written.
    fn make_room(&self, written: u64) {
        let enough = self.room.fetch_update(Ordering::Relaxed, Ordering::Relaxed, |room| room.checked_sub(written));
        if enough.is_err() && self.trim().is_ok() {
            self.room.store(self.limit / 16, Ordering::Relaxed);
        }
    }

    fn failed(&self, error: &io::Error) -> StoreFault {
        StoreFault::Failed { place: self.folder.display().to_string(), why: error.to_string() }
    }
}

/// A temporary file, removed when this is dropped: after an error, or when the work is left in the middle.
struct Temporary(PathBuf);

impl Drop for Temporary {
    fn drop(&mut self) {
        let _ = fs::remove_file(&self.0);
    }
}

impl Store for DiskCache {
    fn get(&self, key: u128) -> Result<Option<Vec<u8>>, StoreFault> {
        let path = self.path(key);
        match read(&path) {
            Ok(None) => Ok(None),
            Ok(Some(file)) => match opened(key, file) {
                Ok(bytes) => Ok(Some(bytes)),
                Err(why) => Err(StoreFault::Damaged { place: path.display().to_string(), why: why.to_owned() }),
            },
            Err(error) => Err(self.failed(&error)),
        }
    }

    fn put(&self, key: u128, bytes: &[u8]) -> Result<(), StoreFault> {
        let len = (HEAD + bytes.len()) as u64;
        if len > self.limit.min(LARGEST) {
            return Ok(());
        }
        self.write(key, bytes).map_err(|error| self.failed(&error))?;
        self.make_room(len);
        Ok(())
    }

    fn place(&self, key: u128) -> String {
        self.path(key).display().to_string()
    }
}

/// Whether a name is one of this cache's: 32 hexadecimal digits first, `ending` last.
fn is_named(name: &str, ending: &str) -> bool {
    let hex = |b: &u8| b.is_ascii_digit() || (b'a'..=b'f').contains(b);
    name.ends_with(ending) && name.len() >= 32 + ending.len() && name.as_bytes()[..32].iter().all(hex)
}

/// The content of an entry's file, which is marked as used now; `None` if there is none.
fn read(path: &Path) -> io::Result<Option<Vec<u8>>> {
    let mut file = match File::open(path) {
        Err(e) if matches!(e.kind(), io::ErrorKind::NotFound | io::ErrorKind::NotADirectory) => return Ok(None),
        file => file?,
    };
    let mut bytes = Vec::new();
    let mut rest = Read::by_ref(&mut file).take(HEAD as u64 + LARGEST);
    while rest.by_ref().take(OFTEN as u64).read_to_end(&mut bytes)? > 0 {
        stop::check();
    }
    // Where it may not be marked, it goes a little early.
    let _ = file.set_modified(SystemTime::now());
    Ok(Some(bytes))
}

/// What stands before a result in its file: magic, version, key, length, and the digest of these and the result.
fn head(key: u128, bytes: &[u8]) -> [u8; HEAD] {
    let mut head = [0; HEAD];
    head[..8].copy_from_slice(&MAGIC);
    head[8..12].copy_from_slice(&VERSION.to_le_bytes());
    head[12..28].copy_from_slice(&key.to_le_bytes());
    head[28..COVERED].copy_from_slice(&(bytes.len() as u64).to_le_bytes());
    let mut digest = blake3::Hasher::new();
    digest.update(&head[..COVERED]);
    for part in bytes.chunks(OFTEN) {
        stop::check();
        digest.update(part);
    }
    head[COVERED..].copy_from_slice(digest.finalize().as_bytes());
    head
}

/// The result in an entry's file, or what is wrong with it. O(bytes).
fn opened(key: u128, mut file: Vec<u8>) -> Result<Vec<u8>, &'static str> {
    let Some((found, bytes)) = file.split_at_checked(HEAD) else { return Err("it is cut off within its head") };
    let expected = head(key, bytes);
    if found != expected {
        let same = |range: std::ops::Range<usize>| found[range.clone()] == expected[range];
        return Err(if !same(0..12) {
            "it does not begin as a kept result does"
        } else if !same(12..28) {
            "it is kept under another key than its own"
        } else if !same(28..COVERED) {
            "it has another length than was written"
        } else {
            "its digest does not match"
        });
    }
    file.drain(..HEAD);
    Ok(file)
}
