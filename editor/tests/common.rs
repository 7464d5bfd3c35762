//! The window of a test: opened, driven and drawn.

use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, Rect, Vec2, pos2, vec2};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable as _;
use serde_json::{Value as Json, json};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use tenon_editor::app::App;

/// A graph of which something is wrong, is missing, and is switched off.
pub const WRONG: &str = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "count": { "type": "number", "v": 1, "params": { "value": -5 } },
    "series": { "type": "series", "v": 1, "inputs": { "count": { "from": ["count.value"] } } },
    "point": { "type": "point", "v": 1, "inputs": { "x": { "from": ["series.numbers"] } } },
    "off": { "type": "number", "v": 1, "state": "disabled" },
    "unknown": { "type": "nobody.knows", "v": 1 }
  }
}"#;

/// A number, and a point at as much along X.
pub const TWO: &str = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "a": { "type": "number", "v": 1, "params": { "value": 3 } },
    "p": { "type": "point", "v": 1, "inputs": { "x": { "from": ["a.value"] } } }
  }
}"#;

/// A number that goes into a node of the plugin of misdeeds, which gives it on.
pub const TRUSTING: &str = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "n": { "type": "number", "v": 1, "params": { "value": 7.25 } },
    "p": { "type": "misbehaving.trusting", "v": 1, "inputs": { "x": { "from": ["n.value"] } } }
  }
}"#;

/// The shell, held to a proof so strict that it fails: tools that go over the edges of parts by no tenth of a millimetre leave
/// stock standing.
pub fn faulty_shell() -> PathBuf {
    let dir = example("shell-256");
    let file = dir.join("shell-256.tenon.json");
    let text = std::fs::read_to_string(&file).unwrap();
    let strict = r#""params": { "leftover": 0.000001, "gouge": 0.000001 }, "type": "prove""#;
    let strict = text.replace(r#""type": "prove""#, strict);
    assert_ne!(strict, text);
    std::fs::write(&file, strict).unwrap();
    dir
}

/// The repository.
pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// A folder of its own for a test, empty.
pub fn folder(name: &str) -> PathBuf {
    let dir = std::env::temp_dir().join(format!("tenon-editor-{}-{name}", std::process::id()));
    let _ = std::fs::remove_dir_all(&dir);
    std::fs::create_dir_all(&dir).unwrap();
    dir
}

/// A graph written to a file.
pub fn graph(name: &str, text: &str) -> PathBuf {
    let path = folder(name).join("graph.tenon.json");
    std::fs::write(&path, text).unwrap();
    path
}

/// A copy of an example graph with its inputs, so that nothing is left behind beside the example itself; and nothing that a
/// window has left there, such as unsaved work, comes along.
pub fn example(name: &str) -> PathBuf {
    fn copy(from: &Path, to: &Path) {
        std::fs::create_dir_all(to).unwrap();
        for entry in std::fs::read_dir(from).unwrap().map(|e| e.unwrap().path()) {
            let name = entry.file_name().unwrap();
            if name.to_string_lossy().starts_with('.') {
                continue;
            }
            let to = to.join(name);
            match entry.is_dir() {
                true => copy(&entry, &to),
                false => drop(std::fs::copy(&entry, &to).unwrap()),
            }
        }
    }
    static COUNT: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
    let count = COUNT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let to = folder(&format!("{name}-{count}"));
    copy(&root().join("graphs").join(name), &to);
    to
}

/// The shell of `shell-256` with 4 × 4 small panels on one board and no files, changed by `change` before it is written.
pub fn small_shell(name: &str, change: impl FnOnce(&mut Json)) -> PathBuf {
    let text = std::fs::read_to_string(root().join("graphs/shell-256/shell-256.tenon.json")).unwrap();
    let mut whole: Json = serde_json::from_str(&text).unwrap();
    whole.as_object_mut().unwrap().remove("interface");
    let nodes = &mut whole["nodes"];
    nodes.as_object_mut().unwrap().retain(|_, n| !n["type"].as_str().unwrap().starts_with("write"));
    for curve in ["arc", "folds"] {
        nodes[curve]["params"]["iterations"] = 2.into();
    }
    nodes["arc"]["params"]["points"] = json!([[0, 0, 0], [180, 0, 300], [720, 0, 300], [900, 0, 0]]);
    nodes["fold_2"]["params"] = json!({ "x": 20, "y": 240 });
    nodes["fold_3"]["params"] = json!({ "y": 480 });
    nodes["pack"]["params"] = json!({ "board_x": 1200, "board_y": 800 });
    change(nodes);
    graph(name, &whole.to_string())
}

/// The plugin of misdeeds, compiled here.
pub fn misbehaving(name: &str) -> PathBuf {
    misbehaving_by(name, &[])
}

/// The same, compiled with other options besides.
pub fn misbehaving_by(name: &str, options: &[&str]) -> PathBuf {
    let sdk = root().join("plugin-sdk");
    let library = folder(name).join("misbehaving").with_extension(std::env::consts::DLL_EXTENSION);
    let mut cc = std::process::Command::new("cc");
    cc.args(["-std=c11", "-shared", "-fPIC", "-pthread", "-DLOADABLE"])
        .args(options)
        .arg("-I")
        .arg(sdk.join("include"));
    let done = cc.arg(sdk.join("examples/misbehaving-c/misbehaving.c")).arg("-o").arg(&library).arg("-lm").output();
    let done = done.unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    library
}

/// Red, green and blue of a pixel.
pub fn rgb(picture: &image::RgbaImage, at: Pos2) -> [i32; 3] {
    let p = picture.get_pixel(at.x as u32, at.y as u32);
    [0, 1, 2].map(|k| i32::from(p[k]))
}

/// All pixels of a part of the window.
pub fn places(area: Rect) -> impl Iterator<Item = Pos2> {
    let [x, y] = [area.left() as u32..area.right() as u32, area.top() as u32..area.bottom() as u32];
    y.flat_map(move |y| x.clone().map(move |x| pos2(x as f32, y as f32)))
}

/// How many pixels of a part of a picture are as `is` says of red, green and blue.
pub fn pixels(picture: &image::RgbaImage, area: Rect, is: impl Fn([i32; 3]) -> bool) -> usize {
    places(area).filter(|at| is(rgb(picture, *at))).count()
}

/// The middle of all pixels that are as `is` says.
pub fn middle(picture: &image::RgbaImage, area: Rect, is: impl Fn([i32; 3]) -> bool) -> Option<Pos2> {
    let all: Vec<Pos2> = places(area).filter(|at| is(rgb(picture, *at))).collect();
    let sum = all.iter().fold(vec2(0.0, 0.0), |sum, at| sum + at.to_vec2());
    (!all.is_empty()).then(|| (sum / all.len() as f32).to_pos2())
}

/// Whether a colour is another one, within what drivers do to it.
pub fn like(p: [i32; 3], colour: [i32; 3]) -> bool {
    (0..3).all(|k| (p[k] - colour[k]).abs() <= 6)
}

/// A file as the desktop lets it fall on a window.
#[derive(Debug)]
struct Dropped(PathBuf);

impl eframe::egui::DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|e| e.to_string())
    }
}

/// The window, 1280 × 800, with `graph` open and evaluated.
pub struct Window {
    pub harness: Harness<'static, App>,
}

impl Window {
    pub fn open(graph: Option<&Path>) -> Self {
        Self::sized(graph, vec2(1280.0, 800.0))
    }

    pub fn sized(graph: Option<&Path>, size: Vec2) -> Self {
        let mut window = Self::unsettled(graph, size);
        window.settle();
        window
    }

    /// The window at once, whatever is still being evaluated.
    pub fn unsettled(graph: Option<&Path>, size: Vec2) -> Self {
        let mut setup = egui_kittest::wgpu::default_wgpu_setup();
        tenon_editor::viewport::write_directly(&mut setup);
        let builder = Harness::builder().with_size(size).with_max_steps(64).with_step_dt(1.0 / 60.0).wgpu_setup(setup);
        let harness = builder.build_eframe(|cc| App::new(cc, graph).unwrap());
        Self { harness }
    }

    pub fn app(&mut self) -> &mut App {
        self.harness.state_mut()
    }

    /// Lets the evaluation come to its end, and shows what it found. A minute is long enough for every graph here.
    pub fn settle(&mut self) {
        let start = Instant::now();
        self.steps(2);
        while !self.harness.state().settled() {
            assert!(start.elapsed() < Duration::from_secs(300), "the evaluation does not end");
            std::thread::sleep(Duration::from_millis(5));
            self.steps(1);
        }
        self.steps(3);
    }

    pub fn steps(&mut self, count: usize) {
        self.harness.run_steps(count);
    }

    /// Where something with a name is on screen.
    pub fn rect(&self, label: &str) -> Rect {
        self.harness.get_by_label(label).rect()
    }

    /// The first of several of that name.
    pub fn first(&self, label: &str) -> Rect {
        self.harness.get_all_by_label(label).next().unwrap().rect()
    }

    /// Where the only thing whose name has this in it is on screen.
    pub fn rect_containing(&self, label: &str) -> Rect {
        self.harness.get_by_label_contains(label).rect()
    }

    /// The uppermost of all whose name begins so.
    pub fn first_containing(&self, label: &str) -> Rect {
        let all = self.harness.get_all_by_label_contains(label).map(|n| n.rect());
        all.min_by(|a, b| a.top().total_cmp(&b.top())).unwrap()
    }

    pub fn has(&self, label: &str) -> bool {
        self.harness.query_by_label(label).is_some()
    }

    /// Presses Enter and looks at the frames that follow, one by one, for words that may stand in few of them.
    pub fn enter_shows(&mut self, words: &str) -> bool {
        let (key, modifiers) = (Key::Enter, Modifiers::NONE);
        let pressed = Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers };
        self.harness.input_mut().events.push(pressed);
        (0..4).any(|_| {
            self.harness.step();
            self.has_containing(words)
        })
    }

    pub fn hover(&mut self, at: Pos2) {
        self.harness.hover_at(at);
        self.steps(1);
    }

    fn button(&mut self, at: Pos2, button: PointerButton, pressed: bool, modifiers: Modifiers) {
        self.harness.event(Event::PointerButton { pos: at, button, pressed, modifiers });
        self.steps(1);
    }

    fn hold(&mut self, modifiers: Modifiers) {
        self.harness.event(Event::ModifiersChanged(modifiers));
    }

    pub fn click(&mut self, at: Pos2) {
        self.click_with(at, PointerButton::Primary, Modifiers::NONE);
    }

    pub fn click_with(&mut self, at: Pos2, button: PointerButton, modifiers: Modifiers) {
        self.hold(modifiers);
        self.hover(at);
        self.button(at, button, true, modifiers);
        self.button(at, button, false, modifiers);
        self.hold(Modifiers::NONE);
        self.steps(2);
    }

    pub fn double_click(&mut self, at: Pos2) {
        // Clicks that came before must not count.
        self.steps(30);
        self.click(at);
        self.click(at);
    }

    /// Presses, moves in steps, lets go.
    pub fn drag(&mut self, from: Pos2, to: Pos2) {
        self.drag_with(from, to, PointerButton::Primary, Modifiers::NONE);
    }

    pub fn drag_with(&mut self, from: Pos2, to: Pos2, button: PointerButton, modifiers: Modifiers) {
        self.hold(modifiers);
        self.hover(from);
        self.button(from, button, true, modifiers);
        for i in 1..=8 {
            self.hover(from + (to - from) * (i as f32 / 8.0));
        }
        self.button(to, button, false, modifiers);
        self.hold(Modifiers::NONE);
        self.steps(2);
    }

    /// Presses at the first corner, moves through the others, lets go at the last.
    pub fn path_with(&mut self, corners: &[Pos2], modifiers: Modifiers) {
        let (Some(first), Some(last)) = (corners.first(), corners.last()) else { return };
        self.hold(modifiers);
        self.hover(*first);
        self.button(*first, PointerButton::Primary, true, modifiers);
        for pair in corners.windows(2) {
            for i in 1..=8 {
                self.hover(pair[0] + (pair[1] - pair[0]) * (i as f32 / 8.0));
            }
        }
        self.button(*last, PointerButton::Primary, false, modifiers);
        self.hold(Modifiers::NONE);
        self.steps(2);
    }

    /// Turns the wheel over a place, by so many points; the view may take a while to follow.
    pub fn wheel(&mut self, at: Pos2, points: f32) {
        self.hover(at);
        let (unit, phase) = (eframe::egui::MouseWheelUnit::Point, eframe::egui::TouchPhase::Move);
        let (delta, modifiers) = (vec2(0.0, points), Modifiers::NONE);
        self.harness.event(Event::MouseWheel { unit, delta, phase, modifiers });
        self.steps(30);
    }

    /// Presses, moves to a place and holds there; [`Window::release`] lets go.
    pub fn press(&mut self, from: Pos2, to: Pos2, modifiers: Modifiers) {
        self.hold(modifiers);
        self.hover(from);
        self.button(from, PointerButton::Primary, true, modifiers);
        for i in 1..=8 {
            self.hover(from + (to - from) * (i as f32 / 8.0));
        }
        self.steps(1);
    }

    pub fn release(&mut self, at: Pos2) {
        self.button(at, PointerButton::Primary, false, Modifiers::NONE);
        self.hold(Modifiers::NONE);
        self.steps(2);
    }

    /// What an event, such as Ctrl+C or letting a button go, brings into the clipboard; the desktop makes these events of the keys.
    pub fn clipboard(&mut self, event: Event) -> String {
        self.harness.event(event);
        let start = Instant::now();
        loop {
            self.steps(1);
            let commands = &self.harness.output().platform_output.commands;
            let text = commands.iter().find_map(|c| match c {
                eframe::egui::OutputCommand::CopyText(text) => Some(text.clone()),
                _ => None,
            });
            // What is long is made beside the window.
            match text {
                Some(text) => return text,
                None if self.harness.state().settled() => return String::new(),
                None => assert!(start.elapsed() < Duration::from_secs(60), "nothing is copied"),
            }
        }
    }

    /// Rests with the pointer at a place until tooltips show.
    pub fn rest(&mut self, at: Pos2) {
        self.hover(at - vec2(2.0, 0.0));
        self.hover(at);
        self.steps(80);
    }

    pub fn has_containing(&self, label: &str) -> bool {
        self.harness.query_all_by_label_contains(label).next().is_some()
    }

    /// Brings something into sight and clicks it.
    pub fn tap(&mut self, label: &str) {
        self.harness.get_by_label(label).scroll_to_me();
        self.steps(30);
        self.click(self.rect(label).center());
    }

    /// A text field: its text becomes another, and Enter is pressed.
    pub fn fill(&mut self, label: &str, text: &str) {
        self.tap(label);
        self.key(Modifiers::COMMAND, Key::A);
        self.type_text(text);
        self.key(Modifiers::NONE, Key::Enter);
        self.steps(2);
    }

    pub fn key(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.steps(2);
    }

    pub fn type_text(&mut self, text: &str) {
        self.harness.event(Event::Text(text.to_owned()));
        self.steps(2);
    }

    /// Lets a file fall on the window.
    pub fn drop_file(&mut self, path: &Path) {
        self.harness.input_mut().dropped_files.push(std::sync::Arc::new(Dropped(path.to_owned())));
        self.steps(2);
    }

    /// The graph as its file would be.
    pub fn text(&self) -> String {
        self.harness.state().model.document().to_string_canonical()
    }

    /// The window as a picture, kept for people under target/editor.
    pub fn picture(&mut self, name: &str) -> image::RgbaImage {
        let image = self.harness.render().unwrap();
        let dir = root().join("target/editor");
        std::fs::create_dir_all(&dir).unwrap();
        image.save(dir.join(format!("{name}.png"))).unwrap();
        image
    }

    /// A parameter as text; empty if it is not set.
    pub fn param(&self, node: &str, port: &str) -> String {
        self.harness.state().model.param(node, port).map(|value| value.to_string()).unwrap_or_default()
    }
}
