//! Notices that another program has written the graph's file, also while the window rests: a thread looks at the file's
//! time and length now and then, which costs a few microseconds, and wakes the window once for each change.

use super::keep::{Stamp, stamp};
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{RecvTimeoutError, Sender, channel};
use std::time::Duration;

/// How often it is looked at.
const EVERY: Duration = Duration::from_secs(1);

/// The thread that looks. It ends when this is dropped.
pub struct Watch {
    files: Sender<Option<(PathBuf, Stamp)>>,
    noticed: Arc<AtomicBool>,
}

impl Watch {
    /// Starts the thread; `wake` is called from it when a file has changed.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn start(wake: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let (files, inbox) = channel::<Option<(PathBuf, Stamp)>>();
        let noticed = Arc::new(AtomicBool::new(false));
        let flag = noticed.clone();
        std::thread::Builder::new().name("watch".into()).spawn(move || {
            let mut file = None;
            loop {
                // With nothing to look at it only waits to be told.
                let told = match &file {
                    None => inbox.recv().map_err(|_| RecvTimeoutError::Disconnected),
                    Some(_) => inbox.recv_timeout(EVERY),
                };
                match told {
                    Ok(other) => file = other,
                    Err(RecvTimeoutError::Disconnected) => return,
                    Err(RecvTimeoutError::Timeout) => {
                        let Some((path, known)) = &mut file else { continue };
                        let now = stamp(path);
                        if now != *known {
                            *known = now;
                            flag.store(true, Ordering::SeqCst);
                            wake();
                        }
                    }
                }
            }
        })?;
        Ok(Self { files, noticed })
    }

    /// The file that is looked at from now on, and how it is known.
    pub fn look_at(&self, file: Option<(PathBuf, Stamp)>) {
        self.noticed.store(false, Ordering::SeqCst);
        // It fails only if the thread has ended, and then nothing is noticed any more.
        let _ = self.files.send(file);
    }

    /// Whether a change was noticed since this was asked last.
    pub fn noticed(&self) -> bool {
        self.noticed.swap(false, Ordering::SeqCst)
    }
}
