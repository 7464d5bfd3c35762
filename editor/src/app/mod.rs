//! The window: menus, canvas, viewport, panels, keys. Everything that it does goes to the model.

pub mod dialogs;
mod files;
mod keys;
mod menus;
mod notices;
pub mod positions;
mod preferences;
mod status;
mod tour;

use crate::boards::BoardView;
use crate::canvas::Canvas;
use crate::model::Model;
use crate::panels::{self, Browser, Lower};
use crate::viewport::Viewport;
use dialogs::Dialogs;
use eframe::egui::{self, Key, Ui};
use files::Leave;
use preferences::Preferences;
use std::path::Path;
use tour::Gallery;

/// The editor's window.
pub struct App {
    /// What is worked on.
    pub model: Model,
    /// Nodes and wires.
    pub canvas: Canvas,
    /// What nodes make.
    pub viewport: Viewport,
    /// Parts on boards, and the player.
    pub boards: BoardView,
    /// What stands beside the canvas.
    pub side: Side,
    /// What stands below the canvas.
    pub lower: Lower,
    browser: Option<Browser>,
    /// The desktop's windows for files.
    pub dialogs: Dialogs,
    help: bool,
    /// A question that must be answered before unsaved work is left.
    leaving: Option<Leave>,
    /// The graphics card, or why there is none.
    card: String,
    has_card: bool,
    /// The processor draws.
    software: bool,
    title: String,
    /// Unsaved work of an earlier window was found, and nobody has said yet what becomes of it.
    found: bool,
    /// What was done last, where it cannot be seen otherwise.
    said: Option<String>,
    preferences: Preferences,
    gallery: Gallery,
    examples: panels::examples::Examples,
    /// The step of the tour that is shown.
    tour: Option<usize>,
    /// It begins as soon as no question about unsaved work is open.
    tour_waits: bool,
    /// It closes, whatever is not saved.
    quits: bool,
    /// What the frame before left in hand.
    grip: Grip,
    /// The frame before had something to do with pointer or keys, so that the next one followed at once.
    heard: bool,
}

/// Two clicks no further apart than this are one double click, seconds: as long as desktops wait.
const DOUBLE_CLICK: f64 = 0.45;

/// A button that is down no longer than this is clicked, seconds.
const CLICK: f64 = 0.8;

/// What a frame leaves in hand for the next one. By the time that a frame sees Escape, what it was meant for is let go already.
#[derive(Clone, Copy, Default)]
struct Grip {
    /// Something is dragged.
    drags: bool,
    /// A field, a menu or a window waits for Escape.
    waits: bool,
}

/// What stands beside the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// What nodes make, in space.
    Space,
    /// Parts on boards.
    Boards,
}

impl Side {
    /// Its name for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Space => "Space",
            Self::Boards => "Boards",
        }
    }
}

impl App {
    /// The window's content; opens `graph` if one is given.
    ///
    /// # Errors
    /// If the system gives no thread for evaluation.
    pub fn new(cc: &eframe::CreationContext<'_>, graph: Option<&Path>) -> std::io::Result<Self> {
        let ctx = cc.egui_ctx.clone();
        // A second pass over the same input would do twice what a key or a click asks for.
        ctx.options_mut(|o| {
            o.max_passes = std::num::NonZeroUsize::MIN;
            o.input_options.max_double_click_delay = DOUBLE_CLICK;
            // Its keys mean something else here; how large everything is, the preferences say.
            o.quit_shortcuts.clear();
            o.zoom_with_keyboard = false;
        });
        crate::theme::install(&ctx);
        let mut viewport = Viewport::default();
        let cpu = |card: &eframe::egui_wgpu::RenderState| {
            card.adapter.get_info().device_type == eframe::wgpu::DeviceType::Cpu
        };
        let software = cc.wgpu_render_state.as_ref().is_some_and(cpu);
        let card = cc.wgpu_render_state.as_ref().map(|card| viewport.use_card(card));
        let mut app = Self {
            model: Model::new(move || ctx.request_repaint())?,
            canvas: Canvas::default(),
            viewport,
            boards: BoardView::default(),
            side: Side::Space,
            lower: Lower::default(),
            browser: None,
            dialogs: Dialogs::default(),
            help: false,
            leaving: None,
            has_card: card.is_some(),
            software,
            card: card.unwrap_or_else(|| "no graphics".into()),
            title: String::new(),
            found: false,
            said: None,
            preferences: Preferences::default(),
            gallery: Gallery::default(),
            examples: Default::default(),
            tour: None,
            tour_waits: false,
            quits: false,
            grip: Grip::default(),
            heard: false,
        };
        if let Some(graph) = graph {
            app.open(graph);
        }
        Ok(app)
    }

    /// Takes what the user prefers, loads plugins, and opens what the program was called with.
    pub fn begin(&mut self, ctx: &egui::Context, start: &crate::Start) {
        let state = crate::model::keep::state_folder();
        self.model.state.clone_from(&state);
        self.take_preferences(ctx);
        self.dialogs = Dialogs::of_the_desktop();
        self.model.host_plugins_by(std::env::current_exe().ok());
        self.model.load_plugins(&start.plugins, &tenon_nodes::plugin::folders());
        if let Some(graph) = &start.graph {
            self.open(graph);
        }
        self.remember_in(ctx, state);
    }

    /// The graphics card's name, or why there is none.
    #[must_use]
    pub fn card(&self) -> &str {
        &self.card
    }

    fn side(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            for (key, side) in keys::BESIDE {
                let hint = format!("Alt+{}", key.name());
                ui.selectable_value(&mut self.side, side, side.name()).on_hover_text(hint);
            }
            if self.side == Side::Boards && !self.model.results.files.is_empty() {
                ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                    if ui.button("Export the files …").on_hover_text(panels::EXPORT).clicked() {
                        self.browse(ui.ctx(), panels::Browse::Export);
                    }
                });
            }
        });
        let keys = ui.rect_contains_pointer(ui.max_rect()) && !ui.ctx().egui_wants_keyboard_input();
        let fit = keys && ui.input(|i| i.key_pressed(Key::F));
        match self.side {
            Side::Boards => {
                if fit {
                    self.boards.show_all();
                }
                if keys {
                    self.boards.keys(ui);
                }
                self.boards.show(ui, &mut self.model, &mut self.viewport.picked);
            }
            Side::Space if self.has_card => {
                if fit {
                    self.viewport.show_all();
                }
                self.viewport.show(ui, &mut self.model);
            }
            Side::Space => {
                ui.centered_and_justified(|ui| ui.label("no graphics: the viewport cannot be shown"));
            }
        }
    }

    /// Opens an example, or puts a piece of it where the canvas is looked at.
    fn example(&mut self, ui: &Ui, shown: panels::examples::Shown) {
        match shown {
            panels::examples::Shown::Open(path) => self.leave(ui, Leave::Open(path)),
            panels::examples::Shown::Insert(piece) => {
                let at = self.canvas.middle();
                self.model.message = self.model.insert_at(&piece, at).err();
            }
        }
    }

    /// Whether nothing is on its way from other threads: the evaluation, what is made of its results to be looked at, plugins
    /// that are loaded, files that are written.
    #[must_use]
    pub fn settled(&self) -> bool {
        let beside = self.model.plugins().loading().is_none() && self.model.exporting().is_none();
        let made = self.viewport.settled() && self.boards.settled() && self.lower.settled() && self.examples.settled();
        self.model.settled() && beside && made
    }

    /// Notes what is in hand, and ends a step that nobody holds any more: a step stays open only as long as something is dragged or
    /// a field has the keyboard.
    fn note_grip(&mut self, ctx: &egui::Context) {
        let typed = ctx.memory(|m| m.focused()).is_some();
        let drags = ctx.dragged_id().is_some();
        let windows =
            self.browser.is_some() || self.gallery.open || self.help || self.asks() || self.canvas.has_window();
        self.grip = Grip { drags, waits: drags || typed || egui::Popup::is_any_open(ctx) || windows };
        if !drags && !typed && !ctx.input(|i| i.pointer.any_down()) {
            self.model.end_all();
        }
    }

    /// Goes where a click in the lower panel leads.
    fn went(&mut self, ctx: &egui::Context, to: panels::Went) {
        // What is being typed belongs to what is seen now.
        self.canvas.settle(&mut self.model);
        let before = self.model.trail().to_vec();
        match to {
            panels::Went::Node(path) => {
                self.model.go_into(&path);
                self.canvas.show_all();
            }
            panels::Went::Export => self.browse(ctx, panels::Browse::Export),
            panels::Went::Panel(picked) => {
                self.model.go_to(&picked.output);
                self.viewport.picked = Some(picked);
            }
        }
        if self.model.trail() != before {
            self.canvas.opened();
        }
    }

    /// Where one is inside clusters, and the way out.
    fn trail(&mut self, ui: &mut Ui) {
        let trail = self.model.trail().to_vec();
        let Some(last) = trail.last() else { return };
        let mut leave = None;
        ui.horizontal_wrapped(|ui| {
            if ui.button("Whole graph").on_hover_text("Alt and the left arrow: one step out").clicked() {
                leave = Some(0);
            }
            for (depth, e) in trail.iter().enumerate().take(trail.len() - 1) {
                ui.label("›");
                if ui.button(&e.cluster).clicked() {
                    leave = Some(depth + 1);
                }
            }
            ui.label("›");
            if let Some(file) = self.model.linked() {
                ui.strong(&last.cluster);
                ui.weak(format!("of {file}, to be looked at; seen through {}", last.path));
                if ui.button("Take it into this file").on_hover_text("then it can be changed here").clicked() {
                    self.model.message = self.model.embed_here().err();
                }
                return;
            }
            let id = egui::Id::new("cluster-name");
            let mut name = ui.data(|d| d.get_temp::<String>(id)).unwrap_or_else(|| last.cluster.clone());
            let field = ui.add(egui::TextEdit::singleline(&mut name).desired_width(140.0).id(id.with("field")));
            field.widget_info(|| egui::WidgetInfo::labeled(egui::WidgetType::TextEdit, true, "name of the cluster"));
            if field.has_focus() {
                ui.data_mut(|d| d.insert_temp(id, name.clone()));
            }
            if field.lost_focus() {
                ui.data_mut(|d| d.remove::<String>(id));
                if name.trim() != last.cluster && !ui.input(|i| i.key_pressed(Key::Escape)) {
                    self.model.message = self.model.rename_cluster(&last.cluster, name.trim()).err();
                }
            }
            ui.weak(format!("seen through {}", last.path));
        });
        if let Some(depth) = leave {
            self.model.leave_to(depth);
            self.canvas.opened();
        }
    }
}

impl eframe::App for App {
    /// Clicks are timed by the frames that see them. What was clicked while a slow frame was drawn waited for its end, and that
    /// time does not count.
    fn raw_input_hook(&mut self, ctx: &egui::Context, input: &mut egui::RawInput) {
        let waited = match (self.heard, input.time) {
            (true, Some(now)) => (now - ctx.input(|i| i.time)).max(0.0),
            _ => 0.0,
        };
        ctx.options_mut(|o| {
            o.input_options.max_double_click_delay = DOUBLE_CLICK + waited;
            o.input_options.max_click_duration = CLICK + waited;
        });
    }

    fn ui(&mut self, ui: &mut Ui, _: &mut eframe::Frame) {
        self.heard = ui.input(|i| !i.raw.events.is_empty());
        self.model.poll();
        self.examples.poll();
        self.boards.poll();
        self.keys(ui);
        egui::Panel::top("menus").show(ui, |ui| self.menus(ui));
        egui::Panel::bottom("status").show(ui, |ui| self.status(ui));
        let width = ui.available_width();
        egui::Panel::right("right").default_size(width * 0.45).min_size(160.0).show(ui, |ui| {
            egui::Panel::bottom("inspector")
                .resizable(true)
                .min_size(150.0)
                .default_size(ui.available_height() * 0.34)
                .show(ui, |ui| {
                    if let Some(shown) = panels::inspector(ui, &mut self.model, &mut self.examples) {
                        self.example(ui, shown);
                    }
                });
            egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| self.side(ui));
        });
        self.lower.rest();
        if self.lower.tab.is_some() {
            egui::Panel::bottom("lower").resizable(true).default_size(200.0).show(ui, |ui| {
                self.boards.look(ui.ctx(), &self.model);
                if let Some(went) = self.lower.show(ui, &self.model, &self.boards) {
                    self.went(ui.ctx(), went);
                }
            });
        }
        self.notices(ui);
        if !self.model.trail().is_empty() {
            egui::Panel::top("trail").show(ui, |ui| self.trail(ui));
        }
        let depth = self.model.trail().len();
        egui::CentralPanel::default().frame(egui::Frame::NONE).show(ui, |ui| self.canvas.show(ui, &mut self.model));
        if self.model.trail().len() != depth {
            self.canvas.opened();
        }
        panels::help(ui, &mut self.help);
        self.files(ui);
        self.gallery(ui);
        self.tour(ui);
        self.note_grip(ui.ctx());
        if !self.model.settled() {
            // The worker wakes the window when it has something; this only keeps the clock of the bar going.
            ui.ctx().request_repaint_after(std::time::Duration::from_millis(200));
        }
    }
}
