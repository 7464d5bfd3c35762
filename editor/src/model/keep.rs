//! No work is lost: what is not saved is kept in a file beside the graph, a second after it was done, until it is saved or
//! given up; where nothing can be written beside it, in the state folder. And the other way round: a graph that another
//! program has written is taken as a step.

use super::Model;
use super::file::ENDING;
use super::slot::Slot;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};
use tenon_engine::{Diagnostic, Document, Operation, digest_bytes};
use tenon_nodes::host::output::write_quickly;

/// How often unsaved work is written, and files are looked at: often enough that on a busy machine, too, no second is lost.
const EVERY: Duration = Duration::from_millis(400);

/// Most graphs that are remembered.
const RECENT: usize = 12;

/// What is kept of unsaved work, and what is known of the graph's file.
#[derive(Default)]
pub struct Keeper {
    /// Where unsaved work is written; none if there is no place for it.
    slot: Option<Slot>,
    /// Where it is written instead, in the state folder: the place beside the graph cannot be written, or could not be by a
    /// window before.
    elsewhere: Option<Slot>,
    /// The revision that was written last.
    written: Option<u64>,
    /// When it was, or files were looked at.
    last: Option<Instant>,
    /// Time and length of the graph's file when it was read or written.
    stamp: Stamp,
    /// It was told that work cannot be kept.
    told: bool,
}

/// Time and length of a file, by which a change is noticed.
pub(super) type Stamp = Option<(SystemTime, u64)>;

pub(super) fn stamp(path: &Path) -> Stamp {
    let data = fs::metadata(path).ok()?;
    Some((data.modified().ok()?, data.len()))
}

/// Where a desktop program keeps what it must remember: `$XDG_STATE_HOME/tenon`, by default `~/.local/state/tenon`.
#[must_use]
pub fn state_folder() -> Option<PathBuf> {
    let set = std::env::var_os("XDG_STATE_HOME").map(PathBuf::from).filter(|p| p.is_absolute());
    let home = || std::env::var_os("HOME").map(|h| PathBuf::from(h).join(".local/state"));
    Some(set.or_else(home)?.join("tenon"))
}

impl Model {
    /// The file that unsaved work is kept in; none for a graph without a file where there is no state folder.
    #[must_use]
    pub fn kept_path(&self) -> Option<PathBuf> {
        self.keeper.elsewhere.as_ref().or(self.keeper.slot.as_ref()).map(|s| s.file.clone())
    }

    /// Remembers in a folder from now on: recent graphs, unsaved work of graphs without a file, who works on what.
    pub fn remember_in(&mut self, state: Option<PathBuf>) {
        self.state = state;
        self.take_slot(true);
        self.remember();
    }

    /// Takes a place for unsaved work of the graph that is open; `offer` takes one with work that was left behind, if there
    /// is one: beside the graph, else in the state folder.
    fn take_slot(&mut self, offer: bool) {
        let locks = self.locks();
        let file = match self.canonical() {
            Some(path) => path.file_name().map(|n| path.with_file_name(format!(".{}.unsaved", n.to_string_lossy()))),
            None => self.state.as_ref().map(|s| s.join(format!("unsaved{ENDING}"))),
        };
        (self.keeper.slot, self.keeper.elsewhere) = (None, None);
        self.keeper.slot = file.and_then(|file| Slot::take(&file, locks.as_deref(), offer));
        if offer {
            self.keeper.elsewhere = self.slot_elsewhere(true).filter(|s| s.orphan);
        }
        if self.path().is_some() && self.keeper.slot.as_ref().is_some_and(|s| s.second) {
            let message = "another window has this graph open, too";
            self.message = Some(Diagnostic::error("open-twice", message).hint("the one that is saved last wins"));
        }
    }

    /// The graph's file by the name that all windows call it.
    fn canonical(&self) -> Option<PathBuf> {
        self.path().map(|path| path.canonicalize().unwrap_or_else(|_| path.to_owned()))
    }

    fn locks(&self) -> Option<PathBuf> {
        self.state.as_ref().map(|s| s.join("locks"))
    }

    /// A place in the state folder for unsaved work of a graph that has a file; `offer` as at [`Model::take_slot`].
    fn slot_elsewhere(&self, offer: bool) -> Option<Slot> {
        let name = digest_bytes(self.canonical()?.as_os_str().as_encoded_bytes());
        let file = self.state.as_ref()?.join(format!("unsaved-{name:032x}{ENDING}"));
        Slot::take(&file, self.locks().as_deref(), offer)
    }

    /// The text of unsaved work that an earlier window has left behind.
    #[must_use]
    pub fn left_behind(&self) -> Option<String> {
        let left = [&self.keeper.slot, &self.keeper.elsewhere].into_iter().flatten().filter(|s| s.orphan);
        let texts = left.filter_map(|s| Some((stamp(&s.file)?.0, fs::read_to_string(&s.file).ok()?)));
        let latest = texts.filter(|(_, text)| !text.trim().is_empty()).max_by_key(|(time, _)| *time);
        latest.map(|(_, text)| text).filter(|_| self.keeper.written.is_none())
    }

    /// Takes the work that was left behind, to be saved or undone.
    ///
    /// # Errors
    /// If there is none, or it cannot be read.
    pub fn recover(&mut self) -> Result<(), Diagnostic> {
        let text = self.left_behind().ok_or_else(|| Diagnostic::error("nothing-kept", "no work was left behind"))?;
        let (graph, layout) = super::split_layout(&text);
        let mut document = Document::from_slice(graph.as_bytes())
            .map_err(|all| all.into_iter().next().unwrap_or_else(|| Diagnostic::error("no-graph", "it is no graph")))?;
        if !layout.is_empty() {
            document.read_layout(layout.as_bytes())?;
        }
        self.become_like(document)
    }

    /// Makes the document what another is, as one step.
    pub(super) fn become_like(&mut self, mut document: Document) -> Result<(), Diagnostic> {
        document.migrate(&self.registry);
        let steps = self.document.diff(&document);
        if !steps.is_empty() {
            self.apply_to_whole(Operation::All(steps))?;
        }
        Ok(())
    }

    /// Gives up what is kept of unsaved work, because it was saved or is not wanted.
    pub fn forget_kept(&mut self) {
        for slot in [&mut self.keeper.slot, &mut self.keeper.elsewhere].into_iter().flatten() {
            // If it is not there, nothing is to be forgotten.
            let _ = fs::remove_file(&slot.file);
            // What cannot be taken away is not asked for again, so that what follows is kept.
            slot.orphan = false;
        }
        self.keeper.written = None;
    }

    /// Puts work that was left behind and cannot be read under another name, so that its place is free for what comes; gives why,
    /// with that name.
    #[must_use]
    pub fn put_aside(&mut self, why: Diagnostic) -> Diagnostic {
        let Some(path) = self.kept_path() else { return why };
        let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let free = (1..).map(|i| path.with_file_name(format!("{name}-{i}"))).find(|p| !p.exists());
        let hint = match free.as_ref().map(|to| (to, fs::rename(&path, to))) {
            Some((to, Ok(()))) => format!("it is kept as {}", to.display()),
            _ => format!("it stays in {}, and what is done now cannot be kept", path.display()),
        };
        why.hint(hint)
    }

    /// Notes how the graph's file is now, after reading or writing it; `offer` as at [`Model::take_slot`].
    pub(super) fn note_file(&mut self, offer: bool) {
        // The place of the graph before is given back first.
        self.keeper = Keeper::default();
        self.keeper.stamp = self.path().and_then(stamp);
        self.take_slot(offer);
        self.watch.look_at(self.path().map(|p| (p.to_owned(), self.keeper.stamp)));
    }

    /// Keeps unsaved work and looks whether the graph's file was changed elsewhere; to be called every frame. Gives when
    /// it wants to be called again, if nothing else happens.
    pub fn keep(&mut self) -> Option<Duration> {
        let unsaved = self.seems_unsaved();
        if !unsaved && self.keeper.written.is_some() {
            self.forget_kept();
        }
        let rest = self.keeper.last.map_or(Duration::ZERO, |last| EVERY.saturating_sub(last.elapsed()));
        if !self.watch.noticed() && rest > Duration::ZERO {
            return self.wants_keeping(unsaved).then_some(rest);
        }
        self.keeper.last = Some(Instant::now());
        // What is written or told must be true: that a graph was opened or placed a moment ago makes no work of it.
        let unsaved = self.unsaved();
        self.look_at_file(unsaved);
        if unsaved && self.keeper.written != Some(self.revision()) && self.left_behind().is_none() {
            self.write_kept();
        }
        self.wants_keeping(unsaved).then_some(EVERY)
    }

    /// Whether there is work that is not kept yet.
    fn wants_keeping(&self, unsaved: bool) -> bool {
        unsaved && self.keeper.written != Some(self.revision()) && !self.keeper.told
    }

    fn write_kept(&mut self) {
        let Some(path) = self.kept_path() else { return };
        let document = self.with_typed();
        let text = document.to_string_canonical() + &document.layout_to_string();
        drop(document);
        let mut written = write_quickly(&path, text.as_bytes());
        if written.is_err()
            && self.keeper.elsewhere.is_none()
            && let Some(slot) = self.slot_elsewhere(false)
        {
            written = write_quickly(&slot.file, text.as_bytes());
            self.keeper.elsewhere = Some(slot).filter(|_| written.is_ok());
        }
        match written {
            Ok(()) => self.keeper.written = Some(self.revision()),
            Err(e) if !self.keeper.told => {
                let message = format!("unsaved work cannot be kept: {e}");
                self.message = Some(Diagnostic::error("unwritable", message).hint("save often, or elsewhere"));
                self.keeper.told = true;
            }
            Err(_) => {}
        }
    }

    fn look_at_file(&mut self, unsaved: bool) {
        let Some(path) = self.path().map(Path::to_owned) else { return };
        let now = stamp(&path);
        if now == self.keeper.stamp || now.is_none() {
            return;
        }
        self.keeper.stamp = now;
        let document = match super::file::load(&path) {
            Ok((document, _)) => document,
            Err(why) => {
                let message = format!("another program has written what is no graph into {}", path.display());
                let hint = format!("{}; saving writes over it", why.diagnostic().message);
                self.message = Some(Diagnostic::error("changed-elsewhere", message).hint(hint));
                return;
            }
        };
        let text = document.to_string_canonical_for(&self.registry);
        if text == self.saved.0 {
            // It was looked at while it was being written.
            self.message.take_if(|told| told.code == "changed-elsewhere");
            return;
        }
        if unsaved {
            let message = format!("{} was changed by another program, and here too", path.display());
            self.message =
                Some(Diagnostic::error("changed-elsewhere", message).hint("saving writes over the other change"));
            return;
        }
        let mut document = document;
        for (id, place) in self.document.nodes().keys().filter_map(|id| Some((id, self.document.position(id)?))) {
            // Nodes that are gone there have no place any more.
            let _ = Operation::Move { node: id.clone(), to: Some(place) }.apply(&mut document);
        }
        self.message = match self.become_like(document) {
            Ok(()) => {
                self.saved.0 = text;
                self.compared.0 = self.revision.wrapping_sub(1);
                None
            }
            Err(refused) => Some(refused),
        };
    }

    /// Graphs that were opened before, the last one first.
    #[must_use]
    pub fn recent(&self) -> Vec<PathBuf> {
        let text = self.state.as_ref().and_then(|s| fs::read_to_string(s.join("recent")).ok()).unwrap_or_default();
        text.lines().map(PathBuf::from).filter(|p| p.exists()).collect()
    }

    /// Remembers the graph that is open as the last one.
    pub fn remember(&self) {
        let (Some(state), Some(path)) = (&self.state, self.path().and_then(|p| p.canonicalize().ok())) else { return };
        let others = self.recent().into_iter().filter(|p| *p != path);
        let all: Vec<String> =
            std::iter::once(path.clone()).chain(others).take(RECENT).map(|p| p.display().to_string()).collect();
        // It is no more than a convenience.
        let _ = write_quickly(&state.join("recent"), all.join("\n").as_bytes());
    }
}
