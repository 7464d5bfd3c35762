//! What stands behind the model to go by: a mesh, or a picture, placed by numbers. It is of the window, not of the graph.

use super::Viewport;
use super::gpu::Picture;
use crate::scene::{self, Drawing, Kind, Part, Vertex};
use eframe::egui::{DragValue, Ui};
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;
use tenon_engine::{Diagnostic, Tree, digest_bytes};
use tenon_nodes::io::read_obj;
use tenon_nodes::value::V;

/// How wide a picture is at first, mm.
const WIDTH: f64 = 5000.0;
/// Longest side of a picture on the card, pixels.
const SIDE: u32 = 4096;
/// The largest file that is read, bytes.
const LARGEST: u64 = 512 << 20;

/// Something behind the model.
pub struct Reference {
    /// Its name.
    pub name: String,
    /// What is drawn.
    pub drawing: Arc<Drawing>,
    /// The picture that it is; none for a mesh.
    pub picture: Option<Arc<Picture>>,
    /// Where its lower left corner, or the mesh's origin, lies, mm.
    pub at: DVec3,
    /// Width of a picture, mm; of a mesh how many times larger it is than in its file.
    pub scale: f64,
    /// Turn about Z, degrees.
    pub turn: f64,
    /// A picture stands upright instead of lying.
    pub upright: bool,
    /// The mesh as the file has it.
    mesh: Option<Arc<Drawing>>,
    digest: u128,
}

/// Files that are shown as pictures, by their endings.
pub const PICTURES: [&str; 1] = ["png"];

impl Viewport {
    /// Shows a mesh (OBJ, in millimetres) or a picture (PNG, at first on the ground) behind the model.
    ///
    /// # Errors
    /// If the file cannot be read as either.
    pub fn refer_to(&mut self, path: &Path) -> Result<(), Diagnostic> {
        let wrong =
            |why: String| Diagnostic::error("bad-reference", format!("{} cannot be shown: {why}", path.display()));
        let size = std::fs::metadata(path).map_err(|e| wrong(e.to_string()))?.len();
        if size > LARGEST {
            return Err(wrong(format!("it is larger than {} MiB", LARGEST >> 20)));
        }
        let bytes = std::fs::read(path).map_err(|e| wrong(e.to_string()))?;
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let digest = digest_bytes(&bytes);
        let (mesh, picture) = if path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj")) {
            let mesh = read_obj(&bytes, 1.0).map_err(|e| wrong(e.to_string()))?;
            let drawing = scene::draw(&Tree::item(V::new(mesh))).ok_or_else(|| wrong("nothing is in it".into()))?;
            (Some(Arc::new(drawing)), None)
        } else {
            let image = image::load_from_memory(&bytes).map_err(|e| wrong(e.to_string()))?;
            let large = image.width().max(image.height()) > SIDE;
            let image = if large { image.thumbnail(SIDE, SIDE) } else { image }.to_rgba8();
            let size = [image.width(), image.height()];
            if size.contains(&0) {
                return Err(wrong("it has no pixels".into()));
            }
            (None, Some(Arc::new(Picture { size, bytes: image.into_raw() })))
        };
        let scale = if picture.is_some() { WIDTH } else { 1.0 };
        let drawing = Arc::new(Drawing::empty(Kind::Mesh));
        let (at, turn, upright) = (DVec3::ZERO, 0.0, false);
        let mut new = Reference { name, drawing, picture, at, scale, turn, upright, mesh, digest };
        new.place();
        self.references.retain(|r| r.name != new.name);
        self.references.push(new);
        Ok(())
    }
}

impl Reference {
    /// Puts it where its numbers say. O(corners).
    pub fn place(&mut self) {
        let (s, c) = self.turn.to_radians().sin_cos();
        let turned = |p: DVec3| DVec3::new(c * p.x - s * p.y, s * p.x + c * p.y, p.z);
        let mut d = match (&self.mesh, &self.picture) {
            (Some(mesh), _) => {
                let to =
                    |p: [f32; 3]| (turned(DVec3::from(p.map(f64::from)) * self.scale) + self.at).as_vec3().to_array();
                let mut d = (**mesh).clone();
                d.triangles.iter_mut().for_each(|v| v.position = to(v.position));
                d.lines.iter_mut().for_each(|l| (l.from, l.to) = (to(l.from), to(l.to)));
                d
            }
            (None, picture) => {
                let [w, h] = picture.as_ref().map_or([1, 1], |p| p.size).map(f64::from);
                let (along, up) = (DVec3::X, if self.upright { DVec3::Z } else { DVec3::Y });
                let mut d = Drawing::empty(Kind::Mesh);
                let corner = |part: u32| {
                    let (right, below) = (f64::from(part & 1), f64::from(part >> 1));
                    let p = (along * right + up * (1.0 - below) * h / w) * self.scale;
                    Vertex { position: (turned(p) + self.at).as_vec3().to_array(), normal: [0, 0, 127, 0], part }
                };
                d.triangles = [2, 3, 1, 2, 1, 0].map(corner).to_vec();
                d.parts = vec![Part::new("picture".into(), self.at)];
                d
            }
        };
        let places = d.triangles.iter().map(|v| DVec3::from(v.position.map(f64::from)));
        d.bounds = places.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |[a, b], p| [a.min(p), b.max(p)]);
        let numbers = [self.at.x, self.at.y, self.at.z, self.scale, self.turn, f64::from(self.upright)];
        d.digest = numbers.iter().fold(self.digest, |sum, v| sum.rotate_left(23) ^ u128::from(v.to_bits()));
        self.drawing = Arc::new(d);
    }

    /// Its numbers, to be changed; true if it is not to be shown any more.
    pub(super) fn edit(&mut self, ui: &mut Ui) -> bool {
        let before = (self.at, self.scale, self.turn, self.upright);
        let gone = ui.horizontal(|ui| {
            ui.weak(&self.name);
            ui.small_button("×").on_hover_text("do not show it any more").clicked()
        });
        ui.horizontal(|ui| {
            for (axis, value) in ["x ", "y ", "z "].into_iter().zip([&mut self.at.x, &mut self.at.y, &mut self.at.z]) {
                ui.add(DragValue::new(value).speed(10.0).max_decimals(1).prefix(axis));
            }
        });
        ui.horizontal(|ui| {
            let scale = DragValue::new(&mut self.scale).range(1e-6..=1e7).max_decimals(3);
            match self.picture {
                Some(_) => ui.add(scale.speed(10.0).prefix("width ").suffix(" mm")),
                None => ui.add(scale.speed(0.01).suffix(" times")),
            };
            ui.add(DragValue::new(&mut self.turn).speed(1.0).max_decimals(1).suffix("°"))
                .on_hover_text("turned about Z");
            if self.picture.is_some() {
                ui.checkbox(&mut self.upright, "upright");
            }
        });
        if before != (self.at, self.scale, self.turn, self.upright) {
            self.place();
        }
        gone.inner
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_is_placed_scaled_and_turned_by_its_numbers() {
        let picture = Some(Arc::new(Picture { size: [2, 3], bytes: vec![0; 24] }));
        let drawing = Arc::new(Drawing::empty(Kind::Mesh));
        let (name, at, mesh) = ("p".to_owned(), DVec3::new(100.0, 0.0, 5.0), None);
        let mut r = Reference { name, drawing, picture, at, scale: 200.0, turn: 0.0, upright: false, mesh, digest: 1 };
        r.place();
        assert_eq!(r.drawing.bounds, [DVec3::new(100.0, 0.0, 5.0), DVec3::new(300.0, 300.0, 5.0)]);
        // The first row is the farthest.
        let first = r.drawing.triangles.iter().find(|v| v.part == 0).unwrap();
        assert_eq!(first.position, [100.0, 300.0, 5.0]);
        let before = r.drawing.digest;
        (r.turn, r.upright) = (90.0, true);
        r.place();
        assert!((r.drawing.bounds[1] - DVec3::new(100.0, 200.0, 305.0)).length() < 1e-3, "{:?}", r.drawing.bounds);
        assert_ne!(r.drawing.digest, before);
    }
}
