//! OBJ files: read back bit by bit, and any mesh that is read goes through ordering and thickening without a fault of ours.

use super::{check_report, registry};
use std::io;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};
use tenon_engine::{Control, Document, Host, Options, Session};
use tenon_nodes::io::{read_obj, write_obj};

/// Longest file that goes through the nodes.
const LONGEST: usize = 8192;

struct One(Mutex<Arc<[u8]>>);

impl Host for One {
    fn read(&self, _: &str) -> io::Result<Arc<[u8]>> {
        Ok(self.0.lock().unwrap_or_else(PoisonError::into_inner).clone())
    }
}

pub fn check(bytes: &[u8]) {
    let Ok(mesh) = read_obj(bytes, 1.0) else { return };
    let points = mesh.points.len();
    assert!(mesh.face_vertices.iter().all(|v| (*v as usize) < points), "a corner without its vertex");
    assert_eq!(mesh.face_start.last().map(|n| *n as usize), Some(mesh.face_vertices.len()));
    let again =
        read_obj(&write_obj(&mesh, &|| true), 1.0).unwrap_or_else(|e| panic!("what was written is not read: {e}"));
    assert_eq!(again.face_vertices, mesh.face_vertices);
    // Adding nothing turns -0 into 0.
    assert!(again.points.iter().zip(&mesh.points).all(|(a, b)| a == b));
    if bytes.len() > LONGEST {
        return;
    }
    static GRAPH: LazyLock<Document> = LazyLock::new(|| {
        let text = br#"{"format": "tenon", "nodes": {
            "m": {"type": "read_mesh", "params": {"path": "any"}},
            "o": {"type": "order_faces", "inputs": {"mesh": {"from": ["m.mesh"]}}},
            "t": {"type": "thicken", "inputs": {"mesh": {"from": ["o.mesh"]}}}}}"#;
        Document::from_slice(text).unwrap_or_default()
    });
    let host = Arc::new(One(Mutex::new(bytes.into())));
    let options = Options { threads: 1, host, ..Options::default() };
    let mut session = Session::new(registry().clone(), GRAPH.clone(), options);
    check_report(&session.evaluate(&[], &Control::default()));
    for name in ["m.mesh", "o.mesh", "t.panels"] {
        if let Some(tree) = session.value(name) {
            assert!(!tree.summary().is_empty());
        }
    }
}
