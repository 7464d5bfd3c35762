//! The pictures of the book, drawn by the program: `cargo xtask screenshots` runs this.

#[allow(dead_code, reason = "the tests do more with it")]
#[path = "../tests/common.rs"]
mod common;

use common::{Window, example, root};
use eframe::egui::vec2;

fn main() {
    let save = |w: &mut Window, name: &str| {
        let picture = w.picture(name);
        picture.save(root().join(format!("docs/{name}.png"))).unwrap();
    };
    let mut w = Window::sized(Some(&example("shell-256")), vec2(1440.0, 860.0));
    w.app().model.selection = ["thicken".to_owned()].into();
    w.app().canvas.show_all();
    w.steps(3);
    w.app().model.selection.clear();
    w.steps(2);
    save(&mut w, "editor");
    w.app().side = tenon_editor::app::Side::Boards;
    w.app().model.selection = ["pack".to_owned()].into();
    w.app().canvas.show_all();
    w.steps(3);
    let length = w.app().boards.plays()[0].length();
    w.app().boards.player.code = true;
    w.app().boards.player.go_to(0.08 * length);
    w.steps(1);
    w.app().boards.show_all();
    w.steps(3);
    save(&mut w, "editor-boards");
    w.harness.ctx.set_theme(eframe::egui::Theme::Light);
    w.app().side = tenon_editor::app::Side::Space;
    w.app().viewport.measure = Some(tenon_editor::viewport::Measure::Size);
    w.app().model.selection = ["thicken".to_owned()].into();
    w.app().canvas.show_all();
    w.app().lower.toggle(tenon_editor::panels::Tab::Profile);
    w.steps(4);
    save(&mut w, "editor-light");
}
