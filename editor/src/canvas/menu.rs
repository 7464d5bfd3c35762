//! The context menu of the canvas, and groups behind their nodes.

use super::align;
use super::hit::Hit;
use super::input::Typing;
use super::paint::Paint;
use super::shape::Shapes;
use super::{Canvas, Finder};
use crate::model::Model;
use crate::theme;
use eframe::egui::{Align2, FontId, Rect, Response, Stroke, StrokeKind, vec2};
use tenon_engine::{Json, NodeState, Operation};

impl Canvas {
    pub(super) fn context_menu(&mut self, response: &Response, model: &mut Model) {
        let hit = self.menu_on.unwrap_or(Hit::Nothing);
        response.context_menu(|ui| {
            let Some(shape) = hit.node().and_then(|n| self.shapes.nodes.get(n)) else {
                if ui.button("Add a node …").clicked() {
                    let at = response.interact_pointer_pos().or_else(|| ui.input(|i| i.pointer.latest_pos()));
                    self.finder = Some(Finder::new(at.unwrap_or(response.rect.center()), None));
                    ui.close();
                }
                if ui.button("Show all").clicked() {
                    model.selection.clear();
                    self.fit = true;
                    ui.close();
                }
                return;
            };
            let id = shape.id.clone();
            ui.strong(&id);
            let state = |s: NodeState| -> Vec<Operation> {
                model.selection.iter().map(|id| Operation::SetState { node: id.clone(), state: s }).collect()
            };
            let all = [
                ("Enable", NodeState::On),
                ("Freeze", NodeState::Frozen),
                ("Bypass", NodeState::Bypassed),
                ("Disable", NodeState::Disabled),
            ];
            let mut operation = None;
            for (words, s) in all {
                if ui.add_enabled(shape.state != s, eframe::egui::Button::new(words)).clicked() {
                    operation = Some(Operation::All(state(s)));
                    ui.close();
                }
            }
            ui.separator();
            let shows = model.previews(&id);
            if ui.button(if shows { "Hide in the viewport" } else { "Show in the viewport" }).clicked() {
                for id in model.selection.clone() {
                    model.set_preview(&id, !shows);
                }
                ui.close();
            }
            if ui.button("Rename …").clicked() {
                self.typing = Some(Typing::rename(id.clone()));
                ui.close();
            }
            if let Hit::Input(n, i) = hit
                && let Some(port) = self.shapes.nodes.get(n).and_then(|s| s.inputs.get(i))
                && ui.button(format!("Take all wires off {}", port.name)).clicked()
            {
                operation = Some(Operation::PutWires { node: id.clone(), port: port.name.clone(), wires: None });
                ui.close();
            }
            if model.selection.len() > 1 {
                ui.menu_button("Align", |ui| {
                    for (words, how) in align::ALL {
                        if ui.button(words).clicked() {
                            operation = align::align(model, &self.shapes, how);
                            ui.close();
                        }
                    }
                });
            }
            ui.separator();
            if ui.button("Duplicate").clicked() {
                model.message = model.duplicate([40.0, 40.0]).err();
                ui.close();
            }
            if ui.button("Group").clicked() {
                operation = Some(group(model));
                ui.close();
            }
            if ui.button("Make a cluster").clicked() {
                model.message = model.gather().err();
                ui.close();
            }
            if shape.info.type_name.starts_with("cluster:") && ui.button("Explode the cluster").clicked() {
                model.message = model.explode(&id).err();
                ui.close();
            }
            if ui.button("Delete").clicked() {
                model.delete_selection();
                ui.close();
            }
            if let Some(operation) = operation {
                model.edit(operation);
            }
        });
    }
}

/// The operation that groups the selected nodes.
pub fn group(model: &Model) -> Operation {
    let taken = |n: &str| model.document().groups.contains_key(n);
    let name = (1u64..).map(|n| format!("group {n}")).find(|n| !taken(n)).unwrap_or_default();
    Operation::SetGroup { name, nodes: Some(model.selection.iter().cloned().collect()) }
}

/// Paints groups: a field around the nodes with the group's name on it.
pub fn groups(p: &Paint, shapes: &Shapes) {
    for (name, group) in &p.model.document().groups {
        let members = group.get("nodes").and_then(Json::as_array).into_iter().flatten().filter_map(Json::as_str);
        let rects = members.filter_map(|id| shapes.find(id)).map(|n| p.moved(&shapes.nodes[n]));
        let Some(bounds) = rects.reduce(Rect::union) else { continue };
        let bounds = Rect::from_min_max(bounds.min - vec2(14.0, 34.0), bounds.max + vec2(14.0, 14.0));
        let rect = p.view.rect_to_screen(p.area, bounds);
        if !rect.intersects(p.area) {
            continue;
        }
        let colour = theme::type_colour("layout");
        p.painter.rect(rect, 6.0, colour.gamma_multiply(0.18), Stroke::new(1.0, colour), StrokeKind::Inside);
        let size = 14.0 * p.view.zoom;
        if size > 4.0 {
            let title = group.get("title").and_then(Json::as_str).unwrap_or(name);
            let at = rect.min + vec2(8.0, 5.0) * p.view.zoom;
            p.painter.text(at, Align2::LEFT_TOP, title, FontId::proportional(size.round()), p.theme.text);
        }
    }
}
