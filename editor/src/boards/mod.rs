//! The boards: parts where they lie, seen from above or in space, and the player that moves the tool through them.

mod carve;
mod draw;
mod player;
mod space;

use crate::canvas::View;
use crate::model::Model;
use crate::model::beside::Beside;
use crate::model::cut::{Boards, boards, faults, missing, programs};
use crate::model::play::{Now, Play};
use crate::theme::Theme;
use crate::viewport::Picked;
use carve::{Carved, Carver, Moment};
use draw::Draw;
pub use draw::kind_colour;
use eframe::egui::{
    self, Color32, Context, Id, Key, Rect, Sense, TextureHandle, TextureOptions, Ui, WidgetInfo, WidgetType, pos2,
};
use player::Player;
use space::Space;
use std::collections::BTreeSet;
use std::sync::Arc;
use tenon_geometry::DVec2;

/// The view of the boards.
#[derive(Default)]
pub struct BoardView {
    view: View,
    /// The room that all boards were fitted into: they are fitted again if it changes, until somebody moves the view.
    fitted: Option<Rect>,
    moved: bool,
    found: Option<Boards>,
    looks: u64,
    /// The programs as steps, read beside the window.
    plays: Beside<Vec<Play>>,
    /// The nodes whose layout and programs were shown last: they stay until others are selected.
    last: [Option<String>; 2],
    /// For which results `found` is, and with what selected.
    of: Option<(u64, BTreeSet<String>)>,
    /// The player.
    pub player: Player,
    carver: Option<Carver>,
    /// The board as far as it is cut, and its picture with the state that it is of.
    carved: Carved,
    picture: Option<(u64, TextureHandle)>,
    space: Space,
}

impl BoardView {
    /// After another graph was opened.
    pub fn opened(&mut self) {
        *self = Self { looks: self.looks + 1, ..Self::default() };
    }

    /// Number of boards that are seen.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.found.as_ref().map_or(0, |b| b.layout.boards)
    }

    /// The layout that is seen, with its parts.
    #[must_use]
    pub fn found(&self) -> Option<&Boards> {
        self.found.as_ref()
    }

    /// Counts what was looked for.
    #[must_use]
    pub fn looks(&self) -> u64 {
        self.looks
    }

    /// The programs that can be played.
    #[must_use]
    pub fn plays(&self) -> &[Play] {
        self.plays.last().map_or(&[], |p| p.as_slice())
    }

    /// Where the tool is; none before anything was played.
    #[must_use]
    pub fn now(&self) -> Option<(&Play, Now)> {
        self.player.now(self.plays())
    }

    /// Along what the grain of the boards that are seen runs.
    #[must_use]
    pub fn grain(&self) -> Option<DVec2> {
        self.found.as_ref()?.grain
    }

    /// The board as far as it is cut.
    #[must_use]
    pub fn carved(&self) -> &Carved {
        &self.carved
    }

    /// Whether nothing is on its way from other threads.
    #[must_use]
    pub fn settled(&self) -> bool {
        self.plays.settled() && self.carver.as_ref().is_none_or(Carver::settled)
    }

    /// Takes what was made beside the window, also while this is not shown.
    pub fn poll(&mut self) {
        self.plays.poll();
    }

    /// Finds boards and programs, if the results have changed.
    pub fn look(&mut self, ctx: &Context, model: &Model) {
        let same = |(count, selection): &(u64, BTreeSet<String>)| {
            *count == model.results.count && *selection == model.selection
        };
        if self.of.as_ref().is_some_and(same) && self.plays.settled() {
            return;
        }
        self.of = Some((model.results.count, model.selection.clone()));
        self.looks += 1;
        let [layout, program] = &mut self.last;
        let found = boards(model, layout.as_deref());
        if let Some(found) = &found
            && layout.as_ref() != Some(&found.node)
        {
            // Programs of other boards are none of these.
            self.plays.forget();
            *layout = Some(found.node.clone());
        }
        let programs = found.as_ref().and_then(|b| programs(model, &b.node, program.as_deref()));
        if let Some(found) = &programs {
            *program = Some(found.node.clone());
        }
        self.player.faults = programs.as_ref().map(|p| faults(model, &p.node)).unwrap_or_default();
        self.found = found;
        match programs {
            Some(found) => {
                let wake = ctx.clone();
                let read = move || found.all.iter().map(|q| Play::new(q, &found.machine)).collect();
                self.plays.want(found.digest, move || wake.request_repaint(), read);
            }
            None => self.plays.forget(),
        }
    }

    /// Keys of the player: Space plays and pauses, comma and full stop go one move back and on.
    pub fn keys(&mut self, ui: &Ui) {
        let Some(plays) = self.plays.last() else { return };
        let keys = [Key::Space, Key::Comma, Key::Period];
        let [play, back, on] = ui.input(|i| keys.map(|key| i.modifiers.is_none() && i.key_pressed(key)));
        if play {
            self.player.play_or_pause(plays);
        }
        if back || on {
            self.player.step(plays, on);
        }
    }

    /// Shows the boards in all the room that `ui` has; `picked` is the panel that is picked in the viewport too.
    pub fn show(&mut self, ui: &mut Ui, model: &mut Model, picked: &mut Option<Picked>) {
        self.look(ui.ctx(), model);
        if self.found.is_none() {
            ui.centered_and_justified(|ui| ui.label(missing(model, "boards")));
            return;
        }
        if let Some(plays) = self.plays.last().cloned().filter(|p| !p.is_empty()) {
            egui::Panel::bottom("player").show(ui, |ui| self.player.bar(ui, &plays));
            if self.player.code {
                let panel =
                    egui::Panel::right("code").default_size((ui.available_width() * 0.5).min(400.0)).min_size(160.0);
                panel.show(ui, |ui| self.player.code(ui, &plays));
            }
            self.carve(ui.ctx(), &plays);
        }
        if self.player.solid && self.now().is_some() {
            self.show_solid(ui);
        } else {
            self.show_flat(ui, model, picked);
        }
        if self.player.playing {
            ui.ctx().request_repaint();
        }
    }

    /// Says which moment is looked at, and takes what is there of it.
    fn carve(&mut self, ctx: &Context, plays: &Arc<Vec<Play>>) {
        let (Some(found), Some((play, now))) = (&self.found, self.player.now(plays)) else { return };
        if play.board >= found.layout.boards {
            return;
        }
        let carver = match &mut self.carver {
            Some(carver) => carver,
            none => {
                let ctx = ctx.clone();
                let Some(started) = Carver::start(move || ctx.request_repaint()) else { return };
                none.insert(started)
            }
        };
        let (plays, program, board) = (plays.clone(), self.player.program, found.layout.board);
        let solid = self.player.solid;
        carver.want(Moment { plays, program, board, step: now.step, part_way: now.part_way, solid });
        self.carved = carver.carved();
    }

    fn show_solid(&mut self, ui: &mut Ui) {
        let Some((found, (play, now))) = self.found.as_ref().zip(self.player.now(self.plays.last().map_or(&[], |p| p)))
        else {
            return;
        };
        if let Some((_, at)) = self.player.show.take_if(|(board, _)| *board == play.board) {
            self.space.look_at(at);
        }
        let at = self.player.struck(play, now);
        self.space.show(ui, &found.layout.board, play, now, &self.carved, &self.player.faults, at);
    }

    fn show_flat(&mut self, ui: &mut Ui, model: &mut Model, picked: &mut Option<Picked>) {
        let Some(found) = &self.found else { return };
        let area = ui.available_rect_before_wrap();
        let response = ui.interact(area, Id::new("boards"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "boards"));
        let draw = Draw::new(found);
        if !self.moved && self.fitted != Some(area) {
            self.view.fit(area, draw.bounds());
            self.fitted = Some(area);
        }
        if let Some((board, at)) = self.player.show.take() {
            let at = draw.board(board).min + at.truncate();
            let middle = pos2(at.x as f32, -at.y as f32);
            self.view.fit(area, Rect::from_center_size(middle, egui::vec2(300.0, 300.0)));
            self.moved = true;
        }
        if response.dragged() {
            self.view.origin += response.drag_delta();
            self.moved = true;
        }
        let (scroll, pinch, at) = ui.input(|i| (i.smooth_scroll_delta.y, i.zoom_delta(), i.pointer.latest_pos()));
        if let Some(at) = at.filter(|_| response.contains_pointer() && (scroll != 0.0 || pinch != 1.0)) {
            self.view.zoom_at(area, at, if pinch != 1.0 { pinch } else { (scroll * 0.004).exp() });
            self.moved = true;
        }
        let part = picked.as_ref().filter(|p| Some(&p.output) == found.panels.as_ref()).map(|p| p.part);
        let painter = ui.painter_at(area);
        let theme = Theme::of(ui);
        let view = self.view;
        let to_screen = |p: DVec2| view.to_screen(area, pos2(p.x as f32, -p.y as f32));
        draw.boards(&painter, &theme, &to_screen);
        draw.parts(&painter, view.zoom, part, &to_screen);
        let playing = self.plays.last().and_then(|plays| self.player.now(plays));
        if let Some((play, now)) = playing {
            let place = draw.board(play.board);
            if let Some(image) = &self.carved.image {
                let fresh = self.picture.as_ref().is_some_and(|(of, _)| *of == self.carved.count);
                if !fresh {
                    let options = TextureOptions::LINEAR;
                    match &mut self.picture {
                        Some((of, texture)) => {
                            texture.set(image.clone(), options);
                            *of = self.carved.count;
                        }
                        none => {
                            let texture = ui.ctx().load_texture("board that is cut", image.clone(), options);
                            *none = Some((self.carved.count, texture));
                        }
                    }
                }
                if let Some((_, texture)) = &self.picture {
                    let rect = Rect::from_two_pos(to_screen(place.min), to_screen(place.max));
                    let whole = Rect::from_min_max(pos2(0.0, 0.0), pos2(1.0, 1.0));
                    painter.image(texture.id(), rect, whole, Color32::WHITE);
                }
            }
            draw.addresses(&painter, &to_screen);
            let struck = self.player.struck(play, now);
            draw::paint_tool(&painter, &theme, view.zoom, play, now, struck, &|p| to_screen(p + place.min));
        } else {
            draw.addresses(&painter, &to_screen);
        }
        for fault in &self.player.faults.told {
            let Some(at) = fault.at else { continue };
            draw::paint_fault(&painter, &theme, to_screen(at.truncate() + draw.board(fault.board).min));
        }
        let under = |at: egui::Pos2| {
            let p = view.to_canvas(area, at);
            DVec2::new(f64::from(p.x), -f64::from(p.y))
        };
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            let hit = draw.part_at(under(at));
            *picked = hit.zip(found.panels.clone()).map(|(part, output)| Picked { output, part });
            if let Some(board) = draw.board_at(under(at)) {
                self.player.choose(self.plays.last().map_or(&[], |p| p), board);
            }
            if let Some(id) = picked.as_ref().and_then(|p| model.local(&p.output)).map(str::to_owned) {
                model.selection = [id].into();
            }
        }
        // Tells screen readers and tests where the boards are.
        for b in 0..found.layout.boards {
            let board = draw.board(b);
            let rect = Rect::from_two_pos(to_screen(board.min), to_screen(board.max)).intersect(area);
            let response = ui.interact(rect, Id::new(("board", b)), Sense::hover());
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, format!("board {}", b + 1)));
        }
        let told = ui.input(|i| i.pointer.hover_pos()).filter(|_| response.contains_pointer());
        if let Some(words) = told.and_then(|at| draw.part_at(under(at))).and_then(|p| self.words(p)) {
            response.on_hover_text_at_pointer(words);
        }
    }

    /// What is known of a part: its address, its board, and how long it takes.
    fn words(&self, part: u32) -> Option<String> {
        let found = self.found.as_ref()?;
        let address = found.parts.panels.address.get(part as usize)?.to_string();
        let board = found.layout.placements.iter().find(|p| p.part == part)?.board;
        let times = self.plays().iter().filter(|p| p.board == board);
        let time: f64 = times.filter_map(|p| p.time_of_part(&address)).sum();
        Some(format!("{address}: board {}, {} at the machine", board + 1, player::clock(time)))
    }

    /// Shows everything at the next frame.
    pub fn show_all(&mut self) {
        (self.moved, self.fitted) = (false, None);
        self.space.show_all();
    }
}
