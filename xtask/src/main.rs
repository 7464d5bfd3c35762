//! Developer commands: `cargo xtask bench SUITE` measures, `cargo xtask docs` writes the node reference and
//! the list of codes, `cargo xtask picture` draws the picture of the README.

mod bench;
mod codes;
mod dist;
mod docs;
mod picture;
mod sdk;

use std::process::ExitCode;

/// The allocator of the `tenon` binary, so that what is measured is what people run.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

const USAGE: &str = "\
cargo xtask bench chain [CASE]...   measure the chain; one JSON line per figure (docs/benchmarks.md)
cargo xtask bench engine [NODES]... the engine beside its peers, at these sizes or at all
cargo xtask bench abi [CASE]...     what it costs to cross to a plugin, and from a host
cargo xtask bench cancel [CASE]...  how long jobs go on after they were told to stop; FILE.obj is planarized
cargo xtask bench editor [CASE]...  what the editor's window costs
cargo xtask dist [--no-editor]      lay out target/dist as it is installed
cargo xtask docs [--check]          write docs/nodes.md and the codes of docs/diagnostics.md, or only compare
cargo xtask picture                  draw docs/shell-256.svg from graphs/shell-256
cargo xtask screenshots              draw the pictures of the editor in docs/";

fn main() -> ExitCode {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let args: Vec<&str> = args.iter().map(String::as_str).collect();
    let result = match args.as_slice() {
        ["bench", "chain", cases @ ..] => bench::chain::run(cases),
        ["bench", "engine", sizes @ ..] => bench::engine::run(sizes),
        ["bench", "abi", cases @ ..] => bench::abi::run(cases),
        ["bench", "cancel", cases @ ..] => bench::cancel::run(cases),
        ["bench-plugin-host", library, memory] => bench::abi::serve(library, memory),
        ["dist"] => dist::run(true),
        ["dist", "--no-editor"] => dist::run(false),
        ["bench-child", rest @ ..] => bench::growth::child(rest),
        ["picture"] => picture::write(),
        ["screenshots"] => editor(&["run", "-p", "tenon-editor", "--example", "screenshots"]),
        ["bench", "editor", cases @ ..] => {
            editor(&[&["bench", "-p", "tenon-editor", "--bench", "editor", "--"][..], cases].concat())
        }
        ["docs"] => docs::write().and_then(|()| codes::write()),
        ["docs", "--check"] => docs::check().and_then(|()| codes::check()),
        _ => Err(USAGE.to_owned()),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("{message}");
            ExitCode::from(2)
        }
    }
}

/// Lets cargo do something with the editor, so that nothing here depends on it: its window takes minutes to build.
fn editor(arguments: &[&str]) -> Result<(), String> {
    match std::process::Command::new("cargo").args(arguments).current_dir(root()).status() {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => Err(format!("cargo {}: {status}", arguments.join(" "))),
        Err(e) => Err(format!("cargo cannot be called: {e}")),
    }
}

/// The repository's root, whatever the current folder is.
fn root() -> &'static std::path::Path {
    std::path::Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(std::path::Path::new("."))
}
