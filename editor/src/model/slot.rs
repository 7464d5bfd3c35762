//! Where one window keeps its unsaved work, so that no other window takes it for work that was left behind. As long as the
//! window lives it holds a lock, which the system takes back however it ends; work in a place that nobody holds is an
//! orphan.

use std::fs::{self, File};
use std::path::{Path, PathBuf};
use tenon_engine::digest_bytes;

/// Most windows on one graph that keep their work.
const MOST: usize = 64;

/// A place for unsaved work.
#[derive(Debug)]
pub struct Slot {
    /// The file.
    pub file: PathBuf,
    /// Another window holds the first place, and so has this graph open.
    pub second: bool,
    /// Work that a window has left behind stood there when it was taken.
    pub orphan: bool,
    /// Held as long as this is.
    _lock: Option<File>,
}

impl Slot {
    /// Takes a place among `file` and those numbered after it: if `orphans` are wanted, one with work that a window has left
    /// behind, else the first empty one. Without a folder for locks it is `file` itself. `None` if all are held.
    pub fn take(file: &Path, locks: Option<&Path>, orphans: bool) -> Option<Self> {
        let is_left = |file: &Path| fs::metadata(file).is_ok_and(|m| m.len() > 0);
        let Some(locks) = locks.filter(|f| fs::create_dir_all(f).is_ok()) else {
            let orphan = orphans && is_left(file);
            return Some(Self { file: file.to_owned(), second: false, orphan, _lock: None });
        };
        let (mut free, mut held) = (None, false);
        for number in 1..=MOST {
            let place = numbered(file, number);
            let left = is_left(&place);
            if (left && !orphans) || (free.is_some() && !left) {
                continue;
            }
            // Locks are empty files that stay; they say nothing but who holds them.
            let name = format!("{:032x}", digest_bytes(place.as_os_str().as_encoded_bytes()));
            let lock = File::options().create(true).append(true).open(locks.join(name));
            let Some(lock) = lock.ok().filter(|l| l.try_lock().is_ok()) else {
                held |= number == 1;
                continue;
            };
            let slot = Self { file: place, second: held, orphan: left, _lock: Some(lock) };
            if left {
                return Some(slot);
            }
            free = Some(slot);
        }
        free
    }
}

/// `.graph.tenon.json.unsaved`, `.graph.tenon.json.2.unsaved` …
fn numbered(file: &Path, number: usize) -> PathBuf {
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    match (number, name.rsplit_once('.')) {
        (1, _) | (_, None) => file.to_owned(),
        (_, Some((stem, ending))) => file.with_file_name(format!("{stem}.{number}.{ending}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn windows_have_places_of_their_own_and_orphans_come_first() {
        let folder = std::env::temp_dir().join(format!("tenon-slot-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        let (file, locks) = (folder.join(".g.unsaved"), folder.join("locks"));
        let take = || Slot::take(&file, Some(&locks), true).unwrap();
        let (first, second) = (take(), take());
        assert_eq!((first.file.as_path(), first.second), (file.as_path(), false));
        assert_eq!((second.file.clone(), second.second), (folder.join(".g.2.unsaved"), true));
        // What both keep is theirs as long as they live.
        fs::write(&first.file, "one").unwrap();
        fs::write(&second.file, "two").unwrap();
        let third = take();
        assert_eq!(third.file, folder.join(".g.3.unsaved"));
        drop((second, third));
        assert_eq!(Slot::take(&file, Some(&locks), false).unwrap().file, folder.join(".g.3.unsaved"));
        let heir = take();
        assert!(heir.orphan);
        assert_eq!(fs::read_to_string(&heir.file).unwrap(), "two");
        drop(first);
        assert_eq!(fs::read_to_string(take().file).unwrap(), "one");
        fs::remove_dir_all(&folder).unwrap();
    }
}
