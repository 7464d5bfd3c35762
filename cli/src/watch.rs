//! `tenon watch`: evaluates a graph again whenever its file or a file that it reads changes, and says what ran.

mod changes;

use crate::args::WatchArgs;
use crate::files::{self, Made};
use crate::output::{self, Staged};
use crate::run::{CACHE, literal, parse_set, seconds, size};
use crate::words::{Voice, Wrong, print, to_json};
use crate::{End, cache, graph, interrupt};
use changes::{Changes, Look};
use std::collections::{BTreeMap, HashSet};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::Ordering;
use std::time::Duration;
use tenon_engine::{Diagnostic, Document, Happened, Json, Live, NodeReport, NodeReports, Options, Severity, Snapshot};

/// How often files are looked at.
const PAUSE: Duration = Duration::from_millis(100);

/// Of the nodes that ran, so many are named, the slowest ones.
const NAMED: usize = 12;

/// Watches until Ctrl-C.
pub fn watch(args: &WatchArgs) -> Result<End, Wrong> {
    let voice = Voice::new();
    let stop = interrupt::flag();
    let sets = args.set.iter().map(|s| parse_set(s)).collect::<Result<Vec<_>, _>>()?;
    let file = graph::find(&args.graph)?;
    let mut of_graph = Look::at(&file);
    let (_, document) = graph::load(&file)?;
    if let Some(dir) = &args.out {
        output::prepare_folder(dir)?;
    }
    let texts: HashSet<String> = sets.iter().map(|(_, text)| (*text).to_owned()).collect();
    let inputs = Arc::new(Changes::new(graph::Files::new(&file, texts)));
    let store = cache::store(&args.cache);
    let options = Options { threads: args.threads.into(), cache_bytes: CACHE, host: inputs.clone(), store };
    let registry = Arc::new(crate::plugins::registry_for(&document)?);
    let no_thread = |error| Wrong::new("no-thread", format!("the system gives no thread: {error}"));
    // Nothing runs before the inputs are set.
    let mut live = Live::new(registry, Document::new(), options, || {}).map_err(no_thread)?;
    live.lock(true);
    update(&mut live, document, &sets)?;
    // A name that nobody knows is told with each evaluation, as long as the file does not know it.
    live.set_goals(&args.get.iter().map(String::as_str).collect::<Vec<_>>());
    live.lock(false);
    voice.say(&format!("watching {}; Ctrl-C ends", file.display()));

    let mut told: Option<Arc<Snapshot>> = None;
    while !stop.load(Ordering::SeqCst) {
        if of_graph.has_changed(&file) {
            live.lock(true);
            match graph::load(&file).map_err(Wrong::from).and_then(|(_, document)| update(&mut live, document, &sets)) {
                Ok(()) => voice.say(&format!("{} has changed", file.display())),
                // It may be under way to something better.
                Err(wrong) => voice.wrong(&wrong),
            }
            live.lock(false);
        }
        for path in inputs.changed() {
            voice.say(&format!("{} has changed", path.display()));
            live.evaluate_now();
        }
        if let Some(snapshot) = live.latest().filter(|s| told.as_ref().is_none_or(|t| !Arc::ptr_eq(s, t)))
            && snapshot.revision() == live.revision()
        {
            if let Err(wrong) = tell(&live, &snapshot, &file, args, &voice) {
                voice.wrong(&wrong);
            }
            told = Some(snapshot);
        }
        std::thread::sleep(PAUSE);
    }
    Ok(if live.is_busy() { End::Interrupted } else { End::Done })
}

/// Makes the document what the file says, with inputs as `--set` says.
fn update(live: &mut Live, document: Document, sets: &[(&str, &str)]) -> Result<(), Wrong> {
    let fault = |d: Diagnostic| Wrong::new("no-graph", "the graph cannot be taken over").because(vec![d]);
    live.replace(document).map_err(fault)?;
    for (name, text) in sets {
        let value = literal(live.document(), live.registry(), name, text);
        live.set(name, value)
            .map_err(|d| Wrong::new("set", format!("--set {name} cannot be done")).because(vec![d]))?;
    }
    // Nobody takes anything back here.
    live.forget_steps();
    Ok(())
}

/// Writes what an evaluation has made and says how it went.
fn tell(live: &Live, snapshot: &Snapshot, graph: &Path, args: &WatchArgs, voice: &Voice) -> Result<(), Wrong> {
    let report = snapshot.report();
    let mut staged = Staged::default();
    let made = files::stage(&mut staged, snapshot.files().to_vec(), args.out.as_deref(), args.unproven)?;
    for path in files::commit(staged, &made, args.out.as_deref())? {
        voice.say(&format!("{} is of an earlier run: it is now called .stale", path.display()));
    }
    let mut diagnostics = report.diagnostics.clone();
    diagnostics.extend_from_slice(&report.cache);
    diagnostics.extend(made.iter().filter_map(Made::diagnostic));
    voice.diagnostics(&diagnostics);
    let errors = diagnostics.iter().filter(|d| d.severity == Severity::Error).count();
    if args.json {
        let mut json = report.to_json();
        json["revision"] = snapshot.revision().into();
        json["ok"] = (errors == 0 && !made.iter().any(|m| m.withheld)).into();
        json["graph"] = graph.display().to_string().into();
        json["diagnostics"] = to_json(&diagnostics);
        json["files"] = made.iter().filter_map(Made::path).map(|p| Json::from(p.display().to_string())).collect();
        let values = args.get.iter().filter_map(|name| Some((name.clone(), snapshot.value(name)?.to_json())));
        if !args.get.is_empty() {
            json["values"] = values.collect::<serde_json::Map<_, _>>().into();
        }
        // One line, so that whoever reads along knows where it ends.
        return print(&format!("{json}\n"));
    }
    let mut lines = ran(&report.nodes);
    let outputs = live.document().outputs.keys().filter(|name| !args.get.contains(name));
    for name in outputs.chain(&args.get) {
        if let Some(tree) = snapshot.value(name) {
            lines.push(crate::run::value_line(live.document(), live.registry(), name, tree));
        }
    }
    let files = made.iter().filter_map(|m| Some((m.path()?, m.file.bytes.len())));
    lines.extend(files.map(|(path, bytes)| format!("wrote {} ({})", path.display(), size(bytes))));
    let found = match errors {
        0 => "no errors".to_owned(),
        1 => "1 error".to_owned(),
        n => format!("{n} errors"),
    };
    lines.push(format!("{} in {}, {found}\n", counts(&report.nodes), seconds(report.elapsed)));
    print(&lines.join("\n"))
}

/// The nodes that ran, the slowest first.
fn ran(nodes: &NodeReports) -> Vec<String> {
    let mut ran: Vec<NodeReport<'_>> =
        nodes.iter().filter(|n| matches!(n.happened, Happened::Executed | Happened::Failed)).collect();
    ran.sort_by(|a, b| b.time.cmp(&a.time).then_with(|| a.id.cmp(b.id)));
    let more = ran.len().saturating_sub(NAMED);
    let line = |n: &NodeReport<'_>| format!("{:>10}  {} {}", seconds(n.time), n.happened.as_str(), n.id);
    let mut lines: Vec<String> = ran.iter().take(NAMED).map(line).collect();
    lines.extend((more > 0).then(|| format!("            and {more} more that took less")));
    lines
}

/// "3 executed, 5 memo".
fn counts(nodes: &NodeReports) -> String {
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for node in nodes.iter() {
        *counts.entry(node.happened.as_str()).or_default() += 1;
    }
    let counts: Vec<String> = counts.iter().map(|(what, n)| format!("{n} {what}")).collect();
    if counts.is_empty() { "nothing to do".to_owned() } else { counts.join(", ") }
}
