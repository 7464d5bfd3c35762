//! Drawing boards from above: outlines, what tools clear, holes, addresses; and the tool on its way.

use crate::model::cut::{Boards, Kind, Now, Play};
use crate::theme::Theme;
use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, pos2};
use tenon_geometry::DVec2;
use tenon_geometry::board::Placement;
use tenon_geometry::joint::{Feature, Machining};

/// Room between boards, mm.
const GAP: f64 = 150.0;

/// A board in the drawing, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Lower left corner.
    pub min: DVec2,
    /// Upper right corner.
    pub max: DVec2,
}

/// What is drawn.
pub struct Draw<'a> {
    found: &'a Boards,
    /// Features by part.
    features: Vec<Vec<&'a Feature>>,
}

impl<'a> Draw<'a> {
    /// Prepares it. O(features).
    pub fn new(found: &'a Boards) -> Self {
        let mut features = vec![Vec::new(); found.parts.frame.len()];
        for f in &found.parts.features.features {
            if let Some(own) = features.get_mut(f.panel as usize) {
                own.push(f);
            }
        }
        Self { found, features }
    }

    /// Where a board lies in the drawing: side by side.
    pub fn board(&self, board: u32) -> Place {
        let size = self.found.layout.board.size;
        let min = DVec2::new(f64::from(board) * (size.x + GAP), 0.0);
        Place { min, max: min + size }
    }

    /// All boards, with y down as the screen has it.
    pub fn bounds(&self) -> Rect {
        let last = self.board(self.found.layout.boards.max(1) - 1);
        Rect::from_min_max(pos2(0.0, -last.max.y as f32), pos2(last.max.x as f32, 0.0))
    }

    fn outline(&self, p: &Placement, outline: &[DVec2]) -> Vec<DVec2> {
        let offset = self.board(p.board).min;
        outline.iter().map(|c| p.point(c.extend(0.0)).truncate() + offset).collect()
    }

    fn pieces(&self) -> impl Iterator<Item = (&Placement, &[DVec2])> {
        let all = &self.found.layout;
        all.placements.iter().filter_map(|p| Some((p, all.piece.get(p.part as usize)?.as_slice())))
    }

    /// The part that a place of the drawing lies in.
    pub fn part_at(&self, at: DVec2) -> Option<u32> {
        let inside = |p: &Placement, piece: &[DVec2]| {
            let outline = self.outline(p, piece);
            let sides = outline.iter().zip(outline.iter().cycle().skip(1));
            let crossed = sides
                .filter(|(a, b)| (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x));
            crossed.count() % 2 == 1
        };
        self.pieces().find(|(p, piece)| inside(p, piece)).map(|(p, _)| p.part)
    }

    /// The board that a place of the drawing lies in.
    pub fn board_at(&self, at: DVec2) -> Option<u32> {
        (0..self.found.layout.boards).find(|b| {
            let place = self.board(*b);
            at.cmpge(place.min).all() && at.cmple(place.max).all()
        })
    }

    /// Paints boards and parts; `picked` in another colour.
    pub fn paint(
        &self,
        painter: &Painter,
        theme: &Theme,
        zoom: f32,
        picked: Option<u32>,
        to_screen: &dyn Fn(DVec2) -> Pos2,
    ) {
        let wood = Color32::from_rgb(206, 172, 124);
        painter.rect_filled(painter.clip_rect(), 0.0, theme.space);
        for b in 0..self.found.layout.boards {
            let place = self.board(b);
            let rect = Rect::from_two_pos(to_screen(place.min), to_screen(place.max));
            painter.rect(rect, 0.0, wood, Stroke::new(1.0, theme.edge), StrokeKind::Outside);
            let name = format!("board {}", b + 1);
            painter.text(rect.left_top(), Align2::LEFT_BOTTOM, name, FontId::proportional(13.0), theme.text);
        }
        let seen = painter.clip_rect();
        for (p, piece) in self.pieces() {
            let corners: Vec<Pos2> = self.outline(p, piece).into_iter().map(to_screen).collect();
            let bounds = Rect::from_points(&corners);
            if !bounds.intersects(seen) {
                continue;
            }
            if let Some(cleared) = self.found.layout.cleared.get(p.part as usize).filter(|_| zoom > 0.08) {
                let cleared = self.outline(p, cleared).into_iter().map(to_screen).collect();
                painter.add(Shape::closed_line(cleared, Stroke::new(1.0, Color32::from_rgb(150, 116, 72))));
            }
            let fill =
                if picked == Some(p.part) { Color32::from_rgb(255, 160, 60) } else { Color32::from_rgb(236, 212, 172) };
            painter.add(Shape::convex_polygon(corners, fill, Stroke::new(1.0, Color32::from_rgb(86, 62, 34))));
            if zoom > 0.12 {
                self.features(painter, p, zoom, to_screen);
            }
            let size = (bounds.height().min(bounds.width()) * 0.3).min(15.0);
            if size > 5.0 {
                let address = self.found.parts.panels.address.get(p.part as usize);
                let address = address.map_or_else(|| p.part.to_string(), ToString::to_string);
                let ink = Color32::from_rgb(50, 36, 20);
                painter.text(bounds.center(), Align2::CENTER_CENTER, address, FontId::proportional(size.round()), ink);
            }
        }
    }

    fn features(&self, painter: &Painter, p: &Placement, zoom: f32, to_screen: &dyn Fn(DVec2) -> Pos2) {
        let offset = self.board(p.board).min;
        for f in self.features.get(p.part as usize).into_iter().flatten() {
            if let Machining::Drill { entry, diameter, .. } = &f.machining {
                let at = to_screen(p.point(*entry).truncate() + offset);
                let radius = (*diameter as f32 * 0.5 * zoom).max(1.0);
                painter.circle_filled(at, radius, Color32::from_rgb(70, 50, 30));
            }
        }
    }
}

/// Colour of what a step does.
pub fn kind_colour(kind: Kind) -> Color32 {
    match kind {
        Kind::Rapid => Color32::from_rgb(70, 140, 230),
        Kind::Plunge => Color32::from_rgb(230, 70, 60),
        Kind::Cut => Color32::from_rgb(40, 160, 70),
        Kind::Retract => Color32::from_rgb(170, 90, 200),
    }
}

/// Marks a place where a proof has found something wrong.
pub fn paint_fault(painter: &Painter, theme: &Theme, at: Pos2) {
    let stroke = Stroke::new(2.5, theme.error);
    for d in [eframe::egui::vec2(6.0, 6.0), eframe::egui::vec2(6.0, -6.0)] {
        painter.line_segment([at - d, at + d], stroke);
    }
    painter.circle_stroke(at, 10.0, stroke);
}

/// Paints what the tool has done until now and the tool itself; `to_screen` takes board coordinates.
pub fn paint_play(
    painter: &Painter,
    theme: &Theme,
    zoom: f32,
    play: &Play,
    now: Now,
    to_screen: &dyn Fn(DVec2) -> Pos2,
) {
    let mut run: Vec<Pos2> = Vec::new();
    let mut run_kind: Option<(Kind, Option<usize>)> = None;
    let flush = |run: &mut Vec<Pos2>, kind: Option<(Kind, Option<usize>)>| {
        let Some((kind, tool)) = kind.filter(|_| run.len() > 1) else { return run.clear() };
        let cuts = kind == Kind::Cut || kind == Kind::Plunge;
        let diameter = tool.and_then(|t| play.machine.machine.tools.get(t)).map_or(0.0, |t| t.diameter);
        let groove = diameter as f32 * zoom;
        if cuts && groove > 2.0 {
            // What is left of the material there: nothing, down to the layer below.
            let stroke = Stroke::new(groove, Color32::from_rgb(108, 86, 58));
            painter.add(Shape::line(run.clone(), stroke));
        }
        painter.add(Shape::line(
            std::mem::take(run),
            if cuts {
                Stroke::new(1.4, kind_colour(kind))
            } else {
                Stroke::new(0.8, kind_colour(kind).gamma_multiply(0.35))
            },
        ));
    };
    let mut last: Option<Pos2> = None;
    for step in &play.steps[..now.step.min(play.steps.len())] {
        let at = to_screen(step.tip.truncate());
        let kind = (step.kind, step.tool);
        if run_kind != Some(kind) {
            flush(&mut run, run_kind);
            run.extend(last);
            run_kind = Some(kind);
        }
        run.push(at);
        last = Some(at);
    }
    let tip = to_screen(now.tip.truncate());
    if let Some(step) = play.steps.get(now.step) {
        if run_kind != Some((step.kind, step.tool)) {
            flush(&mut run, run_kind);
            run.extend(last);
            run_kind = Some((step.kind, step.tool));
        }
        run.push(tip);
        flush(&mut run, run_kind);
        let tool = play.tool(step);
        let holder = tool.and_then(|t| t.holder.iter().map(|h| h.radius_from.max(h.radius_to)).reduce(f64::max));
        let length = tool.map_or(80.0, |t| t.length);
        let nose = to_screen((now.tip + now.axis * length).truncate());
        if let Some(radius) = holder {
            painter.circle_stroke(nose, (radius as f32 * zoom).max(3.0), Stroke::new(1.5, theme.text));
        }
        painter.line_segment([tip, nose], Stroke::new(2.0, theme.text));
        let radius = tool.map_or(3.0, |t| t.diameter * 0.5);
        let fill = kind_colour(step.kind);
        painter.circle(tip, (radius as f32 * zoom).max(3.0), fill, Stroke::new(1.5, Color32::WHITE));
    }
}
