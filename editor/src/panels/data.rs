//! Any value as a table: one row per item, only those that are seen are made. Statistics of numbers; copy as CSV.

use crate::model::Model;
use eframe::egui::{ComboBox, RichText, ScrollArea, TextStyle, Ui};
use std::fmt::Write as _;
use tenon_engine::Tree;

/// What is shown.
#[derive(Default)]
pub struct DataView {
    /// `node.port`.
    port: Option<String>,
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
    /// Shows the values of the selected node's outputs.
    pub fn show(&mut self, ui: &mut Ui, model: &Model) {
        let chosen = model.selection.iter().next().filter(|_| model.selection.len() == 1);
        let node = chosen.and_then(|id| Some((id, model.document().nodes().get(id)?)));
        let Some((id, node)) = node else {
            ui.weak("Select one node to see what it gives.");
            return;
        };
        let info = model.catalog.of(node);
        let ports: Vec<String> = info.outputs.iter().map(|p| format!("{id}.{}", p.name)).collect();
        if !self.port.as_ref().is_some_and(|p| ports.contains(p)) {
            self.port = ports.first().cloned();
        }
        let Some(port) = self.port.clone() else { return };
        let tree = model.value(&port);
        ui.horizontal(|ui| {
            ComboBox::from_id_salt("data-port").selected_text(&port).show_ui(ui, |ui| {
                for p in &ports {
                    if ui.selectable_label(*p == port, p).clicked() {
                        self.port = Some(p.clone());
                    }
                }
            });
            let Some(tree) = tree else { return };
            if ui.button("Copy as CSV").clicked() {
                ui.ctx().copy_text(csv(tree));
            }
            ui.label(format!("{} branches, {} items of {}", tree.branches().len(), tree.len(), tree.type_name()));
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
            let line: String = format!("{path:<10} {i:>8}  {item}").chars().take(400).collect();
            ui.label(RichText::new(line).monospace());
        }
    });
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
