//! The finder: type a few letters, get a node. Opened by a wire it offers what the wire fits and connects it.

use super::gesture::End;
use super::shape::Shapes;
use crate::model::Model;
use crate::model::catalog::TypeInfo;
use crate::theme;
use eframe::egui::{Area, Frame, Id, Key, Order, Pos2, Rect, RichText, ScrollArea, TextEdit, Ui, vec2};
use std::sync::Arc;
use tenon_engine::Operation;

/// What came of a frame of the finder.
pub enum Found {
    /// It stays open.
    Open,
    /// It was closed.
    Closed,
    /// This type was chosen.
    Type(String),
}

/// An open finder.
pub struct Finder {
    /// Where on screen it was asked for.
    pub at: Pos2,
    wire: Option<End>,
    typed: String,
    chosen: usize,
    begun: bool,
}

impl Finder {
    /// Opens at a place on screen, for a wire if one was let go there.
    pub fn new(at: Pos2, wire: Option<End>) -> Self {
        Self { at, wire, typed: String::new(), chosen: 0, begun: false }
    }

    fn fits(&self, model: &Model, t: &TypeInfo) -> bool {
        let Some(wire) = &self.wire else { return true };
        match wire.output {
            true => t.inputs.iter().any(|p| model.catalog.fits(&wire.type_name, &p.type_name)),
            false => t.outputs.iter().any(|p| model.catalog.fits(&p.type_name, &wire.type_name)),
        }
    }

    /// Shows it.
    pub fn show(&mut self, ui: &mut Ui, area: Rect, model: &Model) -> Found {
        let all = model.catalog.find(&self.typed, |t| self.fits(model, t));
        let mut found = Found::Open;
        let shown = Area::new(Id::new("finder")).order(Order::Foreground).fixed_pos(self.at).constrain_to(area).show(
            ui.ctx(),
            |ui| {
                Frame::popup(ui.style()).show(ui, |ui| {
                    ui.set_width(300.0);
                    let hint = self
                        .wire
                        .as_ref()
                        .map_or("find a node".to_owned(), |w| format!("find a node for {}", w.type_name));
                    let field = ui.add_sized(vec2(300.0, 22.0), TextEdit::singleline(&mut self.typed).hint_text(hint));
                    if !self.begun {
                        field.request_focus();
                    }
                    if field.changed() {
                        self.chosen = 0;
                    }
                    let (down, up, enter, escape) = ui.input(|i| {
                        let key = |k| i.key_pressed(k);
                        (key(Key::ArrowDown), key(Key::ArrowUp), key(Key::Enter), key(Key::Escape))
                    });
                    self.chosen = (self.chosen + usize::from(down))
                        .saturating_sub(usize::from(up))
                        .min(all.len().saturating_sub(1));
                    found = self.list(ui, &all, down || up);
                    if let Some(t) = all.get(self.chosen).filter(|_| enter) {
                        found = Found::Type(t.type_name.clone());
                    }
                    if escape {
                        found = Found::Closed;
                    }
                });
            },
        );
        if self.begun && shown.response.clicked_elsewhere() && matches!(found, Found::Open) {
            found = Found::Closed;
        }
        self.begun = true;
        found
    }

    fn list(&self, ui: &mut Ui, all: &[Arc<TypeInfo>], moved: bool) -> Found {
        let mut found = Found::Open;
        if all.is_empty() {
            ui.label("nothing has that name");
        }
        ScrollArea::vertical().max_height(240.0).show(ui, |ui| {
            ui.set_width(ui.available_width());
            for (i, t) in all.iter().enumerate() {
                let row = ui.horizontal(|ui| {
                    let (rect, _) = ui.allocate_exact_size(vec2(8.0, 8.0), eframe::egui::Sense::hover());
                    let colour = theme::category_colour(&t.category, &theme::Theme::of(ui));
                    ui.painter().circle_filled(rect.center(), 4.0, colour);
                    let label = ui.selectable_label(i == self.chosen, &t.title).on_hover_text(&t.doc);
                    ui.label(RichText::new(&t.category).weak().small());
                    label
                });
                if row.inner.clicked() {
                    found = Found::Type(t.type_name.clone());
                }
                if i == self.chosen && moved {
                    row.response.scroll_to_me(None);
                }
            }
        });
        if let Some(t) = all.get(self.chosen) {
            ui.separator();
            ui.label(RichText::new(&t.doc).small());
        }
        found
    }

    /// Adds a node of that type, with the wire if there is one, as one step.
    pub fn add(&self, model: &mut Model, type_name: &str, at: Pos2, shapes: &Shapes) {
        let (id, add) = model.new_node(type_name, [f64::from(at.x), f64::from(at.y)]);
        let mut all = vec![add];
        let info = model.catalog.get(type_name).cloned();
        if let (Some(wire), Some(info)) = (self.wire.as_ref().filter(|w| shapes.find(&w.node).is_some()), info) {
            if wire.output {
                let port = info.inputs.iter().find(|p| model.catalog.fits(&wire.type_name, &p.type_name));
                let from = format!("{}.{}", wire.node, wire.port);
                all.extend(port.map(|p| Operation::Connect { node: id.clone(), port: p.name.clone(), from, at: None }));
            } else {
                let port = info.outputs.iter().find(|p| model.catalog.fits(&p.type_name, &wire.type_name));
                all.extend(port.map(|p| model.new_wire(&format!("{id}.{}", p.name), &wire.node, &wire.port)));
            }
        }
        if model.edit(Operation::All(all)) {
            model.selection = [id].into();
        }
    }
}
