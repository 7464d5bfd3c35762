//! Numbers that people slide: typed in the finder, made of numbers, put before inputs; and the graph's own inputs and outputs.

use crate::common::{TWO, Window, graph};
use eframe::egui::{Key, Modifiers, PointerButton, Pos2, vec2};
use tenon_editor::model::param::Widget;

fn empty(w: &Window) -> Pos2 {
    w.rect("canvas").left_bottom() + vec2(60.0, -160.0)
}

/// The value row of a node, if it is a slider: value and ends.
fn slider(w: &Window, node: &str) -> Option<(f64, f64, f64)> {
    let shapes = &w.harness.state().canvas.shapes;
    let shape = &shapes.nodes[shapes.find(node)?];
    shape.rows.iter().find_map(|row| match row {
        tenon_editor::canvas::Row::Input(_, Some(Widget::Slider(s))) => Some((s.value, s.min, s.max)),
        _ => None,
    })
}

#[test]
fn a_number_typed_in_the_finder_is_a_slider_with_ends() {
    let mut w = Window::open(None);
    w.double_click(empty(&w));
    w.type_text("0<4<12 cm");
    assert!(w.has("Slider 0 < 4 < 12 cm"));
    w.picture("finder-slider");
    w.key(Modifiers::NONE, Key::Enter);
    assert_eq!(slider(&w, "slider"), Some((4.0, 0.0, 12.0)));
    assert_eq!(w.app().model.steps(), (1, 0), "one step");
    w.settle();
    assert_eq!(w.app().model.results.values["slider.value"].first::<f64>(), Some(&40.0), "4 cm");
    // It slides between its ends by whole numbers.
    let row = w.rect("input slider.value");
    w.drag(row.center(), row.right_center() + vec2(80.0, 0.0));
    assert_eq!(w.param("slider", "value"), "12");
    w.picture("slider");
    // Another range is typed where the value stands.
    w.double_click(row.center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("2..2.5..3");
    w.key(Modifiers::NONE, Key::Enter);
    assert_eq!(slider(&w, "slider"), Some((2.5, 2.0, 3.0)));
    assert_eq!(w.param("slider", "step"), "0.1");
    w.double_click(empty(&w) + vec2(0.0, -200.0));
    w.type_text("5");
    w.key(Modifiers::NONE, Key::Enter);
    assert_eq!(slider(&w, "integer_slider"), Some((5.0, 0.0, 10.0)));
    w.double_click(empty(&w) + vec2(300.0, -200.0));
    w.type_text("\"oak");
    w.key(Modifiers::NONE, Key::Enter);
    assert_eq!(w.param("text", "value"), "\"oak\"");
}

#[test]
fn a_number_becomes_a_slider_and_an_input_gets_one() {
    let mut w = Window::open(Some(&graph("to-slider", TWO)));
    w.settle();
    w.click_with(w.rect("node a").center(), PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Make it a slider").center());
    assert_eq!(slider(&w, "a"), Some((3.0, 0.0, 10.0)));
    assert_eq!(w.app().model.document().nodes()["p"].inputs.get("x").unwrap().from.as_slice(), ["a.value"]);
    w.click_with(w.rect("input p.y").center(), PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Put a slider before y").center());
    assert_eq!(w.app().model.document().nodes()["p"].inputs.get("y").unwrap().from.as_slice(), ["slider.value"]);
    w.settle();
    assert_eq!(w.app().model.results.counts(), (0, 0), "{:?}", w.app().model.results.diagnostics);
    w.key(Modifiers::COMMAND, Key::Z);
    w.key(Modifiers::COMMAND, Key::Z);
    assert!(!w.app().model.unsaved());
}

#[test]
fn the_interface_is_made_by_hand_and_taken_back() {
    let mut w = Window::open(Some(&graph("interface", TWO)));
    let before = w.text();
    w.click_with(w.rect("input p.y").left_center(), PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Make y an input of the graph").center());
    w.click_with(w.rect("input p.z").left_center(), PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Make z an input of the graph").center());
    w.click_with(w.rect("output p.point").right_center(), PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Make point an output of the graph").center());
    // With nothing selected the interface stands beside the canvas.
    w.app().model.selection.clear();
    w.steps(2);
    w.fill("name of input y", "height");
    w.fill("min of height", "-5");
    w.fill("max of height", "40");
    w.fill("step of height", "2.5");
    w.fill("unit of height", "cm");
    w.fill("doc of height", "How high the point stands.");
    w.fill("name of output point", "corner");
    w.picture("interface");
    let input = w.app().model.document().inputs["height"].clone();
    assert_eq!((input.min, input.max, input.unit.as_deref()), (Some(-5.0), Some(40.0), Some("cm")));
    assert_eq!(input.doc.as_deref(), Some("How high the point stands."));
    assert!(w.app().model.document().outputs.contains_key("corner"));
    assert_eq!(slider(&w, "p"), Some((0.0, -5.0, 40.0)), "its ends make a slider of it");
    // It slides by its step from the smallest value on, here and on the canvas.
    let row = w.rect("input p.y");
    w.drag(row.center(), row.center() + vec2(row.width() * 0.13, 0.0));
    let slid: f64 = w.param("p", "y").parse().unwrap();
    assert!(slid != 0.0 && (slid + 5.0) % 2.5 == 0.0, "{slid}");
    w.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(w.param("p", "y"), "");
    w.fill("step of height", "0");
    assert!(w.app().model.message.is_some(), "nothing slides by 0");
    assert_eq!(w.app().model.document().inputs["height"].step, Some(2.5));
    // The last goes up, and the file says so.
    w.tap("input z one up");
    let order: Vec<&str> = w.harness.state().model.document().inputs_in_order().into_iter().map(|(n, _)| n).collect();
    assert_eq!(order, ["z", "height"]);
    w.fill("max of height", "many");
    assert!(w.app().model.message.is_some(), "that is no number");
    assert_eq!(w.app().model.document().inputs["height"].max, Some(40.0));
    w.tap("take away input z");
    assert!(!w.app().model.document().inputs.contains_key("z"));
    let steps = w.app().model.steps().0;
    for _ in 0..steps {
        w.app().model.undo();
    }
    w.steps(2);
    assert_eq!(w.text(), before);
}
