//! The plan of a sweep: one JSON object per line, `{"key", "graph", "set"}`. The key is a digest of the graph, the values
//! and the program's version, so it names one result for ever.

use super::vary;
use crate::args::SweepPlanArgs;
use crate::run::{literal, parse_set};
use crate::words::{Voice, Wrong, print};
use crate::{End, graph, output};
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_engine::{Digester, Document, Json, Options, Session, Severity, digest_bytes};

/// The most rows that a plan may have.
const MOST: usize = 1_000_000;

/// One variant of a graph.
#[derive(Clone, Debug)]
pub struct Row {
    /// Digest of everything that makes it another than other rows, 32 hexadecimal digits.
    pub key: String,
    /// The graph's file.
    pub graph: PathBuf,
    /// Values of inputs by name; set in order of names.
    pub set: BTreeMap<String, Json>,
}

/// The key of a row.
pub fn key(document: u128, set: &BTreeMap<String, Json>) -> String {
    let mut d = Digester::new();
    d.str("tenon sweep row");
    d.str(env!("CARGO_PKG_VERSION"));
    d.u128(document);
    for (name, value) in set {
        d.str(name);
        d.str(&value.to_string());
    }
    format!("{:032x}", d.finish())
}

/// What of a graph goes into the keys.
pub fn digest(document: &Document) -> u128 {
    digest_bytes(document.to_string_canonical().as_bytes())
}

/// Writes the plan of all combinations; every value has been accepted by its input before.
/// O(rows × inputs).
pub fn make(args: &SweepPlanArgs) -> Result<End, Wrong> {
    let (file, mut document) = graph::load(&args.graph)?;
    let host = graph::Files::new(&file, HashSet::new());
    document.read_links(&host);
    let registry = Arc::new(tenon_nodes::registry());
    let mut faults = document.validate(&registry);
    faults.retain(|d| d.severity == Severity::Error);
    if !faults.is_empty() {
        return Err(Wrong::new("no-graph", format!("{} has errors", file.display())).because(faults));
    }
    let digest = digest(&document);
    let mut session = Session::new(registry, document, Options { host: Arc::new(host), ..Options::default() });
    let mut axes: Vec<(&str, Vec<Json>)> = Vec::new();
    for text in &args.set {
        let (name, text) = parse_set(text)?;
        axes.push((name, vec![literal(session.document(), session.registry(), name, text)]));
    }
    for text in &args.vary {
        let Some((name, text)) = text.split_once('=').filter(|(name, _)| !name.is_empty()) else {
            return Err(Wrong::new("vary", format!("--vary {text} gives no values")).hint("write --vary NAME=VALUES"));
        };
        axes.push((name, vary::values(text, |t| literal(session.document(), session.registry(), name, t))?));
    }
    let mut names = HashSet::new();
    let mut count = 1_usize;
    for (name, values) in &axes {
        if !names.insert(*name) {
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
    for i in 0..count {
        let mut set = BTreeMap::new();
        let mut rest = i;
        // The last input varies fastest.
        for (name, values) in axes.iter().rev() {
            set.insert((*name).to_owned(), values[rest % values.len()].clone());
            rest /= values.len();
        }
        let key = key(digest, &set);
        if seen.insert(key.clone()) {
            text.push_str(&serde_json::json!({ "key": key, "graph": graph, "set": set }).to_string());
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
pub fn read(plan: &Path) -> Result<Vec<Row>, Wrong> {
    let text = std::fs::read_to_string(plan)
        .map_err(|e| Wrong::new("unreadable", format!("{} cannot be read: {e}", plan.display())))?;
    let folder = folder_of(plan);
    let (mut rows, mut seen) = (Vec::new(), HashSet::new());
    for (i, line) in text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()) {
        let row = parse(line, &folder).ok_or_else(|| {
            let message = format!("{}, line {}: not a row of a sweep", plan.display(), i + 1);
            Wrong::new("no-plan", message).hint("`tenon sweep plan` writes plans")
        })?;
        if seen.insert(row.key.clone()) {
            rows.push(row);
        }
    }
    Ok(rows)
}

fn parse(line: &str, folder: &Path) -> Option<Row> {
    let row: Json = serde_json::from_str(line).ok()?;
    let key = row["key"].as_str()?.to_owned();
    // It becomes a folder's name.
    if key.len() != 32 || !key.bytes().all(|b| b.is_ascii_hexdigit() && !b.is_ascii_uppercase()) {
        return None;
    }
    let set = row["set"].as_object()?.iter().map(|(name, value)| (name.clone(), value.clone())).collect();
    Some(Row { key, graph: folder.join(row["graph"].as_str()?), set })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_row_is_refused() {
        let here = Path::new("/p");
        let good = r#"{"key":"00112233445566778899aabbccddeeff","graph":"g.tenon.json","set":{"a":1}}"#;
        assert_eq!(parse(good, here).unwrap().graph, Path::new("/p/g.tenon.json"));
        for bad in [
            "7",
            "{}",
            &good.replace("0011", "../1"),
            &good.replace("aabb", "AABB"),
            &good.replace(r#"{"a":1}"#, "[1]"),
            &good.replace("00112233", ""),
        ] {
            assert!(parse(bad, here).is_none(), "{bad}");
        }
    }

    #[test]
    fn the_key_knows_graph_and_values() {
        let set = |v: f64| BTreeMap::from([("a".to_owned(), Json::from(v))]);
        assert_eq!(key(1, &set(2.5)), key(1, &set(2.5)));
        assert_ne!(key(1, &set(2.5)), key(2, &set(2.5)));
        assert_ne!(key(1, &set(2.5)), key(1, &set(2.0)));
        assert_ne!(key(1, &set(2.5)), key(1, &BTreeMap::new()));
    }
}
