//! The desktop program: `tenon-editor [--plugin LIBRARY]... [GRAPH]`.

use std::process::ExitCode;
use tenon_editor::Start;

/// Evaluation frees and takes large blocks all the time.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn main() -> ExitCode {
    let Some(start) = Start::read(std::env::args_os().skip(1)) else {
        eprintln!("usage: tenon-editor [--plugin LIBRARY]... [GRAPH]");
        return ExitCode::from(2);
    };
    match tenon_editor::run(start) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("the window cannot be opened: {error}");
            ExitCode::from(1)
        }
    }
}
