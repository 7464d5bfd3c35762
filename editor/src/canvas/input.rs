//! Typing on the canvas: a value into an input, or another id for a node.

use super::shape::{HEADER, Row, Shapes};
use crate::model::Model;
use crate::model::param;
use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::{Area, Frame, Id, Key, Order, Rect, ScrollArea, TextEdit, Ui, vec2};
use tenon_engine::Literal;
use tenon_engine::Operation;

/// A field that is open on the canvas.
pub struct Typing {
    node: String,
    /// The input, or none for the node's id.
    port: Option<String>,
    text: String,
    /// The field has the keyboard.
    begun: bool,
}

impl Typing {
    /// A field for the value of an input.
    pub fn new(node: String, port: String, model: &Model) -> Self {
        let there = model.document().nodes().get(&node);
        let value = there.and_then(|n| n.params.get(&port)).map(Literal::to_json).or_else(|| {
            let info = model.catalog.get(&there?.type_name)?;
            info.inputs.iter().find(|p| p.name == port)?.default.clone()
        });
        Self { node, port: Some(port), text: param::to_text(value.as_ref()), begun: false }
    }

    /// A field for the id of a node.
    pub fn rename(node: String) -> Self {
        Self { text: node.clone(), node, port: None, begun: false }
    }

    /// Where it stands on the canvas; none if there is no such place any more.
    pub fn place(&self, shapes: &Shapes) -> Option<Rect> {
        let shape = &shapes.nodes[shapes.find(&self.node)?];
        let Some(port) = &self.port else {
            let mut rect = shape.rect;
            rect.set_height(HEADER);
            return Some(rect);
        };
        let i = shape.inputs.iter().position(|p| p.name == *port)?;
        let row = shape.rows.iter().position(|r| matches!(r, Row::Input(p, _) if *p == i))?;
        Some(shape.row_rect(row))
    }

    /// Shows it at `place`; false once it is closed.
    pub fn show(&mut self, ui: &mut Ui, place: Rect, area: Rect, model: &mut Model, zoom: f32) -> bool {
        let choices = self.choices(model);
        let mut open = true;
        let id = Id::new(("typing", &self.node, &self.port));
        let shown =
            Area::new(id).order(Order::Foreground).fixed_pos(place.min).constrain_to(area).show(ui.ctx(), |ui| {
                Frame::popup(ui.style()).inner_margin(2.0).show(ui, |ui| {
                    if choices.is_empty() {
                        open = self.field(ui, place.width().max(160.0 * zoom.max(1.0)), model);
                    } else {
                        ui.set_min_width(place.width());
                        ScrollArea::vertical().max_height(260.0).show(ui, |ui| {
                            for choice in &choices {
                                if ui.selectable_label(*choice == self.text, choice).clicked() {
                                    self.text.clone_from(choice);
                                    self.commit(model);
                                    open = false;
                                }
                            }
                        });
                        open &= !ui.input(|i| i.key_pressed(Key::Escape));
                    }
                });
            });
        if self.begun && shown.response.clicked_elsewhere() {
            if choices.is_empty() {
                self.commit(model);
            }
            open = false;
        }
        self.begun = true;
        open
    }

    fn field(&mut self, ui: &mut Ui, width: f32, model: &mut Model) -> bool {
        let field = ui.add_sized(vec2(width, 22.0), TextEdit::singleline(&mut self.text).id_salt("typing-field"));
        if !self.begun {
            field.request_focus();
            if let Some(mut state) = TextEdit::load_state(ui.ctx(), field.id) {
                let all = CCursorRange::two(CCursor::new(0), CCursor::new(self.text.chars().count()));
                state.cursor.set_char_range(Some(all));
                state.store(ui.ctx(), field.id);
            }
            return true;
        }
        if ui.input(|i| i.key_pressed(Key::Escape)) {
            return false;
        }
        if ui.input(|i| i.key_pressed(Key::Enter)) {
            self.commit(model);
            return false;
        }
        true
    }

    fn choices(&self, model: &Model) -> Vec<String> {
        let port = || {
            let node = model.document().nodes().get(&self.node)?;
            let info = model.catalog.get(&node.type_name)?;
            Some(info.inputs.iter().find(|p| Some(&p.name) == self.port.as_ref())?.choices.clone())
        };
        port().unwrap_or_default()
    }

    fn commit(&self, model: &mut Model) {
        let Some(port) = &self.port else {
            let to = self.text.trim();
            if to != self.node {
                let chosen = model.selection.contains(&self.node);
                let done = model.edit(Operation::Rename { from: self.node.clone(), to: to.into() });
                if done && chosen {
                    model.selection.insert(to.into());
                }
            }
            return;
        };
        let node = model.document().nodes().get(&self.node);
        let info = node.and_then(|n| model.catalog.get(&n.type_name)).cloned();
        let Some(input) = info.as_ref().and_then(|t| t.inputs.iter().find(|p| p.name == *port)) else { return };
        let value = param::from_text(input, &self.text);
        let old = model.param(&self.node, port);
        if value != old && !(old.is_none() && value == input.default) {
            model.edit(Operation::SetParam { node: self.node.clone(), port: port.clone(), value });
        }
    }
}
