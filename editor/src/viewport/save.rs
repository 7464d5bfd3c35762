//! Pictures of what is seen, of any size: drawn and written beside the window.

use super::gpu::{self, Frame};
use super::{Camera, Viewport};
use eframe::egui::Context;
use eframe::egui_wgpu::RenderState;
use glam::{DMat4, DVec3};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use tenon_engine::Diagnostic;

/// A picture that is being written, and where to.
pub(super) struct Saving {
    pub(super) path: PathBuf,
    done: Receiver<Result<(), String>>,
}

/// All that a picture needs of the window.
struct Shot {
    card: RenderState,
    frame: Frame,
    camera: Camera,
}

impl Shot {
    fn draw(&self, size: [u32; 2]) -> Result<image::RgbaImage, String> {
        let frame = Frame { matrix: matrix(&self.camera, self.frame.size, size), ..self.frame.clone() };
        // What is seen is as large as it fits in.
        let by = |k: usize| size[k] as f32 / frame.size[k].max(1.0);
        let scale = by(0).min(by(1)).max(0.1);
        let bytes = gpu::picture(&self.card, &frame, size, scale)?;
        image::RgbaImage::from_raw(size[0], size[1], bytes).ok_or_else(|| "the card gave too little".into())
    }

    fn write(&self, size: [u32; 2], path: &Path) -> Result<(), String> {
        let mut bytes = std::io::Cursor::new(Vec::new());
        self.draw(size)?.write_to(&mut bytes, image::ImageFormat::Png).map_err(|e| e.to_string())?;
        tenon_nodes::host::output::write_whole(path, bytes.get_ref()).map_err(|e| e.to_string())
    }
}

/// From the model to the clip space of a picture that holds all that is seen in a view of a size, points, whichever of them is
/// wider.
fn matrix(camera: &Camera, view: [f32; 2], picture: [u32; 2]) -> DMat4 {
    let aspect = f64::from(picture[0]) / f64::from(picture[1].max(1));
    let seen = f64::from(view[0].max(1.0)) / f64::from(view[1].max(1.0));
    let scale = (aspect / seen).min(1.0);
    DMat4::from_scale(DVec3::new(scale, scale, 1.0)) * camera.matrix(aspect)
}

impl Viewport {
    fn shot(&self) -> Result<Shot, String> {
        let card = self.card.clone().ok_or("there are no graphics")?;
        let frame = self.drawn.clone().ok_or("nothing has been drawn yet")?;
        Ok(Shot { card, frame, camera: self.camera })
    }

    /// A picture of what is seen, of any size.
    ///
    /// # Errors
    /// If there is no card, nothing was drawn yet, or the card cannot make it.
    pub fn picture(&self, size: [u32; 2]) -> Result<image::RgbaImage, String> {
        self.shot()?.draw(size)
    }

    /// Begins to save a picture of what is seen, [`Viewport::picture_size`] large; [`Viewport::saved`] tells what came of it.
    ///
    /// # Errors
    /// If there is nothing to draw it with, or another one is being written.
    pub fn save_picture(&mut self, ctx: &Context, path: &Path) -> Result<(), Diagnostic> {
        if let Some(Saving { path: other, .. }) = &self.saving {
            return Err(not_written(path, &format!("{} is still being written", other.display())));
        }
        let shot = self.shot().map_err(|why| not_written(path, &why))?;
        let (tell, done) = channel();
        let (ctx, size, to) = (ctx.clone(), self.picture_size, path.to_owned());
        let work = move || {
            // Nobody listens any more once the window is closed.
            let _ = tell.send(shot.write(size, &to));
            ctx.request_repaint();
        };
        let started = std::thread::Builder::new().name("picture".into()).spawn(work);
        started.map_err(|e| not_written(path, &e.to_string()))?;
        self.saving = Some(Saving { path: path.to_owned(), done });
        Ok(())
    }

    /// What came of the picture that was being saved, once: what was written, or why it was not.
    pub fn saved(&mut self) -> Option<Result<String, Diagnostic>> {
        let saving = self.saving.as_ref()?;
        let done = match saving.done.try_recv() {
            Ok(done) => done,
            Err(TryRecvError::Empty) => return None,
            Err(TryRecvError::Disconnected) => Err("it could not be drawn".to_owned()),
        };
        let path = self.saving.take()?.path;
        Some(done.map(|()| format!("{} was written", path.display())).map_err(|why| not_written(&path, &why)))
    }
}

fn not_written(path: &Path, why: &str) -> Diagnostic {
    Diagnostic::error("unwritable", format!("{} was not written: {why}", path.display()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Rect, pos2, vec2};

    #[test]
    fn a_picture_of_any_shape_holds_all_that_is_seen() {
        for orthographic in [false, true] {
            let camera = Camera { orthographic, ..Camera::default() };
            for (view, picture) in
                [([900.0, 300.0], [1000, 2000]), ([300.0, 900.0], [2000, 1000]), ([600.0; 2], [9, 9])]
            {
                let area = Rect::from_min_size(pos2(0.0, 0.0), vec2(view[0], view[1]));
                let matrix = matrix(&camera, view, picture);
                let corners = [area.min, area.right_top(), area.max, area.left_bottom()];
                let all = corners.map(|at| {
                    let (origin, direction) = camera.ray(area, at);
                    let along = (camera.target - origin).dot(camera.back()) / direction.dot(camera.back());
                    matrix.project_point3(origin + direction * along)
                });
                let most = |k: usize| all.iter().map(|p| p[k].abs()).fold(0.0, f64::max);
                assert!(most(0) < 1.0 + 1e-6 && most(1) < 1.0 + 1e-6, "{view:?} in {picture:?}: {all:?}");
                assert!(most(0).max(most(1)) > 1.0 - 1e-6, "and is as large as it can be");
            }
        }
    }
}
