//! `tenon fmt`: graph files in canonical form.

use crate::args::FmtArgs;
use crate::words::{Voice, Wrong};
use crate::{End, graph, output};
use std::path::Path;
use tenon_engine::Document;

/// Formats, or with `--check` only compares, every file; a file that is wrong does not keep the others from being done.
pub fn fmt(args: &FmtArgs) -> Result<End, Wrong> {
    let voice = Voice::new();
    let mut end = End::Done;
    let mut wrong = Vec::new();
    for path in &args.files {
        match format_one(path, args.check) {
            Ok(None) => {}
            Ok(Some(changed)) if args.check => {
                voice.say(&format!("{changed} is not in canonical form"));
                end = End::Errors;
            }
            Ok(Some(changed)) => voice.say(&format!("formatted {changed}")),
            Err(fault) => wrong.push(fault),
        }
    }
    let last = wrong.pop();
    wrong.iter().for_each(|fault| voice.wrong(fault));
    last.map_or(Ok(end), Err)
}

/// The file's name if it was not in canonical form.
fn format_one(path: &Path, check: bool) -> Result<Option<String>, Wrong> {
    let file = graph::find(path)?;
    let before = graph::read(&file)?;
    let document = Document::from_slice(&before).map_err(|diagnostics| {
        Wrong::new("no-graph", format!("{} is not a readable graph", file.display())).because(diagnostics)
    })?;
    let after = document.to_string_canonical();
    if after.as_bytes() == before {
        return Ok(None);
    }
    if !check {
        // A link stays a link: what it points to is rewritten.
        let real = file.canonicalize().unwrap_or_else(|_| file.clone());
        output::write_whole(&real, after.as_bytes())?;
    }
    Ok(Some(file.display().to_string()))
}
