//! What a user prefers, what is told once, and windows of the desktop.

use crate::common::{Window, folder, graph, misbehaving};
use eframe::egui::{Key, Modifiers, PointerButton, Theme, ThemePreference, vec2};
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, mpsc};
use std::time::{Duration, Instant};
use tenon_editor::app::dialogs::Dialogs;
use tenon_engine::Operation;

const ONE: &str = r#"{ "format": "tenon", "version": 1, "nodes": { "a": { "type": "number", "v": 1 } } }"#;

fn opened(name: &str) -> (Window, PathBuf) {
    let state = folder(&format!("{name}-state"));
    let mut w = Window::open(Some(&graph(name, ONE)));
    let ctx = w.harness.ctx.clone();
    w.app().remember_in(&ctx, Some(state.clone()));
    w.steps(3);
    (w, state)
}

fn choose(w: &mut Window, menu: &str, item: &str) {
    w.click(w.rect(menu).center());
    w.click(w.rect(item).center());
    w.key(Modifiers::NONE, Key::Escape);
    w.steps(4);
}

#[test]
fn theme_and_scale_are_taken_at_once_and_kept() {
    let (mut w, state) = opened("comfort");
    for (words, theme) in [("Light", Theme::Light), ("Dark", Theme::Dark)] {
        choose(&mut w, "View", words);
        assert_eq!(w.harness.ctx.theme(), theme);
    }
    let before = w.rect("File");
    choose(&mut w, "View", "125 %");
    assert!((w.harness.ctx.zoom_factor() - 1.25).abs() < 1e-6);
    let after = w.rect("File");
    assert!((after.height() - before.height()).abs() < 2.0, "points stay points: {before} {after}");
    let kept = std::fs::read_to_string(state.join("preferences.json")).unwrap();
    assert!(kept.contains("\"dark\"") && kept.contains("1.25"), "{kept}");
    let mut again = Window::open(None);
    let ctx = again.harness.ctx.clone();
    again.app().remember_in(&ctx, Some(state));
    again.steps(2);
    assert_eq!(ctx.theme(), Theme::Dark);
    assert!((ctx.zoom_factor() - 1.25).abs() < 1e-6);
}

#[test]
fn the_view_menu_sets_what_is_preferred() {
    let (mut w, state) = opened("preferred");
    let kept = || -> serde_json::Value {
        serde_json::from_str(&std::fs::read_to_string(state.join("preferences.json")).unwrap()).unwrap()
    };
    choose(&mut w, "View", "Dark");
    choose(&mut w, "View", "As the desktop");
    assert_eq!(w.harness.ctx.options(|o| o.theme_preference), ThemePreference::System);
    assert_eq!(kept()["theme"], "system");
    for (words, scale) in [("80 %", 0.8), ("150 %", 1.5), ("100 %", 1.0)] {
        choose(&mut w, "View", words);
        assert!((w.harness.ctx.zoom_factor() - scale).abs() < 1e-6, "{words}");
    }
    // Files are asked for by the desktop, or by the window itself.
    let asked = Arc::new(AtomicUsize::new(0));
    let count = asked.clone();
    w.app().dialogs = Dialogs::answered_by(move |_| {
        count.fetch_add(1, Ordering::SeqCst);
        None
    });
    choose(&mut w, "View", "File windows of the desktop");
    assert_eq!(kept()["desktop_dialogs"], false);
    w.key(Modifiers::COMMAND, Key::O);
    assert!(w.has("Open a graph") && asked.load(Ordering::SeqCst) == 0, "the window's own");
    w.key(Modifiers::NONE, Key::Escape);
    choose(&mut w, "View", "File windows of the desktop");
    assert_eq!(kept()["desktop_dialogs"], true);
    w.key(Modifiers::COMMAND, Key::O);
    let start = Instant::now();
    while !w.has("Open a graph") {
        assert!(start.elapsed() < Duration::from_secs(30), "nobody is asked");
        std::thread::sleep(Duration::from_millis(5));
        w.steps(1);
    }
    assert_eq!(asked.load(Ordering::SeqCst), 1, "the desktop is asked first, and answers nothing");
    w.key(Modifiers::NONE, Key::Escape);
    if cfg!(target_os = "linux") {
        for apart in [false, true] {
            choose(&mut w, "View", "Plugins in processes of their own");
            assert_eq!(kept()["plugins_apart"], apart);
        }
    }
    // What stands below and beside the canvas.
    for (tab, there) in [("Problems", "neither a wire nor a value"), ("Profile", "time of a")] {
        w.click(w.rect("View").center());
        // The entry of the menu lies over the button of the status line.
        w.click(w.first_containing(tab).center());
        w.steps(3);
        assert!(w.has_containing(there), "{tab}");
    }
}

#[test]
fn f1_shows_the_keys_and_puts_them_away() {
    let (mut w, _) = opened("keys");
    assert!(!w.has("Keys"));
    w.key(Modifiers::NONE, Key::F1);
    assert!(w.has("Keys"));
    w.picture("keys");
    w.key(Modifiers::NONE, Key::F1);
    assert!(!w.has("Keys"));
}

#[test]
fn that_the_processor_draws_is_told_once() {
    let (mut w, state) = opened("software");
    let told = "No graphics card was found: the processor draws. Large models turn slowly.";
    assert!(w.has(told), "these tests are drawn by Mesa's software adapter");
    w.picture("software");
    w.click(w.rect("I see").center());
    assert!(!w.has(told));
    let mut again = Window::open(None);
    let ctx = again.harness.ctx.clone();
    again.app().remember_in(&ctx, Some(state));
    again.steps(2);
    assert!(!again.has(told));
}

#[test]
fn the_desktop_is_asked_for_files_beside_the_window() {
    let (mut w, _) = opened("desktop");
    let path = folder("desktop-out").join("saved");
    let (go, gone) = mpsc::channel::<()>();
    let gone = Mutex::new(gone);
    let (answer, asked) = (path.clone(), Arc::new(AtomicUsize::new(0)));
    let count = asked.clone();
    w.app().dialogs = Dialogs::answered_by(move |wish| {
        count.fetch_add(1, Ordering::SeqCst);
        assert!(wish.name.ends_with(".tenon.json"), "a name is proposed: {}", wish.name);
        gone.lock().unwrap().recv().unwrap();
        Some(answer.clone())
    });
    w.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    assert!(!w.has("Save the graph"), "the window's own is not shown");
    // While it is open the window goes on, and no second one is opened.
    let add = w.app().model.new_node("number", [0.0, 0.0]).1;
    assert!(w.app().model.edit(add));
    w.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    w.steps(5);
    go.send(()).unwrap();
    let path = path.with_file_name("saved.tenon.json");
    let start = Instant::now();
    while !path.exists() {
        assert!(start.elapsed() < Duration::from_secs(30), "the answer is never taken");
        std::thread::sleep(Duration::from_millis(5));
        w.steps(1);
    }
    assert_eq!(asked.load(Ordering::SeqCst), 1);
    assert!(std::fs::read_to_string(&path).unwrap().contains("number"));
    assert_eq!(w.app().model.path(), Some(&*path));
}

#[test]
fn a_name_whose_ending_the_desktop_did_not_see_is_asked_for_once_more() {
    let (mut w, _) = opened("desktop-over");
    let there = folder("desktop-over-out").join("there.tenon.json");
    std::fs::write(&there, "precious").unwrap();
    let short = there.with_file_name("there");
    w.app().dialogs = Dialogs::answered_by(move |_| Some(short.clone()));
    w.key(Modifiers::COMMAND | Modifiers::SHIFT, Key::S);
    let start = Instant::now();
    while !w.has("Save the graph") {
        assert!(start.elapsed() < Duration::from_secs(60), "it is never asked for");
        std::thread::sleep(Duration::from_millis(5));
        w.steps(1);
    }
    assert_eq!(std::fs::read_to_string(&there).unwrap(), "precious");
}

#[test]
fn ctrl_q_never_closes_the_window() {
    let (mut w, _) = opened("ctrl-q");
    w.double_click(w.rect("input a.value").center());
    w.harness.input_mut().events.push(eframe::egui::Event::Key {
        key: Key::Q,
        physical_key: None,
        pressed: true,
        repeat: false,
        modifiers: Modifiers::COMMAND,
    });
    w.harness.step();
    let asked = w.harness.output().viewport_output.values().flat_map(|v| &v.commands);
    assert_eq!(asked.filter(|c| **c == eframe::egui::ViewportCommand::Close).count(), 0);
}

#[test]
fn where_no_desktop_answers_the_windows_own_browser_does() {
    let (mut w, _) = opened("nobody");
    w.app().dialogs = Dialogs::answered_by(|_| None);
    w.key(Modifiers::COMMAND, Key::O);
    let start = Instant::now();
    while !w.has("Open a graph") {
        assert!(start.elapsed() < Duration::from_secs(30), "it never comes");
        std::thread::sleep(Duration::from_millis(5));
        w.steps(1);
    }
    assert!(!w.app().dialogs.are_there(), "it is not asked again");
    w.click(w.rect("View").center());
    assert!(w.has("File windows of the desktop"), "the preference says so");
}

#[cfg(target_os = "linux")]
#[test]
fn a_plugin_that_crashes_leaves_the_window() {
    let (mut w, _) = opened("crash");
    w.app().model.host_plugins_by(Some(env!("CARGO_BIN_EXE_tenon-editor").into()));
    w.app().model.load_plugins(&[misbehaving("crashing")], &[]);
    w.settle();
    let (id, add) = w.app().model.new_node("misbehaving.doomed", [0.0, 0.0]);
    let set = |x: i32| Operation::SetParam { node: id.clone(), port: "x".into(), value: Some(x.into()) };
    assert!(w.app().model.edit(Operation::All(vec![add, set(101)])));
    w.settle();
    let told: Vec<String> = w.app().model.results.of_node(&id).map(|d| d.message.clone()).collect();
    assert!(told.iter().any(|m| m.contains("a segmentation fault")), "{told:?}");
    w.picture("plugin-died");
    // The next evaluation starts a new process.
    assert!(w.app().model.edit(set(1)));
    w.settle();
    assert_eq!(w.app().model.results.of_node(&id).count(), 0);
    assert!(w.app().model.results.values.contains_key(&format!("{id}.y")));
}

#[cfg(target_os = "linux")]
#[test]
fn a_plugin_that_spins_for_ever_holds_no_frame_is_stopped_by_escape_and_its_node_says_so() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "spin": { "type": "misbehaving.doomed", "v": 1, "params": { "x": 103 } },
    "other": { "type": "number", "v": 1 }
  }
}"#;
    let library = misbehaving("spinning");
    let mut w = Window::open(Some(&graph("spins", text)));
    w.app().model.run_plugins_apart(true);
    w.app().model.host_plugins_by(Some(env!("CARGO_BIN_EXE_tenon-editor").into()));
    w.drop_file(&library);
    let until = |w: &mut Window, label: &str| {
        let start = Instant::now();
        while !w.has(label) {
            assert!(start.elapsed() < Duration::from_secs(30), "{label} never comes");
            std::thread::sleep(Duration::from_millis(5));
            w.steps(1);
        }
    };
    until(&mut w, "Stop");
    // Meanwhile the canvas moves under the hand and values are typed.
    let before = w.rect("node spin");
    let empty = w.rect("canvas").left_bottom() + vec2(60.0, -60.0);
    w.drag_with(empty, empty + vec2(40.0, -30.0), PointerButton::Secondary, Modifiers::NONE);
    assert!(w.rect("node spin").center().distance(before.center() + vec2(40.0, -30.0)) < 1.0);
    assert!(w.has("Stop"), "it still spins");
    w.key(Modifiers::NONE, Key::Escape);
    until(&mut w, "stopped; F5 runs it again");
    w.picture("plugin-stopped");
    w.rest(w.rect("node spin").center());
    assert!(w.has_containing("stopped while it ran"), "the node says so");
    w.rest(w.rect("node other").center());
    assert!(!w.has_containing("stopped while it ran"), "and no other");
    // With a number that it bears it runs as if nothing had been.
    w.double_click(w.rect("input spin.x").center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("6.125");
    w.key(Modifiers::NONE, Key::Enter);
    w.settle();
    w.rest(w.rect("node spin").center());
    assert!(!w.has_containing("stopped while it ran"));
    w.rest(w.rect("output spin.y").center());
    assert!(w.has_containing("6.125"), "it has run");
}
