//! Points of the document taken by hand: dragged in a plane or along an axis, snapped to a grid, or typed.

use super::Camera;
use super::section::Clip;
use crate::model::Model;
use crate::model::handle::{Handle, Place, set_weight, weight};
use crate::panels::{escaped, figure};
use crate::theme::Theme;
use eframe::egui::{
    Area, Color32, DragValue, Frame, Id, Key, Order, Pos2, Rect, Sense, Stroke, Ui, WidgetInfo, WidgetType, vec2,
};
use glam::DVec3;

/// The grid that points snap to with Shift at first, mm.
const GRID: f64 = 10.0;

/// In which plane points are dragged.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Drag {
    /// That of two axes which the eye sees best.
    #[default]
    Best,
    /// Level.
    XY,
    /// Square to Y.
    XZ,
    /// Square to X.
    YZ,
    /// Square to the view.
    View,
}

/// Which points there are and which one is being moved.
pub struct Hand {
    /// In which plane they are dragged.
    pub plane: Drag,
    /// The grid that they snap to with Shift, mm.
    pub grid: f64,
    /// All points, and the revision and results that they are of.
    points: Vec<Handle>,
    of: Option<(u64, u64)>,
    /// The point as it was when it was taken, and its distance from the pointer then.
    taken: Option<(Handle, DVec3)>,
    chosen: Option<Handle>,
    /// The weight and the pointer's distance from its point, as they were when the ring was taken.
    weighed: Option<(f64, f32)>,
    /// Coordinates are being typed or turned as one step.
    turning: bool,
}

impl Default for Hand {
    fn default() -> Self {
        let (plane, points) = (Drag::Best, Vec::new());
        Self { plane, grid: GRID, points, of: None, taken: None, chosen: None, weighed: None, turning: false }
    }
}

impl Hand {
    /// In which plane and on which grid points are dragged, to be chosen.
    pub(super) fn choose(&mut self, ui: &mut Ui) {
        ui.horizontal(|ui| {
            ui.label("Drag points in");
            let planes = [
                (Drag::Best, "the best plane"),
                (Drag::XY, "XY"),
                (Drag::XZ, "XZ"),
                (Drag::YZ, "YZ"),
                (Drag::View, "the view"),
            ];
            for (plane, words) in planes {
                ui.selectable_value(&mut self.plane, plane, words);
            }
        });
        ui.horizontal(|ui| {
            ui.label("with Shift on a grid of");
            let field =
                ui.add(DragValue::new(&mut self.grid).range(0.01..=1e4).speed(0.5).max_decimals(2).suffix(" mm"));
            field.widget_info(|| WidgetInfo::labeled(WidgetType::DragValue, true, "grid"));
        });
    }

    /// Shows all points that are not cut away and moves the one that is taken; true if one was clicked.
    pub fn show(&mut self, ui: &mut Ui, area: Rect, camera: &Camera, clip: Option<Clip>, model: &mut Model) -> bool {
        let now = (model.revision(), model.results.count);
        if self.of != Some(now) {
            self.points = model.handles();
            self.of = Some(now);
        }
        // It was let go where this was not shown.
        if self.taken.is_some() && !ui.input(|i| i.pointer.any_down()) {
            self.taken = None;
            model.end();
        }
        let theme = Theme::of(ui);
        let painter = ui.painter_at(area);
        let mut clicked = false;
        for handle in self.points.clone() {
            let held = self.taken.as_ref().is_some_and(|(t, _)| t.same(&handle));
            if clip.is_some_and(|c| c.side(handle.at) > 0.0) && !held {
                continue;
            }
            // One that is held may leave the viewport, and comes back.
            let Some(at) = camera.project(area, handle.at).filter(|at| held || area.contains(*at)) else { continue };
            let id = Id::new(("handle", handle.label()));
            let response = ui.interact(Rect::from_center_size(at, vec2(16.0, 16.0)), id, Sense::click_and_drag());
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, format!("point {}", handle.label())));
            if response.drag_started() {
                let start = ui.input(|i| i.pointer.press_origin()).unwrap_or(at);
                let grip = self.under(ui, area, camera, &handle, start).map_or(DVec3::ZERO, |p| handle.at - p);
                self.taken = Some((handle.clone(), grip));
                self.chosen = Some(handle.clone());
                model.begin();
            }
            if response.clicked() {
                clicked = true;
                model.selection = [handle.node.clone()].into();
                self.chosen = Some(handle.clone());
            }
            if let (true, Some(pointer)) = (response.dragged(), ui.input(|i| i.pointer.latest_pos())) {
                self.drag(ui, area, camera, pointer, model);
            }
            if response.drag_stopped() && self.taken.take().is_some() {
                model.end();
            }
            let chosen = self.chosen.as_ref().is_some_and(|c| c.same(&handle));
            let lit = chosen || response.hovered() || model.selection.contains(&handle.node);
            let divides = matches!(handle.place, Place::Subdivision(_));
            let plain = if divides { Color32::from_rgb(90, 150, 230) } else { Color32::from_rgb(225, 90, 110) };
            let fill = if lit { theme.selected } else { plain };
            let radius = if response.hovered() {
                6.5
            } else if divides {
                3.5
            } else {
                5.0
            };
            painter.circle(at, radius, fill, Stroke::new(1.5, Color32::WHITE));
            response.on_hover_text(format!(
                "{}: {:.2}, {:.2}, {:.2} mm\ndrag: in a plane, with X, Y or Z held along that axis, with Shift on a grid of {} mm",
                handle.label(),
                handle.at.x,
                handle.at.y,
                handle.at.z,
                self.grid
            ));
        }
        let weighed = self.weigh(ui, area, camera, model);
        self.typed(ui, area, model) || clicked || weighed
    }

    /// A ring around the chosen control point: dragged outwards the point weighs more. True if the pointer is used there.
    fn weigh(&mut self, ui: &mut Ui, area: Rect, camera: &Camera, model: &mut Model) -> bool {
        let chosen = self.chosen.as_ref().and_then(|c| self.points.iter().find(|h| h.same(c))).cloned();
        let Some(handle) = chosen.filter(|_| self.taken.is_none()) else { return false };
        let Some(weight) = weight(&handle, model.document(), &model.catalog) else { return false };
        let Some(at) = camera.project(area, handle.at).filter(|at| area.contains(*at)) else { return false };
        // A weight of 1 is a ring of 22 points; twice the weight is 14 more.
        let radius = (22.0 + 14.0 * weight.log2() as f32).clamp(12.0, 90.0);
        let theme = Theme::of(ui);
        ui.painter_at(area).circle_stroke(at, radius, Stroke::new(1.5, theme.selected));
        let knob = at + vec2(radius, 0.0);
        let sense = Rect::from_center_size(knob, vec2(14.0, 14.0));
        let response = ui.interact(sense, Id::new("weight"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, format!("weight {}", handle.label())));
        ui.painter_at(area).circle(knob, 5.0, theme.selected, Stroke::new(1.0, Color32::WHITE));
        let (start, pointer) = ui.input(|i| (i.pointer.press_origin(), i.pointer.latest_pos()));
        if response.drag_started() {
            self.weighed = Some((weight, start.unwrap_or(knob).distance(at)));
            model.begin();
        }
        if let (true, Some(pointer), Some((first, from))) = (response.dragged(), pointer, self.weighed) {
            // The ring may be drawn larger or smaller than its weight is: only how far it is dragged counts.
            let wanted = first * f64::from((pointer.distance(at) - from) / 14.0).exp2();
            let wanted = wanted.clamp(first.min(1e-3), first.max(1e3));
            let operation = set_weight(&handle, wanted, model.document()).filter(|_| (wanted - weight).abs() > 1e-3);
            if let Some(operation) = operation {
                model.edit(operation);
            }
        }
        if response.drag_stopped() {
            model.end();
        }
        let used = response.hovered() || response.dragged();
        response.on_hover_text(format!("weight {weight:.3}: drag outwards for more"));
        used
    }

    /// Where the pointer means the point to be: in the plane that was chosen, or along an axis.
    fn under(&self, ui: &Ui, area: Rect, camera: &Camera, handle: &Handle, at: Pos2) -> Option<DVec3> {
        let (origin, direction) = camera.ray(area, at);
        let held = [Key::X, Key::Y, Key::Z].into_iter().zip(DVec3::AXES).find(|(k, _)| ui.input(|i| i.key_down(*k)));
        if let Some((_, axis)) = held {
            // The place on the axis that is nearest to the ray.
            let square = axis - direction * axis.dot(direction);
            let length = square.length_squared();
            let along = (origin - handle.at).dot(square) / length;
            return (length > 1e-9).then(|| handle.at + axis * along);
        }
        let back = camera.back();
        let normal = match self.plane {
            Drag::Best => DVec3::AXES.into_iter().max_by(|a, b| a.dot(back).abs().total_cmp(&b.dot(back).abs()))?,
            Drag::XY => DVec3::Z,
            Drag::XZ => DVec3::Y,
            Drag::YZ => DVec3::X,
            Drag::View => back,
        };
        // A plane that is seen from its edge would send the point anywhere.
        if direction.dot(normal).abs() < 0.02 {
            return None;
        }
        let along = (handle.at - origin).dot(normal) / direction.dot(normal);
        (along.is_finite() && along > 0.0).then(|| origin + direction * along)
    }

    fn drag(&mut self, ui: &Ui, area: Rect, camera: &Camera, pointer: Pos2, model: &mut Model) {
        let Some((start, grip)) = &self.taken else { return };
        let held = ui.input(|i| [Key::X, Key::Y, Key::Z].into_iter().any(|k| i.key_down(k)));
        let grip = if held { DVec3::ZERO } else { *grip };
        let Some(mut to) = self.under(ui, area, camera, start, pointer).map(|p| p + grip) else { return };
        if ui.input(|i| i.modifiers.shift) {
            to = (to / self.grid).round() * self.grid;
        }
        let now = self.points.iter().find(|h| h.same(start)).cloned().unwrap_or_else(|| start.clone());
        let operation = now.move_to(to, model.document()).filter(|_| (now.at - to).length() > 5e-3);
        if let Some(operation) = operation {
            model.edit(operation);
        }
    }

    /// The coordinates of the chosen point, to be typed; true if the pointer is used there.
    fn typed(&mut self, ui: &mut Ui, area: Rect, model: &mut Model) -> bool {
        let chosen = self.chosen.as_ref().and_then(|c| self.points.iter().find(|h| h.same(c))).cloned();
        let Some(handle) = chosen.filter(|h| model.selection.contains(&h.node) || self.taken.is_some()) else {
            self.chosen = None;
            if std::mem::take(&mut self.turning) {
                model.end();
            }
            return false;
        };
        let mut to = handle.at;
        let place = Area::new(Id::new("coordinates"))
            .order(Order::Middle)
            .fixed_pos(area.left_top() + vec2(8.0, 38.0))
            .constrain_to(area);
        let shown = place.show(ui.ctx(), |ui| {
            Frame::popup(ui.style())
                .inner_margin(4.0)
                .show(ui, |ui| {
                    ui.horizontal(|ui| {
                        ui.label(handle.label());
                        let mut settled = true;
                        for (axis, value) in ["x", "y", "z"].into_iter().zip([&mut to.x, &mut to.y, &mut to.z]) {
                            let field = figure(value, "mm")
                                .speed(1.0)
                                .max_decimals(2)
                                .update_while_editing(false)
                                .prefix(format!("{axis} "))
                                .suffix(" mm");
                            let response = ui.add(field);
                            response.widget_info(|| {
                                WidgetInfo::labeled(
                                    WidgetType::DragValue,
                                    true,
                                    format!("{axis} of {}", handle.label()),
                                )
                            });
                            // From the first field that is typed in to the last it is one step.
                            settled &= !response.dragged() && !response.has_focus();
                        }
                        settled
                    })
                    .inner
                })
                .inner
        });
        let settled = shown.inner;
        if !settled && !self.turning {
            model.begin();
            self.turning = true;
        }
        let escaped = escaped(ui);
        if to != handle.at
            && !escaped
            && let Some(operation) = handle.move_to(to, model.document())
        {
            model.edit(operation);
        }
        if settled && std::mem::take(&mut self.turning) {
            if escaped { model.abort() } else { model.end() }
        }
        shown.response.contains_pointer()
    }
}
