//! `tenon inspect`: the value of any port as a summary, a table or JSON.

use crate::args::InspectArgs;
use crate::progress::Bar;
use crate::run;
use crate::words::{Voice, Wrong, print, print_json};
use crate::{End, interrupt};
use std::fmt::Write;
use tenon_engine::{Column, Control, Diagnostic, Json, Progress, Session, Severity, Tree};

/// A summary shows no more items than this.
const SHOWN: usize = 8;

/// Evaluates what one port depends on and shows what stands there.
pub fn inspect(args: &InspectArgs) -> Result<End, Wrong> {
    let (_, mut session) = run::open(&args.graph, &args.set, args.threads, &args.cache)?;
    let name = args.port.as_str();
    let unknown = |d: Diagnostic| Wrong::new("inspect", format!("{name} cannot be shown")).because(vec![d]);
    // An output first: a node may call an output and an input the same.
    let output = session.knows(name);
    let targets = match &output {
        Ok(()) => vec![name.to_owned()],
        Err(no_output) => session.sources(name).map_err(|no_input| {
            // Of a name without a dot, or of a node that is not there, both say the same.
            let tell = if no_output.hint.is_some() || no_input.hint.is_none() { no_output } else { &no_input };
            unknown(tell.clone())
        })?,
    };
    let mut diagnostics = Vec::new();
    if !targets.is_empty() {
        let targets: Vec<&str> = targets.iter().map(String::as_str).collect();
        let bar = Bar::new(args.json);
        let show = |p: &Progress| bar.show(p.fraction, &p.node);
        let report = session.evaluate(&targets, &Control { cancel: interrupt::flag(), on_progress: Some(&show) });
        bar.clear();
        if report.cancelled {
            return Ok(End::Interrupted);
        }
        diagnostics = report.diagnostics;
        diagnostics.extend(report.cache);
    }
    let tree = match output {
        Ok(()) => session.value(name),
        Err(_) => session.input(name).map_err(unknown)?,
    };
    let voice = Voice::new();
    voice.diagnostics(&diagnostics);
    let Some(tree) = tree else {
        voice.say(&format!("{name} has no value"));
        return Ok(End::Errors);
    };
    if args.json {
        print_json(&tree.to_json())?;
    } else if args.table {
        print(&table(&tree))?;
    } else {
        print(&summary(&session, name, &tree))?;
    }
    let failed = diagnostics.iter().any(|d| d.severity == Severity::Error);
    Ok(if failed { End::Errors } else { End::Done })
}

/// Type, counts, size and digest; of numbers their range; the first items.
fn summary(session: &Session, name: &str, tree: &Tree) -> String {
    let mut out = String::new();
    let _ = writeln!(out, "{name}: {}", tree.type_name());
    let gaps: usize = tree.branches().iter().map(|(_, c)| (0..c.len()).filter(|i| !c.is_valid(*i)).count()).sum();
    let _ = writeln!(out, "  items     {}{}", tree.len(), if gaps > 0 { format!(", {gaps} gaps") } else { "".into() });
    let _ = writeln!(out, "  branches  {}", tree.branches().len());
    let _ = writeln!(out, "  size      {}", run::size(tree.bytes()));
    let _ = writeln!(out, "  digest    {:032x}", tree.digest());
    let numbers: Vec<f64> = tree.branches().iter().flat_map(|(_, c)| numbers(c)).collect();
    if numbers.len() > 1 {
        let (min, max) = numbers.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
        let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
        let unit = run::unit(session.document(), session.registry(), name).map(|u| format!(" {u}")).unwrap_or_default();
        let _ = writeln!(out, "  numbers   {min} to {max}{unit}, mean {mean}");
    }
    let items = tree.branches().iter().flat_map(|(path, c)| (0..c.len()).map(move |i| (path, i, c)));
    for (path, i, column) in items.take(SHOWN) {
        let text = if column.is_valid(i) { column.summary(i) } else { "gap".into() };
        let _ = writeln!(out, "  {path}[{i}]  {text}");
    }
    if tree.len() > SHOWN {
        let _ = writeln!(out, "  … and {} more; --table shows them all", tree.len() - SHOWN);
    }
    out
}

/// The numbers of a column of numbers, without gaps.
fn numbers(column: &Column) -> Vec<f64> {
    let number = |i| column.get::<f64>(i).copied().or_else(|| column.get::<i64>(i).map(|v| *v as f64));
    (0..column.len()).filter_map(number).collect()
}

/// One line per item: path, index, and the item's members where it is an object of plain members or a short list of
/// numbers, else its summary.
fn table(tree: &Tree) -> String {
    let mut head: Vec<String> = vec!["path".into(), "item".into()];
    let mut rows = Vec::with_capacity(tree.len());
    for (path, column) in tree.branches() {
        for (i, json) in column.to_json().as_array().into_iter().flatten().enumerate() {
            let mut row = vec![path.to_string(), i.to_string()];
            for (key, cell) in cells(json, || column.summary(i)) {
                let at = head.iter().skip(2).position(|h| *h == key).map_or_else(
                    || {
                        head.push(key.clone());
                        head.len() - 1
                    },
                    |at| at + 2,
                );
                row.resize(row.len().max(at + 1), String::new());
                row[at] = cell;
            }
            rows.push(row);
        }
    }
    let width = |c: usize| rows.iter().filter_map(|r| r.get(c)).chain([&head[c]]).map(|t| t.chars().count()).max();
    let widths: Vec<usize> = (0..head.len()).map(|c| width(c).unwrap_or(0)).collect();
    let mut out = String::new();
    for row in [&head].into_iter().chain(&rows) {
        let line: Vec<String> = row.iter().zip(&widths).map(|(text, w)| format!("{text:w$}")).collect();
        let _ = writeln!(out, "{}", line.join("  ").trim_end());
    }
    out
}

/// What an item's line holds: column and text.
fn cells(item: &Json, summary: impl Fn() -> String) -> Vec<(String, String)> {
    let text = |v: &Json| match v {
        Json::String(s) => s.chars().map(|c| if c.is_control() { ' ' } else { c }).collect(),
        Json::Array(list) => format!("{} items", list.len()),
        Json::Object(map) => format!("{} members", map.len()),
        other => other.to_string(),
    };
    match item {
        Json::Object(map) => map.iter().map(|(key, v)| (key.clone(), text(v))).collect(),
        Json::Array(list) if list.len() <= 4 && list.iter().all(Json::is_number) => {
            ["x", "y", "z", "w"].iter().zip(list).map(|(key, v)| ((*key).to_owned(), text(v))).collect()
        }
        Json::Array(_) => vec![("value".into(), summary())],
        Json::Null => vec![("value".into(), "gap".into())],
        plain => vec![("value".into(), text(plain))],
    }
}
