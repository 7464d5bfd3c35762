//! Memory that a plugin may read and nothing else: every array on pages of its own that cannot be written to, if wished with
//! a page behind that cannot be read either. So a write is noticed when it happens, also one that is undone.
//!
//! On systems without such pages what was lent is compared with what it was.

/// Where what is lent begins on its pages.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Behind {
    /// It ends where its pages end, and what lies behind cannot be read.
    Nothing,
    /// Zeros follow to the end of a page.
    Zeros,
}

/// What a plugin did with the pages.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Touched {
    /// It wrote to one.
    pub written: bool,
    /// It read or wrote behind one.
    pub passed: bool,
}

#[cfg(unix)]
pub(super) use guarded::Pages;
#[cfg(not(unix))]
pub(super) use plain::Pages;

#[cfg(unix)]
mod guarded {
    use super::{Behind, Touched};
    use std::alloc::{Layout, handle_alloc_error};
    use std::ffi::c_void;
    use std::mem::{MaybeUninit, transmute};
    use std::ptr::null_mut;
    use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicU32, Ordering};
    use std::sync::{Mutex, MutexGuard, PoisonError};

    /// One array's pages.
    struct Mapping {
        start: usize,
        /// Bytes that can be read.
        open: usize,
        /// All bytes, the page behind included.
        length: usize,
        /// How often the plugin did what it must not; it may go on since the first time.
        forced: AtomicU32,
        next: *const Mapping,
    }

    /// The mappings that the handler knows, the newest first.
    static NEWEST: AtomicPtr<Mapping> = AtomicPtr::new(null_mut());
    static WRITTEN: AtomicBool = AtomicBool::new(false);
    static PASSED: AtomicBool = AtomicBool::new(false);
    /// What handled each signal before; null while there are no pages.
    static BEFORE: [AtomicPtr<libc::sigaction>; 2] = [const { AtomicPtr::new(null_mut()) }; 2];
    /// Threads that may meet one array at the same moment, each with a signal of its own. Beyond that it is a fault that
    /// comes again and again.
    const AT_ONCE: u32 = 64;
    /// Signals have one handler in a process, so there are pages for one evaluation at a time.
    static TURN: Mutex<()> = Mutex::new(());

    /// What systems say when memory is touched that must not be: most the first, macOS the second.
    const SIGNALS: [libc::c_int; 2] = [libc::SIGSEGV, libc::SIGBUS];

    /// Read-only memory for one evaluation. While it lives, signals about it are heard; others go to whoever heard them before,
    /// or end the process if nobody did.
    pub(in super::super) struct Pages {
        behind: Behind,
        page: usize,
        /// Each of a box, which the handler knows too.
        mappings: Vec<*mut Mapping>,
        before: Box<[libc::sigaction; 2]>,
        _turn: MutexGuard<'static, ()>,
    }

    /// Notes what was touched and lets the plugin go on, so that every node is tried in one process.
    extern "C" fn touched(signal: libc::c_int, info: *mut libc::siginfo_t, context: *mut c_void) {
        // SAFETY: the system gives the information with the signal.
        let address = unsafe { (*info).si_addr() }.addr();
        let mut at: *const Mapping = NEWEST.load(Ordering::Acquire);
        // SAFETY: mappings are taken off the list before they go, and what leads to the next never changes.
        while let Some(mapping) = unsafe { at.as_ref() } {
            let inside = address.wrapping_sub(mapping.start);
            if inside < mapping.length && mapping.forced.fetch_add(1, Ordering::Relaxed) < AT_ONCE {
                let flag = if inside < mapping.open { &WRITTEN } else { &PASSED };
                flag.store(true, Ordering::Relaxed);
                let (start, all) = (std::ptr::with_exposed_provenance_mut(mapping.start), mapping.length);
                // SAFETY: a whole mapping of our own, which nobody here holds as a slice meanwhile.
                if unsafe { libc::mprotect(start, all, libc::PROT_READ | libc::PROT_WRITE) } == 0 {
                    return;
                }
            }
            at = mapping.next;
        }
        let known = SIGNALS.iter().position(|s| *s == signal);
        let before = known.map_or(null_mut(), |i| BEFORE[i].load(Ordering::Acquire));
        // SAFETY: null, or an action that the system gave and that is there as long as the pages are; the rest came with
        // the signal.
        unsafe { elsewhere(signal, info, context, before) };
    }

    /// Somebody else's: whoever handled it before does so now, and the pages stay watched. If nobody did, it is met again
    /// when this returns, as it was before there were pages.
    ///
    /// # Safety
    /// `before` is null or how the signal was handled before, and the rest what the system gave with it.
    unsafe fn elsewhere(
        signal: libc::c_int,
        info: *mut libc::siginfo_t,
        context: *mut c_void,
        before: *const libc::sigaction,
    ) {
        // SAFETY: as the caller vouches; an action is the address of a function of the form that its flags say, but for two.
        unsafe {
            match before.as_ref() {
                // The pages come or go at this moment, and with them the handler.
                None => {}
                Some(action) if [libc::SIG_DFL, libc::SIG_IGN].contains(&action.sa_sigaction) => {
                    libc::sigaction(signal, before, null_mut());
                }
                Some(action) => {
                    let handler = std::ptr::with_exposed_provenance::<c_void>(action.sa_sigaction);
                    if action.sa_flags & libc::SA_SIGINFO == 0 {
                        transmute::<*const c_void, extern "C" fn(libc::c_int)>(handler)(signal);
                    } else {
                        type Told = extern "C" fn(libc::c_int, *mut libc::siginfo_t, *mut c_void);
                        transmute::<*const c_void, Told>(handler)(signal, info, context);
                    }
                }
            }
        }
    }

    impl Pages {
        /// No memory yet. Waits while another evaluation has its pages.
        pub fn new(behind: Behind) -> Self {
            let turn = TURN.lock().unwrap_or_else(PoisonError::into_inner);
            WRITTEN.store(false, Ordering::Relaxed);
            PASSED.store(false, Ordering::Relaxed);
            let before = Box::new(SIGNALS.map(|signal| {
                let mut before = MaybeUninit::<libc::sigaction>::zeroed();
                // SAFETY: zeros are an action, and the handler has the form that SA_SIGINFO asks for.
                unsafe {
                    let mut action: libc::sigaction = MaybeUninit::zeroed().assume_init();
                    action.sa_sigaction =
                        touched as extern "C" fn(libc::c_int, *mut libc::siginfo_t, *mut c_void) as usize;
                    action.sa_flags = libc::SA_SIGINFO | libc::SA_ONSTACK;
                    libc::sigaction(signal, &raw const action, before.as_mut_ptr());
                    before.assume_init()
                }
            }));
            for (place, before) in BEFORE.iter().zip(&*before) {
                place.store(std::ptr::from_ref(before).cast_mut(), Ordering::Release);
            }
            // SAFETY: it takes a number only.
            let page = usize::try_from(unsafe { libc::sysconf(libc::_SC_PAGESIZE) }).unwrap_or(4096);
            Self { behind, page, mappings: Vec::new(), before, _turn: turn }
        }

        /// A copy of as many bytes that can only be read. It is aligned to 8 if something may be read behind it, and otherwise
        /// as far as their number is. O(bytes).
        ///
        /// # Safety
        /// They are there.
        pub unsafe fn lend(&mut self, from: *const u8, bytes: usize) -> *const u8 {
            // SAFETY: as the caller vouches.
            let (at, mapping) = unsafe { self.map(from, bytes) };
            self.mappings.push(mapping);
            at
        }

        /// The same for ever.
        ///
        /// # Safety
        /// As [`Pages::lend`].
        pub unsafe fn keep(&mut self, from: *const u8, bytes: usize) -> *const u8 {
            // SAFETY: as the caller vouches.
            unsafe { self.map(from, bytes).0 }
        }

        /// # Safety
        /// As [`Pages::lend`].
        unsafe fn map(&self, from: *const u8, bytes: usize) -> (*const u8, *mut Mapping) {
            let open = bytes.max(1).next_multiple_of(self.page);
            let length = open + if self.behind == Behind::Nothing { self.page } else { 0 };
            let (protection, flags) = (libc::PROT_READ | libc::PROT_WRITE, libc::MAP_PRIVATE | libc::MAP_ANON);
            // SAFETY: fresh pages, of which nobody knows yet.
            let start = unsafe { libc::mmap(null_mut(), length, protection, flags, -1, 0) };
            if start == libc::MAP_FAILED {
                handle_alloc_error(Layout::from_size_align(length, self.page).unwrap_or(Layout::new::<u8>()));
            }
            let skip = if self.behind == Behind::Nothing { open - bytes } else { 0 };
            // SAFETY: inside the fresh pages; what is copied is there, as the caller vouches.
            let at = unsafe {
                let at = start.cast::<u8>().add(skip);
                at.copy_from_nonoverlapping(from, bytes);
                let closed = libc::mprotect(start, open, libc::PROT_READ) == 0
                    && (length == open || libc::mprotect(start.byte_add(open), length - open, libc::PROT_NONE) == 0);
                assert!(closed, "the system does not close pages: {}", std::io::Error::last_os_error());
                at
            };
            let start = start.expose_provenance();
            let next = NEWEST.load(Ordering::Relaxed);
            let mapping = Mapping { start, open, length, forced: AtomicU32::new(0), next };
            let mapping = Box::into_raw(Box::new(mapping));
            NEWEST.store(mapping, Ordering::Release);
            (at, mapping)
        }

        /// What was done with what is lent, up to now.
        pub fn touched(&self) -> Touched {
            Touched { written: WRITTEN.load(Ordering::Relaxed), passed: PASSED.load(Ordering::Relaxed) }
        }
    }

    impl Drop for Pages {
        fn drop(&mut self) {
            for (signal, before) in SIGNALS.iter().zip(&*self.before) {
                // SAFETY: what the system gave.
                unsafe { libc::sigaction(*signal, before, null_mut()) };
            }
            BEFORE.iter().for_each(|place| place.store(null_mut(), Ordering::Release));
            NEWEST.store(null_mut(), Ordering::Release);
            for mapping in &self.mappings {
                // SAFETY: our own box, and our own pages, which nobody may look at any more.
                unsafe {
                    let mapping = Box::from_raw(*mapping);
                    libc::munmap(std::ptr::with_exposed_provenance_mut(mapping.start), mapping.length);
                }
            }
        }
    }
}

#[cfg(not(unix))]
mod plain {
    use super::{Behind, Touched};

    /// What was lent, beside what it was.
    pub(in super::super) struct Pages(Vec<(Vec<u64>, Vec<u64>)>);

    impl Pages {
        /// No memory yet.
        pub fn new(_: Behind) -> Self {
            Self(Vec::new())
        }

        /// A copy of as many bytes, aligned to 8. O(bytes).
        ///
        /// # Safety
        /// They are there.
        pub unsafe fn lend(&mut self, from: *const u8, bytes: usize) -> *const u8 {
            let mut copy = vec![0_u64; bytes.div_ceil(8).max(1)];
            let at = copy.as_mut_ptr().cast::<u8>();
            // SAFETY: there is room, and as the caller vouches.
            unsafe { at.copy_from_nonoverlapping(from, bytes) };
            self.0.push((copy.clone(), copy));
            self.0.last().map_or(at, |(now, _)| now.as_ptr().cast())
        }

        /// The same for ever.
        ///
        /// # Safety
        /// As [`Pages::lend`].
        pub unsafe fn keep(&mut self, from: *const u8, bytes: usize) -> *const u8 {
            // SAFETY: as the caller vouches.
            let at = unsafe { self.lend(from, bytes) };
            self.0.pop().map(|(now, _)| Box::leak(now.into_boxed_slice()));
            at
        }

        /// What was done with what is lent, as far as it shows. O(bytes).
        pub fn touched(&self) -> Touched {
            Touched { written: self.0.iter().any(|(now, was)| now != was), passed: false }
        }
    }
}

#[cfg(all(test, unix, not(miri)))]
mod tests {
    use super::*;

    fn lend(pages: &mut Pages, bytes: &[u8]) -> *const u8 {
        // SAFETY: a slice is there.
        unsafe { pages.lend(bytes.as_ptr(), bytes.len()) }
    }

    /// Whether this is the process of one test alone, which is started otherwise: a process has one handler of signals, and
    /// other tests (of loom) set theirs.
    fn alone(test: &str) -> bool {
        if std::env::var_os("TENON_TEST_ALONE").is_some() {
            return true;
        }
        let child = std::process::Command::new(std::env::current_exe().unwrap())
            .args(["--exact", &format!("check::pages::tests::{test}")])
            .env("TENON_TEST_ALONE", "1")
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&child.stdout);
        assert!(child.status.success() && told.contains("1 passed"), "{child:?}");
        false
    }

    #[test]
    fn writes_are_noticed_also_when_they_are_undone() {
        if !alone("writes_are_noticed_also_when_they_are_undone") {
            return;
        }
        let mut pages = Pages::new(Behind::Zeros);
        let (numbers, others) = (lend(&mut pages, &[1, 2, 3]), lend(&mut pages, &[4, 5, 6]));
        // SAFETY: lent above; that it cannot be written to is what is tried.
        unsafe {
            assert_eq!((*numbers, *others.add(2), *numbers.add(3)), (1, 6, 0));
            assert_eq!(pages.touched(), Touched::default());
            let at = others.cast_mut();
            at.write_volatile(7);
            at.write_volatile(4);
            assert_eq!(at.read_volatile(), 4);
        }
        assert_eq!(pages.touched(), Touched { written: true, passed: false });
        drop(pages);
        assert_eq!(Pages::new(Behind::Zeros).touched(), Touched::default());
    }

    /// Each gets a signal of its own if none was handled before the others met theirs.
    #[test]
    fn many_threads_may_touch_one_array_at_once() {
        if !alone("many_threads_may_touch_one_array_at_once") {
            return;
        }
        struct At(*mut u8);
        // SAFETY: memory that any thread may touch.
        unsafe impl Sync for At {}
        for _ in 0..200 {
            let mut pages = Pages::new(Behind::Zeros);
            let at = At(lend(&mut pages, &[0; 64]).cast_mut());
            let (at, ready) = (&at, std::sync::Barrier::new(8));
            std::thread::scope(|scope| {
                for i in 0..8 {
                    let ready = &ready;
                    scope.spawn(move || {
                        ready.wait();
                        // SAFETY: lent above; that it cannot be written to is what is tried.
                        unsafe { at.0.add(i).write_volatile(1) };
                    });
                }
            });
            assert_eq!(pages.touched(), Touched { written: true, passed: false });
        }
    }

    /// A fault elsewhere goes to whoever handled such before, and what is lent is watched afterwards as before.
    #[test]
    fn the_faults_of_others_are_handled_as_before() {
        use std::sync::atomic::{AtomicPtr, AtomicUsize, Ordering};
        static ELSEWHERE: AtomicPtr<libc::c_void> = AtomicPtr::new(std::ptr::null_mut());
        static HEARD: AtomicUsize = AtomicUsize::new(0);
        fn close(protection: libc::c_int) {
            // SAFETY: a page of this test.
            unsafe { libc::mprotect(ELSEWHERE.load(Ordering::Relaxed), 1, protection) };
        }
        extern "C" fn open(_: libc::c_int) {
            HEARD.fetch_add(1, Ordering::Relaxed);
            close(libc::PROT_READ | libc::PROT_WRITE);
        }
        extern "C" fn open_told(signal: libc::c_int, info: *mut libc::siginfo_t, context: *mut libc::c_void) {
            // SAFETY: the system gives the information with the signal.
            let at = unsafe { (*info).si_addr() };
            if at == ELSEWHERE.load(Ordering::Relaxed) && !context.is_null() {
                open(signal);
            }
        }
        if !alone("the_faults_of_others_are_handled_as_before") {
            return;
        }
        let told = open_told as extern "C" fn(libc::c_int, *mut libc::siginfo_t, *mut libc::c_void) as usize;
        let handlers = [(open as extern "C" fn(libc::c_int) as usize, 0), (told, libc::SA_SIGINFO)];
        // SAFETY: a fresh page, handlers of the form that the flags say, and what is lent; that neither can be written to is
        // what is tried.
        unsafe {
            let page = libc::mmap(std::ptr::null_mut(), 1, libc::PROT_NONE, libc::MAP_PRIVATE | libc::MAP_ANON, -1, 0);
            assert_ne!(page, libc::MAP_FAILED);
            ELSEWHERE.store(page, Ordering::Relaxed);
            for (handler, flags) in handlers {
                HEARD.store(0, Ordering::Relaxed);
                for signal in [libc::SIGSEGV, libc::SIGBUS] {
                    let mut action: libc::sigaction = std::mem::zeroed();
                    (action.sa_sigaction, action.sa_flags) = (handler, flags);
                    libc::sigaction(signal, &raw const action, std::ptr::null_mut());
                }
                let mut pages = Pages::new(Behind::Zeros);
                let lent = lend(&mut pages, &[1, 2, 3]).cast_mut();
                for times in 1..3 {
                    close(libc::PROT_NONE);
                    page.cast::<u8>().write_volatile(1);
                    assert_eq!((HEARD.load(Ordering::Relaxed), pages.touched()), (times, Touched::default()));
                }
                lent.write_volatile(1);
                assert_eq!((HEARD.load(Ordering::Relaxed), pages.touched().written), (2, true));
            }
        }
    }

    #[test]
    fn reading_behind_an_array_is_noticed() {
        if !alone("reading_behind_an_array_is_noticed") {
            return;
        }
        let mut pages = Pages::new(Behind::Nothing);
        let words = lend(&mut pages, &[1; 24]);
        assert!(words.addr().is_multiple_of(8));
        // SAFETY: the first is lent; that the second cannot be read is what is tried.
        unsafe {
            assert_eq!(words.add(23).read_volatile(), 1);
            assert_eq!(pages.touched(), Touched::default());
            words.add(24).read_volatile();
        }
        assert_eq!(pages.touched(), Touched { written: false, passed: true });
    }
}
