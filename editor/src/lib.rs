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

use std::ffi::OsString;
use std::path::PathBuf;

/// What the window begins with.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Start {
    /// The graph that is opened.
    pub graph: Option<PathBuf>,
    /// Libraries of plugins that are loaded besides those in the folders.
    pub plugins: Vec<PathBuf>,
}

impl Start {
    /// What the arguments of the program say; none if they cannot be understood.
    pub fn read(arguments: impl IntoIterator<Item = OsString>) -> Option<Self> {
        let (mut start, mut arguments) = (Self::default(), arguments.into_iter());
        while let Some(argument) = arguments.next() {
            match argument.to_str() {
                Some("--plugin") => start.plugins.push(arguments.next()?.into()),
                Some(option) if option.starts_with('-') => return None,
                _ if start.graph.is_some() => return None,
                _ => start.graph = Some(argument.into()),
            }
        }
        Some(start)
    }
}

/// Opens the window and returns when it is closed.
///
/// # Errors
/// If the system gives no window, no graphics at all, or no thread.
pub fn run(start: Start) -> eframe::Result {
    let window = eframe::egui::ViewportBuilder::default()
        .with_inner_size([1440.0, 900.0])
        .with_min_inner_size([480.0, 360.0])
        .with_app_id("tenon-editor");
    let mut options = eframe::NativeOptions { viewport: window, ..Default::default() };
    viewport::write_directly(&mut options.wgpu_options.wgpu_setup);
    type Made = Result<Box<dyn eframe::App>, Box<dyn std::error::Error + Send + Sync>>;
    let app = move |cc: &eframe::CreationContext<'_>| -> Made {
        app::positions::Positions::tell_if_asked(&cc.egui_ctx);
        let mut app = app::App::new(cc, None)?;
        app.begin(&cc.egui_ctx, &start);
        Ok(Box::new(app))
    };
    eframe::run_native("Tenon", options, Box::new(app))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_name_a_graph_and_plugins() {
        let read = |all: &[&str]| Start::read(all.iter().map(|a| OsString::from(*a)));
        let both = Start { graph: Some("g".into()), plugins: vec!["a.so".into(), "b.so".into()] };
        assert_eq!(read(&["--plugin", "a.so", "g", "--plugin", "b.so"]), Some(both));
        assert_eq!(read(&[]), Some(Start::default()));
        assert_eq!(read(&["--plugin"]), None);
        assert_eq!(read(&["g", "h"]), None);
        assert_eq!(read(&["--help"]), None);
    }
}
