//! The piece list: every part with where it lies, how large it is and how long it takes, sorted by any column. A click picks
//! the panel.

use super::lower::Went;
use crate::boards::BoardView;
use crate::model::Model;
use crate::model::cut::missing;
use crate::model::play::Play;
use crate::viewport::Picked;
use eframe::egui::{RichText, ScrollArea, Sense, TextStyle, Ui, WidgetInfo, WidgetType, vec2};
use std::collections::HashMap;
use std::fmt::Write as _;
use tenon_geometry::joint::Machining;
use tenon_geometry::mesh::Address;

/// One part.
#[derive(Clone, Debug, PartialEq)]
struct Piece {
    part: u32,
    /// Where it is in the grid; one that has no address counts by its number alone.
    place: Address,
    address: String,
    board: Option<u32>,
    /// Front, mm².
    area: f64,
    /// mm³.
    volume: f64,
    edges: usize,
    holes: usize,
    /// Seconds, as far as programs tell.
    time: f64,
}

const COLUMNS: [&str; 7] = ["address", "board", "area m²", "volume dm³", "edges", "holes", "time"];

/// The list, kept while nothing changes.
#[derive(Default)]
pub struct Pieces {
    of: Option<(u64, usize)>,
    all: Vec<Piece>,
    /// The output whose panels the parts are.
    panels: Option<String>,
    sorted: (usize, bool),
}

fn list(boards: &BoardView) -> (Vec<Piece>, Option<String>) {
    let Some(found) = boards.found() else { return (Vec::new(), None) };
    let panels = &found.parts.panels;
    let mut holes = vec![0; panels.len()];
    for f in &found.parts.features.features {
        if let (Machining::Drill { .. }, Some(n)) = (&f.machining, holes.get_mut(f.panel as usize)) {
            *n += 1;
        }
    }
    let times: Vec<_> = boards.plays().iter().map(Play::time_of_parts).collect();
    let lies: HashMap<u32, u32> = found.layout.placements.iter().map(|p| (p.part, p.board)).collect();
    let all = (0..panels.len()).map(|i| {
        let place = panels.address.get(i).copied();
        let address = place.map_or_else(|| i.to_string(), |a| a.to_string());
        let board = lies.get(&(i as u32)).copied();
        Piece {
            part: i as u32,
            place: place.unwrap_or(Address { column: i as u32, ..Address::default() }),
            board,
            area: panels.front_area(i),
            volume: panels.volume(i),
            edges: panels.corners(i).len(),
            holes: holes[i],
            time: times.iter().filter_map(|t| t.get(address.as_str())).sum(),
            address,
        }
    });
    (all.collect(), found.panels.clone())
}

fn sort(all: &mut [Piece], (column, down): (usize, bool)) {
    all.sort_by(|a, b| {
        let order = match column {
            1 => a.board.cmp(&b.board),
            2 => a.area.total_cmp(&b.area),
            3 => a.volume.total_cmp(&b.volume),
            4 => a.edges.cmp(&b.edges),
            5 => a.holes.cmp(&b.holes),
            6 => a.time.total_cmp(&b.time),
            // By patch, row and column, as people count: 9.9 before 10.2.
            _ => a.place.cmp(&b.place),
        };
        (if down { order.reverse() } else { order }).then(a.part.cmp(&b.part))
    });
}

fn cells(p: &Piece) -> [String; 7] {
    [
        p.address.clone(),
        p.board.map_or_else(|| "none".into(), |b| (b + 1).to_string()),
        format!("{:.4}", p.area / 1e6),
        format!("{:.3}", p.volume / 1e6),
        p.edges.to_string(),
        p.holes.to_string(),
        if p.time > 0.0 { format!("{:.0} s", p.time) } else { "–".into() },
    ]
}

impl Pieces {
    /// Shows the parts of the boards that are seen; gives what was clicked.
    pub fn show(&mut self, ui: &mut Ui, model: &Model, boards: &BoardView) -> Option<Went> {
        // The programs come later than the boards that they cut.
        let of = (boards.looks(), boards.plays().as_ptr() as usize);
        if self.of != Some(of) {
            (self.all, self.panels) = list(boards);
            sort(&mut self.all, self.sorted);
            self.of = Some(of);
        }
        if self.all.is_empty() {
            ui.weak(missing(model, "pieces"));
            return None;
        }
        let mut went = None;
        ui.horizontal(|ui| {
            let area: f64 = self.all.iter().map(|p| p.area).sum();
            let time: f64 = self.all.iter().map(|p| p.time).sum();
            let words =
                format!("{} pieces, {:.2} m², {:.0} min at the machine", self.all.len(), area / 1e6, time / 60.0);
            ui.label(words);
            if ui.button("Copy as CSV").clicked() {
                ui.ctx().copy_text(self.csv());
            }
            if !model.results.files.is_empty() && ui.button("Export the files …").on_hover_text(super::EXPORT).clicked()
            {
                went = Some(Went::Export);
            }
        });
        let widths = [150.0, 60.0, 80.0, 90.0, 60.0, 60.0, 80.0];
        let height = ui.text_style_height(&TextStyle::Body) + 4.0;
        ui.horizontal(|ui| {
            for (column, words) in COLUMNS.into_iter().enumerate() {
                let arrow = match self.sorted {
                    (c, down) if c == column => {
                        if down {
                            " ⬇"
                        } else {
                            " ⬆"
                        }
                    }
                    _ => "",
                };
                let text = RichText::new(format!("{words}{arrow}")).strong();
                let head = ui.add_sized(vec2(widths[column], height), eframe::egui::Button::new(text).frame(false));
                head.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, format!("sort by {words}")));
                if head.clicked() {
                    self.sorted = (column, self.sorted == (column, false));
                    sort(&mut self.all, self.sorted);
                }
            }
        });
        ScrollArea::vertical().auto_shrink(false).show_rows(ui, height, self.all.len(), |ui, rows| {
            for p in self.all.get(rows).unwrap_or(&[]) {
                let (rect, row) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
                row.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, format!("piece {}", p.address)));
                if row.hovered() {
                    ui.painter().rect_filled(rect, 2.0, ui.visuals().widgets.hovered.weak_bg_fill);
                }
                let mut x = rect.left();
                for (cell, width) in cells(p).into_iter().zip(widths) {
                    let at = eframe::egui::pos2(x + width / 2.0, rect.center().y);
                    let font = TextStyle::Body.resolve(ui.style());
                    ui.painter().text(at, eframe::egui::Align2::CENTER_CENTER, cell, font, ui.visuals().text_color());
                    x += width + ui.spacing().item_spacing.x;
                }
                if row.clicked() {
                    went = self.panels.clone().map(|output| Went::Panel(Picked { output, part: p.part }));
                }
            }
        });
        went
    }

    fn csv(&self) -> String {
        let mut text = format!("{}\n", COLUMNS.join(","));
        for p in &self.all {
            let _ = writeln!(text, "{}", cells(p).join(","));
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_are_sorted_as_people_count() {
        let piece = |(patch, row, column), time| {
            let place = Address { patch, row, column };
            let address = place.to_string();
            Piece { part: 0, place, address, board: None, area: 1.0, volume: 1.0, edges: 4, holes: 0, time }
        };
        let places = [(1, 0, 3), (0, 10, 2), (0, 9, 9), (0, 0, 10), (0, 9, 10), (0, 0, 2)];
        let mut all: Vec<Piece> =
            places.into_iter().zip([1.0, 3.0, 2.0, 0.0, 0.0, 0.0]).map(|(p, t)| piece(p, t)).collect();
        sort(&mut all, (0, false));
        let order: Vec<_> = all.iter().map(|p| p.address.as_str()).collect();
        assert_eq!(order, ["0.2", "0.10", "9.9", "9.10", "10.2", "1-0.3"]);
        sort(&mut all, (6, true));
        assert_eq!(all[0].address, "10.2");
    }
}
