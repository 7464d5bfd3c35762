//! Programs of other people that are measured in the same run.

use crate::root;
use serde_json::Value;
use std::process::Command;

/// The peer of the curve and the vector sum.
pub struct Numpy {
    /// "numpy 2.1.0 IFS tree".
    pub name: String,
    /// Curve of 2^iterations segments, ms.
    pub curve_ms: f64,
    /// Vector sum of points² vertices, ms.
    pub vector_sum_ms: f64,
}

/// Runs `benches/ifs_tree.py` with the first Python that has numpy: `$PYTHON`, the tests' environment, `python3`.
/// `None`, with a line on stderr, if there is none.
pub fn numpy(iterations: u32, points: u32) -> Option<Numpy> {
    let own = std::env::var("PYTHON").ok();
    let tools = std::env::var_os("TENON_TEST_TOOLS").map_or_else(|| root().join("target/tools"), Into::into);
    let tests = tools.join("venv/bin/python").display().to_string();
    let pythons = own.into_iter().chain([tests, "python3".to_owned()]);
    for python in pythons {
        let Some(version) = output(Command::new(&python).args(["-c", "import numpy; print(numpy.__version__)"])) else {
            continue;
        };
        let script = root().join("benches/ifs_tree.py");
        let line = output(Command::new(&python).arg(script).args([iterations.to_string(), points.to_string()]))?;
        let json: Value = serde_json::from_str(&line).ok()?;
        return Some(Numpy {
            name: format!("numpy {} IFS tree", version.trim()),
            curve_ms: json["curve_s"].as_f64()? * 1e3,
            vector_sum_ms: json["vector_sum_s"].as_f64()? * 1e3,
        });
    }
    eprintln!("no Python with numpy: the peer is null (set PYTHON to one that has it)");
    None
}

/// What a command prints, if it succeeds.
fn output(command: &mut Command) -> Option<String> {
    let output = command.output().ok()?;
    output.status.success().then(|| String::from_utf8_lossy(&output.stdout).into_owned())
}
