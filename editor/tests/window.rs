//! The window itself: it never waits, and what it shows besides the graph.

use crate::common::{Window, example, faulty_shell, folder, graph};
use eframe::egui::{Key, Modifiers, PointerButton, Rect, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use std::time::{Duration, Instant};
use tenon_engine::Diagnostic;
use tenon_geometry::proof::ProofReport;
use tenon_nodes::value::V;

/// Twenty-five million sums, one by one.
const SLOW: &str = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": {
    "a": { "type": "series", "v": 1, "params": { "count": 5000 } },
    "p": { "type": "point", "v": 1, "match": "cross",
           "inputs": { "x": { "from": ["a.numbers"] }, "y": { "from": ["a.numbers"] } } }
  }
}"#;

#[test]
fn a_slow_node_holds_no_frame_and_escape_stops_it() {
    let mut w = Window::unsettled(Some(&graph("slow", SLOW)), vec2(1280.0, 800.0));
    let start = Instant::now();
    w.steps(5);
    assert!(!w.app().model.settled(), "it takes seconds");
    // Meanwhile the document is worked on.
    w.app().model.selection = ["a".to_owned()].into();
    w.key(Modifiers::COMMAND, Key::D);
    assert!(w.app().model.document().nodes().contains_key("a-2"));
    w.app().model.undo();
    // The canvas moves under the hand.
    let before = w.rect("node a");
    let empty = w.rect("canvas").left_bottom() + vec2(60.0, -60.0);
    w.drag_with(empty, empty + vec2(40.0, -30.0), PointerButton::Secondary, Modifiers::NONE);
    let moved = w.rect("node a").center() - before.center();
    assert!((moved - vec2(40.0, -30.0)).length() < 1.0, "{moved}");
    assert!(!w.app().model.settled(), "it goes on");
    while !w.app().model.is_running() {
        assert!(start.elapsed() < Duration::from_secs(60), "it never begins");
        w.steps(1);
    }
    let escaped = Instant::now();
    w.key(Modifiers::NONE, Key::Escape);
    while !w.app().model.settled() {
        assert!(escaped.elapsed() < Duration::from_secs(60), "it does not stop");
        std::thread::sleep(Duration::from_millis(5));
        w.steps(1);
    }
    assert!(w.app().model.results.cancelled, "it was stopped, not finished");
    assert!(w.app().model.was_stopped_at("p") && !w.app().model.was_stopped_at("a"), "the node says so");
    w.steps(2);
    assert!(w.has("stopped; F5 runs it again"));
}

#[test]
fn pieces_are_a_table_that_is_sorted_and_picks_panels() {
    let mut w = Window::open(Some(&example("shell-256")));
    w.click(w.first("Pieces").center());
    w.settle();
    assert!(w.has("sort by time"));
    w.click(w.rect("sort by area m²").center());
    w.click(w.rect("sort by area m²").center());
    w.picture("pieces");
    let first = w.first_containing("piece ");
    w.click(first.center());
    let picked = w.app().viewport.picked.clone().expect("a piece is a panel");
    let parts = &w.app().model.results.drawings["thicken.panels"].parts;
    let largest = parts.iter().map(|p| p.area).fold(0.0, f64::max);
    assert!((parts[picked.part as usize].area - largest).abs() < 1.0, "the largest comes first");
    // Parts take time at the machine, all of it that programs take but for changes between them.
    let plays = w.app().boards.plays();
    let times = plays[0].time_of_parts();
    let sum: f64 = times.values().sum();
    assert!(times.len() > 50 && (sum - plays[0].length()).abs() < 1e-6, "{} parts, {sum} s", times.len());
}

#[test]
fn what_a_proof_has_found_is_marked_on_the_board() {
    let mut w = Window::open(Some(&faulty_shell()));
    w.click(w.rect("Boards").center());
    w.settle();
    let found = w.app().boards.player.faults.clone();
    let faults = &found.told;
    assert!(!faults.is_empty(), "{:?}", w.app().model.results.diagnostics);
    assert!(faults.iter().any(|f| f.at.is_some()));
    w.picture("faults");
    // One is chosen: the tool goes there, and its line is the fault's.
    let own: Vec<_> = faults.iter().filter(|f| f.board == 0).cloned().collect();
    let first = own.iter().find(|f| f.line.is_some()).unwrap();
    // The proof tells the first hundred of each program and counts the others.
    let report = w.app().model.results.values["prove.report"].first::<V<ProofReport>>().unwrap().clone();
    let more = report.programs[0].omitted;
    assert!(own.len() == 100 && more > 0, "{} are listed, {more} are not", own.len());
    w.click(w.rect(&format!("100 of {} faults", 100 + more)).center());
    w.picture("faults-listed");
    w.click(w.first(&first.words).center());
    w.settle();
    let boards = &w.app().boards;
    let (play, now) = boards.now().expect("something is played");
    assert_eq!(Some(play.steps[now.step].line), first.line, "{}", first.words);
    assert!(boards.player.struck(play, now), "the tool is marked there");
    w.picture("fault-chosen");
}

#[test]
fn newcomers_are_offered_the_examples_once_and_take_the_tour_through_its_three_steps() {
    let mut w = Window::open(None);
    let ctx = w.harness.ctx.clone();
    let state = folder("newcomer");
    w.app().remember_in(&ctx, Some(state.clone()));
    w.steps(2);
    assert!(w.has("shell-256"), "the examples are shown");
    w.picture("gallery");
    w.click(w.rect("Take the tour").center());
    w.settle();
    assert!(!w.has("Take the tour"), "the examples are put away");
    assert!(w.has("Step 1 of 3"));
    w.picture("tour");
    let points = w.param("arc", "points");
    let at = w.rect("point arc.points 2").center();
    w.drag(at, at + vec2(20.0, -30.0));
    assert_ne!(w.param("arc", "points"), points, "first: a point is dragged");
    w.click(w.rect("Next").center());
    w.steps(3);
    assert!(w.has("Step 2 of 3"));
    let (row, thickness) = (w.rect("input thicken.thickness"), w.param("thicken", "thickness"));
    w.drag(row.left_center() + vec2(40.0, 0.0), row.left_center() + vec2(row.width() * 0.8, 0.0));
    assert_ne!(w.param("thicken", "thickness"), thickness, "second: the slider that comes into view");
    w.click(w.rect("Next").center());
    w.settle();
    assert!(w.has("Step 3 of 3"));
    w.click(w.rect("Boards").center());
    w.settle();
    w.click(w.rect("Play").center());
    w.steps(5);
    assert!(w.app().boards.player.time > 0.0, "third: the tool moves");
    w.click(w.rect("Done").center());
    let kept = std::fs::read_to_string(state.join("preferences.json")).unwrap();
    assert!(kept.contains("\"toured\": true"), "{kept}");
    // Nothing is left beside the example.
    while w.app().model.undo() {}
    w.app().model.forget_kept();
    let mut again = Window::open(None);
    let ctx = again.harness.ctx.clone();
    again.app().remember_in(&ctx, Some(state));
    again.steps(2);
    assert!(!again.has("Step 1 of 3") && !again.has("Take the tour"));
}

#[test]
fn examples_that_were_put_away_do_not_come_back_at_the_next_start() {
    let state = folder("put-away");
    let start = || {
        let mut w = Window::open(None);
        let ctx = w.harness.ctx.clone();
        w.app().remember_in(&ctx, Some(state.clone()));
        w.steps(2);
        w
    };
    let mut w = start();
    assert!(w.has("Take the tour"));
    w.key(Modifiers::NONE, Key::Escape);
    assert!(!w.has("Take the tour"));
    let mut w = start();
    assert!(!w.has("Take the tour"));
    w.click(w.rect("Help").center());
    w.click(w.rect("Examples …").center());
    w.steps(2);
    assert!(w.has("Take the tour"), "the menu has them");
}

#[test]
fn the_tour_waits_for_the_answer_about_unsaved_work() {
    let mut w = Window::open(None);
    let add = w.app().model.new_node("number", [0.0, 0.0]).1;
    assert!(w.app().model.edit(add));
    let text = w.text();
    for (answer, begins) in [("Cancel", false), ("Discard changes", true)] {
        w.click(w.rect("Help").center());
        w.click(w.rect("Tour of three steps").center());
        w.steps(3);
        assert!(!w.has("Step 1 of 3"), "not before the question is answered");
        w.click(w.rect(answer).center());
        w.settle();
        assert_eq!(w.has("Step 1 of 3"), begins, "after {answer}");
        assert_eq!(w.text() == text, !begins);
    }
}

#[test]
fn texts_of_the_status_line_lie_beside_each_other_in_a_small_window() {
    let mut w = Window::sized(Some(&example("quad-mesh")), vec2(640.0, 480.0));
    let long = "this is a message that is far too long for the line, ".repeat(4);
    for step in 0..4 {
        match step {
            0 => {}
            1 => w.app().model.said = Some(long.clone()),
            2 => w.app().model.message = Some(Diagnostic::error("long", long.clone())),
            _ => w.app().model.message = Some(Diagnostic::error("short", "no")),
        }
        w.steps(2);
        let line = w.harness.get_by_label("Profile").parent().expect("it stands in the line");
        let all: Vec<Rect> = line.children().map(|n| n.rect()).collect();
        assert!(all.len() >= 6, "{all:?}");
        for (i, a) in all.iter().enumerate() {
            assert!(a.left() >= 0.0 && a.right() <= 640.0, "{a:?} is out of the window");
            for b in &all[..i] {
                assert!(!a.shrink(0.5).intersects(b.shrink(0.5)), "{a:?} lies over {b:?} in step {step}");
            }
        }
        w.picture(&format!("status-small-{step}"));
    }
    // Where there is room, the card is named.
    let wide = Window::sized(None, vec2(1280.0, 800.0));
    let card = wide.harness.state().card().to_owned();
    assert!(!card.is_empty() && wide.harness.query_all_by_label_contains(&card).next().is_some(), "{card}");
}

#[test]
fn very_small_and_very_large_windows_are_drawn() {
    let dir = example("quad-mesh");
    for size in [vec2(640.0, 480.0), vec2(7680.0, 4320.0)] {
        let mut w = Window::sized(Some(&dir), size);
        let canvas = w.rect("canvas");
        assert!(canvas.width() > size.x * 0.3 && canvas.max.x <= size.x && canvas.max.y <= size.y);
        // All that is pressed over the viewport lies in it, whatever is shown in colours.
        let mut chosen = "plain";
        for measure in ["plain", "planarity"] {
            if measure != chosen {
                w.click(w.harness.get_by_value(chosen).rect().center());
                w.click(w.rect(measure).center());
                w.settle();
                chosen = measure;
            }
            let (view, list) = (w.rect("viewport"), w.harness.get_by_value(chosen).rect());
            let names = ["Fit", "Views", "Perspective", "Addresses", "Measure", "More"];
            let all: Vec<Rect> = names.iter().map(|name| w.rect(name)).chain([list]).collect();
            for (i, a) in all.iter().enumerate() {
                assert!(view.contains_rect(*a), "{a} of {view} at {size}, {measure}");
                assert!(all[..i].iter().all(|b| !a.shrink(0.5).intersects(*b)), "{a} lies over another at {size}");
            }
            w.picture(&format!("over-{}-{measure}", size.x));
        }
        let picture = w.harness.render().unwrap();
        assert_eq!([picture.width() as f32, picture.height() as f32], [size.x, size.y]);
        let first = *picture.get_pixel(0, 0);
        assert!(picture.pixels().any(|p| *p != first));
    }
}
