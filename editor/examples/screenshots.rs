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
    player(&mut w, save);
    w.harness.ctx.set_theme(eframe::egui::Theme::Light);
    w.app().side = tenon_editor::app::Side::Space;
    w.app().viewport.measure = Some(tenon_editor::viewport::Measure::Size);
    w.app().model.selection = ["thicken".to_owned()].into();
    w.app().canvas.show_all();
    w.app().lower.toggle(tenon_editor::panels::Tab::Profile);
    w.settle();
    save(&mut w, "editor-light");
    inside(save);
    open(save);
    for name in ["quad-mesh", "shell-21mm", "shell-256", "three-strips"] {
        thumbnail(name);
    }
}

/// The boards while they are cut: from above on a dark ground, in space on a light one.
fn player(w: &mut Window, save: impl Fn(&mut Window, &str)) {
    w.app().side = tenon_editor::app::Side::Boards;
    w.app().model.selection = ["pack".to_owned()].into();
    w.app().canvas.show_all();
    w.settle();
    let length = w.app().boards.plays()[0].length();
    w.app().boards.player.code = true;
    w.app().boards.player.go_to(0.75 * length);
    w.settle();
    // Near enough to see holes, grain and the tool.
    let near = w.app().boards.now().map(|(play, now)| (play.board, now.tip));
    w.app().boards.player.show = near;
    w.settle();
    save(w, "editor-boards");
    w.harness.ctx.set_theme(eframe::egui::Theme::Light);
    (w.app().boards.player.solid, w.app().boards.player.code) = (true, false);
    w.settle();
    w.app().boards.show_all();
    w.settle();
    save(w, "editor-solid");
    w.app().boards.player.solid = false;
}

/// A cluster from inside, with a group and a note, on a dark ground.
fn inside(save: impl Fn(&mut Window, &str)) {
    let mut w = Window::sized(Some(&example("three-strips")), vec2(1280.0, 760.0));
    w.app().model.enter("low").unwrap();
    w.app().canvas.opened();
    w.settle();
    let arc = w.app().model.document().nodes().keys().filter(|id| id.starts_with("arc_")).cloned().collect();
    w.app().model.selection = arc;
    let group = tenon_editor::canvas::group(&w.app().model);
    w.app().model.edit(group);
    let title = w.app().model.set_in_group("group 1", "title", Some("Control points of the arc".into()));
    w.app().model.edit(title);
    let (id, add) = w.app().model.new_node("note", [250.0, -420.0]);
    w.app().model.edit(add);
    let text = Some("Every strip bends over its own arc.\nThe folds are the same in all of them.".into());
    w.app().model.edit(tenon_engine::Operation::SetParam { node: id, port: "text".into(), value: text });
    w.app().model.selection.clear();
    w.app().canvas.show_all();
    w.settle();
    save(&mut w, "editor-inside");
}

/// The shell cut open, with its tool paths, and the list of its pieces, on a light ground.
fn open(save: impl Fn(&mut Window, &str)) {
    let mut w = Window::sized(Some(&example("shell-256")), vec2(1280.0, 760.0));
    w.harness.ctx.set_theme(eframe::egui::Theme::Light);
    w.app().viewport.tool_paths = true;
    w.app().viewport.clip = Some(tenon_editor::viewport::Clip::square_to(0, 2600.0));
    w.app().lower.toggle(tenon_editor::panels::Tab::Pieces);
    w.settle();
    // Near enough to see single moves.
    let parts = &w.app().model.results.drawings["thicken.panels"].parts;
    let off = |p: &tenon_editor::scene::Part| (p.centre.x - 2500.0).abs() + (p.centre.y - 500.0).abs();
    let near = parts.iter().min_by(|a, b| off(a).total_cmp(&off(b))).map(|p| p.centre);
    let camera = &mut w.app().viewport.camera;
    (camera.target, camera.distance) = (near.unwrap(), 1500.0);
    w.settle();
    save(&mut w, "editor-open");
}

/// The picture of an example for the window's list of examples.
fn thumbnail(name: &str) {
    let mut w = Window::sized(Some(&example(name)), vec2(1000.0, 640.0));
    w.harness.ctx.set_theme(eframe::egui::Theme::Light);
    w.app().viewport.show_all();
    w.settle();
    let picture = w.app().viewport.picture([320, 200]).unwrap();
    picture.save(root().join(format!("graphs/{name}/{name}.png"))).unwrap();
}
