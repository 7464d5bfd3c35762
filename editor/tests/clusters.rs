//! Clusters on the canvas: instances with the ports of their definition, made and taken apart by hand.

use crate::common::{Window, example, graph};
use eframe::egui::{Event, Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable as _;
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

#[test]
fn clusters_are_made_inside_clusters_by_keys_and_copied_with_what_they_need() {
    let mut w = Window::open(Some(&example("three-strips")));
    let (text, area) = (w.app().model.whole().to_string_canonical(), w.app().model.results.values["area.sum"].digest());
    w.app().model.selection = ["low".to_owned()].into();
    w.app().canvas.show_all();
    w.steps(3);
    // A double-click below the title enters, and so does Enter.
    w.double_click(w.rect("node low").center() + vec2(0.0, 30.0));
    assert_eq!(w.app().model.trail().len(), 1, "{:?}", w.app().model.message);
    w.key(Modifiers::ALT, Key::ArrowLeft);
    assert!(w.app().model.trail().is_empty());
    w.key(Modifiers::NONE, Key::Enter);
    assert_eq!(w.app().model.trail().len(), 1);
    w.settle();

    w.app().model.selection = ["arc".to_owned(), "folds".to_owned()].into();
    w.key(Modifiers::COMMAND, Key::K);
    assert!(w.app().model.message.is_none(), "{:?}", w.app().model.message);
    w.settle();
    assert_eq!(w.app().model.results.values["area.sum"].digest(), area, "results stay");
    let made = w.app().model.selection.first().cloned().unwrap();
    assert!(w.app().model.whole().clusters.contains_key(&made), "its definition stands at the top of the file");
    w.picture("cluster-in-cluster");
    // It goes into another file with its definition.
    let copied = w.clipboard(Event::Copy);
    let mut other = Window::open(None);
    other.harness.event(Event::Paste(copied));
    other.steps(3);
    assert!(other.app().model.whole().clusters.contains_key(&made), "{:?}", other.app().model.message);
    // Into its own definition it does not go.
    let own = w.clipboard(Event::Copy);
    w.key(Modifiers::NONE, Key::Enter);
    assert_eq!(w.app().model.trail().len(), 2);
    w.settle();
    assert!(w.app().model.value("arc.curve").is_some(), "values two levels down are those of the instance");
    w.harness.event(Event::Paste(own));
    w.steps(2);
    assert_eq!(w.app().model.message.as_ref().unwrap().code, "cluster-cycle");
    w.key(Modifiers::ALT, Key::ArrowLeft);
    // It is taken apart again, and every step is taken back.
    w.app().model.selection = [made].into();
    w.key(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::K);
    assert!(w.app().model.document().nodes().contains_key("arc"));
    w.settle();
    assert_eq!(w.app().model.results.values["area.sum"].digest(), area);
    w.key(Modifiers::COMMAND, Key::Z);
    w.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(w.app().model.whole().to_string_canonical(), text);
}

#[test]
fn a_linked_cluster_is_looked_into_and_taken_in_by_one_click() {
    let mut w = Window::open(Some(&example("three-strips")));
    let area = w.app().model.results.values["area.sum"].digest();
    w.app().model.enter("low").unwrap();
    w.app().canvas.opened();
    w.settle();
    w.app().model.enter("cut").unwrap();
    w.app().canvas.opened();
    w.settle();
    let file = w.app().model.linked().unwrap();
    assert!(file.ends_with("boards.tenon.json"), "{file}");
    let id = w.app().model.document().nodes().keys().next().unwrap().clone();
    assert!(w.has_containing("to be looked at"));
    let values = w.app().model.results.values.keys().filter(|k| k.starts_with("low/cut/")).count();
    assert!(values > 0, "its values are those of the instance");
    let places: std::collections::BTreeSet<String> =
        w.app().canvas.shapes.nodes.iter().map(|s| format!("{:?}", s.rect.min)).collect();
    assert!(places.len() > 1, "nodes do not lie on one another");
    w.picture("linked");
    let text = w.app().model.whole().to_string_canonical();
    w.app().model.selection = [id.clone()].into();
    w.key(Modifiers::NONE, Key::Delete);
    assert_eq!(w.app().model.message.as_ref().unwrap().code, "linked-cluster");
    assert_eq!(w.app().model.whole().to_string_canonical(), text, "nothing changes");
    w.click(w.rect("Take it into this file").center());
    assert!(w.app().model.linked().is_none(), "{:?}", w.app().model.message);
    assert_eq!(w.app().model.trail().len(), 2);
    w.settle();
    let (node, note) = (id, Some("here".to_owned()));
    assert!(w.app().model.edit(Operation::SetNote { node, note }), "{:?}", w.app().model.message);
    assert_eq!(w.app().model.results.values["area.sum"].digest(), area);
    w.key(Modifiers::COMMAND, Key::Z);
    w.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(w.app().model.whole().to_string_canonical(), text);
}

#[test]
fn a_problem_inside_a_cluster_is_told_with_its_path_and_leads_into_its_instances() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "clusters": {
    "row": {
      "interface": { "version": 1, "outputs": { "numbers": { "port": "inner.numbers" } } },
      "nodes": { "inner": { "type": "series", "v": 1, "params": { "count": -4 } } }
    },
    "rows": {
      "interface": { "version": 1, "outputs": { "numbers": { "port": "far.numbers" } } },
      "nodes": { "far": { "type": "cluster:row", "v": 1 } }
    },
    "other": {
      "interface": { "version": 1, "outputs": { "numbers": { "port": "n.numbers" } } },
      "nodes": { "n": { "type": "series", "v": 1 } }
    }
  },
  "nodes": {
    "top": { "type": "cluster:rows", "v": 1 },
    "aside": { "type": "cluster:other", "v": 1 },
    "near": { "type": "number", "v": 1, "params": { "value": 3 } }
  }
}"#;
    let mut w = Window::open(Some(&graph("inside-wrong", text)));
    w.click(w.rect_containing(" errors, ").center());
    w.steps(3);
    assert!(w.has("problems of top") && !w.has("problems of near"));
    let row = |w: &Window| w.first_containing("top/far/inner").center();
    let at = row(&w);
    w.click(at);
    w.steps(3);
    let trail: Vec<String> = w.app().model.trail().iter().map(|e| e.path.clone()).collect();
    assert_eq!(trail, ["top", "top/far"], "every instance around it is entered");
    w.settle();
    assert!(w.has("Whole graph") && w.has("problems of inner"));
    assert!(w.has("inner") && w.has_containing("Series, "), "the node is in the inspector");
    assert!(w.rect("canvas").contains(w.rect("node inner").center()), "and in sight");
    // From inside another cluster the same line leads there too.
    w.click(w.rect("Whole graph").center());
    w.app().model.enter("aside").unwrap();
    w.app().canvas.opened();
    w.settle();
    let at = row(&w);
    w.click(at);
    w.settle();
    w.steps(3);
    assert!(w.app().model.trail().last().unwrap().path == "top/far" && w.has("problems of inner"));
    // Mended by hand, nothing is told any more.
    w.double_click(w.rect("input inner.count").center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("4");
    w.key(Modifiers::NONE, Key::Enter);
    w.settle();
    assert!(w.has("Nothing is wrong.") && !w.has("problems of inner"));
}

#[test]
fn instances_tell_what_is_inside_them_at_every_level_and_nothing_that_is_gone() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "clusters": {
    "inner": {
      "interface": { "version": 1, "outputs": { "n": { "port": "b.numbers" }, "m": { "port": "long.point" } } },
      "nodes": {
        "a": { "type": "series", "v": 1, "params": { "count": 400 } },
        "b": { "type": "series", "v": 1, "params": { "count": 3 } },
        "long": { "type": "point", "v": 1, "match": "cross",
                  "inputs": { "x": { "from": ["a.numbers"] }, "y": { "from": ["a.numbers"] } } }
      }
    },
    "outer": {
      "interface": { "version": 1, "outputs": { "n": { "port": "low.n" }, "m": { "port": "low.m" } } },
      "nodes": { "low": { "type": "cluster:inner", "v": 1 } }
    }
  },
  "nodes": { "top": { "type": "cluster:outer", "v": 1 } }
}"#;
    let mut w = Window::open(Some(&graph("levels", text)));
    w.click(w.first("Profile").center());
    w.settle();
    let state = |w: &Window, node: &str| w.harness.get_by_label(&format!("node {node}")).value().unwrap();
    let row = |w: &Window, path: &str| w.harness.get_by_label(&format!("time of {path}")).value().unwrap();
    let enter = |w: &mut Window, node: &str| {
        let at = w.rect(&format!("node {node}")).center();
        w.click(at);
        w.key(Modifiers::NONE, Key::Enter);
        w.settle();
    };
    let out = |w: &mut Window| {
        w.key(Modifiers::ALT, Key::ArrowLeft);
        w.settle();
    };
    // 160 000 points take megabytes.
    let whole = row(&w, "top");
    assert!(whole.contains("s, ") && whole.ends_with(" MB"), "{whole}");
    assert_eq!(state(&w, "top"), whole.split(", ").next().unwrap());
    enter(&mut w, "top");
    assert!(row(&w, "top/low").ends_with(" MB"), "{}", row(&w, "top/low"));
    assert_eq!(state(&w, "low"), row(&w, "top/low").split(", ").next().unwrap());
    w.picture("instance-inside");
    enter(&mut w, "low");
    assert!(row(&w, "top/low/long").ends_with(" MB"));
    // What is deleted counts no more.
    w.click(w.rect("node long").center());
    w.key(Modifiers::NONE, Key::Delete);
    w.settle();
    assert!(!w.has("time of top/low/long"));
    for path in ["top/low", "top"] {
        out(&mut w);
        assert!(!row(&w, path).ends_with(" MB"), "{}", row(&w, path));
    }
    assert!(!state(&w, "top").is_empty());
    // What fails inside is told at every level.
    enter(&mut w, "top");
    enter(&mut w, "low");
    w.double_click(w.rect("input b.count").center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("-4");
    w.key(Modifiers::NONE, Key::Enter);
    w.settle();
    assert_eq!(state(&w, "b"), "failed");
    out(&mut w);
    assert_eq!(state(&w, "low"), "failed");
    out(&mut w);
    assert_eq!(state(&w, "top"), "failed");
}
