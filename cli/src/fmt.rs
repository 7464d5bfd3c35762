//! `tenon fmt`: graph files in canonical form, nodes of older versions brought to today's.

use crate::args::FmtArgs;
use crate::words::{Voice, Wrong};
use crate::{End, graph, output};
use std::collections::HashSet;
use std::path::Path;
use tenon_engine::{Cluster, Document, Registry};

/// Formats, or with `--check` only compares, every file; a file that is wrong does not keep the others from being done.
pub fn fmt(args: &FmtArgs) -> Result<End, Wrong> {
    let voice = Voice::new();
    let mut end = End::Done;
    let mut wrong = Vec::new();
    for path in &args.files {
        match format_one(path, args, crate::plugins::registry_for, &voice) {
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
fn format_one(
    path: &Path,
    args: &FmtArgs,
    registry: impl Fn(&Document) -> Result<Registry, Wrong>,
    voice: &Voice,
) -> Result<Option<String>, Wrong> {
    let file = graph::find(path)?;
    let before = graph::read(&file)?;
    let mut document = Document::from_slice(&before).map_err(|diagnostics| {
        Wrong::new("no-graph", format!("{} is not a readable graph", file.display())).because(diagnostics)
    })?;
    let registry = registry(&document)?;
    let told = document.migrate(&registry);
    if args.update_links {
        update_links(&file, &mut document, voice)?;
    }
    let after = document.to_string_canonical();
    if after.as_bytes() == before {
        // What could not be brought forward stands in the file as it was.
        voice.diagnostics(&told);
        return Ok(None);
    }
    voice.diagnostics(&told);
    if !args.check {
        // A link stays a link: what it points to is rewritten.
        let real = file.canonicalize().unwrap_or_else(|_| file.clone());
        output::write_whole(&real, after.as_bytes())?;
    }
    Ok(Some(file.display().to_string()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tenon_engine::{Json, NodeType, Port};

    fn args(check: bool) -> FmtArgs {
        FmtArgs { files: Vec::new(), check, update_links: false }
    }

    /// Version 1 of a beam had its length in centimetres.
    fn registry() -> Registry {
        let mut registry = Registry::new();
        let beam = NodeType::new("beam", 2).input(Port::item::<f64>("length")).output(Port::item::<f64>("length"));
        registry.register(beam.run(|_| Ok(()))).unwrap();
        registry
            .register_migration("beam", 1, |mut node| {
                let params = node["params"].as_object_mut().ok_or("no parameters")?;
                let cm = params.remove("length_cm").as_ref().and_then(Json::as_f64).ok_or("no length_cm")?;
                params.insert("length".into(), (cm * 10.0).into());
                Ok(node)
            })
            .unwrap();
        registry
    }

    #[test]
    fn the_form_of_today_is_what_is_saved() {
        let folder = std::env::temp_dir().join(format!("tenon-fmt-{}", std::process::id()));
        let _ = std::fs::remove_dir_all(&folder);
        std::fs::create_dir_all(&folder).unwrap();
        let file = folder.join("beam.tenon.json");
        let fixture = |name: &str| {
            std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/migrations").join(name)).unwrap()
        };
        std::fs::write(&file, fixture("beam.before.tenon.json")).unwrap();
        let (registry, voice) = (|_: &Document| Ok(registry()), Voice::new());
        assert!(format_one(&file, &args(true), registry, &voice).unwrap().is_some(), "--check sees the older version");
        assert_eq!(std::fs::read_to_string(&file).unwrap(), fixture("beam.before.tenon.json"));
        assert!(format_one(&file, &args(false), registry, &voice).unwrap().is_some());
        assert_eq!(std::fs::read_to_string(&file).unwrap(), fixture("beam.after.tenon.json"));
        assert_eq!(format_one(&file, &args(false), registry, &voice).unwrap(), None, "once is enough");
        std::fs::remove_dir_all(&folder).unwrap();
    }
}
