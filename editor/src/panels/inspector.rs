//! What the selected node is: its doc, every input with its value, every output with what it gives.

use super::examples::{Examples, Shown};
use super::figure::read;
use crate::model::Model;
use crate::model::catalog::{PortInfo, TypeInfo};
use crate::model::param::{self, Widget, number, widget};
use crate::theme::Theme;
use eframe::egui::{
    self, Checkbox, ComboBox, Grid, Id, RichText, ScrollArea, Slider, SliderClamping, TextEdit, Ui, WidgetInfo,
    WidgetType,
};
use tenon_engine::{Json, Operation, Quantity};

/// Shows the one selected node; if none is, the inputs and outputs of the graph.
pub fn inspector(ui: &mut Ui, model: &mut Model, examples: &mut Examples) -> Option<Shown> {
    close_what_is_gone(ui, model);
    let mut ids = model.selection.iter();
    let (Some(id), None) = (ids.next().cloned(), ids.next()) else {
        match model.selection.len() {
            0 => {
                ui.weak("Click a node to see its values. Double-click on the canvas to add one. F1 shows the keys.");
                super::interface::interface(ui, model);
            }
            n => drop(ui.weak(format!("{n} nodes are selected."))),
        }
        return None;
    };
    let node = model.document().nodes().get(&id).cloned()?;
    let info = model.catalog.of(&node);
    let mut shown = None;
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.strong(&id);
            ui.weak(format!("{}, {}", info.title, info.category));
        });
        ui.label(&info.doc);
        note(ui, model, &id, node.more.note.as_deref());
        problems(ui, model, &id);
        if !info.inputs.is_empty() {
            Grid::new(("inputs", &id)).num_columns(2).striped(true).show(ui, |ui| {
                for port in &info.inputs {
                    ui.label(&port.name).on_hover_text(&port.doc);
                    input(ui, model, &id, port);
                    ui.end_row();
                }
            });
        }
        outputs(ui, model, &id, &info);
        shown = examples.show(ui, &info.type_name);
    });
    shown
}

fn note(ui: &mut Ui, model: &mut Model, id: &str, note: Option<&str>) {
    let mut text = note.unwrap_or_default().to_owned();
    let field =
        TextEdit::singleline(&mut text).hint_text("remark").desired_width(f32::INFINITY).id(Id::new(("note", id)));
    let response = ui.add(field);
    step_around(ui, model, &response);
    if response.changed() {
        model.edit(Operation::SetNote { node: id.into(), note: Some(text).filter(|t| !t.is_empty()) });
    }
}

fn problems(ui: &mut Ui, model: &Model, id: &str) {
    let theme = Theme::of(ui);
    for d in model.results.of_node(&model.path_of(id)).take(20) {
        let item = d.item.map(|i| format!("item {i}: ")).unwrap_or_default();
        let hint = d.hint.as_ref().map(|h| format!(" ({h})")).unwrap_or_default();
        let colour = if d.severity == tenon_engine::Severity::Error { theme.error } else { theme.warning };
        ui.label(RichText::new(format!("{item}{}{hint}", d.message)).color(colour));
    }
}

/// Where it is kept which widget has an open step.
fn held() -> Id {
    Id::new("widget with an open step")
}

/// Everything between taking a widget and letting it go is one step; Escape gives it up.
pub(crate) fn step_around(ui: &Ui, model: &mut Model, response: &egui::Response) {
    let now = ui.data(|d| d.get_temp::<Id>(held()));
    if (response.drag_started() || response.gained_focus()) && now.is_none() {
        ui.data_mut(|d| d.insert_temp(held(), response.id));
        model.begin();
    }
    if (response.drag_stopped() || response.lost_focus()) && now == Some(response.id) {
        let_go(ui, model);
    }
}

fn let_go(ui: &Ui, model: &mut Model) {
    ui.data_mut(|d| d.remove::<Id>(held()));
    match ui.input(|i| i.key_pressed(egui::Key::Escape)) {
        true => model.abort(),
        false => model.end(),
    }
}

/// Closes the step of a widget that has gone without being let go, as when another node was selected meanwhile.
fn close_what_is_gone(ui: &Ui, model: &mut Model) {
    let Some(id) = ui.data(|d| d.get_temp::<Id>(held())) else { return };
    let there = ui.ctx().read_response(id).is_some();
    let busy = ui.memory(|m| m.has_focus(id)) || ui.ctx().is_being_dragged(id);
    if !(there && busy) {
        let_go(ui, model);
    }
}

fn input(ui: &mut Ui, model: &mut Model, id: &str, port: &PortInfo) {
    let node = model.document().nodes().get(id);
    let wires = node.and_then(|n| n.inputs.get(&port.name)).map_or(&[][..], |w| &w.from);
    if !wires.is_empty() {
        ui.weak(format!("from {}", wires.join(", ")));
        return;
    }
    value(ui, model, id, port);
}

/// The widget for the value of an input; what is set by it goes to the graph.
pub(super) fn value(ui: &mut Ui, model: &mut Model, id: &str, port: &PortInfo) {
    let address = format!("{id}.{}", port.name);
    let Some(node) = model.document().nodes().get(id) else { return };
    let bound = model.document().inputs.values().find(|i| i.ports.contains(&address));
    let port = &param::at(node, port, bound);
    let set = model.param(id, &port.name);
    let value = edit(ui, &address, port, &widget(port, set.as_ref()), set.as_ref(), model);
    if let Some(value) = value
        && value != set
    {
        model.edit(Operation::SetParam { node: id.into(), port: port.name.clone(), value });
    }
}

/// The widget of an input; gives the new value when it has one.
fn edit(
    ui: &mut Ui,
    address: &str,
    port: &PortInfo,
    w: &Widget,
    set: Option<&Json>,
    model: &mut Model,
) -> Option<Option<Json>> {
    let unit = if port.unit.is_empty() { String::new() } else { format!(" {}", port.unit) };
    let mut new = None;
    ui.horizontal(|ui| {
        match w {
            Widget::Slider(s) => {
                let mut value = s.value;
                let slider = Slider::new(&mut value, s.min..=s.max).step_by(s.by()).suffix(&unit);
                let measure = Quantity::unit(&port.unit);
                let slider = slider.custom_parser(move |text| read(text, measure));
                // Only a hand may change a value: by itself a slider would round it.
                let response =
                    ui.add(if s.integer { slider.integer() } else { slider }.clamping(SliderClamping::Edits));
                step_around(ui, model, &response);
                if response.changed()
                    && value != s.value
                    && (response.dragged() || response.has_focus() || response.clicked())
                {
                    new = Some(Some(number(param::slid(value))));
                }
            }
            Widget::Number { value, integer } => {
                let mut value = *value;
                let speed = if *integer { 0.2 } else { param::round_step(value.abs().max(1.0) / 100.0) };
                let mut field = super::figure(&mut value, &port.unit)
                    .clamp_existing_to_range(false)
                    .speed(speed)
                    .suffix(&unit)
                    .max_decimals(if *integer { 0 } else { 6 });
                if let Some((min, max)) = port.range {
                    field = field.range(min..=max);
                }
                let response = ui.add(field);
                let name = || WidgetInfo::labeled(WidgetType::DragValue, true, format!("value of {address}"));
                response.widget_info(name);
                step_around(ui, model, &response);
                if response.changed() {
                    new = Some(Some(number(value)));
                }
            }
            Widget::Toggle(on) => {
                let mut on = *on;
                if ui.add(Checkbox::without_text(&mut on)).changed() {
                    new = Some(Some(on.into()));
                }
            }
            Widget::Choice(now) => {
                ComboBox::from_id_salt(address).selected_text(now).show_ui(ui, |ui| {
                    for choice in &port.choices {
                        if ui.selectable_label(choice == now, choice).clicked() {
                            new = Some(Some(Json::from(choice.as_str())));
                        }
                    }
                });
            }
            Widget::Text(_) | Widget::Other(_) | Widget::Empty => new = typed(ui, address, port, set),
        }
        if set.is_some()
            && port.default.is_some()
            && ui.small_button("↺").on_hover_text("back to the default").clicked()
        {
            new = Some(None);
        }
    });
    new
}

/// A value that is typed counts when Enter is pressed or the field is left.
fn typed(ui: &mut Ui, address: &str, port: &PortInfo, set: Option<&Json>) -> Option<Option<Json>> {
    let id = Id::new(("typed", address));
    let now = param::to_text(set.or(port.default.as_ref()));
    let mut text = ui.data(|d| d.get_temp::<String>(id)).unwrap_or_else(|| now.clone());
    let hint = if port.optional { "none" } else { "value or wire" };
    let response = ui.add(TextEdit::singleline(&mut text).desired_width(180.0).hint_text(hint).id(id.with("field")));
    if response.lost_focus() {
        ui.data_mut(|d| d.remove::<String>(id));
        let escaped = ui.input(|i| i.key_pressed(egui::Key::Escape));
        return (!escaped && text != now).then(|| param::from_text(port, &text));
    }
    if response.has_focus() {
        ui.data_mut(|d| d.insert_temp(id, text));
    }
    None
}

fn outputs(ui: &mut Ui, model: &Model, id: &str, info: &TypeInfo) {
    ui.separator();
    for port in &info.outputs {
        let value = model.value(&format!("{id}.{}", port.name));
        let text = value.map_or_else(|| "no value yet".to_owned(), crate::canvas::value_in_short);
        ui.horizontal_wrapped(|ui| {
            ui.label(RichText::new(&port.name).strong()).on_hover_text(&port.doc);
            ui.label(text);
        });
    }
}
