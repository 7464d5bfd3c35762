//! Below the canvas: all that is wrong, where the time goes, and values as tables. A click goes to the node.

use super::data::DataView;
use super::pieces::Pieces;
use crate::model::Model;
use crate::model::critical::critical_path;
use crate::model::play::Play;
use crate::theme::{self, Theme};
use crate::viewport::Picked;
use eframe::egui::{Align2, FontId, Rect, RichText, ScrollArea, Sense, TextWrapMode, Ui, WidgetInfo, WidgetType, vec2};
use std::time::Duration;
use tenon_engine::Severity;

/// What stands below the canvas.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tab {
    /// All that is wrong.
    Problems,
    /// Where the time goes.
    Profile,
    /// What the selected node gives.
    Data,
    /// All parts.
    Pieces,
}

impl Tab {
    /// Its name for people.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Problems => "Problems",
            Self::Profile => "Profile",
            Self::Data => "Data",
            Self::Pieces => "Pieces",
        }
    }
}

/// What was clicked.
#[derive(Clone, Debug, PartialEq)]
pub enum Went {
    /// A node, by its path.
    Node(String),
    /// A panel.
    Panel(Picked),
    /// Where the files of the graph are written.
    Export,
}

/// The panel below the canvas.
#[derive(Default)]
pub struct Lower {
    /// What it shows; none: it is closed.
    pub tab: Option<Tab>,
    data: DataView,
    pieces: Pieces,
}

impl Lower {
    /// Opens at a tab, or closes if it shows that.
    pub fn toggle(&mut self, tab: Tab) {
        self.tab = if self.tab == Some(tab) { None } else { Some(tab) };
    }

    /// What is made only for who looks at it is given up, if nobody does.
    pub fn rest(&mut self) {
        if self.tab != Some(Tab::Data) {
            self.data.close();
        }
    }

    /// Whether nothing is being made to be shown.
    #[must_use]
    pub fn settled(&self) -> bool {
        self.data.settled()
    }

    /// Shows it; gives what was clicked.
    pub fn show(&mut self, ui: &mut Ui, model: &Model, plays: &[Play]) -> Option<Went> {
        ui.horizontal(|ui| {
            for tab in [Tab::Problems, Tab::Profile, Tab::Data, Tab::Pieces] {
                if ui.selectable_label(self.tab == Some(tab), tab.name()).clicked() {
                    self.tab = Some(tab);
                }
            }
            if ui.small_button("×").on_hover_text("close").clicked() {
                self.tab = None;
            }
        });
        ui.separator();
        // Its height is the person's, however little there is to show.
        ui.set_min_height(ui.available_height());
        match self.tab? {
            Tab::Problems => problems(ui, model).map(Went::Node),
            Tab::Profile => profile(ui, model).map(Went::Node),
            Tab::Data => {
                self.data.show(ui, model);
                None
            }
            Tab::Pieces => self.pieces.show(ui, model, plays),
        }
    }
}

fn problems(ui: &mut Ui, model: &Model) -> Option<String> {
    let all = &model.results.diagnostics;
    if all.is_empty() {
        ui.weak("Nothing is wrong.");
        return None;
    }
    let (theme, mut go) = (Theme::of(ui), None);
    let height = ui.text_style_height(&eframe::egui::TextStyle::Body) + 4.0;
    ScrollArea::vertical().auto_shrink(false).show_rows(ui, height, all.len(), |ui, rows| {
        // One line each, however long; all of it under the pointer.
        ui.style_mut().wrap_mode = Some(TextWrapMode::Truncate);
        for d in all.get(rows).unwrap_or(&[]) {
            let colour = match d.severity {
                Severity::Error => theme.error,
                Severity::Warning => theme.warning,
                Severity::Note => theme.faint_text,
            };
            let words = d.to_string();
            let row = ui.selectable_label(false, RichText::new(&words).color(colour)).on_hover_text(words);
            if row.clicked() {
                go = d.node.as_deref().map(str::to_owned);
            }
        }
    });
    go
}

fn profile(ui: &mut Ui, model: &Model) -> Option<String> {
    let mut all: Vec<_> = model
        .results
        .nodes
        .iter()
        .filter(|(path, _)| model.local(path).is_some_and(|id| model.path_of(id) == path.as_str()))
        .collect();
    all.sort_by(|a, b| b.1.time.cmp(&a.1.time).then_with(|| a.0.cmp(b.0)));
    let most = all.first().map_or(0.0, |(_, r)| r.time.as_secs_f64()).max(1e-9);
    let (theme, mut go) = (Theme::of(ui), None);
    let time = |id: &str| model.results.nodes.get(&*model.path_of(id)).map_or(Duration::ZERO, |r| r.time);
    let (critical, longest) = critical_path(model.document(), time);
    let bytes: usize = all.iter().map(|(_, r)| r.bytes).sum();
    let total: Duration = all.iter().map(|(_, r)| r.time).sum();
    ui.label(format!(
        "{} of work; the longest chain takes {} ({} nodes, ■); results take {}",
        theme::duration(total),
        theme::duration(longest),
        critical.len(),
        crate::canvas::bytes(bytes)
    ));
    let font = FontId::proportional(13.0);
    ScrollArea::vertical().auto_shrink(false).show_rows(ui, 18.0, all.len(), |ui, rows| {
        for (id, r) in all.get(rows).unwrap_or(&[]) {
            let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 18.0), Sense::click());
            let (time, bytes) = (theme::duration(r.time), crate::canvas::bytes(r.bytes));
            response.widget_info(|| WidgetInfo {
                current_text_value: Some(format!("{time}, {bytes}")),
                ..WidgetInfo::labeled(WidgetType::Button, true, format!("time of {id}"))
            });
            let bars = Rect::from_min_max(rect.min + vec2(300.0, 2.0), rect.max - vec2(4.0, 2.0));
            let mut bar = bars;
            bar.set_width(bars.width().max(0.0) * (r.time.as_secs_f64() / most) as f32);
            let painter = ui.painter();
            painter.rect_filled(bar, 2.0, theme.slider);
            let text = |x: f32, align, words: String| {
                painter.text(rect.left_center() + vec2(x, 0.0), align, words, font.clone(), theme.text);
            };
            let on = model.local(id).is_some_and(|id| critical.iter().any(|c| c == id));
            text(4.0, Align2::LEFT_CENTER, if on { "■".into() } else { String::new() });
            text(18.0, Align2::LEFT_CENTER, (*id).clone());
            text(210.0, Align2::RIGHT_CENTER, time);
            text(290.0, Align2::RIGHT_CENTER, bytes);
            if response.clicked() {
                go = Some((*id).clone());
            }
        }
    });
    go
}
