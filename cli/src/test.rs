//! `tenon test`: compares graphs with the expectations recorded beside them, or records them.

pub mod junit;

use crate::args::TestArgs;
use crate::words::{Voice, Wrong, print, print_json};
use crate::{End, graph, interrupt, output, run};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use tenon_engine::{Control, Expectations, Json, Outcome};

/// What came of one graph.
pub struct Tested {
    graph: PathBuf,
    elapsed: Duration,
    /// The outcomes, or why there are none.
    result: Result<Vec<Outcome>, Wrong>,
}

impl Tested {
    fn passed(&self) -> bool {
        self.result.as_ref().is_ok_and(|all| all.iter().all(|o| o.failures.is_empty()))
    }

    fn to_json(&self) -> Json {
        let mut json = serde_json::json!({
            "graph": self.graph.display().to_string(),
            "ok": self.passed(),
            "elapsed_ms": self.elapsed.as_secs_f64() * 1e3,
        });
        match &self.result {
            Ok(outcomes) => {
                let one = |o: &Outcome| serde_json::json!({ "name": o.name, "ok": o.failures.is_empty(), "failures": o.failures });
                json["expectations"] = outcomes.iter().map(one).collect();
            }
            Err(wrong) => {
                json["error"] = wrong.to_json()["error"].clone();
                json["diagnostics"] = wrong.to_json()["diagnostics"].clone();
            }
        }
        json
    }
}

/// Tests or records every graph; one that is wrong does not keep the others from it.
pub fn test(args: &TestArgs) -> Result<End, Wrong> {
    let voice = Voice::new();
    let cancel = interrupt::flag();
    let mut all = Vec::with_capacity(args.graphs.len());
    for path in &args.graphs {
        let mut tested = Tested { graph: path.clone(), elapsed: Duration::ZERO, result: Ok(Vec::new()) };
        match one(path, args, &cancel, &mut tested) {
            Ok(None) => return Ok(End::Interrupted),
            Ok(Some(outcomes)) => tested.result = Ok(outcomes),
            Err(wrong) => {
                voice.wrong(&wrong);
                tested.result = Err(wrong);
            }
        }
        if !args.json {
            print(&words(&tested, args.record))?;
        }
        all.push(tested);
    }
    let ok = all.iter().all(Tested::passed);
    if let Some(file) = &args.junit {
        output::write_whole(file, junit::report(&all).as_bytes())?;
    }
    if args.json {
        print_json(&serde_json::json!({ "ok": ok, "graphs": all.iter().map(Tested::to_json).collect::<Vec<_>>() }))?;
    }
    let wrong = all.iter().filter(|t| t.result.is_err()).count();
    if wrong > 0 && !args.json {
        return Err(Wrong::new(
            "not-tested",
            format!("{wrong} of {} graphs could not be {}", all.len(), done(args.record)),
        ));
    }
    Ok(if wrong > 0 {
        End::Wrong
    } else if ok {
        End::Done
    } else {
        End::Errors
    })
}

fn done(record: bool) -> &'static str {
    if record { "recorded" } else { "tested" }
}

/// The outcomes of one graph; `None` if it was interrupted.
fn one(
    path: &Path,
    args: &TestArgs,
    cancel: &Arc<AtomicBool>,
    tested: &mut Tested,
) -> Result<Option<Vec<Outcome>>, Wrong> {
    let (file, mut session) = run::open(path, &[], args.threads, &args.cache)?;
    tested.graph.clone_from(&file);
    let beside = beside(&file);
    let missing = !beside.exists();
    if missing && !args.record {
        return Err(Wrong::new("no-expectations", format!("there is no {}", beside.display()))
            .hint(format!("record what is expected: tenon test {} --record", path.display())));
    }
    let expected = match missing {
        true => Expectations::default(),
        false => Expectations::from_slice(&graph::read(&beside)?).map_err(|d| {
            Wrong::new("bad-expectations", format!("{} cannot be used", beside.display())).because(vec![d])
        })?,
    };
    for (name, value) in &expected.set {
        session
            .set(name, value.clone())
            .map_err(|d| Wrong::new("set", format!("{}: {name} cannot be set", beside.display())).because(vec![d]))?;
    }
    let targets = expected.targets(&session);
    let targets: Vec<&str> = targets.iter().map(String::as_str).collect();
    let report = session.evaluate(&targets, &Control { cancel: cancel.clone(), on_progress: None });
    if report.cancelled {
        return Ok(None);
    }
    tested.elapsed = report.elapsed;
    Voice::new().diagnostics(&report.cache);
    if !args.record {
        return Ok(Some(expected.check(&session, &report)));
    }
    if report.has_errors() {
        return Err(Wrong::new("not-recorded", format!("{} has errors: nothing was recorded", file.display()))
            .because(report.diagnostics));
    }
    let recorded = expected.record(&session, &report, args.exact);
    output::write_whole(&beside, format!("{:#}\n", recorded.to_json()).as_bytes())?;
    // What was written must hold for the very run that it was made of.
    Ok(Some(recorded.check(&session, &report)))
}

/// `NAME.expect.json` beside `NAME.tenon.json`.
fn beside(graph: &Path) -> PathBuf {
    let name = graph.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let name = [".tenon.json", ".json"].iter().find_map(|end| name.strip_suffix(end)).unwrap_or(&name);
    graph.with_file_name(format!("{name}.expect.json"))
}

/// A line per expectation that was not met, and one for the graph.
fn words(tested: &Tested, record: bool) -> String {
    let mut out = String::new();
    let graph = tested.graph.display();
    let Ok(outcomes) = &tested.result else { return out };
    for outcome in outcomes.iter().filter(|o| !o.failures.is_empty()) {
        let _ = writeln!(out, "FAILED {graph} {}", outcome.name);
        for failure in &outcome.failures {
            let _ = writeln!(out, "  {failure}");
        }
    }
    let failed = outcomes.iter().filter(|o| !o.failures.is_empty()).count();
    let passed = outcomes.len() - failed;
    let time = run::seconds(tested.elapsed);
    let _ = match record {
        true => writeln!(out, "{graph}: {} expectations recorded in {time}", outcomes.len()),
        false => writeln!(out, "{graph}: {passed} passed, {failed} failed in {time}"),
    };
    out
}
