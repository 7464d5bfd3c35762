//! The buttons over the viewport.

use super::analysis::Measure;
use super::section::Clip;
use super::{Standard, Viewport};
use crate::model::Model;
use crate::panels::Browse;
use eframe::egui::containers::menu::{MenuButton, MenuConfig};
use eframe::egui::{self, DragValue, Rect, Response, TextStyle, Ui, WidgetInfo, WidgetType};
use glam::DVec3;

/// The least width of the list of what is shown in colours, points.
const MEASURE: f32 = 90.0;

/// A field of a number with its name for screen readers and tests.
fn named(ui: &mut Ui, name: &str, field: DragValue<'_>) -> Response {
    let response = ui.add(field);
    response.widget_info(|| WidgetInfo::labeled(WidgetType::DragValue, true, name));
    response
}

impl Viewport {
    pub(super) fn buttons(&mut self, ui: &mut Ui, area: Rect, model: &mut Model) {
        let place =
            Rect::from_min_max(area.min + egui::vec2(6.0, 6.0), egui::pos2(area.right() - 6.0, area.top() + 58.0));
        let mut ui = ui.new_child(egui::UiBuilder::new().max_rect(place));
        ui.horizontal_wrapped(|ui| {
            ui.style_mut().spacing.item_spacing.x = 3.0;
            if ui.button("Fit").on_hover_text("Show all, or what is selected (F)").clicked() {
                self.show_all();
            }
            let views = [
                ("Top", Standard::Top, "7"),
                ("Bottom", Standard::Bottom, "Ctrl+7"),
                ("Front", Standard::Front, "1"),
                ("Back", Standard::Back, "Ctrl+1"),
                ("Right", Standard::Right, "3"),
                ("Left", Standard::Left, "Ctrl+3"),
                ("Corner", Standard::Corner, "0"),
            ];
            ui.menu_button("Views", |ui| {
                for (words, from, key) in views {
                    if ui.add(egui::Button::new(words).shortcut_text(key)).clicked() {
                        self.camera.stand(from);
                        ui.close();
                    }
                }
            });
            let words = if self.camera.orthographic { "Parallel" } else { "Perspective" };
            if ui.button(words).on_hover_text("Switch between perspective and parallel lines (5)").clicked() {
                self.camera.orthographic = !self.camera.orthographic;
            }
            ui.toggle_value(&mut self.labels, "Addresses");
            self.choose_measure(ui, model);
            if ui.toggle_value(&mut self.ruler.on, "Measure").changed() {
                self.ruler.ends.clear();
            }
            // What is set there is set one after the other, so it stays open.
            let stays = MenuConfig::new().close_behavior(egui::PopupCloseBehavior::CloseOnClickOutside);
            MenuButton::new("More").config(stays).ui(ui, |ui| self.more(ui, model));
        });
    }

    fn choose_measure(&mut self, ui: &mut Ui, model: &Model) {
        let name = self.measure.as_ref().map_or("plain".to_owned(), Measure::name);
        // A list does not go into the next line by itself.
        let font = TextStyle::Button.resolve(ui.style());
        let text = ui.painter().layout_no_wrap(name.clone(), font, ui.visuals().text_color()).size().x;
        let (spacing, whole) = (ui.spacing().clone(), ui.max_rect().width());
        let around = spacing.icon_width + spacing.icon_spacing + 2.0 * spacing.button_padding.x;
        let width = (text + around).max(MEASURE).min(whole);
        if width > ui.available_size_before_wrap().x {
            ui.end_row();
        }
        egui::ComboBox::from_id_salt("measure").selected_text(name).width(width).truncate().show_ui(ui, |ui| {
            ui.selectable_value(&mut self.measure, None, "plain");
            let counts: Vec<usize> = model.results.drawings.values().map(|d| d.parts.len()).collect();
            let fits = |tree: &tenon_engine::Tree| {
                matches!(tree.type_name(), "number" | "integer") && tree.len() > 1 && counts.contains(&tree.len())
            };
            let mut lists: Vec<&String> =
                model.results.values.iter().filter(|(_, t)| fits(t)).map(|(a, _)| a).collect();
            lists.sort();
            let lists = lists.into_iter().map(|a| Measure::Numbers(a.as_str().into()));
            for measure in Measure::ALL.into_iter().chain(lists) {
                let name = measure.name();
                ui.selectable_value(&mut self.measure, Some(measure), name);
            }
        });
    }

    fn more(&mut self, ui: &mut Ui, model: &mut Model) {
        ui.horizontal(|ui| {
            ui.checkbox(&mut self.tool_paths, "Tool paths").on_hover_text("of every part, where its panel is");
            ui.add_enabled(self.tool_paths, egui::Checkbox::new(&mut self.rapid_moves, "rapid moves too"));
        });
        ui.separator();
        self.hand.choose(ui);
        ui.separator();
        self.choose_clip(ui, model);
        ui.separator();
        if ui.button("Mesh or picture behind …").clicked() {
            self.wants = Some(Browse::Reference);
            ui.close();
        }
        self.edit_references(ui, model);
        ui.separator();
        ui.horizontal(|ui| {
            let [w, h] = &mut self.picture_size;
            named(ui, "width of the picture", DragValue::new(w).range(16..=65536).speed(8.0));
            ui.label("×");
            named(ui, "height of the picture", DragValue::new(h).range(16..=65536).speed(8.0));
            if ui.add_enabled(self.saving.is_none(), egui::Button::new("Save a picture …")).clicked() {
                self.wants = Some(Browse::Picture);
                ui.close();
            }
        });
    }

    /// The plane that cuts the view open: its direction, its place, and which side goes.
    fn choose_clip(&mut self, ui: &mut Ui, model: &Model) {
        let bounds = self.bounds(model).unwrap_or([DVec3::ZERO, DVec3::ONE]);
        let middle = (bounds[0] + bounds[1]) / 2.0;
        let mut cut = self.clip.is_some();
        if ui.checkbox(&mut cut, "Cut open").on_hover_text("a plane in front of which nothing is drawn").changed() {
            self.clip = cut.then_some(Clip::square_to(0, middle.x));
        }
        let back = self.camera.back();
        let Some(clip) = &mut self.clip else { return };
        ui.horizontal(|ui| {
            for (axis, words) in ["X", "Y", "Z"].into_iter().enumerate() {
                let on = clip.normal.abs_diff_eq(DVec3::AXES[axis], 1e-9)
                    || clip.normal.abs_diff_eq(-DVec3::AXES[axis], 1e-9);
                if ui.selectable_label(on, words).clicked() {
                    *clip = Clip::square_to(axis, middle[axis]);
                }
            }
            if ui.button("This view").on_hover_text("square to the view").clicked() {
                *clip = Clip::through(middle, back);
            }
            if ui.button("Other side").clicked() {
                *clip = clip.flipped();
            }
        });
        let [from, to] = clip.reach(bounds);
        ui.horizontal(|ui| {
            let slider = ui.add(egui::Slider::new(&mut clip.at, from..=to).show_value(false));
            slider.widget_info(|| egui::WidgetInfo::slider(true, 0.0, "place of the section"));
            ui.add(DragValue::new(&mut clip.at).speed(5.0).suffix(" mm").max_decimals(1));
        });
        let [mut turn, mut tilt] = clip.angles();
        let before = [turn, tilt];
        ui.horizontal(|ui| {
            let angle = |value, words| DragValue::new(value).speed(1.0).max_decimals(1).prefix(words).suffix("°");
            named(ui, "turn of the section", angle(&mut turn, "turned "));
            named(ui, "tilt of the section", angle(&mut tilt, "tilted ").range(-90.0..=90.0));
        });
        if [turn, tilt] != before {
            *clip = clip.turned([turn, tilt], clip.normal * clip.at);
        }
    }
}
