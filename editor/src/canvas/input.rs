//! Typing on the canvas: a value into an input, or another id for a node.

use super::groups;
use super::shape::{HEADER, Kind, Row, Shapes};
use crate::model::Model;
use crate::model::param;
use eframe::egui::text::{CCursor, CCursorRange};
use eframe::egui::{Area, Frame, Id, Key, Order, Rect, ScrollArea, TextEdit, Ui, vec2};
use tenon_engine::Literal;
use tenon_engine::Operation;

/// What is typed.
enum What {
    /// The value of an input.
    Value(String),
    /// The id of a node.
    Id,
    /// The title of a group.
    Title,
}

/// A field that is open on the canvas.
pub struct Typing {
    /// The node or the group.
    node: String,
    what: What,
    /// It may have several lines.
    lines: bool,
    /// It is typed even where there is a choice.
    raw: bool,
    text: String,
    /// The field was shown.
    begun: bool,
    /// It asked for the keyboard and has not got it yet.
    asked: bool,
    /// The entries to choose from are to be edited.
    pub entries: bool,
}

impl Typing {
    /// A field for the value of an input.
    pub fn new(node: String, port: String, model: &Model) -> Self {
        let there = model.document().nodes().get(&node);
        let value = there.and_then(|n| n.params.get(&port)).map(Literal::to_json).or_else(|| {
            let info = model.catalog.get(&there?.type_name)?;
            info.inputs.iter().find(|p| p.name == port)?.default.clone()
        });
        let lines = there.is_some_and(|n| matches!(n.type_name.as_str(), "note" | "text"));
        Self {
            node,
            what: What::Value(port),
            lines,
            raw: false,
            text: param::to_text(value.as_ref()),
            begun: false,
            asked: false,
            entries: false,
        }
    }

    /// The node whose entries are to be edited.
    pub fn node(&self) -> &str {
        &self.node
    }

    /// A field for the value of an input as the file has it, whatever is offered otherwise.
    pub fn raw(node: String, port: String, model: &Model) -> Self {
        Self { raw: true, ..Self::new(node, port, model) }
    }

    /// A field for the id of a node.
    pub fn rename(node: String) -> Self {
        Self { text: node.clone(), node, what: What::Id, ..Self::empty() }
    }

    /// A field for the title of a group.
    pub fn title(group: String, model: &Model) -> Self {
        let text = groups::title(model.document(), &group).to_owned();
        Self { text, node: group, what: What::Title, ..Self::empty() }
    }

    fn empty() -> Self {
        let (node, text) = (String::new(), String::new());
        Self { node, what: What::Id, lines: false, raw: false, text, begun: false, asked: false, entries: false }
    }

    /// The input whose value is typed.
    fn port(&self) -> Option<&str> {
        if let What::Value(port) = &self.what { Some(port) } else { None }
    }

    /// Where it stands on the canvas; none if there is no such place any more.
    pub fn place(&self, shapes: &Shapes, model: &Model) -> Option<Rect> {
        if matches!(self.what, What::Title) {
            return groups::strip(model.document(), shapes, &self.node);
        }
        let shape = &shapes.nodes[shapes.find(&self.node)?];
        if shape.kind == Kind::Note {
            return Some(shape.rect);
        }
        let Some(port) = self.port() else {
            let mut rect = shape.rect;
            rect.set_height(HEADER);
            return Some(rect);
        };
        let i = shape.inputs.iter().position(|p| p.name == port)?;
        let row = shape.rows.iter().position(|r| matches!(r, Row::Input(p, _) if *p == i))?;
        Some(shape.row_rect(row))
    }

    /// Shows it at `place`; false once it is closed.
    pub fn show(&mut self, ui: &mut Ui, place: Rect, area: Rect, model: &mut Model, zoom: f32) -> bool {
        let choices = if self.raw { Vec::new() } else { self.choices(model) };
        let mut open = true;
        let id = Id::new(("typing", &self.node, self.port()));
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
                            if self.is_value_list(model) {
                                ui.separator();
                                if ui.button("Edit the entries …").clicked() {
                                    self.entries = true;
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
        let file = self.is_file(model);
        let field = ui
            .horizontal(|ui| {
                let field = if self.lines {
                    let width = width.max(240.0);
                    ui.add(
                        TextEdit::multiline(&mut self.text)
                            .id_salt("typing-field")
                            .desired_width(width)
                            .desired_rows(3),
                    )
                } else {
                    ui.add_sized(vec2(width, 22.0), TextEdit::singleline(&mut self.text).id_salt("typing-field"))
                };
                if file && ui.button("…").on_hover_text("choose a file").clicked() {
                    model.wanted_file = Some((self.node.clone(), self.port().unwrap_or_default().to_owned()));
                }
                field
            })
            .inner;
        if model.wanted_file.is_some() {
            return false;
        }
        let again = self.begun && self.asked && !field.has_focus();
        self.asked = !self.begun;
        if !self.begun || again {
            // The menu that this was opened from takes the keyboard with it once more.
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
        // A long text is work while it is typed.
        model.set_typed(self.value(model).filter(|_| self.lines));
        let enter = ui.input(|i| i.key_pressed(Key::Enter) && (!self.lines || i.modifiers.command));
        if enter {
            self.commit(model);
            return false;
        }
        true
    }

    /// Whether the input names a file.
    fn is_file(&self, model: &Model) -> bool {
        let info = model.document().nodes().get(&self.node).map(|n| model.catalog.of(n));
        info.is_some_and(|t| t.inputs.iter().any(|p| Some(p.name.as_str()) == self.port() && p.file))
    }

    fn choices(&self, model: &Model) -> Vec<String> {
        let port = || {
            let node = model.document().nodes().get(&self.node)?;
            let info = model.catalog.get(&node.type_name)?;
            let port = info.inputs.iter().find(|p| Some(p.name.as_str()) == self.port())?;
            Some(param::at(node, port, None).choices)
        };
        port().unwrap_or_default()
    }

    fn is_value_list(&self, model: &Model) -> bool {
        model.document().nodes().get(&self.node).is_some_and(|n| n.type_name == "value_list")
    }

    /// The operation that sets ends, value and step of a slider as they were typed; none if that is not what was typed.
    fn slider(&self, model: &Model) -> Option<Operation> {
        let node = model.document().nodes().get(&self.node)?;
        let whole = node.type_name == "integer_slider";
        let typed = param::Typed::read(&self.text).filter(|_| self.text.contains(['<']) || self.text.contains(".."))?;
        if !(whole && typed.type_name() == "integer_slider" || node.type_name == "slider") {
            return None;
        }
        let set = |(port, value): (&str, tenon_engine::Json)| Operation::SetParam {
            node: self.node.clone(),
            port: port.to_owned(),
            value: Some(value),
        };
        Some(Operation::All(typed.params().into_iter().map(set).collect()))
    }

    /// Puts what was typed into the graph.
    pub fn commit(&self, model: &mut Model) {
        if matches!(self.what, What::Title) {
            let title = Some(self.text.trim()).filter(|t| !t.is_empty() && *t != self.node);
            let now = groups::title(model.document(), &self.node);
            if self.text == now || title.unwrap_or(&self.node) == now {
                return;
            }
            let operation = model.set_in_group(&self.node, "title", title.map(Into::into));
            model.edit(operation);
            return;
        }
        let Some(port) = self.port().map(str::to_owned) else {
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
        if let Some(operation) = self.slider(model).filter(|_| port == "value") {
            model.edit(operation);
        } else if let Some(operation) = self.value(model) {
            model.edit(operation);
        }
    }

    /// Sets the input to what was typed; none if that changes nothing.
    fn value(&self, model: &Model) -> Option<Operation> {
        let port = self.port()?.to_owned();
        let node = model.document().nodes().get(&self.node);
        let info = node.and_then(|n| model.catalog.get(&n.type_name)).cloned();
        let input = info.as_ref()?.inputs.iter().find(|p| p.name == port)?;
        let value = param::from_text(input, &self.text);
        let old = model.param(&self.node, &port);
        let changes = value != old && !(old.is_none() && value == input.default);
        changes.then(|| Operation::SetParam { node: self.node.clone(), port, value })
    }
}
