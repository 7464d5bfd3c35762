//! What a tooltip says of a node or a port: what it is for, and what stands there now.

use super::shape::Shape;
use crate::model::Model;
use crate::model::words::in_short;
use crate::theme;
use eframe::egui::{RichText, Ui};
use tenon_engine::{Access, Severity, Tree};

/// The lines for a node.
pub fn node(ui: &mut Ui, model: &Model, shape: &Shape) {
    ui.set_max_width(340.0);
    ui.strong(format!("{} ({})", shape.info.title, shape.info.type_name));
    ui.label(&shape.info.doc);
    if let Some(note) = model.document().nodes().get(&shape.id).and_then(|n| n.more.note.as_ref()) {
        ui.label(RichText::new(note).italics());
    }
    if let Some(r) = model.results.nodes.get(&*model.path_of(&shape.id)) {
        ui.weak(format!("{} in {}, {}", r.happened.as_str(), theme::duration(r.time), bytes(r.bytes)));
    }
    if model.was_stopped_at(&shape.id) {
        ui.weak("stopped while it ran; F5 runs it again");
    }
    if !model.previews(&shape.id) {
        ui.weak("not shown in the viewport; Ctrl+Q shows it");
    }
    if model.results.worst(&model.path_of(&shape.id)).is_some() {
        ui.separator();
        problems(ui, model, shape);
    }
}

/// What is wrong with a node, the worst first.
pub fn problems(ui: &mut Ui, model: &Model, shape: &Shape) {
    const MOST: usize = 6;
    ui.set_max_width(380.0);
    let theme = theme::Theme::of(ui);
    let path = model.path_of(&shape.id);
    for d in model.results.of_node(&path).take(MOST) {
        let colour = if d.severity == Severity::Error { theme.error } else { theme.warning };
        let port = d.port.as_ref().map(|p| format!("{p}: ")).unwrap_or_default();
        let item = d.item.map(|i| format!("item {i}: ")).unwrap_or_default();
        ui.colored_label(colour, format!("{port}{item}{}", d.message));
        if let Some(hint) = &d.hint {
            ui.label(&**hint);
        }
    }
    let rest = model.results.of_node(&path).count().saturating_sub(MOST);
    if rest > 0 {
        ui.weak(format!("and {rest} more, under errors in the status line"));
    }
}

/// The lines for a port.
pub fn port(ui: &mut Ui, model: &Model, shape: &Shape, port: usize, output: bool) {
    let Some(info) = (if output { shape.outputs.get(port) } else { shape.inputs.get(port) }) else { return };
    ui.set_max_width(340.0);
    let access = match info.access {
        Access::Item => "",
        Access::List => "list of ",
        Access::Tree => "tree of ",
    };
    let unit = if info.unit.is_empty() { String::new() } else { format!(", {}", info.unit) };
    ui.strong(format!("{}: {access}{}{unit}", info.name, info.type_name));
    ui.label(&info.doc);
    if let Some((min, max)) = info.range {
        ui.weak(format!("from {min} to {max}"));
    }
    if output {
        match model.value(&format!("{}.{}", shape.id, info.name)) {
            Some(tree) => ui.weak(value(tree)),
            None => ui.weak("no value yet"),
        };
        return;
    }
    let node = model.document().nodes().get(&shape.id);
    let wires = node.and_then(|n| n.inputs.get(&info.name)).map_or(&[][..], |w| &w.from);
    for from in wires.iter().take(6) {
        let there = model.value(from.as_str()).map_or_else(|| "no value yet".to_owned(), value);
        ui.weak(format!("from {from}: {there}"));
    }
    if wires.len() > 6 {
        ui.weak(format!("and {} wires more", wires.len() - 6));
    }
}

/// A value in one line: branches, items, and what the first ones are.
#[must_use]
pub fn value(tree: &Tree) -> String {
    let (branches, items) = (tree.branches().len(), tree.len());
    let shape = match (branches, items) {
        (1, 1) => String::new(),
        (1, n) => format!("{n} items, "),
        (b, n) => format!("{b} branches, {n} items, "),
    };
    format!("{shape}{}", in_short(tree, 200))
}

/// A size for people.
#[must_use]
pub fn bytes(n: usize) -> String {
    match n as f64 {
        b if b >= 1e6 => format!("{:.1} MB", b / 1e6),
        b if b >= 1e3 => format!("{:.1} kB", b / 1e3),
        b => format!("{b} B"),
    }
}
