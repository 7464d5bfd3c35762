//! The finder: type a few letters, get a node; type a number or `0<5<10`, get a slider. Opened by a wire it offers what the
//! wire fits and connects it.

use super::chooser::{Chooser, Chosen, Entries};
use super::shape::Shapes;
use super::wiring::End;
use crate::model::Model;
use crate::model::catalog::TypeInfo;
use crate::model::param::{Typed, shown};
use crate::theme;
use eframe::egui::{Pos2, Rect, Response, RichText, Sense, Ui, vec2};
use std::sync::Arc;
use tenon_engine::{Json, Operation};

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
    chooser: Chooser,
}

/// Offers as they stand in the list.
struct Offers<'a> {
    all: &'a [Offer],
    /// The port of each that the wire would go to, and in which direction that is.
    ports: Vec<Option<String>>,
    arrow: &'a str,
    model: &'a Model,
}

impl Offers<'_> {
    fn info(&self, entry: usize) -> Option<&Arc<TypeInfo>> {
        self.model.catalog.get(self.all.get(entry)?.type_name())
    }
}

impl Entries for Offers<'_> {
    fn count(&self) -> usize {
        self.all.len()
    }

    fn row(&self, ui: &mut Ui, entry: usize, chosen: bool) -> Response {
        let category = self.info(entry).map_or("", |t| &t.category);
        let row = ui.horizontal(|ui| {
            let (rect, _) = ui.allocate_exact_size(vec2(8.0, 8.0), Sense::hover());
            ui.painter().circle_filled(rect.center(), 4.0, theme::category_colour(category, &theme::Theme::of(ui)));
            let label = ui.selectable_label(chosen, self.all[entry].title());
            ui.label(RichText::new(category).weak().small());
            if let Some(port) = &self.ports[entry] {
                ui.label(RichText::new(format!("{} {port}", self.arrow)).small());
            }
            label
        });
        row.inner.on_hover_text(self.about(entry).unwrap_or_default())
    }

    fn about(&self, entry: usize) -> Option<&str> {
        self.info(entry).map(|t| t.doc.as_str())
    }
}

impl Finder {
    /// Opens at a place on screen, for a wire if one was let go there.
    pub fn new(at: Pos2, wire: Option<End>) -> Self {
        Self { at, wire, chooser: Chooser::default() }
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
        let typed = self.chooser.typed.trim();
        let slider = Typed::read(typed).map(Offer::Slider);
        let text = typed.strip_prefix('"').map(|t| t.strip_suffix('"').unwrap_or(t)).filter(|t| !t.is_empty());
        let value = slider.or(text.map(|t| Offer::Text(t.to_owned())));
        let value = value.filter(|v| model.catalog.get(v.type_name()).is_some_and(|t| self.fits(model, t)));
        let types = model.catalog.find(&self.chooser.typed, |t| self.fits(model, t));
        value.into_iter().chain(types.into_iter().map(Offer::Type)).collect()
    }

    /// Shows it.
    pub fn show(&mut self, ui: &Ui, area: Rect, model: &Model) -> Found {
        let (all, hint) = (self.offers(model), self.wire.as_ref());
        let hint =
            hint.map_or("find a node, or type 0<5<10".to_owned(), |w| format!("find a node for {}", w.type_name));
        let ports =
            all.iter().map(|o| self.port(model, model.catalog.get(o.type_name())?).map(str::to_owned)).collect();
        let arrow = if self.wire.as_ref().is_some_and(|w| w.output) { "to" } else { "from" };
        let offers = Offers { all: &all, ports, arrow, model };
        match self.chooser.show(ui, area, self.at, &hint, &offers) {
            Chosen::Open => Found::Open,
            Chosen::Closed => Found::Closed,
            Chosen::Entry(i) => all.get(i).cloned().map_or(Found::Closed, Found::Chosen),
        }
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
