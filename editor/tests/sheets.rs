//! Text panels that show what a wire brings, and value lists.

use crate::common::{Window, graph};
use eframe::egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable as _;
use tenon_engine::Operation;

const LONG: &str = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "s": { "type": "series", "v": 1, "params": { "count": 1000 } },
    "t": { "type": "text_panel", "v": 1, "inputs": { "data": { "from": ["s.numbers"] } } },
    "u": { "type": "text_panel", "v": 1, "inputs": { "data": { "from": ["t.data"], "tree": ["graft"] } } }
  }
}"#;

#[test]
fn a_text_panel_shows_its_wire_and_turns_its_lines() {
    let mut w = Window::open(Some(&graph("sheet", LONG)));
    let (zoom, node) = (w.app().canvas.view.zoom, w.rect("node t"));
    let body = node.center() + vec2(0.0, 60.0);
    let picture = w.picture("text-panel");
    let shown = |w: &Window, node: &str| -> Vec<String> {
        let text = w.harness.get_by_label(&format!("lines of {node}")).value().unwrap();
        text.lines().map(str::to_owned).collect()
    };
    let first = shown(&w, "t");
    assert!((8..12).contains(&first.len()), "{first:?}");
    assert!(first.iter().enumerate().all(|(i, line)| *line == format!("{i}  {i}.0")), "{first:?}");
    assert_eq!(shown(&w, "u")[..4], ["{0;0}", "0  0.0", "{0;1}", "0  1.0"], "branches stand under their paths");
    // There they are painted, one below another.
    let paper = w.rect("lines of t").shrink(8.0 * zoom);
    let ground = i32::from(picture.get_pixel(paper.center().x as u32, paper.center().y as u32)[0]);
    let ink = |x: u32, y: u32| (i32::from(picture.get_pixel(x, y)[0]) - ground).abs() > 90;
    let inked = |y: u32| (paper.left() as u32..paper.center().x as u32 - 4).any(|x| ink(x, y));
    let rows: Vec<bool> = (paper.top() as u32..paper.bottom() as u32).map(inked).collect();
    let lines = usize::from(rows[0]) + rows.windows(2).filter(|p| p[1] && !p[0]).count();
    assert!((8..=10).contains(&lines), "{lines} lines are painted");
    w.wheel(body, -160.0);
    let line = w.app().canvas.first_line("t");
    let now = shown(&w, "t");
    assert_eq!(now[0], format!("{0}  {0}.0", line.floor()));
    assert!(line > 5.0, "{line}");
    assert_eq!(w.app().canvas.view.zoom, zoom, "the canvas stays");
    for _ in 0..3 {
        w.wheel(body, -100_000.0);
    }
    let last = w.app().canvas.first_line("t");
    assert!(last > 980.0 && last < 1000.0, "{last}");
    assert!(shown(&w, "t").contains(&"999  999.0".to_owned()), "the last line is there");
    w.picture("text-panel-end");
    w.wheel(body, 100_000.0);
    assert_eq!(w.app().canvas.first_line("t"), 0.0);
    // It passes on what it shows.
    assert_eq!(w.app().model.results.values["u.data"].branches().len(), 1000);
    // Its ends take wires like those of every node.
    let out = w.rect("output s.numbers").right_center();
    w.app().model.edit(Operation::PutWires { node: "u".into(), port: "data".into(), wires: None });
    w.steps(2);
    w.drag(out, w.rect("input u.data").left_center());
    assert_eq!(w.app().model.document().nodes()["u"].inputs.get("data").unwrap().from.as_slice(), ["s.numbers"]);
}

#[test]
fn a_value_list_is_chosen_from_and_its_entries_are_edited() {
    let mut w = Window::open(None);
    w.double_click(w.rect("canvas").center());
    w.type_text("value list");
    w.key(Modifiers::NONE, Key::Enter);
    w.settle();
    let value = |w: &Window| w.harness.state().model.results.values["value_list.value"].to_json().to_string();
    assert!(value(&w).contains("[1]"), "the first: {}", value(&w));
    w.picture("value-list");
    w.click(w.rect("input value_list.chosen").center());
    w.steps(2);
    w.picture("value-list-open");
    w.click(w.rect("three").center());
    w.settle();
    assert!(value(&w).contains("[3]"), "{}", value(&w));
    w.click(w.rect("input value_list.chosen").center());
    w.steps(2);
    w.click(w.rect("Edit the entries …").center());
    w.steps(3);
    w.fill("name of entry 3", "thick");
    w.fill("value of entry 3", "18.5");
    w.click(w.rect("Add an entry").center());
    w.picture("entries");
    assert_eq!(w.param("value_list", "names"), "[\"one\",\"two\",\"thick\",\"entry 4\"]");
    assert_eq!(w.param("value_list", "values"), "[1,2,18.5,18.5]");
    w.key(Modifiers::NONE, Key::Escape);
    w.settle();
    let model = &w.app().model;
    assert_eq!(model.param("value_list", "chosen").unwrap(), "thick", "what is chosen stays chosen");
    assert!(value(&w).contains("18.5"), "{}", value(&w));
    // The menu of the node opens them too, and every step is taken back.
    w.click_with(w.rect("node value_list").center(), PointerButton::Secondary, Modifiers::NONE);
    w.click(w.rect("Edit the entries …").center());
    w.steps(2);
    assert!(w.has("name of entry 4"));
    while w.app().model.undo() {}
    w.steps(2);
    assert!(w.app().model.document().nodes().is_empty());
}
