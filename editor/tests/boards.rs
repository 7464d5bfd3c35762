//! Boards, player and tables of the shell.

use crate::common::{Window, example, folder, like, middle, pixels, places, rgb, root, small_shell};
use eframe::egui::{Key, Modifiers, PointerButton, Pos2, Rect, pos2, vec2};
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use image::RgbaImage;
use serde_json::json;
use tenon_editor::app::Side;

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
    let machine = std::fs::read_to_string(root().join("nodes/machines/maka-mm7s.json")).unwrap();
    let mut machine: serde_json::Value = serde_json::from_str(&machine).unwrap();
    machine["clamps"] = json!([{ "name": "stop", "min": [200, 100, 0], "max": [330, 160, 40] }]);
    std::fs::write(graph.with_file_name("clamped.json"), machine.to_string()).unwrap();
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
