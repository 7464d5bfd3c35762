//! Figures of panels and faces as colours, with a legend.

use crate::scene::{Drawing, Kind, Part};
use crate::theme::Theme;
use eframe::egui::{Align2, Color32, FontId, Painter, Rect, pos2, vec2};
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use tenon_engine::Tree;

/// What is shown in colours.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Measure {
    /// Area of the front face.
    Size,
    /// Largest angle to a neighbour.
    Fold,
    /// Distance of corners from a plane.
    Planarity,
    /// Difference of opposite angles around corners.
    Conicity,
    /// A list of numbers in the graph (`node.port`), one per panel or face.
    Numbers(Arc<str>),
}

impl Measure {
    /// Those that need no list.
    pub const ALL: [Self; 4] = [Self::Size, Self::Fold, Self::Planarity, Self::Conicity];

    /// What it is called.
    #[must_use]
    pub fn name(&self) -> String {
        match self {
            Self::Size => "panel size".into(),
            Self::Fold => "fold angle".into(),
            Self::Planarity => "planarity".into(),
            Self::Conicity => "conicity".into(),
            Self::Numbers(address) => (**address).to_owned(),
        }
    }

    /// The figure of a part; that of a list stands elsewhere.
    #[must_use]
    pub fn of(&self, part: &Part) -> f64 {
        match self {
            Self::Size => part.area,
            Self::Fold => part.fold,
            Self::Planarity => part.planarity,
            Self::Conicity => part.conicity,
            Self::Numbers(_) => f64::NAN,
        }
    }

    /// A figure as people type it, in the unit that it is shown in.
    #[must_use]
    pub fn read(&self, text: &str) -> Option<f64> {
        let end = text.trim().find(|c: char| !(c.is_ascii_digit() || "+-.eE".contains(c)));
        let number: f64 = text.trim().get(..end.unwrap_or(text.trim().len()))?.parse().ok()?;
        Some(if *self == Self::Size { number * 1e6 } else { number })
    }

    /// A figure for people.
    #[must_use]
    pub fn shown(&self, value: f64) -> String {
        match self {
            Self::Size => format!("{:.4} m²", value / 1e6),
            Self::Fold | Self::Conicity => format!("{value:.1}°"),
            Self::Planarity => format!("{value:.3} mm"),
            Self::Numbers(_) => crate::model::param::shown(value),
        }
    }
}

/// A measure with its figures' range, and the numbers if it is a list.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// What is measured.
    pub measure: Measure,
    /// Smallest and largest figure.
    pub range: [f64; 2],
    /// From where to where the colours go; what lies beyond bears the last one.
    pub shown: [f64; 2],
    /// Another one for other figures or another range of colours.
    pub key: u128,
    /// The list; NaN for gaps.
    numbers: Arc<Vec<f64>>,
}

impl Measured {
    /// Measures all drawings; none if nothing has figures. O(parts), O(numbers) for a list.
    #[must_use]
    pub fn new(measure: &Measure, drawings: &BTreeMap<String, Arc<Drawing>>, list: Option<&Tree>) -> Option<Self> {
        let mut numbers = Vec::new();
        for (_, column) in list.into_iter().flat_map(|t| t.branches()) {
            let number = |i| column.get::<f64>(i).copied().or_else(|| column.get::<i64>(i).map(|v| *v as f64));
            numbers.extend((0..column.len()).map(|i| number(i).unwrap_or(f64::NAN)));
        }
        let numbers = Arc::new(numbers);
        let mut found = Self { measure: measure.clone(), range: [0.0; 2], shown: [0.0; 2], key: 0, numbers };
        let faces = drawings.values().filter(|d| matches!(d.kind, Kind::Panels | Kind::Mesh));
        let all = faces.flat_map(|d| (0..d.parts.len()).map(|i| found.figure(d, i)));
        let range =
            all.filter(|v| v.is_finite()).fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], v| [a.min(v), b.max(v)]);
        (found.range, found.shown) = (range, range);
        (range[0] <= range[1]).then_some(found)
    }

    /// The figure of a part of a drawing; NaN if it has none.
    #[must_use]
    pub fn figure(&self, drawing: &Drawing, part: usize) -> f64 {
        match &self.measure {
            Measure::Numbers(_) if self.numbers.len() != drawing.parts.len() => f64::NAN,
            Measure::Numbers(_) => self.numbers.get(part).copied().unwrap_or(f64::NAN),
            plain => drawing.parts.get(part).filter(|p| p.area > 0.0).map_or(f64::NAN, |p| plain.of(p)),
        }
    }
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
    measure: Option<u128>,
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
        measure: Option<&Measured>,
        picked: Option<u32>,
    ) -> Arc<Vec<u32>> {
        let measure = measure.filter(|_| matches!(drawing.kind, Kind::Panels | Kind::Mesh));
        if measure.is_none() && picked.is_none() {
            self.kept.remove(output);
            return self.plain.clone();
        }
        let now = For { digest: drawing.digest, measure: measure.map(|m| m.key), picked };
        if let Some((made_for, colours)) = self.kept.get(output)
            && *made_for == now
        {
            return colours.clone();
        }
        let bytes = |c: Color32| u32::from_le_bytes([c.r(), c.g(), c.b(), 255]);
        let mut colours: Vec<u32> = match measure {
            None => vec![0; drawing.parts.len()],
            Some(m) => {
                let [low, high] = m.shown;
                let colour = |v: f64| match v {
                    v if !v.is_finite() => 0,
                    v => bytes(gradient(if high > low { (v - low) / (high - low) } else { 0.5 })),
                };
                (0..drawing.parts.len()).map(|i| colour(m.figure(drawing, i))).collect()
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

/// Width of the fields at the ends of the legend.
const FIELD: f32 = 84.0;

/// Where the legend's bar stands: below, right of the axes.
pub fn bar(area: Rect) -> Rect {
    let width = (area.width() - 2.0 * FIELD - 96.0).clamp(40.0, 180.0);
    Rect::from_min_size(area.right_bottom() - vec2(FIELD + 14.0 + width, 28.0), vec2(width, 14.0))
}

/// Where the fields of the smallest and the largest figure stand.
pub fn fields(area: Rect) -> [Rect; 2] {
    let bar = bar(area);
    let away = 5.0 + FIELD / 2.0;
    let [low, high] = [bar.left_center() - vec2(away, 0.0), bar.right_center() + vec2(away, 0.0)];
    [low, high].map(|middle| Rect::from_center_size(middle, vec2(FIELD, 20.0)))
}

/// Where the legend begins: what stands below it would be hidden.
pub fn top(area: Rect) -> f32 {
    bar(area).top() - 24.0
}

/// What the colours mean; the ends of the range stand beside the bar, to be changed.
pub fn legend(painter: &Painter, area: Rect, theme: &Theme, m: &Measured) {
    let (bar, [low, high]) = (bar(area), fields(area));
    let ground = low.union(high).expand(4.0).with_min_y(top(area));
    painter.rect_filled(ground, 4.0, theme.space.gamma_multiply(0.88));
    let steps = 60;
    for i in 0..steps {
        let t = f64::from(i) / f64::from(steps - 1);
        let x = bar.left() + bar.width() * i as f32 / steps as f32;
        let step = Rect::from_min_size(pos2(x, bar.top()), vec2(bar.width() / steps as f32 + 0.5, bar.height()));
        painter.rect_filled(step, 0.0, gradient(t));
    }
    let name = m.measure.name();
    let above = bar.center_top() - vec2(0.0, 5.0);
    painter.text(above, Align2::CENTER_BOTTOM, name, FontId::proportional(12.0), theme.text);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_are_read_as_they_are_shown() {
        for measure in Measure::ALL {
            let value = if measure == Measure::Size { 123_400.0 } else { 12.5 };
            assert_eq!(measure.read(&measure.shown(value)), Some(value), "{measure:?}");
        }
        assert_eq!(Measure::Size.read("0.5"), Some(5e5));
        assert_eq!(Measure::Fold.read("wide"), None);
    }

    #[test]
    fn the_gradient_ends_where_it_should() {
        assert_eq!(gradient(0.0), Color32::from_rgb(60, 100, 200));
        assert_eq!(gradient(1.0), Color32::from_rgb(215, 70, 55));
        assert_eq!(gradient(f64::NAN), gradient(0.0));
    }
}
