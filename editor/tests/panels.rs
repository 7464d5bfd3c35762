//! The panels around the canvas: problems, data as tables and trees, examples of nodes.

use crate::common::{Window, example, graph};
use eframe::egui::{Event, Key, Modifiers};
use egui_kittest::kittest::Queryable as _;
use std::time::{Duration, Instant};

const WRONG: &str = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "a": { "type": "series", "v": 1, "params": { "count": 3 } },
    "b": { "type": "series", "v": 1, "params": { "count": -4 } },
    "p": { "type": "point", "v": 1, "inputs": { "x": { "from": ["a.numbers"], "tree": ["graft"] } } }
  }
}"#;

#[test]
fn a_click_on_a_problem_goes_to_its_node() {
    let mut w = Window::open(Some(&graph("problems", WRONG)));
    let (errors, _) = w.app().model.results.counts();
    assert!(errors > 0);
    w.click(w.first_containing(" errors, ").center());
    w.steps(3);
    w.picture("problems");
    let of_b = w.harness.get_all_by_label_contains("out-of-range").next().unwrap().rect();
    w.click(of_b.center());
    w.steps(3);
    assert_eq!(w.app().model.selection.iter().collect::<Vec<_>>(), ["b"]);
    let (canvas, node) = (w.rect("canvas"), w.rect("node b"));
    assert!(canvas.contains(node.center()), "it is in sight");
    // Mended, it is told no more.
    w.key(Modifiers::COMMAND, Key::Z);
    w.app().model.edit(tenon_engine::Operation::SetParam { node: "b".into(), port: "count".into(), value: None });
    w.settle();
    assert!(w.has("Nothing is wrong."));
}

#[test]
fn values_at_outputs_and_inputs_are_tables_and_trees() {
    let mut w = Window::open(Some(&graph("data", WRONG)));
    w.app().model.selection = ["a".to_owned()].into();
    w.click(w.first("Data").center());
    w.settle();
    assert!(w.has("3 numbers from 0 to 2, mean 1.0000"));
    // What arrives at an input, as its wires bring it.
    w.app().model.selection = ["p".to_owned()].into();
    w.settle();
    w.click(w.rect("port that is shown").center());
    w.settle();
    w.click(w.rect("into p.x").center());
    w.settle();
    assert!(w.has_containing("3 branches, 3 items of number"));
    w.click(w.rect("Tree").center());
    w.steps(2);
    let branch = w.first_containing("+ {0;1}");
    w.click(branch.center());
    w.steps(2);
    assert!(w.has_containing("− {0;1}"), "it is open");
    w.picture("data-tree");
    w.click(w.rect("open all").center());
    w.steps(2);
    assert!(w.has_containing("− {0;2}"));
}

#[test]
fn a_million_rows_and_branches_are_scrolled_through() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "s": { "type": "series", "v": 1, "params": { "count": 1000000 } },
    "t": { "type": "text_panel", "v": 1, "inputs": { "data": { "from": ["s.numbers"], "tree": ["graft"] } } }
  }
}"#;
    let mut w = Window::open(Some(&graph("million", text)));
    w.app().model.selection = ["s".to_owned()].into();
    w.click(w.first("Data").center());
    w.settle();
    assert!(w.has_containing("1000000 items of number"));
    let row = w.first_containing(&format!("{:<10} {:>8}", "{0}", 0)).center();
    let start = Instant::now();
    for _ in 0..5 {
        w.wheel(row, -40_000_000.0);
    }
    // A hundred and fifty frames; the whole table would take seconds for each.
    assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
    assert!(w.has_containing("  999999  "), "the last row is there");
    w.picture("million");
    // As many branches, all open: two million rows.
    w.app().model.selection = ["t".to_owned()].into();
    w.settle();
    w.click(w.rect("Tree").center());
    w.click(w.rect("open all").center());
    assert!(w.has_containing("1000000 branches, 1000000 items of number"));
    let (row, start) = (w.first_containing("− {0;0}").center(), Instant::now());
    for _ in 0..5 {
        w.wheel(row, -40_000_000.0);
    }
    assert!(start.elapsed() < Duration::from_secs(60), "{:?}", start.elapsed());
    w.picture("million-branches");
    assert!(w.has_containing("− {0;999999}"), "the last branch is there");
}

#[test]
fn examples_of_a_node_are_put_into_the_graph() {
    let mut w = Window::open(Some(&example("shell-256")));
    w.app().model.selection = ["thicken".to_owned()].into();
    w.steps(3);
    let before = w.app().model.document().nodes().len();
    w.harness.get_by_label("Examples").scroll_to_me();
    w.steps(5);
    w.click(w.rect("Examples").center());
    w.settle();
    w.steps(30);
    w.harness.get_all_by_label("Insert").next().unwrap().scroll_to_me();
    w.steps(10);
    w.picture("examples-of-a-node");
    w.click(w.first("Insert").center());
    w.steps(3);
    assert!(w.app().model.document().nodes().len() > before, "{:?}", w.app().model.message);
    assert!(w.app().model.selection.iter().any(|id| id.starts_with("thicken")));
    w.app().model.undo();
    assert_eq!(w.app().model.document().nodes().len(), before, "one step");
}

#[test]
fn what_is_copied_as_csv_comes_into_the_clipboard() {
    let mut w = Window::open(Some(&graph("csv", WRONG)));
    w.app().model.selection = ["a".to_owned()].into();
    w.click(w.first("Data").center());
    w.settle();
    let button = w.rect("Copy as CSV").center();
    w.hover(button);
    let press = |pressed| Event::PointerButton {
        pos: button,
        button: eframe::egui::PointerButton::Primary,
        pressed,
        modifiers: Modifiers::NONE,
    };
    w.harness.event(press(true));
    w.steps(1);
    let text = w.clipboard(press(false));
    assert!(text.eq("path,index,number\n{0},0,0.0\n{0},1,1.0\n{0},2,2.0\n"), "{text}");
}

#[test]
fn the_profile_names_the_longest_chain() {
    let mut w = Window::open(Some(&example("quad-mesh")));
    w.click(w.rect("Profile").center());
    w.steps(2);
    let model = &w.app().model;
    let time = |id: &str| model.results.nodes.get(id).map_or(std::time::Duration::ZERO, |r| r.time);
    let (chain, longest) = tenon_editor::model::critical::critical_path(model.document(), time);
    let sum: std::time::Duration = chain.iter().map(|id| time(id)).sum();
    assert!(chain.len() > 3 && sum == longest && chain.contains(&"planarize".to_owned()), "{chain:?}");
    let words = format!("the longest chain takes {} ({} nodes", tenon_editor::theme::duration(longest), chain.len());
    assert!(w.has_containing(&words), "{words}");
    w.picture("profile-chain");
}

#[test]
fn a_value_that_goes_to_several_ports_is_set_as_one_step() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "interface": { "inputs": { "order": { "port": ["a.keep_order", "b.keep_order", "c.keep_order"] } } },
  "nodes": {
    "a": { "type": "pack", "v": 1 },
    "b": { "type": "pack", "v": 1 },
    "c": { "type": "pack", "v": 1 }
  }
}"#;
    let mut w = Window::open(Some(&graph("shared-value", text)));
    let kept = |w: &mut Window| ["a", "b", "c"].map(|n| w.app().model.param(n, "keep_order"));
    let toggle = w.harness.get_by_role(eframe::egui::accesskit::Role::CheckBox).rect().center();
    w.click(toggle);
    assert_eq!(kept(&mut w), [Some(true.into()), Some(true.into()), Some(true.into())]);
    assert_eq!(w.app().model.steps(), (1, 0));
    w.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(kept(&mut w), [None, None, None]);
}
