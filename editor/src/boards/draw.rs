//! Drawing boards from above: grain, outlines, what tools clear, holes and other features, addresses; and the tool on its way.

use crate::model::cut::Boards;
use crate::model::play::{Kind, Now, Play};
use crate::theme::Theme;
use eframe::egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, pos2, vec2};
use tenon_geometry::board::Placement;
use tenon_geometry::joint::{Feature, Machining};
use tenon_geometry::{DVec2, DVec3};

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
}

const WOOD: Color32 = Color32::from_rgb(206, 172, 124);
const INK: Color32 = Color32::from_rgb(50, 36, 20);
const HOLE: Color32 = Color32::from_rgb(70, 50, 30);
/// What a tool makes below the surface, or the hand later.
const HIDDEN: Color32 = Color32::from_rgb(140, 100, 60);

impl<'a> Draw<'a> {
    /// Prepares it.
    pub fn new(found: &'a Boards) -> Self {
        Self { found }
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

    /// Paints the boards with their grain.
    pub fn boards(&self, painter: &Painter, theme: &Theme, to_screen: &dyn Fn(DVec2) -> Pos2) {
        painter.rect_filled(painter.clip_rect(), 0.0, theme.space);
        for b in 0..self.found.layout.boards {
            let place = self.board(b);
            let rect = Rect::from_two_pos(to_screen(place.min), to_screen(place.max));
            painter.rect(rect, 0.0, WOOD, Stroke::new(1.0, theme.edge), StrokeKind::Outside);
            // What has no room beside the name is left out.
            let room = rect.width();
            if let Some(grain) = self.found.grain {
                grain_lines(&painter.with_clip_rect(rect.intersect(painter.clip_rect())), rect, grain);
                // A double arrow beside the name, since grain has no sense.
                let along = vec2(grain.x as f32, -grain.y as f32) * 14.0;
                let middle = rect.right_top() + vec2(-22.0, -10.0);
                let stroke = Stroke::new(1.5, theme.text);
                for sign in [1.0, -1.0].into_iter().filter(|_| room > 120.0) {
                    let tip = middle + along * sign;
                    painter.line_segment([middle, tip], stroke);
                    for side in [0.5, -0.5] {
                        painter.line_segment([tip, tip - (along + along.rot90() * side * 2.0) * sign * 0.3], stroke);
                    }
                }
                if room > 290.0 {
                    let at = rect.right_top() + vec2(-42.0, -3.0);
                    painter.text(at, Align2::RIGHT_BOTTOM, "grain", FontId::proportional(12.0), theme.faint_text);
                }
            }
            let size = self.found.layout.board.size;
            let name = match room > 240.0 {
                true => format!("board {}, {:.0} × {:.0} mm", b + 1, size.x, size.y),
                false => format!("board {}", b + 1),
            };
            painter.text(rect.left_top(), Align2::LEFT_BOTTOM, name, FontId::proportional(13.0), theme.text);
        }
    }

    /// Paints the parts with what is to be made in them; `picked` in another colour.
    pub fn parts(&self, painter: &Painter, zoom: f32, picked: Option<u32>, to_screen: &dyn Fn(DVec2) -> Pos2) {
        let seen = painter.clip_rect();
        for (p, piece) in self.pieces() {
            let corners: Vec<Pos2> = self.outline(p, piece).into_iter().map(to_screen).collect();
            if !Rect::from_points(&corners).intersects(seen) {
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
        }
    }

    /// Writes the addresses on the parts, over whatever was cut.
    pub fn addresses(&self, painter: &Painter, to_screen: &dyn Fn(DVec2) -> Pos2) {
        let seen = painter.clip_rect();
        for (p, piece) in self.pieces() {
            let corners: Vec<Pos2> = self.outline(p, piece).into_iter().map(to_screen).collect();
            let bounds = Rect::from_points(&corners);
            let size = (bounds.height().min(bounds.width()) * 0.3).min(15.0);
            if size > 5.0 && bounds.intersects(seen) {
                let address = self.found.parts.panels.address.get(p.part as usize);
                let address = address.map_or_else(|| p.part.to_string(), ToString::to_string);
                painter.text(bounds.center(), Align2::CENTER_CENTER, address, FontId::proportional(size.round()), INK);
            }
        }
    }

    /// What is made in a part: by the machine in full lines, by hand in fainter ones.
    fn features(&self, painter: &Painter, p: &Placement, zoom: f32, to_screen: &dyn Fn(DVec2) -> Pos2) {
        let all = &self.found.parts.features;
        for (features, ink) in [(&all.features, HOLE), (&all.by_hand, HIDDEN)] {
            // They stand in the order of parts.
            let first = features.partition_point(|f| f.panel < p.part);
            for f in features[first..].iter().take_while(|f| f.panel == p.part) {
                self.feature(painter, p, f, ink, zoom, to_screen);
            }
        }
    }

    fn feature(
        &self,
        painter: &Painter,
        p: &Placement,
        feature: &Feature,
        ink: Color32,
        zoom: f32,
        to_screen: &dyn Fn(DVec2) -> Pos2,
    ) {
        let offset = self.board(p.board).min;
        let place = |at: DVec3| to_screen(p.point(at).truncate() + offset);
        let line = Stroke::new(1.0, ink);
        match &feature.machining {
            Machining::Drill { entry, axis, depth, diameter } => {
                let radius = (*diameter as f32 * 0.5 * zoom).max(1.0);
                let (from, to) = (place(*entry), place(*entry + *axis * *depth));
                // A hole that leans, as of toe screws and dowels, is seen along its way too.
                if from.distance(to) > radius {
                    painter.line_segment([from, to], Stroke::new(2.0 * radius, HIDDEN.gamma_multiply(0.45)));
                    painter.line_segment([from, to], Stroke::new(1.0, HIDDEN));
                }
                painter.circle_filled(from, radius, ink);
            }
            Machining::Slot { from, to, width, .. } => {
                let width = (*width as f32 * zoom).max(1.0);
                painter.line_segment([place(*from), place(*to)], Stroke::new(width, ink.gamma_multiply(0.6)));
            }
            Machining::Pocket { outline, .. } => {
                painter.add(Shape::closed_line(outline.iter().map(|c| place(*c)).collect(), line));
            }
            Machining::Contour { line: along, .. } => {
                painter.add(Shape::line(along.iter().map(|c| place(*c)).collect(), line));
            }
            // The address stands there already.
            Machining::Engraving { .. } => {}
        }
    }
}

/// Fine lines along the grain, uneven as wood is.
fn grain_lines(painter: &Painter, rect: Rect, grain: DVec2) {
    let stroke = Stroke::new(1.0, Color32::from_rgb(192, 156, 108));
    let along_x = grain.x.abs() > grain.y.abs();
    let across = if along_x { rect.height() } else { rect.width() };
    let count = (across / 7.0).clamp(3.0, 400.0) as u32;
    for i in 0..count {
        let uneven = f64::from(i.wrapping_mul(2_654_435_761) >> 24) / 256.0;
        let at = (f64::from(i) + 0.2 + 0.6 * uneven) as f32 / count as f32 * across;
        let [a, b] = match along_x {
            true => [rect.left_top() + vec2(0.0, at), rect.right_top() + vec2(0.0, at)],
            false => [rect.left_top() + vec2(at, 0.0), rect.left_bottom() + vec2(at, 0.0)],
        };
        painter.line_segment([a, b], stroke);
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

/// Steps whose way is drawn behind the tool.
const TRAIL: usize = 300;

/// Paints the way of the tool's last steps and the tool from above: its cutter, and the outline of its holder at the other
/// end; `struck`: the proof has found something wrong just here. `to_screen` takes board coordinates.
pub fn paint_tool(
    painter: &Painter,
    theme: &Theme,
    zoom: f32,
    play: &Play,
    now: Now,
    struck: bool,
    to_screen: &dyn Fn(DVec2) -> Pos2,
) {
    let Some(step) = play.steps.get(now.step) else { return };
    let first = now.step.saturating_sub(TRAIL);
    let mut last = first.checked_sub(1).and_then(|s| play.steps.get(s)).map(|s| s.tip);
    for (i, s) in play.steps.iter().enumerate().take(now.step + 1).skip(first) {
        let to = if i == now.step { now.tip } else { s.tip };
        if let Some(from) = last {
            let cuts = matches!(s.kind, Kind::Cut | Kind::Plunge);
            // What is longer ago is fainter.
            let age = 1.0 - (now.step - i) as f32 / (TRAIL + 1) as f32;
            let colour = kind_colour(s.kind).gamma_multiply(age * if cuts { 1.0 } else { 0.6 });
            let ends = [to_screen(from.truncate()), to_screen(to.truncate())];
            painter.line_segment(ends, Stroke::new(if cuts { 1.6 } else { 0.9 }, colour));
        }
        last = Some(to);
    }
    let tip = to_screen(now.tip.truncate());
    let tool = play.tool(step);
    let holder = tool.and_then(|t| t.holder.iter().map(|h| h.radius_from.max(h.radius_to)).reduce(f64::max));
    let length = tool.map_or(80.0, |t| t.length);
    let nose = to_screen((now.tip + now.axis * length).truncate());
    let ink = if struck { theme.error } else { theme.text };
    if let Some(radius) = holder {
        painter.circle(nose, (radius as f32 * zoom).max(3.0), ink.gamma_multiply(0.12), Stroke::new(1.5, ink));
    }
    painter.line_segment([tip, nose], Stroke::new(2.0, ink));
    let radius = tool.map_or(3.0, |t| t.diameter * 0.5);
    let fill = if struck { theme.error } else { kind_colour(step.kind) };
    painter.circle(tip, (radius as f32 * zoom).max(3.0), fill, Stroke::new(1.5, Color32::WHITE));
}
