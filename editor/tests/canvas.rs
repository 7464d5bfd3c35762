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
    assert_eq!([after[0] - before[0], after[1] - before[1]], [50.0, 30.0]);
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
