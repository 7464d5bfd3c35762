//! The context menus of the canvas: of nodes, their ports, wires, groups, and of the empty canvas.

use super::hit::Hit;
use super::input::Typing;
use super::{Canvas, Finder, align, groups};
use crate::model::Model;
use crate::panels::entries::Entries;
use eframe::egui::{Response, Ui};
use tenon_engine::{Cluster, Look, Node, NodeState, Operation};

impl Canvas {
    pub(super) fn context_menu(&mut self, response: &Response, model: &mut Model) {
        let hit = self.menu_on.unwrap_or(Hit::Nothing);
        response.context_menu(|ui| {
            match hit {
                Hit::Wire(w) => return self.wire_menu(ui, w, model),
                Hit::Group(g) => return self.group_menu(ui, g, model),
                _ => {}
            }
            let Some(shape) = hit.node().and_then(|n| self.shapes.nodes.get(n)) else {
                if ui.button("Add a node …").clicked() {
                    self.finder = Some(Finder::new(self.menu_at, None));
                    ui.close();
                }
                if ui.button("Write a note").clicked() {
                    let at = self.view.to_canvas(response.rect, self.menu_at);
                    let (id, add) = model.new_node("note", [f64::from(at.x), f64::from(at.y)]);
                    if model.edit(add) {
                        self.typing = Some(Typing::new(id, "text".into(), model));
                    }
                    ui.close();
                }
                if ui.button("Show all").clicked() {
                    model.selection.clear();
                    self.fit = true;
                    ui.close();
                }
                return;
            };
            let id = shape.id.clone();
            ui.strong(&id);
            let state = |s: NodeState| -> Vec<Operation> {
                model.selection.iter().map(|id| Operation::SetState { node: id.clone(), state: s }).collect()
            };
            let all = [
                ("Enable", NodeState::On),
                ("Freeze", NodeState::Frozen),
                ("Bypass", NodeState::Bypassed),
                ("Disable", NodeState::Disabled),
            ];
            let mut operation = None;
            for (words, s) in all {
                if ui.add_enabled(shape.state != s, eframe::egui::Button::new(words)).clicked() {
                    operation = Some(Operation::All(state(s)));
                    ui.close();
                }
            }
            ui.separator();
            let shows = model.previews(&id);
            if ui.button(if shows { "Hide in the viewport" } else { "Show in the viewport" }).clicked() {
                if !model.selection.contains(&id) {
                    model.selection = [id.clone()].into();
                }
                let look = |id: &String| Look { shown: Some(!shows), ..model.document().look(id) };
                let all = model.selection.iter().map(|id| Operation::SetLook { node: id.clone(), look: look(id) });
                operation = Some(Operation::All(all.collect()));
                ui.close();
            }
            if ui.button("Rename …").clicked() {
                self.typing = Some(Typing::rename(id.clone()));
                ui.close();
            }
            if let Hit::Input(n, i) = hit
                && let Some(port) = self.shapes.nodes.get(n).and_then(|s| s.inputs.get(i))
                && ui.button(format!("Take all wires off {}", port.name)).clicked()
            {
                operation = Some(Operation::PutWires { node: id.clone(), port: port.name.clone(), wires: None });
                ui.close();
            }
            if let Some(slider) = model.number_to_slider(&id)
                && ui.button("Make it a slider").clicked()
            {
                operation = Some(slider);
                ui.close();
            }
            if let Hit::Input(_, i) | Hit::Value(_, i, _) = hit
                && let Some(port) = shape.inputs.get(i)
            {
                let at = [f64::from(shape.rect.left()) - 260.0, f64::from(shape.rect.top())];
                if let Some(slider) = model.slider_before(&id, &port.name, at)
                    && ui.button(format!("Put a slider before {}", port.name)).clicked()
                {
                    operation = Some(slider);
                    ui.close();
                }
                operation = operation.or(expose(ui, model, &id, &port.name, false));
            }
            if let Hit::Output(_, o) = hit
                && let Some(port) = shape.outputs.get(o)
            {
                operation = operation.or(expose(ui, model, &id, &port.name, true));
            }
            if model.selection.len() > 1 {
                ui.menu_button("Align", |ui| {
                    for (words, how) in align::ALL {
                        if ui.button(words).clicked() {
                            operation = align::align(model, &self.shapes, how);
                            ui.close();
                        }
                    }
                });
            }
            ui.separator();
            if ui.button("Duplicate").clicked() {
                model.message = model.duplicate([40.0, 40.0]).err();
                ui.close();
            }
            if ui.button("Group").clicked() {
                operation = Some(groups::group(model));
                ui.close();
            }
            if ui.button("Make a cluster").clicked() {
                model.message = model.gather().err();
                ui.close();
            }
            if model.document().nodes().get(&id).is_some_and(|n| n.type_name == "value_list")
                && ui.button("Edit the entries …").clicked()
            {
                self.entries = Some(Entries::new(id.clone()));
                ui.close();
            }
            if let Some(cluster) = model.document().nodes().get(&id).and_then(Node::cluster).map(str::to_owned) {
                cluster_menu(ui, model, &id, &cluster);
            }
            if ui.button("Delete").clicked() {
                model.delete_selection();
                ui.close();
            }
            if let Some(operation) = operation {
                model.edit(operation);
            }
        });
    }
}

/// What can be done with an instance of a cluster.
fn cluster_menu(ui: &mut Ui, model: &mut Model, id: &str, cluster: &str) {
    let linked = matches!(model.whole().clusters.get(cluster), Some(Cluster::File(_)));
    let words = if linked { "Look into the cluster" } else { "Enter the cluster" };
    if ui.button(words).clicked() {
        model.message = model.enter(id).err();
        ui.close();
    }
    if linked && ui.button("Take the cluster into this file").clicked() {
        model.message = model.embed(cluster).err();
        ui.close();
    }
    if ui.button("Explode the cluster").clicked() {
        model.message = model.explode(id).err();
        ui.close();
    }
}

/// Makes a port one of the graph's own, or of the cluster's that is worked on.
fn expose(ui: &mut Ui, model: &Model, node: &str, port: &str, output: bool) -> Option<Operation> {
    let address = format!("{node}.{port}");
    let document = model.document();
    let exposed = if output {
        document.outputs.values().any(|o| o.port == address)
    } else {
        document.inputs.values().any(|i| i.ports.contains(&address))
    };
    let of = if model.trail().is_empty() { "the graph" } else { "the cluster" };
    let words = match (exposed, output) {
        (true, _) => format!("{port} is no port of {of} any more"),
        (false, true) => format!("Make {port} an output of {of}"),
        (false, false) => format!("Make {port} an input of {of}"),
    };
    let clicked = ui.button(words).clicked();
    if clicked {
        ui.close();
    }
    clicked.then(|| model.toggle_exposed(node, port, output))
}

impl Canvas {
    fn wire_menu(&mut self, ui: &mut Ui, wire: usize, model: &mut Model) {
        let Some(wire_there) = self.shapes.wires.get(wire) else { return };
        let to = &self.shapes.nodes[wire_there.to];
        let (node, port) = (to.id.clone(), to.inputs[wire_there.port].name.clone());
        ui.strong(format!("{} to {node}.{port}", wire_there.from));
        if ui.button("Put a point into it").clicked() {
            let place = wire_there.source.map(|(n, o)| self.shapes.nodes[n].output(o));
            let middle = place.map_or(to.rect.min, |a| a + (to.input(wire_there.port) - a) / 2.0);
            self.reroute(wire, [f64::from(middle.x - 14.0), f64::from(middle.y - 9.0)], model);
            ui.close();
        } else if ui.button("Remove it").clicked() {
            model.edit(Operation::Disconnect { node, port, from: wire_there.from.clone() });
            ui.close();
        }
    }

    fn group_menu(&mut self, ui: &mut Ui, group: usize, model: &mut Model) {
        let Some(name) = model.document().groups.keys().nth(group).cloned() else { return };
        let mut rename = false;
        if let Some(operation) = groups::menu(ui, model, &name, &mut rename) {
            model.edit(operation);
        }
        if rename {
            self.typing = Some(Typing::title(name, model));
        }
    }
}
