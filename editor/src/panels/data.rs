//! The value at any port as a table, one row per item, or as a tree whose branches open and close; only rows that are seen
//! are made. Statistics of numbers; copy as CSV. What takes as long as there are items is done beside the window, and only
//! when the value has changed.

use crate::model::Model;
use crate::model::arrives::Arriving;
use crate::model::beside::Beside;
use crate::model::catalog::PortInfo;
use crate::model::words::words;
use eframe::egui::{Button, ComboBox, Context, RichText, ScrollArea, TextStyle, Ui, WidgetInfo, WidgetType};
use std::fmt::Write as _;
use std::sync::Arc;
use tenon_engine::{Column, Json, Text, Tree};

/// Most letters of an item that a row shows.
const LETTERS: usize = 2000;

/// What is seen of a value: what is told of it, none if there is no value, or why there cannot be any.
type Made = Result<Option<Seen>, String>;

/// What is shown.
#[derive(Default)]
pub struct DataView {
    /// `node.port`, and whether that is an input.
    port: Option<(String, bool)>,
    /// Branches stand under their paths.
    as_tree: bool,
    seen: Beside<Made>,
    /// The port that it is of: while a value changes, the one before is shown.
    seen_at: Option<(String, bool)>,
    /// The rows of the tree, by the digest of the value that they are of.
    folds: Option<(u128, Folds)>,
    /// What is being made into a table for the clipboard.
    copying: Option<Tree>,
    csv: Beside<String>,
    /// What was to be copied last could not be made into a table.
    not_copied: bool,
}

/// A value with what is told of it.
struct Seen {
    tree: Tree,
    /// In which row of the table each branch begins, and how many rows there are.
    rows: Rows,
    statistics: Option<Statistics>,
}

/// Blocks of rows, one per branch.
#[derive(Default)]
struct Rows {
    starts: Vec<usize>,
    count: usize,
}

impl Rows {
    /// O(branches).
    fn new(heights: impl Iterator<Item = usize>) -> Self {
        let mut rows = Self::default();
        for height in heights {
            rows.starts.push(rows.count);
            rows.count += height;
        }
        rows
    }

    /// The branch of a row, and the how many-th of its rows that is. O(log branches).
    fn find(&self, row: usize) -> Option<(usize, usize)> {
        let b = self.starts.partition_point(|s| *s <= row).checked_sub(1)?;
        Some((b, row - self.starts[b]))
    }
}

/// Which branches are open, and the rows that this makes: one for each branch, below it those of its items.
#[derive(Default)]
struct Folds {
    open: Vec<bool>,
    rows: Rows,
}

impl Folds {
    fn new(tree: &Tree, open: Vec<bool>) -> Self {
        let items = tree.branches().iter().map(|(_, column)| column.len());
        Self { rows: Rows::new(open.iter().zip(items).map(|(open, items)| 1 + if *open { items } else { 0 })), open }
    }
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

/// A text as a field of a CSV file. One that is empty is none that is not there.
fn field(text: &str) -> String {
    let plain = !text.is_empty() && !text.contains([',', '"', '\n', '\r']);
    if plain { text.to_owned() } else { format!("\"{}\"", text.replace('"', "\"\"")) }
}

/// A number as it is; one that JSON lacks stands there as a text.
fn figure(json: &Json) -> String {
    json.as_str().map_or_else(|| json.to_string(), str::to_owned)
}

/// The whole item as a field, a text as it is and everything else as its JSON; of a gap nothing.
fn cell(column: &Column, i: usize) -> String {
    match column.get::<Text>(i) {
        Some(text) => field(&text.0),
        None if column.is_valid(i) => field(&figure(&column.item_json(i))),
        None => String::new(),
    }
}

/// The coordinates of an item as three fields.
fn coordinates(column: &Column, i: usize) -> String {
    let json = column.item_json(i);
    [0, 1, 2].map(|k| json.get(k).map(figure).unwrap_or_default()).join(",")
}

/// Path, index and item of all items, as a table with a head; points have a column for each coordinate. O(items).
#[must_use]
pub fn csv(tree: &Tree) -> String {
    let is_point = |column: &Column| matches!(column.type_name(), "point" | "vector");
    let points = !tree.branches().is_empty() && tree.branches().iter().all(|(_, column)| is_point(column));
    let cell = if points { coordinates } else { cell };
    let mut text = format!("path,index,{}\n", if points { "x,y,z" } else { tree.type_name() });
    for (path, column) in tree.branches() {
        let path = field(&path.to_string());
        for i in 0..column.len() {
            let _ = writeln!(text, "{path},{i},{}", cell(column, i));
        }
    }
    text
}

impl Seen {
    /// O(items).
    fn new(tree: Tree) -> Self {
        let rows = Rows::new(tree.branches().iter().map(|(_, column)| column.len()));
        Self { rows, statistics: statistics(&tree), tree }
    }
}

impl DataView {
    /// Whether nothing is being made.
    #[must_use]
    pub fn settled(&self) -> bool {
        self.seen.settled() && self.copying.is_none()
    }

    /// Shows the values at the selected node's ports.
    pub fn show(&mut self, ui: &mut Ui, model: &Model) {
        self.copy(ui.ctx());
        let chosen = model.selection.iter().next().filter(|_| model.selection.len() == 1);
        let node = chosen.and_then(|id| Some((id, model.document().nodes().get(id)?)));
        let Some((id, node)) = node else {
            ui.weak("Select one node to see what it gives and takes.");
            self.look_away();
            return;
        };
        let info = model.catalog.of(node);
        let of = |ports: &[PortInfo], input: bool| -> Vec<(String, bool)> {
            ports.iter().map(|p| (format!("{id}.{}", p.name), input)).collect()
        };
        let ports = [of(&info.outputs, false), of(&info.inputs, true)].concat();
        if !self.port.as_ref().is_some_and(|p| ports.contains(p)) {
            self.port = ports.first().cloned();
        }
        let Some(port) = self.port.clone() else { return };
        if self.seen_at.as_ref() != Some(&port) {
            self.seen.forget();
            self.seen_at = Some(port.clone());
        }
        let there = match port.1 {
            true => port.0.split_once('.').and_then(|(_, name)| model.arriving(id, name)),
            false => model.value(&port.0).cloned().map(Arriving::Value),
        };
        if there.is_none() {
            self.look_away();
        }
        let seen = there.clone().and_then(|there| self.seen_of(ui, model, there));
        let words =
            |(address, input): &(String, bool)| if *input { format!("into {address}") } else { address.clone() };
        ui.horizontal_wrapped(|ui| {
            let shown = ComboBox::from_id_salt("data-port").selected_text(words(&port)).show_ui(ui, |ui| {
                for p in &ports {
                    if ui.selectable_label(*p == port, words(p)).clicked() {
                        self.port = Some(p.clone());
                    }
                }
            });
            let label = || WidgetInfo::labeled(WidgetType::ComboBox, true, "port that is shown");
            shown.response.widget_info(label);
            if let Some(Ok(Some(seen))) = seen.as_deref() {
                self.head(ui, seen);
            }
        });
        // Each view of each port has a scroll bar of its own.
        ui.push_id((&port, self.as_tree), |ui| match (there, seen.as_deref()) {
            (None, _) | (_, Some(Ok(None))) => drop(ui.weak("There is no value yet.")),
            (_, None) if self.seen.failed() => drop(ui.weak("The value could not be read.")),
            (_, None) => drop(ui.weak("The value is being read …")),
            (_, Some(Err(why))) => drop(ui.weak(why)),
            (_, Some(Ok(Some(seen)))) if self.as_tree => self.branches(ui, &seen.tree),
            (_, Some(Ok(Some(seen)))) => table(ui, seen),
        });
    }

    /// What is shown of a value; none while the first is being made.
    fn seen_of(&mut self, ui: &Ui, model: &Model, there: Arriving) -> Option<Arc<Made>> {
        let (ctx, key) = (ui.ctx().clone(), there.key());
        let maker = || {
            let make = model.make(there);
            move || make().map(|tree| tree.map(Seen::new))
        };
        self.seen.want_by(key, move || ctx.request_repaint(), maker);
        self.seen.last().filter(|_| !self.seen.failed()).cloned()
    }

    /// Gives the clipboard the table that was asked for, once it is made.
    fn copy(&mut self, ctx: &Context) {
        let Some(tree) = self.copying.clone() else { return };
        let wake = ctx.clone();
        self.csv.want(tree.digest(), move || wake.request_repaint(), move || csv(&tree));
        self.not_copied = self.csv.failed();
        if let Some(text) = self.csv.now() {
            ctx.copy_text(text.to_string());
        } else if !self.not_copied {
            return;
        }
        self.csv.forget();
        self.copying = None;
    }

    /// Gives up all that is being made, because nobody looks.
    pub fn close(&mut self) {
        self.look_away();
        self.csv.forget();
        self.copying = None;
    }

    fn look_away(&mut self) {
        self.seen.forget();
        self.seen_at = None;
    }

    /// How the value is shown, and what is told of all of it.
    fn head(&mut self, ui: &mut Ui, seen: &Seen) {
        let tree = &seen.tree;
        ui.selectable_value(&mut self.as_tree, false, "Table");
        ui.selectable_value(&mut self.as_tree, true, "Tree");
        if ui.add_enabled(self.copying.is_none(), Button::new("Copy as CSV")).clicked() {
            self.copying = Some(tree.clone());
            self.not_copied = false;
            ui.ctx().request_repaint();
        }
        if self.not_copied {
            ui.weak("nothing was copied: the table could not be made");
        }
        let count = |n: usize, one: &str, many: &str| format!("{n} {}", if n == 1 { one } else { many });
        let branches = count(tree.branches().len(), "branch", "branches");
        let items = count(seen.rows.count, "item", "items");
        ui.label(format!("{branches}, {items} of {}", tree.type_name()));
        if let Some(s) = seen.statistics.filter(|s| s.count > 1) {
            ui.label(format!("{} numbers from {} to {}, mean {:.4}", s.count, s.min, s.max, s.mean));
        }
    }

    /// Branches by their paths, each with its items below it if it is open. O(rows seen), and O(branches) where one opens.
    fn branches(&mut self, ui: &mut Ui, tree: &Tree) {
        let all = |open| Folds::new(tree, vec![open; tree.branches().len()]);
        if self.folds.as_ref().is_none_or(|(of, _)| *of != tree.digest()) {
            self.folds = Some((tree.digest(), all(false)));
        }
        let Some((_, folds)) = &mut self.folds else { return };
        ui.horizontal(|ui| {
            if ui.small_button("open all").clicked() {
                *folds = all(true);
            }
            if ui.small_button("close all").clicked() {
                *folds = all(false);
            }
        });
        let height = ui.spacing().interact_size.y;
        let mut toggled = None;
        ScrollArea::both().auto_shrink(false).show_rows(ui, height, folds.rows.count, |ui, rows| {
            ui.style_mut().wrap_mode = Some(eframe::egui::TextWrapMode::Extend);
            for (b, row) in rows.filter_map(|row| folds.rows.find(row)) {
                let Some((path, column)) = tree.branches().get(b) else { continue };
                let Some(i) = row.checked_sub(1) else {
                    let mark = if folds.open[b] { "−" } else { "+" };
                    let words = format!("{mark} {path}  {} × {}", column.len(), column.type_name());
                    if ui.selectable_label(false, RichText::new(words).monospace()).clicked() {
                        toggled = Some(b);
                    }
                    continue;
                };
                ui.label(RichText::new(line(&format!("    {i:>8}"), column, i)).monospace());
            }
        });
        if let Some(b) = toggled {
            let mut open = std::mem::take(&mut folds.open);
            open[b] = !open[b];
            *folds = Folds::new(tree, open);
        }
    }
}

fn table(ui: &mut Ui, seen: &Seen) {
    let height = ui.text_style_height(&TextStyle::Monospace);
    ScrollArea::both().auto_shrink(false).show_rows(ui, height, seen.rows.count, |ui, rows| {
        ui.style_mut().wrap_mode = Some(eframe::egui::TextWrapMode::Extend);
        for (b, i) in rows.filter_map(|row| seen.rows.find(row)) {
            let Some((path, column)) = seen.tree.branches().get(b) else { continue };
            let path = path.to_string();
            ui.label(RichText::new(line(&format!("{path:<10} {i:>8}"), column, i)).monospace());
        }
    });
}

/// An item behind what says which it is.
fn line(which: &str, column: &Column, i: usize) -> String {
    format!("{which}  {}", words(column, i, LETTERS))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tenon_engine::Path;

    #[test]
    fn tables_have_a_row_per_item_and_gaps_stay() {
        let a = (Path::root().child(1), Column::new(vec![1.0, 4.0]));
        let b = (Path::root(), Column::with_gaps(vec![None, Some(-2.0)]));
        let tree = Tree::from_branches(vec![a, b]);
        assert_eq!(csv(&tree), "path,index,number\n{0},0,\n{0},1,-2.0\n{0;1},0,1.0\n{0;1},1,4.0\n");
        let s = statistics(&tree).unwrap();
        assert_eq!((s.count, s.min, s.max, s.mean), (3, -2.0, 4.0, 1.0));
        let seen = Seen::new(tree);
        assert_eq!((0..4).filter_map(|row| seen.rows.find(row)).collect::<Vec<_>>(), [(0, 0), (0, 1), (1, 0), (1, 1)]);
        assert_eq!(field("a \"b\", c"), "\"a \"\"b\"\", c\"");
    }

    #[test]
    fn tables_hold_whole_values() {
        let long = format!("{}, \"so\"\n", "a".repeat(200));
        let texts = vec![Text::from("oak"), Text::from(""), Text::from(long.as_str())];
        let quoted = long.replace('"', "\"\"");
        assert_eq!(
            csv(&Tree::list(texts)),
            format!("path,index,text\n{{0}},0,oak\n{{0}},1,\"\"\n{{0}},2,\"{quoted}\"\n")
        );
        let figures = [0.1 + 0.2, f64::MAX, f64::NAN];
        let table = csv(&Tree::list(figures.to_vec()));
        let read: Vec<f64> = table.lines().skip(1).map(|l| l.split(',').nth(2).unwrap().parse().unwrap()).collect();
        assert_eq!(read[..2], figures[..2]);
        assert!(read[2].is_nan());
        let point = tenon_nodes::value::Point(tenon_geometry::DVec3::new(0.1 + 0.2, -1.0, 1e-7));
        let points = Tree::column(Column::with_gaps(vec![Some(point), None]));
        assert_eq!(csv(&points), "path,index,x,y,z\n{0},0,0.30000000000000004,-1.0,1e-7\n{0},1,,,\n");
        let file = tenon_engine::File { name: "a.nc".into(), bytes: vec![0; 3].into(), withheld: None };
        assert!(csv(&Tree::item(file)).contains("\"\"withheld\"\":null"), "the whole JSON");
    }

    #[test]
    fn a_table_that_cannot_be_made_leaves_the_button() {
        /// What cannot be written.
        #[derive(Clone, Default)]
        struct Nothing;
        impl tenon_engine::Item for Nothing {
            const TYPE: &'static str = "nothing of the kind";
            fn digest(&self, _: &mut tenon_engine::Digester) {}
            fn to_json(&self) -> Json {
                panic!("on purpose")
            }
        }
        let mut view = DataView { copying: Some(Tree::item(Nothing)), ..DataView::default() };
        let start = std::time::Instant::now();
        while !view.settled() {
            assert!(start.elapsed().as_secs() < 20, "it is never given up");
            view.copy(&Context::default());
        }
        assert!(view.not_copied && view.copying.is_none());
    }

    #[test]
    fn an_open_branch_has_its_items_below_it_and_an_empty_one_has_none() {
        let branches = [2_usize, 0, 1].into_iter().enumerate();
        let tree =
            Tree::from_branches(branches.map(|(b, n)| (Path::root().child(b), Column::new(vec![0.5; n]))).collect());
        let rows = |open: [bool; 3]| {
            let folds = Folds::new(&tree, open.to_vec());
            (0..folds.rows.count).filter_map(|row| folds.rows.find(row)).collect::<Vec<_>>()
        };
        assert_eq!(rows([false; 3]), [(0, 0), (1, 0), (2, 0)]);
        assert_eq!(rows([true, true, false]), [(0, 0), (0, 1), (0, 2), (1, 0), (2, 0)]);
    }
}
