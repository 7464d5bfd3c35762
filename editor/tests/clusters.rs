//! Clusters on the canvas: instances with the ports of their definition, made and taken apart by hand.

use crate::common::{Window, root};
use eframe::egui::{Modifiers, PointerButton};

#[test]
fn instances_have_ports_values_and_times() {
    let mut w = Window::open(Some(&root().join("graphs/three-strips")));
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
