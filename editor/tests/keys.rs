//! What is done often is done by keys, and by the bindings of Grasshopper where they exist.

use crate::common::{Window, graph};
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::Queryable as _;

const CHAIN: &str = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "a": { "type": "number", "v": 1, "params": { "value": 3 } },
    "b": { "type": "number", "v": 1, "inputs": { "value": { "from": ["a.value"] } } },
    "c": { "type": "number", "v": 1, "inputs": { "value": { "from": ["b.value"] } } },
    "p": { "type": "point", "v": 1, "inputs": { "x": { "from": ["c.value"] } } },
    "q": { "type": "point", "v": 1 }
  }
}"#;

const SHIFT: Modifiers = Modifiers::SHIFT;
const ALT: Modifiers = Modifiers::ALT;

fn both() -> Modifiers {
    Modifiers::COMMAND.plus(SHIFT)
}

fn empty(w: &Window) -> Pos2 {
    w.rect("canvas").left_bottom() + vec2(60.0, -60.0)
}

fn selected(w: &Window) -> Vec<String> {
    w.harness.state().model.selection.iter().cloned().collect()
}

fn choose(w: &mut Window, ids: &[&str]) {
    w.app().model.selection = ids.iter().map(|id| (*id).to_owned()).collect();
    w.steps(1);
}

fn sources(w: &Window, node: &str, port: &str) -> Vec<String> {
    let wires = w.harness.state().model.document().nodes()[node].inputs.get(port).cloned().unwrap_or_default();
    wires.from.iter().map(ToString::to_string).collect()
}

#[test]
fn keys_open_the_finder_rename_and_go_through_what_is_found() {
    let mut w = Window::open(Some(&graph("keys", CHAIN)));
    w.hover(empty(&w));
    w.key(Modifiers::NONE, Key::F4);
    w.type_text("point");
    w.key(Modifiers::NONE, Key::ArrowDown);
    w.key(Modifiers::NONE, Key::ArrowDown);
    w.key(Modifiers::NONE, Key::ArrowUp);
    let found = w.app().model.catalog.find("point", |_| true)[1].type_name.clone();
    w.key(Modifiers::NONE, Key::Enter);
    let id = selected(&w)[0].clone();
    assert_eq!(w.app().model.document().nodes()[&id].type_name, *found, "the second of the list");
    w.key(Modifiers::NONE, Key::F2);
    w.type_text("corner");
    w.key(Modifiers::NONE, Key::Enter);
    assert_eq!(selected(&w), ["corner"]);
    // With the pointer elsewhere it comes into the middle of the canvas.
    w.hover(w.rect("File").center());
    w.key(Modifiers::NONE, Key::F4);
    w.type_text("reroute");
    w.key(Modifiers::NONE, Key::Enter);
    let (new, canvas) = (w.rect("node reroute"), w.rect("canvas"));
    assert!((new.center() - canvas.center()).length() < 60.0, "{new:?} in {canvas:?}");
    w.key(Modifiers::NONE, Key::Delete);
    // What is found is clicked, too.
    w.hover(empty(&w) + vec2(0.0, -100.0));
    w.key(Modifiers::COMMAND, Key::Space);
    w.type_text("reroute");
    w.picture("finder-by-key");
    w.click(w.rect("Reroute").center());
    assert!(w.app().model.document().nodes().contains_key("reroute"));
}

#[test]
fn a_node_of_the_graph_is_found_by_name_type_text_and_remark() {
    let text = CHAIN.replace(
        r#""q": { "type": "point", "v": 1 }"#,
        r#""q": { "type": "point", "v": 1, "note": "the apex" },
    "said": { "type": "text", "v": 1, "params": { "value": "larch" } },
    "words": { "type": "note", "v": 1, "params": { "text": "Begin here." } }"#,
    );
    let mut w = Window::open(Some(&graph("search", &text)));
    let mut find = |typed: &str| {
        choose(&mut w, &[]);
        w.key(Modifiers::NONE, Key::F3);
        w.type_text(typed);
        w.picture("search");
        w.key(Modifiers::NONE, Key::Enter);
        w.steps(2);
        let found = selected(&w);
        let at = w.first_containing(&format!("node {}", found[0]));
        assert!(w.rect("canvas").contains(at.center()), "{found:?} is in sight");
        found
    };
    assert_eq!(find("b"), ["b"]);
    assert_eq!(find("Point"), ["p"], "the first of a type");
    assert_eq!(find("APEX"), ["q"]);
    assert_eq!(find("begin"), ["words"]);
    assert_eq!(find("larch"), ["said"]);
    // The second of two by the arrow; and Escape leaves everything as it was.
    w.key(Modifiers::NONE, Key::F3);
    w.type_text("point");
    w.key(Modifiers::NONE, Key::ArrowDown);
    w.key(Modifiers::NONE, Key::Enter);
    assert_eq!(selected(&w), ["q"]);
    w.key(Modifiers::NONE, Key::F3);
    w.type_text("a");
    w.key(Modifiers::NONE, Key::Escape);
    assert_eq!((selected(&w), w.app().model.steps()), (vec!["q".to_owned()], (0, 0)));
}

#[test]
fn keys_open_what_stands_below_the_canvas_and_beside_it() {
    let mut w = Window::open(Some(&graph("tabs", CHAIN)));
    let words = [(Key::Num1, "Nothing is wrong."), (Key::Num2, "of work; the longest chain takes")];
    let more = [(Key::Num3, "Select one node to see"), (Key::Num4, "The pieces appear once")];
    for (key, words) in words.into_iter().chain(more) {
        w.key(ALT, key);
        assert!(w.has_containing(words), "{words}");
        w.key(ALT, key);
        assert!(!w.has_containing(words), "{words}, after it was closed");
    }
    w.key(ALT, Key::Num6);
    assert!(w.has_containing("The boards appear once"));
    w.key(ALT, Key::Num5);
    assert!(!w.has_containing("The boards appear once"));
}

#[test]
fn groups_are_made_and_dissolved_by_keys() {
    let mut w = Window::open(Some(&graph("ungroup", CHAIN)));
    let before = w.text();
    choose(&mut w, &["a", "b"]);
    w.key(Modifiers::COMMAND, Key::G);
    assert_eq!(w.app().model.document().groups.len(), 1);
    // Another node is added to it by the menu of its title.
    w.app().canvas.show_all();
    choose(&mut w, &["c"]);
    w.key(Modifiers::NONE, Key::Home);
    choose(&mut w, &["c"]);
    let title = w.rect("group group 1").left_center() + vec2(20.0, 0.0);
    w.click_with(title, PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Add what is selected").center());
    assert_eq!(w.app().model.document().groups["group 1"]["nodes"].as_array().unwrap().len(), 3);
    // One goes out, then all.
    choose(&mut w, &["c"]);
    w.key(both(), Key::G);
    assert_eq!(w.app().model.document().groups["group 1"]["nodes"].as_array().unwrap().len(), 2);
    choose(&mut w, &["a", "b"]);
    w.key(both(), Key::G);
    assert!(w.app().model.document().groups.is_empty());
    w.key(Modifiers::COMMAND, Key::Z);
    let title = w.rect("group group 1").left_center() + vec2(20.0, 0.0);
    w.click_with(title, PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Dissolve").center());
    assert!(w.app().model.document().groups.is_empty());
    assert_eq!(w.text(), before);
}

#[test]
fn nodes_are_nudged_and_copied_by_dragging_with_alt() {
    let mut w = Window::open(Some(&graph("nudge", CHAIN)));
    let place = |w: &Window, id: &str| w.harness.state().model.document().position(id).unwrap();
    choose(&mut w, &["q"]);
    let [x, y] = place(&w, "q");
    w.key(Modifiers::NONE, Key::ArrowRight);
    w.key(Modifiers::NONE, Key::ArrowDown);
    w.key(SHIFT, Key::ArrowDown);
    assert_eq!(place(&w, "q"), [x + 10.0, y + 11.0]);
    // A node that stands off the grid comes onto it, wherever the others stand.
    let title = w.rect("node q").center();
    w.drag(title, title + vec2(0.0, 33.0));
    let [_, y] = place(&w, "q");
    assert_eq!(y.rem_euclid(10.0), 0.0);
    let steps = w.app().model.steps().0;
    let title = w.rect("node q").center();
    w.drag_with(title, title + vec2(60.0, 80.0), PointerButton::Primary, ALT);
    assert_eq!(selected(&w), ["q-2"]);
    assert!(place(&w, "q-2")[1] > place(&w, "q")[1], "the copy has gone, the node stays");
    assert_eq!(w.app().model.steps().0, steps + 1);
}

#[test]
fn selection_grows_along_the_wires() {
    let mut w = Window::open(Some(&graph("along", CHAIN)));
    choose(&mut w, &["c"]);
    w.key(Modifiers::COMMAND, Key::ArrowLeft);
    assert_eq!(selected(&w), ["a", "b", "c"]);
    choose(&mut w, &["b"]);
    w.key(Modifiers::COMMAND, Key::ArrowRight);
    assert_eq!(selected(&w), ["b", "c", "p"]);
    // Shift and a click add and take away.
    choose(&mut w, &["a"]);
    w.click_with(w.rect("node p").center(), PointerButton::Primary, SHIFT);
    assert_eq!(selected(&w), ["a", "p"]);
    w.steps(30);
    w.click_with(w.rect("node p").center(), PointerButton::Primary, SHIFT);
    assert_eq!(selected(&w), ["a"]);
}

#[test]
fn wires_are_led_to_another_port_all_at_once() {
    let mut w = Window::open(Some(&graph("rewire", CHAIN)));
    let before = w.text();
    let (from, to) = (w.rect("input p.x").left_center(), w.rect("input q.y").left_center());
    w.drag_with(from, to, PointerButton::Primary, both());
    assert_eq!((sources(&w, "p", "x").len(), sources(&w, "q", "y")), (0, vec!["c.value".to_owned()]));
    assert_eq!(w.app().model.steps(), (1, 0));
    // From an output, too: everything that it fed is fed by another.
    let (from, to) = (w.rect("output c.value").right_center(), w.rect("output a.value").right_center());
    w.drag_with(from, to, PointerButton::Primary, both());
    assert_eq!(sources(&w, "q", "y"), ["a.value"]);
    w.key(Modifiers::COMMAND, Key::Z);
    w.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(w.text(), before);
}

#[test]
fn escape_gives_up_what_is_being_dragged() {
    let mut w = Window::open(Some(&graph("escape", CHAIN)));
    let (before, layout) = (w.text(), w.app().model.document().layout_to_string());
    choose(&mut w, &["q"]);
    // A node.
    let title = w.rect("node q").center();
    w.press(title, title + vec2(90.0, 60.0), Modifiers::NONE);
    w.key(Modifiers::NONE, Key::Escape);
    w.release(title + vec2(90.0, 60.0));
    assert_eq!(w.app().model.document().layout_to_string(), layout);
    assert_eq!(selected(&w), ["q"], "the selection stays");
    // A wire that was taken off.
    let port = w.rect("input p.x").left_center();
    w.press(port, port + vec2(-30.0, 80.0), Modifiers::COMMAND);
    assert!(sources(&w, "p", "x").is_empty());
    w.key(Modifiers::NONE, Key::Escape);
    w.release(port + vec2(-30.0, 80.0));
    assert_eq!(w.text(), before);
    // A value.
    let value = w.rect("input a.value").center();
    w.press(value, value + vec2(60.0, 0.0), Modifiers::NONE);
    assert_ne!(w.text(), before);
    w.key(Modifiers::NONE, Key::Escape);
    w.release(value + vec2(60.0, 0.0));
    assert_eq!(w.text(), before);
    assert_eq!(w.app().model.steps(), (0, 0), "nothing was done");
    // A frame.
    let canvas = w.rect("canvas");
    w.press(canvas.left_top() + vec2(4.0, 4.0), canvas.right_bottom() - vec2(4.0, 4.0), Modifiers::NONE);
    assert_eq!(selected(&w).len(), 5);
    w.key(Modifiers::NONE, Key::Escape);
    w.release(canvas.center());
    assert!(selected(&w).len() <= 1, "{:?}", selected(&w));
}

#[test]
fn what_is_copied_goes_from_window_to_window_to_where_the_pointer_is() {
    let mut w = Window::open(Some(&graph("clip", CHAIN)));
    choose(&mut w, &["b", "c"]);
    let text = w.clipboard(Event::Copy);
    assert!(text.contains("\"b\"") && text.contains("\"c\""), "{text}");
    let mut other = Window::open(None);
    let at = other.rect("canvas").center() + vec2(40.0, 30.0);
    other.hover(at);
    other.harness.event(Event::Paste(text));
    other.steps(3);
    assert_eq!(selected(&other), ["b", "c"]);
    assert_eq!(sources(&other, "c", "value"), ["b.value"]);
    let around = other.rect("node b").union(other.rect("node c"));
    assert!(around.expand(80.0).contains(at), "{around:?} is not around {at:?}");
    // Cutting takes them away here, as one step each.
    choose(&mut w, &["b", "c"]);
    assert!(w.clipboard(Event::Cut).contains("\"c\""));
    w.steps(1);
    assert_eq!(w.app().model.document().nodes().keys().collect::<Vec<_>>(), ["a", "p", "q"]);
    w.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(w.app().model.document().nodes().len(), 5);
}

#[test]
fn the_canvas_is_moved_scaled_fitted_and_gone_to_by_its_map() {
    let mut w = Window::open(Some(&graph("view", CHAIN)));
    let canvas = w.rect("canvas");
    let start = w.app().canvas.view;
    w.drag_with(empty(&w), empty(&w) + vec2(80.0, -50.0), PointerButton::Secondary, Modifiers::NONE);
    let moved = w.app().canvas.view.origin - start.origin;
    assert!((moved - vec2(80.0, -50.0)).length() < 12.0, "{moved:?}");
    // What is under the pointer stays there while the wheel turns.
    let at = canvas.center() + vec2(70.0, -40.0);
    let before = w.app().canvas.view.to_canvas(canvas, at);
    w.wheel(at, 200.0);
    let view = w.app().canvas.view;
    assert!(view.zoom > start.zoom * 1.2, "{} {}", view.zoom, start.zoom);
    assert!((view.to_canvas(canvas, at) - before).length() < 1.0);
    choose(&mut w, &["q"]);
    w.hover(at);
    w.key(Modifiers::NONE, Key::F);
    let node = w.rect("node q").center();
    assert!((node.x - canvas.center().x).abs() < 60.0, "what is selected is in the middle");
    // The map shows where that is; a click on it goes elsewhere.
    w.app().canvas.view.zoom = 1.6;
    w.steps(2);
    let before = w.app().canvas.view.origin;
    w.click(canvas.right_bottom() - vec2(60.0, 40.0));
    assert_ne!(w.app().canvas.view.origin, before, "the map goes there");
    w.key(Modifiers::NONE, Key::Home);
    let seen = w.app().canvas.view.seen(canvas);
    assert!(w.app().canvas.shapes.nodes.iter().all(|s| seen.contains_rect(s.rect)), "all of it");
}

#[test]
fn what_lies_under_the_map_is_not_touched_by_clicks_and_drags_on_it() {
    let mut w = Window::open(Some(&graph("map", CHAIN)));
    let (canvas, text) = (w.rect("canvas"), w.text());
    let on_map = canvas.right_bottom() - vec2(60.0, 40.0);
    // The value of a node comes to lie under the map, where a click selects the node and a drag turns the value.
    let under = |w: &mut Window| {
        w.app().canvas.view.zoom = 1.6;
        w.steps(2);
        let q = w.app().canvas.shapes.nodes.iter().find(|s| s.id == "q").unwrap().rect.center();
        let by = on_map - w.app().canvas.view.to_screen(canvas, q);
        w.app().canvas.view.origin += by;
        w.steps(2);
        assert!(w.rect("node q").left() < on_map.x && w.rect("node q").right() > on_map.x);
        w.app().canvas.view.origin
    };
    let before = under(&mut w);
    w.rest(on_map);
    assert!(!w.has_containing("number, mm") && !w.has_containing("(point)"), "no tooltip of what lies there");
    w.rest(w.rect("output q.point").left_center() + vec2(4.0, 0.0));
    w.click(on_map);
    assert!(w.app().canvas.view.origin != before && selected(&w).is_empty());
    let before = under(&mut w);
    w.double_click(on_map);
    assert!(w.app().canvas.view.origin != before && !w.app().canvas.is_typing());
    assert!(selected(&w).is_empty());
    under(&mut w);
    let mut seen = Vec::new();
    w.press(on_map, on_map - vec2(20.0, 10.0), Modifiers::NONE);
    seen.push(w.app().canvas.view.origin);
    w.hover(on_map - vec2(30.0, 10.0));
    seen.push(w.app().canvas.view.origin);
    w.release(on_map - vec2(30.0, 10.0));
    assert!(seen[1].x > seen[0].x && seen[1].y == seen[0].y, "the canvas follows: {seen:?}");
    assert_eq!((w.text(), w.app().model.steps()), (text, (0, 0)));
    assert!(selected(&w).is_empty());
}

#[test]
fn nodes_are_aligned_and_distributed_by_the_menu() {
    let mut w = Window::open(Some(&graph("align", CHAIN)));
    for (id, at) in [("a", [0.0, 0.0]), ("b", [210.0, 40.0]), ("c", [640.0, 90.0])] {
        w.app().model.edit(tenon_engine::Operation::Move { node: id.into(), to: Some(at) });
    }
    choose(&mut w, &["a", "b", "c"]);
    w.hover(w.rect("canvas").center());
    w.key(Modifiers::NONE, Key::F);
    let align = |w: &mut Window, words: &str| {
        w.click_with(w.rect("node b").center(), PointerButton::Secondary, Modifiers::NONE);
        let menu = w.harness.get_by_label_contains("Align").rect();
        w.click(menu.center());
        w.steps(5);
        w.click(w.rect(words).center());
    };
    let places = |w: &Window, k: usize| -> Vec<f64> {
        ["a", "b", "c"].map(|id| w.harness.state().model.document().position(id).unwrap()[k]).into()
    };
    align(&mut w, "Distribute across");
    assert_eq!(places(&w, 0), [0.0, 320.0, 640.0]);
    align(&mut w, "Lower edges");
    assert_eq!(places(&w, 1), [90.0, 90.0, 90.0], "they are of one height");
    align(&mut w, "Right edges");
    assert_eq!(places(&w, 0), [640.0, 640.0, 640.0]);
    assert_eq!(w.app().model.steps().0, 6, "each is a step");
}

#[test]
fn the_middle_button_moves_the_canvas() {
    let mut w = Window::open(Some(&graph("middle", CHAIN)));
    let (before, from) = (w.rect("node a"), empty(&w));
    w.drag_with(from, from + vec2(40.0, -30.0), PointerButton::Middle, Modifiers::NONE);
    assert!((w.rect("node a").center() - before.center() - vec2(40.0, -30.0)).length() < 1.0);
    // Over a node too, which stays where it is on the canvas.
    let at = w.app().model.position("a");
    let from = w.rect("node a").center();
    w.drag_with(from, from + vec2(-40.0, 30.0), PointerButton::Middle, Modifiers::NONE);
    assert!((w.rect("node a").center() - before.center()).length() < 1.0);
    assert_eq!((w.app().model.position("a"), w.app().model.steps().0), (at, 0));
}
