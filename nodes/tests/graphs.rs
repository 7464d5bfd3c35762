//! The graphs that Tenon ships do what they say, and foreign meshes go through the whole chain.

use serde_json::{Value, json};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_engine::{Control, Document, Host, Options, Report, Session};
use tenon_geometry::DVec3;
use tenon_geometry::panel::{PanelSet, Side};
use tenon_geometry::proof::ProofReport;
use tenon_nodes::value::V;

/// Files beside the graph, or anywhere by absolute path.
pub struct Beside(pub PathBuf);

impl Host for Beside {
    fn read(&self, path: &str) -> io::Result<Arc<[u8]>> {
        std::fs::read(self.0.join(path)).map(Into::into)
    }
}

/// A shipped graph, and what reads its files.
pub fn document(graph: &str) -> (Document, Arc<dyn Host>) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../graphs").join(graph);
    let bytes = std::fs::read(folder.join(format!("{graph}.tenon.json"))).unwrap();
    (Document::from_slice(&bytes).unwrap(), Arc::new(Beside(folder)))
}

fn run(graph: &str, set: &[(&str, Value)]) -> (Session, Report) {
    let (document, host) = document(graph);
    let options = Options { host, ..Options::default() };
    let mut session = Session::new(Arc::new(tenon_nodes::registry()), document, options);
    for (name, value) in set {
        session.set(name, value.clone()).unwrap();
    }
    let report = session.evaluate(&[], &Control::default());
    (session, report)
}

fn panels(session: &Session) -> V<PanelSet> {
    session.value("panels").unwrap().first::<V<PanelSet>>().unwrap().clone()
}

/// Everything ran without an error, all programs are proven and have their final names.
fn proven(session: &Session, report: &Report) -> V<ProofReport> {
    assert!(!report.has_errors(), "{:#?}", report.diagnostics);
    let proof = session.value("proof").unwrap().first::<V<ProofReport>>().unwrap().clone();
    assert!(proof.passed() && !proof.programs.is_empty());
    assert!(proof.gouge() <= 0.005 && proof.leftover() <= 0.05, "{} {}", proof.gouge(), proof.leftover());
    assert!(session.files().iter().all(|(_, file)| file.withheld.is_none()));
    proof
}

fn integer(session: &Session, name: &str) -> i64 {
    *session.value(name).unwrap().first::<i64>().unwrap()
}

#[test]
fn shell_256_is_the_third_prototype() {
    let (session, report) = run("shell-256", &[]);
    let proof = proven(&session, &report);
    let set = panels(&session);
    assert_eq!((set.len(), set.thickness), (256, 10.0));
    assert!((0..256).all(|i| set.is_valid(i)));
    assert!(integer(&session, "boards") <= 4);
    assert_eq!(proof.parts.iter().flatten().count(), 256);
    for row in 0..16 {
        // v1 of the first panel and v2 of the last one stand on the supports.
        let (first, last) = (set.corners(row * 16).start, set.corners(row * 16 + 15).start + 1);
        let span = set.front[last] - set.front[first];
        assert!((span - DVec3::new(4500.0, 0.0, 0.0)).length() < 1e-9, "row {row} spans {span}");
    }
    for i in 0..set.len() {
        for k in set.corners(i).filter(|k| set.neighbour[*k].get().is_none()) {
            match set.side[k] {
                // Supports are cut horizontally…
                Side::Left | Side::Right => {
                    assert!(set.chamfer[k].normal.cross(DVec3::Z).length() < 1e-9, "panel {i}: {:?}", set.chamfer[k]);
                }
                // … and sides square.
                _ => assert!(set.chamfer[k].normal.dot(set.normal[i]).abs() < 1e-9, "panel {i}: {:?}", set.chamfer[k]),
            }
        }
    }
    // Toe screws on every inner edge: both panels of it are drilled.
    let inner = set.neighbour.iter().filter_map(|n| n.get()).count() / 2;
    let count = integer(&session, "screws.count");
    assert!(count >= inner as i64, "{count} screws on {inner} inner edges");
}

#[test]
fn shell_256_obeys_its_inputs() {
    let inputs =
        [("iterations", json!(2)), ("thickness", json!(12)), ("fold_depth", json!(10)), ("screw_spacing", json!(400))];
    let (session, report) = run("shell-256", &inputs);
    proven(&session, &report);
    let set = panels(&session);
    assert_eq!((set.len(), set.thickness), (16, 12.0));
}

#[test]
fn shell_21mm_leans_both_ways() {
    let (session, report) = run("shell-21mm", &[]);
    proven(&session, &report);
    let set = panels(&session);
    assert_eq!((set.len(), set.thickness), (256, 21.0));
    let lean = |i: usize, k: usize| set.chamfer[k].normal.dot(set.normal[i]).asin().to_degrees();
    let leans = || (0..set.len()).flat_map(|i| set.corners(i).map(move |k| (i, k))).map(|(i, k)| lean(i, k));
    let (least, most) = leans().fold((f64::MAX, f64::MIN), |(a, b), l| (a.min(l), b.max(l)));
    assert!(least < -5.0 && most > 5.0, "chamfers lean from {least}° to {most}°");
}

#[test]
fn quad_mesh_takes_what_it_ships() {
    let (session, report) = run("quad-mesh", &[]);
    proven(&session, &report);
    assert_eq!(panels(&session).len(), 96);
    assert!(*session.value("deviation").unwrap().first::<f64>().unwrap() <= 1e-4);
}

#[test]
fn quad_mesh_takes_foreign_meshes() {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/meshes");
    if !data.exists() && std::env::var_os("CI").is_none() {
        println!("skipped: there are no foreign meshes at {}", data.display());
        return;
    }
    for (name, unit, faces) in [("quadmesh", 1000.0, 81), ("rhinomesh", 1000.0, 100), ("faces", 500.0, 25)] {
        let path = data.join(format!("{name}.obj"));
        let (session, report) = run("quad-mesh", &[("mesh", json!(path)), ("unit", json!(unit))]);
        proven(&session, &report);
        assert_eq!(panels(&session).len(), faces, "{name}");
        assert!(*session.value("deviation").unwrap().first::<f64>().unwrap() <= 1e-4, "{name}");
    }
}
