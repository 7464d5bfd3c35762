//! The canvas by hand: finder, wires, moving, framing, typing, groups, states.

use crate::common::{Window, graph};
use eframe::egui::{Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::Queryable as _;
use tenon_engine::NodeState;

const TWO: &str = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "a": { "type": "number", "v": 1, "params": { "value": 3 } },
    "p": { "type": "point", "v": 1 }
  }
}"#;

/// A place of the canvas where nothing stands.
fn empty(w: &Window) -> Pos2 {
    w.rect("canvas").left_bottom() + vec2(60.0, -60.0)
}

#[test]
fn the_finder_adds_a_node_where_it_was_asked_for() {
    let mut w = Window::open(None);
    w.double_click(empty(&w));
    w.type_text("itera");
    w.picture("finder");
    w.key(Modifiers::NONE, Key::Enter);
    assert!(w.app().model.document().nodes().contains_key("ifs_curve"));
    assert!(w.app().model.selection.contains("ifs_curve"));
    w.settle();
    let (errors, _) = w.app().model.results.counts();
    assert!(errors > 0, "a curve without points says so");
    w.double_click(empty(&w) + vec2(0.0, -200.0));
    w.type_text("takagi");
    w.key(Modifiers::NONE, Key::Escape);
    assert_eq!(w.app().model.document().nodes().len(), 1, "Escape closes the finder");
}

#[test]
fn a_wire_is_drawn_replaced_and_taken_off() {
    let mut w = Window::open(Some(&graph("wire", TWO)));
    let out = w.rect("output a.value").right_center();
    let port = w.rect("input p.x").left_center();
    w.drag(out, port);
    let wires = |w: &Window, node: &str, port: &str| -> Vec<String> {
        let document = w.harness.state().model.document();
        document.nodes()[node]
            .inputs
            .get(port)
            .map_or_else(Vec::new, |w| w.from.iter().map(ToString::to_string).collect())
    };
    assert_eq!(wires(&w, "p", "x"), ["a.value"]);
    w.settle();
    let value = w.app().model.results.values["p.point"].to_json().to_string();
    assert!(value.contains("[3.0,0.0,0.0]"), "{value}");
    // From the input's side, too; and at an input for one item the new wire takes the old one's place.
    w.drag(w.rect("input p.y").left_center(), w.rect("output a.value").right_center());
    assert_eq!(wires(&w, "p", "y"), ["a.value"]);
    // A wire that does not fit is refused with the reason.
    w.drag(w.rect("output p.point").right_center(), w.rect("input a.value").left_center());
    assert_eq!(wires(&w, "a", "value"), [""; 0]);
    assert!(w.app().model.message.as_ref().unwrap().message.contains("brings point"));
    let port = w.rect("input p.x").left_center();
    w.drag_with(port, port + vec2(-20.0, 120.0), PointerButton::Primary, Modifiers::COMMAND);
    assert_eq!(wires(&w, "p", "x"), [""; 0]);
}

#[test]
fn a_wire_let_go_on_the_canvas_finds_a_node_and_connects_it() {
    let mut w = Window::open(Some(&graph("drop", TWO)));
    w.drag(w.rect("output p.point").right_center(), empty(&w));
    w.type_text("iterated");
    w.key(Modifiers::NONE, Key::Enter);
    let node = &w.app().model.document().nodes()["ifs_curve"];
    assert_eq!(node.inputs.get("points").unwrap().from.as_slice(), ["p.point"]);
    assert_eq!(w.app().model.steps(), (1, 0), "node and wire are one step");
}

#[test]
fn nodes_are_framed_moved_duplicated_and_deleted() {
    let mut w = Window::open(Some(&graph("move", TWO)));
    let canvas = w.rect("canvas");
    w.drag(canvas.left_top() + vec2(4.0, 4.0), canvas.right_bottom() - vec2(4.0, 4.0));
    assert_eq!(w.app().model.selection.len(), 2);
    let place = |w: &Window| w.harness.state().model.document().position("a").unwrap();
    let before = place(&w);
    let header = w.rect("node a").center();
    w.drag(header, header + vec2(50.0, 30.0));
    let after = place(&w);
    // The node that was taken lands on the grid, as near as can be to where it was let go.
    assert!(after.iter().all(|v| v.rem_euclid(10.0) == 0.0), "{after:?}");
    assert!((after[0] - before[0] - 50.0).abs() <= 5.0 && (after[1] - before[1] - 30.0).abs() <= 5.0, "{after:?}");
    w.key(Modifiers::COMMAND, Key::D);
    assert_eq!(w.app().model.document().nodes().keys().collect::<Vec<_>>(), ["a", "a-2", "p", "p-2"]);
    w.key(Modifiers::COMMAND, Key::G);
    assert_eq!(w.app().model.document().groups.len(), 1);
    w.picture("group");
    w.key(Modifiers::COMMAND, Key::A);
    w.click_with(w.rect("node a").center(), PointerButton::Secondary, Modifiers::NONE);
    let menu = w.harness.get_by_label_contains("Align").rect();
    w.click(menu.center());
    w.steps(5);
    w.click(w.rect("Left edges").center());
    let lefts: Vec<f64> = ["a", "a-2", "p", "p-2"].map(|n| w.app().model.document().position(n).unwrap()[0]).into();
    assert!(lefts.iter().all(|x| *x == lefts[0]), "{lefts:?}");
    w.key(Modifiers::COMMAND, Key::Z);
    w.app().model.selection = ["a-2".to_owned(), "p-2".to_owned()].into();
    w.key(Modifiers::NONE, Key::Delete);
    assert_eq!(w.app().model.document().nodes().keys().collect::<Vec<_>>(), ["a", "p"]);
    for _ in 0..4 {
        w.key(Modifiers::COMMAND, Key::Z);
    }
    assert_eq!(place(&w), before);
}

#[test]
fn copied_nodes_go_through_the_clipboard_into_another_graph() {
    let mut w = Window::open(Some(&graph("copy", TWO)));
    w.key(Modifiers::COMMAND, Key::A);
    let text = w.app().model.copy().unwrap();
    let mut other = Window::open(None);
    other.harness.event(eframe::egui::Event::Paste(text));
    other.steps(2);
    assert_eq!(other.app().model.document().nodes().keys().collect::<Vec<_>>(), ["a", "p"]);
    assert_eq!(other.param("a", "value"), "3");
    other.harness.event(eframe::egui::Event::Paste("no graph".into()));
    other.steps(2);
    assert!(other.app().model.message.is_some());
}

#[test]
fn values_and_names_are_typed_on_the_canvas() {
    let mut w = Window::open(Some(&graph("type", TWO)));
    w.double_click(w.rect("input p.x").center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("2 cm");
    w.key(Modifiers::NONE, Key::Enter);
    assert_eq!(w.param("p", "x"), "\"2 cm\"");
    w.double_click(w.rect("node p").center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("corner");
    w.key(Modifiers::NONE, Key::Enter);
    assert!(w.app().model.document().nodes().contains_key("corner"));
    w.settle();
    let value = w.app().model.results.values["corner.point"].to_json().to_string();
    assert!(value.contains("[20.0,0.0,0.0]"), "{value}");
}

#[test]
fn the_menu_switches_nodes_off() {
    let mut w = Window::open(Some(&graph("menu", TWO)));
    w.click_with(w.rect("node a").center(), PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Disable").center());
    assert_eq!(w.app().model.document().nodes()["a"].state, NodeState::Disabled);
}

#[test]
fn an_unknown_node_keeps_its_wires_and_says_what_it_is() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "p": { "type": "point", "v": 1, "inputs": { "x": { "from": ["ghost.size"] } } },
    "ghost": { "type": "from_the_future", "v": 3, "params": { "shape": "round" } }
  }
}"#;
    let mut w = Window::open(Some(&graph("unknown", text)));
    assert!(w.has("output ghost.size") && w.has("input ghost.shape") && w.has("input p.x"));
    assert_eq!(w.app().canvas.shapes.wires.len(), 1);
    assert!(w.app().canvas.shapes.wires[0].source.is_some());
    assert!(w.app().model.results.counts().0 > 0);
    w.picture("unknown");
}

#[test]
fn small_windows_work() {
    let mut w = Window::sized(Some(&graph("small", TWO)), vec2(640.0, 480.0));
    assert!(w.has("node a"));
    w.picture("small");
}

#[test]
fn groups_are_named_coloured_and_moved_by_their_title() {
    let mut w = Window::open(Some(&graph("groups", TWO)));
    w.key(Modifiers::COMMAND, Key::A);
    w.key(Modifiers::COMMAND, Key::G);
    w.app().model.selection.clear();
    w.app().canvas.show_all();
    w.steps(2);
    w.double_click(w.rect("group group 1").left_center() + vec2(20.0, 0.0));
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("Support");
    w.key(Modifiers::NONE, Key::Enter);
    let title = w.rect("group Support").left_center() + vec2(20.0, 0.0);
    w.click_with(title, PointerButton::Secondary, Modifiers::NONE);
    let colour = w.harness.get_by_label_contains("Colour").rect();
    w.click(colour.center());
    w.steps(5);
    w.click(w.rect("Green").center());
    let group = w.app().model.document().groups["group 1"].clone();
    assert_eq!(group["colour"], "#78be5a");
    assert_eq!(group["title"], "Support");
    let place = |w: &Window| w.harness.state().model.document().position("p").unwrap();
    let before = place(&w);
    w.drag(title, title + vec2(60.0, 40.0));
    let (zoom, after) = (f64::from(w.app().canvas.view.zoom), place(&w));
    assert!((after[0] - before[0] - 60.0 / zoom).abs() < 11.0 && after[1] > before[1], "{before:?} {after:?}");
    w.picture("group-colour");
    // A title that is left as it was is no step, and what was taken back can still be done again.
    w.key(Modifiers::COMMAND, Key::Z);
    let steps = w.app().model.steps();
    w.double_click(title);
    w.key(Modifiers::NONE, Key::Enter);
    assert_eq!(w.app().model.steps(), steps);
    w.key(Modifiers::COMMAND, Key::Y);
    let text = w.text();
    for _ in 0..4 {
        w.key(Modifiers::COMMAND, Key::Z);
    }
    assert!(w.app().model.document().groups.is_empty());
    for _ in 0..4 {
        w.key(Modifiers::COMMAND, Key::Y);
    }
    assert_eq!(w.text(), text);
}

#[test]
fn notes_stand_on_the_canvas_and_say_what_was_typed() {
    let mut w = Window::open(Some(&graph("note", TWO)));
    w.click_with(empty(&w), PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Write a note").center());
    w.type_text("The arc spans 4.5 m.\nIts supports are level.");
    w.key(Modifiers::COMMAND, Key::Enter);
    assert_eq!(w.param("note", "text"), "\"The arc spans 4.5 m.\\nIts supports are level.\"");
    w.settle();
    assert_eq!(w.app().model.results.counts(), (0, 0), "{:?}", w.app().model.results.diagnostics);
    w.picture("note");
    w.double_click(w.rect("node note").center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("Shorter.");
    w.click(empty(&w) + vec2(0.0, -200.0));
    assert_eq!(w.param("note", "text"), "\"Shorter.\"");
}

#[test]
fn wires_are_led_through_points_without_changing_a_result() {
    let mut w = Window::open(Some(&graph("reroute", TWO)));
    let header = w.rect("node p").center();
    w.drag(header, header + vec2(200.0, 100.0));
    w.drag(w.rect("output a.value").right_center(), w.rect("input p.x").left_center());
    w.settle();
    let value = |w: &Window| w.harness.state().model.results.values["p.point"].to_json();
    let before = value(&w);
    let (from, to) = (w.rect("output a.value").right_center(), w.rect("input p.x").left_center());
    w.double_click(from + (to - from) / 2.0);
    let document = w.app().model.document();
    assert_eq!(document.nodes()["reroute"].inputs.get("value").unwrap().from.as_slice(), ["a.value"]);
    assert_eq!(document.nodes()["p"].inputs.get("x").unwrap().from.as_slice(), ["reroute.value"]);
    w.settle();
    assert_eq!(value(&w), before);
    // It is moved like a node, and its ends take wires.
    let point = w.rect("node reroute").center();
    w.drag(point, point + vec2(-60.0, -50.0));
    w.drag(w.rect("output reroute.value").right_center(), w.rect("input p.y").left_center());
    assert_eq!(w.app().model.document().nodes()["p"].inputs.get("y").unwrap().from.as_slice(), ["reroute.value"]);
    w.settle();
    w.picture("reroute");
    assert_eq!(w.app().model.results.counts(), (0, 0), "{:?}", w.app().model.results.diagnostics);
    // A wire is taken away by its menu.
    let (a, b) = (w.rect("output reroute.value").right_center(), w.rect("input p.y").left_center());
    let reach = vec2(((b.x - a.x).abs() * 0.5).max((b.y - a.y).abs() * 0.25).clamp(18.0, 240.0), 0.0);
    let wire = [a, a + reach, b - reach, b];
    let curve = eframe::egui::epaint::CubicBezierShape::from_points_stroke(
        wire,
        false,
        Default::default(),
        eframe::egui::Stroke::NONE,
    );
    w.click_with(curve.sample(0.7), PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Remove it").center());
    assert!(w.app().model.document().nodes()["p"].inputs.get("y").is_none_or(|i| i.from.is_empty()));
}

#[test]
fn a_lasso_selects_what_it_goes_around() {
    let mut w = Window::open(Some(&graph("lasso", TWO)));
    let node = w.rect("node p");
    let (a, b) = (node.left_top() - vec2(30.0, 40.0), node.right_bottom() + vec2(30.0, 140.0));
    let alt = Modifiers { alt: true, ..Modifiers::NONE };
    w.path_with(&[a, eframe::egui::pos2(b.x, a.y), b, eframe::egui::pos2(a.x, b.y)], alt);
    assert_eq!(w.app().model.selection.iter().collect::<Vec<_>>(), ["p"]);
}

#[test]
fn keys_switch_previews_and_states() {
    let mut w = Window::open(Some(&graph("states", TWO)));
    let state = |w: &Window| w.harness.state().model.document().nodes()["p"].state;
    w.click(w.rect("node p").center());
    w.key(Modifiers::COMMAND, Key::E);
    assert_eq!(state(&w), NodeState::Disabled);
    w.key(Modifiers::COMMAND, Key::E);
    assert_eq!(state(&w), NodeState::On);
    w.key(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::E);
    assert_eq!(state(&w), NodeState::Frozen);
    w.key(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::E);
    w.settle();
    assert!(w.app().model.results.drawings.contains_key("p.point"));
    w.key(Modifiers::COMMAND, Key::Q);
    w.settle();
    assert!(!w.app().model.results.drawings.contains_key("p.point"));
}

#[test]
fn a_single_point_is_edited_by_its_coordinates() {
    let text = r#"{ "format": "tenon", "version": 1, "nodes": { "pl": { "type": "plane", "v": 1 } } }"#;
    let mut w = Window::open(Some(&graph("single", text)));
    w.double_click(w.rect("input pl.origin").center());
    w.steps(2);
    assert!(w.has("pl.origin") && !w.has("Add a row"), "one point has no rows");
    let cell = w.rect("y of 1").center();
    w.drag(cell, cell + vec2(30.0, 0.0));
    let point: Vec<f64> = serde_json::from_str(&w.param("pl", "origin")).unwrap();
    assert!(point[0] == 0.0 && point[1] > 10.0 && point[2] == 0.0, "{point:?}");
    assert_eq!(w.app().model.steps().0, 1);
    w.picture("single-point");
    w.settle();
    assert_eq!(w.app().model.results.counts().0, 0, "{:?}", w.app().model.results.diagnostics);
}

#[test]
fn the_finder_finds_by_letters_categories_and_keywords_and_says_what_a_node_does() {
    let mut w = Window::open(None);
    let of = |w: &mut Window, name: &str| w.app().model.catalog.get(name).unwrap().clone();
    let (curve, pack) = (of(&mut w, "ifs_curve"), of(&mut w, "pack"));
    assert!(!pack.title.to_lowercase().contains(&pack.category.to_lowercase()));
    for (typed, node) in [("itcrv", &curve), ("takagi", &curve), (pack.category.as_str(), &pack)] {
        w.double_click(empty(&w));
        assert!(w.app().canvas.is_typing());
        w.type_text("no such thing");
        assert!(w.has("nothing has that name") && !w.has(&node.title));
        w.key(Modifiers::COMMAND, Key::A);
        w.type_text(typed);
        assert!(w.has(&node.title), "{typed} finds {}", node.title);
        let first = w.app().model.catalog.find(typed, |_| true)[0].doc.clone();
        assert!(w.has(&first), "what the first of {typed} does stands below");
        w.key(Modifiers::NONE, Key::Escape);
    }
}

#[test]
fn the_finder_of_a_wire_offers_only_what_the_wire_fits() {
    let mut w = Window::open(Some(&graph("unfit", TWO)));
    let title = w.app().model.catalog.get("pack").unwrap().title.clone();
    w.double_click(empty(&w));
    w.type_text("pack");
    assert!(w.has(&title), "without a wire it is there");
    w.key(Modifiers::NONE, Key::Escape);
    w.steps(30);
    w.drag(w.rect("output p.point").right_center(), empty(&w));
    assert!(w.app().canvas.is_typing());
    w.type_text("pack");
    assert!(!w.has(&title), "a point is no part");
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("ifs_curve");
    assert!(w.has(&w.harness.state().model.catalog.get("ifs_curve").unwrap().title));
}

#[test]
fn points_at_an_input_are_edited_as_a_table() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": { "c": { "type": "ifs_curve", "v": 1, "params": { "points": [[0, 0, 0], [100, 50, 0]] } } }
}"#;
    let mut w = Window::open(Some(&graph("table", text)));
    w.double_click(w.rect("input c.points").center());
    w.click(w.rect("Add a row").center());
    assert_eq!(w.param("c", "points"), "[[0,0,0],[100,50,0],[200,100,0]]");
    let cell = w.rect("y of 3");
    w.drag(cell.center(), cell.center() + vec2(30.0, 0.0));
    let points: serde_json::Value = serde_json::from_str(&w.param("c", "points")).unwrap();
    assert!(points[2][1].as_f64().unwrap() > 110.0, "{points}");
    assert_eq!(w.app().model.steps().0, 2, "turning is one step");
    let cell = w.rect("weight of 2");
    w.drag(cell.center(), cell.center() + vec2(40.0, 0.0));
    let weights: serde_json::Value = serde_json::from_str(&w.param("c", "weights")).unwrap();
    assert!(weights[1].as_f64().unwrap() > 1.1 && weights[0] == 1, "{weights}");
    w.picture("table");
    w.settle();
    assert_eq!(w.app().model.results.counts().0, 0, "{:?}", w.app().model.results.diagnostics);
}

#[test]
fn points_at_an_input_are_drawn_and_dragged_put_in_and_taken_away() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": { "c": { "type": "ifs_curve", "v": 1, "params": { "points": [[0, 5, 0], [400, 5, 300], [1000, 5, 0]] } } }
}"#;
    let mut w = Window::open(Some(&graph("drawing", text)));
    w.double_click(w.rect("input c.points").center());
    w.settle();
    let points = |w: &Window| -> Vec<[f64; 3]> { serde_json::from_str(&w.param("c", "points")).unwrap() };
    let handle = |w: &Window, i: usize| w.rect(&format!("point {i} in the drawing")).center();
    // Seen from the front, where they spread most: y stays.
    let (a, b, top) = (handle(&w, 1), handle(&w, 3), handle(&w, 2));
    assert!(a.y == b.y && top.y < a.y && a.x < top.x && top.x < b.x);
    w.drag(top, top - vec2(0.0, 12.0));
    w.settle();
    let higher = points(&w)[1];
    assert!(higher[0] == 400.0 && higher[1] == 5.0 && higher[2] > 310.0, "{higher:?}");
    assert_eq!(w.app().model.steps().0, 1, "dragging is one step");
    w.drag_with(handle(&w, 2), handle(&w, 2) + vec2(11.0, 7.0), PointerButton::Primary, Modifiers::SHIFT);
    w.settle();
    let on_grid = points(&w)[1];
    assert!(on_grid[0] % 10.0 == 0.0 && on_grid[2] % 10.0 == 0.0 && on_grid != higher, "{on_grid:?}");
    let between = handle(&w, 1).lerp(handle(&w, 2), 0.5);
    w.double_click(between);
    assert_eq!(points(&w).len(), 4);
    let new = points(&w)[1];
    assert!((new[0] - on_grid[0] / 2.0).abs() < 20.0 && new[1] == 5.0, "{new:?} lies between the first two");
    w.settle();
    w.picture("drawing");
    w.click_with(handle(&w, 2), PointerButton::Secondary, Modifiers::NONE);
    assert_eq!(points(&w).len(), 3);
    assert!(points(&w)[1] == on_grid && w.app().model.results.counts().0 == 0);
    w.click(w.rect("from above").center());
    w.steps(2);
    assert!(handle(&w, 1).y == handle(&w, 2).y, "all have the same y");
}

#[test]
fn wires_from_nodes_that_were_not_copied_stay_where_they_were() {
    let wired = TWO.replace(
        r#""type": "point", "v": 1"#,
        r#""type": "point", "v": 1, "inputs": { "x": { "from": ["a.value"] } }"#,
    );
    let mut w = Window::open(Some(&graph("copied-wires", &wired)));
    w.app().model.selection = ["p".to_owned()].into();
    let text = w.app().model.copy().unwrap();
    let paste = |w: &mut Window| {
        w.harness.event(eframe::egui::Event::Paste(text.clone()));
        w.steps(2);
        let id = w.app().model.selection.first().cloned().unwrap();
        w.app().model.document().nodes()[&id].inputs.values().map(|i| i.from.len()).sum::<usize>()
    };
    assert_eq!(paste(&mut w), 1, "beside what it was copied from it is wired as that");
    // Another graph has an `a`, too, which is another one.
    let mut other = Window::open(Some(&graph("copied-elsewhere", TWO)));
    assert_eq!(paste(&mut other), 0);
    w.app().open(&graph("copied-later", TWO));
    w.settle();
    assert_eq!(paste(&mut w), 0);
}

#[test]
fn a_long_text_is_work_while_it_is_typed() {
    let path = graph("long-text", TWO);
    let mut w = Window::open(Some(&path));
    w.click_with(empty(&w), PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Write a note").center());
    let steps = w.app().model.steps().0;
    w.type_text("The arc ");
    w.type_text("spans 4.5 m.");
    assert!(w.app().model.unsaved());
    w.key(Modifiers::COMMAND, Key::S);
    assert!(std::fs::read_to_string(&path).unwrap().contains("spans 4.5 m."));
    w.type_text(" And more.");
    assert!(w.app().model.unsaved());
    let (kept, start) = (w.app().model.kept_path().unwrap(), std::time::Instant::now());
    while !std::fs::read_to_string(&kept).is_ok_and(|text| text.contains("spans 4.5 m. And more.")) {
        assert!(start.elapsed().as_secs() < 60, "it is not kept");
        std::thread::sleep(std::time::Duration::from_millis(20));
        w.steps(1);
    }
    // What else is done meanwhile is a step of its own.
    let out = w.rect("node a").center();
    w.drag(out, out + vec2(0.0, 40.0));
    w.app().model.undo();
    w.key(Modifiers::COMMAND, Key::Enter);
    assert_eq!(w.param("note", "text"), "\"The arc spans 4.5 m. And more.\"");
    assert_eq!(w.app().model.steps().0, steps + 2, "one step until it was saved, and one after that");
    // Escape gives up what was typed last.
    w.double_click(w.rect("node note").center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("Nothing.");
    w.key(Modifiers::NONE, Key::Escape);
    assert_eq!(w.param("note", "text"), "\"The arc spans 4.5 m. And more.\"");
    // So is what stands in a short field when the graph is saved.
    w.double_click(w.rect("input a.value").center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("17.5");
    w.key(Modifiers::COMMAND, Key::S);
    assert!(std::fs::read_to_string(&path).unwrap().contains("17.5"));
}

#[test]
fn nodes_that_come_without_a_place_get_one() {
    let mut w = Window::open(Some(&graph("homeless", TWO)));
    for id in ["x", "y", "z"] {
        let node = Box::new(tenon_engine::Node::new("point"));
        w.app().model.apply(tenon_engine::Operation::AddNode { id: id.into(), node }).unwrap();
    }
    w.steps(2);
    let all: Vec<_> = w.app().canvas.shapes.nodes.iter().map(|n| n.rect).collect();
    for (i, a) in all.iter().enumerate() {
        assert!(all[..i].iter().all(|b| !a.intersects(*b)), "{all:?}");
    }
    assert!(w.app().model.unsaved());
    for _ in 0..3 {
        w.app().model.undo();
        w.steps(1);
    }
    assert!(!w.app().model.unsaved(), "it is as it was opened");
}
