//! Figures of panels and faces as colours, with a legend.

use crate::scene::{Drawing, Kind, Part};
use crate::theme::Theme;
use eframe::egui::{Align2, Color32, FontId, Painter, Rect, pos2, vec2};
use std::collections::HashMap;
use std::sync::Arc;

/// What is shown in colours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Area of the front face.
    Size,
    /// Largest angle to a neighbour.
    Fold,
}

impl Measure {
    /// All of them with their names.
    pub const ALL: [(Self, &'static str); 2] = [(Self::Size, "panel size"), (Self::Fold, "fold angle")];

    /// The figure of a part.
    #[must_use]
    pub fn of(self, part: &Part) -> f64 {
        match self {
            Self::Size => part.area,
            Self::Fold => part.fold,
        }
    }

    /// A figure for people.
    #[must_use]
    pub fn shown(self, value: f64) -> String {
        match self {
            Self::Size => format!("{:.4} m²", value / 1e6),
            Self::Fold => format!("{value:.1}°"),
        }
    }
}

/// Smallest and largest figure of everything that has one; none if nothing has.
#[must_use]
pub fn range<'a>(measure: Measure, drawings: impl Iterator<Item = &'a Arc<Drawing>>) -> Option<[f64; 2]> {
    let parts = drawings.filter(|d| matches!(d.kind, Kind::Panels | Kind::Mesh)).flat_map(|d| &d.parts);
    let figures = parts.filter(|p| p.area > 0.0).map(|p| measure.of(p));
    let range = figures.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
    (range[0] <= range[1]).then_some(range)
}

/// From blue by green and yellow to red, `t` from 0 to 1.
#[must_use]
pub fn gradient(t: f64) -> Color32 {
    const STOPS: [[f64; 3]; 4] =
        [[60.0, 100.0, 200.0], [70.0, 180.0, 120.0], [240.0, 210.0, 80.0], [215.0, 70.0, 55.0]];
    let at = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) * 3.0 };
    let i = (at as usize).min(2);
    let mix = |k: usize| (STOPS[i][k] + (at - i as f64) * (STOPS[i + 1][k] - STOPS[i][k])).round() as u8;
    Color32::from_rgb(mix(0), mix(1), mix(2))
}

/// What the colours of an output were made for: value, measure with its range, part that is picked.
#[derive(Clone, PartialEq)]
struct For {
    digest: u128,
    measure: Option<(Measure, [f64; 2])>,
    picked: Option<u32>,
}

/// Colours by output, kept while nothing changes.
#[derive(Default)]
pub struct Colours {
    plain: Arc<Vec<u32>>,
    kept: HashMap<String, (For, Arc<Vec<u32>>)>,
}

impl Colours {
    /// The colours of an output's parts; empty if all parts look alike. O(parts) when something has changed.
    pub fn of(
        &mut self,
        output: &str,
        drawing: &Drawing,
        measure: Option<(Measure, [f64; 2])>,
        picked: Option<u32>,
    ) -> Arc<Vec<u32>> {
        let measure = measure.filter(|_| matches!(drawing.kind, Kind::Panels | Kind::Mesh));
        if measure.is_none() && picked.is_none() {
            self.kept.remove(output);
            return self.plain.clone();
        }
        let now = For { digest: drawing.digest, measure, picked };
        if let Some((made_for, colours)) = self.kept.get(output)
            && *made_for == now
        {
            return colours.clone();
        }
        let bytes = |c: Color32| u32::from_le_bytes([c.r(), c.g(), c.b(), 255]);
        let mut colours: Vec<u32> = match measure {
            None => vec![0; drawing.parts.len()],
            Some((measure, [low, high])) => {
                let along = |p: &Part| if high > low { (measure.of(p) - low) / (high - low) } else { 0.5 };
                drawing.parts.iter().map(|p| bytes(gradient(along(p)))).collect()
            }
        };
        // One more than there are parts: the last one counts for all beyond.
        colours.push(0);
        if let Some(colour) = picked.and_then(|p| colours.get_mut(p as usize)) {
            *colour = bytes(Color32::from_rgb(255, 150, 40));
        }
        let colours = Arc::new(colours);
        self.kept.insert(output.to_owned(), (now, colours.clone()));
        colours
    }
}

/// What the colours mean, in the upper right corner.
pub fn legend(painter: &Painter, area: Rect, theme: &Theme, measure: Measure, [low, high]: [f64; 2]) {
    let bar = Rect::from_min_size(area.right_top() + vec2(-26.0, 64.0), vec2(14.0, 150.0));
    let steps = 50;
    for i in 0..steps {
        let t = f64::from(i) / f64::from(steps - 1);
        let y = bar.bottom() - bar.height() * (i as f32 + 1.0) / steps as f32;
        let step = Rect::from_min_size(pos2(bar.left(), y), vec2(bar.width(), bar.height() / steps as f32 + 0.5));
        painter.rect_filled(step, 0.0, gradient(t));
    }
    let text =
        |at, words: String| painter.text(at, Align2::RIGHT_CENTER, words, FontId::proportional(12.0), theme.text);
    text(bar.left_top() - vec2(5.0, 0.0), measure.shown(high));
    text(bar.left_center() - vec2(5.0, 0.0), measure.shown((low + high) / 2.0));
    text(bar.left_bottom() - vec2(5.0, 0.0), measure.shown(low));
    let name = Measure::ALL.iter().find(|m| m.0 == measure).map_or("", |m| m.1);
    painter.text(bar.right_top() - vec2(0.0, 16.0), Align2::RIGHT_CENTER, name, FontId::proportional(12.0), theme.text);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gradient_ends_where_it_should() {
        assert_eq!(gradient(0.0), Color32::from_rgb(60, 100, 200));
        assert_eq!(gradient(1.0), Color32::from_rgb(215, 70, 55));
        assert_eq!(gradient(f64::NAN), gradient(0.0));
    }
}
