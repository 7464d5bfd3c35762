//! Saving under another name, leaving unsaved work, and all the ways by which another graph is opened.

use crate::common::{Window, example, folder, graph};
use eframe::egui::{Key, Modifiers, ViewportCommand, ViewportEvent, ViewportId};
use std::path::Path;
use tenon_engine::Operation;

fn with(value: i32) -> String {
    format!(
        "{{\n  \"format\": \"tenon\",\n  \"nodes\": {{\n    \"a\": {{\n      \"params\": {{\n        \"value\": {value}\n      }},\n      \
         \"type\": \"number\",\n      \"v\": 1\n    }}\n  }},\n  \"units\": \"mm\",\n  \"version\": 1\n}}\n"
    )
}

fn set(w: &mut Window, value: i32) {
    let set = Operation::SetParam { node: "a".into(), port: "value".into(), value: Some(value.into()) };
    assert!(w.app().model.edit(set));
}

/// Types a path into the file window, which has the keyboard, and confirms it.
fn name(w: &mut Window, path: &Path) {
    w.steps(2);
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text(&path.display().to_string());
    w.key(Modifiers::NONE, Key::Enter);
}

/// What the window asked of the desktop in its last frame.
fn commands(w: &Window) -> Vec<ViewportCommand> {
    w.harness.output().viewport_output.values().flat_map(|v| v.commands.clone()).collect()
}

/// The desktop's button that closes the window; what the window says to it.
fn close(w: &mut Window) -> Vec<ViewportCommand> {
    w.harness.input_mut().viewports.entry(ViewportId::ROOT).or_default().events.push(ViewportEvent::Close);
    w.harness.step();
    let said = commands(w);
    w.harness.input_mut().viewports.entry(ViewportId::ROOT).or_default().events.clear();
    w.steps(2);
    said
}

#[test]
fn a_graph_is_saved_under_another_name_and_over_a_file_only_when_told_twice() {
    let path = graph("as", &with(3));
    let other = path.with_file_name("other.tenon.json");
    std::fs::write(&other, "precious").unwrap();
    let mut w = Window::open(Some(&path));
    set(&mut w, 7);
    w.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    assert!(w.has("Save the graph"));
    name(&mut w, &other);
    assert!(w.has("Write over it"), "it is asked first");
    assert_eq!(std::fs::read_to_string(&other).unwrap(), "precious");
    w.click(w.rect("Write over it").center());
    assert_eq!(std::fs::read_to_string(&other).unwrap(), with(7));
    assert_eq!(std::fs::read_to_string(&path).unwrap(), with(3), "the first file stays");
    assert_eq!(w.app().model.path(), Some(&*other));
    assert!(!w.app().model.unsaved() && !w.has("Save the graph"));
    // A name without an ending gets it, and Esc leaves everything.
    w.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    name(&mut w, &path.with_file_name("third"));
    assert_eq!(std::fs::read_to_string(path.with_file_name("third.tenon.json")).unwrap(), with(7));
    w.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    w.key(Modifiers::NONE, Key::Escape);
    assert!(!w.has("Save the graph"));
    assert!(w.app().model.path().unwrap().ends_with("third.tenon.json"));
}

#[test]
fn unsaved_work_is_left_only_when_somebody_says_so() {
    let path = graph("leave", &with(3));
    let mut w = Window::open(Some(&path));
    set(&mut w, 7);
    let asked = "The graph has changes that are not saved";
    for answer in ["Cancel", "Discard changes", "Save"] {
        w.key(Modifiers::COMMAND, Key::N);
        assert!(w.has(asked), "{answer}");
        w.picture("leaving");
        w.click(w.rect(answer).center());
        w.steps(2);
        assert!(!w.has(asked), "{answer}");
        let there = w.app().model.path().is_some();
        assert_eq!(there, answer == "Cancel", "{answer}");
        let saved = std::fs::read_to_string(&path).unwrap();
        assert_eq!(saved, if answer == "Save" { with(8) } else { with(3) }, "{answer}");
        if answer == "Discard changes" {
            w.app().open(&path);
            w.steps(2);
            assert_eq!(w.param("a", "value"), "3", "what was discarded is gone");
            set(&mut w, 8);
        }
    }
    // What is saved is left without a word.
    w.app().open(&path);
    w.steps(2);
    w.key(Modifiers::COMMAND, Key::N);
    assert!(!w.has(asked) && w.app().model.path().is_none());
}

#[test]
fn the_window_closes_at_once_but_not_over_unsaved_work() {
    let path = graph("close", &with(3));
    let mut w = Window::open(Some(&path));
    assert!(!close(&mut w).contains(&ViewportCommand::CancelClose), "nothing is unsaved");
    set(&mut w, 7);
    assert!(close(&mut w).contains(&ViewportCommand::CancelClose));
    assert!(w.has("The graph has changes that are not saved"));
    w.click(w.rect("Cancel").center());
    assert_eq!(w.param("a", "value"), "7");
    assert!(close(&mut w).contains(&ViewportCommand::CancelClose), "it is asked anew");
    let discard = w.rect("Discard changes").center();
    w.hover(discard);
    for pressed in [true, false] {
        let (button, modifiers) = (eframe::egui::PointerButton::Primary, Modifiers::NONE);
        w.harness.event(eframe::egui::Event::PointerButton { pos: discard, button, pressed, modifiers });
        w.harness.step();
    }
    assert!(commands(&w).contains(&ViewportCommand::Close), "then it goes: {:?}", commands(&w));
    // The desktop brings that back as the wish to close, which nothing stops any more.
    assert!(!close(&mut w).contains(&ViewportCommand::CancelClose));
    assert!(!w.has("The graph has changes that are not saved"));
    std::thread::sleep(std::time::Duration::from_millis(1000));
    w.steps(3);
    assert!(!w.app().model.kept_path().unwrap().exists(), "what was discarded is not kept");
    assert_eq!(std::fs::read_to_string(&path).unwrap(), with(3));
}

#[test]
fn a_graph_that_is_dropped_is_opened_after_the_question() {
    let (path, other) = (graph("drop-a", &with(3)), graph("drop-b", &with(5)));
    let mut w = Window::open(Some(&path));
    w.drop_file(&other);
    assert_eq!(w.param("a", "value"), "5");
    set(&mut w, 6);
    w.drop_file(&path);
    assert_eq!(w.param("a", "value"), "6", "it is asked first");
    w.click(w.rect("Save").center());
    assert_eq!(w.param("a", "value"), "3");
    assert_eq!(std::fs::read_to_string(&other).unwrap(), with(6));
}

#[test]
fn recent_graphs_and_examples_are_opened_from_their_lists() {
    let state = folder("lists");
    let (path, other) = (graph("recent-a", &with(3)), graph("recent-b", &with(5)));
    let mut w = Window::open(Some(&path));
    let ctx = w.harness.ctx.clone();
    w.app().remember_in(&ctx, Some(state));
    w.app().open(&other);
    w.steps(2);
    assert_eq!(w.param("a", "value"), "5");
    w.click(w.rect("File").center());
    // A menu inside a menu opens under the pointer.
    w.hover(w.first_containing("Open recent").center());
    w.steps(30);
    let row = path.canonicalize().unwrap().display().to_string();
    w.picture("recent");
    w.click(w.rect(&row).center());
    assert_eq!(w.param("a", "value"), "3");

    w.click(w.rect("Help").center());
    w.click(w.rect("Examples …").center());
    w.steps(3);
    w.click(w.first("quad-mesh").center());
    assert!(w.app().model.path().is_some_and(|p| p.ends_with("quad-mesh.tenon.json")));
    assert!(!w.has("three-strips"), "the list is closed");
    w.key(Modifiers::COMMAND, Key::O);
    name(&mut w, &example("three-strips"));
    assert!(w.app().model.path().is_some_and(|p| p.ends_with("three-strips.tenon.json")));
}
