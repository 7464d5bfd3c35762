//! What stands behind the model to go by: meshes and pictures, placed by numbers. The layout file keeps which and where;
//! the files are read beside the window.

use super::Viewport;
use super::gpu::Picture;
use crate::model::Model;
use crate::model::beside::Beside;
use crate::model::file::name_in;
use crate::panels::{figure, step_around};
use crate::scene::{self, Drawing, Kind, Part, Vertex};
use crate::theme::Theme;
use eframe::egui::{Button, Context, DragValue, Response, Ui, WidgetInfo, WidgetType};
use glam::{DMat4, DVec3};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_engine::{Diagnostic, Json, Operation, Table, Tree, digest_bytes};
use tenon_nodes::io::read_obj;
use tenon_nodes::value::V;

/// The key of the layout file under which they stand.
const KEY: &str = "references";
/// What it is called that one cannot be shown.
const BAD: &str = "bad-reference";
/// How wide a picture is at first, mm.
const WIDTH: f64 = 5000.0;
/// Longest side of a picture on the card, pixels.
const SIDE: u32 = 4096;
/// The largest file that is read, bytes.
const LARGEST: u64 = 512 << 20;

/// Files that are shown as pictures, by their endings.
pub const PICTURES: [&str; 3] = ["png", "jpg", "jpeg"];

/// Something behind the model, as the layout file keeps it.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Its file, from the graph's folder on.
    pub file: String,
    /// Where its lower left corner, or the mesh's origin, lies, mm.
    pub at: DVec3,
    /// Width of a picture, mm; of a mesh how many times larger it is than in its file.
    pub scale: f64,
    /// Turn about Z, degrees.
    pub turn: f64,
    /// A picture stands upright instead of lying.
    pub upright: bool,
}

impl Reference {
    /// One that lies at the origin.
    fn new(file: &str) -> Self {
        let scale = if is_mesh(file) { 1.0 } else { WIDTH };
        Self { file: file.to_owned(), at: DVec3::ZERO, scale, turn: 0.0, upright: false }
    }

    /// One as it stands in the file; what makes no sense there is as at first.
    fn read(json: &Json) -> Option<Self> {
        let first = Self::new(json.get("file")?.as_str()?);
        let number = |json: Option<&Json>| json.and_then(Json::as_f64).filter(|v| v.is_finite());
        let at = json.get("at").and_then(Json::as_array);
        let at = at.and_then(|at| Some(DVec3::new(number(at.first())?, number(at.get(1))?, number(at.get(2))?)));
        Some(Self {
            at: at.unwrap_or_default(),
            scale: number(json.get("scale")).filter(|s| *s > 0.0).unwrap_or(first.scale),
            turn: number(json.get("turn")).unwrap_or_default(),
            upright: json.get("upright").and_then(Json::as_bool).unwrap_or_default(),
            ..first
        })
    }

    fn json(&self) -> Json {
        serde_json::json!({
            "file": self.file,
            "at": self.at.to_array(),
            "scale": self.scale,
            "turn": self.turn,
            "upright": self.upright,
        })
    }

    /// What it is called: its file without folders.
    #[must_use]
    pub fn name(&self) -> &str {
        self.file.rsplit('/').next().unwrap_or(&self.file)
    }

    /// From the coordinates of its file to the model's. A picture is one wide there, its lower left corner at the origin.
    #[must_use]
    pub fn place(&self) -> DMat4 {
        let upright = if self.upright { DMat4::from_rotation_x(90f64.to_radians()) } else { DMat4::IDENTITY };
        let turn = DMat4::from_rotation_z(self.turn.to_radians());
        DMat4::from_translation(self.at) * turn * upright * DMat4::from_scale(DVec3::splat(self.scale))
    }
}

/// What stands behind the model of a graph, in the order in which it came.
#[must_use]
pub fn references(model: &Model) -> Vec<Reference> {
    let all = model.whole().layout_entry(KEY).and_then(Json::as_array);
    all.into_iter().flatten().filter_map(Reference::read).collect()
}

/// The change that makes these stand behind the model.
fn set(all: &[Reference]) -> Operation {
    let value = (!all.is_empty()).then(|| all.iter().map(Reference::json).collect());
    Operation::SetEntry { table: Table::Layout, key: KEY.to_owned(), value }
}

/// What a file shows.
pub(super) struct Seen {
    pub(super) drawing: Arc<Drawing>,
    pub(super) picture: Option<Arc<Picture>>,
}

/// A file that is read, was read, or could not be.
#[derive(Default)]
struct Read {
    seen: Beside<Result<Seen, String>>,
    /// What is wrong has been told.
    told: bool,
}

impl Read {
    /// What it shows, or why it shows nothing; none while it is read.
    fn now(&self) -> Option<Result<&Seen, &str>> {
        match self.seen.now() {
            Some(read) => Some(Result::as_ref(read).map_err(String::as_str)),
            None => self.seen.settled().then_some(Err("it could not be read")),
        }
    }
}

/// The files behind the model, read beside the window.
#[derive(Default)]
pub struct References {
    /// By their whole paths: a graph that is saved into another folder names other files.
    files: BTreeMap<PathBuf, Read>,
    /// The graph's folder.
    folder: PathBuf,
    /// What stands in the layout once it could be read.
    new: BTreeSet<String>,
}

impl References {
    /// Whether nothing is being read.
    #[must_use]
    pub fn settled(&self) -> bool {
        self.new.is_empty() && self.files.values().all(|f| f.seen.settled())
    }

    /// The files that are being read.
    pub(super) fn coming(&self) -> impl Iterator<Item = &str> {
        self.files.iter().filter(|(_, f)| !f.seen.settled()).filter_map(|(path, _)| path.file_name()?.to_str())
    }

    /// What a file shows, once it is read.
    pub(super) fn seen(&self, file: &str) -> Option<&Seen> {
        self.files.get(&self.folder.join(file))?.now()?.ok()
    }

    /// Smallest and largest coordinates of each that is read, mm.
    #[must_use]
    pub fn boxes(&self, model: &Model) -> Vec<(String, [DVec3; 2])> {
        let of = |r: Reference| {
            let [low, high] = self.seen(&r.file)?.drawing.bounds;
            let place = r.place();
            let corner = |i: usize| {
                let pick = |k: usize| if i >> k & 1 == 0 { low[k] } else { high[k] };
                place.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
            };
            let bounds = (0..8).map(corner).map(|p| [p, p]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])?;
            Some((r.file, bounds))
        };
        references(model).into_iter().filter_map(of).collect()
    }

    /// Reads what the layout names and is not read yet, takes what was read, and tells what could not be.
    fn follow(&mut self, ctx: &Context, model: &mut Model) {
        let kept: BTreeSet<String> = references(model).into_iter().map(|r| r.file).collect();
        self.folder = folder_of(model);
        let wanted: BTreeSet<PathBuf> = kept.union(&self.new).map(|file| self.folder.join(file)).collect();
        self.files.retain(|path, _| wanted.contains(path));
        let mut wrong = Vec::new();
        for file in kept.union(&self.new) {
            let (path, ctx) = (self.folder.join(file), ctx.clone());
            let entry = self.files.entry(path.clone()).or_default();
            entry.seen.want(0, move || ctx.request_repaint(), move || read(&path));
            if let (Some(Err(why)), false) = (entry.now(), entry.told) {
                wrong.push((file.clone(), why.to_owned()));
                entry.told = true;
            }
        }
        let read: Vec<String> = self.new.iter().filter(|f| self.seen(f).is_some()).cloned().collect();
        self.new.retain(|file| !read.contains(file));
        let fresh: Vec<Reference> = read.iter().filter(|f| !kept.contains(*f)).map(|f| Reference::new(f)).collect();
        if !fresh.is_empty() {
            let mut all = references(model);
            all.extend(fresh);
            // A change clears what was told; that another file cannot be shown stays told.
            let told = model.message.take().filter(|m| m.code == BAD);
            model.message = model.apply_to_whole(set(&all)).err().or(told);
        }
        // Told last, so that what was shown at the same time does not hide it.
        for (file, why) in wrong {
            self.new.remove(&file);
            model.message = Some(Diagnostic::error(BAD, format!("{file} cannot be shown: {why}")));
        }
    }
}

impl Viewport {
    /// Shows a mesh (OBJ, in millimetres) or a picture (PNG, JPEG; at first on the ground) behind the model, as soon as it is
    /// read.
    pub fn refer_to(&mut self, model: &Model, path: &Path) {
        let file = name_in(model.path(), path);
        // It may have changed since it was read.
        self.references.files.remove(&folder_of(model).join(&file));
        self.references.new.insert(file);
    }

    /// Brings what stands behind the model up to the graph.
    pub(super) fn follow_references(&mut self, ctx: &Context, model: &mut Model) {
        self.references.follow(ctx, model);
    }

    /// The numbers of all that stands behind the model, to be changed.
    pub(super) fn edit_references(&self, ui: &mut Ui, model: &mut Model) {
        let mut all = references(model);
        let before = all.clone();
        let mut index = 0;
        all.retain_mut(|reference| {
            index += 1;
            !ui.push_id(index, |ui| self.edit_reference(ui, model, reference)).inner
        });
        if all != before {
            model.message = model.apply_to_whole(set(&all)).err();
        }
    }

    /// The numbers of one; true if it is not to be shown any more.
    fn edit_reference(&self, ui: &mut Ui, model: &mut Model, r: &mut Reference) -> bool {
        let name = r.name().to_owned();
        let read = self.references.files.get(&folder_of(model).join(&r.file)).and_then(Read::now);
        let gone = ui.horizontal(|ui| {
            ui.weak(&name).on_hover_text(&r.file);
            match read {
                Some(Err(why)) => ui.colored_label(Theme::of(ui).error, why),
                Some(Ok(_)) => ui.label(""),
                None => ui.spinner(),
            };
            let away = ui.add(Button::new("×").small()).on_hover_text("do not show it any more");
            away.widget_info(|| WidgetInfo::labeled(WidgetType::Button, true, format!("take away {name}")));
            away.clicked()
        });
        let mut number = |ui: &mut Ui, what: &str, field: DragValue<'_>| -> Response {
            let response = ui.add(field);
            response.widget_info(|| WidgetInfo::labeled(WidgetType::DragValue, true, format!("{what} of {name}")));
            step_around(ui, model, &response);
            response
        };
        ui.horizontal(|ui| {
            for (axis, value) in ["x", "y", "z"].into_iter().zip([&mut r.at.x, &mut r.at.y, &mut r.at.z]) {
                number(ui, axis, figure(value, "mm").speed(10.0).max_decimals(1).prefix(format!("{axis} ")));
            }
        });
        ui.horizontal(|ui| {
            let mesh = is_mesh(&r.file);
            let scale = figure(&mut r.scale, if mesh { "" } else { "mm" }).range(1e-6..=1e7).max_decimals(3);
            match mesh {
                true => number(ui, "scale", scale.speed(0.01).suffix(" times")),
                false => number(ui, "width", scale.speed(10.0).prefix("width ").suffix(" mm")),
            };
            let turn = figure(&mut r.turn, "deg").speed(1.0).max_decimals(1).suffix("°");
            number(ui, "turn", turn).on_hover_text("turned about Z");
            if !mesh {
                ui.checkbox(&mut r.upright, "upright");
            }
        });
        gone.inner
    }
}

/// The folder from which files of a graph are named.
fn folder_of(model: &Model) -> PathBuf {
    model.path().and_then(Path::parent).map(Path::to_owned).unwrap_or_default()
}

fn is_mesh(file: &str) -> bool {
    Path::new(file).extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"))
}

/// Reads a file; O(bytes).
fn read(path: &Path) -> Result<Seen, String> {
    let size = std::fs::metadata(path).map_err(|e| e.to_string())?.len();
    if size > LARGEST {
        return Err(format!("it is larger than {} MiB", LARGEST >> 20));
    }
    let bytes = std::fs::read(path).map_err(|e| e.to_string())?;
    if is_mesh(&path.to_string_lossy()) {
        let mesh = read_obj(&bytes, 1.0).map_err(|e| e.to_string())?;
        let drawing = scene::draw(&Tree::item(V::new(mesh))).ok_or("nothing is in it")?;
        return Ok(Seen { drawing: Arc::new(drawing), picture: None });
    }
    let image = image::load_from_memory(&bytes).map_err(|e| e.to_string())?;
    let large = image.width().max(image.height()) > SIDE;
    let image = if large { image.thumbnail(SIDE, SIDE) } else { image }.to_rgba8();
    let size = [image.width(), image.height()];
    if size.contains(&0) {
        return Err("it has no pixels".into());
    }
    let drawing = Arc::new(ground(size, digest_bytes(&bytes)));
    Ok(Seen { drawing, picture: Some(Arc::new(Picture { size, bytes: image.into_raw() })) })
}

/// What a picture lies on: one wide, its lower left corner at the origin.
fn ground(size: [u32; 2], digest: u128) -> Drawing {
    let height = f64::from(size[1]) / f64::from(size[0]);
    let mut d = Drawing::empty(Kind::Mesh);
    let corner = |part: u32| {
        let (right, below) = (f64::from(part & 1), f64::from(part >> 1));
        let position = [right as f32, ((1.0 - below) * height) as f32, 0.0];
        Vertex { position, normal: [0, 0, 127, 0], part }
    };
    d.triangles = [2, 3, 1, 2, 1, 0].map(corner).to_vec();
    d.parts = vec![Part::new("picture".into(), DVec3::ZERO)];
    (d.bounds, d.digest) = ([DVec3::ZERO, DVec3::new(1.0, height, 0.0)], digest);
    d
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_placed_scaled_and_turned_by_its_numbers() {
        let d = ground([2, 3], 1);
        let mut r = Reference { at: DVec3::new(100.0, 0.0, 5.0), scale: 200.0, ..Reference::new("in/p.png") };
        let corner = |r: &Reference| r.place().transform_point3(d.bounds[1]);
        assert!(corner(&r).distance(DVec3::new(300.0, 300.0, 5.0)) < 1e-9);
        // The first row is the farthest.
        let first = d.triangles.iter().find(|v| v.part == 0).unwrap();
        assert_eq!(first.position, [0.0, 1.5, 0.0]);
        (r.turn, r.upright) = (90.0, true);
        assert!(corner(&r).distance(DVec3::new(100.0, 200.0, 305.0)) < 1e-9, "{}", corner(&r));
        assert_eq!(r.name(), "p.png");
    }

    #[test]
    fn they_are_kept_as_they_are_and_nonsense_is_as_at_first() {
        let mut r = Reference::new("rock.obj");
        (r.at, r.scale, r.turn) = (DVec3::new(1.5, -2.0, 0.0), 0.25, 30.0);
        assert_eq!(Reference::read(&r.json()), Some(r));
        let wrong = serde_json::json!({ "file": "p.jpg", "at": [1, "two", 3], "scale": -4, "turn": [], "upright": 1 });
        assert_eq!(Reference::read(&wrong), Some(Reference::new("p.jpg")));
        assert_eq!(Reference::read(&serde_json::json!({ "at": [1, 2, 3] })), None);
    }
}
