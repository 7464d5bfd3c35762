//! Keys that mean the same everywhere in the window.

use super::files::Leave;
use super::{App, Side};
use crate::panels::{Browse, Tab};
use eframe::egui::{self, Key, KeyboardShortcut, Modifiers, Ui};
use tenon_engine::NodeState;

pub(super) const fn command(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND, key)
}

const fn with_shift(key: Key) -> KeyboardShortcut {
    KeyboardShortcut::new(Modifiers::COMMAND.plus(Modifiers::SHIFT), key)
}

pub(super) const UNDO: KeyboardShortcut = command(Key::Z);
pub(super) const REDO: KeyboardShortcut = command(Key::Y);
pub(super) const REDO_TOO: KeyboardShortcut = with_shift(Key::Z);
pub(super) const SAVE: KeyboardShortcut = command(Key::S);
pub(super) const SAVE_AS: KeyboardShortcut = with_shift(Key::S);
pub(super) const OPEN: KeyboardShortcut = command(Key::O);
pub(super) const NEW: KeyboardShortcut = command(Key::N);
pub(super) const ALL: KeyboardShortcut = command(Key::A);
pub(super) const DUPLICATE: KeyboardShortcut = command(Key::D);
pub(super) const GROUP: KeyboardShortcut = command(Key::G);
pub(super) const UNGROUP: KeyboardShortcut = with_shift(Key::G);
pub(super) const CLUSTER: KeyboardShortcut = command(Key::K);
pub(super) const EXPLODE: KeyboardShortcut = with_shift(Key::K);
pub(super) const PREVIEW: KeyboardShortcut = command(Key::Q);
pub(super) const ENABLE: KeyboardShortcut = command(Key::E);
pub(super) const FREEZE: KeyboardShortcut = with_shift(Key::E);

/// What Alt and a number opens below the canvas.
pub(super) const BELOW: [(Key, Tab); 4] =
    [(Key::Num1, Tab::Problems), (Key::Num2, Tab::Profile), (Key::Num3, Tab::Data), (Key::Num4, Tab::Pieces)];

/// What Alt and a number shows beside it.
pub(super) const BESIDE: [(Key, Side); 2] = [(Key::Num5, Side::Space), (Key::Num6, Side::Boards)];

impl App {
    /// Keys that mean the same everywhere in the window, unless somebody types.
    pub(super) fn keys(&mut self, ui: &Ui) {
        if self.asks() {
            return;
        }
        let pressed = |keys| ui.input_mut(|i| i.consume_shortcut(&keys));
        if pressed(SAVE_AS) {
            self.browse(ui.ctx(), Browse::Save);
        } else if pressed(SAVE) {
            self.save(ui.ctx(), None);
        }
        if pressed(OPEN) {
            self.browse(ui.ctx(), Browse::Open);
        }
        if pressed(NEW) {
            self.leave(ui, Leave::New);
        }
        if ui.input(|i| i.key_pressed(Key::F1)) {
            self.help = !self.help;
        }
        let escape = ui.input(|i| i.key_pressed(Key::Escape));
        if escape && self.grip.drags && !self.canvas.is_dragging() {
            self.model.abort();
        }
        let drags = self.canvas.is_dragging() || ui.ctx().dragged_id().is_some();
        if drags || ui.ctx().egui_wants_keyboard_input() || self.canvas.is_typing() {
            return;
        }
        if pressed(REDO_TOO) || pressed(REDO) {
            self.model.redo();
        } else if pressed(UNDO) {
            self.model.undo();
        }
        if pressed(ALL) {
            self.model.selection = self.model.document().nodes().keys().cloned().collect();
        }
        if pressed(DUPLICATE) && !self.model.selection.is_empty() {
            self.model.message = self.model.duplicate([40.0, 40.0]).err();
        }
        if pressed(UNGROUP) {
            self.ungroup();
        } else if pressed(GROUP) {
            self.group();
        }
        if pressed(EXPLODE) {
            self.explode();
        } else if pressed(CLUSTER) && !self.model.selection.is_empty() {
            self.model.message = self.model.gather().err();
        }
        self.canvas_keys(ui);
        self.view_keys(ui);
        if pressed(PREVIEW) {
            self.model.toggle_preview();
        }
        if pressed(FREEZE) {
            self.model.toggle_state(NodeState::Frozen);
        } else if pressed(ENABLE) {
            self.model.toggle_state(NodeState::Disabled);
        }
        if ui.input(|i| i.modifiers.alt && i.key_pressed(Key::ArrowLeft)) && !self.model.trail().is_empty() {
            self.model.leave_to(self.model.trail().len() - 1);
            self.canvas.opened();
        }
        if ui.input(|i| i.modifiers.is_none() && i.key_pressed(Key::Enter))
            && let (1, Some(id)) = (self.model.selection.len(), self.model.selection.first().cloned())
            && self.model.document().nodes().get(&id).is_some_and(|n| n.cluster().is_some())
        {
            match self.model.enter(&id) {
                Ok(()) => self.canvas.opened(),
                Err(e) => self.model.message = Some(e),
            }
        }
        if ui.input(|i| i.key_pressed(Key::Delete) || i.key_pressed(Key::Backspace)) {
            self.model.delete_selection();
        }
        if escape && !self.grip.waits && !self.model.cancel() {
            self.model.selection.clear();
        }
        if ui.input(|i| i.key_pressed(Key::F5)) {
            self.model.again();
        }
        for event in ui.input(|i| i.events.clone()) {
            match event {
                egui::Event::Copy => self.copy(ui),
                egui::Event::Cut => {
                    self.copy(ui);
                    self.model.delete_selection();
                }
                egui::Event::Paste(text) => self.paste(ui, &text),
                _ => {}
            }
        }
    }

    /// Keys of the canvas: finding nodes, those there may be and those there are, naming, moving, selecting along wires, showing all.
    fn canvas_keys(&mut self, ui: &Ui) {
        let plain = |key| ui.input(|i| i.modifiers.is_none() && i.key_pressed(key));
        if plain(Key::F4) || ui.input(|i| i.modifiers.command_only() && i.key_pressed(Key::Space)) {
            self.canvas.open_finder(ui);
        }
        if plain(Key::F3) {
            self.canvas.open_search();
        }
        if plain(Key::F2) {
            self.canvas.rename(&self.model);
        }
        if plain(Key::F) && self.canvas.pointer(ui).is_some() || plain(Key::Home) {
            if plain(Key::Home) {
                self.model.selection.clear();
            }
            self.canvas.show_all();
        }
        let along = |key| ui.input_mut(|i| i.consume_key(Modifiers::COMMAND, key));
        if along(Key::ArrowLeft) {
            self.model.select_along(false);
        } else if along(Key::ArrowRight) {
            self.model.select_along(true);
        }
        let arrows = [
            (Key::ArrowLeft, [-1.0, 0.0]),
            (Key::ArrowRight, [1.0, 0.0]),
            (Key::ArrowUp, [0.0, -1.0]),
            (Key::ArrowDown, [0.0, 1.0]),
        ];
        for (key, way) in arrows {
            let step = match ui.input(|i| (i.key_pressed(key), i.modifiers)) {
                (true, m) if m.is_none() => 10.0,
                (true, m) if m.shift_only() => 1.0,
                _ => continue,
            };
            self.model.nudge(way.map(|w| w * step));
        }
    }

    /// Keys that open what stands below the canvas and beside it.
    fn view_keys(&mut self, ui: &Ui) {
        let with_alt = |key| ui.input_mut(|i| i.consume_key(Modifiers::ALT, key));
        for (key, tab) in BELOW {
            if with_alt(key) {
                self.lower.toggle(tab);
            }
        }
        for (key, side) in BESIDE {
            if with_alt(key) {
                self.side = side;
            }
        }
    }

    /// Puts what is in the clipboard where the pointer is.
    fn paste(&mut self, ui: &Ui, text: &str) {
        let at = self.canvas.pointer(ui);
        self.model.message = self.model.paste(text, at).err();
    }

    pub(super) fn ungroup(&mut self) {
        if let Some(operation) = crate::canvas::ungroup(&self.model) {
            self.model.edit(operation);
        }
    }

    /// Takes the selected instances of clusters apart.
    pub(super) fn explode(&mut self) {
        let nodes = self.model.document().nodes();
        let is_instance = |id: &&String| nodes.get(*id).is_some_and(|n| n.cluster().is_some());
        let all: Vec<String> = self.model.selection.iter().filter(is_instance).cloned().collect();
        self.model.begin();
        for id in all {
            if let Err(refused) = self.model.explode(&id) {
                self.model.message = Some(refused);
            }
        }
        self.model.end();
    }
}
