//! Values that a program gives in memory: they stand like literals, are not part of the document, and give way to what is
//! set later.

use crate::common::*;
use serde_json::json;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use tenon_engine::*;

fn graph() -> (Draft, Session) {
    let s = session(json!({
        "a": { "type": "number" },
        "b": { "type": "add", "params": { "b": 1 }, "inputs": { "a": { "from": ["a.value"] } } }
    }));
    let draft = Draft::new(s.registry().clone(), Arc::new(NoHost), s.document().clone());
    (draft, s)
}

fn give(draft: &Draft, s: &mut Session, name: &str, tree: Tree) -> Result<(), Diagnostic> {
    draft.given(name, &tree)?.iter().for_each(|g| s.give(g));
    Ok(())
}

#[test]
fn a_given_list_maps_over_the_node_and_survives_edits_elsewhere() {
    let (draft, mut s) = graph();
    give(&draft, &mut s, "a.value", Tree::list(vec![1.0, 2.0, 3.0])).unwrap();
    assert!(!evaluate(&mut s, &["b.sum"]).has_errors());
    assert_eq!(items(&s, "b.sum"), json!([2.0, 3.0, 4.0]));
    // The plan is made anew for this.
    s.edit(&Operation::AddNode { id: "c".into(), node: Box::new(Node::new("number")) }).unwrap();
    s.set("b.b", json!(10)).unwrap();
    evaluate(&mut s, &["b.sum"]);
    assert_eq!(items(&s, "b.sum"), json!([11.0, 12.0, 13.0]));
    let saved: Json = s.document().to_string_canonical_for(s.registry()).parse().unwrap();
    assert_eq!((saved["nodes"]["a"].get("params"), &saved["nodes"]["b"]["params"]["b"]), (None, &json!(10)));
}

#[test]
fn what_is_set_later_overrules_it() {
    for by_edit in [false, true] {
        let (draft, mut s) = graph();
        give(&draft, &mut s, "a.value", Tree::item(5.0)).unwrap();
        evaluate(&mut s, &["b.sum"]);
        assert_eq!(items(&s, "b.sum"), json!([6.0]));
        if by_edit {
            let set = |value: Option<Json>| Operation::SetParam { node: "a".into(), port: "value".into(), value };
            s.edit(&set(Some(json!(7)))).unwrap();
        } else {
            s.set("a.value", json!(7)).unwrap();
        }
        s.edit(&Operation::AddNode { id: "c".into(), node: Box::new(Node::new("number")) }).unwrap();
        evaluate(&mut s, &["b.sum"]);
        assert_eq!(items(&s, "b.sum"), json!([8.0]));
    }
}

#[test]
fn what_does_not_fit_is_refused_with_its_place() {
    let (draft, mut s) = graph();
    let said = |r: Result<(), Diagnostic>| r.unwrap_err().to_string();
    let text = Tree::item(Text::from("x"));
    assert!(said(give(&draft, &mut s, "a.value", text)).contains("takes number, but text came in"));
    assert!(said(give(&draft, &mut s, "b.a", Tree::item(1.0))).contains("b.a has a wire"));
    assert!(said(give(&draft, &mut s, "a.valu", Tree::item(1.0))).contains("did you mean \"value\""));
    assert!(said(give(&draft, &mut s, "a.value", Tree::item(f64::NAN))).contains("not a finite number"));
    // Integers are converted, as on a wire.
    give(&draft, &mut s, "a.value", Tree::item(4_i64)).unwrap();
    evaluate(&mut s, &["b.sum"]);
    assert_eq!(items(&s, "b.sum"), json!([5.0]));
}

/// Counts how often it is dropped.
struct Lender(Vec<f64>, Arc<AtomicUsize>);

impl AsRef<[f64]> for Lender {
    fn as_ref(&self) -> &[f64] {
        &self.0
    }
}

impl Drop for Lender {
    fn drop(&mut self) {
        self.1.fetch_add(1, Ordering::Relaxed);
    }
}

#[test]
fn lent_items_are_read_in_place_and_given_back() {
    let back = Arc::new(AtomicUsize::new(0));
    let owned = vec![1.0, 2.0];
    let address = owned.as_ptr();
    let column = Column::lent(Lender(owned, back.clone()));
    assert_eq!(column.slice::<f64>().map(<[f64]>::as_ptr), Some(address));
    assert_eq!(column.digest(), Column::new(vec![1.0, 2.0]).digest());
    let kept = column.clone();
    drop(column);
    assert_eq!(back.load(Ordering::Relaxed), 0);
    drop(kept);
    assert_eq!(back.load(Ordering::Relaxed), 1);
}
