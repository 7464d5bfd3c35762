//! The pictures of the book, drawn by the program on a dark and on a light ground: `cargo xtask screenshots` runs this.

#[allow(dead_code, reason = "the tests do more with it")]
#[path = "../tests/common.rs"]
mod common;

use common::{WRONG, Window, example, faulty_shell, graph, root};
use eframe::egui::{Theme, pos2, vec2};
use image::DynamicImage;
use image::codecs::png::{CompressionType, FilterType as Rows, PngEncoder};
use image::imageops::{FilterType, resize};
use std::path::Path;
use tenon_editor::app::Side;
use tenon_editor::panels::Tab;
use tenon_editor::scene::Part;
use tenon_editor::viewport::{Clip, Measure};
use tenon_engine::Operation;

fn main() {
    // The window shows them among the examples.
    for name in ["quad-mesh", "shell-21mm", "shell-256", "three-strips"] {
        thumbnail(name);
    }
    whole();
    found();
    colours();
    boards();
    inside();
    open();
    problems();
    faults();
    data();
    addresses();
    points();
    gallery();
    tour();
}

fn save(picture: impl Into<DynamicImage>, to: &str) {
    let file = std::fs::File::create(root().join(to)).unwrap();
    let small = PngEncoder::new_with_quality(file, CompressionType::Best, Rows::Adaptive);
    picture.into().into_rgb8().write_with_encoder(small).unwrap();
}

/// Draws what a window shows on both grounds.
fn both(w: &mut Window, name: &str) {
    for (theme, ground) in [(Theme::Dark, "dark"), (Theme::Light, "light")] {
        w.harness.ctx.set_theme(theme);
        w.settle();
        let name = format!("{name}-{ground}");
        let picture = w.picture(&name);
        save(picture, &format!("docs/{name}.png"));
    }
}

/// A window of which nothing is told that depends on the machine, and the pointer out of the way.
fn window(graph: Option<&Path>) -> Window {
    let mut w = Window::sized(graph, vec2(1280.0, 760.0));
    if w.has("I see") {
        w.click(w.rect("I see").center());
    }
    w.harness.event(eframe::egui::Event::PointerGone);
    w.steps(2);
    w
}

fn shell() -> Window {
    window(Some(&example("shell-256")))
}

fn choose(w: &mut Window, id: &str) {
    w.app().model.selection = [id.to_owned()].into();
    w.app().canvas.show_all();
    w.settle();
}

/// The shell of 256 panels, near enough that the inputs of its nodes are read.
fn whole() {
    let mut w = shell();
    choose(&mut w, "thicken");
    w.app().model.selection.clear();
    both(&mut w, "editor");
}

/// A node that is looked for.
fn found() {
    let mut w = shell();
    choose(&mut w, "thicken");
    let canvas = w.rect("canvas");
    w.double_click(pos2(canvas.left() + 60.0, canvas.top() + 40.0));
    w.type_text("panel");
    both(&mut w, "editor-finder");
}

/// Sizes of panels in colours, and how long each node took.
fn colours() {
    let mut w = shell();
    w.app().viewport.measure = Some(Measure::Size);
    choose(&mut w, "thicken");
    w.app().lower.toggle(Tab::Profile);
    both(&mut w, "editor-colours");
}

/// The boards while they are cut: from above with the program, and in space.
fn boards() {
    let mut w = shell();
    w.app().side = Side::Boards;
    choose(&mut w, "pack");
    let length = w.app().boards.plays()[0].length();
    w.app().boards.player.go_to(0.75 * length);
    both(&mut w, "editor-boards");
    // Near enough to see holes, grain and the tool.
    w.app().boards.player.code = true;
    w.app().boards.player.show = w.app().boards.now().map(|(play, now)| (play.board, now.tip));
    both(&mut w, "editor-program");
    (w.app().boards.player.solid, w.app().boards.player.code) = (true, false);
    w.settle();
    w.app().boards.show_all();
    both(&mut w, "editor-solid");
}

/// A cluster from inside, with a group and a note.
fn inside() {
    let mut w = window(Some(&example("three-strips")));
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
    w.app().model.edit(Operation::SetParam { node: id, port: "text".into(), value: text });
    w.app().model.selection.clear();
    w.app().canvas.show_all();
    both(&mut w, "editor-inside");
}

/// The shell cut open, with its tool paths, and the list of its pieces.
fn open() {
    let mut w = shell();
    w.app().viewport.tool_paths = true;
    w.app().viewport.clip = Some(Clip::square_to(0, 2600.0));
    choose(&mut w, "thicken");
    w.app().model.selection.clear();
    w.app().lower.toggle(Tab::Pieces);
    w.settle();
    // Near enough to see single moves.
    let parts = &w.app().model.results.drawings["thicken.panels"].parts;
    let off = |p: &Part| (p.centre.x - 2500.0).abs() + (p.centre.y - 500.0).abs();
    let near = parts.iter().min_by(|a, b| off(a).total_cmp(&off(b))).map(|p| p.centre);
    let camera = &mut w.app().viewport.camera;
    (camera.target, camera.distance) = (near.unwrap(), 1500.0);
    both(&mut w, "editor-open");
}

/// What is wrong, at the nodes and in words, and what a number is.
fn problems() {
    let mut w = window(Some(&graph("problems", WRONG)));
    w.app().lower.toggle(Tab::Problems);
    w.app().canvas.show_all();
    w.steps(2);
    w.app().model.selection = ["series".to_owned()].into();
    both(&mut w, "editor-problems");
}

/// What a proof has found: on the board, on the slider, in the list.
fn faults() {
    let mut w = window(Some(&faulty_shell()));
    w.app().side = Side::Boards;
    choose(&mut w, "prove");
    let first = w.app().boards.player.faults.of(0).find(|f| f.line.is_some()).cloned();
    let (line, at) = first.and_then(|f| f.line.zip(f.at)).unwrap();
    let time = w.app().boards.plays()[0].time_of(line).unwrap();
    w.app().boards.player.go_to(time);
    w.app().boards.player.show = Some((0, at));
    w.app().lower.toggle(Tab::Problems);
    both(&mut w, "editor-faults");
}

/// A value as a tree, all of its branches open.
fn data() {
    let mut w = window(Some(&example("nodes").join("trees.tenon.json")));
    choose(&mut w, "wall_and_bay");
    w.app().lower.toggle(Tab::Data);
    w.settle();
    w.click(w.rect("Tree").center());
    w.click(w.rect("open all").center());
    w.harness.event(eframe::egui::Event::PointerGone);
    both(&mut w, "editor-data");
}

/// The panels with their addresses, near enough to be read.
fn addresses() {
    let mut w = shell();
    choose(&mut w, "thicken");
    w.app().model.selection.clear();
    w.click(w.rect("Addresses").center());
    w.harness.event(eframe::egui::Event::PointerGone);
    let parts = &w.app().model.results.drawings["thicken.panels"].parts;
    let middle = parts[parts.len() / 2].centre;
    let camera = &mut w.app().viewport.camera;
    (camera.target, camera.distance, camera.pitch) = (middle, 2400.0, 1.2);
    both(&mut w, "editor-addresses");
}

/// The control points of a curve, drawn and as a table.
fn points() {
    let mut w = shell();
    choose(&mut w, "arc");
    w.double_click(w.rect("input arc.points").center());
    w.harness.event(eframe::egui::Event::PointerGone);
    both(&mut w, "editor-points");
}

/// The first step of the tour.
fn tour() {
    let mut w = shell();
    w.click(w.rect("Help").center());
    w.click(w.rect("Tour of three steps").center());
    w.settle();
    w.harness.event(eframe::egui::Event::PointerGone);
    both(&mut w, "editor-tour");
}

/// The examples.
fn gallery() {
    let mut w = window(None);
    w.click(w.rect("Help").center());
    w.click(w.rect("Examples …").center());
    w.harness.event(eframe::egui::Event::PointerGone);
    both(&mut w, "editor-examples");
}

/// The picture of an example for the window's list of examples: drawn larger, so that thin lines stay whole.
fn thumbnail(name: &str) {
    let mut w = Window::sized(Some(&example(name)), vec2(1000.0, 640.0));
    w.harness.ctx.set_theme(Theme::Light);
    w.app().viewport.show_all();
    w.settle();
    let picture = w.app().viewport.picture([1280, 800]).unwrap();
    save(resize(&picture, 320, 200, FilterType::Triangle), &format!("graphs/{name}/{name}.png"));
}
