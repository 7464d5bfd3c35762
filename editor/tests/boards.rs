//! Boards, player and tables of the shell.

use crate::common::{Window, example};
use tenon_editor::app::Side;

#[test]
fn the_boards_are_seen_and_the_tool_moves_through_them() {
    let mut w = Window::open(Some(&example("shell-256")));
    w.click(w.rect("Boards").center());
    assert_eq!(w.app().side, Side::Boards);
    assert_eq!(w.app().boards.count(), 3);
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
    assert!(w.app().boards.player.time > length / 2.0);
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
    assert!(w.has("1 branches, 1 items of curve"));
    w.picture("data");
    w.click(w.first("Profile").center());
    w.click(w.rect("time of pack").center());
    assert!(w.app().model.selection.contains("pack"));
    w.picture("profile");
}
