//! Which part of the canvas is seen: where it begins and how large it is drawn.

use eframe::egui::{Pos2, Rect, Vec2, pos2};

/// Smallest and largest scale.
pub const ZOOM: std::ops::RangeInclusive<f32> = 0.04..=3.0;

/// From canvas points to screen points: `screen = origin + canvas · zoom`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where the canvas' zero stands, relative to the canvas' area on screen.
    pub origin: Vec2,
    /// Scale.
    pub zoom: f32,
}

impl Default for View {
    fn default() -> Self {
        Self { origin: Vec2::ZERO, zoom: 1.0 }
    }
}

impl View {
    /// A place of the canvas on screen; `area` is the canvas' area there.
    #[must_use]
    pub fn to_screen(&self, area: Rect, p: Pos2) -> Pos2 {
        area.min + self.origin + p.to_vec2() * self.zoom
    }

    /// A rectangle of the canvas on screen.
    #[must_use]
    pub fn rect_to_screen(&self, area: Rect, r: Rect) -> Rect {
        Rect::from_min_max(self.to_screen(area, r.min), self.to_screen(area, r.max))
    }

    /// A place on screen in the canvas.
    #[must_use]
    pub fn to_canvas(&self, area: Rect, p: Pos2) -> Pos2 {
        ((p - area.min - self.origin) / self.zoom).to_pos2()
    }

    /// Scales by `factor`; what is under `at` stays there.
    pub fn zoom_at(&mut self, area: Rect, at: Pos2, factor: f32) {
        let fixed = self.to_canvas(area, at);
        self.zoom = (self.zoom * factor).clamp(*ZOOM.start(), *ZOOM.end());
        self.origin = at - area.min - fixed.to_vec2() * self.zoom;
    }

    /// Shows all of `content`, not larger than its own size.
    pub fn fit(&mut self, area: Rect, content: Rect) {
        let content = content.expand(30.0);
        let scale = (area.width() / content.width()).min(area.height() / content.height());
        self.zoom = scale.clamp(*ZOOM.start(), 1.0);
        self.origin = area.size() / 2.0 - content.center().to_vec2() * self.zoom;
    }

    /// Brings `p` into the middle.
    pub fn centre(&mut self, area: Rect, p: Pos2) {
        self.origin = area.size() / 2.0 - p.to_vec2() * self.zoom;
    }

    /// The part of the canvas that is seen.
    #[must_use]
    pub fn seen(&self, area: Rect) -> Rect {
        Rect::from_min_max(self.to_canvas(area, area.min), self.to_canvas(area, area.max))
    }
}

/// A place rounded to the grid that nodes snap to.
#[must_use]
pub fn snap(p: Pos2) -> Pos2 {
    pos2((p.x / 10.0).round() * 10.0, (p.y / 10.0).round() * 10.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::vec2;

    #[test]
    fn zooming_keeps_what_is_under_the_cursor() {
        let area = Rect::from_min_size(pos2(100.0, 50.0), vec2(800.0, 600.0));
        let mut view = View::default();
        view.fit(area, Rect::from_min_max(pos2(0.0, 0.0), pos2(3000.0, 400.0)));
        assert!(area.contains_rect(view.rect_to_screen(area, Rect::from_min_max(pos2(0.0, 0.0), pos2(3000.0, 400.0)))));
        let cursor = pos2(321.0, 222.0);
        let before = view.to_canvas(area, cursor);
        view.zoom_at(area, cursor, 1.7);
        assert!((view.to_canvas(area, cursor) - before).length() < 0.01);
    }
}
