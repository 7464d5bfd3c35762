//! What is seen in space: cut open, measured, in colours, with tool paths and references, as a picture of any size; points and
//! weights taken by hand.

use crate::common::{Window, example, folder, graph};
use eframe::egui::{Key, Modifiers, vec2};
use tenon_editor::viewport::{Clip, Measure};

/// Pixels of the picture that are more green than anything else.
fn green(picture: &image::RgbaImage) -> usize {
    let is = |p: &image::Rgba<u8>| p[1] > p[0].saturating_add(50) && p[1] > p[2].saturating_add(50);
    picture.pixels().filter(|p| is(p)).count()
}

fn wooden(picture: &image::RgbaImage) -> usize {
    let is = |p: &image::Rgba<u8>| p[0] > 90 && p[0] > p[1].saturating_add(8) && p[1] > p[2].saturating_add(15);
    picture.pixels().filter(|p| is(p)).count()
}

#[test]
fn the_shell_is_cut_open_measured_and_drawn_at_any_size() {
    let mut w = Window::open(Some(&example("shell-256")));
    let area = w.rect("viewport");
    let whole = w.app().viewport.picture([400, 300]).unwrap();
    assert_eq!(whole.dimensions(), (400, 300));
    assert_eq!(w.app().viewport.picture([1000, 40]).unwrap().dimensions(), (1000, 40));
    let refused = w.app().viewport.picture([1 << 20, 1 << 20]).unwrap_err();
    assert!(refused.contains("1048576"), "{refused}");
    // What is larger than a tile is put together without seams: reduced it is the picture in one piece.
    let large = w.app().viewport.picture([4400, 3300]).unwrap();
    let small = image::imageops::resize(&large, 400, 300, image::imageops::FilterType::Triangle);
    let differ = small.pixels().zip(whole.pixels()).filter(|(a, b)| (0..3).any(|k| a[k].abs_diff(b[k]) > 90)).count();
    assert!(differ < 2400, "{differ} of 120000 pixels differ");
    let file = folder("picture").join("shell.png");
    w.app().viewport.picture_size = [320, 200];
    w.app().viewport.picture_to(&file).unwrap();
    assert_eq!(image::open(&file).unwrap().to_rgba8().dimensions(), (320, 200));

    // Half of it is cut away, and what is cut away is not picked.
    let parts = w.app().model.results.drawings["thicken.panels"].parts.clone();
    w.app().viewport.clip = Some(Clip::square_to(0, 2250.0));
    w.settle();
    let half = w.app().viewport.picture([400, 300]).unwrap();
    let (all, left) = (wooden(&whole), wooden(&half));
    assert!(left * 3 < all * 2 && left * 10 > all, "{left} of {all} pixels of wood are left");
    w.picture("section");
    let gone = parts.iter().max_by(|a, b| a.centre.x.total_cmp(&b.centre.x)).unwrap().centre;
    let at = w.app().viewport.camera.project(area, gone).unwrap();
    w.click(at);
    let picked = w.app().viewport.picked.clone();
    assert!(picked.is_none_or(|p| parts[p.part as usize].centre.x < 2300.0));
    w.app().viewport.clip = None;

    // The distance of two panels' corners.
    w.click(w.rect("Measure").center());
    for part in [40, 200] {
        let at = w.app().viewport.camera.project(area, parts[part].centre).unwrap();
        w.click(at);
    }
    let ends = w.app().viewport.ruler.ends.clone();
    let apart = parts[40].centre.distance(parts[200].centre);
    assert_eq!(ends.len(), 2);
    assert!((ends[0].distance(ends[1]) - apart).abs() < 500.0, "{} and not {apart}", ends[0].distance(ends[1]));
    w.picture("measure");
    w.click(w.rect("Measure").center());

    // Tool paths where the panels are: cuts are green.
    let before = green(&w.app().viewport.picture([600, 400]).unwrap());
    w.app().viewport.tool_paths = true;
    w.settle();
    let after = green(&w.app().viewport.picture([600, 400]).unwrap());
    assert!(after > before + 500, "{before} green pixels, then {after}");
    w.picture("tool-paths");
    w.app().viewport.tool_paths = false;

    // Planar panels have no corner off their plane.
    for part in &w.app().model.results.drawings["thicken.panels"].parts {
        assert!(part.planarity < 1e-6 && part.conicity.is_finite());
    }
    for measure in [Measure::Planarity, Measure::Conicity] {
        w.app().viewport.measure = Some(measure);
        w.steps(2);
    }
    w.picture("conicity");
}

#[test]
fn pictures_and_meshes_stand_behind_the_model() {
    let mut w = Window::open(None);
    let dir = folder("behind");
    let picture = dir.join("plan.png");
    image::RgbImage::from_fn(60, 40, |x, _| image::Rgb([if x < 30 { 250 } else { 0 }, 20, 20])).save(&picture).unwrap();
    w.drop_file(&picture);
    assert_eq!(w.app().viewport.references.len(), 1, "{:?}", w.app().model.message);
    assert!(w.app().viewport.references[0].picture.is_some());
    let (area, bounds) = (w.rect("viewport"), w.app().viewport.references[0].drawing.bounds);
    w.app().viewport.camera.fit(area, bounds);
    w.steps(2);
    let seen = w.app().viewport.picture([300, 200]).unwrap();
    let red = seen.pixels().filter(|p| p[0] > 150 && p[1] < 60).count();
    assert!(red > 2000, "{red} pixels are red");
    // It is placed and scaled by numbers.
    let r = &mut w.app().viewport.references[0];
    (r.at.x, r.scale) = (20_000.0, 500.0);
    r.place();
    let moved = r.drawing.bounds;
    assert_eq!([moved[0].x, moved[1].x], [20_000.0, 20_500.0]);
    w.steps(2);
    let seen = w.app().viewport.picture([300, 200]).unwrap();
    assert_eq!(seen.pixels().filter(|p| p[0] > 150 && p[1] < 60).count(), 0, "it lies elsewhere");
    // A mesh is another; both are listed under More.
    let mesh = dir.join("rock.obj");
    std::fs::write(&mesh, "v 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nf 1 2 3 4\n").unwrap();
    w.app().viewport.refer_to(&mesh).unwrap();
    w.click(w.rect("More").center());
    assert!(w.has("plan.png") && w.has("rock.obj"));
    w.picture("references");
    w.key(Modifiers::NONE, Key::Escape);
    std::fs::write(dir.join("bad.png"), "no picture").unwrap();
    w.drop_file(&dir.join("bad.png"));
    assert!(w.app().model.message.as_ref().unwrap().message.contains("bad.png"));
}

#[test]
fn weights_and_subdivision_points_are_taken_by_hand() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": { "c": { "type": "ifs_curve", "v": 1, "params": { "points": [[0, 0, 0], [500, 0, 300], [1000, 0, 0]] } } }
}"#;
    let mut w = Window::open(Some(&graph("weights", text)));
    let shape = |w: &Window| w.harness.state().model.results.drawings["c.curve"].digest;
    let before = shape(&w);
    w.click(w.rect("point c.points 2").center());
    let knob = w.rect("weight c.points 2").center();
    w.drag(knob, knob + vec2(20.0, 0.0));
    w.settle();
    let weights: Vec<f64> = serde_json::from_str(&w.param("c", "weights")).unwrap();
    assert!(weights[1] > 1.5 && weights[0] == 1.0, "{weights:?}");
    assert_ne!(shape(&w), before);
    assert_eq!(w.app().model.steps().0, 1, "turning a weight is one step");
    w.picture("weight");
    w.key(Modifiers::COMMAND, Key::Z);
    w.settle();
    assert_eq!(shape(&w), before);
    // A subdivision point: the curve bends, the control points stay.
    let point = w.rect("point c s2").center();
    w.drag(point, point + vec2(0.0, -25.0));
    w.settle();
    assert_eq!(w.param("c", "subdivision_numbers"), "[2]");
    assert_ne!(shape(&w), before);
    assert_eq!(w.app().model.results.counts().0, 0, "{:?}", w.app().model.results.diagnostics);
}
