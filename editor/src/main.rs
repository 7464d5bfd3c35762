//! The desktop program: `tenon-editor [GRAPH]`.

use std::path::PathBuf;
use std::process::ExitCode;

/// Evaluation frees and takes large blocks all the time.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    let mut arguments = std::env::args_os().skip(1);
    let graph = arguments.next().map(PathBuf::from);
    if arguments.next().is_some() || graph.as_deref().is_some_and(|g| g.to_str().is_some_and(|g| g.starts_with('-'))) {
        eprintln!("usage: tenon-editor [GRAPH]");
        return ExitCode::from(2);
    }
    match tenon_editor::run(graph) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("the window cannot be opened: {error}");
            ExitCode::from(1)
        }
    }
}
