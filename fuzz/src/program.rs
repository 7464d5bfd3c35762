//! G-code: motions in the order of their lines with finite numbers, or the line that is refused.

use std::sync::LazyLock;
use tenon_nodes::post::{MachineFile, machine_preset, machine_presets, parse_program};

pub fn check(bytes: &[u8]) {
    static MACHINES: LazyLock<Vec<MachineFile>> =
        LazyLock::new(|| machine_presets().filter_map(|name| machine_preset(name).ok()).collect());
    let lines = bytes.split(|b| *b == b'\n').count() as u32;
    for file in MACHINES.iter() {
        match parse_program(bytes, &file.machine) {
            Ok(motions) => {
                assert!(motions.len() as u32 <= lines);
                assert!(motions.windows(2).all(|w| w[0].line < w[1].line), "one motion a line, in order");
                for m in motions {
                    assert!(m.line >= 1 && m.line <= lines);
                    assert!(m.linear.is_finite() && m.angles.iter().all(|a| a.is_finite()), "{m:?}");
                    assert!(m.feed.is_finite() && m.speed.is_finite() && m.speed >= 0.0, "{m:?}");
                    assert!(m.rapid || m.feed > 0.0, "{m:?}");
                }
            }
            Err(e) => assert!(e.line >= 1 && e.line <= lines && !e.problem.is_empty(), "{e}"),
        }
    }
}
