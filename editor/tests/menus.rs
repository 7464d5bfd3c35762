//! What stands in menus and lists and is chosen there by hand: tool paths, pictures, files, colours, examples.

use crate::common::{Window, example, folder, graph};
use eframe::egui::{Event, Key, Modifiers, PointerButton, ViewportCommand};
use egui_kittest::kittest::Queryable as _;
use std::path::Path;
use tenon_editor::viewport::{Measure, references};
use tenon_engine::{Node, Operation};

/// Types a path where a file is asked for.
fn choose(w: &mut Window, path: &Path) {
    w.type_text(&path.to_string_lossy());
    w.key(Modifiers::NONE, Key::Enter);
    w.settle();
}

/// Pixels of the viewport that are mainly of one channel: 0 red, 1 green, 2 blue.
fn mainly(w: &mut Window, channel: usize) -> usize {
    let picture = w.app().viewport.picture([600, 400]).unwrap();
    let is = |p: &image::Rgba<u8>| (0..3).all(|k| k == channel || p[channel] > p[k].saturating_add(50));
    picture.pixels().filter(|p| is(p)).count()
}

#[test]
fn tool_paths_are_shown_by_the_menu_and_rapid_moves_with_them() {
    let mut w = Window::open(Some(&example("shell-256")));
    let before = [1, 2].map(|k| mainly(&mut w, k));
    w.click(w.rect("More").center());
    w.click(w.rect("Tool paths").center());
    w.settle();
    let cuts = [1, 2].map(|k| mainly(&mut w, k));
    assert!(cuts[0] > before[0] + 500, "{before:?} green and blue pixels, then {cuts:?}");
    w.click(w.rect("rapid moves too").center());
    w.settle();
    let rapid = mainly(&mut w, 2);
    assert!(rapid > cuts[1] + 100, "{} blue pixels, then {rapid}", cuts[1]);
    w.picture("tool-paths-menu");
    w.click(w.rect("Tool paths").center());
    w.settle();
    assert_eq!([1, 2].map(|k| mainly(&mut w, k)), before);
}

#[test]
fn a_picture_is_saved_by_the_menu_beside_the_window_which_says_so() {
    let mut w = Window::open(Some(&example("shell-256")));
    let file = folder("menu-picture").join("shell.png");
    w.app().viewport.picture_size = [4000, 3000];
    w.click(w.rect("More").center());
    w.click(w.rect("Save a picture …").center());
    w.type_text(&file.to_string_lossy());
    let start = std::time::Instant::now();
    w.harness.key_press(Key::Enter);
    w.steps(1);
    let frame = start.elapsed();
    w.steps(1);
    assert!(w.has_containing("writing ") && !file.exists(), "it is still being drawn after a frame of {frame:?}");
    w.settle();
    assert!(w.has_containing("shell.png was written"), "{:?}", w.app().model.message);
    let picture = image::open(&file).unwrap().to_rgba8();
    assert_eq!(picture.dimensions(), (4000, 3000));
    // It is what the window shows, and the window goes on as before.
    let small = image::imageops::resize(&picture, 400, 300, image::imageops::FilterType::Triangle);
    let own = w.app().viewport.picture([400, 300]).unwrap();
    let differ = small.pixels().zip(own.pixels()).filter(|(a, b)| (0..3).any(|k| a[k].abs_diff(b[k]) > 90)).count();
    assert!(differ < 2400, "{differ} of 120000 pixels differ");
    // Where it cannot be written, that is told.
    w.click(w.rect("More").center());
    w.click(w.rect("Save a picture …").center());
    choose(&mut w, &file.join("below-a-file.png"));
    let told = w.app().model.message.clone().unwrap().message;
    assert!(told.contains("was not written"), "{told}");
}

#[test]
fn a_large_mesh_is_read_beside_the_window_which_says_so() {
    use std::fmt::Write as _;
    let (side, mut text) = (200, String::new());
    for i in 0..side * side {
        writeln!(text, "v {} {} 0", i % side, i / side).unwrap();
    }
    for i in (1..side * (side - 1)).filter(|i| i % side != 0) {
        writeln!(text, "f {i} {} {} {}", i + 1, i + side + 1, i + side).unwrap();
    }
    let mesh = folder("menu-mesh").join("large.obj");
    std::fs::write(&mesh, text).unwrap();
    let mut w = Window::open(None);
    w.click(w.rect("File").center());
    w.click(w.rect("Show a mesh or picture behind …").center());
    w.type_text(&mesh.to_string_lossy());
    assert!(w.enter_shows("reading ") && references(&w.app().model).is_empty());
    w.settle();
    assert!(!w.has_containing("reading "), "{:?}", w.app().model.message);
    let boxes = w.harness.state().viewport.references.boxes(&w.harness.state().model);
    assert_eq!(boxes.iter().map(|(_, b)| b[1].x).collect::<Vec<_>>(), [f64::from(side - 1)]);
}

#[test]
fn the_files_of_the_graph_are_written_by_the_menu() {
    let mut w = Window::open(Some(&example("quad-mesh")));
    let out = folder("menu-export").join("out");
    w.click(w.rect("File").center());
    w.click(w.rect("Export the files …").center());
    choose(&mut w, &out);
    let files: Vec<_> = w.app().model.results.files.iter().map(|(_, f)| f.clone()).collect();
    assert!(files.len() > 1);
    for file in files {
        let name = out.join(&*file.name);
        let name = if file.withheld.is_some() { name.with_added_extension("unproven") } else { name };
        assert_eq!(std::fs::read(name).unwrap(), &*file.bytes);
    }
    assert!(w.has_containing(" files"), "and the status line says so");
}

#[test]
fn a_list_of_numbers_colours_panels_one_by_one() {
    let mut w = Window::open(Some(&example("shell-256")));
    let series = Node::new("series").param("start", 10).param("step", 0.5).param("count", 256);
    w.app().model.edit(Operation::AddNode { id: "weights".into(), node: Box::new(series) });
    let short = Node::new("series").param("count", 255);
    w.app().model.edit(Operation::AddNode { id: "short".into(), node: Box::new(short) });
    w.settle();
    let plain = [0, 2].map(|k| mainly(&mut w, k));
    w.click(w.harness.get_by_value("plain").rect().center());
    assert!(!w.has_containing("short.numbers"), "a list of another length fits no panel");
    w.tap("weights.numbers");
    w.settle();
    assert_eq!(w.app().viewport.measure, Some(Measure::Numbers("weights.numbers".into())));
    assert_eq!(w.app().viewport.shown_range(), Some([10.0, 137.5]));
    let coloured = [0, 2].map(|k| mainly(&mut w, k));
    assert!((0..2).all(|k| coloured[k] > plain[k] + 500), "{plain:?} red and blue pixels, then {coloured:?}");
    w.picture("list-colours");
    // What is picked tells its own number.
    let part = w.app().model.results.drawings["thicken.panels"].parts[200].clone();
    let area = w.rect("viewport");
    let at = w.app().viewport.camera.project(area, part.centre).unwrap();
    w.click(at);
    let picked = w.app().viewport.picked.clone().unwrap();
    assert_eq!((picked.output.as_str(), picked.part), ("thicken.panels", 200));
}

#[test]
fn an_example_is_opened_by_its_picture_and_by_a_node_that_it_uses() {
    let mut w = Window::open(None);
    w.click(w.rect("Help").center());
    w.click(w.rect("Examples …").center());
    w.tap("three-strips");
    w.settle();
    let path = |w: &Window| w.harness.state().model.path().unwrap().to_owned();
    assert!(path(&w).ends_with("three-strips/three-strips.tenon.json"), "{:?}", path(&w));
    assert!(!w.has("quad-mesh"), "the examples are put away");
    assert!(!w.app().model.results.drawings.is_empty() && !w.app().model.unsaved());

    let text = r#"{ "format": "tenon", "version": 1, "nodes": { "m": { "type": "read_mesh", "v": 1 } } }"#;
    let mut w = Window::open(Some(&graph("menu-examples", text)));
    w.click(w.rect("node m").center());
    w.tap("Examples");
    w.settle();
    w.steps(20);
    w.tap("Open");
    w.settle();
    assert!(path(&w).ends_with("quad-mesh/quad-mesh.tenon.json"), "{:?}", path(&w));
    assert!(w.app().model.document().nodes().values().any(|n| n.type_name.as_str() == "read_mesh"));

    // Small examples lie many in a folder, so what is opened is a file.
    let text = r#"{ "format": "tenon", "version": 1, "nodes": { "m": { "type": "cross_reference", "v": 1 } } }"#;
    let mut w = Window::open(Some(&graph("menu-small-examples", text)));
    w.click(w.rect("node m").center());
    w.tap("Examples");
    w.settle();
    w.steps(20);
    w.tap("Open");
    w.settle();
    assert!(path(&w).ends_with("nodes/points.tenon.json"), "{:?}", path(&w));
    assert!(w.app().model.document().nodes().values().any(|n| n.type_name.as_str() == "cross_reference"));
}

#[test]
fn paste_in_the_menu_asks_the_desktop_for_the_clipboard() {
    let mut w = Window::open(None);
    w.click(w.rect("Edit").center());
    let at = w.rect_containing("Paste").center();
    w.press(at, at, Modifiers::NONE);
    let (button, modifiers) = (PointerButton::Primary, Modifiers::NONE);
    w.harness.event(Event::PointerButton { pos: at, button, pressed: false, modifiers });
    w.steps(1);
    let asked = w.harness.output().viewport_output.values().flat_map(|v| &v.commands);
    assert!(asked.into_iter().any(|c| matches!(c, ViewportCommand::RequestPaste)));
}
