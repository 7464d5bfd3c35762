//! The inputs and outputs of the graph, or of the cluster that is worked on: names, values, ends, units, words and order.

use super::inspector::value;
use crate::model::Model;
use crate::model::param;
use eframe::egui::{self, Button, Id, RichText, ScrollArea, TextEdit, Ui, WidgetInfo, WidgetType};
use tenon_engine::{Json, Operation};

/// Shows them all, to be changed.
pub(super) fn interface(ui: &mut Ui, model: &mut Model) {
    let of = if model.trail().is_empty() { "the graph" } else { "the cluster" };
    ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
        let inputs: Vec<String> = model.document().inputs_in_order().iter().map(|(n, _)| (*n).to_owned()).collect();
        let outputs: Vec<String> = model.document().outputs_in_order().iter().map(|(n, _)| (*n).to_owned()).collect();
        if inputs.is_empty() && outputs.is_empty() {
            ui.weak(format!("Right-click a port to make it one of {of}: then its name, ends and unit stand here."));
        }
        if !inputs.is_empty() {
            ui.strong(format!("Inputs of {of}"));
        }
        for (i, name) in inputs.iter().enumerate() {
            ui.push_id(("input", name), |ui| input(ui, model, name, i > 0));
        }
        if !outputs.is_empty() {
            ui.separator();
            ui.strong(format!("Outputs of {of}"));
        }
        for (i, name) in outputs.iter().enumerate() {
            ui.push_id(("output", name), |ui| output(ui, model, name, i > 0));
        }
    });
}

/// A text that counts once Enter is pressed or the field is left; Escape leaves it as it was.
fn field(ui: &mut Ui, label: &str, now: &str, hint: &str, width: f32) -> Option<String> {
    let id = Id::new(("interface", label));
    let mut text = ui.data(|d| d.get_temp::<String>(id)).unwrap_or_else(|| now.to_owned());
    let response = ui.add(TextEdit::singleline(&mut text).desired_width(width).hint_text(hint).id(id.with("field")));
    response.widget_info(|| WidgetInfo::labeled(WidgetType::TextEdit, true, label));
    if response.lost_focus() {
        ui.data_mut(|d| d.remove::<String>(id));
        let escaped = ui.input(|i| i.key_pressed(egui::Key::Escape));
        return Some(text.trim().to_owned()).filter(|text| !escaped && text != now);
    }
    if response.has_focus() {
        ui.data_mut(|d| d.insert_temp(id, text));
    }
    None
}

/// A button that moves a row up, and one that takes it away.
fn buttons(ui: &mut Ui, what: &str, name: &str, up: bool) -> (bool, bool) {
    let raise = ui.add_enabled(up, Button::new("⬆").small()).on_hover_text("one up");
    raise.widget_info(|| WidgetInfo::labeled(WidgetType::Button, up, format!("{what} {name} one up")));
    let remove = ui.small_button("×").on_hover_text("no port any more");
    remove.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, format!("take away {what} {name}")));
    (raise.clicked(), remove.clicked())
}

fn input(ui: &mut Ui, model: &mut Model, name: &str, up: bool) {
    let Some(now) = model.document().inputs.get(name).cloned() else { return };
    ui.horizontal(|ui| {
        if let Some(new) = field(ui, &format!("name of input {name}"), name, "name", 110.0) {
            model.message = model.rename_input(name, &new).err();
        }
        let first = now.ports.first().and_then(|p| p.split_once('.'));
        if let Some((id, port)) = first {
            let info = model.document().nodes().get(id).map(|n| model.catalog.of(n));
            if let Some(port) = info.and_then(|t| t.inputs.iter().find(|p| p.name == port).cloned()) {
                shared_value(ui, model, &now.ports, id, &port);
            }
        }
        let (raise, remove) = buttons(ui, "input", name, up);
        if raise {
            model.raise_input(name);
        }
        if remove {
            model.edit(Operation::SetInput { name: name.to_owned(), input: None });
        }
    });
    ui.horizontal(|ui| {
        let end = |v: Option<f64>| v.map(param::shown).unwrap_or_default();
        let mut set = |ui: &mut Ui, what: &str, value: Option<f64>| {
            let text = field(ui, &format!("{what} of {name}"), &end(value), what, 50.0)?;
            if text.is_empty() {
                return Some(None);
            }
            let number = text.parse::<f64>().ok().filter(|v| v.is_finite());
            if number.is_none() {
                let message = format!("\"{text}\" is no number");
                model.message = Some(tenon_engine::Diagnostic::error("bad-range", message));
            }
            number.map(Some)
        };
        let (min, max, step) = (set(ui, "min", now.min), set(ui, "max", now.max), set(ui, "step", now.step));
        if let Some(min) = min {
            model.change_input(name, |i| i.min = min);
        }
        if let Some(max) = max {
            model.change_input(name, |i| i.max = max);
        }
        if let Some(step) = step {
            model.change_input(name, |i| i.step = step);
        }
        let unit = now.unit.as_deref().unwrap_or_default();
        if let Some(unit) = field(ui, &format!("unit of {name}"), unit, "unit", 40.0) {
            model.change_input(name, |i| i.unit = Some(unit).filter(|u| !u.is_empty()));
        }
        let doc = now.doc.as_deref().unwrap_or_default();
        let width = (ui.available_width() - 16.0).max(120.0);
        if let Some(doc) = field(ui, &format!("doc of {name}"), doc, "what it means", width) {
            model.change_input(name, |i| i.doc = Some(doc).filter(|d| !d.is_empty()));
        }
    });
    ui.label(RichText::new(format!("goes to {}", now.ports.join(", "))).weak().small());
}

/// The value of an input: that of the first port behind it, which goes to all of them in the same step.
fn shared_value(ui: &mut Ui, model: &mut Model, ports: &[String], id: &str, port: &crate::model::catalog::PortInfo) {
    let before = model.param(id, &port.name);
    model.begin();
    value(ui, model, id, port);
    let after = model.param(id, &port.name);
    if before != after {
        share(model, ports, after);
    }
    model.end();
}

/// Gives a value to all ports but the first that have another one.
fn share(model: &mut Model, ports: &[String], after: Option<Json>) {
    let others = ports.iter().skip(1).filter_map(|p| p.split_once('.'));
    let others = others.filter(|(node, port)| model.param(node, port) != after);
    let set = |(node, port): (&str, &str)| Operation::SetParam {
        node: node.to_owned(),
        port: port.to_owned(),
        value: after.clone(),
    };
    let all: Vec<Operation> = others.map(set).collect();
    if !all.is_empty() {
        model.edit(Operation::All(all));
    }
}

fn output(ui: &mut Ui, model: &mut Model, name: &str, up: bool) {
    let Some(now) = model.document().outputs.get(name).cloned() else { return };
    ui.horizontal(|ui| {
        if let Some(new) = field(ui, &format!("name of output {name}"), name, "name", 110.0) {
            model.message = model.rename_output(name, &new).err();
        }
        let unit = now.unit.as_deref().unwrap_or_default();
        if let Some(unit) = field(ui, &format!("unit of output {name}"), unit, "unit", 40.0) {
            model.change_output(name, |o| o.unit = Some(unit).filter(|u| !u.is_empty()));
        }
        let doc = now.doc.as_deref().unwrap_or_default();
        if let Some(doc) = field(ui, &format!("doc of output {name}"), doc, "what it means", 190.0) {
            model.change_output(name, |o| o.doc = Some(doc).filter(|d| !d.is_empty()));
        }
        let (raise, remove) = buttons(ui, "output", name, up);
        if raise {
            model.raise_output(name);
        }
        if remove {
            model.edit(Operation::SetOutput { name: name.to_owned(), output: None });
        }
    });
    ui.label(RichText::new(format!("from {}", now.port)).weak().small());
}
