//! Undo and redo without limit.

use crate::common::{TWO, Window, graph};
use eframe::egui::{Key, Modifiers, PointerButton, vec2};
use tenon_engine::Operation;

#[test]
fn fifty_steps_go_back_and_forward_byte_for_byte() {
    let mut w = Window::open(None);
    let mut texts = vec![w.text()];
    for i in 0..50 {
        let model = &mut w.app().model;
        let done = match i % 5 {
            0 => {
                let (_, add) = model.new_node("number", [f64::from(i) * 10.0, 0.0]);
                model.edit(add)
            }
            1 => {
                let node = model.document().nodes().keys().next_back().unwrap().clone();
                model.edit(Operation::SetParam { node, port: "value".into(), value: Some(i.into()) })
            }
            2 => {
                let node = model.document().nodes().keys().next().unwrap().clone();
                model.edit(Operation::SetNote { node, note: Some(format!("step {i}")) })
            }
            3 => {
                let (id, add) = model.new_node("point", [0.0, f64::from(i)]);
                let wire = Operation::Connect { node: id, port: "x".into(), from: "number.value".into(), at: None };
                model.edit(Operation::All(vec![add, wire]))
            }
            _ => {
                let node = model.document().nodes().keys().next_back().unwrap().clone();
                model.edit(Operation::Move { node, to: Some([f64::from(i), f64::from(i)]) })
            }
        };
        assert!(done, "step {i}: {:?}", w.app().model.message);
        texts.push(w.text() + &w.harness.state().model.document().layout_to_string());
    }
    texts[0] += &tenon_engine::Document::new().layout_to_string();
    let now = |w: &Window| w.text() + &w.harness.state().model.document().layout_to_string();
    for text in texts.iter().rev().skip(1) {
        w.key(Modifiers::COMMAND, Key::Z);
        assert_eq!(now(&w), *text);
    }
    assert_eq!(w.app().model.steps(), (0, 50));
    for text in texts.iter().skip(1) {
        w.key(Modifiers::COMMAND, Key::Y);
        assert_eq!(now(&w), *text);
    }
    w.settle();
    assert_eq!(w.app().model.results.values["number.value"].len(), 1);
}

#[test]
fn fifty_steps_by_hand_go_back_and_forward() {
    let mut w = Window::open(Some(&graph("by-hand", TWO)));
    let now = |w: &Window| w.text() + &w.harness.state().model.document().layout_to_string();
    let mut texts = vec![now(&w)];
    for i in 0..50 {
        match i % 5 {
            0 => {
                w.double_click(w.rect("input a.value").center());
                w.key(Modifiers::COMMAND, Key::A);
                w.type_text(&format!("{}", 10 + i));
                w.key(Modifiers::NONE, Key::Enter);
            }
            1 => {
                w.click(w.rect("node p").center());
                w.key(Modifiers::SHIFT, Key::ArrowDown);
            }
            2 => w.key(Modifiers::COMMAND, Key::E),
            3 => w.drag(
                w.rect("node a").center(),
                w.rect("node a").center() + vec2(0.0, if i % 2 == 0 { 30.0 } else { -30.0 }),
            ),
            _ if i % 2 == 0 => w.drag(w.rect("output a.value").right_center(), w.rect("input p.y").left_center()),
            _ => {
                let port = w.rect("input p.y").left_center();
                w.drag_with(port, port + vec2(-20.0, 120.0), PointerButton::Primary, Modifiers::COMMAND);
            }
        }
        texts.push(now(&w));
        assert_ne!(texts[i + 1], texts[i], "step {i}");
    }
    for (key, all) in [(Key::Z, texts.iter().rev().collect::<Vec<_>>()), (Key::Y, texts.iter().collect())] {
        for (i, text) in all.into_iter().enumerate().skip(1) {
            w.key(Modifiers::COMMAND, key);
            assert_eq!(now(&w), *text, "{key:?} {i}");
        }
    }
}
