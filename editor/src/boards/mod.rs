//! The boards: parts where they lie, seen from above, and the player that moves the tool through them.

mod draw;
mod player;

use crate::canvas::View;
use crate::model::Model;
use crate::model::cut::{Boards, Play, boards, faults, programs};
use crate::theme::Theme;
use crate::viewport::Picked;
use draw::Draw;
pub use draw::kind_colour;
use eframe::egui::{self, Id, Rect, Sense, Ui, WidgetInfo, WidgetType, pos2};
use player::Player;

/// The view of the boards.
#[derive(Default)]
pub struct BoardView {
    view: View,
    fitted: bool,
    found: Option<Boards>,
    /// The programs as steps, and the digest of what they were read from.
    plays: Vec<Play>,
    read: Option<u128>,
    /// For which results `found` and `plays` are, and with what selected.
    of: Option<(u64, usize)>,
    /// The player.
    pub player: Player,
}

impl BoardView {
    /// After another graph was opened.
    pub fn opened(&mut self) {
        *self = Self::default();
    }

    /// Number of boards that are seen.
    #[must_use]
    pub fn count(&self) -> u32 {
        self.found.as_ref().map_or(0, |b| b.layout.boards)
    }

    /// The programs that can be played.
    #[must_use]
    pub fn plays(&self) -> &[Play] {
        &self.plays
    }

    /// Finds boards and programs, if the results have changed.
    pub fn look(&mut self, model: &Model) {
        let now = (model.results.count, model.selection.len());
        if self.of == Some(now) {
            return;
        }
        self.of = Some(now);
        self.found = boards(model);
        self.player.faults = faults(model);
        let found = programs(model);
        if self.read != found.as_ref().map(|p| p.digest) {
            self.read = found.as_ref().map(|p| p.digest);
            self.plays = found.map_or_else(Vec::new, |p| p.all.iter().map(|q| Play::new(q, &p.machine)).collect());
        }
    }

    /// Shows the boards in all the room that `ui` has; `picked` is the panel that is picked in the viewport too.
    pub fn show(&mut self, ui: &mut Ui, model: &mut Model, picked: &mut Option<Picked>) {
        self.look(model);
        let Some(found) = &self.found else {
            ui.centered_and_justified(|ui| {
                ui.label("No node gives a layout yet. The boards appear once parts are packed.")
            });
            return;
        };
        if !self.plays.is_empty() {
            egui::Panel::bottom("player").show(ui, |ui| self.player.bar(ui, &self.plays));
            if self.player.code {
                egui::Panel::right("code").default_size(240.0).show(ui, |ui| self.player.code(ui, &self.plays));
            }
        }
        let area = ui.available_rect_before_wrap();
        let response = ui.interact(area, Id::new("boards"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "boards"));
        let draw = Draw::new(found);
        if !self.fitted {
            self.view.fit(area, draw.bounds());
            self.fitted = true;
        }
        if response.dragged() {
            self.view.origin += response.drag_delta();
        }
        let (scroll, pinch, at) = ui.input(|i| (i.smooth_scroll_delta.y, i.zoom_delta(), i.pointer.latest_pos()));
        if let Some(at) = at.filter(|_| response.contains_pointer() && (scroll != 0.0 || pinch != 1.0)) {
            self.view.zoom_at(area, at, if pinch != 1.0 { pinch } else { (scroll * 0.004).exp() });
        }
        let part = picked.as_ref().filter(|p| Some(&p.output) == found.panels.as_ref()).map(|p| p.part);
        let painter = ui.painter_at(area);
        let theme = Theme::of(ui);
        let to_screen = |p: tenon_geometry::DVec2| self.view.to_screen(area, pos2(p.x as f32, -p.y as f32));
        draw.paint(&painter, &theme, self.view.zoom, part, &to_screen);
        if let Some((play, now)) = self.player.now(&self.plays) {
            let offset = draw.board(play.board).min;
            draw::paint_play(&painter, &theme, self.view.zoom, play, now, &|p| to_screen(p + offset));
        }
        for fault in &self.player.faults {
            let Some(at) = fault.at else { continue };
            draw::paint_fault(&painter, &theme, to_screen(at.truncate() + draw.board(fault.board).min));
        }
        if response.clicked()
            && let Some(at) = response.interact_pointer_pos()
        {
            let p = self.view.to_canvas(area, at);
            let hit = draw.part_at(tenon_geometry::DVec2::new(f64::from(p.x), -f64::from(p.y)));
            *picked = hit.zip(found.panels.clone()).map(|(part, output)| Picked { output, part });
            if let Some(board) = draw.board_at(tenon_geometry::DVec2::new(f64::from(p.x), -f64::from(p.y))) {
                self.player.choose(&self.plays, board);
            }
            if let Some(id) = picked.as_ref().and_then(|p| model.local(&p.output)).map(str::to_owned) {
                model.selection = [id].into();
            }
        }
        self.name_parts(ui, area, &draw);
        if self.player.playing {
            ui.ctx().request_repaint();
        }
    }

    /// Shows everything at the next frame.
    pub fn show_all(&mut self) {
        self.fitted = false;
    }

    /// Tells screen readers and tests where the boards are.
    fn name_parts(&self, ui: &Ui, area: Rect, draw: &Draw) {
        for b in 0..self.count() {
            let board = draw.board(b);
            let corner = |p: tenon_geometry::DVec2| self.view.to_screen(area, pos2(p.x as f32, -p.y as f32));
            let rect = Rect::from_two_pos(corner(board.min), corner(board.max)).intersect(area);
            let response = ui.interact(rect, Id::new(("board", b)), Sense::hover());
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, format!("board {}", b + 1)));
        }
    }
}
