//! The player: which program, where in time, how fast; and its text with the line that runs.

use super::draw::kind_colour;
use crate::model::cut::{Fault, Faults};
use crate::model::play::{Kind, Now, Play};
use crate::theme::Theme;
use eframe::egui::{self, ComboBox, RichText, ScrollArea, Slider, TextStyle, Ui};
use tenon_geometry::DVec3;
use tenon_nodes::value::Standing;

/// Where the tool is.
pub struct Player {
    /// The program that is played.
    pub program: usize,
    /// Seconds from its start.
    pub time: f64,
    /// Times real time.
    pub speed: f64,
    /// It runs.
    pub playing: bool,
    /// The text is shown.
    pub code: bool,
    /// The board is shown in space.
    pub solid: bool,
    /// What proofs have found wrong.
    pub faults: Faults,
    /// A place of a board that is to be brought into view.
    pub show: Option<(u32, DVec3)>,
    /// Something was played, so that the tool is drawn.
    begun: bool,
    /// The line that the text was brought to.
    at_line: u32,
}

impl Default for Player {
    fn default() -> Self {
        Self {
            program: 0,
            time: 0.0,
            speed: 20.0,
            playing: false,
            code: false,
            solid: false,
            faults: Faults::default(),
            show: None,
            begun: false,
            at_line: 0,
        }
    }
}

pub(super) fn clock(seconds: f64) -> String {
    let s = seconds.max(0.0).round() as u64;
    format!("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
}

impl Player {
    /// The program that is played and where its tool is; none before anything was played.
    pub fn now<'a>(&self, plays: &'a [Play]) -> Option<(&'a Play, Now)> {
        let play = plays.get(self.program).filter(|_| self.begun)?;
        Some((play, play.at(self.time)?))
    }

    /// Goes to a time and shows the tool there.
    pub fn go_to(&mut self, time: f64) {
        (self.time, self.begun) = (time, true);
    }

    /// Whether the proof has found something wrong in what runs just now.
    pub fn struck(&self, play: &Play, now: Now) -> bool {
        let line = play.steps.get(now.step).map(|s| s.line);
        line.is_some() && self.faults.of(play.board).any(|f| f.line == line)
    }

    /// Plays from where the tool is, from the start if it is at the end; or pauses.
    pub fn play_or_pause(&mut self, plays: &[Play]) {
        let Some(play) = plays.get(self.program) else { return };
        self.playing = !self.playing;
        if self.playing && self.time >= play.length() {
            self.time = 0.0;
        }
        self.begun = true;
    }

    /// Goes to the end of the move that runs, or of the next; or back to its start, or to that of the one before. O(log moves).
    pub fn step(&mut self, plays: &[Play], on: bool) {
        let Some(play) = plays.get(self.program) else { return };
        let (steps, now) = (&play.steps, self.time);
        let to = match on {
            true => steps.get(steps.partition_point(|s| s.time[1] <= now)).map_or(play.length(), |s| s.time[1]),
            false => steps[..steps.partition_point(|s| s.time[0] < now)].last().map_or(0.0, |s| s.time[0]),
        };
        self.playing = false;
        self.go_to(to);
    }

    /// Takes the program of a board.
    pub fn choose(&mut self, plays: &[Play], board: u32) {
        if let Some(program) = plays.iter().position(|p| p.board == board).filter(|p| *p != self.program) {
            (self.program, self.time, self.playing) = (program, 0.0, false);
        }
    }

    /// The bar below the boards.
    pub fn bar(&mut self, ui: &mut Ui, plays: &[Play]) {
        self.program = self.program.min(plays.len().saturating_sub(1));
        let Some(play) = plays.get(self.program) else { return };
        let length = play.length();
        if self.playing {
            self.time += f64::from(ui.input(|i| i.stable_dt.min(0.1))) * self.speed;
            self.playing = self.time < length;
        }
        self.time = self.time.clamp(0.0, length);
        ui.add_space(3.0);
        ui.horizontal(|ui| {
            ComboBox::from_id_salt("program").selected_text(&play.name).show_ui(ui, |ui| {
                for (i, p) in plays.iter().enumerate() {
                    if ui.selectable_label(i == self.program, &p.name).clicked() && i != self.program {
                        (self.program, self.time, self.playing) = (i, 0.0, false);
                    }
                }
            });
            let theme = Theme::of(ui);
            match (&play.standing, &play.refused) {
                (_, Some((line, why))) => {
                    ui.colored_label(theme.error, format!("line {line} cannot be read")).on_hover_text(why)
                }
                (Standing::Passed, _) => ui.colored_label(theme.selected, "proven"),
                (Standing::Unproven, _) => ui.colored_label(theme.warning, "unproven"),
                (Standing::Failed(why), _) => ui.colored_label(theme.error, "proof failed").on_hover_text(&**why),
            };
            ui.label(format!("{} of {}", clock(self.time), clock(length)))
                .on_hover_text("estimated: rapid moves at 20 m/min, no acceleration, no tool changes");
            ui.toggle_value(&mut self.code, "Program");
            if ui.toggle_value(&mut self.solid, "In space").on_hover_text("the board and the tool as bodies").changed()
            {
                self.begun = true;
            }
            self.choose_fault(ui, play);
        });
        ui.horizontal(|ui| {
            let button = ui.button(if self.playing { "Pause" } else { "Play" });
            if button.on_hover_text("Space over the boards; comma and full stop: one move").clicked() {
                self.play_or_pause(plays);
            }
            ui.spacing_mut().slider_width = (ui.available_width() - 190.0).max(60.0);
            let slider = ui.add(Slider::new(&mut self.time, 0.0..=length.max(1e-9)).show_value(false));
            slider.widget_info(|| egui::WidgetInfo::slider(true, self.time, "time"));
            if slider.changed() {
                self.begun = true;
            }
            self.mark_faults(ui, slider.rect, play, length);
            let speed =
                egui::DragValue::new(&mut self.speed).range(0.1..=1000.0).speed(1.0).max_decimals(1).suffix(" ×");
            let speed = ui.add(speed).on_hover_text("times real time");
            speed.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::DragValue, true, "speed"));
        });
        ui.horizontal(|ui| {
            let kinds =
                [("rapid", Kind::Rapid), ("plunge", Kind::Plunge), ("cut", Kind::Cut), ("retract", Kind::Retract)];
            for (words, kind) in kinds {
                ui.label(RichText::new(format!("■ {words}")).small().color(kind_colour(kind)));
            }
            let step = play.at(self.time).and_then(|n| play.steps.get(n.step));
            if let Some((step, tool)) = step.and_then(|s| Some((s, play.tool(s)?))) {
                ui.label(RichText::new(format!("line {}, tool {}: {}", step.line, tool.number, tool.name)).small());
            }
            if let Some((part, time)) = step.and_then(|s| play.part(s)) {
                ui.label(RichText::new(format!("part {part}: {} in all", clock(time))).small());
            }
        });
    }

    /// Marks on the slider where in time the proof has found something wrong.
    fn mark_faults(&self, ui: &Ui, slider: egui::Rect, play: &Play, length: f64) {
        let own = self.faults.of(play.board);
        let colour = Theme::of(ui).error;
        for time in own.filter_map(|f| play.time_of(f.line?)) {
            let x = slider.left() + slider.width() * (time / length.max(1e-9)) as f32;
            ui.painter().vline(x, slider.top()..=slider.top() + 5.0, egui::Stroke::new(1.5, colour));
        }
    }

    /// The list of what proofs found wrong with a program; choosing one goes there.
    fn choose_fault(&mut self, ui: &mut Ui, play: &Play) {
        let own: Vec<&Fault> = self.faults.of(play.board).collect();
        if own.is_empty() {
            return;
        }
        let mut chosen = None;
        let words = match (own.len(), self.faults.more(play.board)) {
            (1, 0) => "1 fault".to_owned(),
            (told, 0) => format!("{told} faults"),
            (told, more) => format!("{told} of {} faults", told + more),
        };
        ui.menu_button(RichText::new(words).color(Theme::of(ui).error), |ui| {
            ScrollArea::vertical().max_height(260.0).show(ui, |ui| {
                for fault in &own {
                    if ui.button(&fault.words).clicked() {
                        chosen = Some((*fault).clone());
                        ui.close();
                    }
                }
            });
        });
        if let Some(fault) = chosen {
            // What is left standing is no line's fault: then only its place is shown.
            if let Some(time) = fault.line.and_then(|l| play.time_of(l)) {
                self.go_to(time);
            }
            self.show = fault.at.map(|at| (fault.board, at));
        }
    }

    /// The text of the program; a click on a line goes there.
    pub fn code(&mut self, ui: &mut Ui, plays: &[Play]) {
        let Some(play) = plays.get(self.program) else { return };
        let line = play.at(self.time).and_then(|n| play.steps.get(n.step)).map_or(1, |s| s.line);
        let height = ui.text_style_height(&TextStyle::Monospace) + ui.spacing().item_spacing.y;
        let mut area = ScrollArea::both().auto_shrink(false).id_salt("program text");
        if line != self.at_line {
            // The line that runs stays in the middle.
            let middle = (ui.available_height() / 2.0 / height).floor();
            area = area.vertical_scroll_offset(((line as f32 - 1.0 - middle) * height).max(0.0));
            self.at_line = line;
        }
        let mut go = None;
        area.show_rows(ui, height - ui.spacing().item_spacing.y, play.line_count(), |ui, rows| {
            ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
            for row in rows {
                let number = row as u32 + 1;
                let text = RichText::new(format!("{number:>6}  {}", play.line(row + 1))).monospace();
                if ui.selectable_label(number == line, text).clicked() {
                    go = play.time_of(number);
                }
            }
        });
        if let Some(time) = go {
            self.go_to(time);
        }
    }
}
