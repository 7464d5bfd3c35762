//! The finder: type a few letters, get a node; type a number or `0<5<10`, get a slider. Opened by a wire it offers what the
//! wire fits and connects it.

use super::shape::Shapes;
use super::wiring::End;
use crate::model::Model;
use crate::model::catalog::TypeInfo;
use crate::model::param::{Typed, shown};
use crate::theme;
use eframe::egui::{Area, Frame, Id, Key, Order, Pos2, Rect, RichText, ScrollArea, TextEdit, Ui, Vec2, vec2};
use std::sync::Arc;
use tenon_engine::{Json, Operation};

/// Room that a full list takes.
const ROOM: Vec2 = vec2(320.0, 350.0);

/// What came of a frame of the finder.
pub enum Found {
    /// It stays open.
    Open,
    /// It was closed.
    Closed,
    /// This was chosen.
    Chosen(Offer),
}

/// What the finder offers.
#[derive(Clone, Debug)]
pub enum Offer {
    /// A node of a type.
    Type(Arc<TypeInfo>),
    /// A slider that was typed.
    Slider(Typed),
    /// A text that was typed after a quotation mark.
    Text(String),
}

impl Offer {
    fn type_name(&self) -> &str {
        match self {
            Self::Type(t) => &t.type_name,
            Self::Slider(typed) => typed.type_name(),
            Self::Text(_) => "text",
        }
    }

    fn title(&self) -> String {
        match self {
            Self::Type(t) => t.title.clone(),
            Self::Text(text) => format!("Text “{text}”"),
            Self::Slider(typed) => {
                let s = &typed.slider;
                let space = if typed.unit.is_empty() { "" } else { " " };
                format!("Slider {} < {} < {}{space}{}", shown(s.min), shown(s.value), shown(s.max), typed.unit)
            }
        }
    }

    fn params(&self) -> Vec<(&'static str, Json)> {
        match self {
            Self::Type(_) => Vec::new(),
            Self::Slider(typed) => typed.params(),
            Self::Text(text) => vec![("value", Json::from(text.as_str()))],
        }
    }
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

    /// The port of a type that the wire would go to; none if there is no wire, or none that it fits.
    fn port<'a>(&self, model: &Model, t: &'a TypeInfo) -> Option<&'a str> {
        let wire = self.wire.as_ref()?;
        let ports = if wire.output { &t.inputs } else { &t.outputs };
        let best = model.catalog.best(&wire.type_name, wire.output, ports, |_| true)?;
        ports.get(best).map(|p| p.name.as_str())
    }

    fn fits(&self, model: &Model, t: &TypeInfo) -> bool {
        self.wire.is_none() || self.port(model, t).is_some()
    }

    /// What was typed as a value, then node types.
    fn offers(&self, model: &Model) -> Vec<Offer> {
        let typed = self.typed.trim();
        let slider = Typed::read(typed).map(Offer::Slider);
        let text = typed.strip_prefix('"').map(|t| t.strip_suffix('"').unwrap_or(t)).filter(|t| !t.is_empty());
        let value = slider.or(text.map(|t| Offer::Text(t.to_owned())));
        let value = value.filter(|v| model.catalog.get(v.type_name()).is_some_and(|t| self.fits(model, t)));
        let types = model.catalog.find(&self.typed, |t| self.fits(model, t));
        value.into_iter().chain(types.into_iter().map(Offer::Type)).collect()
    }

    /// Shows it.
    pub fn show(&mut self, ui: &mut Ui, area: Rect, model: &Model) -> Found {
        let all = self.offers(model);
        let mut found = Found::Open;
        // Where there is room for a full list, so that it does not jump while it grows and shrinks.
        let room = area.max - ROOM;
        let at = self.at.min(room).max(area.min);
        let shown = Area::new(Id::new("finder")).order(Order::Foreground).fixed_pos(at).constrain_to(area).show(
            ui.ctx(),
            |ui| {
                Frame::popup(ui.style()).show(ui, |ui| {
                    ui.set_width(300.0);
                    let hint = self.wire.as_ref().map_or("find a node, or type 0<5<10".to_owned(), |w| {
                        format!("find a node for {}", w.type_name)
                    });
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
                    found = self.list(ui, &all, down || up, model);
                    if let Some(t) = all.get(self.chosen).filter(|_| enter) {
                        found = Found::Chosen(t.clone());
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

    fn list(&self, ui: &mut Ui, all: &[Offer], moved: bool, model: &Model) -> Found {
        let mut found = Found::Open;
        if all.is_empty() {
            ui.label("nothing has that name");
        }
        ScrollArea::vertical().max_height(240.0).show(ui, |ui| {
            ui.set_width(ui.available_width());
            for (i, offer) in all.iter().enumerate() {
                let Some(t) = model.catalog.get(offer.type_name()) else { continue };
                let row = ui.horizontal(|ui| {
                    let (rect, _) = ui.allocate_exact_size(vec2(8.0, 8.0), eframe::egui::Sense::hover());
                    let colour = theme::category_colour(&t.category, &theme::Theme::of(ui));
                    ui.painter().circle_filled(rect.center(), 4.0, colour);
                    let label = ui.selectable_label(i == self.chosen, offer.title()).on_hover_text(&t.doc);
                    ui.label(RichText::new(&t.category).weak().small());
                    if let Some(port) = self.port(model, t) {
                        let arrow = if self.wire.as_ref().is_some_and(|w| w.output) { "to" } else { "from" };
                        ui.label(RichText::new(format!("{arrow} {port}")).small());
                    }
                    label
                });
                if row.inner.clicked() {
                    found = Found::Chosen(offer.clone());
                }
                if i == self.chosen && moved {
                    row.response.scroll_to_me(None);
                }
            }
        });
        if let Some(t) = all.get(self.chosen).and_then(|o| model.catalog.get(o.type_name())) {
            ui.separator();
            ui.label(RichText::new(&t.doc).small());
        }
        found
    }

    /// Adds what was chosen, with the wire if there is one, as one step.
    pub fn add(&self, model: &mut Model, offer: &Offer, at: Pos2, shapes: &Shapes) {
        let type_name = offer.type_name();
        let (id, add) = model.new_node(type_name, [f64::from(at.x), f64::from(at.y)]);
        let mut all = vec![add];
        let set = |(port, value): (&str, Json)| Operation::SetParam {
            node: id.clone(),
            port: port.to_owned(),
            value: Some(value),
        };
        all.extend(offer.params().into_iter().map(set));
        let info = model.catalog.get(type_name).cloned();
        let mut said = None;
        if let (Some(wire), Some(info)) = (self.wire.as_ref().filter(|w| shapes.find(&w.node).is_some()), info) {
            if wire.output {
                let port = self.port(model, &info);
                let from = format!("{}.{}", wire.node, wire.port);
                said = port.map(|p| format!("the wire goes to {id}.{p}"));
                all.extend(port.map(|p| Operation::Connect { node: id.clone(), port: p.to_owned(), from, at: None }));
            } else {
                let port = self.port(model, &info);
                said = port.map(|p| format!("the wire comes from {id}.{p}"));
                all.extend(port.map(|p| model.new_wire(&format!("{id}.{p}"), &wire.node, &wire.port)));
            }
        }
        if model.edit(Operation::All(all)) {
            model.said = said;
            model.selection = [id].into();
        }
    }
}
