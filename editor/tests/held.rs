//! What is held is one step, whatever happens to it meanwhile: Escape gives it up, other keys wait, nothing stays open.

use crate::common::{Window, graph};
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, RawInput, vec2};

const CURVE: &str = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "c": { "type": "ifs_curve", "v": 1, "params": { "points": [[0, 0, 0], [500, 0, 400], [1000, 0, 0]] } },
    "n": { "type": "number", "v": 1, "params": { "value": 3 } }
  }
}"#;

fn window(name: &str) -> Window {
    let mut w = Window::open(Some(&graph(name, CURVE)));
    w.app().viewport.show_all();
    w.steps(2);
    w
}

fn points(w: &Window) -> String {
    w.param("c", "points")
}

fn point(w: &Window) -> Pos2 {
    w.rect("point c.points 2").center()
}

/// Two changes of a number are two steps, so nothing before them is open.
fn assert_nothing_is_open(w: &mut Window) {
    let before = w.app().model.steps().0;
    for value in [50, 51] {
        let set =
            tenon_engine::Operation::SetParam { node: "n".into(), port: "value".into(), value: Some(value.into()) };
        assert!(w.app().model.edit(set));
        w.steps(1);
    }
    assert_eq!(w.app().model.steps().0, before + 2);
}

#[test]
fn a_point_that_is_dragged_out_of_the_viewport_comes_back_and_is_one_step() {
    let mut w = window("outside");
    let (at, canvas) = (point(&w), w.rect("canvas").center());
    w.press(at, canvas, Modifiers::NONE);
    let far = points(&w);
    w.hover(at + vec2(0.0, 30.0));
    w.steps(2);
    assert_ne!(points(&w), far, "it is still held");
    w.hover(canvas);
    w.release(canvas);
    w.settle();
    assert_eq!(w.app().model.steps().0, 1);
    assert_nothing_is_open(&mut w);
}

#[test]
fn escape_gives_up_what_is_dragged_anywhere() {
    let mut w = window("given-up");
    let before = w.text();
    // A point in the viewport.
    let at = point(&w);
    w.press(at, at + vec2(30.0, 20.0), Modifiers::NONE);
    assert_ne!(w.text(), before);
    w.key(Modifiers::NONE, Key::Escape);
    w.hover(at + vec2(60.0, 40.0));
    w.release(at + vec2(60.0, 40.0));
    w.settle();
    assert_eq!((w.text(), w.app().model.steps()), (before.clone(), (0, 0)));
    // The weight of a point, by its ring.
    w.click(point(&w));
    let ring = w.rect("weight c.points 2").center();
    w.press(ring, ring + vec2(30.0, 0.0), Modifiers::NONE);
    assert_ne!(w.text(), before);
    w.key(Modifiers::NONE, Key::Escape);
    w.release(ring + vec2(30.0, 0.0));
    assert_eq!((w.text(), w.app().model.steps()), (before.clone(), (0, 0)));
    // A coordinate in its field, and a value in the inspector.
    for (node, name) in [("c", "z of c.points 2"), ("n", "value of n.value")] {
        w.app().model.selection = [node.to_owned()].into();
        w.steps(2);
        let field = w.rect(name).center();
        w.press(field, field + vec2(40.0, 0.0), Modifiers::NONE);
        assert_ne!(w.text(), before, "{name}");
        w.key(Modifiers::NONE, Key::Escape);
        w.release(field + vec2(40.0, 0.0));
        assert_eq!((w.text(), w.app().model.steps()), (before.clone(), (0, 0)), "{name}");
    }
    // A point in the drawing of a table.
    w.double_click(w.rect("input c.points").center());
    w.settle();
    let drawn = w.rect("point 2 in the drawing").center();
    w.press(drawn, drawn + vec2(0.0, 12.0), Modifiers::NONE);
    assert_ne!(w.text(), before);
    w.key(Modifiers::NONE, Key::Escape);
    w.release(drawn + vec2(0.0, 12.0));
    assert_eq!((w.text(), w.app().model.steps()), (before, (0, 0)));
    assert!(w.has("point 2 in the drawing"), "the table stays");
    assert_nothing_is_open(&mut w);
}

#[test]
fn other_keys_wait_while_a_point_is_dragged() {
    let mut w = window("waits");
    let at = point(&w);
    w.app().model.selection = ["n".to_owned()].into();
    w.press(at, at + vec2(30.0, 20.0), Modifiers::NONE);
    let held = points(&w);
    for (modifiers, key) in [
        (Modifiers::COMMAND, Key::Z),
        (Modifiers::NONE, Key::Delete),
        (Modifiers::ALT, Key::Num6),
        (Modifiers::NONE, Key::F4),
    ] {
        w.key(modifiers, key);
        assert_eq!((points(&w), w.app().model.document().nodes().len()), (held.clone(), 2), "{key:?}");
        assert!(w.has("point c.points 2") && !w.app().canvas.is_typing(), "{key:?}");
    }
    w.hover(at + vec2(40.0, 20.0));
    w.release(at + vec2(40.0, 20.0));
    assert_eq!(w.app().model.steps().0, 1);
}

#[test]
fn escape_leaves_a_field_a_menu_or_a_window_first_and_selects_nothing_only_then() {
    let mut w = window("first");
    w.click(point(&w));
    let before = points(&w);
    let chosen = |w: &Window| w.harness.state().model.selection.iter().cloned().collect::<Vec<_>>();
    assert_eq!(chosen(&w), ["c"]);
    // A coordinate that is being typed.
    w.click(w.rect("x of c.points 2").center());
    w.type_text("7");
    w.key(Modifiers::NONE, Key::Escape);
    assert_eq!((chosen(&w), points(&w)), (vec!["c".to_owned()], before.clone()));
    assert_nothing_is_open(&mut w);
    // Menus, the keys, a table.
    for label in ["More", "Views"] {
        w.click(w.rect(label).center());
        w.key(Modifiers::NONE, Key::Escape);
        assert_eq!(chosen(&w), ["c"], "{label}");
    }
    w.key(Modifiers::NONE, Key::F1);
    assert!(w.has("Keys"));
    w.key(Modifiers::NONE, Key::Escape);
    assert!(!w.has("F3") && chosen(&w) == ["c"]);
    w.double_click(w.rect("input c.points").center());
    w.settle();
    // First the cell that is typed in, then the table.
    w.click(w.rect("x of 2").center());
    w.type_text("77");
    w.key(Modifiers::NONE, Key::Escape);
    assert!(w.has("Add a row"));
    assert_eq!(points(&w), before);
    assert_nothing_is_open(&mut w);
    w.key(Modifiers::NONE, Key::Escape);
    assert!(!w.has("Add a row") && chosen(&w) == ["c"]);
    // A value in the inspector.
    w.app().model.selection = ["n".to_owned()].into();
    w.steps(2);
    w.click(w.rect("value of n.value").center());
    w.type_text("8");
    w.key(Modifiers::NONE, Key::Escape);
    assert_eq!((w.param("n", "value").as_str(), chosen(&w)), ("51", vec!["n".to_owned()]));
    assert_nothing_is_open(&mut w);
    w.key(Modifiers::NONE, Key::Escape);
    assert!(chosen(&w).is_empty());
}

/// A frame that comes so many seconds after the one before and sees these things.
fn later(w: &mut Window, seconds: f64, events: Vec<Event>) {
    let ctx = w.harness.ctx.clone();
    let time = Some(ctx.input(|i| i.time) + seconds);
    let mut input = RawInput { time, ..Default::default() };
    eframe::App::raw_input_hook(w.app(), &ctx, &mut input);
    w.harness.input_mut().time = time;
    events.into_iter().for_each(|e| w.harness.event(e));
    w.steps(1);
}

#[test]
fn a_slow_frame_between_two_clicks_leaves_them_a_double_click() {
    let mut w = window("slow-frame");
    let at = w.rect("canvas").center() + vec2(0.0, 160.0);
    w.hover(at);
    let button =
        |pressed| Event::PointerButton { pos: at, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE };
    let click = || vec![button(true), button(false)];
    // So far apart they are two, if the window had nothing to do.
    later(&mut w, 3.0, click());
    later(&mut w, 0.02, Vec::new());
    later(&mut w, 0.7, click());
    let finder = |w: &Window| w.harness.ctx.memory(|m| m.focused()).is_some();
    assert!(!finder(&w));
    // If what the first one asked for took so long, it is not known when the second one was.
    later(&mut w, 3.0, click());
    later(&mut w, 0.7, click());
    assert!(finder(&w));
}
