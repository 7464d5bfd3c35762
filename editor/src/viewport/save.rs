//! Pictures of what is seen, of any size: drawn and written beside the window.

use super::gpu::{self, Frame};
use super::{Camera, Viewport};
use eframe::egui::Context;
use eframe::egui_wgpu::RenderState;
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
        let aspect = f64::from(size[0]) / f64::from(size[1].max(1));
        let frame = Frame { matrix: self.camera.matrix(aspect), ..self.frame.clone() };
        let scale = (size[1] as f32 / frame.size[1].max(1.0)).max(0.1);
        let bytes = gpu::picture(&self.card, &frame, size, scale)?;
        image::RgbaImage::from_raw(size[0], size[1], bytes).ok_or_else(|| "the card gave too little".into())
    }

    fn write(&self, size: [u32; 2], path: &Path) -> Result<(), String> {
        let mut bytes = std::io::Cursor::new(Vec::new());
        self.draw(size)?.write_to(&mut bytes, image::ImageFormat::Png).map_err(|e| e.to_string())?;
        tenon_nodes::host::output::write_whole(path, bytes.get_ref()).map_err(|e| e.to_string())
    }
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
