//! Measuring between two places that are clicked; corners near the pointer are taken exactly.

use super::Camera;
use crate::theme::Theme;
use eframe::egui::{Align2, FontId, Painter, Pos2, Rect, Stroke};
use glam::DVec3;

/// Corners so near to the pointer are taken, points of the screen.
const NEAR: f32 = 10.0;

/// A distance that is being measured.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Ruler {
    /// Clicks measure.
    pub on: bool,
    /// The places, none, one or two.
    pub ends: Vec<DVec3>,
}

impl Ruler {
    /// Takes a place; a third one begins anew.
    pub fn take(&mut self, at: DVec3) {
        if self.ends.len() > 1 {
            self.ends.clear();
        }
        self.ends.push(at);
    }

    /// The corner near the pointer, else the place itself.
    #[must_use]
    pub fn snapped(camera: &Camera, area: Rect, at: Pos2, hit: DVec3, corners: impl Iterator<Item = DVec3>) -> DVec3 {
        let near = corners.filter_map(|p| {
            let away = camera.project(area, p)?.distance(at);
            // What lies behind what was hit is not meant.
            (away < NEAR && (p - hit).dot(camera.back()) > -camera.distance * 0.02).then_some((away, p))
        });
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(hit, |(_, p)| p)
    }

    /// The distance and its parts along the axes, in words; none before two places are taken.
    #[must_use]
    pub fn words(&self) -> Option<String> {
        let [a, b] = self.ends[..] else { return None };
        let d = b - a;
        Some(format!("{:.2} mm  (x {:.2}, y {:.2}, z {:.2})", d.length(), d.x, d.y, d.z))
    }

    /// Paints what was taken; gives where the words stand.
    pub fn paint(&self, painter: &Painter, theme: &Theme, camera: &Camera, area: Rect) -> Option<(Rect, String)> {
        let places: Vec<Pos2> = self.ends.iter().filter_map(|p| camera.project(area, *p)).collect();
        for p in &places {
            painter.circle(*p, 4.0, theme.selected, Stroke::new(1.0, theme.text));
        }
        let ([a, b], Some(words)) = (&places[..], self.words()) else { return None };
        painter.line_segment([*a, *b], Stroke::new(2.0, theme.selected));
        let middle = *a + (*b - *a) / 2.0;
        let galley = painter.layout_no_wrap(words.clone(), FontId::proportional(13.0), theme.text);
        let back = Rect::from_center_size(middle, galley.size()).expand(3.0);
        painter.rect_filled(back, 3.0, theme.node);
        let at = Align2::CENTER_CENTER.anchor_size(middle, galley.size()).min;
        painter.galley(at, galley, theme.text);
        Some((back, words))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_places_give_a_distance_and_a_third_begins_anew() {
        let mut ruler = Ruler::default();
        ruler.take(DVec3::ZERO);
        assert_eq!(ruler.words(), None);
        ruler.take(DVec3::new(3.0, 4.0, 0.0));
        assert_eq!(ruler.words().unwrap(), "5.00 mm  (x 3.00, y 4.00, z 0.00)");
        ruler.take(DVec3::ONE);
        assert_eq!(ruler.ends, [DVec3::ONE]);
    }
}
