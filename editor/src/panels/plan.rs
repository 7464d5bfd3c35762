//! The points of a list as a drawing, seen along an axis: they are dragged, put in and taken away there, and the curve that
//! the node makes of them follows.

use crate::scene::{Drawing, Kind};
use crate::theme::Theme;
use eframe::egui::{
    Align2, FontId, Painter, PointerButton, Pos2, Rect, Response, Sense, Stroke, Ui, WidgetInfo, WidgetType, pos2, vec2,
};

/// How near to a point or line counts as on it, screen points.
const NEAR: f32 = 9.0;
/// Room around what is drawn, screen points.
const MARGIN: f32 = 22.0;
const HEIGHT: f32 = 190.0;

/// What is done with the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drawn {
    /// A point goes elsewhere.
    Move(usize, [f64; 3]),
    /// A new one, before the one that has this number.
    Put(usize, [f64; 3]),
    /// A point is taken away.
    Take(usize),
}

/// Along which axis one looks, and what a view is called: right and up are these coordinates.
const VIEWS: [(&str, [usize; 2]); 3] = [("from above", [0, 1]), ("from the front", [0, 2]), ("from the right", [1, 2])];

/// The drawing of one list.
#[derive(Default)]
pub struct Plan {
    /// Which of the views; none: the one that shows most.
    view: Option<usize>,
    /// The point that is dragged, and how the drawing is seen meanwhile: it would run away from the pointer.
    held: Option<(usize, Sight)>,
}

/// From coordinates to the screen.
#[derive(Clone, Copy)]
struct Sight {
    axes: [usize; 2],
    /// What is in the middle, mm.
    middle: [f64; 2],
    centre: Pos2,
    /// Screen points per mm.
    scale: f64,
}

impl Sight {
    fn new(axes: [usize; 2], rect: Rect, all: impl Iterator<Item = [f64; 3]>) -> Self {
        let (mut low, mut high) = ([f64::INFINITY; 2], [f64::NEG_INFINITY; 2]);
        for p in all {
            for k in 0..2 {
                (low[k], high[k]) = (low[k].min(p[axes[k]]), high[k].max(p[axes[k]]));
            }
        }
        if low[0] > high[0] {
            (low, high) = ([-500.0; 2], [500.0; 2]);
        }
        let room = rect.size() - vec2(2.0 * MARGIN, 2.0 * MARGIN);
        let fits = |k: usize, room: f32| f64::from(room.max(1.0)) / (high[k] - low[k]);
        let scale = fits(0, room.x).min(fits(1, room.y));
        let scale = if scale.is_finite() { scale } else { 0.1 };
        Self { axes, middle: [0, 1].map(|k| (low[k] + high[k]) / 2.0), centre: rect.center(), scale }
    }

    fn to_screen(self, p: [f64; 3]) -> Pos2 {
        let [x, y] = [0, 1].map(|k| ((p[self.axes[k]] - self.middle[k]) * self.scale) as f32);
        self.centre + vec2(x, -y)
    }

    /// A point where the pointer is; its third coordinate stays. As exact as the screen shows, on a grid if one is asked for.
    fn at(&self, at: Pos2, mut p: [f64; 3], on_grid: bool) -> [f64; 3] {
        let off = at - self.centre;
        let step = 10_f64.powi(((if on_grid { 20.0 } else { 1.0 }) / self.scale).log10().floor() as i32);
        for (k, off) in [off.x, -off.y].into_iter().enumerate() {
            let v = self.middle[k] + f64::from(off) / self.scale;
            // A step below one has a reciprocal without crumbs.
            p[self.axes[k]] = if step < 1.0 {
                (v * (1.0 / step).round()).round() / (1.0 / step).round()
            } else {
                (v / step).round() * step
            };
        }
        p
    }
}

/// The view in which points spread most; from above if they spread alike.
fn best(points: &[[f64; 3]]) -> usize {
    let spread = [0, 1, 2].map(|k| {
        let all = || points.iter().map(|p| p[k]);
        all().fold(f64::NEG_INFINITY, f64::max) - all().fold(f64::INFINITY, f64::min)
    });
    // The axis along which they spread least is the one to look along: z, y, x.
    [2, 1, 0]
        .into_iter()
        .enumerate()
        .fold((0, f64::INFINITY), |best, (view, axis)| if spread[axis] < best.1 { (view, spread[axis]) } else { best })
        .0
}

/// How far a place is from a line, and how far along it that is, 0 to 1.
fn from_line(at: Pos2, a: Pos2, b: Pos2) -> (f32, f32) {
    let t = ((at - a).dot(b - a) / (b - a).length_sq().max(1e-9)).clamp(0.0, 1.0);
    (at.distance(a + (b - a) * t), t)
}

impl Plan {
    /// Whether a point is being dragged.
    #[must_use]
    pub fn is_dragging(&self) -> bool {
        self.held.is_some()
    }

    /// Shows the points and what the node makes of them; gives what was done. O(points + lines).
    pub fn show(&mut self, ui: &mut Ui, points: &[[f64; 3]], made: &[&Drawing]) -> Option<Drawn> {
        let view = self.view.unwrap_or_else(|| best(points));
        ui.horizontal(|ui| {
            for (k, (name, _)) in VIEWS.iter().enumerate() {
                if ui.selectable_label(k == view, *name).clicked() {
                    self.view = Some(k);
                }
            }
        });
        let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), HEIGHT), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "drawing of the points"));
        let response = response
            .on_hover_text("drag a point, with Shift on a grid; double-click: a new one, on the line between two; right-click: take it away");
        let (_, axes) = VIEWS[view.min(VIEWS.len() - 1)];
        let lines = || made.iter().filter(|d| d.kind == Kind::Curve).flat_map(|d| &d.lines);
        let ends = lines().flat_map(|l| [l.from, l.to]).map(|p| p.map(f64::from));
        let sight = self.held.map_or_else(|| Sight::new(axes, rect, points.iter().copied().chain(ends)), |(_, s)| s);
        let done = self.hand(ui, &response, sight, points);
        let painter = ui.painter_at(rect);
        let theme = Theme::of(ui);
        painter.rect_filled(rect, 3.0, theme.space);
        for line in lines() {
            let [a, b] = [line.from, line.to].map(|p| sight.to_screen(p.map(f64::from)));
            painter.line_segment([a, b], Stroke::new(1.5, crate::theme::type_colour("curve")));
        }
        paint(ui, &painter, &theme, sight, points);
        done
    }

    /// What the pointer does.
    fn hand(&mut self, ui: &Ui, response: &Response, sight: Sight, points: &[[f64; 3]]) -> Option<Drawn> {
        let (at, pressed, shift) = ui.input(|i| (i.pointer.latest_pos(), i.pointer.press_origin(), i.modifiers.shift));
        let at = at?;
        let under = |at: Pos2| {
            let far = points.iter().map(|p| sight.to_screen(*p).distance(at)).enumerate();
            far.filter(|(_, d)| *d < NEAR).min_by(|a, b| a.1.total_cmp(&b.1)).map(|(i, _)| i)
        };
        if response.drag_started_by(PointerButton::Primary) {
            self.held = pressed.and_then(under).map(|i| (i, sight));
        }
        if let Some((i, sight)) = self.held {
            if !response.dragged_by(PointerButton::Primary) {
                self.held = None;
                return None;
            }
            let was = *points.get(i)?;
            let now = sight.at(at, was, shift);
            return (now != was).then_some(Drawn::Move(i, now));
        }
        if response.secondary_clicked() {
            return under(at).map(Drawn::Take);
        }
        if !response.double_clicked() || under(at).is_some() {
            return None;
        }
        let between = points.windows(2).enumerate().map(|(i, w)| {
            let (far, t) = from_line(at, sight.to_screen(w[0]), sight.to_screen(w[1]));
            (far, i, [0, 1, 2].map(|k| w[0][k] + f64::from(t) * (w[1][k] - w[0][k])))
        });
        let near = between.filter(|(far, ..)| *far < NEAR).min_by(|a, b| a.0.total_cmp(&b.0));
        Some(match near {
            Some((_, i, p)) => Drawn::Put(i + 1, sight.at(at, p, shift)),
            None => Drawn::Put(points.len(), sight.at(at, points.last().copied().unwrap_or_default(), shift)),
        })
    }
}

fn paint(ui: &Ui, painter: &Painter, theme: &Theme, sight: Sight, points: &[[f64; 3]]) {
    let places: Vec<Pos2> = points.iter().map(|p| sight.to_screen(*p)).collect();
    for w in places.windows(2) {
        painter.line_segment([w[0], w[1]], Stroke::new(1.0, theme.faint));
    }
    for (i, at) in places.iter().enumerate() {
        painter.circle(*at, 5.0, crate::theme::type_colour("point"), Stroke::new(1.5, theme.value));
        let above = pos2(at.x, at.y - 8.0);
        let font = FontId::proportional(crate::theme::SMALL);
        painter.text(above, Align2::CENTER_BOTTOM, (i + 1).to_string(), font, theme.text);
        let handle =
            ui.interact(Rect::from_center_size(*at, vec2(10.0, 10.0)), ui.id().with(("handle", i)), Sense::hover());
        handle.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, format!("point {} in the drawing", i + 1)));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_on_screen_is_a_round_coordinate_and_the_third_stays() {
        let rect = Rect::from_min_size(pos2(100.0, 50.0), vec2(400.0, 200.0));
        let points = [[0.0, 7.0, 0.0], [1000.0, 7.0, 300.0]];
        let sight = Sight::new([0, 2], rect, points.into_iter());
        for p in points {
            let there = sight.to_screen(p);
            assert!(rect.contains(there));
            assert_eq!(sight.at(there, [0.0, 7.0, 0.0], false), p);
        }
        let [x, y, z] = sight.at(pos2(333.3, 111.1), points[0], false);
        assert_eq!((x.fract(), y, z.fract()), (0.0, 7.0, 0.0), "a millimetre is less than a pixel");
        let [x, _, z] = sight.at(pos2(333.3, 111.1), points[0], true);
        assert_eq!((x % 10.0, z % 10.0), (0.0, 0.0));
        let fine = Sight::new([0, 1], rect, [[0.0; 3], [1.0, 0.1, 0.0]].into_iter());
        let [x, ..] = fine.at(pos2(333.3, 111.1), [0.0; 3], false);
        assert_eq!(format!("{x}").len(), 5, "{x} has three decimals");
    }

    #[test]
    fn one_looks_along_the_axis_in_which_points_spread_least() {
        assert_eq!(best(&[[0.0, 0.0, 0.0], [1.0, 2.0, 0.0]]), 0);
        assert_eq!(best(&[[0.0, 0.0, 0.0], [1.0, 0.0, 2.0]]), 1);
        assert_eq!(best(&[[0.0, 0.0, 0.0], [0.0, 1.0, 2.0]]), 2);
        assert_eq!(best(&[]), 0);
        assert_eq!(best(&[[3.0, 4.0, 5.0]]), 0);
    }
}
