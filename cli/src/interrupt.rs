//! Ctrl-C: the first one asks the evaluation to stop, the second one stops the program.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of a program ended by Ctrl-C, as shells know it.
pub const INTERRUPTED: u8 = 130;

/// A flag that turns true at the first Ctrl-C. Files get their names by renaming, so the second one may end the program
/// at any moment without leaving one half-written.
pub fn flag() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    let seen = flag.clone();
    // Fails only if a handler is set already or the system has none; then Ctrl-C ends the program as it always does.
    let _ = ctrlc::set_handler(move || {
        if seen.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(INTERRUPTED));
        }
    });
    flag
}
