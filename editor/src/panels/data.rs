//! The value at any port as a table, one row per item, or as a tree whose branches open and close; only rows that are seen
//! are made. Statistics of numbers; copy as CSV.

use crate::model::Model;
use crate::model::catalog::PortInfo;
use eframe::egui::{ComboBox, RichText, ScrollArea, TextStyle, Ui, WidgetInfo, WidgetType};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use tenon_engine::Tree;

/// What is shown.
#[derive(Default)]
pub struct DataView {
    /// `node.port`, and whether that is an input.
    port: Option<(String, bool)>,
    /// Branches stand under their paths.
    as_tree: bool,
    /// Branches that are open, by number, of the port that is shown.
    open: BTreeSet<usize>,
    /// Digest of the value that the statistics are of, and they.
    statistics: Option<(u128, Option<Statistics>)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Statistics {
    count: usize,
    min: f64,
    max: f64,
    mean: f64,
}

/// A number, whatever its type is.
fn number(tree: &Tree, branch: usize, i: usize) -> Option<f64> {
    let column = &tree.branches().get(branch)?.1;
    column.get::<f64>(i).copied().or_else(|| column.get::<i64>(i).map(|v| *v as f64))
}

fn statistics(tree: &Tree) -> Option<Statistics> {
    let mut s = Statistics { count: 0, min: f64::INFINITY, max: f64::NEG_INFINITY, mean: 0.0 };
    for b in 0..tree.branches().len() {
        for v in (0..tree.branches()[b].1.len()).filter_map(|i| number(tree, b, i)) {
            s.count += 1;
            s.min = s.min.min(v);
            s.max = s.max.max(v);
            s.mean += (v - s.mean) / s.count as f64;
        }
    }
    (s.count > 0).then_some(s)
}

/// A text as a field of a CSV file.
fn field(text: &str) -> String {
    let plain = !text.contains([',', '"', '\n', '\r']);
    if plain { text.to_owned() } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

/// Path, index and item of all items, as a table with a head. O(items).
#[must_use]
pub fn csv(tree: &Tree) -> String {
    let mut text = format!("path,index,{}\n", tree.type_name());
    for (path, column) in tree.branches() {
        for i in 0..column.len() {
            let item = if column.is_valid(i) { field(&column.summary(i)) } else { String::new() };
            let _ = writeln!(text, "{},{i},{item}", field(&path.to_string()));
        }
    }
    text
}

impl DataView {
    /// Shows the values at the selected node's ports.
    pub fn show(&mut self, ui: &mut Ui, model: &Model) {
        let chosen = model.selection.iter().next().filter(|_| model.selection.len() == 1);
        let node = chosen.and_then(|id| Some((id, model.document().nodes().get(id)?)));
        let Some((id, node)) = node else {
            ui.weak("Select one node to see what it gives and takes.");
            return;
        };
        let info = model.catalog.of(node);
        let of = |ports: &[PortInfo], input: bool| -> Vec<(String, bool)> {
            ports.iter().map(|p| (format!("{id}.{}", p.name), input)).collect()
        };
        let ports = [of(&info.outputs, false), of(&info.inputs, true)].concat();
        if !self.port.as_ref().is_some_and(|p| ports.contains(p)) {
            self.port = ports.first().cloned();
            self.open.clear();
        }
        let Some(port) = self.port.clone() else { return };
        let arrives = port.1.then(|| model.arrives(id, port.0.split_once('.').map_or("", |(_, p)| p))).flatten();
        let tree = if port.1 { arrives.as_deref() } else { model.value(&port.0) };
        let words =
            |(address, input): &(String, bool)| if *input { format!("into {address}") } else { address.clone() };
        ui.horizontal(|ui| {
            let shown = ComboBox::from_id_salt("data-port").selected_text(words(&port)).show_ui(ui, |ui| {
                for p in &ports {
                    if ui.selectable_label(*p == port, words(p)).clicked() {
                        self.port = Some(p.clone());
                        self.open.clear();
                    }
                }
            });
            let label = || WidgetInfo::labeled(WidgetType::ComboBox, true, "port that is shown");
            shown.response.widget_info(label);
            let Some(tree) = tree else { return };
            ui.selectable_value(&mut self.as_tree, false, "Table");
            ui.selectable_value(&mut self.as_tree, true, "Tree");
            if ui.button("Copy as CSV").clicked() {
                ui.ctx().copy_text(csv(tree));
            }
            let count = |n: usize, one: &str, many: &str| format!("{n} {}", if n == 1 { one } else { many });
            let branches = count(tree.branches().len(), "branch", "branches");
            let items = count(tree.len(), "item", "items");
            ui.label(format!("{branches}, {items} of {}", tree.type_name()));
            if self.statistics.as_ref().is_none_or(|s| s.0 != tree.digest()) {
                self.statistics = Some((tree.digest(), statistics(tree)));
            }
            if let Some((_, Some(s))) = self.statistics {
                ui.label(format!("{} numbers from {} to {}, mean {:.4}", s.count, s.min, s.max, s.mean));
            }
        });
        match tree {
            None => {
                ui.weak("There is no value yet.");
            }
            Some(tree) if self.as_tree => branches(ui, tree, &mut self.open),
            Some(tree) => table(ui, tree),
        }
    }
}

fn table(ui: &mut Ui, tree: &Tree) {
    let mut starts = Vec::with_capacity(tree.branches().len());
    let mut count = 0;
    for (_, column) in tree.branches() {
        starts.push(count);
        count += column.len();
    }
    let height = ui.text_style_height(&TextStyle::Monospace);
    ScrollArea::both().auto_shrink(false).show_rows(ui, height, count, |ui, rows| {
        ui.style_mut().wrap_mode = Some(eframe::egui::TextWrapMode::Extend);
        for row in rows {
            let b = starts.partition_point(|s| *s <= row).saturating_sub(1);
            let (Some((path, column)), Some(start)) = (tree.branches().get(b), starts.get(b)) else { continue };
            let i = row - start;
            let item = if column.is_valid(i) { column.summary(i) } else { "(nothing)".to_owned() };
            let path = path.to_string();
            let line: String = format!("{path:<10} {i:>8}  {item}").chars().take(400).collect();
            ui.label(RichText::new(line).monospace());
        }
    });
}

/// Branches by their paths, each with its items below it if it is open. O(branches + rows seen).
fn branches(ui: &mut Ui, tree: &Tree, open: &mut BTreeSet<usize>) {
    let mut starts = Vec::with_capacity(tree.branches().len());
    let mut count = 0;
    for (b, (_, column)) in tree.branches().iter().enumerate() {
        starts.push(count);
        count += 1 + if open.contains(&b) { column.len() } else { 0 };
    }
    ui.horizontal(|ui| {
        if ui.small_button("open all").clicked() {
            *open = (0..tree.branches().len()).collect();
        }
        if ui.small_button("close all").clicked() {
            open.clear();
        }
    });
    let height = ui.spacing().interact_size.y;
    let mut toggled = None;
    ScrollArea::both().auto_shrink(false).show_rows(ui, height, count, |ui, rows| {
        ui.style_mut().wrap_mode = Some(eframe::egui::TextWrapMode::Extend);
        for row in rows {
            let b = starts.partition_point(|s| *s <= row).saturating_sub(1);
            let (Some((path, column)), Some(start)) = (tree.branches().get(b), starts.get(b)) else { continue };
            let Some(i) = (row - start).checked_sub(1) else {
                let mark = if open.contains(&b) { "−" } else { "+" };
                let words = format!("{mark} {path}  {} {}", column.len(), column.type_name());
                if ui.selectable_label(false, RichText::new(words).monospace()).clicked() {
                    toggled = Some(b);
                }
                continue;
            };
            let item = if column.is_valid(i) { column.summary(i) } else { "(nothing)".to_owned() };
            let line: String = format!("    {i:>8}  {item}").chars().take(400).collect();
            ui.label(RichText::new(line).monospace());
        }
    });
    if let Some(b) = toggled
        && !open.remove(&b)
    {
        open.insert(b);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tenon_engine::{Column, Path};

    #[test]
    fn tables_have_a_row_per_item_and_gaps_stay() {
        let a = (Path::root().child(1), Column::new(vec![1.0, 4.0]));
        let b = (Path::root(), Column::with_gaps(vec![None, Some(-2.0)]));
        let tree = Tree::from_branches(vec![a, b]);
        assert_eq!(csv(&tree), "path,index,number\n{0},0,\n{0},1,-2.0\n{0;1},0,1.0\n{0;1},1,4.0\n");
        let s = statistics(&tree).unwrap();
        assert_eq!((s.count, s.min, s.max, s.mean), (3, -2.0, 4.0, 1.0));
        assert_eq!(field("a \"b\", c"), "\"a \"\"b\"\", c\"");
    }
}
