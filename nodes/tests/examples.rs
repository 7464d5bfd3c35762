//! The small graphs that show what nodes are for: one per family, and no node that is shown nowhere.

use crate::graphs::Beside;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_engine::{Control, Document, Expectations, Options, Session, Severity};

/// Graph files in one folder of `graphs/`.
fn files_in(folder: &Path) -> Vec<PathBuf> {
    let entries = folder.read_dir().unwrap().map(|e| e.unwrap().path());
    let mut files: Vec<PathBuf> = entries.filter(|p| p.to_str().unwrap().ends_with(".tenon.json")).collect();
    files.sort();
    files
}

fn graphs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../graphs")
}

fn load(file: &Path) -> Document {
    Document::from_slice(&std::fs::read(file).unwrap()).unwrap()
}

#[test]
fn small_graphs_come_to_what_is_expected_of_them() {
    let files = files_in(&graphs().join("nodes"));
    let told = std::fs::read_to_string(graphs().join("README.md")).unwrap();
    assert!(files.len() >= 14, "{files:?}");
    for file in files {
        assert!(told.contains(&format!("(nodes/{})", file.file_name().unwrap().display())), "{file:?} is not told of");
        let document = load(&file);
        let name = file.display();
        let options = Options { host: Arc::new(Beside(file.parent().unwrap().to_owned())), ..Options::default() };
        let notes = document.nodes().values().filter(|n| n.type_name.as_str() == "note").count();
        let nodes = document.nodes().len();
        assert!(nodes <= 20, "{name}: {nodes} nodes are more than a newcomer takes in");
        let mut session = Session::new(Arc::new(tenon_nodes::registry()), document, options);
        let report = session.evaluate(&[], &Control::default());
        let wrong: Vec<_> = report.diagnostics.iter().filter(|d| d.severity != Severity::Note).collect();
        assert!(wrong.is_empty(), "{name}: {wrong:#?}");
        // Without targets only what leads to an output or a file runs: no node stands there for nothing.
        let ran: BTreeSet<&str> = report.nodes.iter().map(|n| n.id).collect();
        let idle: Vec<&String> = session.document().nodes().keys().filter(|id| !ran.contains(id.as_str())).collect();
        assert_eq!(idle.len(), notes, "{name}: {idle:?} lead to no output");

        let beside = file.to_str().unwrap().replace(".tenon.json", ".expect.json");
        let expected = Expectations::from_slice(&std::fs::read(&beside).unwrap()).unwrap();
        let outputs: Vec<&String> = session.document().outputs.keys().collect();
        assert_eq!(outputs, expected.outputs.keys().collect::<Vec<_>>(), "{beside}");
        for outcome in expected.check(&session, &report) {
            assert_eq!(outcome.failures, [""; 0], "{name}: {}", outcome.name);
        }
    }
}

#[test]
fn every_built_in_node_is_used_in_a_graph() {
    let folders = graphs().read_dir().unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_dir());
    let used: BTreeSet<String> = folders
        .flat_map(|f| files_in(&f))
        .flat_map(|f| load(&f).nodes().values().map(|n| n.type_name.to_string()).collect::<Vec<_>>())
        .collect();
    let registry = tenon_nodes::registry();
    let unused: Vec<&str> = registry.iter().map(|n| n.type_name()).filter(|t| !used.contains(*t)).collect();
    assert_eq!(unused, [""; 0], "no graph under graphs/ shows what they are for");
}
