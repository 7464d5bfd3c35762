//! Opening, saving, and what must not be lost.

use crate::common::{TRUSTING, Window, example, folder, graph, misbehaving, root};
use eframe::egui::{Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use tenon_engine::Operation;

const SMALL: &str = "{\n  \"format\": \"tenon\",\n  \"nodes\": {\n    \"a\": {\n      \"params\": {\n        \"value\": 3\n      },\n      \"type\": \"number\",\n      \"v\": 1\n    }\n  },\n  \"version\": 1\n}\n";

#[test]
fn a_graph_is_saved_as_it_was_and_its_layout_beside_it() {
    let dir = folder("save");
    let original = root().join("graphs/quad-mesh/quad-mesh.tenon.json");
    let copy = dir.join("copy.tenon.json");
    std::fs::copy(&original, &copy).unwrap();
    std::fs::copy(root().join("graphs/quad-mesh/canopy.obj"), dir.join("canopy.obj")).unwrap();
    let mut w = Window::open(Some(&copy));
    assert_eq!(w.app().model.results.counts().0, 0, "{:?}", w.app().model.results.diagnostics);
    w.key(Modifiers::COMMAND, Key::S);
    assert_eq!(std::fs::read(&copy).unwrap(), std::fs::read(&original).unwrap());
    let layout = std::fs::read_to_string(dir.join("copy.layout.json")).unwrap();
    assert!(layout.contains("\"thicken\""), "{layout}");
    let places = |w: &Window| w.harness.state().model.document().layout_to_string();
    let before = places(&w);
    let again = Window::open(Some(&copy));
    assert_eq!(places(&again), before);
}

#[test]
fn a_graph_opened_right_after_another_is_no_unsaved_work() {
    let mut w = Window::open(Some(&graph("before", SMALL)));
    // Its nodes have no places yet, and what is known of the graph before it must not count for it.
    let next = graph("after", SMALL);
    let four = Operation::SetParam { node: "a".into(), port: "value".into(), value: Some(4.into()) };
    assert!(w.app().model.edit(four) && w.app().model.undo() && !w.app().model.unsaved());
    w.app().open(&next);
    assert!(!w.app().model.seems_unsaved());
    for _ in 0..5 {
        w.steps(1);
        let kept = w.app().model.kept_path().unwrap();
        assert!(!kept.exists(), "nothing is kept of a graph that nobody has changed");
        assert!(!w.app().model.seems_unsaved());
    }
    let again = Window::open(Some(&next));
    assert_eq!(again.harness.state().model.left_behind(), None);
}

#[test]
fn a_file_that_is_no_graph_leaves_everything_as_it_was() {
    let mut w = Window::open(None);
    let bad = graph("bad", "{ \"format\": \"tenon\", ");
    w.app().open(&bad);
    w.steps(2);
    let message = w.app().model.message.clone().unwrap().message;
    assert!(message.contains("was not opened") && message.contains("line 1"), "{message}");
    assert_eq!(std::fs::read_to_string(&bad).unwrap(), "{ \"format\": \"tenon\", ");
    assert_eq!(w.app().model.path(), None, "what could not be read is never written over");
}

#[test]
fn of_a_broken_graph_what_can_be_read_is_opened_and_the_file_stays() {
    let whole = std::fs::read_to_string(root().join("graphs/shell-256/shell-256.tenon.json")).unwrap();
    let half = &whole[..whole.len() / 2];
    let bad = graph("half", half);
    let mut w = Window::open(Some(&bad));
    assert!(w.app().model.document().nodes().contains_key("arc"), "{:?}", w.app().model.message);
    let message = w.app().model.message.clone().unwrap();
    assert!(message.message.contains("could be read"), "{}", message.message);
    assert_eq!(w.app().model.path(), None);
    assert!(w.app().model.unsaved(), "it is no file's content");
    // It stays in sight, whatever is done meanwhile.
    let told = message.message.clone();
    w.key(Modifiers::COMMAND, Key::A);
    w.key(Modifiers::COMMAND, Key::D);
    assert!(w.app().model.message.is_none() && w.has(&told));
    w.picture("salvaged");
    w.click(w.rect("Put away").center());
    assert!(!w.has(&told));
    w.key(Modifiers::COMMAND, Key::S);
    assert!(w.has("Save the graph"), "a name is asked for");
    assert_eq!(std::fs::read_to_string(&bad).unwrap(), half);
}

#[test]
fn the_files_of_the_graph_are_written_as_the_command_line_writes_them() {
    let mut w = Window::open(Some(&example("quad-mesh")));
    let out = folder("export").join("out");
    w.app().model.export(&out).unwrap();
    w.settle();
    let written = std::fs::read_dir(&out).unwrap().count();
    // The manifest stands beside them.
    assert!(written > 2 && w.has_containing(&format!("{} files written into", written - 1)), "{written}");
    for (_, file) in &w.app().model.results.files {
        let name = out.join(&*file.name);
        let name = if file.withheld.is_some() { name.with_added_extension("unproven") } else { name };
        assert_eq!(std::fs::read(name).unwrap(), &*file.bytes);
    }
}

#[test]
fn a_mesh_that_is_dropped_becomes_a_node_that_reads_it() {
    let mut w = Window::open(Some(&graph("drop-mesh", SMALL)));
    let folder = w.app().model.path().unwrap().parent().unwrap().to_owned();
    let mesh = folder.join("canopy.obj");
    std::fs::copy(root().join("graphs/quad-mesh/canopy.obj"), &mesh).unwrap();
    w.drop_file(&mesh);
    assert_eq!(w.param("read_mesh", "path"), "\"canopy.obj\"");
    w.settle();
    assert!(w.app().model.results.drawings.contains_key("read_mesh.mesh"));
}

#[test]
fn the_file_of_a_node_is_chosen_by_hand() {
    let text = r#"{ "format": "tenon", "version": 1, "nodes": { "m": { "type": "read_mesh", "v": 1 } } }"#;
    let path = graph("pick-mesh", text);
    std::fs::copy(root().join("graphs/quad-mesh/canopy.obj"), path.with_file_name("canopy.obj")).unwrap();
    let mut w = Window::open(Some(&path));
    w.double_click(w.rect("input m.path").center());
    w.click(w.rect("…").center());
    w.steps(2);
    assert!(w.has("Choose a file"));
    w.click(w.rect("canopy.obj").center());
    w.click(w.rect("Take").center());
    assert_eq!(w.param("m", "path"), "\"canopy.obj\"");
    assert!(!w.has("Choose a file"));
    w.settle();
    assert!(w.app().model.results.drawings.contains_key("m.mesh"), "{:?}", w.app().model.results.diagnostics);
}

#[test]
fn what_a_missing_plugin_would_bring_is_told_at_the_node() {
    let text = r#"{
  "format": "tenon",
  "nodes": {
    "fix": { "type": "cams.cam_connector", "v": 1, "params": { "distance": 200 } },
    "n": { "type": "number", "v": 1 }
  },
  "requires": { "cams": ">=0.1" },
  "version": 1
}"#;
    let mut w = Window::open(Some(&graph("missing", text)));
    let all = w.app().model.results.diagnostics.clone();
    assert!(all.iter().any(|d| d.message.contains("plugin cams")), "{all:?}");
    let at_node = w.app().model.results.of_node("fix").find_map(|d| d.hint.clone());
    assert!(at_node.is_some_and(|hint| hint.contains("cams")), "{all:?}");
    w.picture("missing-plugin");
    // A library that is no plugin is refused, and everything stays.
    let path = w.app().model.path().unwrap().with_file_name(format!("bad.{}", std::env::consts::DLL_EXTENSION));
    std::fs::write(&path, "no library").unwrap();
    w.drop_file(&path);
    w.settle();
    assert!(w.app().model.message.as_ref().unwrap().message.contains("bad."), "{:?}", w.app().model.message);
    assert!(w.app().model.catalog.get("thicken").is_some());
}

#[test]
fn a_plugin_is_loaded_by_letting_its_library_fall_on_the_window_and_by_the_menu() {
    for (by_menu, name) in [(false, "plugin-dropped"), (true, "plugin-by-menu")] {
        let library = misbehaving(name);
        let mut w = Window::open(Some(&graph(&format!("{name}-graph"), TRUSTING)));
        assert!(w.has("problems of p"), "its type is not known");
        if by_menu {
            w.click(w.rect("File").center());
            w.click(w.rect("Load a plugin …").center());
            w.steps(2);
            w.key(Modifiers::COMMAND, Key::A);
            w.type_text(&library.to_string_lossy());
            w.key(Modifiers::NONE, Key::Enter);
        } else {
            w.drop_file(&library);
        }
        w.settle();
        assert!(!w.has("problems of p"), "{:?}", w.app().model.results.diagnostics);
        w.rest(w.rect("output p.y").center());
        assert!(w.has_containing("7.25"), "it has run");
        // Its nodes are found.
        w.click(w.rect("Add node").center());
        w.type_text("takes memory for granted");
        w.key(Modifiers::NONE, Key::Enter);
        assert!(w.has("node misbehaving_trusting"), "{:?}", w.app().model.selection);
    }
}

/// Shows frames until something is so; at most a minute.
fn until(w: &mut Window, mut so: impl FnMut(&mut Window) -> bool) {
    let start = std::time::Instant::now();
    while !so(w) {
        assert!(start.elapsed().as_secs() < 60, "it never came to be");
        std::thread::sleep(std::time::Duration::from_millis(20));
        w.steps(1);
    }
}

#[test]
fn work_that_was_not_saved_is_found_again() {
    let path = graph("kept", SMALL);
    let kept = path.with_file_name(".graph.tenon.json.unsaved");
    let mut w = Window::open(Some(&path));
    let set = |w: &mut Window, value: i32| {
        let set = Operation::SetParam { node: "a".into(), port: "value".into(), value: Some(value.into()) };
        assert!(w.app().model.edit(set));
    };
    set(&mut w, 7);
    until(&mut w, |_| kept.exists());
    // The window goes without a word, as when it is killed.
    drop(w);
    assert_eq!(std::fs::read_to_string(&path).unwrap(), SMALL, "the graph's own file is as it was");

    let mut w = Window::open(Some(&path));
    assert_eq!(w.param("a", "value"), "3");
    w.click(w.rect("Recover it").center());
    assert_eq!(w.param("a", "value"), "7");
    assert!(w.app().model.unsaved());
    w.key(Modifiers::COMMAND, Key::S);
    assert!(!kept.exists() && std::fs::read_to_string(&path).unwrap().contains("\"value\": 7"));

    // What was done and undone leaves nothing behind.
    set(&mut w, 8);
    until(&mut w, |_| kept.exists());
    w.key(Modifiers::COMMAND, Key::Z);
    until(&mut w, |_| !kept.exists());
}

#[test]
fn work_that_was_left_behind_stays_until_the_question_is_answered() {
    let (path, other) = (graph("asked", SMALL), graph("asked-other", SMALL));
    let kept = path.with_file_name(".graph.tenon.json.unsaved");
    std::fs::write(&kept, SMALL.replace("\"value\": 3", "\"value\": 7")).unwrap();
    let mut w = Window::open(Some(&path));
    assert!(w.has("Recover it"));
    for key in [Key::S, Key::N, Key::O, Key::A] {
        w.key(Modifiers::COMMAND, key);
    }
    w.key(Modifiers::NONE, Key::Delete);
    w.drop_file(&other);
    w.steps(3);
    assert!(kept.exists() && w.has("Recover it") && w.param("a", "value") == "3");
    assert_eq!(w.app().model.message.as_ref().unwrap().code, "question-open");
    w.click(w.rect("Recover it").center());
    assert_eq!(w.param("a", "value"), "7");
}

#[test]
fn work_that_cannot_be_read_is_put_aside_and_what_follows_is_kept() {
    let path = graph("torn", SMALL);
    let kept = path.with_file_name(".graph.tenon.json.unsaved");
    std::fs::write(&kept, "{ \"format\": \"tenon\", \"nodes\": {").unwrap();
    let mut w = Window::open(Some(&path));
    w.click(w.rect("Recover it").center());
    let aside = path.with_file_name(".graph.tenon.json.unsaved-1");
    let told = w.app().model.message.clone().unwrap();
    assert!(aside.exists() && told.hint.as_ref().unwrap().contains("unsaved-1"), "{told:?}");
    let set = Operation::SetParam { node: "a".into(), port: "value".into(), value: Some(9.into()) };
    assert!(w.app().model.edit(set));
    until(&mut w, |_| std::fs::read_to_string(&kept).is_ok_and(|text| text.contains("\"value\": 9")));
}

#[test]
fn work_on_a_graph_whose_folder_takes_no_file_is_kept_in_the_state_folder() {
    let (path, state) = (graph("read-only", SMALL), folder("read-only-state"));
    // A folder stands where the file would be.
    std::fs::create_dir(path.with_file_name(".graph.tenon.json.unsaved")).unwrap();
    let open = || {
        let mut w = Window::open(Some(&path));
        let ctx = w.harness.ctx.clone();
        w.app().remember_in(&ctx, Some(state.clone()));
        w.steps(2);
        w
    };
    let kept = |value: &str| {
        let all = std::fs::read_dir(&state).unwrap().filter_map(|e| std::fs::read_to_string(e.unwrap().path()).ok());
        all.filter(|text| text.contains(&format!("\"value\": {value}"))).count()
    };
    let set = |w: &mut Window, value: i32| {
        let set = Operation::SetParam { node: "a".into(), port: "value".into(), value: Some(value.into()) };
        assert!(w.app().model.edit(set));
    };
    let mut w = open();
    set(&mut w, 71);
    until(&mut w, |_| kept("71") == 1);
    assert!(w.app().model.message.is_none(), "it is kept: {:?}", w.app().model.message);
    // It is killed, and the work is offered; what is thrown away is gone.
    drop(w);
    let mut w = open();
    w.click(w.rect("Recover it").center());
    assert_eq!(w.param("a", "value"), "71");
    set(&mut w, 72);
    until(&mut w, |_| kept("72") == 1);
    w.key(Modifiers::COMMAND, Key::S);
    assert_eq!((kept("71"), kept("72")), (0, 0), "what is saved is not kept any more");
    drop(w);
    let w = open();
    assert!(!w.has("Recover it") && w.param("a", "value") == "72");
}

#[test]
fn a_file_that_another_program_has_broken_is_told() {
    let path = graph("broken-elsewhere", SMALL);
    let mut w = Window::open(Some(&path));
    std::fs::write(&path, format!("<<<<<<< HEAD\n{SMALL}")).unwrap();
    until(&mut w, |w| w.app().model.message.as_ref().is_some_and(|m| m.code == "changed-elsewhere"));
    let told = w.app().model.message.clone().unwrap();
    assert!(told.message.contains("is no graph") && told.hint.as_ref().unwrap().contains("line 1"), "{told:?}");
    assert_eq!((w.param("a", "value"), w.app().model.steps()), ("3".to_owned(), (0, 0)));
}

#[test]
fn a_change_by_another_program_is_a_step_that_can_be_undone() {
    let path = graph("elsewhere", SMALL);
    let mut w = Window::open(Some(&path));
    std::fs::write(&path, SMALL.replace("\"value\": 3", "\"value\": 44")).unwrap();
    until(&mut w, |w| w.param("a", "value") == "44");
    assert!(!w.app().model.unsaved());
    assert_eq!(w.app().model.steps(), (1, 0));
    // With changes on both sides nothing is taken, and it is told.
    w.key(Modifiers::COMMAND, Key::Z);
    std::fs::write(&path, SMALL.replace("\"value\": 3", "\"value\": 5555")).unwrap();
    until(&mut w, |w| w.app().model.message.as_ref().is_some_and(|m| m.code == "changed-elsewhere"));
    assert_eq!(w.param("a", "value"), "3");
}

#[test]
fn a_change_by_another_program_wakes_a_window_that_rests() {
    let path = graph("rests", SMALL);
    let mut w = Window::open(Some(&path));
    let start = std::time::Instant::now();
    let ctx = w.harness.ctx.clone();
    while ctx.has_requested_repaint() {
        assert!(start.elapsed().as_secs() < 20, "it never rests");
        w.steps(1);
    }
    // A second of rest at least, so that nothing but the change can wake it.
    std::thread::sleep(std::time::Duration::from_millis(1200));
    assert!(!ctx.has_requested_repaint());
    std::fs::write(&path, SMALL.replace("\"value\": 3", "\"value\": 44")).unwrap();
    while !ctx.has_requested_repaint() {
        assert!(start.elapsed().as_secs() < 60, "nobody wakes it");
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    w.steps(1);
    assert_eq!(w.param("a", "value"), "44");
}

#[test]
fn windows_without_a_file_keep_their_work_apart_and_find_only_orphans() {
    let state = folder("apart");
    let begin = |value: i32| {
        let mut w = Window::open(None);
        let ctx = w.harness.ctx.clone();
        w.app().remember_in(&ctx, Some(state.clone()));
        w.steps(2);
        if value > 0 {
            assert!(!w.has("Recover it"), "the work of a window that lives is not offered");
            let (id, add) = w.app().model.new_node("number", [0.0, 0.0]);
            let set = Operation::SetParam { node: id, port: "value".into(), value: Some(value.into()) };
            assert!(w.app().model.edit(Operation::All(vec![add, set])));
            let kept = w.app().model.kept_path().unwrap();
            until(&mut w, |_| kept.exists());
        }
        w
    };
    let first = begin(11);
    let mut second = begin(22);
    // The second leaves its work on purpose; that of the first stays.
    second.key(Modifiers::COMMAND, Key::N);
    second.click(second.rect("Discard changes").center());
    let text = |w: &Window| std::fs::read_to_string(w.harness.state().model.kept_path().unwrap()).unwrap();
    assert!(text(&first).contains("11"));
    drop(second);
    // The first dies: now there is an orphan.
    drop(first);
    let mut heir = begin(0);
    heir.click(heir.rect("Recover it").center());
    assert_eq!(heir.param("number", "value"), "11");
    drop(heir);
}

#[test]
fn graphs_that_were_opened_are_remembered() {
    let state = folder("state");
    let path = graph("recent", SMALL);
    let mut w = Window::open(Some(&path));
    let ctx = w.harness.ctx.clone();
    w.app().remember_in(&ctx, Some(state.clone()));
    assert_eq!(w.app().model.recent(), [path.canonicalize().unwrap()]);
    w.click(w.rect("File").center());
    let new = w.harness.get_by_label_contains("New").rect();
    w.click(new.center());
    assert_eq!(w.app().model.path(), None);
    assert_eq!(w.app().model.recent().len(), 1);
}
