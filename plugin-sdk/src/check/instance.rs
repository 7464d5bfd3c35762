//! A second instance of a library.

use crate::load::Plugin;
use std::path::Path;

/// The library as another file, loaded: another instance with memory of its own, which loading it again is not.
pub(super) fn another_instance(plugin: &Plugin) -> Result<Plugin, String> {
    let extension = plugin.path.extension().unwrap_or_default();
    let name = format!("tenon-check-{}-{}", std::process::id(), plugin.id);
    // First where it does not lie about if we are killed, then beside the libraries that it may need.
    let folders = [Some(std::env::temp_dir()), plugin.path.parent().map(Path::to_owned)];
    let mut why = String::new();
    for folder in folders.into_iter().flatten() {
        let copy = folder.join(&name).with_extension(extension);
        let loaded = match std::fs::copy(&plugin.path, &copy) {
            Ok(_) => Plugin::load(&copy).map_err(|e| e.to_string()),
            Err(e) => Err(format!("{}: {e}", copy.display())),
        };
        let _ = std::fs::remove_file(&copy);
        match loaded {
            Ok(other) => return Ok(other),
            Err(e) => why = e,
        }
    }
    Err(why)
}
