//! Small pictures of the views on both grounds, kept in `snapshots/`: a view that comes out another way fails here, and
//! `TENON_WRITE_SNAPSHOTS=1` draws it anew. They are reduced ten times, so that what differs between drivers (edges,
//! letters) and from run to run (times) does not count, and what anybody would see does. The whole pictures are left in
//! `target/editor`.

use crate::common::{WRONG, Window, example, graph, root};
use eframe::egui::{Theme, pos2, vec2};
use image::codecs::png::{CompressionType, FilterType as Rows, PngEncoder};
use image::imageops::{FilterType, resize};
use image::{DynamicImage, Rgb, RgbImage};
use std::path::{Path, PathBuf};
use tenon_editor::app::Side;
use tenon_editor::panels::Tab;
use tenon_editor::viewport::{Clip, Measure};

/// How many times smaller the pictures are.
const REDUCED: u32 = 10;
/// Side of the tiles that are compared, pixels of the reduced picture.
const TILE: u32 = 8;
/// How far the mean of a tile's channels may be off, of 255.
const OFF: f64 = 2.0;

fn path(name: &str) -> PathBuf {
    root().join(format!("editor/tests/snapshots/{name}.png"))
}

/// What the window shows now, reduced. Left out is what is never the same: from how long it took to the adapter's name in
/// the lower right corner.
fn small(w: &mut Window, name: &str) -> RgbImage {
    let time = w.rect_containing("done in").left() as u32;
    let mut whole = DynamicImage::ImageRgba8(w.picture(name)).into_rgb8();
    let (width, height) = whole.dimensions();
    for (x, y) in (height - 22..height).flat_map(|y| (time..width).map(move |x| (x, y))) {
        whole.put_pixel(x, y, Rgb([128; 3]));
    }
    resize(&whole, width / REDUCED, height / REDUCED, FilterType::Triangle)
}

/// By how much the tile that differs most is off in the mean, of 255.
fn difference(a: &RgbImage, b: &RgbImage) -> f64 {
    assert_eq!(a.dimensions(), b.dimensions());
    let tile = |x: u32, y: u32| {
        let [right, below] = [(x + TILE).min(a.width()), (y + TILE).min(a.height())];
        let pixels = (y..below).flat_map(|y| (x..right).map(move |x| (x, y)));
        let off = |(x, y)| (0..3).map(|k| f64::from(a.get_pixel(x, y)[k].abs_diff(b.get_pixel(x, y)[k]))).sum::<f64>();
        pixels.map(off).sum::<f64>() / f64::from(3 * (right - x) * (below - y))
    };
    let [across, down] = [a.width(), a.height()].map(|side| (0..side).step_by(TILE as usize));
    down.flat_map(|y| across.clone().map(move |x| (x, y))).map(|(x, y)| tile(x, y)).fold(0.0, f64::max)
}

fn kept(name: &str) -> RgbImage {
    let kept = image::open(path(name));
    kept.unwrap_or_else(|e| panic!("{name}: {e}; TENON_WRITE_SNAPSHOTS=1 draws it")).into_rgb8()
}

/// Compares what the window shows, on a dark and on a light ground, with the pictures that are kept of it.
fn hold(w: &mut Window, view: &str) {
    for (theme, ground) in [(Theme::Dark, "dark"), (Theme::Light, "light")] {
        w.harness.ctx.set_theme(theme);
        w.settle();
        let name = format!("{view}-{ground}");
        let now = small(w, &format!("snapshot-{name}"));
        if std::env::var_os("TENON_WRITE_SNAPSHOTS").is_some() {
            std::fs::create_dir_all(path(&name).parent().unwrap()).unwrap();
            let file = std::fs::File::create(path(&name)).unwrap();
            let small = PngEncoder::new_with_quality(file, CompressionType::Best, Rows::Adaptive);
            now.write_with_encoder(small).unwrap();
        }
        let off = difference(&now, &kept(&name));
        println!("{name}: off by {off:.2}");
        assert!(off <= OFF, "{name}: a part of it is off by {off:.1}; see target/editor/snapshot-{name}.png");
    }
}

/// A window of which nothing is told that depends on the machine.
fn window(graph: Option<&Path>) -> Window {
    let mut w = Window::open(graph);
    if w.has("I see") {
        w.click(w.rect("I see").center());
    }
    w.hover(pos2(400.0, 12.0));
    w
}

fn shell() -> Window {
    let mut w = window(Some(&example("shell-256")));
    w.app().canvas.show_all();
    w
}

#[test]
fn the_canvas_and_the_shell_look_as_they_did() {
    let mut w = shell();
    hold(&mut w, "shell");
    w.app().viewport.measure = Some(Measure::Size);
    w.app().model.selection = ["thicken".to_owned()].into();
    hold(&mut w, "colours");
    w.app().viewport.measure = None;
    w.app().viewport.tool_paths = true;
    w.app().model.selection.clear();
    w.app().viewport.clip = Some(Clip::square_to(0, 2600.0));
    hold(&mut w, "section");
}

#[test]
fn boards_and_the_player_look_as_they_did() {
    let mut w = shell();
    w.app().side = Side::Boards;
    hold(&mut w, "boards");
    let length = w.app().boards.plays()[0].length();
    w.app().boards.player.code = true;
    w.app().boards.player.go_to(0.5 * length);
    w.settle();
    w.app().boards.player.show = w.app().boards.now().map(|(play, now)| (play.board, now.tip));
    hold(&mut w, "player");
    (w.app().boards.player.solid, w.app().boards.player.code) = (true, false);
    hold(&mut w, "solid");
}

#[test]
fn the_lower_panels_look_as_they_did() {
    let mut w = shell();
    w.app().model.selection = ["thicken".to_owned()].into();
    for (tab, view) in [(Tab::Pieces, "pieces"), (Tab::Data, "data")] {
        w.app().lower.toggle(tab);
        hold(&mut w, view);
    }
    let mut w = window(Some(&graph("snapshot-wrong", WRONG)));
    w.app().lower.toggle(Tab::Problems);
    hold(&mut w, "problems");
}

#[test]
fn the_examples_and_the_finder_look_as_they_did() {
    let mut w = window(None);
    w.click(w.rect("Help").center());
    w.click(w.rect("Examples …").center());
    hold(&mut w, "gallery");
    let mut w = window(None);
    w.click(w.rect("Add node").center());
    w.type_text("panel");
    hold(&mut w, "finder");
}

#[test]
fn a_panel_that_moves_and_a_word_that_is_missing_are_seen_and_other_times_are_not() {
    let mut w = shell();
    w.app().model.selection = ["thicken".to_owned()].into();
    w.settle();
    let before = small(&mut w, "snapshot-before");
    // All of it runs again, so that other times stand there.
    let spacing = |w: &mut Window, mm: f64| {
        let set =
            tenon_engine::Operation::SetParam { node: "screws".into(), port: "spacing".into(), value: Some(mm.into()) };
        assert!(w.app().model.edit(set));
        w.settle();
    };
    let was = w.param("screws", "spacing");
    spacing(&mut w, 151.0);
    spacing(&mut w, was.parse().unwrap_or(150.0));
    w.app().model.message = None;
    let again = difference(&small(&mut w, "snapshot-again"), &before);
    assert!(again <= OFF, "only times differ, by {again:.1}");
    // One word less over the viewport.
    let title = w.first("Addresses");
    let blot = |picture: &RgbImage| {
        let mut blotted = picture.clone();
        let [x, y] = [title.left(), title.top()].map(|v| v as u32 / REDUCED);
        let ground = *picture.get_pixel(x - 1, y);
        for (x, y) in (y..=y + 2).flat_map(|y| (x..x + 8).map(move |x| (x, y))) {
            blotted.put_pixel(x, y, ground);
        }
        blotted
    };
    let word = difference(&blot(&before), &before);
    assert!(word > OFF, "a word that is missing is seen only by {word:.1}");
    // The panels on the right become narrower by a dozen points.
    let edge = w.rect("viewport").left() - 8.0;
    let at = pos2(edge, 400.0);
    w.drag(at, at + vec2(12.0, 0.0));
    w.settle();
    let moved = difference(&small(&mut w, "snapshot-moved"), &before);
    assert!(moved > OFF, "a panel that has moved is seen only by {moved:.1}");
    println!("times {again:.2}, a word {word:.2}, a panel {moved:.2}");
}
