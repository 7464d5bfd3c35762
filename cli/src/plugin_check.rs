//! `tenon plugin check`: every check of a plugin's conduct in a process of its own, so that one that crashes or hangs is a
//! finding and not the end.

use crate::End;
use crate::args::PluginCheckArgs;
use crate::test::junit::escape;
use crate::words::{Wrong, print, print_json};
use std::fmt::Write;
use std::io::Read;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};
use tenon_engine::Json;
use tenon_nodes::plugin::check::{Check, all};

/// A check that takes longer hangs.
const LIMIT: Duration = Duration::from_secs(60);

/// What a check found.
struct Outcome {
    name: &'static str,
    about: &'static str,
    /// What is wrong; nothing: it passed.
    faults: Vec<String>,
    time: Duration,
}

/// Makes every check, or one.
pub fn check(args: &PluginCheckArgs) -> Result<End, Wrong> {
    let mut checks = all();
    if let Some(only) = &args.only {
        checks.retain(|c| c.name == only);
        if checks.is_empty() {
            let names: Vec<&str> = all().iter().map(|c| c.name).collect();
            return Err(Wrong::new("unknown-check", format!("there is no check \"{only}\"")).hint(names.join(", ")));
        }
    }
    if args.here {
        return here(&checks, &args.library);
    }
    if !args.library.is_file() {
        return Err(Wrong::new("bad-plugin", format!("{}: there is no such file", args.library.display())));
    }
    let mut outcomes = Vec::new();
    for check in &checks {
        let outcome = apart(check, &args.library)?;
        if !args.json {
            print(&line(&outcome))?;
        }
        outcomes.push(outcome);
    }
    let failed = outcomes.iter().filter(|o| !o.faults.is_empty()).count();
    if args.json {
        print_json(&json(&outcomes, failed))?;
    } else {
        print(&format!("{} passed, {failed} failed\n", outcomes.len() - failed))?;
    }
    if let Some(place) = &args.junit {
        crate::output::write_whole(place, junit(&outcomes, &args.library).as_bytes())?;
    }
    Ok(if failed == 0 { End::Done } else { End::Errors })
}

/// The body of a check's own process: its faults as JSON, last on stdout.
fn here(checks: &[Check], library: &Path) -> Result<End, Wrong> {
    for check in checks {
        let faults = check.run(library).unwrap_or_else(|e| vec![e.to_string()]);
        print(&format!("\n{MARK}{}\n", Json::from(faults)))?;
    }
    Ok(End::Done)
}

/// Before the faults on stdout, since a plugin may print there too.
const MARK: &str = "tenon-check:";

fn apart(check: &Check, library: &Path) -> Result<Outcome, Wrong> {
    let no_process = |e: std::io::Error| Wrong::new("no-process", format!("a check's process cannot be started: {e}"));
    let start = Instant::now();
    let program = std::env::current_exe().map_err(no_process)?;
    let mut child = Command::new(program)
        .args(["plugin", "check", "--here", "--only", check.name])
        .arg(library)
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .map_err(no_process)?;
    let mut pipe = child.stdout.take();
    // Read beside, so that a plugin that prints much does not wait for us.
    let reader = std::thread::spawn(move || {
        let mut text = Vec::new();
        let read = pipe.as_mut().map(|p| p.read_to_end(&mut text));
        (text, read)
    });
    let ended = wait(&mut child, start).map_err(no_process)?;
    let (text, _) = reader.join().unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    let told = text.rsplit_once(MARK).and_then(|(_, json)| serde_json::from_str::<Vec<String>>(json.trim()).ok());
    let faults = match (ended, told) {
        (Some(status), Some(faults)) if status.success() => faults,
        (Some(status), _) => vec![format!("the process ended with {status}")],
        (None, _) => vec![format!("it did not end within {} s", LIMIT.as_secs())],
    };
    Ok(Outcome { name: check.name, about: check.about, faults, time: start.elapsed() })
}

/// How a process ended; `None`: it had to be killed.
fn wait(child: &mut Child, start: Instant) -> std::io::Result<Option<std::process::ExitStatus>> {
    loop {
        if let Some(status) = child.try_wait()? {
            return Ok(Some(status));
        }
        if start.elapsed() > LIMIT {
            child.kill()?;
            child.wait()?;
            return Ok(None);
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn line(o: &Outcome) -> String {
    if o.faults.is_empty() {
        return format!("passed  {}\n", o.name);
    }
    let mut out = format!("FAILED  {}: {}\n", o.name, o.about);
    for fault in &o.faults {
        let _ = writeln!(out, "          {fault}");
    }
    out
}

fn json(outcomes: &[Outcome], failed: usize) -> Json {
    let one = |o: &Outcome| {
        serde_json::json!({ "check": o.name, "about": o.about, "passed": o.faults.is_empty(), "faults": o.faults,
                            "time_ms": o.time.as_secs_f64() * 1e3 })
    };
    serde_json::json!({ "ok": failed == 0, "checks": outcomes.iter().map(one).collect::<Vec<_>>() })
}

fn junit(outcomes: &[Outcome], library: &Path) -> String {
    let failed = outcomes.iter().filter(|o| !o.faults.is_empty()).count();
    let name = escape(&library.display().to_string());
    let mut out = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"{name}\" tests=\"{}\" failures=\"{failed}\">\n",
        outcomes.len()
    );
    for o in outcomes {
        let seconds = o.time.as_secs_f64();
        let _ = write!(out, "  <testcase classname=\"{name}\" name=\"{}\" time=\"{seconds:.3}\"", o.name);
        if o.faults.is_empty() {
            out += "/>\n";
        } else {
            let _ = writeln!(
                out,
                "><failure message=\"{}\">{}</failure></testcase>",
                escape(o.about),
                escape(&o.faults.join("\n"))
            );
        }
    }
    out + "</testsuite>\n"
}
