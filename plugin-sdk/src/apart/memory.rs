//! Memory that two processes see: a file without a name, mapped by both. A header of flags, then room for arrays that is
//! filled from the front during one evaluation and used again by the next. The two take turns: the host writes before it
//! asks, the plugin's process until it answers.

use bytemuck::Pod;
use std::fs::File;
use std::io;
use std::os::fd::{AsRawFd, FromRawFd};
use std::ptr::NonNull;
use std::sync::atomic::{AtomicU32, AtomicU64, Ordering};

/// What stands before the arrays.
#[repr(C)]
pub(super) struct Header {
    /// 1: the evaluation is to stop.
    pub cancel: AtomicU32,
    /// Calls of `progress` that rose; a sign of life.
    pub beats: AtomicU32,
    /// The fraction done, the bits of an `f64`.
    pub progress: AtomicU64,
    /// How far the room was ever used: what lies beyond is still zero.
    used: AtomicU64,
}

/// Where the room begins.
const START: u64 = 4096;
/// Addresses that are set aside; pages are taken as they are needed.
const MOST: u64 = 1 << 36;
/// Arrays begin at multiples of this.
const ALIGN: u64 = 64;

/// The shared memory as this process sees it.
#[derive(Debug)]
pub(super) struct Memory {
    file: File,
    base: NonNull<u8>,
    /// First free byte.
    top: AtomicU64,
    /// Where room ends, at most [`MOST`].
    end: AtomicU64,
}

// SAFETY: the mapping is plain memory that stays until drop; who writes where follows from `top`, which is atomic.
unsafe impl Send for Memory {}
// SAFETY: see above.
unsafe impl Sync for Memory {}

impl Memory {
    /// New memory of one page, in a file that can only grow, so that nobody can take pages away under the other.
    pub fn new() -> io::Result<Self> {
        // SAFETY: a name that ends with 0.
        let fd = unsafe { libc::memfd_create(c"tenon-plugin".as_ptr(), libc::MFD_CLOEXEC | libc::MFD_ALLOW_SEALING) };
        if fd < 0 {
            return Err(io::Error::last_os_error());
        }
        // SAFETY: it was just made and is nobody else's.
        let file = unsafe { File::from_raw_fd(fd) };
        file.set_len(START)?;
        // SAFETY: takes numbers only.
        if unsafe { libc::fcntl(fd, libc::F_ADD_SEALS, libc::F_SEAL_SHRINK) } < 0 {
            return Err(io::Error::last_os_error());
        }
        Self::of(file)
    }

    /// The memory in a file that the other side made.
    pub fn of(file: File) -> io::Result<Self> {
        if file.metadata()?.len() < START {
            return Err(io::Error::other("there is no shared memory"));
        }
        let (protection, flags) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_SHARED | libc::MAP_NORESERVE);
        // SAFETY: a new mapping at a place of the system's choice; it overlaps nothing.
        let at = unsafe { libc::mmap(std::ptr::null_mut(), MOST as usize, protection, flags, file.as_raw_fd(), 0) };
        let base = (at != libc::MAP_FAILED).then(|| NonNull::new(at.cast())).flatten();
        let base = base.ok_or_else(io::Error::last_os_error)?;
        Ok(Self { file, base, top: AtomicU64::new(START), end: AtomicU64::new(MOST) })
    }

    /// The file, to be handed to the other side.
    pub fn file(&self) -> &File {
        &self.file
    }

    pub fn header(&self) -> &Header {
        // SAFETY: the first page is there in every such file and holds only atomics, for which any bytes are good.
        unsafe { self.base.cast::<Header>().as_ref() }
    }

    /// Frees all room.
    pub fn reset(&self) {
        self.set_top(START);
    }

    /// First free byte.
    pub fn top(&self) -> u64 {
        self.top.load(Ordering::Relaxed)
    }

    pub fn set_top(&self, top: u64) {
        self.top.store(top.clamp(START, MOST), Ordering::Relaxed);
    }

    /// From now on at most `bytes` more are given out.
    pub fn limit(&self, bytes: u64) {
        self.end.store(self.top().saturating_add(bytes).min(MOST), Ordering::Relaxed);
    }

    /// Bytes that the file has grown to.
    pub fn len(&self) -> u64 {
        self.file.metadata().map_or(0, |m| m.len())
    }

    /// Sets room aside; `None` if there is none. O(1) besides the system's work on new pages.
    fn room(&self, bytes: u64) -> Option<u64> {
        let at = self.top().next_multiple_of(ALIGN);
        let end = at.checked_add(bytes).filter(|end| *end <= self.end.load(Ordering::Relaxed))?;
        let there = self.len();
        if end > there {
            // Pages are taken here, where it can be refused, and not when they are touched, where it would be fatal. A
            // quarter more, so that growing by little is not slow.
            let more = (end - there).max(there / 4).next_multiple_of(1 << 20).min(MOST - there);
            // SAFETY: takes numbers only.
            let taken = unsafe { libc::fallocate(self.file.as_raw_fd(), 0, there as i64, more as i64) };
            if taken != 0 {
                return None;
            }
        }
        self.set_top(end);
        Some(at)
    }

    /// Zeroed room as an address. O(bytes) where it was used before.
    pub fn zeroed(&self, bytes: u64) -> Option<NonNull<u8>> {
        let at = self.room(bytes)?;
        let used = self.header().used.fetch_max(at + bytes, Ordering::Relaxed);
        // SAFETY: `room` saw to it that the file reaches so far, and gave it to nobody else.
        unsafe {
            let place = self.base.add(at as usize);
            place.write_bytes(0, used.saturating_sub(at).min(bytes) as usize);
            Some(place)
        }
    }

    /// Where bytes lie in the memory: they are copied there unless they do already. O(bytes) or O(1).
    pub fn place(&self, bytes: &[u8]) -> Option<u64> {
        let inside = (bytes.as_ptr() as usize).checked_sub(self.base.as_ptr() as usize).map(|at| at as u64);
        if let Some(at) = inside.filter(|at| at.checked_add(bytes.len() as u64).is_some_and(|end| end <= MOST)) {
            return Some(at);
        }
        let at = self.room(bytes.len() as u64)?;
        self.header().used.fetch_max(at + bytes.len() as u64, Ordering::Relaxed);
        // SAFETY: `room` saw to it that the file reaches so far, and gave it to nobody else.
        unsafe { self.base.add(at as usize).copy_from_nonoverlapping(NonNull::from(bytes).cast(), bytes.len()) };
        Some(at)
    }

    /// The first of `count` items at `at`, if they lie inside and are aligned.
    fn items<T>(&self, at: u64, count: u64) -> Option<NonNull<T>> {
        let bytes = count.checked_mul(size_of::<T>() as u64)?;
        let good = at >= START
            && at.is_multiple_of(align_of::<T>() as u64)
            && at.checked_add(bytes).is_some_and(|end| end <= self.len().min(MOST));
        // SAFETY: inside the mapping.
        good.then(|| unsafe { self.base.add(at as usize).cast() })
    }

    /// Items where they lie; for the side whose turn it is. `None`: they lie outside.
    pub fn view<T: Pod>(&self, at: u64, count: u64) -> Option<&[T]> {
        let first = self.items::<T>(at, count)?;
        // SAFETY: inside, aligned, of a type that any bytes are good for; the other side waits meanwhile.
        Some(unsafe { std::slice::from_raw_parts(first.as_ptr(), count as usize) })
    }

    /// A copy of items. `None`: they lie outside, or there is no memory. O(count).
    pub fn copy<T: Pod>(&self, at: u64, count: u64) -> Option<Vec<T>> {
        let first = self.items::<T>(at, count)?;
        let mut all = Vec::new();
        all.try_reserve_exact(count as usize).ok()?;
        // SAFETY: inside and aligned, any bytes are good for `T`, and there is room for so many. Bytes that a stray thread
        // over there changes meanwhile are still bytes.
        unsafe {
            first.as_ptr().copy_to_nonoverlapping(all.as_mut_ptr(), count as usize);
            all.set_len(count as usize);
        }
        Some(all)
    }
}

impl Drop for Memory {
    fn drop(&mut self) {
        // SAFETY: mapped by `of`, and nobody borrows from it any more.
        unsafe { libc::munmap(self.base.as_ptr().cast(), MOST as usize) };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_sides_see_the_same_and_nothing_outside() {
        let here = Memory::new().unwrap();
        let there = Memory::of(here.file().try_clone().unwrap()).unwrap();
        let at = here.place(bytemuck::cast_slice(&[1.0f64, 2.0, 3.0])).unwrap();
        assert_eq!(there.view::<f64>(at, 3).unwrap(), [1.0, 2.0, 3.0]);
        // What lies there already is not copied.
        let seen = there.view::<f64>(at, 2).unwrap();
        assert_eq!(there.place(bytemuck::cast_slice(seen)), Some(at));
        for (at, count) in [(0, 1), (at + 1, 1), (at, 1 << 40), (u64::MAX - 7, 1), (at, u64::MAX), (MOST, 1)] {
            assert!(there.view::<f64>(at, count).is_none() && there.copy::<f64>(at, count).is_none(), "{at} {count}");
        }
    }

    #[test]
    fn room_is_zero_again_when_it_is_used_again() {
        let memory = Memory::new().unwrap();
        let before = memory.place(&[7; 5000]).unwrap();
        memory.reset();
        let at = memory.zeroed(6000).unwrap().as_ptr() as u64 - memory.base.as_ptr() as u64;
        assert_eq!(before, at);
        assert!(memory.view::<u8>(at, 6000).unwrap().iter().all(|b| *b == 0));
        memory.limit(100);
        assert!(memory.zeroed(101).is_none() && memory.zeroed(64).is_some());
    }

    #[test]
    fn the_file_cannot_be_cut_short() {
        let memory = Memory::new().unwrap();
        memory.place(&[1; 100]).unwrap();
        assert!(memory.file().set_len(0).is_err());
    }
}
