//! The viewport: what nodes make, in space. Looking around, picking, and points taken by hand.

mod analysis;
mod camera;
mod gpu;
mod hand;
mod labels;
mod paths;
mod reference;
mod ruler;
mod save;
mod section;
mod tools;

pub use analysis::Measure;
pub use camera::{Camera, Standard};
pub(crate) use gpu::{Frame, Shown};
pub use gpu::{install, write_directly};
pub use hand::{Drag, Hand};
pub use reference::{PICTURES, Reference, References, references};
pub use ruler::Ruler;
pub use section::Clip;

use crate::model::Model;
use crate::panels::{Browse, escaped};
use crate::scene::Kind;
use crate::theme::Theme;
use analysis::{Colours, Measured};
use eframe::egui::{
    self, Align2, Color32, FontId, Id, Key, PointerButton, Rect, Response, Sense, Stroke, Ui, WidgetInfo, WidgetType,
};
use glam::{DVec2, DVec3};
use std::sync::Arc;

/// Curves and points so near to the pointer are picked, points of the screen.
const NEAR: f64 = 6.0;

/// A part that was picked: an output (`node.port`) and the number of the part.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Picked {
    /// `node.port`.
    pub output: String,
    /// The part's number there.
    pub part: u32,
}

/// What is under the pointer.
struct Met {
    /// Output and part; none if it is only a section, with nothing behind it.
    part: Option<(String, u32)>,
    place: DVec3,
    /// The place is on the section, and the part what is cut there.
    section: bool,
}

/// The viewport of one window.
#[derive(Default)]
pub struct Viewport {
    /// The eye.
    pub camera: Camera,
    /// What was picked last.
    pub picked: Option<Picked>,
    /// Whether parts bear their labels.
    pub labels: bool,
    written: labels::Labels,
    /// Points taken by hand, and how they are dragged.
    pub hand: Hand,
    /// All is to be brought into view as soon as there is something.
    fit: bool,
    /// What is shown in colours.
    pub measure: Option<Measure>,
    /// From where to where the colours go; none: over all figures. It belongs to the measure.
    pub range: Option<(Measure, [f64; 2])>,
    measured: Option<Arc<Measured>>,
    colours: Colours,
    /// Measuring by hand.
    pub ruler: Ruler,
    /// The plane that cuts the view open.
    pub clip: Option<Clip>,
    section: section::Section,
    /// Tool paths are shown.
    pub tool_paths: bool,
    /// Rapid moves too.
    pub rapid_moves: bool,
    paths: paths::Paths,
    /// What stands behind the model.
    pub references: References,
    /// What a file is wanted for.
    pub wants: Option<Browse>,
    /// Size of saved pictures, pixels.
    pub picture_size: [u32; 2],
    /// The graphics card, and what was drawn last.
    card: Option<eframe::egui_wgpu::RenderState>,
    drawn: Option<Frame>,
    saving: Option<save::Saving>,
}

pub(crate) fn rgb(colour: Color32) -> [f32; 3] {
    [colour.r(), colour.g(), colour.b()].map(|c| f32::from(c) / 255.0)
}

/// Turns, moves and nears the eye as the hand says, and looks from where a key says.
pub(crate) fn look(camera: &mut Camera, ui: &Ui, response: &Response) {
    let area = response.rect;
    let (shift, scroll, pinch, at) =
        ui.input(|i| (i.modifiers.shift, i.smooth_scroll_delta.y, i.zoom_delta(), i.pointer.latest_pos()));
    if response.dragged() {
        let by = response.drag_delta();
        let (dx, dy) = (f64::from(by.x), f64::from(by.y));
        if response.dragged_by(PointerButton::Middle) || shift {
            camera.pan(area, dx, dy);
        } else {
            camera.orbit(dx, dy);
        }
    }
    if !response.contains_pointer() {
        return;
    }
    if let Some(at) = at.filter(|at| area.contains(*at) && (scroll != 0.0 || pinch != 1.0)) {
        let factor = if pinch != 1.0 { 1.0 / f64::from(pinch) } else { f64::from(-scroll * 0.003).exp() };
        camera.zoom(area, at, factor);
    }
    if ui.ctx().egui_wants_keyboard_input() {
        return;
    }
    // As on a number pad in other programs: 7 is above, 1 in front, 3 on the right; with Ctrl the other side.
    let keys = [
        (Key::Num7, Standard::Top, Standard::Bottom),
        (Key::Num1, Standard::Front, Standard::Back),
        (Key::Num3, Standard::Right, Standard::Left),
        (Key::Num0, Standard::Corner, Standard::Corner),
    ];
    for (key, plain, other) in keys {
        if ui.input(|i| i.key_pressed(key)) {
            camera.stand(if ui.input(|i| i.modifiers.command) { other } else { plain });
        }
    }
    if ui.input(|i| i.key_pressed(Key::Num5)) {
        camera.orthographic = !camera.orthographic;
    }
}

impl Viewport {
    /// After another graph was opened.
    pub fn opened(&mut self) {
        let measure = self.measure.take().filter(|m| !matches!(m, Measure::Numbers(_)));
        *self = Self {
            fit: true,
            labels: self.labels,
            measure,
            card: self.card.take(),
            picture_size: self.picture_size,
            saving: self.saving.take(),
            ..Self::default()
        };
    }

    /// Takes the graphics card, for pictures; says what it is.
    pub fn use_card(&mut self, card: &eframe::egui_wgpu::RenderState) -> String {
        self.card = Some(card.clone());
        self.picture_size = [1920, 1080];
        install(card)
    }

    /// Shows everything, or what is selected, at the next frame.
    pub fn show_all(&mut self) {
        self.fit = true;
    }

    /// Shows the viewport in all the room that `ui` has.
    pub fn show(&mut self, ui: &mut Ui, model: &mut Model) {
        let area = ui.available_rect_before_wrap();
        let response = ui.interact(area, Id::new("viewport"), Sense::click_and_drag());
        response.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "viewport"));
        if self.fit {
            self.bring_into_view(area, model);
        }
        look(&mut self.camera, ui, &response);
        self.measure_all(model);
        self.render(ui, area, model);
        if self.labels {
            let panels = model.results.drawings.values().filter(|d| d.kind == Kind::Panels).cloned().collect();
            let painter = ui.painter_at(area);
            self.written.paint(ui.ctx(), &painter, (area, &self.camera), self.clip, panels);
        }
        self.axes(ui, area);
        let taken = self.hand.show(ui, area, &self.camera, self.clip, model);
        if response.clicked() && !taken {
            if self.ruler.on {
                self.measure_to(&response, model);
            } else {
                self.pick(ui, &response, model);
            }
        }
        if let Some((at, words)) = self.ruler.paint(&ui.painter_at(area), &Theme::of(ui), &self.camera, area) {
            // Screen readers read it too.
            let told = ui.interact(at, Id::new("measured"), Sense::hover());
            told.widget_info(|| WidgetInfo::labeled(WidgetType::Label, true, &words));
        }
        self.say_what_is_picked(ui, area, model);
        self.buttons(ui, area, model);
        self.legend(ui, area);
        self.going_on(ui, area);
    }

    /// Says what is being read or written beside the window.
    fn going_on(&self, ui: &mut Ui, area: Rect) {
        let reading = self.references.coming().map(|file| format!("reading {file} …"));
        let writing = self.saving.iter().map(|s| format!("writing {} …", s.path.display()));
        let all: Vec<String> = reading.chain(writing).collect();
        if all.is_empty() {
            return;
        }
        let place = Rect::from_min_max(egui::pos2(area.left() + 8.0, area.top() + 64.0), area.max);
        let mut ui = ui.new_child(egui::UiBuilder::new().max_rect(place));
        for words in all {
            ui.horizontal(|ui| {
                ui.spinner();
                ui.label(words);
            });
        }
    }

    /// Follows the graph in what stands behind the model, and tells what came of pictures that were saved. To be called at
    /// every frame, whether the viewport is shown or not.
    pub fn follow(&mut self, ctx: &egui::Context, model: &mut Model) -> Option<String> {
        self.follow_references(ctx, model);
        match self.saved()? {
            Ok(said) => Some(said),
            Err(why) => {
                model.message = Some(why);
                None
            }
        }
    }

    /// Whether nothing is on its way from other threads.
    #[must_use]
    pub fn settled(&self) -> bool {
        // What is not looked at any more is not taken either once it is made.
        let made = (!self.tool_paths || self.paths.settled())
            && (self.clip.is_none() || self.section.settled())
            && (!self.labels || self.written.settled());
        made && self.references.settled() && self.saving.is_none()
    }

    /// The addresses that are written on panels, and where on screen.
    #[must_use]
    pub fn written(&self) -> &[(String, Rect)] {
        self.written.drawn()
    }

    /// From where to where the colours go that are shown now.
    #[must_use]
    pub fn shown_range(&self) -> Option<[f64; 2]> {
        self.measured.as_ref().map(|m| m.shown)
    }

    /// The legend, whose ends can be changed.
    fn legend(&mut self, ui: &mut Ui, area: Rect) {
        let Some(measured) = self.measured.clone() else { return };
        analysis::legend(&ui.painter_at(area), area, &Theme::of(ui), &measured);
        let bar = analysis::bar(area);
        let mut range = measured.shown;
        let speed = (measured.range[1] - measured.range[0]).abs().max(1e-9) / 200.0;
        let names = ["smallest in colours", "largest in colours"];
        for (k, (room, name)) in analysis::fields(area).into_iter().zip(names).enumerate() {
            let measure = measured.measure.clone();
            let field = egui::DragValue::new(&mut range[k])
                .speed(speed)
                .update_while_editing(false)
                .custom_formatter(move |v, _| measure.shown(v))
                .custom_parser({
                    let measure = measured.measure.clone();
                    move |text| measure.read(text)
                });
            let response = ui.put(room, field).on_hover_text("drag or type; double-click beside: all figures again");
            response.widget_info(|| WidgetInfo::labeled(WidgetType::DragValue, true, name));
        }
        if range != measured.shown && range[0] <= range[1] && !escaped(ui) {
            self.range = Some((measured.measure.clone(), range));
        }
        let all = ui.interact(bar, Id::new("legend"), Sense::click());
        all.widget_info(|| WidgetInfo::labeled(WidgetType::Other, true, "legend"));
        if all.double_clicked() {
            self.range = None;
        }
    }

    /// Measures what is shown in colours, if it is not what was measured last. O(outputs), O(parts) after a change.
    fn measure_all(&mut self, model: &Model) {
        let Some(measure) = &self.measure else {
            self.measured = None;
            return;
        };
        let list = match measure {
            Measure::Numbers(address) => match model.results.values.get(&**address) {
                Some(list) => Some(list),
                None => {
                    self.measured = None;
                    return;
                }
            },
            _ => None,
        };
        let range = self.range.as_ref().filter(|(of, _)| of == measure).map(|(_, range)| *range);
        let digests = model.results.drawings.values().map(|d| d.digest).chain(list.map(tenon_engine::Tree::digest));
        let numbers = range.iter().flatten().map(|v| u128::from(v.to_bits()));
        let name = tenon_engine::digest_bytes(measure.name().as_bytes());
        let key =
            digests.chain(numbers).fold(name, |sum, d| sum.rotate_left(29).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ d);
        if self.measured.as_ref().is_some_and(|m| m.key == key) {
            return;
        }
        self.measured = Measured::new(measure, &model.results.drawings, list).map(|mut m| {
            (m.shown, m.key) = (range.unwrap_or(m.range), key);
            Arc::new(m)
        });
    }

    /// Smallest and largest coordinates of all that is shown.
    fn bounds(&self, model: &Model) -> Option<[DVec3; 2]> {
        let all = model.results.drawings.values().map(|d| d.bounds);
        let behind = self.references.boxes(model).into_iter().map(|(_, bounds)| bounds);
        all.chain(behind).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
    }

    /// What is drawn first under the pointer. A curve or point near the pointer goes before the body behind it.
    fn meet(&self, area: Rect, at: egui::Pos2, model: &Model) -> Option<Met> {
        let (origin, direction) = self.camera.ray(area, at);
        let seen = |p: DVec3| self.clip.is_none_or(|c| c.side(p) <= 0.0);
        let all = model.results.drawings.iter();
        let hits = all.clone().filter_map(|(output, d)| d.pick(origin, direction, seen).map(|h| (output, h)));
        let solid = hits.min_by(|a, b| a.1.1.total_cmp(&b.1.1));
        let solid = solid.map(|(output, (part, along))| (output, part, origin + direction * along));
        // Where a body is cut open, what is filled stands before its inside.
        let filled = self.clip.and_then(|c| self.section.hit(c, origin, direction));
        let nearer = |p: &DVec3| solid.is_none_or(|(_, _, hit)| (hit - *p).dot(direction) > 0.0);
        let filled = filled.filter(nearer);
        let first = filled.or(solid.map(|(_, _, hit)| hit));
        // What lies a little behind a face is on it.
        let slack = self.camera.distance * 0.003;
        let hidden = |p: DVec3| first.is_some_and(|hit| (hit - p).dot(direction) < -slack);
        let place = self.camera.projector(area);
        let picture = |p: DVec3| {
            let at = place(p).filter(|_| seen(p))?;
            Some(DVec2::new(f64::from(at.x), f64::from(at.y)))
        };
        let pointer = DVec2::new(f64::from(at.x), f64::from(at.y));
        let thin = all.filter_map(|(output, d)| d.pick_thin(pointer, NEAR, picture).map(|h| (output, h)));
        let thin = thin.filter(|(_, h)| !hidden(h.1)).min_by(|a, b| a.1.2.total_cmp(&b.1.2));
        let thin = thin.map(|(output, (part, place, _))| (output, part, place));
        let section = thin.is_none() && filled.is_some();
        let part = thin.or(solid).map(|(output, part, _)| (output.clone(), part));
        let place = thin.map(|(_, _, place)| place).or(first)?;
        Some(Met { part, place, section })
    }

    fn measure_to(&mut self, response: &Response, model: &Model) {
        let Some(at) = response.interact_pointer_pos() else { return };
        let Some(Met { part, place, section }) = self.meet(response.rect, at, model) else { return };
        let taken = if section {
            // What lies behind a section does not count there, only its own corners.
            Ruler::snapped(&self.camera, response.rect, at, place, self.section.corners())
        } else {
            let drawing = part.and_then(|(output, part)| Some((model.results.drawings.get(&output)?, part)));
            let corners = drawing.into_iter().flat_map(|(d, part)| d.corners_of(part));
            let corners = corners.filter(|p| self.clip.is_none_or(|c| c.side(*p) <= 0.0));
            Ruler::snapped(&self.camera, response.rect, at, place, corners)
        };
        self.ruler.take(taken);
    }

    fn bring_into_view(&mut self, area: Rect, model: &Model) {
        let chosen = |address: &str| model.is_chosen(address);
        let all = &model.results.drawings;
        let any = all.keys().any(|a| chosen(a));
        let boxes = all.iter().filter(|(a, _)| !any || chosen(a)).map(|(_, d)| d.bounds);
        if let Some(bounds) = boxes.reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])]) {
            self.camera.fit(area, bounds);
            self.fit = false;
        }
    }

    fn render(&mut self, ui: &Ui, area: Rect, model: &Model) {
        let theme = Theme::of(ui);
        let measure = self.measured.clone();
        let mut shown = Vec::new();
        for (output, drawing) in &model.results.drawings {
            let chosen = model.is_chosen(output);
            let (mut face, line) = match drawing.kind {
                Kind::Panels => (Color32::from_rgb(226, 190, 140), theme.line),
                Kind::Mesh => (Color32::from_rgb(160, 176, 190), theme.line),
                Kind::Curve => (theme.text, Color32::from_rgb(60, 160, 80)),
                Kind::Points | Kind::Paths => (theme.text, Color32::from_rgb(220, 80, 100)),
            };
            let mut line = line;
            if chosen {
                face = Color32::from_rgb(150, 205, 140);
                line = theme.selected;
            }
            let width = match drawing.kind {
                Kind::Curve => [2.2, 4.0],
                _ => [1.0, 4.0],
            };
            let picked = self.picked.as_ref().filter(|p| p.output == *output).map(|p| p.part);
            let colours = self.colours.of(output, drawing, measure.as_deref(), picked);
            // Of curves the one that is picked bears its own colour.
            let (open, coloured_lines) = (drawing.kind == Kind::Mesh, drawing.kind == Kind::Curve);
            let plain = Shown::plain(output.clone(), drawing.clone(), face, line);
            shown.push(Shown { width, colours, open, coloured_lines, clipped: true, ..plain });
        }
        self.besides(ui, &theme, model, &mut shown);
        let frame = Frame::new(&self.camera, area, theme.space, self.clip, shown);
        self.drawn = Some(frame.clone());
        ui.painter().add(eframe::egui_wgpu::Callback::new_paint_callback(area, frame));
    }

    /// What is drawn besides what nodes make: references, tool paths, the outline of a section.
    fn besides(&mut self, ui: &Ui, theme: &Theme, model: &Model, shown: &mut Vec<Shown>) {
        let plain = |key: String, drawing, line: Color32| Shown {
            open: true,
            clipped: true,
            ..Shown::plain(key, drawing, theme.faint, line)
        };
        for (i, r) in references(model).into_iter().enumerate() {
            let Some(seen) = self.references.seen(&r.file) else { continue };
            let (picture, place) = (seen.picture.clone(), r.place());
            let behind = plain(format!("behind {i} {}", r.file), seen.drawing.clone(), theme.faint);
            shown.push(Shown { picture, place, ..behind });
        }
        if let Some(paths) = Some(()).filter(|()| self.tool_paths).and_then(|()| self.paths.of(ui.ctx(), model)) {
            let way = |key: &str, drawing, width| {
                let colours = paths.colours.clone();
                Shown { colours, width, coloured_lines: true, ..plain(key.into(), drawing, theme.text) }
            };
            shown.push(way("tool paths", paths.feed, [1.3, 4.0]));
            if self.rapid_moves {
                shown.push(way("rapid moves", paths.rapid, [0.8, 4.0]));
            }
        }
        let section = self.clip.and_then(|clip| self.section.of(ui.ctx(), clip, model.results.drawings.values()));
        if let Some(drawing) = section {
            let line = plain("section".into(), drawing, theme.error);
            shown.push(Shown {
                face: rgb(Color32::from_rgb(232, 132, 96)),
                width: [2.5, 4.0],
                clipped: false,
                open: false,
                ..line
            });
        }
    }

    fn pick(&mut self, ui: &Ui, response: &Response, model: &mut Model) {
        let Some(at) = response.interact_pointer_pos() else { return };
        let met = self.meet(response.rect, at, model).and_then(|met| met.part);
        self.picked = met.map(|(output, part)| Picked { output, part });
        if !ui.input(|i| i.modifiers.shift) {
            model.selection.clear();
        }
        if let Some(id) = self.picked.as_ref().and_then(|p| model.local(&p.output)).map(str::to_owned) {
            // The part is shown by its own colour, so that it stands out of the others.
            model.selection.insert(id);
        }
    }

    /// The axes of space in a corner.
    fn axes(&self, ui: &Ui, area: Rect) {
        let painter = ui.painter_at(area);
        let (right, up) = self.camera.sides();
        let centre = egui::pos2(area.left() + 34.0, area.bottom() - 34.0);
        let axes = [("x", DVec3::X, 220, 80, 70), ("y", DVec3::Y, 90, 170, 80), ("z", DVec3::Z, 80, 130, 220)];
        for (name, axis, r, g, b) in axes {
            let by = egui::vec2(axis.dot(right) as f32, -axis.dot(up) as f32) * 22.0;
            let colour = Color32::from_rgb(r, g, b);
            painter.line_segment([centre, centre + by], Stroke::new(2.0, colour));
            painter.text(centre + by * 1.3, Align2::CENTER_CENTER, name, FontId::proportional(11.0), colour);
        }
    }

    fn say_what_is_picked(&self, ui: &Ui, area: Rect, model: &Model) {
        let part = self.picked.as_ref().and_then(|p| {
            let drawing = model.results.drawings.get(&p.output)?;
            Some((p, drawing.parts.get(p.part as usize)?))
        });
        let Some((picked, part)) = part else { return };
        let mut text = format!("{} {}", picked.output, part.label);
        if part.area > 0.0 {
            for measure in Measure::ALL {
                text += &format!(", {} {}", measure.name(), measure.shown(measure.of(part)));
            }
        }
        let listed = self.measured.as_ref().filter(|m| matches!(m.measure, Measure::Numbers(_)));
        if let (Some(m), Some(drawing)) = (listed, model.results.drawings.get(&picked.output)) {
            let figure = m.figure(drawing, picked.part as usize);
            text += &format!(", {} {}", m.measure.name(), m.measure.shown(figure));
        }
        if part.area <= 0.0
            && let Some(at) = self.camera.project(area, part.centre)
        {
            ui.painter_at(area).circle_stroke(at, 8.0, Stroke::new(2.0, Theme::of(ui).selected));
        }
        let bottom = if self.measured.is_some() { analysis::top(area) } else { area.bottom() - 8.0 };
        let at = egui::pos2(area.left() + 70.0, bottom - 4.0);
        let (painter, ink) = (ui.painter_at(area), Theme::of(ui).text);
        let room = (area.right() - at.x - 8.0).max(1.0);
        let galley = painter.layout(text.clone(), FontId::proportional(13.0), ink, room);
        let rect = Align2::LEFT_BOTTOM.anchor_size(at, galley.size());
        painter.galley(rect.min, galley, ink);
        // Screen readers read it too.
        let told = ui.interact(rect, Id::new("picked"), Sense::hover());
        told.widget_info(|| WidgetInfo::labeled(WidgetType::Label, true, &text));
    }
}
