//! The desktop's own windows for files, asked on a thread of their own so that the window never waits for them. Where no
//! desktop answers, the window's own browser does it from then on.

use crate::panels::Browse;
use eframe::egui::Context;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::{Duration, Instant};

/// Nobody says no so soon: there is nobody who could be asked.
const TOO_SOON: Duration = Duration::from_millis(500);

/// What the desktop is asked for.
#[derive(Clone, Debug)]
pub struct Wish {
    /// What the file is for.
    pub what: Browse,
    /// The folder to begin in.
    pub folder: PathBuf,
    /// The name that is proposed.
    pub name: String,
}

/// Who answers.
type Desktop = Arc<dyn Fn(&Wish) -> Option<PathBuf> + Send + Sync>;

/// What came of a question.
pub enum Answer {
    /// Nothing is asked, or nobody has answered yet.
    Nothing,
    /// A file or folder.
    Path(Browse, PathBuf),
    /// Nobody is there to be asked.
    Nobody(Browse),
}

/// A file, if one was chosen, and how long that took.
type Answered = (Option<PathBuf>, Duration);

/// The desktop's windows, of which one is open at most.
#[derive(Default)]
pub struct Dialogs {
    desktop: Option<Desktop>,
    open: Option<(Browse, Receiver<Answered>)>,
}

impl Dialogs {
    /// The windows of the desktop that this runs on, if there can be any.
    #[must_use]
    pub fn of_the_desktop() -> Self {
        if is_there() { Self::answered_by(ask) } else { Self::default() }
    }

    /// Windows that answer so.
    pub fn answered_by(desktop: impl Fn(&Wish) -> Option<PathBuf> + Send + Sync + 'static) -> Self {
        Self { desktop: Some(Arc::new(desktop)), open: None }
    }

    /// Whether there is somebody to be asked.
    #[must_use]
    pub fn are_there(&self) -> bool {
        self.desktop.is_some()
    }

    /// Asks for a file; false if nobody is there. While one window is open, no other is opened.
    pub fn ask(&mut self, ctx: &Context, wish: Wish) -> bool {
        let Some(desktop) = self.desktop.clone() else { return false };
        if self.open.is_some() {
            return true;
        }
        let (tell, answer) = channel();
        let (ctx, what) = (ctx.clone(), wish.what.clone());
        let asked = std::thread::Builder::new().name("file dialog".into()).spawn(move || {
            let begun = Instant::now();
            let answer = desktop(&wish);
            // Nobody listens any more once the window is closed.
            let _ = tell.send((answer, begun.elapsed()));
            ctx.request_repaint();
        });
        if asked.is_ok() {
            self.open = Some((what, answer));
        }
        asked.is_ok()
    }

    /// What has been answered; never waits.
    pub fn answer(&mut self) -> Answer {
        let Some((what, answer)) = self.open.take() else { return Answer::Nothing };
        match answer.try_recv() {
            Ok((Some(path), _)) => Answer::Path(what, path),
            Ok((None, took)) if took >= TOO_SOON => Answer::Nothing,
            Ok((None, _)) | Err(TryRecvError::Disconnected) => {
                self.desktop = None;
                Answer::Nobody(what)
            }
            Err(TryRecvError::Empty) => {
                self.open = Some((what, answer));
                Answer::Nothing
            }
        }
    }
}

/// Whether a desktop can be there: on Linux its portal is reached over the session's bus.
fn is_there() -> bool {
    if !cfg!(target_os = "linux") {
        return true;
    }
    let named = std::env::var_os("DBUS_SESSION_BUS_ADDRESS").is_some_and(|a| !a.is_empty());
    named || std::env::var_os("XDG_RUNTIME_DIR").is_some_and(|dir| Path::new(&dir).join("bus").exists())
}

/// Shows the desktop's window and waits for it.
fn ask(wish: &Wish) -> Option<PathBuf> {
    let mut dialog = rfd::FileDialog::new().set_title(wish.what.words().0).set_directory(&wish.folder);
    if !wish.name.is_empty() {
        dialog = dialog.set_file_name(&wish.name);
    }
    let endings: Vec<&str> = wish.what.endings().iter().map(|e| e.trim_start_matches('.')).collect();
    if !endings.is_empty() {
        dialog = dialog.add_filter(endings.join(", "), &endings);
    }
    match &wish.what {
        Browse::Export => dialog.pick_folder(),
        what if what.writes() => dialog.save_file(),
        _ => dialog.pick_file(),
    }
}
