//! A small shell as a graph, with ways to spoil it.

use serde_json::{Value, json};
use std::collections::HashMap;
use std::io;
use std::sync::Arc;
use tenon_engine::{Control, Diagnostic, Document, Host, Options, Report, Session};

/// Files in memory.
pub struct Files(pub HashMap<&'static str, Vec<u8>>);

impl Host for Files {
    fn read(&self, path: &str) -> io::Result<Arc<[u8]>> {
        match self.0.get(path) {
            Some(bytes) => Ok(bytes.as_slice().into()),
            None => Err(io::ErrorKind::NotFound.into()),
        }
    }
}

/// `{ "from": [source] }`.
pub fn wire(source: &str) -> Value {
    json!({ "from": [source] })
}

/// An arc of four segments swept along a zigzag of four: sixteen panels, with screws, boards, programs and proof.
pub fn shell() -> Value {
    json!({
        "format": "tenon", "version": 1, "units": "mm",
        "nodes": {
            "arc": { "type": "ifs_curve", "v": 1, "params": { "points": [[0, 0, 0], [400, 0, 500], [800, 0, 0]], "iterations": 2 } },
            "zigzag": { "type": "ifs_curve", "v": 1, "params": { "preset": "takagi", "points": [[0, 0, 0], [20, 300, 0], [0, 600, 0]], "iterations": 2 } },
            "surface": { "type": "vector_sum", "v": 1, "inputs": { "a": wire("arc.curve"), "b": wire("zigzag.curve") } },
            "thicken": { "type": "thicken", "v": 1, "params": { "thickness": 10, "left": "plane", "right": "plane" }, "inputs": { "mesh": wire("surface.mesh") } },
            "machine": { "type": "machine", "v": 1 },
            "machining": { "type": "machining", "v": 1 },
            "screws": { "type": "detail", "v": 1, "inputs": { "panels": wire("thicken.panels"), "machine": wire("machine.machine") } },
            "map": { "type": "map", "v": 1, "inputs": { "panels": wire("thicken.panels"), "features": wire("screws.features") } },
            "pack": { "type": "pack", "v": 1, "inputs": { "parts": wire("map.parts"), "machine": wire("machine.machine"), "paths": wire("paths.paths") } },
            "paths": { "type": "toolpath", "v": 1, "inputs": { "parts": wire("map.parts"), "machine": wire("machine.machine"), "machining": wire("machining.machining") } },
            "post": { "type": "post", "v": 1, "inputs": { "paths": wire("paths.paths"), "layout": wire("pack.layout"), "parts": wire("map.parts"), "machine": wire("machine.machine") } },
            "prove": { "type": "prove", "v": 1, "inputs": { "programs": wire("post.programs"), "parts": wire("map.parts"), "layout": wire("pack.layout"), "machine": wire("machine.machine") } },
            "gcode": { "type": "write_gcode", "v": 1, "inputs": { "programs": wire("prove.programs") } }
        }
    })
}

/// Runs a graph on `threads` threads up to `targets`.
pub fn run_on(
    graph: &Value,
    targets: &[&str],
    threads: usize,
    files: HashMap<&'static str, Vec<u8>>,
) -> (Session, Report) {
    let document = Document::from_slice(graph.to_string().as_bytes()).unwrap();
    let host = Arc::new(Files(files));
    let options = Options { threads, host, ..Options::default() };
    let mut session = Session::new(Arc::new(tenon_nodes::registry()), document, options);
    let report = session.evaluate(targets, &Control::default());
    (session, report)
}

/// Runs a graph up to `targets`.
pub fn run(graph: &Value, targets: &[&str]) -> (Session, Report) {
    run_on(graph, targets, 1, HashMap::new())
}

/// The one diagnostic of that code; the test fails if there is none.
#[track_caller]
pub fn told<'a>(report: &'a Report, code: &str) -> &'a Diagnostic {
    match report.diagnostics.iter().find(|d| d.code == code) {
        Some(d) => d,
        None => panic!("no {code} among {:#?}", report.diagnostics),
    }
}
