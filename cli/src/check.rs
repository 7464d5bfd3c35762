//! `tenon check`: reads a graph and says what is wrong with it, without evaluating it.

use crate::args::CheckArgs;
use crate::words::{Voice, Wrong, print, print_json, to_json};
use crate::{End, graph};
use std::collections::HashSet;
use tenon_engine::Severity;

/// Validates a graph against the built-in nodes and those of plugins.
pub fn check(args: &CheckArgs) -> Result<End, Wrong> {
    let (file, mut document) = graph::load(&args.graph)?;
    document.read_links(&graph::Files::new(&file, HashSet::new()));
    let diagnostics = document.validate(&crate::plugins::registry_for(&document)?);
    let errors = diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
    Voice::new().diagnostics(&diagnostics);
    if args.json {
        print_json(&serde_json::json!({
            "ok": errors == 0,
            "graph": file.display().to_string(),
            "diagnostics": to_json(&diagnostics),
        }))?;
    } else {
        let found = match errors {
            0 => "no errors".to_owned(),
            1 => "1 error".to_owned(),
            n => format!("{n} errors"),
        };
        print(&format!("{}: {found}\n", file.display()))?;
    }
    Ok(if errors == 0 { End::Done } else { End::Errors })
}
