//! One thread and several, once and again: the same bytes.

use crate::common::{run_on, shell};
use std::collections::HashMap;

#[test]
fn any_number_of_threads_gives_the_same_programs() {
    let once = |threads| {
        let (session, report) = run_on(&shell(), &["gcode.files", "prove.report"], threads, HashMap::new());
        assert!(!report.has_errors(), "{:#?}", report.diagnostics);
        let files: Vec<(String, Vec<u8>)> =
            session.files().iter().map(|(_, f)| (f.name.to_string(), f.bytes.to_vec())).collect();
        let digests: Vec<(String, u128)> = report.nodes.iter().map(|n| (n.id.to_string(), n.digest)).collect();
        (files, digests)
    };
    let first = once(1);
    assert!(!first.0.is_empty());
    for threads in [1, 2, 3] {
        assert!(once(threads) == first, "{threads} threads differ");
    }
}
