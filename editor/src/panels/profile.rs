//! Where the time goes: nodes by how long they took, with what their results take, and the chain that nothing can be done
//! sooner than. A click goes to the node.

use crate::canvas::bytes;
use crate::model::Model;
use crate::model::critical::critical_path;
use crate::theme::{self, Theme};
use eframe::egui::{Align2, FontId, Rect, ScrollArea, Sense, Ui, WidgetInfo, WidgetType, vec2};
use std::collections::HashSet;
use std::time::Duration;

/// One node.
struct Row {
    path: String,
    time: Duration,
    bytes: usize,
    /// It is on the longest chain.
    critical: bool,
}

/// The list, kept while nothing changes.
#[derive(Default)]
pub struct Profile {
    of: Option<(u64, u64, String)>,
    rows: Vec<Row>,
    /// What stands above it.
    summary: String,
}

impl Profile {
    /// O(nodes log nodes) after changes, O(rows that are seen) otherwise. Gives the path of what was clicked.
    pub fn show(&mut self, ui: &mut Ui, model: &Model) -> Option<String> {
        let of = Some((model.revision(), model.results.count, model.path_of("").into_owned()));
        if self.of != of {
            self.list(model);
            self.of = of;
        }
        ui.label(&self.summary);
        let most = self.rows.first().map_or(0.0, |r| r.time.as_secs_f64()).max(1e-9);
        let (theme, font, mut go) = (Theme::of(ui), FontId::proportional(13.0), None);
        ScrollArea::vertical().auto_shrink(false).show_rows(ui, 18.0, self.rows.len(), |ui, rows| {
            for r in self.rows.get(rows).unwrap_or(&[]) {
                let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::click());
                let (time, bytes) = (theme::duration(r.time), bytes(r.bytes));
                response.widget_info(|| WidgetInfo {
                    current_text_value: Some(format!("{time}, {bytes}")),
                    ..WidgetInfo::labeled(WidgetType::Button, true, format!("time of {}", r.path))
                });
                let bars = Rect::from_min_max(rect.min + vec2(300.0, 2.0), rect.max - vec2(4.0, 2.0));
                let mut bar = bars;
                bar.set_width(bars.width().max(0.0) * (r.time.as_secs_f64() / most) as f32);
                let painter = ui.painter();
                painter.rect_filled(bar, 2.0, theme.slider);
                let text = |x: f32, align, words: String| {
                    painter.text(rect.left_center() + vec2(x, 0.0), align, words, font.clone(), theme.text);
                };
                text(4.0, Align2::LEFT_CENTER, if r.critical { "■".into() } else { String::new() });
                text(18.0, Align2::LEFT_CENTER, r.path.clone());
                text(210.0, Align2::RIGHT_CENTER, time);
                text(290.0, Align2::RIGHT_CENTER, bytes);
                if response.clicked() {
                    go = Some(r.path.clone());
                }
            }
        });
        go
    }

    fn list(&mut self, model: &Model) {
        let time = |id: &str| model.results.nodes.get(&*model.path_of(id)).map_or(Duration::ZERO, |r| r.time);
        let (chain, longest) = critical_path(model.document(), time);
        let chain: HashSet<&str> = chain.iter().map(String::as_str).collect();
        let row = |(path, r): (&String, &crate::model::results::NodeResult)| {
            let id = model.local(path).filter(|id| model.path_of(id) == path.as_str())?;
            Some(Row { path: path.clone(), time: r.time, bytes: r.bytes, critical: chain.contains(id) })
        };
        self.rows = model.results.nodes.iter().filter_map(row).collect();
        self.rows.sort_by(|a, b| b.time.cmp(&a.time).then_with(|| a.path.cmp(&b.path)));
        self.summary = format!(
            "{} of work; the longest chain takes {} ({} nodes, ■); results take {}",
            theme::duration(self.rows.iter().map(|r| r.time).sum()),
            theme::duration(longest),
            chain.len(),
            bytes(self.rows.iter().map(|r| r.bytes).sum())
        );
    }
}
