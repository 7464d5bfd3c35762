//! What runs again and what does not: every rule by the log of events.

use crate::common::*;
use serde_json::json;
use std::sync::{Arc, Mutex};
use tenon_engine::*;

fn chain() -> Json {
    json!({
        "a": {"type": "number", "params": {"value": 1.2}},
        "b": {"type": "floor", "inputs": {"a": {"from": ["a.value"]}}},
        "c": {"type": "add", "inputs": {"a": {"from": ["b.value"]}}},
        "d": {"type": "number", "params": {"value": 5}},
        "e": {"type": "add", "inputs": {"a": {"from": ["c.sum"]}, "b": {"from": ["d.value"]}}},
    })
}

#[test]
fn nothing_changed_nothing_runs() {
    let mut s = session(chain());
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "executed a, executed d, executed b, executed c, executed e");
    let report = evaluate(&mut s, &[]);
    assert_eq!((log(&mut s), report.nodes.len()), (String::new(), 0));
}

#[test]
fn an_output_that_stays_the_same_cuts_off_everything_behind_it() {
    let mut s = session(chain());
    evaluate(&mut s, &[]);
    log(&mut s);
    s.set("a.value", json!(1.7)).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "executed a, executed b, cut off b");
}

#[test]
fn a_slider_back_and_forth_hits_the_memo() {
    let mut s = session(chain());
    evaluate(&mut s, &[]);
    s.set("a.value", json!(2.2)).expect("accepted");
    evaluate(&mut s, &[]);
    log(&mut s);
    s.set("a.value", json!(1.2)).expect("accepted");
    let report = evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "memo a, memo b, memo c, memo e");
    assert!(report.nodes.iter().all(|n| n.happened == Happened::Memo));
    assert_eq!(items(&s, "e.sum"), json!([6.0]));
}

#[test]
fn setting_the_same_value_again_is_cut_off_at_once() {
    let mut s = session(chain());
    evaluate(&mut s, &[]);
    log(&mut s);
    s.set("a.value", json!(1.2)).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "cut off a");
}

#[test]
fn only_what_is_asked_for_runs_and_the_rest_catches_up_later() {
    let mut s = session(chain());
    evaluate(&mut s, &["b.value"]);
    assert_eq!(log(&mut s), "executed a, executed b");
    s.set("a.value", json!(3)).expect("accepted");
    evaluate(&mut s, &["d.value"]);
    assert_eq!(log(&mut s), "executed d");
    evaluate(&mut s, &["e.sum"]);
    assert_eq!(log(&mut s), "executed a, executed b, executed c, executed e");
    assert_eq!(items(&s, "e.sum"), json!([8.0]));
}

#[test]
fn two_nodes_with_the_same_inputs_share_a_result() {
    let mut s = session(json!({"a": {"type": "number", "params": {"value": 4}}, "b": {"type": "number"}}));
    evaluate(&mut s, &[]);
    log(&mut s);
    s.set("b.value", json!(4)).expect("accepted");
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "memo b");
}

#[test]
fn evicted_values_keep_their_digest_and_come_back_when_somebody_reads_them() {
    let options = Options { cache_bytes: 0, ..Options::default() };
    let mut s = Session::new(registry(), document(chain()), options);
    evaluate(&mut s, &["e.sum"]);
    assert_eq!(
        log(&mut s),
        "executed a, executed d, executed b, executed c, executed e, evicted a, evicted b, evicted c, evicted d"
    );
    assert_eq!(items(&s, "e.sum"), json!([6.0]));
    // Cut off by digest although no value is there.
    s.set("a.value", json!(1.5)).expect("accepted");
    evaluate(&mut s, &["e.sum"]);
    assert_eq!(log(&mut s), "executed a, executed b, cut off b, evicted a, evicted b");
    // A change at the side needs c again, which needs what c is made of.
    s.set("d.value", json!(6)).expect("accepted");
    evaluate(&mut s, &["e.sum"]);
    assert_eq!(items(&s, "e.sum"), json!([7.0]));
    let text = log(&mut s);
    assert!(text.contains("executed a") && text.contains("executed c") && text.contains("executed e"), "{text}");
    // And a value that was dropped can be asked for.
    evaluate(&mut s, &["b.value"]);
    assert_eq!(items(&s, "b.value"), json!([1.0]));
}

#[test]
fn a_new_version_of_the_document_runs_only_what_is_new() {
    let mut s = session(chain());
    evaluate(&mut s, &[]);
    log(&mut s);
    let mut nodes = chain();
    nodes["f"] = json!({"type": "floor", "inputs": {"a": {"from": ["e.sum"]}}});
    s.replace(document(nodes));
    evaluate(&mut s, &["f.value"]);
    assert_eq!(log(&mut s), "cut off a, cut off d, cut off b, cut off c, cut off e, executed f");
}

struct Disk(Mutex<Vec<u8>>);

impl Host for Disk {
    fn read(&self, path: &str) -> std::io::Result<Arc<[u8]>> {
        match path {
            "in.txt" => Ok(Arc::from(self.0.lock().map(|b| b.clone()).unwrap_or_default())),
            _ => Err(std::io::Error::new(std::io::ErrorKind::NotFound, "no such file")),
        }
    }
}

#[test]
fn files_count_by_content() {
    let disk = Arc::new(Disk(Mutex::new(b"abc".to_vec())));
    let nodes = json!({
        "r": {"type": "read", "params": {"path": "in.txt"}},
        "w": {"type": "write", "inputs": {"size": {"from": ["r.size"]}}},
    });
    let mut s = Session::new(registry(), document(nodes), Options { host: disk.clone(), ..Options::default() });
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "executed r, executed w");
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "cut off r");
    *disk.0.lock().expect("nobody panicked") = b"abcd".to_vec();
    evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "executed r, executed w");
    let files = s.files();
    assert_eq!(files.len(), 1);
    assert_eq!((files[0].0.as_str(), &*files[0].1.name, files[0].1.bytes.len()), ("w.file", "a.txt", 4));
    s.set("r.path", json!("gone.txt")).expect("accepted");
    let report = evaluate(&mut s, &[]);
    assert_eq!(lines(&report)[0], "error[unreadable-file] r.path: cannot read \"gone.txt\": no such file");
    assert!(s.files().is_empty());
}
