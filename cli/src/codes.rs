//! The codes of the command line's own faults: what each means and what helps.

use tenon_engine::Code;

const fn code(name: &'static str, means: &'static str, help: &'static str) -> Code {
    Code::new(name, means, help)
}

/// Every code that the command line gives besides the engine's and the nodes', sorted by name.
pub const CODES: &[Code] = &[
    code("bad-name", "The name given cannot be a plugin's id.", "Lower case letters, digits and _, a letter first."),
    code(
        "bad-plugin",
        "A library is no plugin, or one that cannot be loaded.",
        "The message says what is wrong with it.",
    ),
    code("exists", "What is to be made is there already.", "Name another, or remove it."),
    code("get", "A value that --get asks for does not exist.", "The reason below it names the nearest."),
    code("inspect", "The port to be shown does not exist.", "The reason below it names the nearest."),
    code(
        "no-expectations",
        "No expectations are recorded beside the graph.",
        "Record them: tenon test GRAPH --record.",
    ),
    code("no-graph", "The file is not a graph, or has errors.", "The reasons stand below it."),
    code("no-plan", "A line of a plan is no row of a sweep.", "tenon sweep plan writes plans."),
    code("no-process", "A check of a plugin cannot be started.", "The message gives the system's reason."),
    code(
        "no-sdk",
        "The source of the plugin SDK, which plugins in Rust need, is not there.",
        "Name its folder with --sdk.",
    ),
    code(
        "no-thread",
        "The system gives the program no thread to work on.",
        "Close other programs, or raise their limit.",
    ),
    code(
        "not-a-host",
        "The process of a plugin was started by hand.",
        "tenon starts it by itself: --isolate ID runs a plugin in a process of its own.",
    ),
    code("not-recorded", "The graph has errors, so nothing was recorded.", "Mend them first."),
    code("not-tested", "Some of the graphs could not be tested.", "Their reasons stand above it."),
    code("set", "An input cannot have the value that --set gives it.", "The reason below it says what it takes."),
    code("unknown-check", "There is no check of that name.", "The hint lists them all."),
    code(
        "unknown-code",
        "There is no diagnostic of that code.",
        "The hint names the nearest; tenon explain lists all.",
    ),
    code(
        "unknown-node-type",
        "There is no node type of that name.",
        "The hint names the nearest; tenon nodes lists all.",
    ),
    code("unknown-row", "The plan has no row of that key.", "A row's key stands in its \"key\"."),
    code("unreadable", "A file or folder cannot be read.", "The message gives the system's reason."),
    code(
        "unwritable",
        "A file cannot be written, or its name leads out of the output folder.",
        "The message says which.",
    ),
    code("vary", "The values of --vary cannot be used.", "Write NAME=a,b,c or NAME=start:end:count."),
    code(
        "withheld",
        "A program failed its proof or has none, so it was written as .unproven.",
        "Look at the proof; --unproven gives it its name all the same.",
    ),
];
