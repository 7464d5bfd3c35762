//! Tells other programs where the named widgets of the window are, for scripts that drive it by mouse and keyboard as a
//! person does. It only tells: nothing in the window can be changed by it.

use eframe::egui::{self, FullOutput, accesskit};
use serde_json::{Value, json};
use std::path::PathBuf;

/// The variable that names the file into which the window writes where its widgets are.
pub const VARIABLE: &str = "TENON_EDITOR_POSITIONS";

/// Writes the file after every frame. Without it, nothing of this costs anything.
pub struct Positions {
    file: PathBuf,
    frame: u64,
}

impl Positions {
    /// Begins to tell, if the variable asks for it.
    pub fn tell_if_asked(ctx: &egui::Context) {
        if let Some(file) = std::env::var_os(VARIABLE).filter(|f| !f.is_empty()) {
            Self::tell(ctx, file.into());
        }
    }

    /// Begins to tell into a file.
    pub fn tell(ctx: &egui::Context, file: PathBuf) {
        // The names are those that screen readers get.
        ctx.enable_accesskit();
        ctx.add_plugin(Self { file, frame: 0 });
    }
}

impl egui::Plugin for Positions {
    fn debug_name(&self) -> &'static str {
        "positions"
    }

    fn output_hook(&mut self, ctx: &egui::Context, output: &mut FullOutput) {
        let Some(update) = &output.platform_output.accesskit_update else { return };
        self.frame += 1;
        let scale = f64::from(ctx.pixels_per_point());
        let pointer = ctx.pointer_latest_pos().map(|p| [p.x, p.y].map(|v| f64::from(v) * scale));
        let down = ctx.input(|i| i.pointer.any_down());
        let widgets: Vec<Value> = update.nodes.iter().filter_map(|(_, node)| widget(node, scale)).collect();
        let focus = update.nodes.iter().find(|(id, _)| *id == update.focus).and_then(|(_, node)| widget(node, scale));
        let all = json!({ "frame": self.frame, "pointer": pointer, "down": down, "focus": focus, "widgets": widgets });
        // Whoever reads it waits for the next one.
        let _ = tenon_nodes::host::output::write_quickly(&self.file, all.to_string().as_bytes());
    }
}

/// A widget's name, what stands in it, and its rectangle in pixels of the window; none if it has no name or no place.
fn widget(node: &accesskit::Node, scale: f64) -> Option<Value> {
    let b = node.bounds()?;
    let name = node.label().or_else(|| node.value()).unwrap_or_default();
    let text = matches!(node.role(), accesskit::Role::TextInput | accesskit::Role::MultilineTextInput);
    if name.is_empty() && !text {
        return None;
    }
    let at = [b.x0, b.y0, b.x1, b.y1].map(|v| (v * scale * 10.0).round() / 10.0);
    Some(json!({ "name": name, "role": format!("{:?}", node.role()), "value": node.value(), "at": at }))
}
