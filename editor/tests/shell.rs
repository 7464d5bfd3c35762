//! The shell of 256 panels: seen, moved by its control points and sliders, picked.

use crate::common::{Window, example};
use eframe::egui::{Modifiers, PointerButton, vec2};
use tenon_editor::viewport::Measure;
use tenon_engine::Json;

/// Pixels of a part of a picture that are the colour of wood in some light.
fn wooden(picture: &image::RgbaImage, area: eframe::egui::Rect) -> usize {
    let pixels = picture.enumerate_pixels();
    let inside = pixels.filter(|(x, y, _)| area.contains(eframe::egui::pos2(*x as f32, *y as f32)));
    inside.filter(|(_, _, p)| p[0] > 90 && p[0] > p[1].saturating_add(8) && p[1] > p[2].saturating_add(15)).count()
}

#[test]
fn the_shell_opens_is_seen_and_follows_the_hand() {
    let mut w = Window::open(Some(&example("shell-256")));
    assert_eq!(w.app().model.results.counts(), (0, 0), "{:?}", w.app().model.results.diagnostics);
    assert_eq!(w.app().model.results.drawings["thicken.panels"].parts.len(), 256);
    let viewport = w.rect("viewport");
    let picture = w.picture("shell");
    let seen = wooden(&picture, viewport);
    assert!(seen > 4000, "only {seen} pixels of the viewport look like wood");
    assert!(!w.app().model.unsaved(), "opening alone changes nothing");

    // A control point is dragged: every frame changes the document, the panels follow, and all of it is one step.
    let before = (w.text(), w.app().model.results.drawings["thicken.panels"].digest);
    let at = w.rect("point arc.points 2").center();
    w.press(at, at + vec2(30.0, -40.0), Modifiers::NONE);
    let start = std::time::Instant::now();
    while w.app().model.results.drawings["thicken.panels"].digest == before.1 {
        assert!(start.elapsed().as_secs() < 60, "the shell does not follow while the point is held");
        std::thread::sleep(std::time::Duration::from_millis(5));
        w.steps(1);
    }
    assert_ne!(w.text(), before.0);
    w.release(at + vec2(30.0, -40.0));
    w.settle();
    assert_ne!(w.app().model.results.drawings["thicken.panels"].digest, before.1);
    let moved: Json = serde_json::from_str(&w.param("arc", "points")).unwrap();
    assert_eq!((&moved[0], &moved[2]), (&serde_json::json!([0, 0, 0]), &serde_json::json!([3600, 0, 1500])));
    assert_eq!(w.app().model.steps(), (1, 0));
    w.picture("shell-moved");
    w.app().model.undo();
    w.settle();
    assert_eq!((w.text(), w.app().model.results.drawings["thicken.panels"].digest), before);

    // The slider of an input without a wire.
    w.app().model.selection = ["thicken".to_owned()].into();
    w.app().canvas.show_all();
    w.steps(3);
    let row = w.rect("input thicken.thickness");
    w.drag(row.left_center() + vec2(40.0, 0.0), row.left_center() + vec2(row.width() * 0.8, 0.0));
    w.settle();
    let thickness: f64 = w.param("thicken", "thickness").parse().unwrap();
    assert!((20.0..28.0).contains(&thickness), "{thickness}");
    assert_eq!(w.app().model.steps(), (1, 0), "sliding is one step");
    w.picture("shell-thick");
    w.app().model.undo();
    w.settle();

    // A panel is picked: its node is selected and its address is known.
    let viewport = w.rect("viewport");
    let part = w.app().model.results.drawings["thicken.panels"].parts[200].centre;
    let at = w.app().viewport.camera.project(viewport, part).unwrap();
    w.click(at);
    w.picture("shell-picked");
    for measure in [Measure::Size, Measure::Fold] {
        let parts = &w.app().model.results.drawings["thicken.panels"].parts;
        let figures: Vec<f64> = parts.iter().map(|p| measure.of(p)).collect();
        assert!(figures.iter().all(|f| *f > 0.0), "every panel has an area and a neighbour at an angle");
    }
    let sum: f64 = w.app().model.results.drawings["thicken.panels"].parts.iter().map(|p| p.area).sum();
    let area = w.app().model.results.values["thicken.area"].first::<f64>().copied().unwrap();
    assert!((sum - area).abs() < 1e-6 * area, "{sum} {area}");
    w.app().viewport.measure = Some(Measure::Size);
    w.steps(2);
    let picture = w.picture("shell-measured");
    let blue = picture.pixels().filter(|p| p[2] > 90 && p[2] > p[0].saturating_add(40)).count();
    assert!(blue > 1000, "small panels are blue: {blue} pixels are");
    w.app().viewport.measure = None;
    let picked = w.app().viewport.picked.clone().unwrap();
    assert_eq!(picked.output, "thicken.panels");
    assert!(w.app().model.selection.contains("thicken"));

    // Turning, nearing and moving leave the document alone.
    let (text, camera) = (w.text(), w.app().viewport.camera);
    let corner = viewport.right_bottom() - vec2(40.0, 40.0);
    w.drag_with(corner, corner - vec2(90.0, 30.0), PointerButton::Secondary, Modifiers::NONE);
    assert_ne!(w.app().viewport.camera, camera);
    assert_eq!(w.text(), text);
}
