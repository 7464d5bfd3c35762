//! Values as they are: shown, copied, read as the engine reads them, and typed only if a file can hold them.

use crate::common::{Window, graph, pixels};
use eframe::egui::{Event, Key, Modifiers, OutputCommand, PointerButton, Rect, pos2};

const POINTS: &str = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": { "c": { "type": "ifs_curve", "v": 1, "params": { "points": [[0, -12345.125, 0], [100, 5, 0]] } } }
}"#;

/// Shows what stands at a port of the selected node in the table of Data.
fn look(w: &mut Window, node: &str, port: &str) {
    w.app().model.selection = [node.to_owned()].into();
    w.settle();
    w.click(w.rect("port that is shown").center());
    w.settle();
    w.click(w.rect(&format!("into {node}.{port}")).center());
    w.settle();
}

/// What a click brings into the clipboard.
fn copied(w: &mut Window, button: &str) -> String {
    let pos = w.rect(button).center();
    w.hover(pos);
    let press =
        |pressed| Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE };
    w.harness.event(press(true));
    w.steps(1);
    w.clipboard(press(false))
}

#[test]
fn a_text_is_shown_and_copied_as_it_is() {
    let long = format!("{}, \\\"the end\\\"", "ash and oak ".repeat(20));
    let text = format!(
        "{{ \"format\": \"tenon\", \"version\": 1, \"nodes\": {{ \"t\": {{ \"type\": \"text\", \"v\": 1, \"params\": {{ \"value\": \"{long}\" }} }} }} }}"
    );
    let long = long.replace('\\', "");
    let mut w = Window::open(Some(&graph("text", &text)));
    w.app().model.selection = ["t".to_owned()].into();
    w.click(w.first("Data").center());
    w.settle();
    w.picture("data-text");
    assert!(w.has(&format!("{:<10} {:>8}  {long}", "{0}", 0)), "the whole text, without quotes");
    let table = copied(&mut w, "Copy as CSV");
    assert_eq!(table, format!("path,index,text\n{{0}},0,\"{}\"\n", long.replace('"', "\"\"")));
    w.rest(w.rect("output t.value").center());
    assert!(w.has_containing("text: ash and oak ash"), "and in the tooltip");
}

#[test]
fn what_arrives_at_an_input_is_read_as_the_engine_reads_it() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "interface": { "inputs": { "thick": { "port": "a.x" } } },
  "nodes": {
    "a": { "type": "point", "v": 1, "params": { "x": "1.2 cm" } },
    "b": { "type": "point", "v": 1, "params": { "x": "thick * 2" } },
    "c": { "type": "ifs_curve", "v": 1, "params": { "points": [1, 2, 3] } },
    "half": { "type": "number", "v": 1, "params": { "value": 0.5 } },
    "whole": { "type": "integer", "v": 1, "params": { "value": 2 } },
    "s": { "type": "statistics", "v": 1, "inputs": { "numbers": { "from": ["whole.value", "half.value"] } } },
    "l": { "type": "list", "v": 1, "inputs": { "items": { "from": ["whole.value", "half.value"] } } }
  }
}"#;
    let mut w = Window::open(Some(&graph("arriving", text)));
    w.click(w.first("Data").center());
    look(&mut w, "c", "points");
    w.picture("data-point");
    assert!(w.has("1 branch, 1 item of point"));
    look(&mut w, "a", "x");
    assert!(w.has("1 branch, 1 item of number") && w.has_containing("0  12"), "with its unit");
    look(&mut w, "b", "x");
    assert!(w.has("1 branch, 1 item of number") && w.has_containing("0  24"), "formulas are computed");
    look(&mut w, "s", "numbers");
    assert!(w.has("1 branch, 2 items of number") && w.has("2 numbers from 0.5 to 2, mean 1.2500"));
    look(&mut w, "l", "items");
    assert!(w.has_containing("cannot join integer and number in one list"), "what the engine says");
    // The table follows what is typed.
    w.double_click(w.rect("input a.x").center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("2 cm");
    w.key(Modifiers::NONE, Key::Enter);
    w.settle();
    w.picture("data-typed");
    look(&mut w, "b", "x");
    assert!(w.has_containing("0  40"));
}

#[test]
fn a_copy_is_given_up_when_the_table_is_closed() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": { "s": { "type": "series", "v": 1, "params": { "count": 1000000 } } }
}"#;
    let mut w = Window::open(Some(&graph("given-up", text)));
    w.app().model.selection = ["s".to_owned()].into();
    w.click(w.first("Data").center());
    w.settle();
    let pos = w.rect("Copy as CSV").center();
    w.hover(pos);
    for pressed in [true, false] {
        w.harness.event(Event::PointerButton {
            pos,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        });
        w.harness.step();
    }
    // It is being made now.
    w.harness.step();
    let key = |key, pressed, modifiers| Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
    w.harness.event(key(Key::Num3, true, Modifiers::ALT));
    w.harness.step();
    assert!(!w.has("Copy as CSV"));
    // By now it would be made.
    std::thread::sleep(std::time::Duration::from_secs(4));
    w.steps(3);
    w.harness.event(key(Key::Num3, true, Modifiers::ALT));
    for _ in 0..100 {
        w.harness.step();
        let commands = &w.harness.output().platform_output.commands;
        assert!(!commands.iter().any(|c| matches!(c, OutputCommand::CopyText(_))), "nobody waits for it any more");
        std::thread::sleep(std::time::Duration::from_millis(10));
    }
    assert!(w.has("Copy as CSV"));
}

#[test]
fn columns_of_points_stand_straight() {
    let mut w = Window::open(Some(&graph("columns", POINTS)));
    w.double_click(w.rect("input c.points").center());
    w.steps(3);
    w.picture("table-columns");
    for axis in ["x", "y", "z"] {
        let [a, b] = [1, 2].map(|i| w.rect(&format!("{axis} of {i}")));
        assert!((a.left(), a.right()) == (b.left(), b.right()), "{axis}: {a} {b}");
    }
}

#[test]
fn what_no_file_can_hold_is_not_taken() {
    let mut w = Window::open(Some(&graph("finite", POINTS)));
    w.double_click(w.rect("input c.points").center());
    w.steps(3);
    let before = w.param("c", "points");
    for typed in ["inf", "-inf", "NaN", "1e999"] {
        w.fill("x of 1", typed);
        assert_eq!(w.param("c", "points"), before, "{typed}");
    }
    w.fill("x of 1", "−1 000.5");
    assert_eq!(w.param("c", "points"), "[[-1000.5,-12345.125,0],[100,5,0]]");
    w.key(Modifiers::NONE, Key::Escape);
    // The same beside a point that was clicked in space.
    w.app().model.selection = ["c".to_owned()].into();
    w.settle();
    w.click(w.rect("point c.points 2").center());
    w.steps(3);
    w.fill("x of c.points 2", "inf");
    assert_eq!(w.param("c", "points"), "[[-1000.5,-12345.125,0],[100,5,0]]");
}

#[test]
fn the_number_of_problems_lies_beside_the_state_of_a_node() {
    let mut w = Window::open(Some(&graph("badge", crate::common::WRONG)));
    let (node, badge) = (w.rect("node series"), w.rect("problems of series"));
    let picture = w.picture("badge");
    let bar = crate::common::rgb(&picture, node.left_center() + eframe::egui::vec2(3.0, 0.0));
    let other = |area: Rect| pixels(&picture, area, |p| !crate::common::like(p, bar));
    let strip =
        |left: f32, right: f32| Rect::from_min_max(pos2(left, badge.bottom() + 2.0), pos2(right, node.bottom() - 1.0));
    assert_eq!(other(strip(badge.left() - 2.0, node.right() - 1.0)), 0, "no letter under it");
    assert!(other(strip(badge.left() - 40.0, badge.left() - 2.0)) > 20, "the state stands left of it");
}

#[test]
fn what_is_typed_may_have_a_unit_of_its_own_wherever_it_is_typed() {
    let mut w = Window::open(Some(&graph("units", POINTS)));
    w.double_click(w.rect("input c.points").center());
    w.fill("x of 1", "1.2 m");
    w.fill("y of 2", "3cm");
    w.fill("z of 2", "3 deg");
    assert_eq!(w.param("c", "points"), "[[1200,-12345.125,0],[100,30,0]]", "an angle is no length");
    w.key(Modifiers::NONE, Key::Escape);
    w.app().model.selection = ["c".to_owned()].into();
    w.settle();
    w.click(w.rect("point c.points 2").center());
    w.steps(3);
    w.fill("z of c.points 2", "1 in");
    assert_eq!(w.param("c", "points"), "[[1200,-12345.125,0],[100,30,25.4]]");
    let text =
        r#"{ "format": "tenon", "version": 1, "nodes": { "p": { "type": "point", "v": 1, "params": { "x": 7 } } } }"#;
    let mut w = Window::open(Some(&graph("units-inspector", text)));
    w.app().model.selection = ["p".to_owned()].into();
    w.steps(3);
    w.fill("value of p.x", "2 m");
    assert_eq!(w.param("p", "x"), "2000");
}

#[test]
fn a_number_keeps_the_digits_that_its_field_does_not_show() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "c": { "type": "ifs_curve", "v": 1, "params": {
      "points": [[0, 0.123456789, 0], [100, 5, 0], [200, 0, 0]], "weights": [1, 0.7071067811865476, 1] } },
    "n": { "type": "number", "v": 1, "params": { "value": 3.141592653589793 } }
  }
}"#;
    let mut w = Window::open(Some(&graph("digits", text)));
    let before = w.text();
    w.double_click(w.rect("input c.points").center());
    for field in ["y of 1", "weight of 2", "z of 3"] {
        w.click(w.rect(field).center());
    }
    w.key(Modifiers::NONE, Key::Tab);
    w.key(Modifiers::NONE, Key::Escape);
    w.key(Modifiers::NONE, Key::Escape);
    w.app().model.selection = ["n".to_owned()].into();
    w.steps(3);
    w.click(w.rect("value of n.value").center());
    w.key(Modifiers::NONE, Key::Tab);
    assert_eq!((w.text(), w.app().model.steps().0), (before, 0));
    // What is typed counts to its last digit.
    w.fill("value of n.value", "2.7182818284590452");
    assert_eq!(w.param("n", "value"), "2.718281828459045");
}

#[test]
fn a_value_with_decimals_is_turned_by_decimals() {
    let text = r#"{ "format": "tenon", "version": 1, "nodes": { "p": { "type": "point", "v": 1, "params": { "x": 21.5 } } } }"#;
    let mut w = Window::open(Some(&graph("turned", text)));
    let at = w.rect("input p.x").center();
    w.drag(at, at + eframe::egui::vec2(12.0, 0.0));
    let value: f64 = w.param("p", "x").parse().unwrap();
    let steps = (value - 21.5) / 0.2;
    assert!(value > 21.5 && value < 24.0 && (steps - steps.round()).abs() < 1e-6, "{value}");
}
