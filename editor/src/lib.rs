//! The desktop editor: an egui canvas and a wgpu viewport over the engine. The document and all that changes it are the
//! engine's; evaluation runs beside the window, which never waits for it.

pub mod app;
pub mod boards;
pub mod canvas;
pub mod model;
pub mod panels;
pub mod scene;
pub mod theme;
pub mod viewport;

use std::path::PathBuf;

/// Opens the window and returns when it is closed.
///
/// # Errors
/// If the system gives no window, no graphics at all, or no thread.
pub fn run(graph: Option<PathBuf>) -> eframe::Result {
    let window = eframe::egui::ViewportBuilder::default()
        .with_inner_size([1440.0, 900.0])
        .with_min_inner_size([480.0, 360.0])
        .with_app_id("tenon-editor");
    let options = eframe::NativeOptions { viewport: window, ..Default::default() };
    let app = move |cc: &eframe::CreationContext<'_>| -> Result<Box<dyn eframe::App>, Box<dyn std::error::Error + Send + Sync>> {
        let mut app = app::App::new(cc, graph.as_deref())?;
        app.remember_in(model::keep::state_folder());
        Ok(Box::new(app))
    };
    eframe::run_native("Tenon", options, Box::new(app))
}
