//! Clusters on the canvas: instances with the ports of their definition, made and taken apart by hand.

use crate::common::{Window, example};
use eframe::egui::{Modifiers, PointerButton};
use tenon_engine::Operation;

#[test]
fn instances_have_ports_values_and_times() {
    let mut w = Window::open(Some(&example("three-strips")));
    assert_eq!(w.app().model.results.counts(), (0, 0), "{:?}", w.app().model.results.diagnostics);
    assert!(w.app().model.results.drawings.contains_key("low.panels"), "panels from inside are seen");
    assert!(!w.app().model.results.nodes["low"].time.is_zero());
    let before = w.app().model.results.values["area.sum"].digest();

    // An instance is taken apart into its nodes, and they are gathered again: the results stay.
    w.app().model.selection = ["low".to_owned()].into();
    w.app().canvas.show_all();
    w.steps(3);
    assert!(w.has("input low.height") && w.has("output low.panels"));
    w.picture("clusters");
    w.click_with(w.rect("node low").center(), PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Explode the cluster").center());
    w.settle();
    let inside = w.app().model.selection.clone();
    assert!(inside.len() > 3 && !w.app().model.document().nodes().contains_key("low"), "{inside:?}");
    assert_eq!(w.app().model.results.values["area.sum"].digest(), before);
    w.app().model.gather().unwrap();
    w.settle();
    assert!(w.app().model.document().nodes().contains_key("cluster-1"));
    assert_eq!(w.app().model.results.values["area.sum"].digest(), before);
    assert_eq!(w.app().model.steps(), (2, 0));
}

#[test]
fn clusters_are_entered_changed_named_and_left() {
    let mut w = Window::open(Some(&example("three-strips")));
    w.app().model.selection = ["low".to_owned()].into();
    w.app().canvas.show_all();
    w.steps(3);
    w.click_with(w.rect("node low").center(), PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Enter the cluster").center());
    w.settle();
    let model = &w.app().model;
    assert_eq!(model.trail().last().unwrap().path, "low");
    assert!(model.document().nodes().contains_key("thicken"), "{:?}", model.document().nodes().keys());
    assert!(model.value("thicken.panels").is_some(), "values are those of the instance");
    assert!(model.results.drawings.contains_key("low/thicken.panels"), "{:?}", model.results.drawings.keys());
    w.picture("inside");
    // What the instance says of a coordinate counts, and no hand can move it there.
    let handles = w.app().model.handles();
    let top = handles.iter().find(|h| h.node == "arc_2").unwrap();
    assert_eq!((top.at.z, top.free), (1000.0, [true, true, false]));

    // A change inside is one of the definition, and all instances follow.
    let area = w.app().model.results.values["area.sum"].digest();
    let set = Operation::SetParam { node: "arc_3".into(), port: "x".into(), value: Some(3000.into()) };
    assert!(w.app().model.edit(set), "{:?}", w.app().model.message);
    w.settle();
    assert_ne!(w.app().model.results.values["area.sum"].digest(), area);

    // A port that is exposed stands at every instance.
    let node = w.app().model.document().nodes().keys().find(|id| id.starts_with("arc_")).unwrap().clone();
    w.app().model.selection = [node.clone()].into();
    w.app().canvas.show_all();
    w.steps(3);
    w.click_with(w.rect(&format!("input {node}.x")).left_center(), PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Make x an input of the cluster").center());
    assert!(w.app().model.document().inputs.contains_key("x"));
    let field = w.rect("name of the cluster");
    w.click(field.center());
    w.key(Modifiers::COMMAND, eframe::egui::Key::A);
    w.type_text("band");
    w.key(Modifiers::NONE, eframe::egui::Key::Enter);
    let model = &w.app().model;
    assert_eq!(model.trail().last().unwrap().cluster, "band", "{:?}", model.message);
    w.click(w.rect("Whole graph").center());
    w.settle();
    assert_eq!(w.app().model.results.counts().0, 0, "{:?}", w.app().model.results.diagnostics);
    let low = &w.app().model.document().nodes()["low"];
    assert_eq!(low.type_name, "cluster:band");
    let info = w.app().model.catalog.get("cluster:band").unwrap().clone();
    assert!(info.inputs.iter().any(|p| p.name == "x"));
    // Every step is taken back from outside as well.
    for _ in 0..3 {
        w.key(Modifiers::COMMAND, eframe::egui::Key::Z);
    }
    w.settle();
    assert_eq!(w.app().model.results.values["area.sum"].digest(), area);
    assert!(!w.app().model.unsaved());
}
