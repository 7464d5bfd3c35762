//! The canvas: nodes and wires of the document, painted and moved by hand. It owns what is only seen (which part, what is
//! folded, what is being dragged); every change goes to the model as an operation.

mod align;
mod chooser;
mod finder;
mod gesture;
mod groups;
mod hit;
mod input;
mod menu;
mod paint;
mod search;
mod shape;
mod sheet;
mod tip;
mod view;
mod wiring;

pub use finder::Finder;
pub use groups::{group, ungroup};
pub use paint::{Strands, strands};
pub use shape::{Row, Shapes};
pub use tip::{bytes, value as value_in_short};
pub use view::View;

use crate::model::Model;
use crate::panels::entries::Entries;
use crate::panels::table::Table;
use crate::theme::Theme;
use eframe::egui::{self, Id, Rect, Sense, Ui, Vec2, WidgetInfo, WidgetType};
use gesture::Gesture;
use hit::Hit;
use input::Typing;
use paint::Paint;
use search::{Search, Sought};
use std::collections::{BTreeSet, HashMap};

/// The canvas of one window.
pub struct Canvas {
    /// Which part is seen.
    pub view: View,
    /// What is drawn.
    pub shapes: Shapes,
    /// The first line that sheets show, by node.
    scrolls: HashMap<String, f32>,
    entries: Option<Entries>,
    gesture: Gesture,
    typing: Option<Typing>,
    table: Option<Table>,
    finder: Option<Finder>,
    search: Option<Search>,
    /// What the context menu was opened on.
    menu_on: Option<Hit>,
    /// Where on screen it was opened.
    menu_at: egui::Pos2,
    /// Everything is to be brought into view, as after opening.
    fit: bool,
    /// Where it was shown last.
    area: Rect,
}

impl Default for Canvas {
    fn default() -> Self {
        Self {
            view: View::default(),
            shapes: Shapes::default(),
            scrolls: HashMap::new(),
            entries: None,
            gesture: Gesture::Idle,
            typing: None,
            table: None,
            finder: None,
            search: None,
            menu_on: None,
            menu_at: egui::Pos2::ZERO,
            fit: false,
            area: Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(800.0, 600.0)),
        }
    }
}

impl Canvas {
    /// After another graph was opened: shows all.
    pub fn opened(&mut self) {
        self.scrolls.clear();
        self.entries = None;
        self.typing = None;
        self.table = None;
        (self.finder, self.search) = (None, None);
        self.gesture = Gesture::Idle;
        self.fit = true;
    }

    /// Shows everything, or what is selected, at the next frame.
    pub fn show_all(&mut self) {
        self.fit = true;
    }

    /// Puts what is being typed into the graph, as leaving the field does.
    pub fn settle(&self, model: &mut Model) {
        if let Some(typing) = &self.typing {
            typing.commit(model);
        }
    }

    /// Whether keys belong to a field that is open.
    #[must_use]
    pub fn is_typing(&self) -> bool {
        self.typing.is_some() || self.finder.is_some() || self.search.is_some()
    }

    /// Whether a window over the canvas waits for Escape.
    #[must_use]
    pub fn has_window(&self) -> bool {
        self.is_typing() || self.table.is_some() || self.entries.is_some()
    }

    /// Places nodes that have no place yet.
    fn arrange(&mut self, model: &mut Model) {
        let homeless: BTreeSet<String> =
            model.document().nodes().keys().filter(|id| model.position(id).is_none()).cloned().collect();
        if homeless.is_empty() {
            return;
        }
        let mut all: Vec<_> = crate::model::arrange::arrange(model.document(), |id| self.shapes.size(id))
            .into_iter()
            .filter(|(id, _)| homeless.contains(id))
            .collect();
        // Below those that have one.
        let settled = self.shapes.nodes.iter().filter(|s| !homeless.contains(&s.id)).map(|s| s.rect);
        if let Some(settled) = settled.reduce(Rect::union) {
            let least = |k: usize| all.iter().map(|(_, at)| at[k]).fold(f64::INFINITY, f64::min);
            let by = [f64::from(settled.left()) - least(0), f64::from(settled.bottom()) + 40.0 - least(1)];
            all.iter_mut().for_each(|(_, at)| *at = [at[0] + by[0], at[1] + by[1]]);
        }
        model.place(all);
        self.shapes.update(model);
        self.shapes.homeless = false;
    }

    /// Shows the canvas in all the room that `ui` has.
    pub fn show(&mut self, ui: &mut Ui, model: &mut Model) {
        let area = ui.available_rect_before_wrap();
        self.area = area;
        let id = Id::new("canvas");
        let response = ui.interact(area, id, Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "canvas"));
        self.shapes.update(model);
        // Nodes may come without a place at any time: from other files, from other programs.
        if self.shapes.homeless {
            self.arrange(model);
        }
        if std::mem::take(&mut self.fit) {
            let chosen =
                model.selection.iter().filter_map(|id| self.shapes.find(id)).map(|n| self.shapes.nodes[n].rect);
            if let Some(content) = chosen.reduce(Rect::union).or_else(|| self.shapes.bounds()) {
                self.view.fit(area, content);
            }
        }
        self.gestures(ui, &response, model);
        self.shapes.update(model);
        self.paint(ui, area, model);
        self.name_what_is_seen(ui, area, model);
        self.context_menu(&response, model);
        self.shapes.update(model);
        self.typing(ui, area, model);
        if let Some(mut table) = self.table.take()
            && table.window(ui, area, model)
        {
            self.table = Some(table);
        }
        if let Some(mut entries) = self.entries.take()
            && entries.window(ui, area, model)
        {
            self.entries = Some(entries);
        }
        self.find(ui, area, model);
    }

    fn paint(&self, ui: &Ui, area: Rect, model: &Model) {
        let offset = self.gesture.offset().unwrap_or(Vec2::ZERO);
        let painter = ui.painter_at(area);
        let (scrolls, copies) = (&self.scrolls, self.gesture.copies());
        let p = Paint { painter, area, view: self.view, theme: Theme::of(ui), model, offset, scrolls, copies };
        p.grid();
        groups::paint(&p, &self.shapes);
        p.wires(&self.shapes);
        match self.gesture.wire() {
            Some(end) => {
                let fits = |shape: &shape::Shape, output: bool, port: usize| {
                    end.fits(&self.shapes, model, shape, output, port)
                };
                p.nodes(&self.shapes, Some(&fits));
            }
            None => p.nodes(&self.shapes, None),
        }
        self.gesture.paint(&p, &self.shapes, ui.input(|i| i.pointer.latest_pos()));
        p.map(&self.shapes);
    }

    /// Tells screen readers and tests what stands where, and shows tooltips. Only of what can be read at this scale.
    fn name_what_is_seen(&self, ui: &Ui, area: Rect, model: &Model) {
        if self.view.zoom < 0.3 {
            return;
        }
        let seen = self.view.seen(area);
        let pointer = ui.input(|i| i.pointer.latest_pos());
        let tips = self.gesture.is_idle() && pointer.is_none_or(|at| self.map_at(area, at).is_none());
        for name in model.document().groups.keys() {
            let Some(strip) = groups::strip(model.document(), &self.shapes, name) else { continue };
            let rect = self.view.rect_to_screen(area, strip).intersect(area);
            let title = groups::title(model.document(), name);
            let response = ui.interact(rect, Id::new(("group", name)), Sense::hover());
            response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, format!("group {title}")));
        }
        for shape in self.shapes.nodes.iter().filter(|s| s.rect.intersects(seen)) {
            let id = Id::new(("node", &shape.id));
            let mut header = shape.rect;
            if matches!(shape.kind, shape::Kind::Node | shape::Kind::Sheet) {
                header.set_height(shape::HEADER);
            }
            let rect = self.view.rect_to_screen(area, header).intersect(area);
            let node = ui.interact(rect, id, Sense::hover());
            node.widget_info(|| WidgetInfo {
                current_text_value: Some(paint::state(model, shape)).filter(|_| shape.kind == shape::Kind::Node),
                ..WidgetInfo::labeled(WidgetType::Other, true, format!("node {}", shape.id))
            });
            self.name_lines(ui, area, model, shape);
            if tips {
                node.on_hover_ui(|ui| tip::node(ui, model, shape));
            }
            if let Some(badge) = paint::badge(shape, model) {
                let rect = self.view.rect_to_screen(area, badge).intersect(area);
                let response = ui.interact(rect, Id::new(("badge", &shape.id)), Sense::hover());
                response
                    .widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, format!("problems of {}", shape.id)));
                if tips {
                    response.on_hover_ui(|ui| tip::problems(ui, model, shape));
                }
            }
            if self.view.zoom < 0.45 || shape.kind == shape::Kind::Note {
                continue;
            }
            for (r, row) in shape.rows.iter().enumerate() {
                let (label, port, output) = match row {
                    shape::Row::Output(o) => (format!("output {}.{}", shape.id, shape.outputs[*o].name), *o, true),
                    shape::Row::Input(i, _) => (format!("input {}.{}", shape.id, shape.inputs[*i].name), *i, false),
                    shape::Row::More(_) => (format!("inputs of {}", shape.id), usize::MAX, false),
                };
                let mut rect = shape.row_rect(r);
                if matches!(shape.kind, shape::Kind::Reroute | shape::Kind::Sheet) {
                    let half = rect.width() / 2.0;
                    if output { rect.min.x += half } else { rect.max.x -= half }
                }
                let rect = self.view.rect_to_screen(area, rect).intersect(area);
                let row = Id::new(("row", &shape.id, r));
                let response = ui.interact(rect, row, Sense::hover());
                response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, &label));
                if port != usize::MAX && tips {
                    response.on_hover_ui(|ui| tip::port(ui, model, shape, port, output));
                }
            }
        }
    }

    /// The place of the canvas in the middle of what was seen last.
    #[must_use]
    pub fn middle(&self) -> [f64; 2] {
        let p = self.view.to_canvas(self.area, self.area.center());
        [f64::from(p.x), f64::from(p.y)]
    }

    /// Where the pointer is on the canvas, if it is over it.
    #[must_use]
    pub fn pointer(&self, ui: &Ui) -> Option<[f64; 2]> {
        let at = ui.input(|i| i.pointer.latest_pos()).filter(|at| self.area.contains(*at))?;
        let p = self.view.to_canvas(self.area, at);
        Some([f64::from(p.x), f64::from(p.y)])
    }

    /// Opens the field in which the one selected node, or the group whose nodes are selected, is named.
    pub fn rename(&mut self, model: &Model) {
        let group = groups::of_selection(model).map(|name| Typing::title(name, model));
        let node = model.selection.first().filter(|_| model.selection.len() == 1).cloned();
        let named = node.map(Typing::rename).or(group);
        if named.is_some() {
            self.typing = named;
        }
    }

    /// Opens the finder in the middle of what is seen, or at the pointer.
    pub fn open_finder(&mut self, ui: &Ui) {
        let at = ui.input(|i| i.pointer.hover_pos()).filter(|at| self.area.contains(*at));
        let at = at.unwrap_or_else(|| self.area.center());
        self.finder = Some(Finder::new(at, None));
    }

    /// Opens the search for a node of the graph.
    pub fn open_search(&mut self) {
        self.search = Some(Search::default());
    }

    fn find(&mut self, ui: &mut Ui, area: Rect, model: &mut Model) {
        if let Some(mut search) = self.search.take() {
            match search.show(ui, area, model) {
                Sought::Open => self.search = Some(search),
                Sought::Closed => {}
                Sought::Node(id) => {
                    model.selection = [id].into();
                    self.show_all();
                }
            }
        }
        let Some(mut finder) = self.finder.take() else { return };
        let at = self.view.to_canvas(area, finder.at);
        match finder.show(ui, area, model) {
            finder::Found::Open => self.finder = Some(finder),
            finder::Found::Closed => {}
            finder::Found::Chosen(offer) => finder.add(model, &offer, view::snap(at), &self.shapes),
        }
    }

    fn typing(&mut self, ui: &mut Ui, area: Rect, model: &mut Model) {
        let Some(mut typing) = self.typing.take() else { return model.set_typed(None) };
        let place = typing.place(&self.shapes, model).map(|r| self.view.rect_to_screen(area, r));
        if let Some(place) = place
            && typing.show(ui, place, area, model, self.view.zoom)
        {
            self.typing = Some(typing);
        } else if typing.entries {
            self.entries = Some(Entries::new(typing.node().to_owned()));
        }
    }

    /// The part of the canvas that the pointer is over; nothing where the map lies on it.
    fn hit(&self, area: Rect, at: egui::Pos2, model: &Model) -> Hit {
        if self.map_at(area, at).is_some() {
            return Hit::Nothing;
        }
        let at = self.view.to_canvas(area, at);
        hit::hit(&self.shapes, model.document(), at, &model.selection, self.view.zoom)
    }
}
