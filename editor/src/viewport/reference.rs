//! What stands behind the model to go by: a mesh, or a picture that lies on the ground. It is of the window, not of the graph.

use super::Viewport;
use crate::scene::{self, Drawing, Kind, Part, Vertex};
use glam::DVec3;
use std::path::Path;
use std::sync::Arc;
use tenon_engine::{Diagnostic, Tree, digest_bytes};
use tenon_nodes::io::read_obj;
use tenon_nodes::value::V;

/// A picture is drawn with so many squares along its longer side.
const SQUARES: u32 = 220;
/// How wide a picture is at first, mm.
const WIDTH: f64 = 5000.0;
/// The largest file that is read, bytes.
const LARGEST: u64 = 512 << 20;

/// Something behind the model.
pub struct Reference {
    /// Its name.
    pub name: String,
    /// What is drawn.
    pub drawing: Arc<Drawing>,
    /// Colours of its parts; empty: one for all.
    pub colours: Arc<Vec<u32>>,
}

impl Viewport {
    /// Shows a mesh (OBJ, in millimetres) or a picture (PNG, on the ground) behind the model.
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
        let mesh = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("obj"));
        let (drawing, colours) = if mesh {
            let mesh = read_obj(&bytes, 1.0).map_err(|e| wrong(e.to_string()))?;
            let drawing = scene::draw(&Tree::item(V::new(mesh))).ok_or_else(|| wrong("nothing is in it".into()))?;
            (drawing, Vec::new())
        } else {
            let image = image::load_from_memory(&bytes).map_err(|e| wrong(e.to_string()))?;
            let image = image.thumbnail(SQUARES, SQUARES).to_rgb8();
            on_the_ground(&image, digest_bytes(&bytes)).ok_or_else(|| wrong("it has no pixels".into()))?
        };
        self.references.retain(|r| r.name != name);
        self.references.push(Reference { name, drawing: Arc::new(drawing), colours: Arc::new(colours) });
        Ok(())
    }
}

/// A picture as coloured squares on the ground, its lower left corner at the origin.
fn on_the_ground(image: &image::RgbImage, digest: u128) -> Option<(Drawing, Vec<u32>)> {
    let (w, h) = image.dimensions();
    if w == 0 || h == 0 {
        return None;
    }
    let step = WIDTH / f64::from(w);
    let corner = |x: u32, y: u32| [(f64::from(x) * step) as f32, (f64::from(h - y) * step) as f32, 0.0];
    let (mut triangles, mut colours) = (Vec::new(), Vec::new());
    for (x, y, pixel) in image.enumerate_pixels() {
        let part = colours.len() as u32;
        let vertex = |position| Vertex { position, normal: [0, 0, 127, 0], part };
        let [a, b, c, d] = [corner(x, y + 1), corner(x + 1, y + 1), corner(x + 1, y), corner(x, y)].map(vertex);
        triangles.extend([a, b, c, a, c, d]);
        colours.push(u32::from_le_bytes([pixel[0], pixel[1], pixel[2], 255]));
    }
    colours.push(0);
    let high = DVec3::new(WIDTH, f64::from(h) * step, 0.0);
    let (lines, points) = (Vec::new(), Vec::new());
    let parts = vec![Part::new("picture".into(), DVec3::ZERO)];
    let bounds = [DVec3::ZERO, high];
    Some((Drawing { kind: Kind::Mesh, triangles, lines, points, parts, bounds, digest }, colours))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_lies_on_the_ground_with_its_first_row_farthest() {
        let image = image::RgbImage::from_fn(2, 3, |x, y| image::Rgb([x as u8 * 100, y as u8 * 50, 7]));
        let (d, colours) = on_the_ground(&image, 1).unwrap();
        assert_eq!((d.triangles.len(), colours.len()), (36, 7));
        assert_eq!(d.bounds[1], DVec3::new(5000.0, 7500.0, 0.0));
        assert_eq!(d.triangles[0].position[1], 5000.0);
        assert!(on_the_ground(&image::RgbImage::new(0, 0), 1).is_none());
    }
}
