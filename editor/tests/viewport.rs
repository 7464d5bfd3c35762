//! What is seen in space: cut open, measured, in colours, with tool paths and references, as a picture of any size; points and
//! weights taken by hand.

use crate::common::{Window, example, folder, graph, small_shell};
use eframe::egui::{Key, Modifiers, vec2};
use egui_kittest::kittest::Queryable as _;
use std::path::PathBuf;
use tenon_editor::viewport::{Clip, Measure, Standard, references};
use tenon_engine::{Operation, Table};
use tenon_geometry::panel::PanelSet;
use tenon_nodes::value::V;

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
fn the_shell_is_cut_open_and_drawn_at_any_size() {
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
    let ctx = w.harness.ctx.clone();
    w.app().viewport.save_picture(&ctx, &file).unwrap();
    w.settle();
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
fn the_distance_of_two_corners_is_measured_exactly_though_they_are_clicked_beside() {
    let mut w = Window::open(Some(&small_shell("measured", |_| ())));
    let area = w.rect("viewport");
    let panels = w.app().model.results.values["thicken.panels"].first::<V<PanelSet>>().unwrap().clone();
    // The front of a panel at the top, so near that a point of the screen is some tenths of a millimetre.
    let part = (0..panels.len()).max_by(|a, b| panels.normal[*a].z.total_cmp(&panels.normal[*b].z)).unwrap();
    let corners = &panels.front[panels.corners(part)];
    let bounds = corners.iter().fold([corners[0]; 2], |[low, high], p| [low.min(*p), high.max(*p)]);
    w.app().viewport.camera.stand(Standard::Top);
    w.app().viewport.camera.fit(area, bounds);
    w.click(w.rect("Measure").center());
    let middle = (bounds[0] + bounds[1]) / 2.0;
    for corner in [corners[0], corners[2]] {
        let camera = w.app().viewport.camera;
        let [at, inwards] = [corner, middle].map(|p| camera.project(area, p).unwrap());
        w.click(at + (inwards - at).normalized() * 2.0);
    }
    let words = w.harness.get_by_label_contains(" mm  (x ").value().unwrap();
    let told: Vec<f64> = words.split(|c: char| !"0123456789.-".contains(c)).filter_map(|n| n.parse().ok()).collect();
    let apart = corners[2] - corners[0];
    let exact = [apart.length(), apart.x, apart.y, apart.z];
    assert!(told.len() == 4 && (0..4).all(|k| (told[k] - exact[k]).abs() < 0.0051), "{words}, and not {exact:?}");
    assert!(area.contains_rect(w.rect_containing(" mm  (x ")));
    w.picture("measure");
    // A third click begins anew.
    w.click(area.center());
    assert!(!w.has_containing(" mm  (x "));
}

#[test]
fn a_section_is_measured_where_it_is_and_no_corner_that_is_cut_away_is_taken() {
    let mut w = Window::open(Some(&small_shell("measured-section", |_| ())));
    let area = w.rect("viewport");
    let panels = w.app().model.results.values["thicken.panels"].first::<V<PanelSet>>().unwrap().clone();
    let part = (0..panels.len()).max_by(|a, b| panels.normal[*a].z.total_cmp(&panels.normal[*b].z)).unwrap();
    // A place inside of a panel at the top, through which it is cut, seen a little from above.
    let front = &panels.front[panels.corners(part)];
    let middle = front.iter().sum::<glam::DVec3>() / front.len() as f64;
    let inside = middle - panels.normal[part] * panels.thickness / 2.0;
    w.app().viewport.clip = Some(Clip::square_to(0, inside.x));
    let camera = &mut w.app().viewport.camera;
    (camera.target, camera.distance, camera.yaw, camera.pitch) = (inside, 200.0, 0.0, 0.3);
    w.settle();
    w.click(w.rect("Measure").center());
    let at = w.app().viewport.camera.project(area, inside).unwrap();
    w.click(at);
    let taken = w.app().viewport.ruler.ends[0];
    assert!((taken.x - inside.x).abs() < 1e-3 && taken.distance(inside) < 10.0, "{taken}, and not {inside}");
    // From above, with a corner cut away that is nearly under the pointer.
    let corner = *front.iter().max_by(|a, b| a.x.total_cmp(&b.x)).unwrap();
    w.app().viewport.camera.stand(Standard::Top);
    w.app().viewport.camera.fit(area, [corner.min(middle), corner.max(middle)]);
    let [a, b] = [corner, middle].map(|p| w.harness.state().viewport.camera.project(area, p).unwrap());
    let point = (corner - middle) / f64::from((a - b).length());
    w.app().viewport.clip = Some(Clip::square_to(0, corner.x - 2.0 * point.x));
    w.settle();
    w.click(a + (b - a).normalized() * 6.0);
    let taken = w.app().viewport.ruler.ends[1];
    assert!(taken.x < corner.x - 2.0 * point.x + 1e-3, "{taken} is cut away");
    assert!(taken.distance(corner - 6.0 * point) < 2.0, "{taken} is beside where was clicked");
}

#[test]
fn a_section_is_turned_and_tilted_by_its_fields_and_a_picture_is_as_large_as_its_fields_say() {
    let mut w = Window::open(Some(&small_shell("fields", |_| ())));
    w.click(w.rect("More").center());
    w.click(w.rect("Cut open").center());
    w.settle();
    let wood = |w: &mut Window| wooden(&w.app().viewport.picture([400, 300]).unwrap());
    let first = wood(&mut w);
    let place = w.app().viewport.clip.map(|c| c.normal * c.at).unwrap();
    w.fill("turn of the section", "60");
    w.fill("tilt of the section", "30");
    w.settle();
    let clip = w.app().viewport.clip.unwrap();
    let meant = glam::DVec3::new(0.75f64.sqrt() * 0.5, 0.75, 0.5);
    assert!(clip.normal.distance(meant) < 1e-9, "{}", clip.normal);
    assert!(clip.side(place).abs() < 1.0, "it turns about where it was");
    let turned = wood(&mut w);
    assert!(turned.abs_diff(first) > 300, "{first} pixels of wood, then {turned}");
    w.picture("section-turned");
    let file = folder("picture-fields").join("view.png");
    w.fill("width of the picture", "320");
    w.fill("height of the picture", "200");
    w.click(w.rect("Save a picture …").center());
    w.type_text(&file.to_string_lossy());
    w.key(Modifiers::NONE, Key::Enter);
    w.settle();
    assert_eq!(image::open(&file).unwrap().to_rgba8().dimensions(), (320, 200));
}

#[test]
fn a_picture_behind_the_model_is_turned_and_stood_upright_by_hand() {
    let (path, photo) = graph_and_photo("turned-behind", "photo.png");
    let mut w = Window::open(Some(&path));
    choose_reference(&mut w, &photo);
    let bounds = |w: &Window| {
        let app = w.harness.state();
        app.viewport.references.boxes(&app.model)[0].1.map(|p| p.round().to_array())
    };
    assert_eq!(bounds(&w), [[0.0; 3], [5000.0, 2500.0, 0.0]]);
    w.click(w.rect("More").center());
    w.click(w.rect("upright").center());
    assert_eq!(bounds(&w), [[0.0; 3], [5000.0, 0.0, 2500.0]]);
    w.fill("turn of photo.png", "90");
    assert_eq!(bounds(&w), [[0.0; 3], [0.0, 5000.0, 2500.0]]);
    w.key(Modifiers::NONE, Key::Escape);
    assert_eq!(w.app().model.steps().0, 3, "it came, was stood up, and turned");
    w.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(bounds(&w), [[0.0; 3], [5000.0, 0.0, 2500.0]]);
}

#[test]
fn pictures_and_meshes_stand_behind_the_model() {
    let mut w = Window::open(None);
    let dir = folder("behind");
    let picture = dir.join("plan.png");
    image::RgbImage::from_fn(60, 40, |x, _| image::Rgb([if x < 30 { 250 } else { 0 }, 20, 20])).save(&picture).unwrap();
    w.drop_file(&picture);
    w.settle();
    let bounds = |w: &Window, file: &str| {
        let app = w.harness.state();
        let all = app.viewport.references.boxes(&app.model);
        all.into_iter().find(|(name, _)| name.ends_with(file)).unwrap().1
    };
    let (area, first) = (w.rect("viewport"), bounds(&w, "plan.png"));
    assert_eq!([first[0].x, first[1].x], [0.0, 5000.0]);
    w.app().viewport.camera.fit(area, first);
    w.steps(2);
    let red = |w: &mut Window| {
        let seen = w.app().viewport.picture([300, 200]).unwrap();
        seen.pixels().filter(|p| p[0] > 150 && p[1] < 60).count()
    };
    assert!(red(&mut w) > 2000, "{} pixels are red", red(&mut w));
    // A plane that cuts the view open cuts it too, where it stands.
    let whole = red(&mut w);
    w.app().viewport.clip = Some(Clip::square_to(0, 1250.0));
    w.steps(2);
    let cut = red(&mut w);
    assert!(cut * 3 > whole && cut * 3 < whole * 2, "half of {whole} red pixels are cut away, {cut} are left");
    w.app().viewport.clip = None;
    // It is moved by mouse and scaled by typing, each as one step.
    w.click(w.rect("More").center());
    let x = w.rect("x of plan.png").center();
    w.drag(x, x + vec2(80.0, 0.0));
    let moved = bounds(&w, "plan.png");
    assert!(moved[0].x > 500.0 && moved[0].y == 0.0, "{moved:?}");
    assert_eq!(w.app().model.steps().0, 2, "it came, and was moved");
    w.click(w.rect("width of plan.png").center());
    w.key(Modifiers::COMMAND, Key::A);
    w.type_text("500");
    w.key(Modifiers::NONE, Key::Enter);
    let scaled = bounds(&w, "plan.png");
    assert!((scaled[1].x - scaled[0].x - 500.0).abs() < 1e-9, "{scaled:?}");
    w.picture("references");
    w.key(Modifiers::NONE, Key::Escape);
    w.key(Modifiers::COMMAND, Key::Z);
    w.key(Modifiers::COMMAND, Key::Z);
    assert_eq!(bounds(&w, "plan.png"), first);
    // A mesh is another.
    let mesh = dir.join("rock.obj");
    std::fs::write(&mesh, "v 0 0 0\nv 9 0 0\nv 9 9 0\nv 0 9 0\nf 1 2 3 4\n").unwrap();
    choose_reference(&mut w, &mesh);
    assert_eq!(bounds(&w, "rock.obj")[1].x, 9.0);
    std::fs::write(dir.join("bad.png"), "no picture").unwrap();
    w.drop_file(&dir.join("bad.png"));
    w.settle();
    assert!(w.app().model.message.as_ref().unwrap().message.contains("bad.png"));
    assert_eq!(references(&w.app().model).len(), 2, "what cannot be shown is not kept");
}

/// Takes a file behind the model by the menu.
fn choose_reference(w: &mut Window, path: &std::path::Path) {
    w.click(w.rect("File").center());
    w.click(w.rect("Show a mesh or picture behind …").center());
    w.type_text(&path.to_string_lossy());
    w.key(Modifiers::NONE, Key::Enter);
    w.settle();
}

/// A graph of one number, and a red picture beside it.
fn graph_and_photo(name: &str, photo: &str) -> (PathBuf, PathBuf) {
    let path = graph(name, r#"{ "format": "tenon", "version": 1, "nodes": { "n": { "type": "number", "v": 1 } } }"#);
    let photo = path.with_file_name(photo);
    image::RgbImage::from_pixel(80, 40, image::Rgb([250, 20, 20])).save(&photo).unwrap();
    (path, photo)
}

#[test]
fn what_stands_behind_the_model_is_kept_with_the_graph_and_told_if_its_file_is_missing() {
    let (path, photo) = graph_and_photo("kept-behind", "photo.jpg");
    let mut w = Window::open(Some(&path));
    choose_reference(&mut w, &photo);
    assert!(w.app().model.unsaved(), "{:?}", w.app().model.message);
    w.click(w.rect("More").center());
    let y = w.rect("y of photo.jpg").center();
    w.drag(y, y + vec2(-60.0, 0.0));
    w.key(Modifiers::NONE, Key::Escape);
    w.key(Modifiers::COMMAND, Key::S);
    let kept = references(&w.app().model);
    assert!(kept[0].file == "photo.jpg" && kept[0].at.y < -100.0, "{kept:?}");
    let layout = std::fs::read_to_string(path.with_file_name("graph.layout.json")).unwrap();
    assert!(layout.contains("photo.jpg"), "{layout}");
    assert_eq!(w.text(), Window::open(Some(&path)).text(), "the graph's own file says nothing of it");

    let mut again = Window::open(Some(&path));
    assert_eq!(references(&again.app().model), kept);
    assert!(!again.app().model.unsaved());
    let app = again.harness.state();
    assert_eq!(app.viewport.references.boxes(&app.model)[0].1[0].y, kept[0].at.y);

    std::fs::remove_file(&photo).unwrap();
    let mut without = Window::open(Some(&path));
    let told = without.app().model.message.clone().unwrap().message;
    assert!(told.contains("photo.jpg") && told.contains("cannot be shown"), "{told}");
    assert_eq!(references(&without.app().model), kept, "its place is kept all the same");
    without.click(without.rect("More").center());
    assert!(without.has_containing("No such file") || without.has_containing("cannot find"));
    without.click(without.rect("take away photo.jpg").center());
    assert!(references(&without.app().model).is_empty());
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

#[test]
fn a_ring_of_any_weight_is_dragged_from_where_it_is_taken() {
    let text = r#"{
  "format": "tenon",
  "version": 1,
  "nodes": { "c": { "type": "ifs_curve", "v": 1, "params": { "points": [[0, 0, 0], [500, 0, 300], [1000, 0, 0]], "weights": [1, W, 1] } } }
}"#;
    for weight in [0.5, 0.1, 50.0] {
        let mut w = Window::open(Some(&graph("ring", &text.replace('W', &weight.to_string()))));
        w.click(w.rect("point c.points 2").center());
        let before = w.text();
        let knob = w.rect("weight c.points 2").center();
        w.press(knob, knob, Modifiers::NONE);
        // Held so long it counts as dragged.
        w.steps(60);
        assert_eq!(w.text(), before, "{weight} was taken and not moved");
        w.hover(knob + vec2(7.0, 0.0));
        w.release(knob + vec2(7.0, 0.0));
        w.settle();
        let weights: Vec<f64> = serde_json::from_str(&w.param("c", "weights")).unwrap();
        assert!((weights[1] - weight * 2f64.sqrt()).abs() < 1e-3 * weight.max(1.0), "{weight}: {weights:?}");
        assert_eq!(w.app().model.steps().0, 1);
    }
}

#[test]
fn one_file_stands_behind_the_model_twice_and_is_read_anew_in_another_folder() {
    let (path, photo) = graph_and_photo("twice-behind", "photo.png");
    let mut w = Window::open(Some(&path));
    w.drop_file(&photo);
    w.settle();
    let steps = w.app().model.steps();
    w.drop_file(&photo);
    w.settle();
    assert_eq!(w.app().model.steps(), steps, "it stands there already: nothing has changed");
    // Twice, beside each other.
    let entries = serde_json::json!([{ "file": "photo.png" }, { "file": "photo.png", "at": [10000, 0, 0] }]);
    let set = Operation::SetEntry { table: Table::Layout, key: "references".into(), value: Some(entries) };
    w.app().model.apply_to_whole(set).unwrap();
    w.settle();
    let boxes = |w: &Window| {
        let app = w.harness.state();
        let all = app.viewport.references.boxes(&app.model);
        all.into_iter().map(|(_, b)| [b[0].x, b[1].x, b[1].y]).collect::<Vec<_>>()
    };
    assert_eq!(boxes(&w), [[0.0, 5000.0, 2500.0], [10000.0, 15000.0, 2500.0]]);
    let area = w.rect("viewport");
    w.app().viewport.camera.stand(Standard::Top);
    w.app().viewport.camera.fit(area, [glam::DVec3::ZERO, glam::DVec3::new(15000.0, 2500.0, 0.0)]);
    w.steps(2);
    let picture = w.picture("references-twice");
    let red = |left: bool| {
        let own = picture.enumerate_pixels().filter(|(x, _, _)| ((*x as f32) < area.center().x) == left);
        own.filter(|(_, _, p)| p[0] > 150 && p[1] < 60 && p[2] < 60).count()
    };
    assert!(red(true) > 300 && red(false) > 300, "{} and {} pixels are red", red(true), red(false));
    // A graph that is saved elsewhere names the files that lie there.
    let other = folder("twice-elsewhere").join("graph.tenon.json");
    image::RgbImage::from_pixel(40, 40, image::Rgb([20, 20, 250])).save(other.with_file_name("photo.png")).unwrap();
    w.app().model.save(Some(&other)).unwrap();
    w.settle();
    assert_eq!(boxes(&w)[0], [0.0, 5000.0, 5000.0], "the square picture of the other folder");
}

#[test]
fn that_a_file_cannot_be_shown_stays_told_beside_one_that_can() {
    let mut w = Window::open(None);
    let dir = folder("half-behind");
    let (good, bad) = (dir.join("plan.png"), dir.join("bad.png"));
    image::RgbImage::from_pixel(8, 8, image::Rgb([250, 20, 20])).save(&good).unwrap();
    std::fs::write(&bad, "no picture").unwrap();
    // Whichever is read first.
    for files in [[&good, &bad], [&bad, &good]] {
        for file in files {
            w.drop_file(file);
        }
        w.settle();
        assert!(w.app().model.message.as_ref().is_some_and(|m| m.message.contains("bad.png")), "it is told");
        assert_eq!(references(&w.app().model).len(), 1);
        w.app().model.undo();
        w.steps(2);
    }
}
