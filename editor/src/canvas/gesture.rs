//! What the hand does on the canvas: panning, zooming, moving, framing, drawing wires, sliding values.

use super::finder::Finder;
use super::hit::Hit;
use super::input::Typing;
use super::paint::{Paint, Strands};
use super::shape::{Kind, Row, Shapes};
use super::wiring::End;
use super::{Canvas, groups, view};
use crate::model::Model;
use crate::model::catalog::PortInfo;
use crate::model::param::{Slider, Widget, number, round_step, slid};
use crate::panels::table::{self, Table};
use crate::theme;
use eframe::egui::{Key, PointerButton, Pos2, Rect, Response, Stroke, StrokeKind, Ui, Vec2};
use tenon_engine::Operation;

/// What the hand does.
#[derive(Default)]
pub enum Gesture {
    /// Nothing.
    #[default]
    Idle,
    /// Moves the canvas.
    Pan,
    /// Moves the canvas by its map: where the map is, and what it shows.
    Map(Rect, Rect),
    /// Draws a frame around nodes; from where, and what was selected before.
    Frame(Pos2, std::collections::BTreeSet<String>),
    /// Draws a line around nodes; its corners, and what was selected before.
    Lasso(Vec<Pos2>, std::collections::BTreeSet<String>),
    /// Moves the selected nodes.
    Move {
        /// By so much, as the hand went.
        by: Vec2,
        /// Where the node that was taken stood: it lands on the grid.
        anchor: Pos2,
        /// Copies are put there, and the nodes stay.
        copies: bool,
    },
    /// Draws a wire.
    Wire(End),
    /// Draws a wire that was taken off the input where it ended, as part of one step.
    Taken(End),
    /// Leads all wires of a port to another one.
    Rewire(End),
    /// Slides a value along its row.
    Slide {
        /// The node.
        node: String,
        /// Its input.
        port: String,
        /// The row on screen.
        row: Rect,
        /// The slider as it was.
        slider: Slider,
    },
    /// Changes a value without ends, by so much per point of the screen.
    Turn {
        /// The node.
        node: String,
        /// Its input.
        port: String,
        /// The value as it was.
        value: f64,
        /// Change per point.
        step: f64,
        /// Only whole numbers.
        integer: bool,
        /// Where it began.
        from: Pos2,
    },
}

impl Gesture {
    /// Whether nothing is being done.
    pub fn is_idle(&self) -> bool {
        matches!(self, Self::Idle)
    }

    /// How far selected nodes have been moved.
    pub fn offset(&self) -> Option<Vec2> {
        if let Self::Move { by, anchor, .. } = self { Some(view::snap(*anchor + *by) - *anchor) } else { None }
    }

    /// Whether copies are being moved.
    pub fn copies(&self) -> bool {
        matches!(self, Self::Move { copies: true, by, .. } if *by != Vec2::ZERO)
    }

    /// The wire that is being drawn.
    pub fn wire(&self) -> Option<&End> {
        if let Self::Wire(end) | Self::Taken(end) = self { Some(end) } else { None }
    }

    /// Paints the frame or the wire.
    pub fn paint(&self, p: &Paint, shapes: &Shapes, pointer: Option<Pos2>) {
        let Some(pointer) = pointer.map(|at| p.view.to_canvas(p.area, at)) else { return };
        match self {
            Self::Frame(from, _) => {
                let rect = p.view.rect_to_screen(p.area, Rect::from_two_pos(*from, pointer));
                let fill = p.theme.selected.gamma_multiply(0.12);
                p.painter.rect(rect, 0.0, fill, Stroke::new(1.0, p.theme.selected), StrokeKind::Inside);
            }
            Self::Lasso(line, _) => {
                let line: Vec<Pos2> = line.iter().map(|c| p.view.to_screen(p.area, *c)).collect();
                p.painter.add(eframe::egui::Shape::closed_line(line, Stroke::new(1.5, p.theme.selected)));
            }
            Self::Wire(end) | Self::Taken(end) => {
                let Some(shape) = shapes.find(&end.node).map(|n| &shapes.nodes[n]) else { return };
                let named = |ports: &[crate::model::catalog::PortInfo]| ports.iter().position(|q| q.name == end.port);
                let colour = theme::type_colour(&end.type_name);
                if end.output {
                    let from = named(&shape.outputs).map(|o| shape.output(o));
                    from.into_iter().for_each(|from| p.wire(from, pointer, colour, Strands::Item));
                } else {
                    let to = named(&shape.inputs).map(|i| shape.input(i));
                    to.into_iter().for_each(|to| p.wire(pointer, to, colour, Strands::Item));
                }
            }
            Self::Rewire(end) => {
                let Some(n) = shapes.find(&end.node) else { return };
                for (from, to) in shapes.wires_at(n, &end.port, end.output) {
                    let ends = if end.output { (pointer, to) } else { (from, pointer) };
                    p.wire(ends.0, ends.1, theme::type_colour(&end.type_name), Strands::Item);
                }
            }
            _ => {}
        }
    }
}

impl Canvas {
    /// Whether something is being dragged.
    #[must_use]
    pub fn is_dragging(&self) -> bool {
        !self.gesture.is_idle()
    }

    /// Gives up what is being dragged: everything is as it was before.
    fn abort(&mut self, model: &mut Model) {
        match std::mem::take(&mut self.gesture) {
            Gesture::Slide { .. } | Gesture::Turn { .. } | Gesture::Taken(_) => model.abort(),
            Gesture::Frame(_, before) | Gesture::Lasso(_, before) => model.selection = before,
            _ => {}
        }
    }

    /// Looks at what the hand does and does it.
    pub(super) fn gestures(&mut self, ui: &Ui, response: &Response, model: &mut Model) {
        let area = response.rect;
        let pointer = ui.input(|i| i.pointer.latest_pos());
        if response.contains_pointer() {
            let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta.y, i.zoom_delta()));
            if let Some(at) = pointer.filter(|_| scroll != 0.0 || pinch != 1.0) {
                let turned = pinch == 1.0 && self.turn_sheet(self.view.to_canvas(area, at), scroll, model);
                if !turned {
                    let factor = if pinch != 1.0 { pinch } else { (scroll * 0.004).exp() };
                    self.view.zoom_at(area, at, factor);
                }
            }
        }
        if !self.gesture.is_idle() && ui.input(|i| i.key_pressed(Key::Escape)) {
            self.abort(model);
        }
        let pressed = ui.input(|i| i.pointer.press_origin());
        if response.drag_started() {
            let right = response.dragged_by(PointerButton::Secondary) || response.dragged_by(PointerButton::Middle);
            let space = ui.input(|i| i.key_down(Key::Space));
            if right || space {
                self.gesture = Gesture::Pan;
            } else if let Some((map, bounds)) = pressed.and_then(|at| self.map_at(area, at)) {
                self.gesture = Gesture::Map(map, bounds);
            } else if let Some(at) = pressed {
                self.begin(ui, area, at, model);
            }
        }
        if let (true, Some(at)) = (response.dragged(), pointer) {
            self.drag(response.drag_delta(), area, at, model);
        }
        if response.drag_stopped() {
            self.finish(area, pointer, model);
        }
        let at = response.interact_pointer_pos().filter(|_| response.clicked());
        if let Some((at, map)) = at.and_then(|at| Some((at, self.map_at(area, at)?))) {
            // What lies under the map is not meant.
            self.go_by_map(area, map, at);
            return;
        }
        // Two clicks soon after an earlier one elsewhere count as three.
        if let Some(at) = pointer.filter(|_| response.double_clicked() || response.triple_clicked()) {
            let raw = ui.input(|i| i.modifiers.command);
            self.double_click(area, at, raw, model);
        } else if let Some(at) = response.interact_pointer_pos().filter(|_| response.clicked()) {
            self.click(ui, area, at, model);
        }
        if response.secondary_clicked() {
            let hit = response.interact_pointer_pos().map(|at| match self.map_at(area, at) {
                Some(_) => Hit::Nothing,
                None => self.hit(area, at, model),
            });
            if let Some(n) = hit.and_then(Hit::node) {
                self.choose(n, false, model);
            }
            self.menu_on = hit;
            self.menu_at = response.interact_pointer_pos().unwrap_or(area.center());
        }
    }

    /// Selects a node; with `more`, besides those that are.
    fn choose(&self, n: usize, more: bool, model: &mut Model) {
        let Some(shape) = self.shapes.nodes.get(n) else { return };
        if model.selection.contains(&shape.id) {
            if more {
                model.selection.remove(&shape.id);
            }
            return;
        }
        if !more {
            model.selection.clear();
        }
        model.selection.insert(shape.id.clone());
    }

    fn begin(&mut self, ui: &Ui, area: Rect, at: Pos2, model: &mut Model) {
        let (shift, ctrl, alt) = ui.input(|i| (i.modifiers.shift, i.modifiers.command, i.modifiers.alt));
        self.gesture = match self.hit(area, at, model) {
            Hit::Nothing | Hit::Wire(_) => {
                let before = if shift { model.selection.clone() } else { Default::default() };
                let from = self.view.to_canvas(area, at);
                if alt { Gesture::Lasso(vec![from], before) } else { Gesture::Frame(from, before) }
            }
            Hit::Group(g) => {
                let name = model.document().groups.keys().nth(g).cloned().unwrap_or_default();
                model.selection = groups::members(model.document(), &name).map(str::to_owned).collect();
                let first = model.selection.first().and_then(|id| self.shapes.find(id));
                first.map_or(Gesture::Idle, |n| self.taken(n, alt))
            }
            Hit::Node(n) | Hit::More(n) => {
                self.choose(n, false, model);
                self.taken(n, alt)
            }
            Hit::Output(n, o) if ctrl && shift => Gesture::Rewire(self.end(n, o, true)),
            Hit::Input(n, i) if ctrl && shift => Gesture::Rewire(self.end(n, i, false)),
            Hit::Output(n, o) => self.wire_from(n, o, true),
            Hit::Input(n, i) if ctrl => self.take_off(n, i, model),
            Hit::Input(n, i) => self.wire_from(n, i, false),
            Hit::Value(n, _, _) if alt => {
                self.choose(n, false, model);
                self.taken(n, alt)
            }
            Hit::Value(n, i, r) => self.begin_value(area, at, n, i, r, model),
        };
        if matches!(self.gesture, Gesture::Slide { .. } | Gesture::Turn { .. }) {
            model.begin();
        }
    }

    /// A node was taken to be moved, or copies of what is selected.
    fn taken(&self, n: usize, copies: bool) -> Gesture {
        Gesture::Move { by: Vec2::ZERO, anchor: self.shapes.nodes[n].rect.min, copies }
    }

    fn begin_value(&self, area: Rect, at: Pos2, n: usize, i: usize, r: usize, model: &mut Model) -> Gesture {
        let shape = &self.shapes.nodes[n];
        let (node, port) = (shape.id.clone(), shape.inputs[i].name.clone());
        match &shape.rows[r] {
            Row::Input(_, Some(Widget::Slider(slider))) => {
                let row = self
                    .view
                    .rect_to_screen(area, shape.row_rect(r))
                    .shrink2(eframe::egui::vec2(10.0 * self.view.zoom, 0.0));
                Gesture::Slide { node, port, row, slider: *slider }
            }
            Row::Input(_, Some(Widget::Number { value, integer })) => {
                let step = if *integer { 0.2 } else { round_step(value.abs().max(1.0) / 100.0) };
                Gesture::Turn { node, port, value: *value, step, integer: *integer, from: at }
            }
            _ => {
                self.choose(n, false, model);
                self.taken(n, false)
            }
        }
    }

    fn drag(&mut self, delta: Vec2, area: Rect, at: Pos2, model: &mut Model) {
        let set = |node: &str, port: &str, value: f64, model: &mut Model| {
            let value = number(slid(value));
            if model.param(node, port).as_ref() != Some(&value) {
                model.edit(Operation::SetParam { node: node.into(), port: port.into(), value: Some(value) });
            }
        };
        match &mut self.gesture {
            Gesture::Idle | Gesture::Wire(_) | Gesture::Taken(_) | Gesture::Rewire(_) => {}
            Gesture::Pan => self.view.origin += delta,
            Gesture::Map(map, bounds) => {
                let map = (*map, *bounds);
                self.go_by_map(area, map, map.0.clamp(at));
            }
            Gesture::Move { by, .. } => *by += delta / self.view.zoom,
            Gesture::Frame(from, before) => {
                let frame = Rect::from_two_pos(*from, self.view.to_canvas(area, at));
                model.selection.clone_from(before);
                let inside = self.shapes.nodes.iter().filter(|s| frame.intersects(s.rect));
                model.selection.extend(inside.map(|s| s.id.clone()));
            }
            Gesture::Lasso(line, before) => {
                let p = self.view.to_canvas(area, at);
                if line.last().is_none_or(|last| last.distance(p) * self.view.zoom > 4.0) {
                    line.push(p);
                }
                model.selection.clone_from(before);
                let inside = self.shapes.nodes.iter().filter(|s| around(line, s.rect.center()));
                model.selection.extend(inside.map(|s| s.id.clone()));
            }
            Gesture::Slide { node, port, row, slider } => {
                let value = slider.at(f64::from((at.x - row.left()) / row.width().max(1.0)));
                set(node, port, value, model);
            }
            Gesture::Turn { node, port, value, step, integer, from } => {
                let turned = *value + f64::from(((at.x - from.x) / 2.0).round()) * *step;
                let value = if *integer { turned.round() } else { turned };
                set(node, port, value, model);
            }
        }
    }

    fn finish(&mut self, area: Rect, pointer: Option<Pos2>, model: &mut Model) {
        let offset = self.gesture.offset();
        match std::mem::take(&mut self.gesture) {
            Gesture::Move { copies, .. } => {
                let by = offset.unwrap_or(Vec2::ZERO);
                if copies && by != Vec2::ZERO {
                    model.message = model.duplicate([f64::from(by.x), f64::from(by.y)]).err();
                    return;
                }
                let moves = model.selection.iter().filter_map(|id| {
                    let at = model.position(id).unwrap_or_default();
                    // Single precision leaves crumbs.
                    let to =
                        Some([(at[0], by.x), (at[1], by.y)].map(|(a, b)| ((a + f64::from(b)) * 100.0).round() / 100.0));
                    (by != Vec2::ZERO).then(|| Operation::Move { node: id.clone(), to })
                });
                let moves: Vec<Operation> = moves.collect();
                if !moves.is_empty() {
                    model.edit(Operation::All(moves));
                }
            }
            Gesture::Slide { .. } | Gesture::Turn { .. } => model.end(),
            Gesture::Wire(end) => {
                let Some(at) = pointer else { return };
                match self.hit(area, at, model) {
                    _ if self.map_at(area, at).is_some() => {}
                    Hit::Nothing | Hit::Wire(_) | Hit::Group(_) => self.finder = Some(Finder::new(at, Some(end))),
                    hit => self.drop_wire(&end, hit, at, area, model),
                }
            }
            Gesture::Taken(end) => {
                let hit = pointer.map_or(Hit::Nothing, |at| self.hit(area, at, model));
                if let (Some(at), Some(_)) = (pointer, hit.node()) {
                    self.drop_wire(&end, hit, at, area, model);
                }
                model.end();
            }
            Gesture::Rewire(end) => {
                let hit = pointer.map_or(Hit::Nothing, |at| self.hit(area, at, model));
                if let Some(operation) = self.rewire(&end, hit, model) {
                    model.edit(operation);
                }
            }
            Gesture::Idle | Gesture::Pan | Gesture::Map(..) | Gesture::Frame(..) | Gesture::Lasso(..) => {}
        }
    }

    fn click(&mut self, ui: &Ui, area: Rect, at: Pos2, model: &mut Model) {
        let more = ui.input(|i| i.modifiers.shift || i.modifiers.command);
        match self.hit(area, at, model) {
            Hit::Nothing => {
                if !more {
                    model.selection.clear();
                }
            }
            Hit::Wire(w) => {
                // A wire is seen best by its ends.
                let wire = &self.shapes.wires[w];
                let ends = wire.source.map(|(n, _)| n).into_iter().chain([wire.to]);
                model.selection = ends.map(|n| self.shapes.nodes[n].id.clone()).collect();
            }
            Hit::Group(g) => {
                let name = model.document().groups.keys().nth(g).cloned().unwrap_or_default();
                model.selection = groups::members(model.document(), &name).map(str::to_owned).collect();
            }
            Hit::More(n) => {
                let id = self.shapes.nodes[n].id.clone();
                model.fold(&id);
            }
            Hit::Value(n, i, r) => {
                let shape = &self.shapes.nodes[n];
                let (node, port) = (shape.id.clone(), shape.inputs[i].name.clone());
                match &shape.rows[r] {
                    Row::Input(_, Some(Widget::Toggle(on))) => {
                        let value = Some((!on).into());
                        model.edit(Operation::SetParam { node, port, value });
                    }
                    Row::Input(_, Some(Widget::Choice(_))) => self.typing = Some(Typing::new(node, port, model)),
                    _ => self.select_one(n, more, model),
                }
            }
            Hit::Node(n) | Hit::Output(n, _) | Hit::Input(n, _) => self.select_one(n, more, model),
        }
    }

    /// Opens what a value is edited by: lists as tables, choices as menus, everything else, and `raw` ones, as a text.
    fn edit_value(&mut self, node: String, port: PortInfo, raw: bool, model: &Model) {
        let value = model.param(&node, &port.name).or_else(|| port.default.clone());
        if raw {
            self.typing = Some(Typing::raw(node, port.name, model));
        } else if table::edits(&port, value.as_ref()) {
            self.table = Some(Table::new(node, port));
        } else {
            self.typing = Some(Typing::new(node, port.name, model));
        }
    }

    fn select_one(&self, n: usize, more: bool, model: &mut Model) {
        if !more {
            model.selection.clear();
        }
        self.choose(n, more, model);
    }

    /// The map under a place on screen: where it is, and what it shows.
    pub(super) fn map_at(&self, area: Rect, at: Pos2) -> Option<(Rect, Rect)> {
        super::paint::map(self.view, area, &self.shapes).filter(|(map, _)| map.contains(at))
    }

    /// Goes to the place of the canvas that a place of the map shows.
    fn go_by_map(&mut self, area: Rect, (map, bounds): (Rect, Rect), at: Pos2) {
        let along = (at - map.min) / map.size();
        self.view.centre(area, bounds.min + along * bounds.size());
    }

    fn double_click(&mut self, area: Rect, at: Pos2, raw: bool, model: &mut Model) {
        match self.hit(area, at, model) {
            Hit::Nothing => self.finder = Some(Finder::new(at, None)),
            Hit::Value(n, i, _) => {
                let shape = &self.shapes.nodes[n];
                self.edit_value(shape.id.clone(), shape.inputs[i].clone(), raw, model);
            }
            Hit::Node(n) => {
                let shape = &self.shapes.nodes[n];
                let id = shape.id.clone();
                let instance = model.document().nodes().get(&id).is_some_and(|n| n.cluster().is_some());
                let title = self.view.to_canvas(area, at).y < shape.rect.top() + super::shape::HEADER;
                match shape.kind {
                    Kind::Note => self.typing = Some(Typing::new(id, "text".into(), model)),
                    Kind::Reroute => {}
                    Kind::Sheet if !title => {}
                    Kind::Node if instance && !title => model.message = model.enter(&id).err(),
                    Kind::Node | Kind::Sheet => self.typing = Some(Typing::rename(id)),
                }
            }
            Hit::Wire(w) => {
                let at = self.view.to_canvas(area, at) - Vec2::new(14.0, 9.0);
                self.reroute(w, [f64::from(at.x), f64::from(at.y)], model);
            }
            Hit::Group(g) => {
                let name = model.document().groups.keys().nth(g).cloned();
                self.typing = name.map(|name| Typing::title(name, model));
            }
            Hit::More(_) | Hit::Output(..) | Hit::Input(..) => {}
        }
    }
}

/// Whether a closed line goes around a place.
fn around(line: &[Pos2], at: Pos2) -> bool {
    let sides = line.iter().zip(line.iter().cycle().skip(1));
    let crossed =
        sides.filter(|(a, b)| (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x));
    crossed.count() % 2 == 1
}
