//! The viewport: what nodes make, in space. Looking around, picking, and points taken by hand.

mod analysis;
mod camera;
mod gpu;
mod hand;

pub use analysis::Measure;
pub use camera::{Camera, Standard};
pub use gpu::install;

use crate::model::Model;
use crate::scene::Kind;
use crate::theme::Theme;
use analysis::Colours;
use eframe::egui::{
    self, Align2, Color32, FontId, Id, PointerButton, Rect, Response, Sense, Stroke, Ui, WidgetInfo, WidgetType,
};
use glam::DVec3;
use gpu::{Frame, Shown};
use hand::Hand;

/// No more labels than this are drawn.
const MOST_LABELS: usize = 3000;

/// A part that was picked: an output (`node.port`) and the number of the part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picked {
    /// `node.port`.
    pub output: String,
    /// The part's number there.
    pub part: u32,
}

/// The viewport of one window.
#[derive(Default)]
pub struct Viewport {
    /// The eye.
    pub camera: Camera,
    /// What was picked last.
    pub picked: Option<Picked>,
    /// Whether parts bear their labels.
    pub labels: bool,
    hand: Hand,
    /// All is to be brought into view as soon as there is something.
    fit: bool,
    /// What is shown in colours.
    pub measure: Option<Measure>,
    colours: Colours,
}

fn rgb(colour: Color32) -> [f32; 3] {
    [colour.r(), colour.g(), colour.b()].map(|c| f32::from(c) / 255.0)
}

impl Viewport {
    /// After another graph was opened.
    pub fn opened(&mut self) {
        *self = Self { fit: true, labels: self.labels, measure: self.measure, ..Self::default() };
    }

    /// Shows everything, or what is selected, at the next frame.
    pub fn show_all(&mut self) {
        self.fit = true;
    }

    /// Shows the viewport in all the room that `ui` has.
    pub fn show(&mut self, ui: &mut Ui, model: &mut Model) {
        let area = ui.available_rect_before_wrap();
        let response = ui.interact(area, Id::new("viewport"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "viewport"));
        if self.fit {
            self.bring_into_view(area, model);
        }
        self.look(ui, &response);
        self.render(ui, area, model);
        if self.labels {
            self.paint_labels(ui, area, model);
        }
        self.axes(ui, area);
        if let Some((measure, range)) = self.measured(model) {
            analysis::legend(&ui.painter_at(area), area, &Theme::of(ui), measure, range);
        }
        let taken = self.hand.show(ui, area, &self.camera, model);
        if response.clicked() && !taken {
            self.pick(ui, &response, model);
        }
        self.say_what_is_picked(ui, area, model);
        self.buttons(ui, area);
    }

    /// What is shown in colours, and from which figure to which.
    fn measured(&self, model: &Model) -> Option<(Measure, [f64; 2])> {
        let measure = self.measure?;
        Some((measure, analysis::range(measure, model.results.drawings.values())?))
    }

    fn bring_into_view(&mut self, area: Rect, model: &Model) {
        let chosen = |address: &str| model.is_chosen(address);
        let all = &model.results.drawings;
        let any = all.keys().any(|a| chosen(a));
        let boxes = all.iter().filter(|(a, _)| !any || chosen(a)).map(|(_, d)| d.bounds);
        if let Some(bounds) = boxes.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]) {
            self.camera.fit(area, bounds);
            self.fit = false;
        }
    }

    fn look(&mut self, ui: &Ui, response: &Response) {
        let area = response.rect;
        let (shift, scroll, pinch, at) =
            ui.input(|i| (i.modifiers.shift, i.smooth_scroll_delta.y, i.zoom_delta(), i.pointer.latest_pos()));
        if response.dragged() {
            let by = response.drag_delta();
            let (dx, dy) = (f64::from(by.x), f64::from(by.y));
            if response.dragged_by(PointerButton::Middle) || shift {
                self.camera.pan(area, dx, dy);
            } else {
                self.camera.orbit(dx, dy);
            }
        }
        if let Some(at) =
            at.filter(|at| response.contains_pointer() && area.contains(*at) && (scroll != 0.0 || pinch != 1.0))
        {
            let factor = if pinch != 1.0 { 1.0 / f64::from(pinch) } else { f64::from(-scroll * 0.003).exp() };
            self.camera.zoom(area, at, factor);
        }
    }

    fn render(&mut self, ui: &Ui, area: Rect, model: &Model) {
        let theme = Theme::of(ui);
        let measure = self.measured(model);
        let mut shown = Vec::new();
        for (output, drawing) in &model.results.drawings {
            let chosen = model.is_chosen(output);
            let (mut face, line) = match drawing.kind {
                Kind::Panels => (Color32::from_rgb(226, 190, 140), theme.line),
                Kind::Mesh => (Color32::from_rgb(160, 176, 190), theme.line),
                Kind::Curve => (theme.text, Color32::from_rgb(60, 160, 80)),
                Kind::Points => (theme.text, Color32::from_rgb(220, 80, 100)),
            };
            let mut line = line;
            if chosen {
                face = Color32::from_rgb(150, 205, 140);
                if matches!(drawing.kind, Kind::Curve | Kind::Points) {
                    line = theme.selected;
                }
            }
            let width = match drawing.kind {
                Kind::Curve => [2.2, 4.0],
                _ => [1.0, 4.0],
            };
            let picked = self.picked.as_ref().filter(|p| p.output == *output).map(|p| p.part);
            let colours = self.colours.of(output, drawing, measure, picked);
            let open = drawing.kind == Kind::Mesh;
            let (face, line) = (rgb(face), rgb(line));
            shown.push(Shown { key: output.clone(), drawing: drawing.clone(), face, line, width, colours, open });
        }
        let aspect = f64::from(area.width().max(1.0) / area.height().max(1.0));
        let frame = Frame {
            matrix: self.camera.matrix(aspect),
            eye: self.camera.back(),
            size: [area.width(), area.height()],
            ground: rgb(theme.space),
            shown,
        };
        ui.painter().add(eframe::egui_wgpu::Callback::new_paint_callback(area, frame));
    }

    fn pick(&mut self, ui: &Ui, response: &Response, model: &mut Model) {
        let Some(at) = response.interact_pointer_pos() else { return };
        let (origin, direction) = self.camera.ray(response.rect, at);
        let hits =
            model.results.drawings.iter().filter_map(|(output, d)| d.pick(origin, direction).map(|h| (output, h)));
        let nearest = hits.min_by(|a, b| a.1.1.total_cmp(&b.1.1));
        self.picked = nearest.map(|(output, (part, _))| Picked { output: output.clone(), part });
        if !ui.input(|i| i.modifiers.shift) {
            model.selection.clear();
        }
        if let Some(id) = self.picked.as_ref().and_then(|p| model.local(&p.output)).map(str::to_owned) {
            // The part is shown by its own colour, so that it stands out of the others.
            model.selection.insert(id);
        }
    }

    fn paint_labels(&self, ui: &Ui, area: Rect, model: &Model) {
        let painter = ui.painter_at(area);
        let ink = Theme::of(ui).text;
        let panels = model.results.drawings.values().filter(|d| d.kind == Kind::Panels);
        for part in panels.flat_map(|d| &d.parts).take(MOST_LABELS) {
            if let Some(at) = self.camera.project(area, part.centre).filter(|at| area.contains(*at)) {
                painter.text(at, Align2::CENTER_CENTER, &part.label, FontId::proportional(10.0), ink);
            }
        }
    }

    /// The axes of space in a corner.
    fn axes(&self, ui: &Ui, area: Rect) {
        let painter = ui.painter_at(area);
        let (right, up) = self.camera.sides();
        let centre = egui::pos2(area.left() + 34.0, area.bottom() - 34.0);
        let axes = [("x", DVec3::X, 220, 80, 70), ("y", DVec3::Y, 90, 170, 80), ("z", DVec3::Z, 80, 130, 220)];
        for (name, axis, r, g, b) in axes {
            let by = egui::vec2(axis.dot(right) as f32, -axis.dot(up) as f32) * 22.0;
            let colour = Color32::from_rgb(r, g, b);
            painter.line_segment([centre, centre + by], Stroke::new(2.0, colour));
            painter.text(centre + by * 1.3, Align2::CENTER_CENTER, name, FontId::proportional(11.0), colour);
        }
    }

    fn say_what_is_picked(&self, ui: &Ui, area: Rect, model: &Model) {
        let part = self.picked.as_ref().and_then(|p| {
            let drawing = model.results.drawings.get(&p.output)?;
            Some((p, drawing.parts.get(p.part as usize)?))
        });
        let Some((picked, part)) = part else { return };
        let mut text = format!("{} {}", picked.output, part.label);
        if part.area > 0.0 {
            for (measure, name) in Measure::ALL {
                text += &format!(", {name} {}", measure.shown(measure.of(part)));
            }
        }
        let at = egui::pos2(area.left() + 70.0, area.bottom() - 12.0);
        ui.painter_at(area).text(at, Align2::LEFT_BOTTOM, text, FontId::proportional(13.0), Theme::of(ui).text);
    }

    fn buttons(&mut self, ui: &mut Ui, area: Rect) {
        let place =
            Rect::from_min_max(area.min + egui::vec2(6.0, 6.0), egui::pos2(area.right() - 6.0, area.top() + 32.0));
        let mut ui = ui.new_child(egui::UiBuilder::new().max_rect(place));
        ui.horizontal(|ui| {
            ui.style_mut().spacing.item_spacing.x = 3.0;
            if ui.button("Fit").on_hover_text("Show all, or what is selected (F)").clicked() {
                self.fit = true;
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
            let name = Measure::ALL.iter().find(|m| Some(m.0) == self.measure).map_or("plain", |m| m.1);
            egui::ComboBox::from_id_salt("measure").selected_text(name).width(90.0).show_ui(ui, |ui| {
                ui.selectable_value(&mut self.measure, None, "plain");
                for (measure, name) in Measure::ALL {
                    ui.selectable_value(&mut self.measure, Some(measure), name);
                }
            });
        });
    }
}
