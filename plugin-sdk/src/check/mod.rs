//! Tests of a plugin's conduct, in the manner of clap-validator: each check has a name and a sentence of prose, and is to
//! be run in a process of its own, since a plugin that is wrong may take its process along.

mod descriptors;
mod hosts;
mod instance;
mod old_nodes;
mod pages;
mod runs;
mod samples;

use crate::load::{LoadError, Plugin};
use std::path::Path;

/// One check.
pub struct Check {
    /// Its name, kebab-case.
    pub name: &'static str,
    /// What it looks at and why.
    pub about: &'static str,
    run: fn(&Plugin) -> Vec<String>,
}

/// Every check, in the order in which they are told.
#[must_use]
pub fn all() -> Vec<Check> {
    let loads = Check {
        name: "loads",
        about: "The library loads, exports tenon_plugin_v1, and its descriptors are whole: ids, sizes, ports, texts.",
        run: |_| Vec::new(),
    };
    std::iter::once(loads).chain(descriptors::checks()).chain(runs::checks()).collect()
}

impl Check {
    /// What is wrong, one sentence each; nothing if all is well.
    ///
    /// # Errors
    /// If the library does not load.
    pub fn run(&self, library: &Path) -> Result<Vec<String>, LoadError> {
        Ok((self.run)(&Plugin::load(library)?))
    }
}
