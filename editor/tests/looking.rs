//! Looking around in space by keys, pointer and menus; picking, addresses, colours, sections; points dragged in planes and typed.

use crate::common::{Window, example, folder, graph, like, middle, pixels, small_shell};
use eframe::egui::{Event, Key, Modifiers, MouseWheelUnit, Pos2, TouchPhase, vec2};
use egui_kittest::kittest::Queryable as _;
use tenon_editor::viewport::{Clip, Measure};

/// An arc that can be taken by its points, and a point of its own.
const ARC: &str = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "c": { "type": "ifs_curve", "v": 1, "params": { "points": [[0, 0, 0], [500, 0, 300], [1000, 0, 0]], "iterations": 5 } },
    "p": { "type": "point", "v": 1, "params": { "x": 200, "y": 700, "z": 50 } }
  }
}"#;

fn points(w: &Window) -> Vec<[f64; 3]> {
    serde_json::from_str(&w.param("c", "points")).unwrap()
}

/// Drags with a key held all the while.
fn drag_holding(w: &mut Window, key: Key, from: Pos2, to: Pos2) {
    let press = |w: &mut Window, pressed| {
        let event = Event::Key { key, physical_key: None, pressed, repeat: false, modifiers: Modifiers::NONE };
        w.harness.event(event);
        w.steps(1);
    };
    w.hover(from);
    press(w, true);
    w.drag(from, to);
    press(w, false);
    w.settle();
}

#[test]
fn keys_and_the_wheel_move_the_eye() {
    let mut w = Window::open(Some(&graph("eye", ARC)));
    let area = w.rect("viewport");
    w.hover(area.center());
    let back = |w: &mut Window| w.app().viewport.camera.back();
    let ctrl = Modifiers::COMMAND;
    let keys = [
        (Modifiers::NONE, Key::Num7, [0, 0, 1]),
        (ctrl, Key::Num7, [0, 0, -1]),
        (Modifiers::NONE, Key::Num1, [0, -1, 0]),
        (ctrl, Key::Num1, [0, 1, 0]),
        (Modifiers::NONE, Key::Num3, [1, 0, 0]),
        (ctrl, Key::Num3, [-1, 0, 0]),
    ];
    for (modifiers, key, from) in keys {
        w.key(modifiers, key);
        let seen = back(&mut w);
        assert!(seen.distance(glam::DVec3::from_array(from.map(f64::from))) < 1e-9, "{key:?} looks from {seen}");
    }
    w.key(Modifiers::NONE, Key::Num5);
    assert!(w.app().viewport.camera.orthographic);
    w.key(Modifiers::NONE, Key::Num5);
    // By the menu too.
    w.click(w.rect("Views").center());
    w.click(w.rect_containing("Left").center());
    assert!(back(&mut w).distance(-glam::DVec3::X) < 1e-9);
    w.hover(area.center());
    let distance = w.app().viewport.camera.distance;
    let (unit, delta, phase, modifiers) = (MouseWheelUnit::Point, vec2(0.0, 60.0), TouchPhase::Move, Modifiers::NONE);
    w.harness.event(Event::MouseWheel { unit, delta, phase, modifiers });
    w.steps(10);
    assert!(w.app().viewport.camera.distance < distance, "the wheel goes nearer");
    let before = w.app().viewport.camera;
    let (from, to) = (area.right_bottom() - vec2(60.0, 60.0), area.right_bottom() - vec2(100.0, 80.0));
    w.drag_with(from, to, eframe::egui::PointerButton::Primary, Modifiers::SHIFT);
    let panned = w.app().viewport.camera;
    assert!(panned.target != before.target && panned.yaw == before.yaw, "with Shift it moves");
    w.hover(area.center());
    w.key(Modifiers::NONE, Key::F);
    assert_ne!(w.app().viewport.camera.target, panned.target, "F shows all");
}

#[test]
fn points_are_dragged_along_axes_in_planes_on_grids_and_typed_as_one_step() {
    let mut w = Window::open(Some(&graph("drag", ARC)));
    let before = points(&w);
    for (key, axis) in [(Key::X, 0), (Key::Y, 1), (Key::Z, 2)] {
        let at = w.rect("point c.points 2").center();
        drag_holding(&mut w, key, at, at + vec2(22.0, -27.0));
        let now = points(&w);
        let moved: Vec<usize> = (0..3).filter(|k| now[1][*k] != before[1][*k]).collect();
        assert_eq!(moved, [axis], "{key:?} holds the axis: {now:?}");
        assert_eq!(w.app().model.steps().0, 1);
        w.app().model.undo();
        w.settle();
    }
    let choose = |w: &mut Window, words: &str| {
        w.click(w.rect("More").center());
        w.click(w.rect(words).center());
        w.key(Modifiers::NONE, Key::Escape);
    };
    for (plane, still) in [("XY", 2), ("XZ", 1), ("YZ", 0)] {
        choose(&mut w, plane);
        let at = w.rect("point c.points 2").center();
        w.drag(at, at + vec2(18.0, -15.0));
        w.settle();
        let now = points(&w);
        assert_eq!(now[1][still], before[1][still], "{plane}");
        assert!((0..3).filter(|k| *k != still).all(|k| now[1][k] != before[1][k]), "{plane}: {now:?}");
        w.app().model.undo();
        w.settle();
    }
    // On a grid of 25 mm, and of 40.
    choose(&mut w, "XZ");
    for grid in [25.0, 40.0] {
        w.click(w.rect("More").center());
        w.fill("grid", &grid.to_string());
        w.key(Modifiers::NONE, Key::Escape);
        let at = w.rect("point c.points 2").center();
        w.drag_with(at, at + vec2(20.0, -30.0), eframe::egui::PointerButton::Primary, Modifiers::SHIFT);
        w.settle();
        let snapped = points(&w)[1];
        assert!(snapped != before[1] && snapped.iter().all(|c| c % grid == 0.0), "{grid}: {snapped:?}");
        w.app().model.undo();
        w.settle();
    }

    // Typed: x and z, with Tab from field to field, are one step.
    w.click(w.rect("point p").center());
    assert!(w.app().model.selection.contains("p"));
    let steps = w.app().model.steps().0;
    w.click(w.rect("x of p").center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("431.5");
    assert_eq!(w.param("p", "x"), "200", "nothing is taken before it is typed to its end");
    w.key(Modifiers::NONE, Key::Tab);
    w.key(Modifiers::NONE, Key::Tab);
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("-12");
    w.key(Modifiers::NONE, Key::Enter);
    w.settle();
    assert_eq!((w.param("p", "x"), w.param("p", "z")), ("431.5".to_owned(), "-12".to_owned()));
    assert_eq!(w.app().model.steps().0, steps + 1);
    w.app().model.undo();
    assert_eq!(["x", "y", "z"].map(|a| w.param("p", a)), ["200", "700", "50"]);
}

#[test]
fn curves_and_points_are_picked_and_chosen_nodes_light_up() {
    let mut w = Window::open(Some(&graph("pick", ARC)));
    let area = w.rect("viewport");
    let curve = w.app().model.results.drawings["c.curve"].clone();
    let place = glam::DVec3::from(curve.lines[curve.lines.len() / 3].to.map(f64::from));
    let at = w.app().viewport.camera.project(area, place).unwrap();
    w.click(at);
    let picked = w.app().viewport.picked.clone().expect("the curve is under the pointer");
    assert_eq!((picked.output.as_str(), picked.part), ("c.curve", 0));
    assert!(w.app().model.selection.contains("c"));
    w.picture("picked-curve");
    // The node that is chosen on the canvas lights up in space.
    let lit = |w: &mut Window, node: &str| {
        (w.app().model.selection, w.app().viewport.picked) = ([node.to_owned()].into(), None);
        w.steps(2);
        let picture = w.app().viewport.picture([400, 300]).unwrap();
        picture
            .pixels()
            .filter(|p| p[1] > 180 && p[1] > p[0].saturating_add(40) && p[1] > p[2].saturating_add(40))
            .count()
    };
    let (other, own) = (lit(&mut w, "p"), lit(&mut w, "c"));
    assert!(own > other + 100, "{own} pixels are lit, {other} when another node is chosen");
}

#[test]
fn addresses_stand_on_what_is_seen_and_nothing_is_taken_that_is_cut_away() {
    let mut w = Window::open(Some(&example("shell-256")));
    w.click(w.rect("Addresses").center());
    w.settle();
    let area = w.rect("viewport");
    let names = |w: &mut Window| -> Vec<String> { w.app().viewport.written().iter().map(|l| l.0.clone()).collect() };
    let all = names(&mut w);
    assert!(all.len() > 20 && all.len() < 256, "{} addresses are seen from here", all.len());
    let drawn = w.app().viewport.written().to_vec();
    for (i, (label, rect)) in drawn.iter().enumerate() {
        let over = drawn[..i].iter().find(|(_, r)| r.intersects(*rect));
        assert_eq!(over, None, "{label} lies over another");
    }
    w.picture("addresses");
    w.hover(area.center());
    w.key(Modifiers::COMMAND, Key::Num7);
    w.settle();
    let below = names(&mut w);
    assert_ne!(all, below);
    w.app().viewport.clip = Some(Clip::square_to(0, 2000.0));
    w.settle();
    let parts = w.app().model.results.drawings["thicken.panels"].parts.clone();
    let place = |label: &str| parts.iter().find(|p| p.label == label).unwrap().centre.x;
    assert!(names(&mut w).iter().all(|label| place(label) <= 2000.0));
    assert!(!w.has("point arc.points 3"), "the point at 3600 is cut away");
    assert!(w.has("point arc.points 2"));
}

#[test]
fn a_section_is_made_moved_and_turned_over_by_the_menu_and_bodies_are_filled() {
    let mut w = Window::open(Some(&example("shell-256")));
    w.click(w.rect("More").center());
    w.click(w.rect("Cut open").center());
    w.settle();
    let first = w.app().viewport.clip.unwrap();
    assert!((first.normal.x - 1.0).abs() < 1e-12 && first.at > 1000.0);
    let slider = w.rect("place of the section");
    w.drag(slider.center(), slider.center() + vec2(slider.width() * 0.2, 0.0));
    w.settle();
    assert!(w.app().viewport.clip.unwrap().at > first.at + 100.0);
    w.click(w.rect("Other side").center());
    w.settle();
    assert!((w.app().viewport.clip.unwrap().normal.x + 1.0).abs() < 1e-12);
    w.picture("section-menu");
    w.key(Modifiers::NONE, Key::Escape);
    // Seen from where it is cut, wood is filled in the colour of sections.
    let (at, parts) = (-w.app().viewport.clip.unwrap().at, &w.app().model.results.drawings["thicken.panels"].parts);
    let near = parts.iter().min_by(|a, b| (a.centre.x - at).abs().total_cmp(&(b.centre.x - at).abs())).unwrap().centre;
    let camera = &mut w.app().viewport.camera;
    (camera.target, camera.distance, camera.yaw, camera.pitch) = (near, 500.0, std::f64::consts::PI, 0.1);
    w.settle();
    let picture = w.app().viewport.picture([800, 500]).unwrap();
    let filled = |p: &image::Rgba<u8>| p[0] > 120 && p[0] > p[1].saturating_add(50) && p[1] > p[2].saturating_add(10);
    let count = picture.pixels().filter(|p| filled(p)).count();
    assert!(count > 2000, "{count} pixels are filled");
    w.picture("section-filled");
    w.click(w.rect("More").center());
    w.click(w.rect("This view").center());
    let (clip, back) = (w.app().viewport.clip.unwrap(), w.app().viewport.camera.back());
    assert!(clip.normal.distance(back) < 1e-9, "square to the view");
}

#[test]
fn colours_have_a_range_that_is_typed_and_lists_of_numbers_are_shown() {
    let mut w = Window::open(Some(&example("shell-256")));
    w.click(w.harness.get_by_value("plain").rect().center());
    w.click(w.rect("panel size").center());
    w.settle();
    assert_eq!(w.app().viewport.measure, Some(Measure::Size));
    assert!(w.has("legend"));
    let blue = |w: &mut Window| {
        let picture = w.app().viewport.picture([400, 300]).unwrap();
        picture.pixels().filter(|p| p[2] > 90 && p[2] > p[0].saturating_add(40)).count()
    };
    let before = blue(&mut w);
    // All panels are smaller than the smallest figure now: all are blue.
    w.click(w.rect("largest in colours").center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("0.5");
    w.key(Modifiers::NONE, Key::Enter);
    w.click(w.rect("smallest in colours").center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("0.4");
    w.key(Modifiers::NONE, Key::Enter);
    w.settle();
    let range = w.app().viewport.range.clone().unwrap().1;
    assert!((range[0] - 4e5).abs() < 1.0 && (range[1] - 5e5).abs() < 1.0, "{range:?}");
    let after = blue(&mut w);
    assert!(after > before + before / 2, "{before} blue pixels, then {after}");
    w.picture("legend-range");
    w.double_click(w.rect("legend").center());
    w.steps(2);
    assert_eq!(w.app().viewport.range, None);
}

/// What is said of what is picked.
fn told(w: &Window) -> String {
    w.harness.get_by_label_contains(", panel size ").value().unwrap()
}

/// A figure that stands in what is said, or that an end of the legend shows.
fn figure(text: &str) -> f64 {
    text.trim().split([' ', '°']).next().unwrap().parse().unwrap()
}

#[test]
fn a_panel_that_is_clicked_tells_its_address_and_figures_and_its_node_is_selected() {
    let mut w = Window::open(Some(&small_shell("picked", |_| ())));
    let area = w.rect("viewport");
    w.hover(area.center());
    w.key(Modifiers::NONE, Key::Num7);
    assert!(!w.has_containing(", panel size "), "nothing is picked");
    w.click(area.center() + vec2(20.0, 20.0));
    let words = told(&w);
    let address = words.strip_prefix("thicken.panels ").and_then(|t| t.split(',').next()).unwrap().to_owned();
    assert!(area.contains_rect(w.rect_containing(", panel size ")), "all of it is seen");
    assert!(w.has("thicken") && w.has("Thicken, Panel"), "its node is in the inspector");
    // It is the part of that address on the boards.
    w.click(w.rect("Boards").center());
    w.settle();
    let (board, picture) = (w.rect("board 1"), w.picture("picked-on-board"));
    let orange = |p| like(p, [255, 160, 60]);
    let middle = middle(&picture, board, orange).expect("a part is orange");
    w.rest(middle);
    assert!(w.has_containing(&format!("{address}: board 1")), "{address} is the part at {middle}");
}

#[test]
fn fold_planarity_and_conicity_are_colours_with_a_legend_and_are_told_of_what_is_picked() {
    // A sheet of nine squares with one corner moved: the four around it are neither flat nor conical. And the shell, which folds.
    let sheet = graph(
        "lifted",
        r#"{ "format": "tenon", "version": 1, "nodes": { "m": { "type": "read_mesh", "v": 1, "params": { "path": "sheet.obj" } } } }"#,
    );
    let corner = |i: i32| match i {
        5 => "v 130 110 40\n".to_owned(),
        _ => format!("v {} {} 0\n", i % 4 * 100, i / 4 * 100),
    };
    let face = |i: i32| format!("f {} {} {} {}\n", i, i + 1, i + 5, i + 4);
    let text: String = (0..16).map(corner).chain([1, 2, 3, 5, 6, 7, 9, 10, 11].map(face)).collect();
    std::fs::write(sheet.with_file_name("sheet.obj"), text).unwrap();
    let shell = small_shell("folded", |_| ());
    for (graph, measures, least, most) in [
        (sheet, &["planarity", "conicity"][..], vec2(60.0, -60.0), vec2(0.0, 0.0)),
        (shell, &["fold angle"][..], vec2(-20.0, -20.0), vec2(-20.0, -80.0)),
    ] {
        let mut w = Window::open(Some(&graph));
        let area = w.rect("viewport");
        w.hover(area.center());
        w.key(Modifiers::NONE, Key::Num7);
        let mut chosen = "plain";
        for measure in measures {
            w.click(w.harness.get_by_value(chosen).rect().center());
            w.click(w.rect(measure).center());
            w.settle();
            chosen = measure;
            let end = |w: &Window, name: &str| figure(&w.harness.get_by_label(name).value().unwrap());
            let range = [end(&w, "smallest in colours"), end(&w, "largest in colours")];
            assert!(w.has("legend") && range[0] < range[1], "{measure}: {range:?}");
            let picture = w.picture(&format!("measured-{}", measure.replace(' ', "-")));
            let faces = area.with_max_x(area.right() - 140.0);
            let blue = pixels(&picture, faces, |[r, g, b]| b > r + 60 && b > g + 40);
            let red = pixels(&picture, faces, |[r, g, b]| r > g + 80 && r > b + 80);
            assert!(blue > 2000 && red > 2000, "{measure}: {blue} pixels are blue, {red} red");
            for (at, is) in [(least, range[0]), (most, range[1])] {
                w.click(area.center() + at);
                let words = told(&w);
                let own = figure(words.split(&format!(", {measure} ")).nth(1).unwrap());
                assert!((own - is).abs() < 0.15 * (range[1] - range[0]), "{measure}: {own} of {range:?} in {words}");
            }
            w.key(Modifiers::NONE, Key::Escape);
        }
    }
}

#[test]
fn the_picture_of_the_viewport_and_the_piece_list_leave_the_window() {
    let mut w = Window::open(Some(&example("shell-256")));
    w.click(w.first("Pieces").center());
    w.settle();
    w.click(w.rect("sort by area m²").center());
    w.click(w.rect("Copy as CSV").center());
    let copied = |w: &Window| {
        w.harness.output().platform_output.commands.iter().find_map(|c| match c {
            eframe::egui::OutputCommand::CopyText(text) => Some(text.clone()),
            _ => None,
        })
    };
    // The click is told in one frame only, so it is looked for in each.
    let mut text = copied(&w);
    let button = w.rect("Copy as CSV").center();
    w.harness.hover_at(button);
    for pressed in [true, false] {
        let (button, modifiers) = (eframe::egui::PointerButton::Primary, Modifiers::NONE);
        w.harness.event(Event::PointerButton { pos: w.rect("Copy as CSV").center(), button, pressed, modifiers });
        w.steps(1);
        text = copied(&w).or(text);
    }
    let text = text.expect("it was copied");
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!((lines.len(), lines[0]), (257, "address,board,area m²,volume dm³,edges,holes,time"));
    let area = |line: &str| line.split(',').nth(2).unwrap().parse::<f64>().unwrap();
    assert!(lines[1..].windows(2).all(|l| area(l[0]) <= area(l[1])), "as it is sorted");
    let file = folder("saved").join("view.png");
    w.app().viewport.picture_size = [64, 48];
    let ctx = w.harness.ctx.clone();
    w.app().viewport.save_picture(&ctx, &file).unwrap();
    w.settle();
    assert_eq!(image::open(&file).unwrap().to_rgba8().dimensions(), (64, 48));
    assert!(w.harness.query_by_label("sort by time").is_some());
}
