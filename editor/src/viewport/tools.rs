//! The buttons over the viewport.

use super::analysis::Measure;
use super::section::Clip;
use super::{Standard, Viewport};
use crate::model::Model;
use crate::panels::Browse;
use eframe::egui::{self, DragValue, Rect, Ui};

impl Viewport {
    pub(super) fn buttons(&mut self, ui: &mut Ui, area: Rect, model: &Model) {
        let place =
            Rect::from_min_max(area.min + egui::vec2(6.0, 6.0), egui::pos2(area.right() - 6.0, area.top() + 58.0));
        let mut ui = ui.new_child(egui::UiBuilder::new().max_rect(place));
        ui.horizontal_wrapped(|ui| {
            ui.style_mut().spacing.item_spacing.x = 3.0;
            if ui.button("Fit").on_hover_text("Show all, or what is selected (F)").clicked() {
                self.show_all();
            }
            let views = [
                ("Top", Standard::Top),
                ("Front", Standard::Front),
                ("Right", Standard::Right),
                ("Corner", Standard::Corner),
            ];
            for (words, from) in views {
                if ui.button(words).clicked() {
                    self.camera.stand(from);
                }
            }
            let words = if self.camera.orthographic { "Parallel" } else { "Perspective" };
            if ui.button(words).on_hover_text("Switch between perspective and parallel lines").clicked() {
                self.camera.orthographic = !self.camera.orthographic;
            }
            ui.toggle_value(&mut self.labels, "Addresses");
            self.choose_measure(ui, model);
            if ui.toggle_value(&mut self.ruler.on, "Measure").changed() {
                self.ruler.ends.clear();
            }
            ui.menu_button("More", |ui| self.more(ui, model));
        });
    }

    fn choose_measure(&mut self, ui: &mut Ui, model: &Model) {
        let name = self.measure.as_ref().map_or("plain".to_owned(), Measure::name);
        egui::ComboBox::from_id_salt("measure").selected_text(name).width(90.0).show_ui(ui, |ui| {
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

    fn more(&mut self, ui: &mut Ui, model: &Model) {
        ui.checkbox(&mut self.tool_paths, "Tool paths").on_hover_text("of every part, where its panel is");
        ui.separator();
        let bounds = self.bounds(model);
        let mut cut = self.clip.is_some();
        if ui.checkbox(&mut cut, "Cut open").on_hover_text("a plane in front of which nothing is drawn").changed() {
            let middle = bounds.map_or(0.0, |[a, b]| (a.x + b.x) / 2.0);
            self.clip = cut.then_some(Clip { axis: 0, at: middle, below: false });
        }
        if let Some(clip) = &mut self.clip {
            ui.horizontal(|ui| {
                for (axis, words) in ["X", "Y", "Z"].into_iter().enumerate() {
                    if ui.selectable_label(clip.axis == axis, words).clicked() {
                        let at = bounds.map_or(0.0, |[a, b]| (a[axis] + b[axis]) / 2.0);
                        *clip = Clip { axis, at, ..*clip };
                    }
                }
                ui.add(DragValue::new(&mut clip.at).speed(5.0).suffix(" mm").max_decimals(1));
                ui.toggle_value(&mut clip.below, "other side");
            });
        }
        ui.separator();
        if ui.button("Mesh or picture behind …").clicked() {
            self.wants = Some(Browse::Reference);
            ui.close();
        }
        let mut gone = None;
        for (i, reference) in self.references.iter().enumerate() {
            ui.horizontal(|ui| {
                ui.weak(&reference.name);
                if ui.small_button("×").on_hover_text("do not show it any more").clicked() {
                    gone = Some(i);
                }
            });
        }
        gone.map(|i| self.references.remove(i));
        ui.separator();
        ui.horizontal(|ui| {
            let [w, h] = &mut self.picture_size;
            ui.add(DragValue::new(w).range(16..=16384).speed(8.0));
            ui.label("×");
            ui.add(DragValue::new(h).range(16..=16384).speed(8.0));
            if ui.button("Save a picture …").clicked() {
                self.wants = Some(Browse::Picture);
                ui.close();
            }
        });
    }
}
