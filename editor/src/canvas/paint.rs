//! Painting nodes, wires and what is being drawn by hand. What lies outside is left out, and zoomed out less is drawn.

use super::shape::{HEADER, Kind, Row, Shape, Shapes, Wire};
use super::view::View;
use crate::model::Model;
use crate::model::param::{Widget, shown};
use crate::theme::{self, Theme};
use eframe::egui::epaint::CubicBezierShape;
use eframe::egui::{Align2, Color32, CornerRadius, FontId, Painter, Pos2, Rect, Stroke, StrokeKind, Vec2, pos2, vec2};
use std::collections::HashMap;
use tenon_engine::{Happened, NodeState, Severity};

/// Below this scale no text is drawn in rows, and below the second none at all.
const DETAIL: [f32; 2] = [0.45, 0.15];

/// Whether the wire that is being drawn can go to a port: of this shape, an output or not, of this number.
pub type Wanted<'a> = Option<&'a dyn Fn(&Shape, bool, usize) -> bool>;

/// What painting needs to know.
pub struct Paint<'a> {
    /// Where to.
    pub painter: Painter,
    /// The area of the canvas on screen.
    pub area: Rect,
    /// The part that is seen.
    pub view: View,
    /// Colours.
    pub theme: Theme,
    /// What is worked on.
    pub model: &'a Model,
    /// Moves selected nodes while they are dragged.
    pub offset: Vec2,
    /// The first line that sheets show, by node.
    pub scrolls: &'a HashMap<String, f32>,
    /// It is copies that are dragged: the nodes are seen where they stay, too.
    pub copies: bool,
}

/// Where the number of things that are wrong stands at a node, canvas points; none if nothing is. What is only noted, such
/// as what keeps a node from running, stands in the header.
pub fn badge(shape: &Shape, model: &Model) -> Option<Rect> {
    model.results.worst(&model.path_of(&shape.id)).filter(|(worst, _)| worst.severity >= Severity::Warning)?;
    let size = vec2(18.0, 16.0);
    Some(Rect::from_center_size(pos2(shape.rect.right() - 6.0, shape.rect.top()), size))
}

impl Paint<'_> {
    pub(super) fn scaled(&self, size: f32) -> f32 {
        size * self.view.zoom
    }

    /// Steps of half a point, so that zooming does not fill the atlas of glyphs.
    pub(super) fn font(&self, size: f32) -> FontId {
        FontId::proportional(((self.scaled(size) * 2.0).round() / 2.0).max(1.0))
    }

    fn at(&self, p: Pos2) -> Pos2 {
        self.view.to_screen(self.area, p)
    }

    /// Where a node stands while it may be dragged.
    pub fn moved(&self, shape: &Shape) -> Rect {
        if self.model.selection.contains(&shape.id) { shape.rect.translate(self.offset) } else { shape.rect }
    }

    fn port(&self, shape: &Shape, p: Pos2) -> Pos2 {
        p + (self.moved(shape).min - shape.rect.min)
    }

    /// The points that show that there is a canvas.
    pub fn grid(&self) {
        self.painter.rect_filled(self.area, 0.0, self.theme.canvas);
        let step = 50.0;
        if self.scaled(step) < 14.0 {
            return;
        }
        let seen = self.view.seen(self.area);
        let (left, top) = ((seen.left() / step).floor() as i32, (seen.top() / step).floor() as i32);
        let (right, bottom) = ((seen.right() / step) as i32, (seen.bottom() / step) as i32);
        for x in left..=right {
            for y in top..=bottom {
                let p = self.at(pos2(x as f32 * step, y as f32 * step));
                self.painter.rect_filled(Rect::from_center_size(p, vec2(1.5, 1.5)), 0.0, self.theme.grid);
            }
        }
    }

    /// All wires.
    pub fn wires(&self, shapes: &Shapes) {
        for wire in &shapes.wires {
            let target = &shapes.nodes[wire.to];
            let end = self.port(target, target.input(wire.port));
            let Some((n, o)) = wire.source else {
                let start = end - vec2(26.0, 0.0);
                let ends = [self.at(start), self.at(end)];
                self.painter.line_segment(ends, Stroke::new(self.scaled(2.0).max(1.0), self.theme.error));
                continue;
            };
            let source = &shapes.nodes[n];
            let start = self.port(source, source.output(o));
            let chosen = self.model.selection.contains(&source.id) || self.model.selection.contains(&target.id);
            let type_name = match (source.outputs[o].type_name.as_str(), self.model.value(&wire.from)) {
                ("any", Some(tree)) => tree.type_name(),
                (named, _) => named,
            };
            let colour = theme::type_colour(type_name);
            let colour = self.theme.wire(colour, chosen);
            self.wire(start, end, colour, strands(self.model, wire));
        }
    }

    /// One wire between two places of the canvas.
    pub fn wire(&self, from: Pos2, to: Pos2, colour: Color32, strands: Strands) {
        let (a, b) = (self.at(from), self.at(to));
        let bounds = Rect::from_two_pos(a, b).expand(self.scaled(90.0));
        if !bounds.intersects(self.area) {
            return;
        }
        let width = self.scaled(1.8).clamp(0.8, 3.0);
        if self.view.zoom < DETAIL[1] {
            self.painter.line_segment([a, b], Stroke::new(width, colour));
            return;
        }
        let reach = self.scaled(super::hit::reach(from, to));
        let curve = |dy: f32| {
            let up = vec2(0.0, dy);
            let points = [a + up, a + up + vec2(reach, 0.0), b + up - vec2(reach, 0.0), b + up];
            CubicBezierShape::from_points_stroke(points, false, Color32::TRANSPARENT, Stroke::new(width, colour))
        };
        match strands {
            Strands::Item => {
                self.painter.add(curve(0.0));
            }
            Strands::List => self.painter.extend([curve(-width), curve(width)].map(Into::into)),
            Strands::Tree => {
                for dy in [-width, width] {
                    let line = curve(dy).flatten(Some(1.0));
                    let dashes =
                        eframe::egui::Shape::dashed_line(&line, Stroke::new(width, colour), 4.0 * width, 2.5 * width);
                    self.painter.extend(dashes);
                }
            }
        }
    }

    /// All nodes that are seen; selected ones last, so that they lie on top.
    pub fn nodes(&self, shapes: &Shapes, wanted: Wanted<'_>) {
        if self.copies {
            let stay = Paint { painter: self.painter.clone(), offset: Vec2::ZERO, copies: false, ..*self };
            stay.nodes(shapes, wanted);
        }
        let seen = self.view.seen(self.area).expand(20.0);
        for on_top in [false, true] {
            for shape in &shapes.nodes {
                if self.model.selection.contains(&shape.id) == on_top && self.moved(shape).intersects(seen) {
                    self.node(shape, wanted);
                }
            }
        }
    }

    fn node(&self, shape: &Shape, wanted: Wanted<'_>) {
        let rect = self.view.rect_to_screen(self.area, self.moved(shape));
        match shape.kind {
            Kind::Node => {}
            Kind::Note => return self.note(shape, rect),
            Kind::Reroute => return self.reroute(shape, rect, wanted),
            Kind::Sheet => {
                let first = self.scrolls.get(&shape.id).copied().unwrap_or_default();
                self.sheet(shape, rect, first, self.view.zoom < DETAIL[1]);
                if self.view.zoom >= DETAIL[0] {
                    let shift = self.moved(shape).min - shape.rect.min;
                    let item =
                        self.model.value(&format!("{}.data", shape.id)).map_or("any", tenon_engine::Tree::type_name);
                    self.dot(self.at(shape.input(0) + shift), item, wanted.map(|w| w(shape, false, 0)));
                    self.dot(self.at(shape.output(0) + shift), item, wanted.map(|w| w(shape, true, 0)));
                }
                return self.problems(shape);
            }
        }
        let radius = CornerRadius::same(self.scaled(6.0).clamp(0.0, 18.0) as u8);
        let worst = self.model.results.worst(&self.model.path_of(&shape.id)).map(|(d, _)| d.severity);
        let off = shape.state == NodeState::Disabled;
        let hidden = hidden(self.model, shape);
        let fill = if off { self.theme.node.gamma_multiply(0.6) } else { self.theme.node };
        self.painter.rect_filled(rect, radius, fill);
        let header = Rect::from_min_max(rect.min, pos2(rect.right(), rect.top() + self.scaled(HEADER)));
        let top = CornerRadius { sw: 0, se: 0, ..radius };
        let bar = match worst {
            Some(Severity::Error) => self.theme.error,
            Some(Severity::Warning) => self.theme.warning,
            _ if off || shape.state == NodeState::Bypassed => self.theme.faint,
            _ if shape.state == NodeState::Frozen => self.theme.frozen,
            _ if hidden => self.theme.header.lerp_to_gamma(self.theme.node, 0.5),
            _ => theme::category_colour(&shape.info.category, &self.theme),
        };
        self.painter.rect_filled(header, top, bar);
        let selected = self.model.selection.contains(&shape.id);
        let edge = if selected { Stroke::new(2.0, self.theme.selected) } else { Stroke::new(1.0, self.theme.edge) };
        self.painter.rect_stroke(rect, radius, edge, StrokeKind::Outside);
        if self.view.zoom < DETAIL[1] {
            return;
        }
        self.header(shape, header, bar);
        if self.view.zoom >= DETAIL[0] {
            for (r, row) in shape.rows.iter().enumerate() {
                self.row(shape, r, row, wanted);
            }
        }
        self.problems(shape);
    }

    /// How many things are wrong with a node.
    fn problems(&self, shape: &Shape) {
        let Some((worst, count)) = self.model.results.worst(&self.model.path_of(&shape.id)) else { return };
        let Some(place) = badge(shape, self.model).filter(|_| self.view.zoom >= DETAIL[1]) else { return };
        let shift = self.moved(shape).min - shape.rect.min;
        let rect = self.view.rect_to_screen(self.area, place.translate(shift));
        let colour = if worst.severity == Severity::Error { self.theme.error } else { self.theme.warning };
        let radius = CornerRadius::same((rect.height() / 2.0).clamp(0.0, 30.0) as u8);
        self.painter.rect(rect, radius, colour, Stroke::new(1.0, self.theme.canvas), StrokeKind::Outside);
        if self.view.zoom >= DETAIL[0] {
            let words = if count > 99 { "99+".to_owned() } else { count.to_string() };
            self.painter.text(
                rect.center(),
                Align2::CENTER_CENTER,
                words,
                self.font(theme::SMALL),
                theme::ink_on(colour),
            );
        }
    }

    /// A sheet with a text.
    fn note(&self, shape: &Shape, rect: Rect) {
        let selected = self.model.selection.contains(&shape.id);
        let edge = if selected { Stroke::new(2.0, self.theme.selected) } else { Stroke::new(1.0, self.theme.edge) };
        self.painter.rect(rect, 2.0, self.theme.paper, edge, StrokeKind::Outside);
        let text = self.model.document().nodes().get(&shape.id).map(super::shape::note_text);
        if self.view.zoom < DETAIL[1] {
            return;
        }
        let (text, ink) = match text.filter(|t| !t.is_empty()) {
            None => ("double-click to write".to_owned(), self.theme.faint_text),
            Some(text) => (text, theme::ink_on(self.theme.paper)),
        };
        let inside = rect.shrink(self.scaled(8.0));
        let galley = self.painter.layout(text, self.font(13.0), ink, inside.width().max(1.0));
        self.painter.with_clip_rect(rect.intersect(self.painter.clip_rect())).galley(inside.min, galley, ink);
    }

    /// A point that wires are led through.
    fn reroute(&self, shape: &Shape, rect: Rect, wanted: Wanted<'_>) {
        let selected = self.model.selection.contains(&shape.id);
        let edge = if selected { Stroke::new(2.0, self.theme.selected) } else { Stroke::new(1.0, self.theme.edge) };
        let radius = CornerRadius::same((rect.height() / 2.0).clamp(0.0, 30.0) as u8);
        self.painter.rect(rect, radius, self.theme.node, edge, StrokeKind::Outside);
        if self.view.zoom >= DETAIL[1] {
            let tree = self.model.value(&format!("{}.value", shape.id));
            let item = tree.map_or("any", tenon_engine::Tree::type_name);
            self.dot(rect.left_center(), item, wanted.map(|w| w(shape, false, 0)));
            self.dot(rect.right_center(), item, wanted.map(|w| w(shape, true, 0)));
        }
    }

    fn header(&self, shape: &Shape, header: Rect, bar: Color32) {
        let ink = theme::ink_on(bar);
        if self.view.zoom < DETAIL[0] {
            // Far away the name is all that can be read; it takes the room of the whole node.
            let rect = self.view.rect_to_screen(self.area, self.moved(shape));
            let painter = self.painter.with_clip_rect(rect.intersect(self.painter.clip_rect()));
            let font = FontId::proportional((14.0 * self.view.zoom).max(9.0).round());
            painter.text(rect.center(), Align2::CENTER_CENTER, &shape.id, font, self.theme.text);
            return;
        }
        let mut inside = header.shrink2(vec2(self.scaled(8.0), 0.0));
        if let Some(badge) = badge(shape, self.model) {
            // It must not lie over the state.
            inside.max.x -= self.scaled(shape.rect.right() - badge.left() - 4.0);
        }
        let painter = self.painter.with_clip_rect(inside.intersect(self.painter.clip_rect()));
        painter.text(inside.left_center(), Align2::LEFT_CENTER, &shape.id, self.font(14.0), ink);
        let state = state(self.model, shape);
        let size = self.painter.layout_no_wrap(state.clone(), self.font(theme::SMALL), ink).size();
        let room = pos2(inside.right() - size.x - 4.0, header.top());
        let room = Rect::from_min_max(room, pos2(inside.right() + self.scaled(8.0), header.bottom()));
        self.painter.rect_filled(room.shrink(1.0), 0.0, bar);
        self.painter.text(
            inside.right_center(),
            Align2::RIGHT_CENTER,
            state,
            self.font(theme::SMALL),
            ink.gamma_multiply(0.85),
        );
    }

    fn row(&self, shape: &Shape, r: usize, row: &Row, wanted: Wanted<'_>) {
        let shift = self.moved(shape).min - shape.rect.min;
        let rect = self.view.rect_to_screen(self.area, shape.row_rect(r).translate(shift));
        let inside = rect.shrink2(vec2(self.scaled(10.0), self.scaled(2.0)));
        let (text, faint) = (self.theme.text, self.theme.faint_text);
        match row {
            Row::Output(o) => {
                let port = &shape.outputs[*o];
                self.dot(pos2(rect.right(), rect.center().y), &port.type_name, wanted.map(|w| w(shape, true, *o)));
                self.painter.text(inside.right_center(), Align2::RIGHT_CENTER, &port.name, self.font(12.0), text);
            }
            Row::Input(i, widget) => {
                let port = &shape.inputs[*i];
                if let Some(widget) = widget {
                    self.widget(inside, widget, &port.unit, &port.name);
                }
                let room = self.painter.with_clip_rect(inside.intersect(self.painter.clip_rect()));
                let ink = if matches!(widget, Some(Widget::Empty)) && port.optional { faint } else { text };
                room.text(
                    inside.left_center() + vec2(self.scaled(3.0), 0.0),
                    Align2::LEFT_CENTER,
                    &port.name,
                    self.font(12.0),
                    ink,
                );
                self.dot(pos2(rect.left(), rect.center().y), &port.type_name, wanted.map(|w| w(shape, false, *i)));
            }
            Row::More(count) => {
                let words = if *count > 0 { format!("{count} more …") } else { "fewer …".to_owned() };
                self.painter.text(inside.left_center(), Align2::LEFT_CENTER, words, self.font(11.0), faint);
            }
        }
    }

    fn dot(&self, at: Pos2, type_name: &str, wanted: Option<bool>) {
        let colour = theme::type_colour(type_name);
        let (radius, colour) = match wanted {
            Some(true) => (self.scaled(7.0), colour),
            Some(false) => (self.scaled(3.0), self.theme.faint),
            None => (self.scaled(4.5), colour),
        };
        self.painter.circle(at, radius, colour, Stroke::new(1.0, self.theme.edge));
    }

    fn widget(&self, inside: Rect, widget: &Widget, unit: &str, name: &str) {
        let value = match widget {
            Widget::Empty => return,
            Widget::Slider(s) => shown(s.value),
            Widget::Number { value, .. } => shown(*value),
            Widget::Toggle(on) => if *on { "yes" } else { "no" }.to_owned(),
            Widget::Choice(t) | Widget::Text(t) => t.lines().next().unwrap_or_default().to_owned(),
            Widget::Other(t) => t.clone(),
        };
        let radius = CornerRadius::same(3);
        self.painter.rect_filled(inside, radius, self.theme.field);
        if let Widget::Slider(s) = widget {
            let mut filled = inside;
            filled.set_width(inside.width() * s.along() as f32);
            self.painter.rect_filled(filled, radius, self.theme.slider);
        }
        let numeric = matches!(widget, Widget::Slider(_) | Widget::Number { .. });
        let value = if numeric && !unit.is_empty() { format!("{value} {unit}") } else { value };
        let name_width = self.painter.layout_no_wrap(name.to_owned(), self.font(12.0), self.theme.text).size().x;
        let mut room = inside.shrink2(vec2(self.scaled(3.0), 0.0));
        room.min.x = (room.min.x + name_width + self.scaled(6.0)).min(room.max.x);
        if matches!(widget, Widget::Choice(_)) {
            // It opens downwards.
            let (centre, r) = (pos2(room.right() - self.scaled(5.0), room.center().y), self.scaled(3.5));
            let corners = vec![centre + vec2(-r, -r * 0.6), centre + vec2(r, -r * 0.6), centre + vec2(0.0, r * 0.8)];
            self.painter.add(eframe::egui::Shape::convex_polygon(corners, self.theme.faint_text, Stroke::NONE));
            room.max.x = (room.max.x - self.scaled(13.0)).max(room.min.x);
        }
        let galley = self.painter.layout_no_wrap(value, self.font(12.0), self.theme.value);
        // Too long a value is seen from its start.
        let x = (room.right() - galley.size().x).max(room.left());
        let at = pos2(x, room.center().y - galley.size().y / 2.0);
        self.painter.with_clip_rect(room.intersect(self.painter.clip_rect())).galley(at, galley, self.theme.value);
    }

    /// All of the canvas in a corner, with the part that is seen.
    pub fn map(&self, shapes: &Shapes) {
        let Some((map, bounds)) = map(self.view, self.area, shapes) else { return };
        let (seen, scale) = (self.view.seen(self.area), map.width() / bounds.width());
        self.painter.rect(map, 3.0, self.theme.node, Stroke::new(1.0, self.theme.edge), StrokeKind::Outside);
        let painter = self.painter.with_clip_rect(map);
        let place = |p: Pos2| map.min + (p - bounds.min) * scale;
        for shape in &shapes.nodes {
            let colour = if self.model.selection.contains(&shape.id) { self.theme.selected } else { self.theme.faint };
            let rect = self.moved(shape);
            painter.rect_filled(Rect::from_min_max(place(rect.min), place(rect.max)), 0.0, colour);
        }
        let frame = Rect::from_min_max(place(seen.min), place(seen.max));
        painter.rect_stroke(frame, 0.0, Stroke::new(1.0, self.theme.text), StrokeKind::Inside);
    }
}

/// Where the map of the canvas is on screen, and what it shows; none if all is seen or there is no room for it.
#[must_use]
pub fn map(view: View, area: Rect, shapes: &Shapes) -> Option<(Rect, Rect)> {
    let bounds = shapes.bounds()?.expand(25.0);
    if view.seen(area).contains_rect(bounds) || area.width() < 420.0 || area.height() < 320.0 {
        return None;
    }
    let scale = (150.0 / bounds.width()).min(100.0 / bounds.height());
    let size = bounds.size() * scale;
    Some((Rect::from_min_size(area.max - size - vec2(10.0, 10.0), size), bounds))
}

/// Whether a node makes something that could be seen and is told not to show it.
fn hidden(model: &Model, shape: &Shape) -> bool {
    let seen = |p: &crate::model::catalog::PortInfo| crate::scene::VISIBLE.contains(&p.type_name.as_str());
    !model.previews(&shape.id) && shape.outputs.iter().any(seen)
}

/// What stands on the right of a node's header: how long it took, or what keeps it from running.
#[must_use]
pub fn state(model: &Model, shape: &Shape) -> String {
    let state = match (shape.state, model.results.nodes.get(&*model.path_of(&shape.id))) {
        (NodeState::Disabled, _) => "off".to_owned(),
        (NodeState::Frozen, _) => "frozen".to_owned(),
        (NodeState::Bypassed, _) => "bypassed".to_owned(),
        _ if model.was_stopped_at(&shape.id) => "stopped".to_owned(),
        (_, Some(r)) => match r.happened {
            Happened::Failed => "failed".to_owned(),
            Happened::Blocked => "blocked".to_owned(),
            _ => theme::duration(r.time),
        },
        _ => String::new(),
    };
    if hidden(model, shape) { format!("hidden  {state}") } else { state }
}

/// One line for an item, two for a list, two broken ones for a tree.
#[must_use]
pub fn strands(model: &Model, wire: &Wire) -> Strands {
    match model.value(&wire.from) {
        Some(tree) if tree.branches().len() > 1 => Strands::Tree,
        Some(tree) if tree.len() > 1 => Strands::List,
        _ => Strands::Item,
    }
}

/// How a wire is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Strands {
    /// One item.
    Item,
    /// A list.
    List,
    /// Several branches.
    Tree,
}
