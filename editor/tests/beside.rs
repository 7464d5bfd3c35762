//! What takes long goes on beside the window, which says so: plugins that are loaded, files that are written, examples that are
//! read.

use crate::common::{TRUSTING, Window, example, folder, graph, misbehaving_by};
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// A library that says who it is when its gate is opened. Whoever waits for it would wait until a minute is over.
struct Late {
    library: PathBuf,
    gate: PathBuf,
}

impl Late {
    fn new(name: &str) -> Self {
        let gate = folder(&format!("{name}-gate")).join("open");
        let library = misbehaving_by(name, &[&format!("-DLATE=\"{}\"", gate.display())]);
        let late = gate.clone();
        std::thread::spawn(move || {
            std::thread::sleep(Duration::from_secs(60));
            let _ = std::fs::write(late, "late");
        });
        Self { library, gate }
    }

    fn assert_nobody_waited(&self) {
        assert!(!self.gate.exists(), "it was waited for");
    }

    fn open(&self) {
        self.assert_nobody_waited();
        std::fs::write(&self.gate, "").unwrap();
    }

    fn close(&self) {
        std::fs::remove_file(&self.gate).unwrap();
    }
}

/// Shows frames until something is told no more.
fn frames_while(w: &mut Window, told: &str) {
    let start = Instant::now();
    while w.has_containing(told) {
        assert!(start.elapsed() < Duration::from_secs(60), "{told} stays");
        w.harness.step();
        std::thread::sleep(Duration::from_millis(10));
    }
}

fn load_late(w: &mut Window, library: &Path) {
    w.drop_file(library);
    assert!(w.has_containing("loading misbehaving"), "the status line says so");
}

#[test]
fn a_library_that_is_slow_to_say_who_it_is_holds_no_frame() {
    for apart in [false, cfg!(target_os = "linux")] {
        let late = Late::new(&format!("late-{apart}"));
        let mut w = Window::open(Some(&graph(&format!("late-graph-{apart}"), TRUSTING)));
        w.app().model.run_plugins_apart(apart);
        w.app().model.host_plugins_by(Some(env!("CARGO_BIN_EXE_tenon-editor").into()));
        load_late(&mut w, &late.library);
        w.picture("plugin-loading");
        assert!(w.has("problems of p"), "until then its nodes are unknown");
        // The graph is worked on meanwhile, and another library is asked for.
        w.double_click(w.rect("input n.value").center());
        w.key(Modifiers::COMMAND, Key::A);
        w.type_text("3.5");
        w.key(Modifiers::NONE, Key::Enter);
        let bad = folder(&format!("late-bad-{apart}")).join("bad").with_extension(std::env::consts::DLL_EXTENSION);
        std::fs::write(&bad, "no library").unwrap();
        w.drop_file(&bad);
        w.steps(20);
        assert!(w.has_containing("loading misbehaving"));
        late.open();
        frames_while(&mut w, "loading misbehaving");
        w.settle();
        assert!(w.app().model.message.as_ref().unwrap().message.contains("bad."), "{:?}", w.app().model.message);
        assert!(!w.has("problems of p"), "{:?}", w.app().model.results.diagnostics);
        w.rest(w.rect("output p.y").center());
        assert!(w.has_containing("3.5"), "it has run with what was typed");
        assert!(w.app().model.unsaved());
        w.app().model.undo();
        assert!(!w.app().model.unsaved(), "nothing else has changed");
    }
}

#[test]
fn what_a_graph_requires_is_loaded_beside_the_window() {
    let late = Late::new("late-required");
    let mut w = Window::open(None);
    w.app().model.load_plugins(std::slice::from_ref(&late.library), &[]);
    late.open();
    w.settle();
    late.close();
    let requires = r#""requires": { "misbehaving": "*" },"#;
    let path = graph("late-requires", &TRUSTING.replacen('{', &format!("{{ {requires}"), 1));
    w.app().open(&path);
    w.steps(2);
    while !w.has("problems of p") {
        assert!(w.has_containing("loading misbehaving"), "until it is there its nodes are unknown");
        std::thread::sleep(Duration::from_millis(5));
        w.steps(1);
    }
    late.open();
    w.settle();
    assert!(!w.has("problems of p"), "{:?}", w.app().model.results.diagnostics);
    assert!(!w.app().model.unsaved());
    // Another graph that requires the same finds it there.
    let again = graph("late-again", &TRUSTING.replacen('{', &format!("{{ {requires}"), 1));
    w.app().open(&again);
    w.steps(2);
    assert!(!w.has_containing("loading "));
}

#[test]
fn files_are_written_beside_the_window_which_says_so() {
    let mut w = Window::open(Some(&example("quad-mesh")));
    let out = folder("beside-export").join("out");
    w.click(w.rect("File").center());
    w.click(w.rect("Export the files …").center());
    w.steps(2);
    w.type_text(&out.to_string_lossy());
    assert!(w.enter_shows("writing files into"));
    w.settle();
    let count = std::fs::read_dir(&out).unwrap().count();
    assert!(w.has_containing(&format!("{} files written into", count - 1)));
    // What goes wrong is told as ever.
    let taken = folder("beside-taken").join("file");
    std::fs::write(&taken, "").unwrap();
    w.app().model.export(&taken).unwrap();
    assert!(w.app().model.export(&out).is_err(), "one at a time");
    w.settle();
    assert!(w.app().model.message.is_some());
}

#[test]
fn examples_are_read_beside_the_window() {
    let mut w = Window::open(Some(&example("shell-256")));
    w.app().model.selection = ["thicken".to_owned()].into();
    w.steps(3);
    w.harness.get_by_label("Examples").scroll_to_me();
    w.steps(5);
    let at = w.rect("Examples").center();
    w.hover(at);
    for pressed in [true, false] {
        let (button, modifiers) = (eframe::egui::PointerButton::Primary, Modifiers::NONE);
        w.harness.event(eframe::egui::Event::PointerButton { pos: at, button, pressed, modifiers });
        w.harness.step();
    }
    for _ in 0..30 {
        if w.has("The example graphs are being read …") {
            w.settle();
            w.steps(30);
            assert!(w.has_containing("thicken in "));
            return;
        }
        assert!(!w.has_containing("thicken in "), "it was waited for");
        w.harness.step();
    }
    panic!("nothing is told");
}
