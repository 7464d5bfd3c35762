//! `tenon run`: evaluates a graph, writes its files, prints values, says how it went.

use crate::args::{CacheArgs, RunArgs};
use crate::files::{self, Made};
use crate::output::{self, Staged};
use crate::progress::Bar;
use crate::words::{Voice, Wrong, print, print_json, to_json};
use crate::{End, cache, graph, interrupt};
use std::collections::{BTreeMap, HashSet};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;
use tenon_engine::{
    Access, Control, Diagnostic, Document, Item, Json, Options, Progress, Registry, Report, Session, Severity, Text,
    Tree,
};

/// Memory that results may take before old ones are dropped, bytes.
pub const CACHE: usize = 2 << 30;

/// What `--get NAME[=FILE]` asks for.
struct Get<'a> {
    name: &'a str,
    file: Option<&'a Path>,
}

/// Runs a graph as the command line says.
pub fn run(args: &RunArgs) -> Result<End, Wrong> {
    let voice = Voice::new();
    let gets: Vec<Get> = args.get.iter().map(|g| parse_get(g)).collect();
    let (file, mut session) = open(&args.graph, &args.set, args.threads, &args.cache)?;
    // What can be known to fail is tried before the work begins.
    if let Some(dir) = &args.out {
        output::prepare_folder(dir)?;
    }
    for get in &gets {
        session
            .knows(get.name)
            .map_err(|d| Wrong::new("get", format!("--get {} cannot be done", get.name)).because(vec![d]))?;
    }
    let targets = targets(&session, &gets, args);
    let report = evaluate(&mut session, &targets, args);
    if report.cancelled {
        voice.say("interrupted: nothing was written");
        return Ok(End::Interrupted);
    }

    let mut diagnostics = report.diagnostics.clone();
    diagnostics.extend_from_slice(&report.cache);
    let mut values = BTreeMap::new();
    let mut staged = Staged::default();
    for get in &gets {
        let Some(tree) = session.value(get.name) else {
            continue; // why it is missing stands in the report
        };
        let json = tree.to_json();
        if let Some(path) = get.file {
            staged.add(path, format!("{json}\n").as_bytes())?;
        } else {
            values.insert(get.name, json);
        }
    }
    let files = files::stage(&mut staged, session.files(), args.out.as_deref(), args.unproven)?;
    diagnostics.extend(files.iter().filter_map(Made::diagnostic));
    let errors = diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
    let end = if errors > 0 || files.iter().any(|f| f.withheld) { End::Errors } else { End::Done };
    let full = full_report(&report, &file, &diagnostics, &files, end);
    if let Some(path) = &args.report {
        staged.add(path, format!("{full:#}\n").as_bytes())?;
    }
    for path in files::commit(staged, &files, args.out.as_deref())? {
        voice.say(&format!("{} is of an earlier run: it is now called .stale", path.display()));
    }

    voice.diagnostics(&diagnostics);
    if args.json {
        let mut full = full;
        full["values"] = serde_json::json!(values);
        print_json(&full)?;
    } else {
        let summary = summarize(&session, &report, &files, &gets, errors, args);
        // Where a value was asked for, nothing else may stand on stdout, even if there is no value.
        if gets.iter().all(|g| g.file.is_some()) {
            print(&summary)?;
        } else {
            print_values(&gets, values)?;
            voice.say(summary.trim_end());
        }
    }
    if args.profile {
        profile(&voice, &report);
    }
    Ok(end)
}

/// Opens a graph with inputs set as `--set` says.
pub fn open(graph: &Path, sets: &[String], threads: u16, cache: &CacheArgs) -> Result<(PathBuf, Session), Wrong> {
    let (file, document) = graph::load(graph)?;
    let sets = sets.iter().map(|s| parse_set(s)).collect::<Result<Vec<_>, _>>()?;
    let texts: HashSet<String> = sets.iter().map(|(_, text)| (*text).to_owned()).collect();
    let options = Options {
        threads: threads.into(),
        cache_bytes: CACHE,
        host: Arc::new(graph::Files::new(&file, texts)),
        store: cache::store(cache),
    };
    let registry = Arc::new(crate::plugins::registry_for(&document)?);
    let mut session = Session::new(registry, document, options);
    for (name, text) in sets {
        set(&mut session, name, text)?;
    }
    Ok((file, session))
}

/// `NAME=VALUE`, taken apart at the first `=`.
pub fn parse_set(text: &str) -> Result<(&str, &str), Wrong> {
    text.split_once('=')
        .filter(|(name, _)| !name.is_empty())
        .ok_or_else(|| Wrong::new("set", format!("--set {text} gives no value")).hint("write --set NAME=VALUE"))
}

/// `NAME` or `NAME=FILE`.
fn parse_get(text: &str) -> Get<'_> {
    match text.split_once('=') {
        Some((name, file)) => Get { name, file: Some(Path::new(file)) },
        None => Get { name: text, file: None },
    }
}

/// The value that a text stands for at an input: at a text port the text as it stands (or what it is between quotes), at
/// others what it is as JSON, and what is not JSON, such as `12 mm`, as text.
pub fn literal(document: &Document, registry: &Registry, name: &str, text: &str) -> Json {
    match serde_json::from_str::<Json>(text) {
        Ok(Json::String(quoted)) => Json::String(quoted),
        Ok(json) if !takes_text(document, registry, name) => json,
        _ => Json::String(text.to_owned()),
    }
}

/// Gives an input a value.
fn set(session: &mut Session, name: &str, text: &str) -> Result<(), Wrong> {
    let value = literal(session.document(), session.registry(), name, text);
    session.set(name, value).map_err(|d| Wrong::new("set", format!("--set {name} cannot be done")).because(vec![d]))
}

/// Whether an input takes texts one by one: there, `12` is the text 12.
fn takes_text(document: &Document, registry: &Registry, name: &str) -> bool {
    let place = document.inputs.get(name).and_then(|input| input.ports.first()).map_or(name, String::as_str);
    let port = document.input_port(registry, place);
    port.is_some_and(|p| p.access() == Access::Item && p.type_name() == Text::TYPE)
}

/// What is to be evaluated: only what was asked for, or with an output folder all outputs and writers as well; none
/// named means all.
fn targets(session: &Session, gets: &[Get], args: &RunArgs) -> Vec<String> {
    let asked = gets.iter().map(|g| g.name.to_owned());
    if args.out.is_none() || gets.is_empty() {
        return asked.collect();
    }
    let document = session.document();
    let mut targets: Vec<String> = document.outputs.keys().cloned().chain(asked).collect();
    targets.extend(session.writers());
    targets
}

fn evaluate(session: &mut Session, targets: &[String], args: &RunArgs) -> Report {
    let targets: Vec<&str> = targets.iter().map(String::as_str).collect();
    let bar = Bar::new(args.json);
    let show = |p: &Progress| bar.show(p.fraction, &p.node);
    let control = Control { cancel: interrupt::flag(), on_progress: Some(&show) };
    let report = session.evaluate(&targets, &control);
    bar.clear();
    report
}

/// The engine's report with what the program adds: the graph's path, the files, whether all went well.
fn full_report(report: &Report, graph: &Path, diagnostics: &[Diagnostic], files: &[Made], end: End) -> Json {
    let mut json = report.to_json();
    json["ok"] = (end == End::Done).into();
    json["graph"] = graph.display().to_string().into();
    json["diagnostics"] = to_json(diagnostics);
    json["files"] = files
        .iter()
        .map(|f| {
            serde_json::json!({
                "from": f.from,
                "name": &*f.file.name,
                "bytes": f.file.bytes.len(),
                "path": f.path().map(|p| p.display().to_string()),
                "withheld": f.file.withheld.as_deref(),
            })
        })
        .collect();
    json
}

/// One value alone is printed as it is; several are named.
fn print_values(gets: &[Get], values: BTreeMap<&str, Json>) -> Result<(), Wrong> {
    match gets {
        [_] => values.values().try_for_each(print_json),
        _ => print_json(&serde_json::json!(values)),
    }
}

/// What a run came to, in lines for people: on stdout, unless values that were asked for stand there.
fn summarize(
    session: &Session,
    report: &Report,
    files: &[Made],
    gets: &[Get],
    errors: usize,
    args: &RunArgs,
) -> String {
    let mut lines = Vec::new();
    for output in session.document().outputs.keys() {
        if let Some(tree) = session.value(output) {
            lines.push(value_line(session.document(), session.registry(), output, &tree));
        }
    }
    for made in files {
        let size = size(made.file.bytes.len());
        lines.push(match made.path() {
            Some(path) => format!("wrote {} ({size})", path.display()),
            None => format!("made {} ({size}), not written: no --out DIR was given", made.file.name),
        });
    }
    let written = gets.iter().filter(|g| session.value(g.name).is_some()).filter_map(|g| g.file);
    lines.extend(written.chain(args.report.as_deref()).map(|path| format!("wrote {}", path.display())));
    let found = match errors {
        0 => "no errors".to_owned(),
        1 => "1 error".to_owned(),
        n => format!("{n} errors"),
    };
    lines.push(format!("{} in {}, {found}\n", if errors == 0 { "done" } else { "ended" }, seconds(report.elapsed)));
    lines.join("\n")
}

/// An output for people: a number alone with its unit, else what the value says of itself.
pub fn value_line(document: &Document, registry: &Registry, output: &str, tree: &Tree) -> String {
    let summary = tree.summary();
    let words = summary.strip_prefix(&format!("{}: ", tree.type_name())).unwrap_or(&summary);
    match tree.first::<f64>() {
        Some(number) if tree.len() == 1 => {
            format!("{output}: {:.3} {}", number, unit(document, registry, output).unwrap_or_default())
                .trim_end()
                .to_owned()
        }
        _ => format!("{output}: {words}"),
    }
}

/// The unit of an interface output: what the graph says, else that of the node's port.
pub fn unit(document: &Document, registry: &Registry, output: &str) -> Option<String> {
    let output = document.outputs.get(output)?;
    let behind = || document.output_port(registry, &output.port)?.describe()["unit"].as_str().map(str::to_owned);
    output.unit.clone().or_else(behind)
}

/// How long each node took, the slowest first.
fn profile(voice: &Voice, report: &Report) {
    let mut nodes: Vec<_> = report.nodes.iter().collect();
    nodes.sort_by(|a, b| b.time.cmp(&a.time).then_with(|| a.id.cmp(b.id)));
    let width = nodes.iter().map(|n| n.id.len()).max().unwrap_or(0);
    for n in nodes {
        let share = 100.0 * n.time.as_secs_f64() / report.elapsed.as_secs_f64().max(f64::MIN_POSITIVE);
        let (time, size) = (seconds(n.time), size(n.bytes));
        voice.say(&format!("{time:>10} {share:5.1} %  {:width$}  {size:>9}  {}", n.id, n.happened.as_str()));
    }
}

/// A duration for people.
pub fn seconds(t: Duration) -> String {
    let s = t.as_secs_f64();
    if s >= 1.0 {
        format!("{s:.2} s")
    } else if s >= 1e-3 {
        format!("{:.1} ms", s * 1e3)
    } else {
        format!("{:.0} µs", s * 1e6)
    }
}

/// A size for people.
pub fn size(bytes: usize) -> String {
    let b = bytes as f64;
    if b >= 1e6 {
        format!("{:.1} MB", b / 1e6)
    } else if b >= 1e3 {
        format!("{:.1} kB", b / 1e3)
    } else {
        format!("{bytes} B")
    }
}
