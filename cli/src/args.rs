//! What can be said on the command line: the sub-commands and their options, with the words of `--help`.

use clap::{Args, Parser, Subcommand};
use std::path::PathBuf;

/// The whole command line.
#[derive(Debug, Parser)]
#[command(
    name = "tenon",
    version,
    about = "Runs the digital chain of free-form timber: from curves to proven machine code.",
    long_about = "Runs the digital chain of free-form timber as one dataflow graph: from curves to proven machine \
                  code.\n\nWithout a command it runs the graph graphs/shell-256 of the current folder into out/.",
    after_help = "Exit codes: 0 done, 1 the graph has errors, 2 the call or a file is wrong, 130 interrupted."
)]
pub struct CommandLine {
    /// What to do; nothing said means the default graph.
    #[command(subcommand)]
    pub command: Option<Command>,
    /// Load a plugin: a shared library. May be given several times; those in the folders of TENON_PLUGIN_PATH and in the
    /// user's folder are loaded as well
    #[arg(long, value_name = "LIBRARY", global = true)]
    pub plugin: Vec<PathBuf>,
    /// Run a plugin in a process of its own, so that its crashes are its own; all means every plugin
    #[arg(long, value_name = "ID", global = true)]
    pub isolate: Vec<String>,
}

/// The sub-commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Evaluate a graph and write what it makes
    Run(RunArgs),
    /// Read a graph and say what is wrong with it, without evaluating it
    Check(CheckArgs),
    /// List the node types, or describe one
    Nodes(NodesArgs),
    /// Show the value of any port: a summary, a table or JSON
    Inspect(InspectArgs),
    /// Say what the code of a diagnostic means and what helps
    Explain(ExplainArgs),
    /// Print the JSON Schema of graph files
    Schema(SchemaArgs),
    /// Compare graphs with the expectations recorded beside them
    Test(TestArgs),
    /// Rewrite graph files in the canonical form
    Fmt(FmtArgs),
    /// Evaluate a graph again whenever its file or a file that it reads changes
    Watch(WatchArgs),
    /// Evaluate a graph for many values of its inputs
    #[command(subcommand)]
    Sweep(SweepCommand),
    /// Look at plugins
    #[command(subcommand)]
    Plugin(PluginCommand),
}

/// What can be asked of plugins.
#[derive(Debug, Subcommand)]
pub enum PluginCommand {
    /// List the plugins that are loaded, and libraries that were refused
    List(PluginListArgs),
    /// Describe one library with its node types
    Info(PluginInfoArgs),
    /// Test one library's conduct, each check in a process of its own
    Check(PluginCheckArgs),
    /// Write the source of a new plugin into a folder
    New(PluginNewArgs),
    /// Be the process of a plugin; started by tenon itself
    #[command(hide = true)]
    Host(PluginHostArgs),
}

/// Options of `tenon plugin host`.
#[derive(Debug, Args)]
pub struct PluginHostArgs {
    /// The shared library
    pub library: PathBuf,
    /// The memory that it may take, bytes
    pub memory: u64,
}

/// Options of `tenon plugin check`.
#[derive(Debug, Args)]
pub struct PluginCheckArgs {
    /// A shared library
    pub library: PathBuf,
    /// Make only this check
    #[arg(long, value_name = "CHECK")]
    pub only: Option<String>,
    /// Make the check in this process; what a check's own process is called with
    #[arg(long, hide = true, requires = "only")]
    pub here: bool,
    /// Print the outcomes as JSON on stdout
    #[arg(long)]
    pub json: bool,
    /// Write the outcomes as JUnit XML
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
}

/// Options of `tenon plugin new`.
#[derive(Debug, Args)]
pub struct PluginNewArgs {
    /// The plugin's id, lower case letters, digits and _; also the name of the folder
    pub name: String,
    /// In C instead of Rust
    #[arg(long)]
    pub c: bool,
    /// A node that makes curves instead of a fastener
    #[arg(long, conflicts_with = "c")]
    pub curve: bool,
    /// The folder plugin-sdk of Tenon, on which a plugin in Rust depends; without it, the one that lies where this program
    /// is installed or was built
    #[arg(long, value_name = "DIR", conflicts_with = "c")]
    pub sdk: Option<PathBuf>,
}

/// Options of `tenon plugin list`.
#[derive(Debug, Args)]
pub struct PluginListArgs {
    /// Print the list as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

/// Options of `tenon plugin info`.
#[derive(Debug, Args)]
pub struct PluginInfoArgs {
    /// A shared library
    pub library: PathBuf,
    /// Print the description as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

/// The steps of a sweep.
#[derive(Debug, Subcommand)]
pub enum SweepCommand {
    /// Write one row per variant of a graph
    Plan(SweepPlanArgs),
    /// Evaluate one row of a plan, unless its result is there already
    RunRow(SweepRowArgs),
    /// Evaluate every row of a plan that has no result yet
    Run(SweepRunArgs),
}

/// Options of `tenon sweep plan`.
#[derive(Debug, Args)]
pub struct SweepPlanArgs {
    /// A graph file, or a folder that holds exactly one *.tenon.json
    pub graph: PathBuf,
    /// Give an input several values: VALUES is a,b,c or start:end:count (both ends included). Several --vary make every
    /// combination; NAME is an interface input or node.port
    #[arg(long, value_name = "NAME=VALUES", required = true)]
    pub vary: Vec<String>,
    /// Give an input the same value in every row
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// The plan to write, one JSON object per line
    #[arg(long, value_name = "FILE")]
    pub out: PathBuf,
}

/// Options of `tenon sweep run-row`.
#[derive(Debug, Args)]
pub struct SweepRowArgs {
    /// The plan
    pub plan: PathBuf,
    /// The row's key
    pub key: String,
    /// Folder of the results; this row's go into DIR/KEY
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Threads to use; 0 means all there are
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    pub threads: u16,
    /// Where results are kept from run to run
    #[command(flatten)]
    pub cache: CacheArgs,
    /// Print the row's result as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

/// Options of `tenon sweep run`.
#[derive(Debug, Args)]
pub struct SweepRunArgs {
    /// The plan
    pub plan: PathBuf,
    /// Folder of the results; each row's go into DIR/KEY
    #[arg(long, value_name = "DIR")]
    pub out: PathBuf,
    /// Rows evaluated at the same time; they share the machine's threads
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub jobs: u16,
    /// Where results are kept from run to run
    #[command(flatten)]
    pub cache: CacheArgs,
    /// Print what was done as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

/// Where results are kept from run to run.
#[derive(Clone, Debug, Default, Args)]
pub struct CacheArgs {
    /// Keep the results of slow nodes in DIR (made if it is not there) and use those that are there
    #[arg(long, value_name = "DIR")]
    pub cache: Option<PathBuf>,
    /// With --cache: the most that DIR may take, in MiB; what was used longest ago goes first
    #[arg(long, value_name = "MIB", requires = "cache", default_value_t = 4096, value_parser = clap::value_parser!(u32).range(1..))]
    pub cache_size: u32,
}

/// Options of `tenon run`.
#[derive(Clone, Debug, Default, Args)]
pub struct RunArgs {
    /// A graph file, or a folder that holds exactly one *.tenon.json
    pub graph: PathBuf,
    /// Give an input a value; NAME is an interface input or node.port, VALUE is JSON or plain text
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Print a value as JSON, or write it to FILE; NAME is an interface output or node.port.
    /// Without --out only what is asked for here is evaluated
    #[arg(long, value_name = "NAME[=FILE]")]
    pub get: Vec<String>,
    /// Write the graph's files into this folder (made if it is not there)
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write diagnostics, timings, digests and sizes as JSON
    #[arg(long, value_name = "FILE")]
    pub report: Option<PathBuf>,
    /// Threads to use; 0 means all there are
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    pub threads: u16,
    /// Where results are kept from run to run
    #[command(flatten)]
    pub cache: CacheArgs,
    /// Print how long each node took
    #[arg(long)]
    pub profile: bool,
    /// Give programs their final names although their proof failed or was skipped
    #[arg(long)]
    pub unproven: bool,
    /// Print the result as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

/// Options of `tenon watch`.
#[derive(Debug, Args)]
pub struct WatchArgs {
    /// A graph file, or a folder that holds exactly one *.tenon.json
    pub graph: PathBuf,
    /// Give an input a value, as for `tenon run`; it stays whatever the file says
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Evaluate only this and show its value after every evaluation; NAME is an interface output or node.port
    #[arg(long, value_name = "NAME", conflicts_with = "out")]
    pub get: Vec<String>,
    /// Write the graph's files into this folder after every evaluation (made if it is not there)
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Threads to use; 0 means all there are
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    pub threads: u16,
    /// Where results are kept from run to run
    #[command(flatten)]
    pub cache: CacheArgs,
    /// Give programs their final names although their proof failed or was skipped
    #[arg(long)]
    pub unproven: bool,
    /// Print the result of every evaluation as one line of JSON on stdout
    #[arg(long)]
    pub json: bool,
}

/// Options of `tenon check`.
#[derive(Debug, Args)]
pub struct CheckArgs {
    /// A graph file, or a folder that holds exactly one *.tenon.json
    pub graph: PathBuf,
    /// Print the diagnostics as JSON on stdout
    #[arg(long)]
    pub json: bool,
}

/// Options of `tenon nodes`.
#[derive(Debug, Args)]
pub struct NodesArgs {
    /// Describe only this node type
    #[arg(value_name = "TYPE")]
    pub node_type: Option<String>,
    /// Tell of the clusters of this graph as well (cluster:NAME)
    #[arg(long, value_name = "GRAPH", conflicts_with = "conversions")]
    pub graph: Option<PathBuf>,
    /// List instead what wires turn into what by themselves
    #[arg(long, conflicts_with = "node_type")]
    pub conversions: bool,
    /// Print the descriptions as JSON
    #[arg(long)]
    pub json: bool,
}

/// Options of `tenon fmt`.
#[derive(Debug, Args)]
pub struct FmtArgs {
    /// Graph files, or folders that hold exactly one *.tenon.json
    #[arg(required = true, value_name = "FILE")]
    pub files: Vec<PathBuf>,
    /// Change nothing; name the files that are not in canonical form and exit with 1
    #[arg(long)]
    pub check: bool,
    /// Pin linked clusters to the version and the digest that their files have now
    #[arg(long, conflicts_with = "check")]
    pub update_links: bool,
}

/// Options of `tenon inspect`.
#[derive(Debug, Args)]
pub struct InspectArgs {
    /// A graph file, or a folder that holds exactly one *.tenon.json
    pub graph: PathBuf,
    /// node.port of an output or an input, or the name of an interface output or input
    #[arg(value_name = "NODE.PORT")]
    pub port: String,
    /// Print the value as JSON
    #[arg(long, group = "form")]
    pub json: bool,
    /// Print one line per item
    #[arg(long, group = "form")]
    pub table: bool,
    /// Print what the value comes to: type, counts, range (what is printed if nothing is said)
    #[arg(long, group = "form")]
    pub summary: bool,
    /// Give an input a value, as for `tenon run`
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// Threads to use; 0 means all there are
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    pub threads: u16,
    /// Where results are kept from run to run
    #[command(flatten)]
    pub cache: CacheArgs,
}

/// Options of `tenon explain`.
#[derive(Debug, Args)]
pub struct ExplainArgs {
    /// The code, as it stands between brackets: missing-input. Without it all are listed
    pub code: Option<String>,
    /// Print the words as JSON
    #[arg(long)]
    pub json: bool,
}

/// Options of `tenon schema`.
#[derive(Debug, Args)]
pub struct SchemaArgs {
    /// Narrow it to the installed node types, each with its parameters and inputs
    #[arg(long)]
    pub nodes: bool,
    /// Print the schema of reports instead: what --report and run --json write
    #[arg(long, conflicts_with = "nodes")]
    pub report: bool,
    /// Print the schema of NAME.expect.json instead: what `tenon test` compares with
    #[arg(long, conflicts_with_all = ["nodes", "report"])]
    pub expect: bool,
}

/// Options of `tenon test`.
#[derive(Debug, Args)]
pub struct TestArgs {
    /// Graph files, or folders that hold exactly one *.tenon.json; NAME.expect.json stands beside NAME.tenon.json
    #[arg(required = true, value_name = "GRAPH")]
    pub graphs: Vec<PathBuf>,
    /// Write what the graphs now come to as what is expected of them; tolerances and inputs that stand there stay
    #[arg(long)]
    pub record: bool,
    /// With --record: expect the digest of every output, so that not one bit may differ
    #[arg(long, requires = "record")]
    pub exact: bool,
    /// Print the outcomes as JSON on stdout
    #[arg(long)]
    pub json: bool,
    /// Write the outcomes as JUnit XML
    #[arg(long, value_name = "FILE")]
    pub junit: Option<PathBuf>,
    /// Threads to use; 0 means all there are
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u16).range(0..=1024))]
    pub threads: u16,
    /// Where results are kept from run to run
    #[command(flatten)]
    pub cache: CacheArgs,
}
