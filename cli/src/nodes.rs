//! `tenon nodes`: lists the node types, or describes one, or lists the implicit conversions.

use crate::End;
use crate::args::NodesArgs;
use crate::graph;
use crate::words::{Wrong, print, print_json};
use std::collections::{BTreeMap, HashSet};
use std::fmt::Write;
use std::path::Path;
use tenon_engine::{Diagnostic, Json, NodeType, Registry};

/// Prints all node types by category, or everything about one.
pub fn nodes(args: &NodesArgs) -> Result<End, Wrong> {
    let registry = crate::plugins::registry()?;
    if args.conversions {
        return conversions(&registry, args.json);
    }
    let clusters = args.graph.as_deref().map_or_else(|| Ok(Vec::new()), |graph| clusters(graph, &registry))?;
    let types = || registry.iter().map(|n| &**n).chain(&clusters);
    if let Some(name) = &args.node_type {
        let Some(node) = types().find(|n| n.type_name() == name) else {
            let known = types().map(|n| n.type_name());
            let wrong = Wrong::new("unknown-node-type", format!("there is no node type \"{name}\""));
            return Err(match tenon_engine::nearest(name, known) {
                Some(near) => wrong.hint(format!("did you mean \"{near}\"?")),
                None => wrong.hint("`tenon nodes` lists them all"),
            });
        };
        let description = node.describe();
        if args.json {
            print_json(&description)?
        } else {
            print(&describe(&description))?
        }
        return Ok(End::Done);
    }
    let all: Vec<Json> = types().map(|n| n.describe()).collect();
    if args.json {
        print_json(&Json::Array(all))?;
    } else {
        print(&list(&all))?;
    }
    Ok(End::Done)
}

/// The clusters of a graph as node types.
fn clusters(path: &Path, registry: &Registry) -> Result<Vec<NodeType>, Wrong> {
    let (file, mut document) = graph::load(path)?;
    document.read_links(&graph::Files::new(&file, HashSet::new()));
    let wrong = |d: Diagnostic| {
        Wrong::new("no-graph", format!("{}: a cluster cannot be used", file.display())).because(vec![d])
    };
    let names = document.clusters.keys();
    names.map(|name| document.cluster_type(name, registry).map_err(wrong)).collect()
}

/// One line per implicit conversion.
fn conversions(registry: &Registry, json: bool) -> Result<End, Wrong> {
    let all = registry.conversions();
    if json {
        print_json(&all.iter().map(|c| serde_json::json!({ "from": c.from, "to": c.to })).collect())?;
    } else {
        print(&all.iter().map(|c| format!("{} -> {}\n", c.from, c.to)).collect::<String>())?;
    }
    Ok(End::Done)
}

fn text<'a>(value: &'a Json, key: &str) -> &'a str {
    value[key].as_str().unwrap_or_default()
}

/// One line per node type, grouped by category.
fn list(all: &[Json]) -> String {
    let mut categories: BTreeMap<&str, Vec<&Json>> = BTreeMap::new();
    for node in all {
        categories.entry(text(node, "category")).or_default().push(node);
    }
    let width = all.iter().map(|n| text(n, "type").len()).max().unwrap_or(0);
    let mut out = String::new();
    for (category, nodes) in categories {
        let _ = writeln!(out, "{category}");
        for node in nodes {
            let doc = text(node, "doc").split_inclusive(". ").next().unwrap_or_default().trim_end();
            let _ = writeln!(out, "  {:width$}  {doc}", text(node, "type"));
        }
    }
    out
}

/// A node type in full: doc, inputs with unit, range and default, outputs.
pub fn describe(node: &Json) -> String {
    let mut out = format!(
        "{} ({}) - {}\n\n{}\n",
        text(node, "type"),
        text(node, "name"),
        text(node, "category"),
        text(node, "doc")
    );
    for (key, title) in [("inputs", "Inputs"), ("outputs", "Outputs")] {
        let ports = node[key].as_array().map_or(&[][..], Vec::as_slice);
        if ports.is_empty() {
            continue;
        }
        let _ = writeln!(out, "\n{title}");
        for port in ports {
            let _ = writeln!(out, "  {}: {}", text(port, "name"), facts(port).join(", "));
            for line in text(port, "doc").lines() {
                let _ = writeln!(out, "      {line}");
            }
        }
    }
    out
}

/// What is to be known of a port besides its doc.
fn facts(port: &Json) -> Vec<String> {
    let mut facts = vec![format!("{} {}", text(port, "access"), text(port, "type"))];
    if let Some(unit) = port["unit"].as_str() {
        facts.push(unit.to_owned());
    }
    match (port["min"].as_f64(), port["max"].as_f64()) {
        (Some(min), Some(max)) => facts.push(format!("{min} to {max}")),
        (Some(min), None) => facts.push(format!("at least {min}")),
        (None, Some(max)) => facts.push(format!("at most {max}")),
        (None, None) => {}
    }
    if let Some(choices) = port["choices"].as_array() {
        let names: Vec<&str> = choices.iter().filter_map(Json::as_str).collect();
        facts.push(format!("one of {}", names.join(" ")));
    }
    match &port["default"] {
        Json::Null => {}
        default => facts.push(format!("default {default}")),
    }
    if port["optional"] == Json::Bool(true) {
        facts.push("may be left out".to_owned());
    }
    facts
}
