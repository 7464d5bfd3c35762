//! Lists that stand at an input, as a table: points with their weights, numbers, texts. Rows are typed, turned, added, moved
//! and taken away; above those of points stands a drawing of them.

use crate::model::Model;
use crate::model::catalog::PortInfo;
use crate::model::param::number;
use crate::panels::figure;
use crate::panels::plan::{Drawn, Plan};
use crate::scene::Drawing;
use eframe::egui::{Button, DragValue, Key, Rect, Response, ScrollArea, TextEdit, Ui, WidgetInfo, WidgetType, Window};
use tenon_engine::{Access, Json, Operation};

/// What one row is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Row {
    /// Three coordinates.
    Point,
    Number,
    Integer,
    Text,
}

fn row_of(port: &PortInfo) -> Option<Row> {
    match port.type_name.as_str() {
        "point" | "vector" => Some(Row::Point),
        "number" => Some(Row::Number),
        "integer" => Some(Row::Integer),
        "text" => Some(Row::Text),
        _ => None,
    }
}

/// A list as rows of JSON values; none if it is something that a table does not show, such as a formula.
fn rows(row: Row, value: Option<&Json>) -> Option<Vec<Json>> {
    let Some(value) = value else { return Some(Vec::new()) };
    let point = |v: &Json| v.as_array().is_some_and(|l| (2..=3).contains(&l.len()) && l.iter().all(Json::is_number));
    let fits = |v: &Json| match row {
        Row::Point => point(v),
        Row::Number | Row::Integer => v.is_number(),
        Row::Text => v.is_string(),
    };
    if fits(value) && row != Row::Text {
        return Some(vec![value.clone()]);
    }
    value.as_array().filter(|l| l.iter().all(fits)).cloned()
}

/// Whether a table shows what stands at an input.
#[must_use]
pub fn edits(port: &PortInfo, value: Option<&Json>) -> bool {
    let Some(row) = row_of(port) else { return false };
    match port.access {
        // One point has three fields; one number or text is typed where it stands.
        Access::Item => row == Row::Point && rows(row, value).is_some_and(|r| r.len() == 1),
        _ => rows(row, value).is_some(),
    }
}

/// An open table.
pub struct Table {
    node: String,
    port: PortInfo,
    /// A value is being turned or typed, or a point dragged, which is one step.
    turning: bool,
    plan: Plan,
    /// How wide the fields of each column are: three coordinates, or a number, and a weight.
    widths: [f32; 4],
}

/// What is done with the rows.
enum Change {
    /// A row has another value.
    Set(usize, Json),
    /// A weight has another value.
    Weight(usize, f64),
    /// A new row, before the one of this number.
    Add(usize, Json),
    Remove(usize),
    Up(usize),
}

impl Table {
    /// Opens the table of an input.
    #[must_use]
    pub fn new(node: String, port: PortInfo) -> Self {
        Self { node, port, turning: false, plan: Plan::default(), widths: [0.0; 4] }
    }

    /// Shows it in a window of its own; false once it is closed.
    pub fn window(&mut self, ui: &Ui, area: Rect, model: &mut Model) -> bool {
        // What is dragged or typed there gives Escape its meaning first.
        let escaped = ui.input(|i| i.key_pressed(Key::Escape)) && !self.turning;
        let mut open = true;
        let title = format!("{}.{}", self.node, self.port.name);
        let window =
            Window::new(title).open(&mut open).collapsible(false).default_pos(area.left_top()).constrain_to(area);
        let shown = window.default_size([330.0, 260.0]).show(ui.ctx(), |ui| self.show(ui, model));
        let there = shown.is_none_or(|s| s.inner.unwrap_or(true));
        let goes_on = open && there && !escaped;
        if !goes_on && self.turning {
            model.end();
        }
        goes_on
    }

    /// Shows the rows; false if there is no such list any more.
    fn show(&mut self, ui: &mut Ui, model: &mut Model) -> bool {
        let Some(node) = model.document().nodes().get(&self.node) else { return false };
        let value = model.param(&self.node, &self.port.name).or_else(|| self.port.default.clone());
        let Some((row, list)) = row_of(&self.port).and_then(|row| Some((row, rows(row, value.as_ref())?))) else {
            return false;
        };
        let weighted = model.catalog.of(node).inputs.iter().any(|p| p.name == "weights") && self.port.name == "points";
        let weights = weighted.then(|| weights(model.param(&self.node, "weights").as_ref(), list.len()));
        let single = self.port.access == Access::Item;
        ui.weak(&self.port.doc);
        let (mut change, mut busy) = (None, false);
        if row == Row::Point && !single {
            change = self.draw(ui, model, &list);
            busy = self.plan.is_dragging();
        }
        let height = ui.spacing().interact_size.y;
        let room = (ui.ctx().content_rect().height() - 440.0).clamp(80.0, 360.0);
        ScrollArea::vertical().max_height(room).show_rows(ui, height, list.len(), |ui, seen| {
            for i in seen {
                let Some(item) = list.get(i) else { continue };
                ui.horizontal(|ui| {
                    ui.monospace(format!("{:>3}", i + 1));
                    let (new, turned) = cells(ui, row, i, item, &self.port.unit, &mut self.widths[..3]);
                    busy |= turned;
                    change = new.map(|v| Change::Set(i, v)).or(change.take());
                    if let Some(w) = weights.as_ref().and_then(|w| w.get(i)) {
                        let mut w = *w;
                        let field = column(
                            ui,
                            &mut self.widths[3],
                            figure(&mut w, "").speed(0.01).range(1e-6..=1e6).prefix("w "),
                        );
                        named(&field, format!("weight of {}", i + 1));
                        busy |= field.dragged() || field.has_focus();
                        if field.changed() {
                            change = Some(Change::Weight(i, w));
                        }
                    }
                    if single {
                        return;
                    }
                    if ui.add_enabled(i > 0, Button::new("⬆").small()).on_hover_text("one up").clicked() {
                        change = Some(Change::Up(i));
                    }
                    if ui.small_button("×").on_hover_text("take it away").clicked() {
                        change = Some(Change::Remove(i));
                    }
                });
            }
        });
        if !single {
            ui.horizontal(|ui| {
                if ui.button("Add a row").clicked() {
                    change = Some(Change::Add(list.len(), next(row, &list)));
                }
                ui.weak(format!("{} rows", list.len()));
            });
        }
        if busy && !self.turning {
            model.begin();
        }
        if let Some(change) = change {
            self.apply(model, list, weights, change);
        }
        match !busy && self.turning {
            true if ui.input(|i| i.key_pressed(Key::Escape)) => model.abort(),
            true => model.end(),
            false => {}
        }
        self.turning = busy;
        true
    }

    /// The points as a drawing, with the curves that the node makes.
    fn draw(&mut self, ui: &mut Ui, model: &Model, list: &[Json]) -> Option<Change> {
        let points: Vec<[f64; 3]> = list.iter().map(coordinates).collect();
        let node = format!("{}.", model.path_of(&self.node));
        let made = model.results.drawings.iter().filter(|(output, _)| output.starts_with(&node));
        let made: Vec<&Drawing> = made.map(|(_, drawing)| &**drawing).collect();
        let json = |p: [f64; 3]| p.into_iter().map(number).collect();
        Some(match self.plan.show(ui, &points, &made)? {
            Drawn::Move(i, p) => Change::Set(i, json(p)),
            Drawn::Put(i, p) => Change::Add(i, json(p)),
            Drawn::Take(i) => Change::Remove(i),
        })
    }

    fn apply(&self, model: &mut Model, mut list: Vec<Json>, weights: Option<Vec<f64>>, change: Change) {
        // Weights that are all 1 need not stand in the file.
        let (mut all, plain) = (weights.unwrap_or_default(), |w: &[f64]| w.iter().all(|w| *w == 1.0));
        let was = all.clone();
        match change {
            Change::Set(i, value) => list[i] = value,
            Change::Weight(i, w) => all[i] = w,
            Change::Add(i, value) => {
                list.insert(i, value);
                if !was.is_empty() || list.len() == 1 {
                    all.insert(i, 1.0);
                }
            }
            Change::Remove(i) => {
                list.remove(i);
                if i < all.len() {
                    all.remove(i);
                }
            }
            Change::Up(i) => {
                list.swap(i - 1, i);
                if i < all.len() {
                    all.swap(i - 1, i);
                }
            }
        }
        let set = |port: &str, value| Operation::SetParam { node: self.node.clone(), port: port.to_owned(), value };
        let value = match self.port.access {
            Access::Item => list.into_iter().next(),
            _ => Some(list.into_iter().collect()),
        };
        let mut operations = vec![set(&self.port.name, value)];
        if all != was && !(plain(&all) && plain(&was)) {
            let value = (!plain(&all)).then(|| all.into_iter().map(number).collect());
            operations.push(set("weights", value));
        }
        model.edit(Operation::All(operations));
    }
}

/// A field in a column: as wide as the widest that was seen there, so that those below each other begin and end alike.
fn column(ui: &mut Ui, width: &mut f32, field: DragValue<'_>) -> Response {
    let shown = ui.scope(|ui| {
        ui.spacing_mut().interact_size.x = width.max(ui.spacing().interact_size.x);
        ui.add(field)
    });
    // While it is typed in it is as wide as its text, which is not yet a figure.
    if !shown.inner.has_focus() {
        *width = width.max(shown.inner.rect.width());
    }
    shown.inner
}

fn named(response: &Response, name: String) {
    response.widget_info(|| WidgetInfo::labeled(WidgetType::DragValue, true, &name));
}

/// The fields of a row; gives its new value if it has one, and whether it is being turned or typed.
fn cells(ui: &mut Ui, row: Row, i: usize, item: &Json, unit: &str, widths: &mut [f32]) -> (Option<Json>, bool) {
    let (mut new, mut busy) = (None, false);
    match row {
        Row::Point => {
            let mut p = coordinates(item);
            for ((axis, slot), width) in ["x", "y", "z"].into_iter().zip(&mut p).zip(widths) {
                let field = figure(slot, "mm").speed(1.0).max_decimals(3).prefix(format!("{axis} "));
                let field = column(ui, width, field);
                named(&field, format!("{axis} of {}", i + 1));
                busy |= field.dragged() || field.has_focus();
                if field.changed() {
                    new = Some(());
                }
            }
            (new.map(|()| p.into_iter().map(number).collect()), busy)
        }
        Row::Number | Row::Integer => {
            let mut v = item.as_f64().unwrap_or_default();
            let whole = row == Row::Integer;
            let field =
                figure(&mut v, unit).max_decimals(if whole { 0 } else { 6 }).speed(if whole { 0.2 } else { 0.1 });
            let field =
                column(ui, &mut widths[0], if unit.is_empty() { field } else { field.suffix(format!(" {unit}")) });
            named(&field, format!("value {}", i + 1));
            (field.changed().then(|| number(v)), field.dragged() || field.has_focus())
        }
        Row::Text => {
            let mut text = item.as_str().unwrap_or_default().to_owned();
            let field = ui.add(TextEdit::singleline(&mut text).desired_width(170.0));
            (field.changed().then(|| text.into()), field.has_focus())
        }
    }
}

/// The weights of so many points; 1 where none is set.
fn weights(value: Option<&Json>, count: usize) -> Vec<f64> {
    let set = value.and_then(Json::as_array);
    (0..count).map(|i| set.and_then(|l| l.get(i)).and_then(Json::as_f64).unwrap_or(1.0)).collect()
}

/// The coordinates of a point; those that are not there are 0.
fn coordinates(point: &Json) -> [f64; 3] {
    [0, 1, 2].map(|k| point.get(k).and_then(Json::as_f64).unwrap_or_default())
}

/// What a new row begins with: a point goes on from the last two, everything else repeats the last.
fn next(row: Row, list: &[Json]) -> Json {
    match (row, list) {
        (Row::Point, [.., a, b]) => {
            let (a, b) = (coordinates(a), coordinates(b));
            (0..3).map(|k| number(2.0 * b[k] - a[k])).collect()
        }
        (Row::Point, [a]) => {
            let a = coordinates(a);
            [a[0] + 1000.0, a[1], a[2]].into_iter().map(number).collect()
        }
        (Row::Point, []) => [0.0; 3].into_iter().map(number).collect(),
        (_, [.., last]) => last.clone(),
        (Row::Text, []) => "".into(),
        (Row::Number | Row::Integer, []) => 0.into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn lists_become_rows_and_formulas_do_not() {
        assert_eq!(rows(Row::Point, Some(&json!([[0, 0], [1, 2, 3]]))).map(|r| r.len()), Some(2));
        assert_eq!(rows(Row::Point, Some(&json!([1, 2, 3]))), Some(vec![json!([1, 2, 3])]));
        assert_eq!(rows(Row::Number, Some(&json!([1, 2, 3]))).map(|r| r.len()), Some(3));
        assert_eq!(rows(Row::Number, Some(&json!("t * 2"))), None);
        assert_eq!(rows(Row::Number, None), Some(vec![]));
    }

    #[test]
    fn a_new_point_goes_on_where_the_others_lead() {
        assert_eq!(next(Row::Point, &[json!([0, 0, 0]), json!([10, 5])]), json!([20, 10, 0]));
        assert_eq!(next(Row::Number, &[json!(4)]), json!(4));
    }
}
