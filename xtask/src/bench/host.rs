//! What a host pays to set one number, evaluate a chain of ten nodes and read the outcome, through `libtenon`: the program
//! `benches/abi/host.c`. The peer are the same ten steps through plain function pointers.

use super::figure::Figure;
use std::process::Command;

/// Round trips of which the median is told.
const ROUNDS: &str = "20000";

/// The figure, µs. Builds the library and the program, optimised.
pub fn round_trip() -> Result<Figure, String> {
    let root = super::super::root();
    let target = crate::dist::target();
    crate::dist::cargo(&["build", "--release", "--quiet", "-p", "tenon-capi"])?;
    let program = target.join("bench-host");
    let libraries = target.join("release");
    let done = Command::new("cc")
        .args(["-std=gnu11", "-O2", "-Wall", "-Wextra", "-Werror"])
        .arg("-I")
        .arg(root.join("capi/include"))
        .arg("-I")
        .arg(root.join("plugin-sdk/include"))
        .arg(root.join("benches/abi/host.c"))
        .arg("-o")
        .arg(&program)
        .arg("-L")
        .arg(&libraries)
        .arg("-ltenon")
        .arg(format!("-Wl,-rpath,{}", libraries.display()))
        .output()
        .map_err(|e| format!("cc cannot be called: {e}"))?;
    if !done.status.success() {
        return Err(String::from_utf8_lossy(&done.stderr).into_owned());
    }
    let done = Command::new(&program).arg(ROUNDS).output().map_err(|e| format!("{}: {e}", program.display()))?;
    let told = String::from_utf8_lossy(&done.stdout);
    let numbers: Vec<f64> = told.split_whitespace().filter_map(|n| n.parse().ok()).collect();
    let (true, [ours, theirs]) = (done.status.success(), numbers.as_slice()) else {
        return Err(format!("{}: {}{told}", done.status, String::from_utf8_lossy(&done.stderr)));
    };
    Ok(Figure {
        suite: "abi",
        case: "host",
        size: 10,
        ours: ours / 1e3,
        unit: "us",
        peer: Some("plain function pointers".into()),
        theirs: Some(theirs / 1e3),
        target: Some(20.0),
    })
}
