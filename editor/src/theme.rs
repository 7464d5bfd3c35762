//! Colours of canvas and viewport on a light and a dark ground, and how figures are written.

use eframe::egui::{Color32, Context, FontId, TextStyle, Ui};
use std::time::Duration;

/// Colours that depend on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Theme {
    /// Ground of the canvas.
    pub canvas: Color32,
    /// Its points.
    pub grid: Color32,
    /// Notes.
    pub paper: Color32,
    /// Body of a node.
    pub node: Color32,
    /// Its edge.
    pub edge: Color32,
    /// Where a value stands.
    pub field: Color32,
    /// The filled part of a slider.
    pub slider: Color32,
    /// Text.
    pub text: Color32,
    /// Values.
    pub value: Color32,
    /// Text of lesser weight.
    pub faint_text: Color32,
    /// What is off.
    pub faint: Color32,
    /// Header of a node.
    pub header: Color32,
    /// What is selected.
    pub selected: Color32,
    /// Errors.
    pub error: Color32,
    /// Warnings.
    pub warning: Color32,
    /// Frozen nodes.
    pub frozen: Color32,
    /// Ground of the viewport.
    pub space: Color32,
    /// Edges of panels.
    pub line: Color32,
}

const DARK: Theme = Theme {
    canvas: Color32::from_rgb(30, 32, 36),
    grid: Color32::from_rgb(58, 61, 68),
    paper: Color32::from_rgb(86, 80, 52),
    node: Color32::from_rgb(48, 51, 58),
    edge: Color32::from_rgb(18, 19, 22),
    field: Color32::from_rgb(37, 39, 45),
    slider: Color32::from_rgb(58, 92, 128),
    text: Color32::from_rgb(224, 226, 230),
    value: Color32::from_rgb(248, 249, 250),
    faint_text: Color32::from_rgb(158, 163, 172),
    faint: Color32::from_rgb(96, 100, 108),
    header: Color32::from_rgb(74, 80, 92),
    selected: Color32::from_rgb(120, 200, 120),
    error: Color32::from_rgb(214, 69, 65),
    warning: Color32::from_rgb(230, 150, 40),
    frozen: Color32::from_rgb(110, 160, 210),
    space: Color32::from_rgb(38, 41, 47),
    line: Color32::from_rgb(104, 80, 54),
};

const LIGHT: Theme = Theme {
    canvas: Color32::from_rgb(232, 233, 235),
    grid: Color32::from_rgb(200, 202, 206),
    paper: Color32::from_rgb(252, 244, 200),
    node: Color32::from_rgb(250, 250, 251),
    edge: Color32::from_rgb(140, 144, 152),
    field: Color32::from_rgb(234, 236, 240),
    slider: Color32::from_rgb(172, 204, 236),
    text: Color32::from_rgb(36, 38, 42),
    value: Color32::from_rgb(12, 13, 15),
    faint_text: Color32::from_rgb(100, 104, 112),
    faint: Color32::from_rgb(160, 164, 172),
    header: Color32::from_rgb(196, 202, 212),
    selected: Color32::from_rgb(40, 140, 50),
    error: Color32::from_rgb(206, 60, 56),
    warning: Color32::from_rgb(236, 160, 60),
    frozen: Color32::from_rgb(140, 184, 228),
    space: Color32::from_rgb(244, 245, 247),
    line: Color32::from_rgb(128, 100, 70),
};

impl Theme {
    /// The colours for the ground that `ui` has.
    #[must_use]
    pub fn of(ui: &Ui) -> Self {
        if ui.visuals().dark_mode { DARK } else { LIGHT }
    }

    /// Colour of a wire, which steps back from nodes unless it is `chosen`; read on the canvas all the same.
    #[must_use]
    pub fn wire(&self, colour: Color32, chosen: bool) -> Color32 {
        match (*self == LIGHT, chosen) {
            (true, true) => colour.lerp_to_gamma(Color32::BLACK, 0.2),
            (true, false) => colour.lerp_to_gamma(Color32::from_rgb(60, 64, 70), 0.5),
            (false, true) => colour,
            (false, false) => colour.gamma_multiply(0.55),
        }
    }
}

/// The smallest text that is read without effort.
pub const SMALL: f32 = 11.0;

/// Gives what egui paints the colours and sizes that it lacks: its own weak text is too faint to be read, the small too small.
pub fn install(ctx: &Context) {
    for (ground, theme) in [(eframe::egui::Theme::Dark, DARK), (eframe::egui::Theme::Light, LIGHT)] {
        ctx.style_mut_of(ground, |style| {
            style.visuals.weak_text_color = Some(theme.faint_text);
            style.text_styles.insert(TextStyle::Small, FontId::proportional(SMALL));
        });
    }
}

/// Colour of wires and ports by item type.
#[must_use]
pub fn type_colour(type_name: &str) -> Color32 {
    match type_name {
        "number" => Color32::from_rgb(86, 156, 214),
        "integer" => Color32::from_rgb(78, 190, 190),
        "boolean" => Color32::from_rgb(190, 120, 200),
        "text" => Color32::from_rgb(170, 170, 110),
        "point" | "vector" | "plane" => Color32::from_rgb(230, 100, 120),
        "curve" | "addresses" => Color32::from_rgb(120, 190, 90),
        "mesh" => Color32::from_rgb(70, 170, 130),
        "panels" => Color32::from_rgb(222, 158, 80),
        "features" => Color32::from_rgb(206, 120, 60),
        "parts" => Color32::from_rgb(190, 140, 96),
        "layout" => Color32::from_rgb(160, 130, 190),
        "tool_paths" | "machining" | "machine" => Color32::from_rgb(110, 130, 210),
        "program" | "proof" | "file" => Color32::from_rgb(200, 110, 170),
        _ => Color32::from_rgb(150, 154, 162),
    }
}

/// Colour of a node's header by category.
#[must_use]
pub fn category_colour(category: &str, theme: &Theme) -> Color32 {
    let tint = match category {
        "Parameters" | "Numbers" | "Number" => type_colour("number"),
        "Curve" => type_colour("curve"),
        "Mesh" | "Surface" => type_colour("mesh"),
        "Panel" | "Panels" => type_colour("panels"),
        "Joint" | "Joints" => type_colour("features"),
        "Board" | "Boards" => type_colour("layout"),
        "Machine" | "Motion" | "Machining" => type_colour("machine"),
        "Files" | "Proof" => type_colour("file"),
        _ => theme.header,
    };
    let mix = |a: u8, b: u8| ((u16::from(a) * 2 + u16::from(b)) / 3) as u8;
    Color32::from_rgb(mix(theme.header.r(), tint.r()), mix(theme.header.g(), tint.g()), mix(theme.header.b(), tint.b()))
}

/// Black or white, whichever reads better on a ground.
#[must_use]
pub fn ink_on(ground: Color32) -> Color32 {
    let light = 0.299 * f32::from(ground.r()) + 0.587 * f32::from(ground.g()) + 0.114 * f32::from(ground.b());
    if light > 140.0 { Color32::from_rgb(16, 17, 19) } else { Color32::WHITE }
}

/// A duration for people.
#[must_use]
pub fn duration(t: Duration) -> String {
    let s = t.as_secs_f64();
    match s {
        _ if s >= 10.0 => format!("{s:.0} s"),
        _ if s >= 1.0 => format!("{s:.1} s"),
        _ if s >= 0.01 => format!("{:.0} ms", s * 1e3),
        _ if s >= 0.001 => format!("{:.1} ms", s * 1e3),
        _ => format!("{:.0} µs", s * 1e6),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Contrast of two opaque colours (WCAG 2.1).
    fn contrast(a: Color32, b: Color32) -> f32 {
        let light = |c: Color32| {
            let [r, g, b, _] = eframe::egui::Rgba::from(c).to_array();
            0.2126 * r + 0.7152 * g + 0.0722 * b + 0.05
        };
        light(a).max(light(b)) / light(a).min(light(b))
    }

    #[test]
    fn wires_and_weak_text_are_read_on_both_grounds() {
        let types = ["number", "integer", "boolean", "text", "point", "curve", "mesh", "panels", "features", "parts"];
        let types = types.into_iter().chain(["layout", "machine", "file", "any"]);
        for colour in types.map(type_colour) {
            for chosen in [false, true] {
                let wire = LIGHT.wire(colour, chosen);
                assert!(contrast(wire, LIGHT.canvas) > if chosen { 2.7 } else { 3.5 }, "{colour:?} on light");
                let wire = DARK.canvas.blend(DARK.wire(colour, chosen));
                assert!(contrast(wire, DARK.canvas) > if chosen { 4.0 } else { 2.2 }, "{colour:?} on dark");
            }
        }
        let ctx = Context::default();
        install(&ctx);
        for ground in [eframe::egui::Theme::Dark, eframe::egui::Theme::Light] {
            let visuals = ctx.style_of(ground).visuals.clone();
            assert!(contrast(visuals.weak_text_color(), visuals.panel_fill) > 4.5, "{ground:?}");
        }
    }
}
