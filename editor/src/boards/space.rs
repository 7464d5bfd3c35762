//! The board in space while it is cut: stock, tool, holder and spindle as bodies.

use super::carve::{self, Carved};
use super::draw::kind_colour;
use crate::model::cut::Faults;
use crate::model::play::{Now, Play};
use crate::scene::{Drawing, Kind, Line, Part, Vertex};
use crate::theme::Theme;
use crate::viewport::{Camera, Frame, Shown, look};
use eframe::egui::{Color32, Id, Sense, Ui, WidgetInfo, WidgetType};
use std::sync::Arc;
use tenon_geometry::DVec3;
use tenon_geometry::board::Board;
use tenon_geometry::machine::{Pose, Revolved};

/// Corners of a body's circles.
const ROUND: usize = 32;
/// Steps whose way is drawn behind the tool.
const TRAIL: usize = 60;
/// So much is seen around a place that is brought into view, mm.
const NEAR: DVec3 = DVec3::splat(100.0);

/// The eye over the board.
#[derive(Default)]
pub struct Space {
    camera: Camera,
    fitted: Option<u32>,
    /// A place that is to be brought into view.
    at: Option<DVec3>,
    /// Counts drawings, so that each is another to the card.
    count: u128,
    colours: Arc<Vec<u32>>,
    tool_colours: Arc<Vec<u32>>,
}

impl Space {
    /// Shows all of the board at the next frame.
    pub fn show_all(&mut self) {
        self.fitted = None;
    }

    /// Brings a place of the board into view at the next frame.
    pub fn look_at(&mut self, place: DVec3) {
        self.at = Some(place);
    }

    /// Shows the board in all the room that `ui` has; `struck`: the proof has found something wrong just here.
    #[expect(clippy::too_many_arguments, reason = "a moment is all of these")]
    pub fn show(
        &mut self,
        ui: &mut Ui,
        board: &Board,
        play: &Play,
        now: Now,
        carved: &Carved,
        faults: &Faults,
        struck: bool,
    ) {
        let area = ui.available_rect_before_wrap();
        let response = ui.interact(area, Id::new("board in space"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "board in space"));
        if self.fitted != Some(play.board) {
            self.camera.fit(area, [DVec3::ZERO, board.size.extend(board.thickness)]);
            self.camera.distance *= 0.8;
            self.fitted = Some(play.board);
        }
        if let Some(place) = self.at.take() {
            self.camera.fit(area, [place - NEAR, place + NEAR]);
        }
        look(&mut self.camera, ui, &response);
        let theme = Theme::of(ui);
        if self.colours.is_empty() {
            self.colours = Arc::new(carve::colours());
        }
        self.count += 1;
        let plain =
            |key: String, drawing, line| Shown { width: [1.2, 5.0], ..Shown::plain(key, drawing, theme.faint, line) };
        let pieces = carved.solid.iter().enumerate().filter(|(_, d)| !d.triangles.is_empty());
        let mut shown: Vec<Shown> = pieces
            .map(|(i, d)| Shown { colours: self.colours.clone(), ..plain(format!("stock {i}"), d.clone(), theme.line) })
            .collect();
        if let Some(tool) = self.tool(play, now, struck) {
            shown
                .push(Shown { colours: self.tool_colours.clone(), ..plain("tool".into(), Arc::new(tool), theme.line) });
        }
        let (way, colours) = way(play, now, self.count);
        shown.push(Shown { coloured_lines: true, colours, ..plain("way".into(), Arc::new(way), theme.text) });
        let marks = marks(faults.of(play.board).filter_map(|f| f.at));
        if !marks.points.is_empty() {
            shown.push(plain("faults".into(), Arc::new(marks), theme.error));
        }
        let frame = Frame::new(&self.camera, area, theme.space, None, shown);
        ui.painter().add(eframe::egui_wgpu::Callback::new_paint_callback(area, frame));
    }

    /// The tool with all that moves with it; red where it strikes something.
    fn tool(&mut self, play: &Play, now: Now, struck: bool) -> Option<Drawing> {
        let step = play.steps.get(now.step)?;
        let body = play.machine.machine.body(play.tool(step)?);
        let bytes = |c: Color32| u32::from_le_bytes([c.r(), c.g(), c.b(), 255]);
        let cutter = if struck { Color32::from_rgb(230, 40, 40) } else { kind_colour(step.kind) };
        let metals = [
            cutter,
            Color32::from_rgb(176, 182, 190),
            Color32::from_rgb(120, 126, 136),
            Color32::from_rgb(84, 90, 100),
        ];
        self.tool_colours = Arc::new(metals.into_iter().map(bytes).chain([0]).collect());
        let mut d = Drawing::empty(Kind::Mesh);
        let pose = Pose { tip: now.tip, axis: now.axis };
        for (part, pieces) in [body.cutter, body.shank, body.holder, body.spindle].into_iter().enumerate() {
            pieces.iter().for_each(|p| revolve(&mut d, p, pose, part as u32));
        }
        d.digest = self.count;
        d.parts = vec![Part::new("tool".into(), now.tip)];
        Some(d)
    }
}

/// Points where something is wrong; others are another drawing to the card.
fn marks(places: impl Iterator<Item = DVec3>) -> Drawing {
    let mut marks = Drawing::empty(Kind::Points);
    marks.points = places.map(|p| p.as_vec3().to_array()).collect();
    marks.digest = tenon_engine::digest_bytes(bytemuck::cast_slice(&marks.points));
    marks
}

/// A length of a solid of revolution, with both ends.
fn revolve(d: &mut Drawing, piece: &Revolved, pose: Pose, part: u32) {
    let side = pose.axis.any_orthonormal_vector();
    let other = pose.axis.cross(side);
    let out = |i: usize| {
        let (s, c) = (i as f64 / ROUND as f64 * std::f64::consts::TAU).sin_cos();
        side * c + other * s
    };
    let vertex = |p: DVec3, n: DVec3| {
        let n = (n * 127.0).round();
        Vertex { position: p.as_vec3().to_array(), normal: [n.x as i8, n.y as i8, n.z as i8, 0], part }
    };
    let ends = [(piece.from, piece.radius_from), (piece.to, piece.radius_to)];
    for i in 0..ROUND {
        let (u, v) = (out(i), out(i + 1));
        let [[a, b], [c, e]] = ends.map(|(h, r)| [u, v].map(|o| pose.tip + pose.axis * h + o * r));
        d.triangles.extend([vertex(a, u), vertex(b, v), vertex(e, v), vertex(a, u), vertex(e, v), vertex(c, u)]);
        for ((h, _), n, [p, q]) in [(ends[0], -pose.axis, [b, a]), (ends[1], pose.axis, [c, e])] {
            d.triangles.extend([pose.tip + pose.axis * h, p, q].map(|p| vertex(p, n)));
        }
    }
}

/// The way of the tool's last steps, with the colours of what they do.
fn way(play: &Play, now: Now, count: u128) -> (Drawing, Arc<Vec<u32>>) {
    use crate::model::play::Kind as Does;
    let bytes = |c: Color32| u32::from_le_bytes([c.r(), c.g(), c.b(), 255]);
    let kinds = [Does::Rapid, Does::Plunge, Does::Cut, Does::Retract];
    let mut d = Drawing::empty(Kind::Paths);
    let first = now.step.saturating_sub(TRAIL);
    let mut last = first.checked_sub(1).and_then(|s| play.steps.get(s)).map(|s| s.tip);
    for (i, step) in play.steps.iter().enumerate().take(now.step + 1).skip(first) {
        let to = if i == now.step { now.tip } else { step.tip };
        if let Some(from) = last {
            let part = kinds.iter().position(|k| *k == step.kind).unwrap_or(0) as u32;
            d.lines.push(Line { from: from.as_vec3().to_array(), to: to.as_vec3().to_array(), part });
        }
        last = Some(to);
    }
    d.digest = count;
    d.parts = vec![Part::new("way".into(), now.tip)];
    (d, Arc::new(kinds.into_iter().map(kind_colour).map(bytes).chain([0]).collect()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_at_other_places_are_another_drawing() {
        let of = |x: f64| marks([DVec3::ZERO, DVec3::new(x, 2.0, 0.0)].into_iter());
        assert_eq!(of(1.0).digest, of(1.0).digest);
        assert_ne!(of(1.0).digest, of(3.0).digest, "as many, and not there");
        assert_eq!(of(3.0).points[1], [3.0, 2.0, 0.0]);
    }

    #[test]
    fn a_revolved_piece_is_closed_and_faces_outwards() {
        let mut d = Drawing::empty(Kind::Mesh);
        let pose = Pose { tip: DVec3::new(3.0, 0.0, 1.0), axis: DVec3::new(0.6, 0.0, 0.8) };
        revolve(&mut d, &Revolved { from: 0.0, to: 10.0, radius_from: 2.0, radius_to: 2.0 }, pose, 0);
        let place = |v: &Vertex| DVec3::from(v.position.map(f64::from));
        let volume: f64 = d
            .triangles
            .chunks_exact(3)
            .map(|t| {
                let [a, b, c] = [place(&t[0]), place(&t[1]), place(&t[2])];
                a.dot(b.cross(c)) / 6.0
            })
            .sum();
        let exact = std::f64::consts::PI * 4.0 * 10.0;
        assert!((volume - exact).abs() < 0.01 * exact, "{volume} {exact}");
    }
}
