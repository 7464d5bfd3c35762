//! Boards, player and tables of the shell.

use crate::common::{Window, example, folder, like, middle, pixels, places, rgb, root, small_shell};
use eframe::egui::accesskit::Toggled;
use eframe::egui::{Key, Modifiers, PointerButton, Pos2, Rect, pos2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use image::RgbaImage;
use serde_json::json;
use tenon_editor::app::Side;
use tenon_engine::{NodeState, Operation};

#[test]
fn the_boards_are_seen_and_the_tool_moves_through_them() {
    let mut w = Window::open(Some(&example("shell-256")));
    w.click(w.rect("Boards").center());
    w.settle();
    assert_eq!(w.app().side, Side::Boards);
    assert_eq!(w.app().boards.count(), 3);
    assert_eq!(w.app().boards.grain().map(|g| g.to_array()), Some([1.0, 0.0]), "parts are mapped to X");
    w.picture("boards");
    // A part that is clicked is the panel in space.
    w.click(w.rect("board 1").center());
    let picked = w.app().viewport.picked.clone().expect("the middle of a board is a part");
    assert_eq!(picked.output, "thicken.panels");
    assert!(w.app().model.selection.contains("thicken"));

    // The player: 14 000 motions that take hours, and a line of the program for every moment.
    let plays = w.app().boards.plays();
    assert_eq!(plays.len(), 3);
    let (first, length) = (&plays[0], plays[0].length());
    assert!(first.steps.len() > 10_000 && length > 600.0, "{} steps, {length} s", first.steps.len());
    let middle = first.at(length / 2.0).unwrap();
    let step = first.steps[middle.step];
    assert!(step.time[0] <= length / 2.0 && length / 2.0 <= step.time[1]);
    assert!(first.line(step.line as usize).contains(|c: char| "XYZABC".contains(c)));
    assert!(first.time_of(step.line).unwrap() <= length / 2.0);
    let board = tenon_board(&w);
    assert!(middle.tip.x > -200.0 && middle.tip.x < board[0] + 200.0, "{}", middle.tip);
    w.app().boards.player.go_to(length / 2.0);
    w.click(w.rect("Program").center());
    w.steps(3);
    w.picture("player");
    w.click(w.rect("Play").center());
    w.steps(5);
    let player = |w: &mut Window| (w.app().boards.player.playing, w.app().boards.player.time);
    assert!(player(&mut w).1 > length / 2.0);
    // By keys over the boards: pause, on to the end of the move, back to its start.
    w.hover(w.rect("boards").center());
    w.key(Modifiers::NONE, Key::Space);
    let (playing, paused) = player(&mut w);
    assert!(!playing);
    let step = |w: &mut Window, at: f64| {
        let play = &w.app().boards.plays()[0];
        play.steps[play.at(at).unwrap().step].time
    };
    let moves = step(&mut w, paused);
    w.key(Modifiers::NONE, Key::Period);
    assert_eq!(player(&mut w).1, moves[1]);
    w.key(Modifiers::NONE, Key::Comma);
    assert_eq!(player(&mut w).1, moves[0]);
    w.key(Modifiers::NONE, Key::Space);
    w.steps(3);
    assert!(player(&mut w).0 && player(&mut w).1 > moves[0]);
}

#[test]
fn the_board_is_cut_as_the_tool_moves_and_whole_again_before() {
    let mut w = Window::open(Some(&example("shell-256")));
    w.click(w.rect("Boards").center());
    w.settle();
    assert!(w.app().boards.carved().image.is_none(), "nothing was played");
    let length = w.app().boards.plays()[0].length();
    let cut = |w: &mut Window, time: f64| {
        w.app().boards.player.go_to(time);
        w.settle();
        let image = w.app().boards.carved().image.clone().expect("the board is looked at from above");
        image.pixels.iter().filter(|p| p.a() > 0).count()
    };
    let (some, more) = (cut(&mut w, 0.3 * length), cut(&mut w, 0.6 * length));
    assert!(some > 100 && more > some + some / 2, "{some} and {more} lines are cut");
    w.picture("board-cut");
    assert_eq!(cut(&mut w, 0.3 * length), some, "backward it is as it was");
    assert_eq!(cut(&mut w, 0.0), 0);
    // The slider is drawn to a time; the line of the program is lit and a click on another goes there.
    let slider = w.rect("time");
    w.drag(slider.left_center() + vec2(6.0, 0.0), slider.left_center() + vec2(slider.width() * 0.04, 0.0));
    let time = w.app().boards.player.time;
    assert!((0.01..0.08).contains(&(time / length)), "{time} of {length}");
    w.click(w.rect("Program").center());
    w.settle();
    let line = |w: &mut Window| {
        let (play, now) = w.app().boards.now().unwrap();
        (play.steps[now.step].line, now)
    };
    let (lit, _) = line(&mut w);
    let text = w.app().boards.plays()[0].line(lit as usize + 3).to_owned();
    w.picture("program");
    w.click(w.rect(&format!("{:>6}  {text}", lit + 3)).center());
    w.settle();
    assert!(line(&mut w).0 >= lit + 3, "the click goes to that line or the next that moves");
    // In space: stock, tool and holder are bodies.
    w.click(w.rect("In space").center());
    w.settle();
    let carved = w.app().boards.carved();
    let triangles: usize = carved.solid.iter().map(|d| d.triangles.len()).sum();
    assert!(triangles > 1000, "{triangles} corners of the surface");
    let seen = w.rect("board in space");
    w.picture("board-in-space");
    w.drag_with(seen.center(), seen.center() + vec2(60.0, 20.0), PointerButton::Primary, Modifiers::NONE);
    // Speed is set by the mouse.
    let speed = w.app().boards.player.speed;
    let field = w.rect("speed");
    w.drag(field.center(), field.center() + vec2(40.0, 0.0));
    assert!(w.app().boards.player.speed > speed);
}

fn tenon_board(w: &Window) -> [f64; 2] {
    let layout = &w.harness.state().model.results.values["pack.layout"].to_json()["branches"]["{0}"][0]["board"];
    ["x", "y"].map(|k| layout[k].as_f64().unwrap())
}

const PART: [i32; 3] = [236, 212, 172];
const ERROR: [i32; 3] = [214, 69, 65];

fn boards_of(w: &mut Window) -> Rect {
    w.click(w.rect("Boards").center());
    w.settle();
    w.rect("board 1")
}

/// Places that bear the colour of grain and have the same on their right, and the same below them.
fn grain(picture: &RgbaImage, board: Rect) -> [usize; 2] {
    let dark = |at: Pos2| (188..202).contains(&rgb(picture, at)[0]);
    [vec2(1.0, 0.0), vec2(0.0, 1.0)]
        .map(|by| places(board.shrink(6.0)).filter(|at| (0..5).all(|k| dark(*at + by * k as f32))).count())
}

#[test]
fn boards_show_grain_what_tools_clear_holes_and_addresses() {
    let graph = small_shell("drawn", |nodes| nodes["map"]["params"]["fixing_holes"] = 0.into());
    let mut w = Window::sized(Some(&graph), vec2(1920.0, 900.0));
    let board = boards_of(&mut w);
    let whole = w.picture("board-drawn");
    let lines = grain(&whole, board);
    let most = lines[0];
    assert!(most > 20 * lines[1].max(100), "grain runs along X: {lines:?}");

    // On every line across a part, what tools clear is met before its edge.
    let (mut met, mut all) = (0, 0);
    for y in board.top() as u32 + 4..board.bottom() as u32 - 4 {
        let row: Vec<[i32; 3]> = (board.left() as u32 + 2..board.right() as u32 - 2)
            .map(|x| rgb(&whole, pos2(x as f32, y as f32)))
            .take_while(|p| !like(*p, PART))
            .collect();
        let Some(edge) = row.iter().rposition(|p| p[0] < 130).filter(|_| row.len() < 100) else { continue };
        (met, all) = (met + usize::from(row[..edge - 3].iter().any(|p| p[0] < 186)), all + 1);
    }
    assert!(all > 100 && 10 * met > 9 * all, "what tools clear is met on {met} of {all} lines");

    // Addresses are darker than holes, and holes darker than edges of parts.
    let ink = |picture: &RgbaImage, board: Rect| pixels(picture, board.shrink(4.0), |p| p[0] < 62);
    let dark = |picture: &RgbaImage| pixels(picture, board, |p| p[0] < 80);
    w.click(w.rect("node screws").center());
    w.key(Modifiers::NONE, Key::Delete);
    w.settle();
    let plain = w.picture("board-without-holes");
    assert!(dark(&whole) > dark(&plain) + 150, "{} dark pixels with holes, {} without", dark(&whole), dark(&plain));
    w.key(Modifiers::COMMAND, Key::Z);
    w.settle();
    let written = ink(&plain, board);
    w.wheel(board.center(), -500.0);
    w.hover(w.rect("File").center());
    let small = ink(&w.picture("board-far"), w.rect("board 1"));
    assert!(written > 150 && small * 20 < written, "addresses are {written} pixels of ink, {small} of parts too small");

    // Parts are mapped to the other axis; then they may be turned freely.
    w.hover(w.rect("boards").center());
    w.key(Modifiers::NONE, Key::F);
    for (node, before, after, runs) in [("map", "x", "y", Some(1)), ("pack", "none", "free", None)] {
        w.click(w.rect(&format!("node {node}")).center());
        w.click(w.harness.get_by_value(before).rect().center());
        w.click(w.rect(after).center());
        w.settle();
        let lines = grain(&w.picture(&format!("board-grain-{after}")), w.rect("board 1"));
        match runs {
            Some(k) => assert!(lines[k] > 20 * lines[1 - k].max(100), "grain runs along {after}: {lines:?}"),
            None => assert!(lines.iter().all(|n| 5 * n < most), "there is no grain: {lines:?} of {most}"),
        }
    }
}

/// Draws the slider of the player to a share of the time.
fn go_to(w: &mut Window, share: f32) {
    let slider = w.rect("time");
    let now = slider.left_center() + vec2(6.0, 0.0);
    w.click(now + vec2((slider.width() - 12.0) * share, 0.0));
    w.settle();
}

/// Metal in any light, on the dark ground of space.
fn grey(p: [i32; 3]) -> bool {
    (p[0] - p[1]).abs() < 10 && (0..22).contains(&(p[2] - p[0])) && !like(p, [38, 41, 47])
}

#[test]
fn moves_have_the_colour_of_what_they_do_and_the_tool_is_seen_with_its_holder() {
    let mut w = Window::open(Some(&small_shell("moves", |_| ())));
    let board = boards_of(&mut w);
    // Rapid, plunge, cut, retract.
    let moves = |picture: &RgbaImage, area: Rect| {
        let kinds: [fn([i32; 3]) -> bool; 4] = [
            |[r, g, b]| b > r + 30 && g > r,
            |[r, g, b]| r > g + 90 && (b - g).abs() < 50,
            |[r, g, b]| g > r + 40 && g > b + 40,
            |[r, g, b]| b > g + 50 && r > g + 40,
        ];
        kinds.map(|is| pixels(picture, area, is))
    };
    let white = |p: [i32; 3]| p == [255; 3];
    let holder = |picture: &RgbaImage| pixels(picture, board, |p| like(p, [224, 226, 230]));
    let still = w.picture("moves-none");
    assert_eq!((moves(&still, board), holder(&still)), ([0; 4], 0), "nothing was played");
    let mut places = Vec::new();
    let mut most = [0; 4];
    for share in [0.2, 0.4, 0.9] {
        go_to(&mut w, share);
        let picture = w.picture(&format!("moves-{share}"));
        let now = moves(&picture, board);
        (0..4).for_each(|k| most[k] = most[k].max(now[k]));
        assert!(holder(&picture) > 30, "the holder's outline is {} pixels", holder(&picture));
        let tip = middle(&picture, board, white).expect("the tool has a white edge");
        assert!(!like(rgb(&picture, tip), ERROR), "nothing is wrong there");
        places.push(tip);
    }
    assert!(most[..3].iter().all(|n| *n > 60), "rapid, plunge, cut, retract from above: {most:?} pixels");
    assert!(places.windows(2).all(|p| p[0].distance(p[1]) > 10.0), "the tool moves: {places:?}");
    // In space moves that go straight up are seen too.
    w.click(w.rect("In space").center());
    w.settle();
    let (mut most, mut places) = ([0; 4], Vec::new());
    for share in [0.2, 0.4, 0.9] {
        go_to(&mut w, share);
        let (area, picture) = (w.rect("board in space"), w.picture(&format!("moves-in-space-{share}")));
        let now = moves(&picture, area);
        (0..4).for_each(|k| most[k] = most[k].max(now[k]));
        assert!(pixels(&picture, area, grey) > 2000, "cutter, holder and spindle are bodies");
        places.push(middle(&picture, area, grey).unwrap());
    }
    assert!(most.iter().all(|n| *n > 60), "rapid, plunge, cut, retract in space: {most:?} pixels");
    assert!(places.windows(2).all(|p| p[0].distance(p[1]) > 10.0), "the tool moves: {places:?}");
}

#[test]
fn a_collision_is_crossed_ticked_listed_and_its_tool_is_red() {
    let graph = small_shell("struck", |nodes| {
        // The proof knows of a clamp that whoever laid the paths did not.
        nodes["clamped"] = json!({ "type": "machine", "v": 1, "params": { "path": "clamped.json" } });
        nodes["prove"]["inputs"]["machine"] = json!({ "from": ["clamped.machine"] });
    });
    clamp(&graph);
    let sound = small_shell("sound", |_| ());
    let red = |p: [i32; 3]| like(p, ERROR);
    let ticks = |w: &Window, picture: &RgbaImage| {
        let slider = w.rect("time");
        pixels(picture, slider.with_max_y(slider.top() + 5.0), |p| p[0] > p[1] + 90)
    };
    let mut w = Window::open(Some(&sound));
    let board = boards_of(&mut w);
    let picture = w.picture("sound");
    assert_eq!((pixels(&picture, board, red), ticks(&w, &picture)), (0, 0));
    assert!(w.has("proven") && !w.has_containing(" faults"));

    let mut w = Window::open(Some(&graph));
    let board = boards_of(&mut w);
    let picture = w.picture("struck");
    assert!(w.has("proof failed"));
    assert!(pixels(&picture, board, red) > 60, "crosses are {} pixels", pixels(&picture, board, red));
    assert!(ticks(&w, &picture) > 3, "ticks are {} pixels", ticks(&w, &picture));
    w.click(w.rect_containing(" faults").center());
    // The last is of the widest tool.
    let entry = w.harness.get_all_by_label_contains("the cutter enters clamp \"stop\"").last().unwrap();
    let words = entry.accesskit_node().label().unwrap();
    w.tap(&words);
    w.settle();
    let line = words.split(':').next().unwrap();
    assert!(w.has_containing(&format!("{line}, tool ")), "{words}");
    let (area, picture) = (w.rect("boards"), w.picture("struck-there"));
    let cross = Rect::from_center_size(area.center(), vec2(22.0, 22.0));
    assert!(pixels(&picture, cross, red) > 40, "its cross is in the middle");
    let tip = middle(&picture, area, |p| p == [255; 3]).expect("the tool has a white edge");
    let tool = Rect::from_center_size(tip, vec2(4.0, 4.0));
    assert!(pixels(&picture, tool, red) > 8, "the tool is red");
    // In space too.
    w.click(w.rect("In space").center());
    w.settle();
    let reds = |w: &mut Window, name: &str| {
        let picture = w.picture(name);
        // Of a deeper red than plunges and marks.
        pixels(&picture, w.rect("board in space"), |p| p[0] > 60 && p[0] > 4 * p[1] && p[0] > 4 * p[2])
    };
    let there = reds(&mut w, "struck-in-space");
    go_to(&mut w, 0.95);
    let elsewhere = reds(&mut w, "struck-in-space-later");
    assert!(there > 40 && elsewhere == 0, "{there} red pixels there, {elsewhere} later");
    // One that is chosen in space is looked at there.
    w.click(w.rect_containing(" faults").center());
    w.tap(&words);
    w.settle();
    let (area, picture) = (w.rect("board in space"), w.picture("struck-looked-at"));
    let near = Rect::from_center_size(area.center(), vec2(60.0, 60.0));
    let struck = pixels(&picture, near, |p| p[0] > 60 && p[0] > 4 * p[1] && p[0] > 4 * p[2]);
    assert!(struck > 400, "the tool is {struck} red pixels in the middle");
    // Seen from above afterwards, nothing moves.
    w.key(Modifiers::NONE, Key::Escape);
    w.click(w.rect("In space").center());
    w.hover(w.rect("boards").center());
    w.key(Modifiers::NONE, Key::F);
    let whole = w.rect("board 1");
    w.click(w.rect("In space").center());
    w.click(w.rect_containing(" faults").center());
    w.tap(&words);
    w.click(w.rect("In space").center());
    w.settle();
    assert_eq!(w.rect("board 1"), whole);
}

/// A machine with a clamp where parts are cut, written beside a graph.
fn clamp(graph: &std::path::Path) {
    let machine = std::fs::read_to_string(root().join("nodes/machines/maka-mm7s.json")).unwrap();
    let mut machine: serde_json::Value = serde_json::from_str(&machine).unwrap();
    machine["clamps"] = json!([{ "name": "stop", "min": [200, 100, 0], "max": [330, 160, 40] }]);
    std::fs::write(graph.with_file_name("clamped.json"), machine.to_string()).unwrap();
}

#[test]
fn programs_and_faults_are_those_of_the_layout_that_is_shown() {
    // One layout with programs that strike a clamp, one whose programs are sound, one without any.
    let graph = small_shell("chains", |nodes| {
        for (node, of) in [("pack_b", "pack"), ("post_b", "post"), ("prove_b", "prove"), ("pack_c", "pack")] {
            nodes[node] = nodes[of].clone();
        }
        nodes["pack_b"]["params"]["margin"] = 20.into();
        nodes["post_b"]["inputs"]["layout"] = json!({ "from": ["pack_b.layout"] });
        nodes["prove_b"]["inputs"]["layout"] = json!({ "from": ["pack_b.layout"] });
        nodes["prove_b"]["inputs"]["programs"] = json!({ "from": ["post_b.programs"] });
        nodes["clamped"] = json!({ "type": "machine", "v": 1, "params": { "path": "clamped.json" } });
        nodes["prove"]["inputs"]["machine"] = json!({ "from": ["clamped.machine"] });
    });
    clamp(&graph);
    let mut w = Window::sized(Some(&graph), vec2(1920.0, 900.0));
    boards_of(&mut w);
    let mut crosses = Vec::new();
    for (node, proven, struck) in [("pack", false, true), ("pack_b", true, false), ("pack_c", false, false)] {
        w.click(w.rect(&format!("node {node}")).center());
        w.settle();
        let (area, picture) = (w.rect("board 1"), w.picture(&format!("chain-{node}")));
        crosses.push(pixels(&picture, area, |p| like(p, ERROR)));
        assert_eq!((w.has("proven"), w.has("proof failed")), (proven, struck), "{node}");
        assert_eq!(w.has_containing(" faults"), struck, "{node}");
        assert_eq!(w.has("Play"), node != "pack_c", "{node}");
    }
    assert!(crosses[0] > 60 && crosses[1..] == [0, 0], "crosses are {crosses:?} pixels");
}

#[test]
fn the_boards_stay_those_of_the_layout_that_was_selected_last() {
    // The second layout has its parts on smaller boards, and programs of its own.
    let graph = small_shell("stays", |nodes| {
        for (node, of) in [("pack_b", "pack"), ("post_b", "post"), ("prove_b", "prove")] {
            nodes[node] = nodes[of].clone();
        }
        nodes["pack_b"]["params"] = json!({ "board_x": 800, "board_y": 600 });
        nodes["post_b"]["inputs"]["layout"] = json!({ "from": ["pack_b.layout"] });
        nodes["prove_b"]["inputs"]["layout"] = json!({ "from": ["pack_b.layout"] });
        nodes["prove_b"]["inputs"]["programs"] = json!({ "from": ["post_b.programs"] });
    });
    let mut w = Window::sized(Some(&graph), vec2(1920.0, 900.0));
    w.click(w.first("Pieces").center());
    boards_of(&mut w);
    let seen = |w: &mut Window| {
        w.settle();
        w.steps(2);
        let rows = w.harness.get_all_by_label_contains("piece ").count();
        let boards = &w.app().boards;
        (boards.found().unwrap().node.clone(), boards.plays().len() as u32 == boards.count(), rows > 0)
    };
    assert_eq!(seen(&mut w), ("pack".into(), true, true));
    w.click(w.rect("node pack_b").center());
    assert_eq!(seen(&mut w), ("pack_b".into(), true, true));
    let count = w.app().boards.count();
    assert!(count > 1, "{count} small boards");
    go_to(&mut w, 0.5);
    let time = w.app().boards.player.time;
    // A part, a piece, another node: none of them means another layout, and the player stays where it is.
    w.click(w.rect("board 1").center() + vec2(20.0, 10.0));
    assert!(w.app().model.selection.contains("thicken"), "{:?}", w.app().model.selection);
    assert_eq!(seen(&mut w), ("pack_b".into(), true, true));
    w.click(w.first_containing("piece ").center());
    assert_eq!(seen(&mut w), ("pack_b".into(), true, true));
    w.click(w.rect("node fold_1").center());
    assert_eq!(seen(&mut w), ("pack_b".into(), true, true));
    assert_eq!((w.app().boards.count(), w.app().boards.player.time), (count, time));
    // Programs and proofs mean the layout that they are for.
    w.click(w.rect("node post").center());
    assert_eq!(seen(&mut w), ("pack".into(), true, true));
    w.click(w.rect("node prove_b").center());
    assert_eq!(seen(&mut w), ("pack_b".into(), true, true));
}

#[test]
fn the_picture_of_a_board_that_is_cut_follows_its_programs() {
    // Only contours, so that much is cut soon.
    let shell = |name: &str, margin: u32| {
        small_shell(name, |nodes| {
            nodes.as_object_mut().unwrap().remove("screws");
            nodes["map"]["inputs"].as_object_mut().unwrap().remove("features");
            nodes["map"]["params"] = json!({ "fixing_holes": 0, "address_height": 0 });
            nodes["pack"]["params"] = json!({ "board_x": 1400, "board_y": 800, "margin": margin });
        })
    };
    let (graph, moved) = (shell("stale", 10), shell("stale-moved", 40));
    // Far enough for something to be cut, and near enough to be there at once.
    let cut = |w: &mut Window| {
        boards_of(w);
        go_to(w, 0.15);
    };
    let mut w = Window::open(Some(&graph));
    cut(&mut w);
    let (board, before) = (w.rect("board 1"), w.picture("stale-before"));
    let set = Operation::SetParam { node: "pack".into(), port: "margin".into(), value: Some(40.into()) };
    assert!(w.app().model.edit(set));
    w.settle();
    let after = w.picture("stale-after");
    let mut fresh = Window::open(Some(&moved));
    cut(&mut fresh);
    assert_eq!(fresh.rect("board 1"), board);
    let meant = fresh.picture("stale-meant");
    let differ = |a: &RgbaImage, b: &RgbaImage| places(board).filter(|at| !like(rgb(a, *at), rgb(b, *at))).count();
    let (moves, stale) = (differ(&before, &meant), differ(&after, &meant));
    assert!(moves > 2000 && stale < 10, "{moves} pixels change, {stale} are not as they are meant");
}

/// Seconds as the player shows them.
fn clock(seconds: f64) -> String {
    let s = seconds.round() as u64;
    format!("{}:{:02}:{:02}", s / 3600, s / 60 % 60, s % 60)
}

#[test]
fn times_of_boards_and_parts_are_the_sums_of_their_moves_and_the_line_that_runs_is_lit() {
    let mut w = Window::sized(Some(&small_shell("times", |_| ())), vec2(1600.0, 900.0));
    let board = boards_of(&mut w);
    let play = &w.app().boards.plays()[0];
    let long = |s: &tenon_editor::model::play::Step| s.time[1] - s.time[0];
    let whole: f64 = play.steps.iter().map(long).sum();
    let mut parts: std::collections::BTreeMap<String, f64> = Default::default();
    for step in &play.steps {
        if let Some((part, _)) = play.part(step) {
            *parts.entry(part.to_owned()).or_default() += long(step);
        }
    }
    assert_eq!(parts.len(), 16);
    assert!(w.has(&format!("0:00:00 of {}", clock(whole))));
    // Over a part stands its own time, and in the list of pieces.
    w.rest(board.center() + vec2(30.0, 10.0));
    let told = w.harness.get_by_label_contains(" at the machine").value().unwrap();
    let address = told.split(':').next().unwrap();
    assert_eq!(told, format!("{address}: board 1, {} at the machine", clock(parts[address])));
    w.click(w.first("Pieces").center());
    w.settle();
    let sum: f64 = parts.values().sum();
    assert!(w.has_containing("16 pieces, ") && w.has_containing(&format!(" m², {:.0} min at", sum / 60.0)));
    w.click(w.rect("×").center());
    // While it is cut, too; and the line of the program that runs is lit, no other.
    w.click(w.rect("Program").center());
    for share in [0.3, 0.7] {
        go_to(&mut w, share);
        let (play, now) = w.app().boards.now().unwrap();
        let step = play.steps[now.step];
        let (line, text) = (step.line, play.line(step.line as usize).to_owned());
        let part = play.part(&step).map(|(part, _)| part.to_owned());
        if let Some(part) = part {
            assert!(w.has(&format!("part {part}: {} in all", clock(parts[&part]))), "{part}");
        }
        // Lines begin with room for their number.
        let lit = w.harness.get_all_by(|n| n.toggled() == Some(Toggled::True));
        let lit: Vec<String> = lit.filter_map(|n| n.accesskit_node().label()).filter(|l| l.starts_with(' ')).collect();
        assert_eq!(lit, [format!("{line:>6}  {text}")]);
        w.picture(&format!("lit-{share}"));
    }
}

#[test]
fn values_are_tables() {
    let mut w = Window::open(Some(&example("shell-256")));
    w.app().model.selection = ["arc".to_owned()].into();
    w.steps(1);
    w.click(w.rect("Data").center());
    w.settle();
    assert!(w.has("1 branch, 1 item of curve"));
    w.picture("data");
    w.click(w.first("Profile").center());
    w.click(w.rect("time of pack").center());
    assert!(w.app().model.selection.contains("pack"));
    w.picture("profile");
}

/// Seconds of a duration as it is shown.
fn seconds(words: &str) -> f64 {
    let (number, unit) = words.trim().split_once(' ').unwrap();
    let one = match unit {
        "s" => 1.0,
        "ms" => 1e-3,
        "µs" => 1e-6,
        _ => panic!("{words}"),
    };
    number.parse::<f64>().unwrap() * one
}

#[test]
fn the_profile_has_bars_as_long_as_times_and_sums_time_and_memory() {
    let mut w = Window::open(Some(&small_shell("bars", |_| ())));
    w.click(w.rect("Profile").center());
    w.settle();
    let picture = w.picture("profile-bars");
    let rows: Vec<(Rect, String, String)> = w
        .harness
        .get_all_by_label_contains("time of ")
        .map(|n| (n.rect(), n.accesskit_node().label().unwrap(), n.value().unwrap()))
        .collect();
    let figures = |value: &str| {
        let (time, bytes) = value.split_once(", ").unwrap();
        (seconds(time), bytes.to_owned())
    };
    let bar = |rect: Rect| {
        let room = rect.with_min_x(rect.left() + 300.0).with_max_x(rect.right() - 4.0);
        let row = Rect::from_center_size(room.center(), vec2(room.width(), 1.5));
        (pixels(&picture, row, |p| like(p, [58, 92, 128])) as f64, f64::from(room.width()))
    };
    let most = rows.iter().map(|(_, _, value)| figures(value).0).fold(0.0, f64::max);
    assert!(rows.len() > 4 && most > 0.0);
    // The last of those that there is room for fade away.
    let seen = w.rect_containing("done in").top() - 30.0;
    for (rect, name, value) in rows.iter().filter(|(rect, ..)| rect.bottom() < seen) {
        let ((long, room), share) = (bar(*rect), figures(value).0 / most);
        assert!((long / room - share).abs() < 0.07, "the bar of {name} is {long} of {room}, it took {value}");
    }
    // Each row tells its node's own memory, the line above all of it.
    let results = &w.app().model.results;
    let bytes = |n: usize| tenon_editor::canvas::bytes(n);
    let all: usize = results.nodes.values().map(|r| r.bytes).sum();
    let own: Vec<String> = rows.iter().map(|(_, n, _)| bytes(results.nodes[&n["time of ".len()..]].bytes)).collect();
    assert!(rows.iter().zip(own).all(|((_, _, value), own)| figures(value).1 == own));
    let values: usize = results.values.values().map(tenon_engine::Tree::bytes).sum();
    assert!(all.abs_diff(values) * 10 < values, "{all} bytes are told, values have {values}");
    assert!(w.has_containing(&format!("results take {}", bytes(all))));
}

#[test]
fn files_are_written_from_the_boards_and_from_the_pieces() {
    let mut w = Window::open(Some(&example("shell-256")));
    for (place, name) in [("Boards", "from-boards"), ("Pieces", "from-pieces")] {
        let out = folder(name).join("out");
        w.click(w.first(place).center());
        w.settle();
        w.click(w.rect("Export the files …").center());
        w.steps(2);
        assert!(w.has("Write the files of the graph into a folder"));
        w.key(Modifiers::COMMAND, Key::A);
        w.type_text(&out.to_string_lossy());
        w.key(Modifiers::NONE, Key::Enter);
        w.settle();
        let count = w.app().model.results.files.len();
        // The manifest stands beside them.
        assert!(count > 1 && std::fs::read_dir(&out).unwrap().count() == count + 1);
        w.click(w.rect("Space").center());
    }
}

#[test]
fn boards_are_seen_wherever_they_are_made_and_from_everywhere() {
    let mut w = Window::sized(Some(&example("three-strips")), vec2(1600.0, 900.0));
    w.click(w.first("Pieces").center());
    boards_of(&mut w);
    let seen = |w: &mut Window| {
        w.settle();
        w.steps(2);
        let found = w.app().boards.found().expect("boards are there");
        let (node, panels) = (found.node.clone(), found.panels.clone().unwrap());
        assert!(w.has("board 1") && w.has_containing("64 pieces"));
        (node, panels)
    };
    // The packer is two clusters deep; its panels are seen as the instance's.
    assert_eq!(seen(&mut w), ("high/cut/pack".into(), "high.panels".into()));
    w.click(w.rect("node low").center());
    assert_eq!(seen(&mut w), ("low/cut/pack".into(), "low.panels".into()));
    w.click(w.rect("node area").center());
    assert_eq!(seen(&mut w), ("low/cut/pack".into(), "low.panels".into()));
    let piece = w.first_containing("piece ").center();
    w.click(piece);
    assert!(w.app().model.selection.contains("low"), "{:?}", w.app().model.selection);
    assert_eq!(w.app().viewport.picked.as_ref().unwrap().output, "low.panels");
    // Inside another instance they stay, until something else is selected there.
    w.app().model.enter("middle").unwrap();
    w.app().canvas.opened();
    assert_eq!(seen(&mut w), ("low/cut/pack".into(), "low/thicken.panels".into()));
    w.click(w.rect("node cut").center());
    assert_eq!(seen(&mut w), ("middle/cut/pack".into(), "middle/thicken.panels".into()));
    w.app().model.enter("cut").unwrap();
    w.app().canvas.opened();
    assert_eq!(seen(&mut w).0, "middle/cut/pack");
    // A piece leads to its panels, out of the cluster that does not have them.
    let piece = w.first_containing("piece ").center();
    w.click(piece);
    w.settle();
    assert_eq!(w.app().model.trail().len(), 1);
    assert!(w.app().model.selection.contains("thicken"), "{:?}", w.app().model.selection);
}

#[test]
fn programs_and_faults_inside_a_cluster_are_played_as_those_outside() {
    // All of the fabrication is put into a cluster, by hand.
    let graph = small_shell("in-cluster", |nodes| {
        nodes["clamped"] = json!({ "type": "machine", "v": 1, "params": { "path": "clamped.json" } });
        nodes["prove"]["inputs"]["machine"] = json!({ "from": ["clamped.machine"] });
    });
    clamp(&graph);
    let mut w = Window::sized(Some(&graph), vec2(1600.0, 900.0));
    boards_of(&mut w);
    let told = |w: &mut Window| {
        let boards = &w.app().boards;
        let grain = boards.grain().map(|g| g.to_array());
        (boards.count(), boards.plays().len(), boards.player.faults.told.len(), grain)
    };
    let outside = told(&mut w);
    assert!(outside.1 == 1 && outside.2 > 0 && outside.3 == Some([1.0, 0.0]), "{outside:?}");
    let made = ["map", "pack", "post", "prove"].map(str::to_owned);
    w.app().model.selection = made.into();
    w.steps(1);
    w.hover(w.rect("canvas").left_top() + vec2(20.0, 20.0));
    w.key(Modifiers::COMMAND, Key::K);
    assert!(w.app().model.message.is_none(), "{:?}", w.app().model.message);
    w.settle();
    assert!(!w.app().model.document().nodes().contains_key("pack"));
    assert_eq!(told(&mut w), outside);
    let made = w.app().model.selection.first().cloned().unwrap();
    w.app().model.enter(&made).unwrap();
    w.app().canvas.opened();
    w.settle();
    assert_eq!(told(&mut w), outside);
    assert!(w.has("Play") && w.has("board 1"));
}

#[test]
fn a_layout_whose_parts_are_not_there_is_told_in_words() {
    let mut w = Window::open(Some(&small_shell("no-parts", |_| ())));
    boards_of(&mut w);
    for (node, state) in [("pack", NodeState::Frozen), ("map", NodeState::Disabled)] {
        assert!(w.app().model.edit(Operation::SetState { node: node.into(), state }));
        w.settle();
    }
    assert!(w.app().boards.found().is_none());
    assert!(w.has_containing("pack gives a layout, but the parts that lie on it cannot be reached"));
}
