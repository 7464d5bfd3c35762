//! The program `tenon`: runs, checks and formats graphs, and describes nodes.
//!
//! Everything that another host of the engine would need as well lives in the engine; here are arguments, files,
//! words and exit codes.

mod args;
mod cache;
mod check;
mod codes;
mod explain;
mod fmt;
mod inspect;
mod interrupt;
mod nodes;
mod plugin_check;
mod plugin_new;
mod plugins;
mod progress;
mod run;
mod schema;
mod sweep;
mod test;
mod watch;
mod words;

use args::{Command, CommandLine, RunArgs};
use clap::Parser;
use std::process::ExitCode;
use tenon_nodes::host::{graph, made as files, output};
use words::{Voice, Wrong};

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// How a call that was right ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// All done.
    Done,
    /// The graph has errors, or files are not as they should be.
    Errors,
    /// Something is wrong and has been said.
    Wrong,
    /// Ctrl-C.
    Interrupted,
}

/// The graph that runs when nothing is said.
const DEFAULT_GRAPH: &str = "graphs/shell-256";

fn main() -> ExitCode {
    let line = CommandLine::parse();
    plugins::name(line.plugin, line.isolate);
    let json = match &line.command {
        Some(Command::Run(a)) => a.json,
        Some(Command::Check(a)) => a.json,
        Some(Command::Nodes(a)) => a.json,
        Some(Command::Inspect(a)) => a.json,
        Some(Command::Sweep(a)) => sweep::json(a),
        Some(Command::Explain(a)) => a.json,
        Some(Command::Test(a)) => a.json,
        Some(Command::Watch(a)) => a.json,
        Some(Command::Plugin(args::PluginCommand::List(a))) => a.json,
        Some(Command::Plugin(args::PluginCommand::Info(a))) => a.json,
        Some(Command::Plugin(args::PluginCommand::Check(a))) => a.json,
        Some(Command::Plugin(args::PluginCommand::New(_) | args::PluginCommand::Host(_))) => false,
        Some(Command::Schema(_) | Command::Fmt(_)) | None => false,
    };
    let result = match line.command {
        Some(Command::Run(a)) => run::run(&a),
        Some(Command::Check(a)) => check::check(&a),
        Some(Command::Nodes(a)) => nodes::nodes(&a),
        Some(Command::Inspect(a)) => inspect::inspect(&a),
        Some(Command::Schema(a)) => schema::schema(&a),
        Some(Command::Explain(a)) => explain::explain(&a),
        Some(Command::Test(a)) => test::test(&a),
        Some(Command::Fmt(a)) => fmt::fmt(&a),
        Some(Command::Watch(a)) => watch::watch(&a),
        Some(Command::Sweep(a)) => sweep::sweep(&a),
        Some(Command::Plugin(a)) => plugins::plugin(&a),
        None => run_default(),
    };
    match result {
        Ok(End::Done) => ExitCode::SUCCESS,
        Ok(End::Errors) => ExitCode::from(1),
        Ok(End::Wrong) => ExitCode::from(2),
        Ok(End::Interrupted) => ExitCode::from(interrupt::INTERRUPTED),
        Err(wrong) => {
            if json {
                // The code says it all if this cannot be printed either.
                let _ = words::print_json(&wrong.to_json());
            }
            Voice::new().wrong(&wrong);
            ExitCode::from(2)
        }
    }
}

/// The main job: the default graph into `out/`.
fn run_default() -> Result<End, Wrong> {
    if !std::path::Path::new(DEFAULT_GRAPH).exists() {
        let here = std::env::current_dir().map(|d| d.display().to_string()).unwrap_or_default();
        return Err(Wrong::new("no-graph", format!("the default graph {DEFAULT_GRAPH} is not in {here}")).hint(
            "start tenon in the folder of its source, or name a graph: tenon run GRAPH (tenon --help says more)",
        ));
    }
    run::run(&RunArgs { graph: DEFAULT_GRAPH.into(), out: Some("out".into()), ..RunArgs::default() })
}
