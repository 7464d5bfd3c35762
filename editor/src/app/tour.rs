//! The first steps: three of them, on the shell of 256 panels. And the examples with their pictures.

use super::App;
use super::files::Leave;
use crate::canvas::Canvas;
use crate::panels::examples::folder as examples;
use eframe::egui::{self, Align2, ColorImage, TextureHandle, Ui, Window};
use std::path::PathBuf;

/// The steps: what to do, and in other words why.
const STEPS: [(&str, &str); 3] = [
    (
        "Drag a red point in the viewport",
        "It is a control point of the arc. The shell follows while you drag, and letting go ends one step: Ctrl+Z takes it back.",
    ),
    (
        "Drag the slider “thickness” of the node thicken",
        "Every input bears its value; double-click it to type, also with a unit such as 12 mm. Nodes that depend on it run \
         again, the others do not.",
    ),
    (
        "Click Boards over the viewport, then Play",
        "There the panels lie on their boards, and the tool moves through them as the machine will.",
    ),
];

/// The examples, with the pictures that were opened.
#[derive(Default)]
pub struct Gallery {
    /// It is shown.
    pub open: bool,
    found: Option<Vec<(String, PathBuf, Option<TextureHandle>)>>,
}

/// Every example that has a folder to itself; the small ones of nodes lie together and are offered beside their nodes.
fn read(ctx: &egui::Context) -> Vec<(String, PathBuf, Option<TextureHandle>)> {
    let entries = examples().and_then(|f| f.read_dir().ok());
    let mut all: Vec<PathBuf> =
        entries.into_iter().flatten().flatten().map(|e| e.path()).filter(|p| p.is_dir()).collect();
    all.retain(|p| crate::model::file::find(p).is_ok());
    all.sort();
    let named = |path: PathBuf| {
        let name = path.file_name()?.to_string_lossy().into_owned();
        let picture = std::fs::read(path.join(format!("{name}.png"))).ok();
        let image = picture.and_then(|b| image::load_from_memory(&b).ok()).map(|i| i.thumbnail(320, 200).to_rgba8());
        let texture = image.map(|i| {
            let size = [i.width() as usize, i.height() as usize];
            ctx.load_texture(&name, ColorImage::from_rgba_unmultiplied(size, &i), Default::default())
        });
        Some((name, path, texture))
    };
    all.into_iter().filter_map(named).collect()
}

/// Said where there is nothing to choose from, and where the tour has nothing to go through.
const NO_EXAMPLES: &str = "The folder graphs with the examples is not beside the program.";

impl App {
    /// Shows the examples, if they are open.
    pub(super) fn gallery(&mut self, ui: &Ui) {
        if !self.gallery.open {
            return;
        }
        let found = self.gallery.found.get_or_insert_with(|| read(ui.ctx()));
        let (mut open, mut chosen, mut take) = (true, None, false);
        let room = ui.ctx().content_rect();
        let window = Window::new("Examples").open(&mut open).collapsible(false).default_width(700.0);
        let window = window.pivot(Align2::CENTER_CENTER).default_pos(room.center());
        window.default_height((room.height() - 100.0).max(80.0)).show(ui.ctx(), |ui| {
            take = ui.button("Take the tour").on_hover_text("three steps on the shell of 256 panels").clicked();
            if found.is_empty() {
                ui.label(NO_EXAMPLES);
            }
            let columns = if room.width() < 720.0 { 1 } else { 2 };
            egui::ScrollArea::vertical().max_height((room.height() - 140.0).max(80.0)).show(ui, |ui| {
                egui::Grid::new("examples").num_columns(columns).show(ui, |ui| {
                    for (i, (name, path, picture)) in found.iter().enumerate() {
                        ui.vertical(|ui| {
                            let button = match picture {
                                Some(texture) => ui.add(egui::Button::image(texture)),
                                None => ui.add_sized([320.0, 60.0], egui::Button::new("no picture")),
                            };
                            let named = ui.button(name);
                            if button.clicked() || named.clicked() {
                                chosen = Some(path.clone());
                            }
                        });
                        if i % columns == columns - 1 {
                            ui.end_row();
                        }
                    }
                });
            });
        });
        let escaped = ui.input(|i| i.key_pressed(egui::Key::Escape));
        self.gallery.open = open && chosen.is_none() && !escaped && !take;
        if !self.gallery.open {
            // Who has put it away once finds it in the menu.
            self.seen_first_steps();
        }
        if take {
            self.begin_tour(ui);
        }
        if let Some(path) = chosen {
            self.leave(ui, Leave::Open(path));
        }
    }

    /// Neither examples nor tour are offered at the next start.
    fn seen_first_steps(&mut self) {
        if !self.preferences.toured {
            self.preferences.toured = true;
            self.keep_preferences();
        }
    }

    /// Begins the tour on the shell, once what is not saved may be left.
    pub(super) fn begin_tour(&mut self, ui: &Ui) {
        let shell = examples().map(|f| f.join("shell-256"));
        let there = self.model.document().nodes().contains_key("thicken");
        match shell {
            _ if there => {}
            Some(shell) => self.leave(ui, Leave::Open(shell)),
            None => self.said = Some(NO_EXAMPLES.into()),
        }
        self.gallery.open = false;
        self.tour_waits = true;
    }

    /// Shows the step of the tour, if one is taken.
    pub(super) fn tour(&mut self, ui: &Ui) {
        if self.tour_waits && self.leaving.is_none() {
            self.tour_waits = false;
            // Without the shell, as when it was not opened after all, there is nothing to go through.
            self.tour = self.model.document().nodes().contains_key("thicken").then_some(0);
        }
        let Some(step) = self.tour else { return };
        let Some((what, why)) = STEPS.get(step) else {
            self.tour = None;
            return;
        };
        let mut next = Some(step);
        let window = Window::new(format!("Step {} of {}", step + 1, STEPS.len())).collapsible(false).resizable(false);
        window.anchor(Align2::LEFT_BOTTOM, [16.0, -44.0]).default_width(320.0).show(ui.ctx(), |ui| {
            ui.strong(*what);
            ui.label(*why);
            ui.horizontal(|ui| {
                let last = step + 1 == STEPS.len();
                if ui.button(if last { "Done" } else { "Next" }).clicked() {
                    next = Some(step + 1);
                }
                if !last && ui.button("Leave the tour").clicked() {
                    next = None;
                }
            });
        });
        if next != Some(step) {
            self.tour = next.filter(|n| *n < STEPS.len());
            if next == Some(1) {
                self.model.selection = ["thicken".to_owned()].into();
                Canvas::show_all(&mut self.canvas);
            }
            if self.tour.is_none() {
                self.seen_first_steps();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gallery_shows_the_graphs_that_have_a_folder_to_themselves() {
        let found = read(&egui::Context::default());
        let names: Vec<&str> = found.iter().map(|(name, ..)| name.as_str()).collect();
        assert_eq!(names, ["quad-mesh", "shell-21mm", "shell-256", "three-strips"]);
        assert!(found.iter().all(|(.., picture)| picture.is_some()));
    }
}
