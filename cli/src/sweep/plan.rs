//! The plan of a sweep: one JSON object per line, `{"key", "graph", "set"}`. The key is a digest of the graph, the values
//! and the program's version, so it names one result for ever.

use super::vary;
use crate::args::SweepPlanArgs;
use crate::run::{literal, parse_set};
use crate::words::{Voice, Wrong, print};
use crate::{End, graph, output};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_engine::sweep::{Row, combinations, document_digest};
use tenon_engine::{Json, Options, Session, Severity};
use tenon_nodes::host::sweep::Planned;

/// The most rows that a plan may have.
const MOST: usize = 1_000_000;

/// Writes the plan of all combinations; every value has been accepted by its input before.
/// O(rows × inputs).
pub fn make(args: &SweepPlanArgs) -> Result<End, Wrong> {
    let (file, mut document) = graph::load(&args.graph)?;
    let host = graph::Files::new(&file, HashSet::new());
    document.read_links(&host);
    let registry = Arc::new(crate::plugins::registry_for(&document)?);
    let mut faults = document.validate(&registry);
    faults.retain(|d| d.severity == Severity::Error);
    if !faults.is_empty() {
        return Err(Wrong::new("no-graph", format!("{} has errors", file.display())).because(faults));
    }
    let digest = document_digest(&document, &registry);
    let mut session = Session::new(registry, document, Options { host: Arc::new(host), ..Options::default() });
    let mut axes: Vec<(String, Vec<Json>)> = Vec::new();
    for text in &args.set {
        let (name, text) = parse_set(text)?;
        axes.push((name.to_owned(), vec![literal(session.document(), session.registry(), name, text)]));
    }
    for text in &args.vary {
        let Some((name, text)) = text.split_once('=').filter(|(name, _)| !name.is_empty()) else {
            return Err(Wrong::new("vary", format!("--vary {text} gives no values")).hint("write --vary NAME=VALUES"));
        };
        axes.push((name.to_owned(), vary::values(text, |t| literal(session.document(), session.registry(), name, t))?));
    }
    let mut names = HashSet::new();
    let mut count = 1_usize;
    for (name, values) in &axes {
        if !names.insert(name) {
            return Err(Wrong::new("vary", format!("{name} is given twice")).hint("name all its values at once"));
        }
        for value in values {
            let refused = |d| Wrong::new("vary", format!("{name} = {value} cannot be done")).because(vec![d]);
            session.set(name, value.clone()).map_err(refused)?;
        }
        count = count.saturating_mul(values.len());
    }
    if count > MOST {
        return Err(Wrong::new("vary", format!("these are {count} rows; a plan holds at most {MOST}")));
    }
    let graph = path_in_plan(&file, &args.out)?;
    let (mut text, mut seen) = (String::new(), HashSet::new());
    for set in combinations(&axes) {
        let row = Row::new(graph.as_str(), digest, set);
        if seen.insert(row.key.clone()) {
            text.push_str(&row.to_line());
            text.push('\n');
        }
    }
    output::write_whole(&args.out, text.as_bytes())?;
    if seen.len() < count {
        Voice::new().say(&format!("{} rows were the same as others and stand once", count - seen.len()));
    }
    print(&format!("wrote {} ({} rows)\n", args.out.display(), seen.len()))?;
    Ok(End::Done)
}

fn folder_of(plan: &Path) -> PathBuf {
    plan.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new(".")).to_owned()
}

/// The graph's path as the plan says it: relative to the plan's folder if it is below, so that both can be moved
/// together; else absolute.
fn path_in_plan(graph: &Path, plan: &Path) -> Result<String, Wrong> {
    let whole = |path: &Path| {
        path.canonicalize().map_err(|e| Wrong::new("unreadable", format!("{} cannot be read: {e}", path.display())))
    };
    std::fs::create_dir_all(folder_of(plan))
        .map_err(|e| Wrong::new("unwritable", format!("{} cannot be written: {e}", plan.display())))?;
    let (graph, folder) = (whole(graph)?, whole(&folder_of(plan))?);
    let path = graph.strip_prefix(&folder).unwrap_or(&graph);
    path.to_str().map(str::to_owned).ok_or_else(|| {
        Wrong::new("unwritable", format!("the path {} is not Unicode and cannot stand in a plan", path.display()))
    })
}

/// Reads a plan; rows that stand twice count once.
///
/// # Errors
/// A file that cannot be read; a line that is no row, by its number.
pub fn read(plan: &Path) -> Result<Vec<Planned>, Wrong> {
    let text = std::fs::read_to_string(plan)
        .map_err(|e| Wrong::new("unreadable", format!("{} cannot be read: {e}", plan.display())))?;
    let folder = folder_of(plan);
    let (mut rows, mut seen) = (Vec::new(), HashSet::new());
    for (i, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let row = Row::from_line(line).ok_or_else(|| {
            let message = format!("{}, line {}: not a row of a sweep", plan.display(), i + 1);
            Wrong::new("no-plan", message).hint("`tenon sweep plan` writes plans")
        })?;
        if seen.insert(row.key.clone()) {
            rows.push(Planned::new(row, &folder));
        }
    }
    Ok(rows)
}
