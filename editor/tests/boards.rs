//! Boards, player and tables of the shell.

use crate::common::{Window, example, folder};
use eframe::egui::{Key, Modifiers, PointerButton, vec2};
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

#[test]
fn values_are_tables() {
    let mut w = Window::open(Some(&example("shell-256")));
    w.app().model.selection = ["arc".to_owned()].into();
    w.steps(1);
    w.click(w.rect("Data").center());
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
