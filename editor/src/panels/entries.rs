//! The entries of a value list: names and values, typed, added, moved and taken away in a window.

use crate::model::{Model, param};
use eframe::egui::{Button, Key, Rect, ScrollArea, TextEdit, Ui, WidgetInfo, WidgetType, Window};
use tenon_engine::{Json, Operation};

/// The open entries of a value list.
pub struct Entries {
    node: String,
    /// What stands in the fields; it becomes part of the graph once a field is left.
    rows: Vec<[String; 2]>,
    /// Names as the graph has them.
    names: Vec<Json>,
    /// The parameters that the rows were read from.
    read: Option<[Option<Json>; 2]>,
}

impl Entries {
    /// Opens those of a node.
    #[must_use]
    pub fn new(node: String) -> Self {
        Self { node, rows: Vec::new(), names: Vec::new(), read: None }
    }

    /// Shows them in a window of its own; false once it is closed.
    pub fn window(&mut self, ui: &Ui, area: Rect, model: &mut Model) -> bool {
        let there = model.document().nodes().get(&self.node).is_some_and(|n| n.type_name == "value_list");
        let mut open = there;
        let window = Window::new(format!("Entries of {}", self.node)).open(&mut open).collapsible(false);
        window.default_pos(area.left_top()).constrain_to(area).default_width(330.0).show(ui.ctx(), |ui| {
            self.show(ui, model);
        });
        let escaped = ui.input(|i| i.key_pressed(Key::Escape)) && !ui.ctx().egui_wants_keyboard_input();
        open && !escaped
    }

    fn read(&mut self, model: &Model) {
        let params = ["names", "values"].map(|port| model.param(&self.node, port));
        if self.read.as_ref() == Some(&params) {
            return;
        }
        let default = |port: &str| {
            let info = model.catalog.get("value_list")?;
            info.inputs.iter().find(|p| p.name == port)?.default.clone()
        };
        let list = |port: &str, set: &Option<Json>| -> Vec<Json> {
            match set.clone().or_else(|| default(port)) {
                Some(Json::Array(list)) => list,
                Some(one) => vec![one],
                None => Vec::new(),
            }
        };
        let (names, values) = (list("names", &params[0]), list("values", &params[1]));
        let text = |list: &[Json], i: usize| param::to_text(list.get(i));
        self.names.clone_from(&names);
        self.rows = (0..names.len().max(values.len())).map(|i| [text(&names, i), text(&values, i)]).collect();
        self.read = Some(params);
    }

    fn show(&mut self, ui: &mut Ui, model: &mut Model) {
        self.read(model);
        let (mut changed, escape) = (false, ui.input(|i| i.key_pressed(Key::Escape)));
        let room = (ui.ctx().content_rect().height() - 240.0).clamp(80.0, 360.0);
        ScrollArea::vertical().max_height(room).show(ui, |ui| {
            let (mut up, mut gone) = (None, None);
            for (i, row) in self.rows.iter_mut().enumerate() {
                ui.horizontal(|ui| {
                    for (text, what) in row.iter_mut().zip(["name", "value"]) {
                        let field = ui.add(TextEdit::singleline(text).desired_width(110.0).hint_text(what));
                        field.widget_info(|| {
                            WidgetInfo::labeled(WidgetType::TextEdit, true, format!("{what} of entry {}", i + 1))
                        });
                        // Escape leaves it as it was.
                        changed |= field.lost_focus() && !escape;
                        if field.lost_focus() && escape {
                            self.read = None;
                        }
                    }
                    if ui.add_enabled(i > 0, Button::new("⬆").small()).on_hover_text("one up").clicked() {
                        up = Some(i);
                    }
                    if ui.small_button("×").on_hover_text("take it away").clicked() {
                        gone = Some(i);
                    }
                });
            }
            if let Some(i) = up {
                self.rows.swap(i - 1, i);
            }
            if let Some(i) = gone {
                self.rows.remove(i);
            }
            changed |= up.is_some() || gone.is_some();
        });
        if ui.button("Add an entry").clicked() {
            let name = format!("entry {}", self.rows.len() + 1);
            let value = self.rows.last().map_or("0", |row| row[1].as_str()).to_owned();
            self.rows.push([name, value]);
            changed = true;
        }
        if changed {
            self.commit(model);
        }
    }

    /// Brings the rows into the graph as one step; the chosen entry stays chosen when its name is typed anew.
    fn commit(&mut self, model: &mut Model) {
        let names: Vec<Json> = self.rows.iter().map(|row| Json::from(row[0].as_str())).collect();
        let values: Vec<Json> = values(self.rows.iter().map(|row| row[1].trim()));
        let set = |port: &str, value| Operation::SetParam { node: self.node.clone(), port: port.to_owned(), value };
        let mut all = vec![set("names", Some(names.clone().into())), set("values", Some(values.into()))];
        if let Some(chosen) = model.param(&self.node, "chosen")
            && !names.contains(&chosen)
            && self.names.len() == names.len()
            && let Some(place) = self.names.iter().position(|name| *name == chosen)
        {
            all.push(set("chosen", names.get(place).cloned()));
        }
        let now = ["names", "values"].map(|port| model.param(&self.node, port));
        if now != [Some(names.into()), all_values(&all)] {
            model.edit(Operation::All(all));
        }
        self.read = None;
    }
}

/// What the operations set the values to.
fn all_values(all: &[Operation]) -> Option<Json> {
    all.iter().find_map(|o| match o {
        Operation::SetParam { port, value, .. } if port == "values" => value.clone(),
        _ => None,
    })
}

/// Values of one type: numbers if all are, else truth values if all are, else texts.
fn values<'a>(texts: impl Iterator<Item = &'a str> + Clone) -> Vec<Json> {
    let numbers: Option<Vec<Json>> =
        texts.clone().map(|t| t.parse::<f64>().ok().filter(|v| v.is_finite()).map(param::number)).collect();
    let truths = || texts.clone().map(|t| t.parse::<bool>().ok().map(Json::from)).collect::<Option<Vec<Json>>>();
    numbers.or_else(truths).unwrap_or_else(|| texts.clone().map(Json::from).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn values_are_of_one_type() {
        assert_eq!(values(["6.5", "18"].into_iter()), [json!(6.5), json!(18)]);
        assert_eq!(values(["true", "false"].into_iter()), [json!(true), json!(false)]);
        assert_eq!(values(["oak", "18"].into_iter()), [json!("oak"), json!("18")]);
    }
}
