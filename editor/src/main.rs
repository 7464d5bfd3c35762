//! The desktop program: `tenon-editor [--plugin LIBRARY]... [GRAPH]`.

use std::process::ExitCode;
use tenon_editor::Start;

/// Evaluation frees and takes large blocks all the time.
#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

/// The life of a plugin's process, if that is what this one was started for.
fn serve() -> Option<ExitCode> {
    let arguments: Vec<_> = std::env::args_os().skip(1).collect();
    let [plugin, host, library, memory] = arguments.as_slice() else { return None };
    if plugin != "plugin" || host != "host" {
        return None;
    }
    let Some(memory) = memory.to_str().and_then(|m| m.parse().ok()) else { return Some(ExitCode::from(2)) };
    match tenon_nodes::plugin::apart::serve(library.as_ref(), memory) {
        Ok(never) => match never {},
        Err(why) => {
            eprintln!("{why}");
            Some(ExitCode::from(2))
        }
    }
}

fn main() -> ExitCode {
    if let Some(code) = serve() {
        return code;
    }
    let Some(start) = Start::read(std::env::args_os().skip(1)) else {
        eprintln!("usage: tenon-editor [--plugin LIBRARY]... [GRAPH]");
        return ExitCode::from(2);
    };
    match tenon_editor::run(start) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("the window cannot be opened: {error}");
            if matches!(error, eframe::Error::Wgpu(_)) {
                eprintln!(
                    "  it is drawn through Vulkan, Metal or DirectX: install a driver of the graphics card, or, without a \
                     card, Mesa's lavapipe (Debian: mesa-vulkan-drivers), which draws with the processor"
                );
            }
            ExitCode::from(1)
        }
    }
}
