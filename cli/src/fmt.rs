//! `tenon fmt`: graph files in canonical form.

use crate::args::FmtArgs;
use crate::words::{Voice, Wrong};
use crate::{End, graph, output};
use std::collections::HashSet;
use std::path::Path;
use tenon_engine::{Cluster, Document};

/// Formats, or with `--check` only compares, every file; a file that is wrong does not keep the others from being done.
pub fn fmt(args: &FmtArgs) -> Result<End, Wrong> {
    let voice = Voice::new();
    let mut end = End::Done;
    let mut wrong = Vec::new();
    for path in &args.files {
        match format_one(path, args, &voice) {
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

/// Pins the clusters that are linked from files; nothing changes if one of the files cannot be read.
fn update_links(file: &Path, document: &mut Document, voice: &Voice) -> Result<(), Wrong> {
    document.read_links(&graph::Files::new(file, HashSet::new()));
    if let Some((path, why)) = document.unread_links().next() {
        let message = format!("{}: the linked file {path} cannot be used: {why}", file.display());
        return Err(Wrong::new("linked-file", message).hint("put the file there, or correct the cluster's \"file\""));
    }
    for name in document.update_links() {
        if let Some(Cluster::File(link)) = document.clusters.get(&name) {
            let version = link.version.unwrap_or(1);
            let digest = link.digest.as_deref().unwrap_or_default();
            voice.say(&format!("{}: cluster \"{name}\" is now version {version}, {digest}", file.display()));
        }
    }
    Ok(())
}

/// The file's name if it was not in canonical form.
fn format_one(path: &Path, args: &FmtArgs, voice: &Voice) -> Result<Option<String>, Wrong> {
    let file = graph::find(path)?;
    let before = graph::read(&file)?;
    let mut document = Document::from_slice(&before).map_err(|diagnostics| {
        Wrong::new("no-graph", format!("{} is not a readable graph", file.display())).because(diagnostics)
    })?;
    if args.update_links {
        update_links(&file, &mut document, voice)?;
    }
    let after = document.to_string_canonical();
    if after.as_bytes() == before {
        return Ok(None);
    }
    if !args.check {
        // A link stays a link: what it points to is rewritten.
        let real = file.canonicalize().unwrap_or_else(|_| file.clone());
        output::write_whole(&real, after.as_bytes())?;
    }
    Ok(Some(file.display().to_string()))
}
