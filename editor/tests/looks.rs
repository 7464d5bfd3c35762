//! How nodes and wires look, and what is said of them: previews, folds, badges, tooltips, ports that light up, strands.

use crate::common::{Window, folder, graph, places, rgb};
use eframe::egui::{Key, Modifiers, PointerButton, vec2};
use egui_kittest::kittest::Queryable as _;
use tenon_engine::{NodeState, Operation};

const SHAPES: &str = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "s": { "type": "series", "v": 1, "params": { "count": 4 } },
    "one": { "type": "number", "v": 1, "params": { "value": 2 } },
    "g": { "type": "text_panel", "v": 1, "inputs": { "data": { "from": ["s.numbers"], "tree": ["graft"] } } },
    "item": { "type": "point", "v": 1, "inputs": { "x": { "from": ["one.value"] } } },
    "list": { "type": "point", "v": 1, "inputs": { "x": { "from": ["s.numbers"] } } },
    "tree": { "type": "point", "v": 1, "inputs": { "x": { "from": ["g.data"] } } }
  }
}"#;

#[test]
fn previews_and_folds_are_steps_and_are_kept_with_the_graph() {
    let path = folder("looks").join("graph.tenon.json");
    std::fs::write(&path, SHAPES).unwrap();
    let mut w = Window::open(Some(&path));
    w.app().model.selection = ["item".to_owned(), "list".to_owned()].into();
    w.key(Modifiers::COMMAND, Key::Q);
    assert!(!w.app().model.previews("item") && !w.app().model.previews("list"));
    assert_eq!(w.app().model.steps(), (1, 0), "one step for both");
    w.settle();
    assert!(!w.app().model.results.drawings.contains_key("item.point"));
    w.picture("hidden");
    w.key(Modifiers::COMMAND, Key::Z);
    assert!(w.app().model.previews("item"));
    w.key(Modifiers::COMMAND, Key::Y);
    w.app().model.fold("g");
    w.app().model.save(None).unwrap();
    assert!(!w.app().model.unsaved());
    let mut again = Window::open(Some(&path));
    assert!(!again.app().model.previews("item") && again.app().model.previews("tree"));
    assert!(again.app().model.document().look("g").open);
    // A copy looks like what it is of.
    again.app().model.selection = ["item".to_owned()].into();
    again.key(Modifiers::COMMAND, Key::D);
    assert!(!again.app().model.previews("item-2"));
}

#[test]
fn wires_are_one_line_two_or_two_broken_ones_by_what_they_bring() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "a": { "type": "number", "v": 1, "params": { "value": 2 } },
    "b": { "type": "series", "v": 1, "params": { "count": 4 } },
    "c": { "type": "series", "v": 1, "params": { "count": 4 } },
    "d": { "type": "reroute", "v": 1, "inputs": { "value": { "from": ["c.numbers"], "tree": ["graft"] } } },
    "item": { "type": "point", "v": 1, "inputs": { "x": { "from": ["a.value"] } } },
    "list": { "type": "point", "v": 1, "inputs": { "x": { "from": ["b.numbers"] } } },
    "tree": { "type": "point", "v": 1, "inputs": { "x": { "from": ["d.value"] } } }
  }
}"#;
    let mut w = Window::open(Some(&graph("strands", text)));
    // Ports stand level, so that wires run straight.
    let places = [
        ("a", [0, 0]),
        ("b", [0, 140]),
        ("c", [-260, 280]),
        ("d", [150, 307]),
        ("item", [420, -20]),
        ("list", [420, 120]),
        ("tree", [420, 260]),
    ];
    for (node, to) in places {
        w.app().model.edit(Operation::Move { node: node.into(), to: Some(to.map(f64::from)) });
    }
    w.hover(w.rect("canvas").center());
    w.key(Modifiers::NONE, Key::Home);
    w.settle();
    for ground in ["Dark", "Light"] {
        w.click(w.rect("View").center());
        w.click(w.rect(ground).center());
        w.key(Modifiers::NONE, Key::Escape);
        w.steps(3);
        // Near enough for the lines of one wire to be told apart.
        while w.app().canvas.view.zoom < 1.6 {
            let at = w.rect("input list.x").left_center() - vec2(40.0, 0.0);
            w.wheel(at, 60.0);
        }
        w.hover(w.rect("File").center());
        let picture = w.picture(&format!("strands-{}", ground.to_lowercase()));
        let mut counts = Vec::new();
        for to in ["item", "list", "tree"] {
            let end = w.rect(&format!("input {to}.x")).left_center();
            let empty = rgb(&picture, end + vec2(-60.0, 12.0));
            // How many lines each column of pixels crosses.
            let across = |x: i32| {
                let is: Vec<bool> = (-9..=9)
                    .map(|y| rgb(&picture, end + vec2(x as f32, y as f32)))
                    .map(|p| (0..3).any(|k| (p[k] - empty[k]).abs() > 40))
                    .collect();
                usize::from(is[0]) + is.windows(2).filter(|p| p[1] && !p[0]).count()
            };
            let all: Vec<usize> = (-100..-15).map(across).collect();
            counts.push([0, 1, 2].map(|n| all.iter().filter(|c| **c == n).count()));
        }
        let [item, list, tree] = counts[..] else { panic!() };
        assert_eq!((item, list), ([0, 85, 0], [0, 0, 85]), "one line, and two, on {ground}");
        assert!(tree[2] > 30 && tree[0] > 10 && tree[1] < 20, "two broken lines: {tree:?} on {ground}");
    }
}

#[test]
fn a_header_says_how_long_its_node_took_or_what_keeps_it() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "long": { "type": "series", "v": 1, "params": { "count": 900000 } },
    "wrong": { "type": "series", "v": 1, "params": { "count": -4 } },
    "after": { "type": "point", "v": 1, "inputs": { "x": { "from": ["wrong.numbers"] } } },
    "off": { "type": "number", "v": 1, "state": "disabled" },
    "p": { "type": "point", "v": 1 }
  }
}"#;
    let mut w = Window::open(Some(&graph("headers", text)));
    let state = |w: &Window, node: &str| w.harness.get_by_label(&format!("node {node}")).value().unwrap();
    let took = w.app().model.results.nodes["long"].time;
    assert_eq!(state(&w, "long"), tenon_editor::theme::duration(took));
    for (node, words) in [("wrong", "failed"), ("after", "blocked"), ("off", "off")] {
        assert_eq!(state(&w, node), words);
    }
    w.click(w.rect("node p").center());
    w.key(Modifiers::COMMAND, Key::Q);
    w.settle();
    assert!(state(&w, "p").starts_with("hidden  "));
    w.click(w.rect("node long").center());
    w.key(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::E);
    assert_eq!(state(&w, "long"), "frozen");
    // What is told is painted on the right of the header.
    let ink = |w: &mut Window, name: &str| {
        let (picture, header) = (w.picture(name), w.rect("node off"));
        let right = header.shrink(3.0).with_min_x(header.right() - 60.0);
        let ground = rgb(&picture, header.center() - vec2(0.0, header.height() * 0.35));
        places(right).filter(|at| (0..3).any(|k| (rgb(&picture, *at)[k] - ground[k]).abs() > 60)).count()
    };
    let written = ink(&mut w, "header-off");
    w.click(w.rect("node off").center());
    w.key(Modifiers::COMMAND, Key::E);
    w.settle();
    let longer = ink(&mut w, "header-on");
    assert!(written > 10 && longer > written, "{written} pixels of ink, then {longer}");
}

/// Where a colour stands on the wheel, degrees: the same for its paler and darker shades.
fn hue(p: [i32; 3]) -> f64 {
    let [r, g, b] = p.map(f64::from);
    (3f64.sqrt() * (g - b)).atan2(2.0 * r - g - b).to_degrees()
}

#[test]
fn ports_and_wires_have_the_colour_of_their_type_on_both_grounds() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "n": { "type": "number", "v": 1, "params": { "value": 3 } },
    "p": { "type": "point", "v": 1, "inputs": { "x": { "from": ["n.value"] } } },
    "c": { "type": "ifs_curve", "v": 1, "inputs": { "points": { "from": ["p.point", "q.point"] } } },
    "q": { "type": "point", "v": 1, "params": { "x": 900, "z": 300 } },
    "d": { "type": "ifs_curve", "v": 1, "params": { "points": [[0, 0, 0], [0, 500, 0]] } },
    "s": { "type": "vector_sum", "v": 1, "inputs": { "a": { "from": ["c.curve"] }, "b": { "from": ["d.curve"] } } },
    "t": { "type": "thicken", "v": 1, "inputs": { "mesh": { "from": ["s.mesh"] } } },
    "m": { "type": "map", "v": 1, "inputs": { "panels": { "from": ["t.panels"] } } }
  }
}"#;
    let mut w = Window::sized(Some(&graph("hues", text)), vec2(1920.0, 900.0));
    for ground in ["Dark", "Light"] {
        w.click(w.rect("View").center());
        w.click(w.rect(ground).center());
        w.key(Modifiers::NONE, Key::Escape);
        w.settle();
        let picture = w.picture(&format!("types-{}", ground.to_lowercase()));
        let mut hues: Vec<f64> = Vec::new();
        for [from, to] in [
            ["n.value", "p.x"],
            ["p.point", "c.points"],
            ["c.curve", "s.a"],
            ["s.mesh", "t.mesh"],
            ["t.panels", "m.panels"],
        ] {
            let [a, b] =
                [w.rect(&format!("output {from}")).right_center(), w.rect(&format!("input {to}")).left_center()];
            let dot = rgb(&picture, a);
            assert_eq!(dot, rgb(&picture, b), "{from} and {to} on {ground}");
            // A wire runs through the middle between its ends, where it is the most colourful.
            let near = (-3..=3).flat_map(|x| (-3..=3).map(move |y| vec2(x as f32, y as f32)));
            let colour = |p: &[i32; 3]| p.iter().max().unwrap() - p.iter().min().unwrap();
            let wire = near.map(|by| rgb(&picture, a.lerp(b, 0.5) + by)).max_by_key(colour).unwrap();
            let apart = |x: f64, y: f64| ((x - y + 540.0).rem_euclid(360.0) - 180.0).abs();
            let own = hue(dot);
            assert!(apart(hue(wire), own) < 14.0, "the wire of {from} is {wire:?}, its port {dot:?} on {ground}");
            assert!(hues.iter().all(|h| apart(*h, own) > 30.0), "{from} is like another on {ground}: {hues:?}, {own}");
            hues.push(own);
        }
    }
}

#[test]
fn tooltips_tell_what_ports_and_nodes_are_and_hold() {
    let mut w = Window::open(Some(&graph("tips", SHAPES)));
    w.rest(w.rect("output s.numbers").center());
    assert!(w.has_containing("numbers: list of number"), "the type");
    assert!(w.has_containing("4 items"), "and how many");
    w.picture("tooltip-port");
    w.rest(w.rect("input list.x").center());
    assert!(w.has_containing("from s.numbers"));
    w.rest(w.rect("node s").center());
    assert!(w.has_containing("Series (series)"));
}

#[test]
fn badges_count_what_is_wrong_and_say_it() {
    let mut w = Window::open(Some(&graph("badges", SHAPES)));
    assert!(!w.has("problems of s"));
    let value = Some((-5).into());
    w.app().model.edit(Operation::SetParam { node: "s".into(), port: "count".into(), value });
    w.settle();
    w.picture("badge");
    w.rest(w.rect("problems of s").center());
    assert!(w.has_containing("count: "), "the port and the message stand there");
    assert!(w.has_containing("-5"), "with the number");
}

#[test]
fn a_warning_has_a_badge_of_its_own_colour() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "read": { "type": "read_mesh", "v": 1, "params": { "path": "bent.obj" } },
    "flat": { "type": "planarize", "v": 1, "params": { "iterations": 0 }, "inputs": { "mesh": { "from": ["read.mesh"] } } }
  }
}"#;
    let path = graph("warned", text);
    std::fs::write(path.with_file_name("bent.obj"), "v 0 0 0\nv 900 0 0\nv 900 900 300\nv 0 900 0\nf 1 2 3 4\n")
        .unwrap();
    let mut w = Window::open(Some(&path));
    let (errors, warnings) = w.app().model.results.counts();
    assert!(errors == 0 && warnings > 0, "{:?}", w.app().model.results.diagnostics);
    let message = w.app().model.results.of_node("flat").next().unwrap().message.clone();
    let badge = w.rect("problems of flat");
    let picture = w.picture("badge-warning");
    let inside = |x: u32, y: u32| badge.contains(eframe::egui::pos2(x as f32, y as f32));
    let orange = |p: &image::Rgba<u8>| p[0] > 220 && (140..180).contains(&p[1]) && p[2] < 70;
    let count = picture.enumerate_pixels().filter(|(x, y, p)| inside(*x, *y) && orange(p)).count();
    assert!(count as f32 > badge.area() * 0.4, "{count} pixels of {badge} are orange");
    w.rest(badge.center());
    assert!(w.has_containing(&message), "{message}");
}

#[test]
fn ports_that_a_wire_fits_light_up_while_it_is_drawn() {
    let mut w = Window::open(Some(&graph("light", SHAPES)));
    let from = w.rect("output one.value").right_center();
    let fit = w.rect("input item.y").left_center();
    let unfit = w.rect("output item.point").right_center();
    let near = |image: &image::RgbaImage, at: eframe::egui::Pos2, r: f32| -> image::Rgba<u8> {
        *image.get_pixel((at.x + r) as u32, at.y as u32)
    };
    let before = w.picture("ports-at-rest");
    w.press(from, from + vec2(20.0, 60.0), Modifiers::NONE);
    let during = w.picture("ports-lit");
    // A point off the middle of a dot is of its colour only while the dot is large.
    let zoom = w.app().canvas.view.zoom;
    assert_ne!(near(&before, fit, -6.0 * zoom), near(&during, fit, -6.0 * zoom), "the dot grows");
    assert_ne!(near(&before, unfit, 3.8 * zoom), near(&during, unfit, 3.8 * zoom), "the other one shrinks");
    w.key(Modifiers::NONE, Key::Escape);
    w.release(from + vec2(20.0, 60.0));
    assert!(!w.has("find a node for number"), "the wire was given up");
}

#[test]
fn many_wires_go_into_one_list_and_the_best_port_is_taken_and_named() {
    let text = SHAPES.replacen("\"one\"", "\"l\": { \"type\": \"list\", \"v\": 1 },\n    \"one\"", 1);
    let mut w = Window::open(Some(&graph("list", &text)));
    for source in ["output one.value", "output s.numbers"] {
        w.drag(w.rect(source).right_center(), w.rect("input l.items").left_center());
    }
    let wires = w.app().model.document().nodes()["l"].inputs.get("items").unwrap().clone();
    assert_eq!(wires.from.as_slice(), ["one.value", "s.numbers"], "in the order in which they came");
    w.settle();
    assert_eq!(w.app().model.results.values["l.items"].len(), 5);
    // Let go on the title of a node, a wire takes the port that suits it and waits for one.
    w.drag(w.rect("output one.value").right_center(), w.rect("node item").center());
    assert_eq!(w.app().model.document().nodes()["item"].inputs.get("y").unwrap().from.as_slice(), ["one.value"]);
    let said = w.app().model.said.clone().unwrap();
    assert!(said.contains("item.y"), "{said}");
    assert!(w.has_containing("item.y, which suits it best"));
}

#[test]
fn nodes_are_bypassed_and_frozen_by_their_menu() {
    let mut w = Window::open(Some(&graph("bypass", SHAPES)));
    let state = |w: &Window, id: &str| w.harness.state().model.document().nodes()[id].state;
    for (words, want) in [("Bypass", NodeState::Bypassed), ("Freeze", NodeState::Frozen), ("Enable", NodeState::On)] {
        w.click_with(w.rect("node s").center(), PointerButton::Secondary, Modifiers::NONE);
        w.click(w.rect(words).center());
        assert_eq!(state(&w, "s"), want);
    }
    w.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(state(&w, "s"), NodeState::Frozen);
    // A frozen node keeps what it made.
    w.settle();
    w.app().model.edit(Operation::SetParam { node: "s".into(), port: "count".into(), value: Some(9.into()) });
    w.settle();
    assert_eq!(w.app().model.results.values["s.numbers"].len(), 4);
}

#[test]
fn toggles_and_choices_are_set_on_the_canvas() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "yes": { "type": "boolean", "v": 1, "params": { "value": true } },
    "curve": { "type": "ifs_curve", "v": 1, "params": { "preset": "takagi" } }
  }
}"#;
    let mut w = Window::open(Some(&graph("toggle", text)));
    w.click(w.rect("input yes.value").center());
    assert_eq!(w.param("yes", "value"), "false");
    w.click(w.rect("input curve.preset").center());
    w.steps(2);
    w.picture("choice");
    let other = w
        .app()
        .model
        .catalog
        .get("ifs_curve")
        .unwrap()
        .inputs
        .iter()
        .find(|p| p.name == "preset")
        .unwrap()
        .choices
        .clone();
    let other = other.iter().find(|c| *c != "takagi").unwrap().clone();
    w.click(w.first(&other).center());
    assert_eq!(w.param("curve", "preset"), format!("\"{other}\""));
    w.key(Modifiers::COMMAND, Key::Z);
    w.key(Modifiers::COMMAND, Key::Z);
    assert_eq!((w.param("yes", "value"), w.param("curve", "preset")), ("true".into(), "\"takagi\"".into()));
}

#[test]
fn a_step_that_a_field_began_ends_when_another_node_is_chosen() {
    let mut w = Window::open(Some(&graph("held", SHAPES)));
    w.click(w.rect("node one").center());
    let note = w.harness.ctx.read_response(eframe::egui::Id::new(("note", "one"))).unwrap().rect;
    w.click(note.center());
    w.type_text("kept");
    // Another node is chosen without a click that would take the keyboard from the field.
    w.app().model.selection = ["s".to_owned()].into();
    w.steps(3);
    assert_eq!(w.app().model.steps(), (1, 0));
    w.app().model.edit(Operation::SetParam { node: "one".into(), port: "value".into(), value: Some(9.into()) });
    assert_eq!(w.app().model.steps(), (2, 0), "what comes next is a step of its own");
    w.app().model.undo();
    assert_eq!(
        (w.param("one", "value"), w.app().model.document().nodes()["one"].more.note.clone()),
        ("2".into(), Some("kept".into()))
    );
}
