//! Undo and redo without limit.

use crate::common::Window;
use eframe::egui::{Key, Modifiers};
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
