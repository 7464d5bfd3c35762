//! The shell of `graphs/shell-256` at any size: drawn larger in the same measure, so that its panels keep their size
//! and every panel its joints.

use crate::root;
use serde_json::{Value, json};
use std::sync::Arc;
use tenon_engine::{Control, Diagnostic, Document, Options, Registry, Report, Session, Severity};
use tenon_geometry::panel::PanelSet;
use tenon_nodes::value::V;

const GRAPH: &str = "graphs/shell-256/shell-256.tenon.json";

/// Panels along one side of the graph as it stands.
const SIDE: f64 = 16.0;

/// Threads of every session that is measured.
const THREADS: usize = 2;

/// How large a shell is: patches of 16 segments along the arc, iterations of the folds.
#[derive(Clone, Copy, Debug)]
pub struct Size {
    /// Pieces of the arc.
    pub patches: u32,
    /// Iterations of the folded curve: 2^folds segments.
    pub folds: u32,
}

impl Size {
    /// The graph as it stands: 256 panels.
    pub const STANDS: Self = Self { patches: 1, folds: 4 };

    /// A thousand panels, ten thousand and a hundred thousand.
    pub const GROWTH: [Self; 3] =
        [Self { patches: 2, folds: 5 }, Self { patches: 5, folds: 7 }, Self { patches: 25, folds: 8 }];

    /// As few panels as there can be: one row.
    pub const LEAST: Self = Self { patches: 1, folds: 0 };

    /// Number of panels.
    pub fn panels(self) -> u64 {
        (u64::from(self.patches) * 16) << self.folds
    }
}

/// The graph's text at a size.
pub fn text(size: Size) -> Result<String, String> {
    let path = root().join(GRAPH);
    let text = std::fs::read_to_string(&path).map_err(|e| format!("{}: {e}", path.display()))?;
    let mut graph: Value = serde_json::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?;
    let odd = || format!("{GRAPH} is not built as the bench expects: xtask/src/bench/shell.rs");
    let nodes = graph.get_mut("nodes").ok_or_else(odd)?;

    let arc = nodes.pointer_mut("/arc/params").ok_or_else(odd)?;
    let points: Vec<[f64; 3]> = serde_json::from_value(arc["points"].clone()).map_err(|_| odd())?;
    let points: [[f64; 3]; 4] = points.try_into().map_err(|_| odd())?;
    arc["points"] = json!(split(points, size.patches, f64::from(size.patches)));
    arc["iterations"] = json!(4);
    arc["degree"] = json!(3);

    let folds = nodes.pointer_mut("/folds/params").ok_or_else(odd)?;
    folds["iterations"] = json!(size.folds);
    let level = size.folds as i32 - 4;
    let scale = f64::from(1 << size.folds) / SIDE;
    // The graph's folds shrink to 0.8 with each iteration: the finest ones stay as deep as they were.
    let depth = 0.8_f64.powi(-level);
    for (node, port, factor) in [("fold_2", "x", depth), ("fold_2", "y", scale), ("fold_3", "y", scale)] {
        let value = nodes.pointer_mut(&format!("/{node}/params/{port}")).ok_or_else(odd)?;
        *value = json!(value.as_f64().ok_or_else(odd)? * factor);
    }
    Ok(graph.to_string())
}

/// A cubic Bézier curve as `patches` chained ones of equal parameter length, its points times `scale`: the blossom at
/// the patches' ends (Ramshaw 1987).
fn split(points: [[f64; 3]; 4], patches: u32, scale: f64) -> Vec<[f64; 3]> {
    let mix = |a: [f64; 3], b: [f64; 3], t: f64| [0, 1, 2].map(|k| a[k] + t * (b[k] - a[k]));
    let blossom = |r: f64, s: f64, t: f64| {
        let [a, b, c] = [0, 1, 2].map(|i| mix(points[i], points[i + 1], r));
        let [a, b] = [mix(a, b, s), mix(b, c, s)];
        mix(a, b, t).map(|x| x * scale)
    };
    let mut out = vec![blossom(0.0, 0.0, 0.0)];
    for i in 0..patches {
        let (a, b) = (f64::from(i) / f64::from(patches), f64::from(i + 1) / f64::from(patches));
        out.extend([blossom(a, a, b), blossom(a, b, b), blossom(b, b, b)]);
    }
    out
}

/// A fresh session of the graph `text` that keeps all its results; nothing has run.
pub fn session(registry: &Arc<Registry>, text: &str) -> Result<Session, String> {
    let document = Document::from_slice(text.as_bytes()).map_err(|d| format!("{d:?}"))?;
    let options = Options { threads: THREADS, cache_bytes: 1 << 40, ..Options::default() };
    Ok(Session::new(registry.clone(), document, options))
}

/// Evaluates one value, which must come out.
pub fn evaluate(session: &mut Session, target: &str) -> Result<Report, String> {
    let report = session.evaluate(&[target], &Control::default());
    if session.value(target).is_some() {
        return Ok(report);
    }
    let reasons: Vec<String> = errors(&report).take(3).map(ToString::to_string).collect();
    Err(format!("{target} cannot be measured: {}", reasons.join("; ")))
}

/// The number of panels that a session makes, which must be the size's.
pub fn check_count(session: &mut Session, size: Size) -> Result<(), String> {
    const PANELS: &str = "thicken.panels";
    evaluate(session, PANELS)?;
    let made = session.value(PANELS).and_then(|t| t.first::<V<PanelSet>>().map(|p| p.len() as u64));
    match made {
        Some(made) if made == size.panels() => Ok(()),
        made => Err(format!("the graph makes {made:?} panels instead of {}", size.panels())),
    }
}

/// What went wrong in an evaluation.
pub fn errors(report: &Report) -> impl Iterator<Item = &Diagnostic> {
    report.diagnostics.iter().filter(|d| d.severity == Severity::Error)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_split_curve_is_the_same_curve() {
        let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 3.0], [2.0, 1.0, 5.0], [4.0, 0.0, 0.0]];
        assert_eq!(split(points, 1, 1.0), points);
        let halves = split(points, 2, 1.0);
        assert_eq!(halves.len(), 7);
        // De Casteljau by hand at 1/2.
        assert_eq!(halves[3], [(0.0 + 3.0 + 6.0 + 4.0) / 8.0, 3.0 / 8.0, (9.0 + 15.0) / 8.0]);
        assert_eq!((halves[0], halves[6]), (points[0], points[3]));
        assert_eq!(split(points, 2, 2.0)[3], halves[3].map(|x| 2.0 * x));
    }

    #[test]
    fn the_graph_as_it_stands_is_its_own_size() {
        let path = root().join(GRAPH);
        let stands: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let first: Value = serde_json::from_str(&text(Size::STANDS).unwrap()).unwrap();
        for pointer in ["/nodes/fold_2/params", "/nodes/fold_3/params", "/nodes/thicken", "/nodes/pack"] {
            let numbers = |v: &Value| v.to_string().replace(".0", "");
            assert_eq!(numbers(first.pointer(pointer).unwrap()), numbers(stands.pointer(pointer).unwrap()));
        }
        assert_eq!(Size::STANDS.panels(), 256);
        assert_eq!(Size::GROWTH.map(Size::panels), [1024, 10_240, 102_400]);
    }
}
