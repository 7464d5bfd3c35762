//! Plugins on the command line: which are loaded for every command, and `tenon plugin list|info`.

use crate::End;
use crate::args::{PluginCommand, PluginInfoArgs, PluginListArgs};
use crate::words::{Wrong, print, print_json};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};
use tenon_engine::{Document, Json, Registry};
use tenon_nodes::plugin::{Found, Plugin, PluginError, Sources, Wanted, apart, folders, load_all, user_folder};

/// The libraries given by `--plugin`, and the ids given by `--isolate`.
static NAMED: OnceLock<(Vec<PathBuf>, Vec<String>)> = OnceLock::new();

/// Keeps what `--plugin` and `--isolate` say for [`registry`].
pub fn name(libraries: Vec<PathBuf>, isolated: Vec<String>) {
    let _ = NAMED.set((libraries, isolated));
}

fn search(requires: &BTreeMap<String, Json>) -> Result<(Registry, Found), Wrong> {
    let mut registry = tenon_nodes::registry();
    let (named, isolated) = NAMED.get().map_or((&[][..], &[][..]), |(n, i)| (n.as_slice(), i.as_slice()));
    let found = load_all(&mut registry, named, &folders(), &Wanted::new(requires, isolated));
    let found = found.map_err(|e: PluginError| Wrong::new("bad-plugin", format!("--plugin {e}")))?;
    Ok((registry, found))
}

/// The built-in node types and those of the plugins. Libraries in folders that were refused are told on stderr.
pub fn registry() -> Result<Registry, Wrong> {
    registry_of(&BTreeMap::new())
}

/// The same for a graph: what it requires and is not there is told when it is evaluated.
pub fn registry_for(document: &Document) -> Result<Registry, Wrong> {
    registry_of(&document.requires)
}

/// The same for commands that work on many graphs. What is refused is told here, once.
pub fn sources() -> Result<Arc<Sources>, Wrong> {
    registry()?;
    let (named, isolated) = NAMED.get().cloned().unwrap_or_default();
    Ok(Arc::new(Sources::new(named, folders(), isolated)))
}

fn registry_of(requires: &BTreeMap<String, Json>) -> Result<Registry, Wrong> {
    let (registry, found) = search(requires)?;
    for refused in &found.refused {
        eprintln!("warning[bad-plugin]: {refused}");
    }
    Ok(registry)
}

/// `tenon plugin …`.
pub fn plugin(command: &PluginCommand) -> Result<End, Wrong> {
    match command {
        PluginCommand::List(args) => list(args),
        PluginCommand::Info(args) => info(args),
        PluginCommand::Check(args) => crate::plugin_check::check(args),
        PluginCommand::New(args) => crate::plugin_new::new(args),
        PluginCommand::Host(args) => {
            match apart::serve(&args.library, args.memory).map_err(|why| Wrong::new("not-a-host", why))? {}
        }
    }
}

fn summary(plugin: &Plugin) -> Json {
    serde_json::json!({
        "id": plugin.id,
        "version": plugin.version,
        "vendor": plugin.vendor,
        "doc": plugin.doc,
        "path": plugin.path.display().to_string(),
        "nodes": plugin.nodes.iter().map(|n| n.id.as_str()).collect::<Vec<_>>(),
    })
}

/// What is loaded, from where, and what was refused.
fn list(args: &PluginListArgs) -> Result<End, Wrong> {
    let (_, found) = search(&BTreeMap::new())?;
    if args.json {
        let refused: Vec<String> = found.refused.iter().map(ToString::to_string).collect();
        let plugins: Vec<Json> = found.plugins.iter().map(|p| summary(p)).collect();
        let places: Vec<String> = folders().iter().map(|f| f.display().to_string()).collect();
        print_json(&serde_json::json!({ "plugins": plugins, "refused": refused, "folders": places }))?;
    } else {
        let mut out = String::new();
        for p in &found.plugins {
            let nodes: Vec<&str> = p.nodes.iter().map(|n| n.id.as_str()).collect();
            let _ = writeln!(out, "{} {}  {}\n  {}", p.id, p.version, p.path.display(), nodes.join(", "));
        }
        for refused in &found.refused {
            let _ = writeln!(out, "refused: {refused}");
        }
        if found.plugins.is_empty() {
            let place = user_folder().map_or_else(|| "a folder".to_owned(), |f| f.display().to_string());
            let _ = writeln!(out, "no plugins; libraries are looked for in {place} and in TENON_PLUGIN_PATH");
        }
        print(&out)?;
    }
    Ok(if found.refused.is_empty() { End::Done } else { End::Errors })
}

/// Everything that one library says of itself.
fn info(args: &PluginInfoArgs) -> Result<End, Wrong> {
    let mut registry = tenon_nodes::registry();
    let plugin = tenon_nodes::plugin::load(&mut registry, &args.library);
    let plugin = plugin.map_err(|e| Wrong::new("bad-plugin", e.to_string()))?;
    let mut json = summary(&plugin);
    let nodes = plugin.nodes.iter().filter_map(|n| registry.get(&n.id));
    json["nodes"] = nodes.clone().map(|n| n.describe()).collect();
    if args.json {
        print_json(&json)?;
    } else {
        let mut out = format!("{} {} by {}\n{}\n", plugin.id, plugin.version, plugin.vendor, plugin.doc);
        for node in nodes {
            let _ = write!(out, "\n{}", crate::nodes::describe(&node.describe()));
        }
        print(&out)?;
    }
    Ok(End::Done)
}
