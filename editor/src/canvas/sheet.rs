//! Sheets on the canvas that show what a wire brings, line by line: only the lines that are seen are made.

use super::Canvas;
use super::paint::Paint;
use super::shape::{FOOT, HEADER, Kind, Shape};
use crate::model::Model;
use crate::model::words::words;
use crate::theme;
use eframe::egui::{Align2, FontId, Id, Pos2, Rect, Sense, Stroke, StrokeKind, Ui, WidgetInfo, WidgetType, pos2, vec2};
use tenon_engine::Tree;

/// Height of a line, canvas points.
const LINE: f32 = 16.0;

/// How many lines a value has: one per item, and one per path if there are several branches. O(branches).
fn count(tree: &Tree) -> usize {
    let heads = if tree.branches().len() > 1 { tree.branches().len() } else { 0 };
    heads + tree.branches().iter().map(|(_, column)| column.len()).sum::<usize>()
}

/// Some lines of a value, from the first to before the last. O(branches + lines).
fn lines(tree: &Tree, from: usize, to: usize) -> Vec<String> {
    let (mut all, mut at) = (Vec::new(), 0);
    let several = tree.branches().len() > 1;
    for (path, column) in tree.branches() {
        let head = usize::from(several);
        let end = at + head + column.len();
        for line in from.max(at)..to.min(end) {
            let Some(i) = (line - at).checked_sub(head) else {
                all.push(path.to_string());
                continue;
            };
            let item = words(column, i, 200);
            all.push(if end - at > 1 { format!("{i}  {item}") } else { item });
        }
        at = end;
        if at >= to {
            break;
        }
    }
    all
}

/// How many lines there is room for.
fn room(shape: &Shape) -> f32 {
    (shape.rect.height() - HEADER - FOOT) / LINE
}

/// The lines that a sheet shows, from its line `first` on.
fn seen_lines(tree: &Tree, shape: &Shape, first: f32) -> Vec<String> {
    let from = first.floor().max(0.0) as usize;
    lines(tree, from, from + room(shape).ceil() as usize + 1)
}

impl Paint<'_> {
    /// A sheet with what comes in, from its line `first` on.
    pub(super) fn sheet(&self, shape: &Shape, rect: Rect, first: f32, far: bool) {
        let selected = self.model.selection.contains(&shape.id);
        let edge = if selected { Stroke::new(2.0, self.theme.selected) } else { Stroke::new(1.0, self.theme.edge) };
        self.painter.rect(rect, 2.0, self.theme.paper, edge, StrokeKind::Outside);
        let ink = theme::ink_on(self.theme.paper);
        let head = Rect::from_min_size(rect.min, vec2(rect.width(), self.scaled(HEADER)));
        self.painter.rect_filled(head.shrink(1.0), 1.0, self.theme.edge.gamma_multiply(0.25));
        if far {
            return;
        }
        let tree = self.model.value(&format!("{}.data", shape.id));
        let inside = head.shrink2(vec2(self.scaled(10.0), 0.0));
        let clip = self.painter.with_clip_rect(inside.intersect(self.painter.clip_rect()));
        clip.text(inside.left_center(), Align2::LEFT_CENTER, &shape.id, self.font(13.0), ink);
        let words = match tree {
            Some(tree) if tree.branches().len() > 1 => {
                format!("{} in {} branches", tree.len(), tree.branches().len())
            }
            Some(tree) => format!("{} {}", tree.len(), tree.type_name()),
            None => "no value yet".to_owned(),
        };
        self.painter.text(
            inside.right_center(),
            Align2::RIGHT_CENTER,
            words,
            self.font(theme::SMALL),
            ink.gamma_multiply(0.8),
        );
        let Some(tree) = tree else { return };
        let body = Rect::from_min_max(pos2(inside.left(), head.bottom()), rect.max - vec2(self.scaled(8.0), 2.0));
        let painter = self.painter.with_clip_rect(body.intersect(self.painter.clip_rect()));
        let (all, seen) = (count(tree), room(shape));
        let font = FontId::monospace(self.font(11.0).size);
        for (k, line) in seen_lines(tree, shape, first).into_iter().enumerate() {
            let y = body.top() + self.scaled((k as f32 - first.fract()) * LINE + 3.0);
            painter.text(pos2(body.left(), y), Align2::LEFT_TOP, line, font.clone(), ink);
        }
        if all as f32 > seen {
            // Where in the whole these lines are.
            let height = body.height().max(1.0);
            let part = (height * seen / all as f32).max(self.scaled(10.0)).min(height);
            let top = body.top() + (height - part) * (first / (all as f32 - seen)).clamp(0.0, 1.0);
            let bar = Rect::from_min_size(pos2(rect.right() - self.scaled(6.0), top), vec2(self.scaled(4.0), part));
            self.painter.rect_filled(bar, 2.0, ink.gamma_multiply(0.45));
        }
    }
}

impl Canvas {
    /// The wheel over a sheet that has more lines than it shows turns its lines; false if there is no such sheet.
    pub(super) fn turn_sheet(&mut self, at: Pos2, scroll: f32, model: &Model) -> bool {
        let over = self.shapes.nodes.iter().rev().find(|s| s.kind == Kind::Sheet && s.rect.contains(at));
        let Some(shape) = over else { return false };
        let Some(tree) = model.value(&format!("{}.data", shape.id)) else { return false };
        let most = count(tree) as f32 - room(shape);
        if most <= 0.0 {
            return false;
        }
        let first = self.scrolls.entry(shape.id.clone()).or_default();
        *first = (*first - scroll / (LINE * self.view.zoom.max(0.2))).clamp(0.0, most);
        true
    }

    /// Tells screen readers and tests which lines a sheet shows.
    pub(super) fn name_lines(&self, ui: &Ui, area: Rect, model: &Model, shape: &Shape) {
        let Some(tree) = model.value(&format!("{}.data", shape.id)).filter(|_| shape.kind == Kind::Sheet) else {
            return;
        };
        let body = shape.rect.with_min_y(shape.rect.top() + HEADER);
        let rect = self.view.rect_to_screen(area, body).intersect(area);
        let response = ui.interact(rect, Id::new(("lines", &shape.id)), Sense::hover());
        response.widget_info(|| WidgetInfo {
            current_text_value: Some(seen_lines(tree, shape, self.first_line(&shape.id)).join("\n")),
            ..WidgetInfo::labeled(WidgetType::Other, true, format!("lines of {}", shape.id))
        });
    }

    /// The first line that the sheet of a node shows.
    #[must_use]
    pub fn first_line(&self, node: &str) -> f32 {
        self.scrolls.get(node).copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tenon_engine::{Column, Path};

    #[test]
    fn lines_are_items_with_paths_between_them() {
        let a = (Path::root().child(0), Column::new(vec![1.5, 2.5]));
        let b = (Path::root().child(1), Column::with_gaps(vec![None, Some(7.0)]));
        let tree = Tree::from_branches(vec![a, b]);
        assert_eq!(count(&tree), 6);
        let all = lines(&tree, 0, 99);
        assert_eq!(all.len(), 6);
        assert_eq!((all[1].as_str(), all[4].as_str()), ("0  1.5", "0  (nothing)"), "{all:?}");
        assert_eq!(lines(&tree, 2, 5), all[2..5]);
        assert_eq!(lines(&Tree::item(4.0), 0, 9).len(), 1);
        assert_eq!(lines(&Tree::item(tenon_engine::Text::from("oak")), 0, 9), ["oak"]);
        let long = Tree::list((0..1_000_000).map(f64::from).collect::<Vec<_>>());
        assert_eq!(lines(&long, 999_999, 1_000_050).len(), 1);
    }
}
