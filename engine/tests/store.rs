//! Results that outlive the process: what is kept, what comes back, and what is wrong with a store.

use crate::common::*;
use proptest::prelude::*;
use serde_json::json;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::Duration;
use tenon_engine::*;

/// Keeps everything, whatever it cost.
#[derive(Default)]
struct Shelf {
    kept: Mutex<BTreeMap<u128, Vec<u8>>>,
    full: AtomicBool,
}

impl Store for Shelf {
    fn get(&self, key: u128) -> Result<Option<Vec<u8>>, StoreFault> {
        match self.kept.lock().unwrap().get(&key) {
            Some(bytes) if bytes.is_empty() => {
                Err(StoreFault::Damaged { place: self.place(key), why: "it is empty".into() })
            }
            found => Ok(found.cloned()),
        }
    }

    fn put(&self, key: u128, bytes: &[u8]) -> Result<(), StoreFault> {
        if self.full.load(Ordering::Relaxed) {
            return Err(StoreFault::Failed { place: "the shelf".into(), why: "it is full".into() });
        }
        self.kept.lock().unwrap().insert(key, bytes.to_vec());
        Ok(())
    }

    fn place(&self, key: u128) -> String {
        format!("board {key:032x}")
    }

    fn is_worth(&self, _: Duration, _: usize) -> bool {
        true
    }
}

impl Shelf {
    fn change(&self, change: impl Fn(&mut Vec<u8>)) {
        self.kept.lock().unwrap().values_mut().for_each(change);
    }
}

/// A session as a new process would have it.
fn fresh(nodes: Json, shelf: &Arc<Shelf>) -> Session {
    let store: Arc<dyn Store> = shelf.clone();
    Session::new(registry(), document(nodes), Options { store: Some(store), ..Options::default() })
}

fn chain() -> Json {
    json!({
        "a": {"type": "number", "params": {"value": 1.25}},
        "b": {"type": "add", "inputs": {"a": {"from": ["a.value"]}}, "params": {"b": 2}},
        "c": {"type": "root", "inputs": {"a": {"from": ["b.sum"]}}},
    })
}

#[test]
fn another_process_takes_everything_from_the_store() {
    let shelf = Arc::new(Shelf::default());
    let mut first = fresh(chain(), &shelf);
    let before = evaluate(&mut first, &[]);
    assert_eq!(log(&mut first), "executed a, executed b, executed c");
    let mut second = fresh(chain(), &shelf);
    let report = evaluate(&mut second, &[]);
    assert_eq!(log(&mut second), "disk a, disk b, disk c");
    assert!(report.nodes.iter().all(|n| n.happened == Happened::Disk));
    assert_eq!(report.to_json()["nodes"][0]["happened"], "disk");
    let digests = |r: &Report| r.nodes.iter().map(|n| (n.id.to_owned(), n.digest)).collect::<Vec<_>>();
    assert_eq!(digests(&report), digests(&before));
    assert_eq!(first.value("c.value"), second.value("c.value"));
    // And from then on it is remembered in memory.
    second.set("a.value", json!(7)).unwrap();
    evaluate(&mut second, &[]);
    log(&mut second);
    second.set("a.value", json!(1.25)).unwrap();
    evaluate(&mut second, &[]);
    assert_eq!(log(&mut second), "memo a, memo b, memo c");
}

#[test]
fn what_nodes_said_is_told_again() {
    // One of three items fails, and one node fails altogether.
    let nodes = json!({
        "a": {"type": "series", "params": {"count": 3, "from": -1}},
        "b": {"type": "root", "inputs": {"a": {"from": ["a.values"]}}},
        "c": {"type": "root", "params": {"a": -4}},
    });
    let shelf = Arc::new(Shelf::default());
    let told = evaluate(&mut fresh(nodes.clone(), &shelf), &[]);
    assert_eq!(told.diagnostics.len(), 2, "{told:?}");
    let mut second = fresh(nodes, &shelf);
    let again = evaluate(&mut second, &[]);
    assert_eq!(again.diagnostics, told.diagnostics);
    assert_eq!(log(&mut second), "disk a, disk c, disk b");
    assert_eq!(again.node("c").map(|n| n.happened), Some(Happened::Failed));
    assert_eq!(items(&second, "b.value"), json!([null, 0.0, 1.0]));
}

#[test]
fn a_result_that_is_there_needs_nothing_of_what_it_was_made_of() {
    let shelf = Arc::new(Shelf::default());
    evaluate(&mut fresh(chain(), &shelf), &[]);
    let store: Arc<dyn Store> = shelf.clone();
    let options = Options { cache_bytes: 0, store: Some(store), ..Options::default() };
    let mut s = Session::new(registry(), document(chain()), options);
    evaluate(&mut s, &["c.value"]);
    assert_eq!(log(&mut s), "disk a, disk b, disk c, evicted a, evicted b");
    s.set("b.b", json!(3)).unwrap();
    evaluate(&mut s, &["c.value"]);
    // b must run: its input comes back from the store.
    assert!(log(&mut s).starts_with("disk a, executed b, executed c"));
}

#[test]
fn another_version_of_a_node_does_not_meet_the_old_ones_results() {
    let shelf = Arc::new(Shelf::default());
    let run = |version: u32, value: f64| {
        let mut r = Registry::new();
        let node = NodeType::new("n", version).output(Port::item::<f64>("out")).run(move |c| {
            c.set("out", value);
            Ok(())
        });
        r.register(node).unwrap();
        let nodes = json!({"a": {"type": "n", "v": version}});
        let store: Arc<dyn Store> = shelf.clone();
        let mut s = Session::new(Arc::new(r), document(nodes), Options { store: Some(store), ..Options::default() });
        evaluate(&mut s, &[]);
        (log(&mut s), items(&s, "a.out"))
    };
    assert_eq!(run(1, 1.0), ("executed a".into(), json!([1.0])));
    assert_eq!(run(1, 1.0), ("disk a".into(), json!([1.0])));
    assert_eq!(run(2, 2.0), ("executed a".into(), json!([2.0])));
}

/// A type that has no bytes.
#[derive(Clone, Default)]
struct Opaque;

impl Item for Opaque {
    const TYPE: &'static str = "opaque";
    fn digest(&self, _: &mut Digester) {}
    fn to_json(&self) -> Json {
        Json::Null
    }
}

#[test]
fn what_has_no_bytes_panicked_or_is_cheap_is_not_kept() {
    let shelf = Arc::new(Shelf::default());
    let mut r = Registry::new();
    r.register_type::<Opaque>();
    let opaque = NodeType::new("opaque", 1).output(Port::item::<Opaque>("out")).run(|c| {
        c.set("out", Opaque);
        Ok(())
    });
    let panics = NodeType::new("panics", 1).output(Port::item::<f64>("out")).run(|_| panic!("the sky fell"));
    let gives_up = NodeType::new("gives_up", 1).output(Port::item::<f64>("out")).run(|_| Err(Fail::cancelled()));
    for node in [opaque, panics, gives_up] {
        r.register(node).unwrap();
    }
    let nodes = json!({"a": {"type": "opaque"}, "b": {"type": "panics"}, "c": {"type": "gives_up"}});
    let store: Arc<dyn Store> = shelf.clone();
    let mut s = Session::new(Arc::new(r), document(nodes), Options { store: Some(store), ..Options::default() });
    evaluate(&mut s, &[]);
    assert!(shelf.kept.lock().unwrap().is_empty());
}

#[test]
fn what_a_cancelled_run_has_finished_is_there_for_the_next() {
    let nodes = json!({
        "a": {"type": "series", "params": {"count": 400}},
        "b": {"type": "sum", "inputs": {"values": {"from": ["a.values"]}}},
        "c": {"type": "sleep", "inputs": {"ms": {"from": ["b.sum"]}}},
    });
    let shelf = Arc::new(Shelf::default());
    let control = Control::default();
    let stop = |p: &Progress| control.cancel.store(&*p.node == "c", Ordering::Relaxed);
    let mut s = fresh(nodes.clone(), &shelf);
    let report = s.evaluate(&[], &Control { cancel: control.cancel.clone(), on_progress: Some(&stop) });
    assert!(report.cancelled && report.cache.is_empty());
    let mut again = fresh(nodes, &shelf);
    evaluate(&mut again, &["b.sum"]);
    assert_eq!(log(&mut again), "disk a, disk b");
}

#[test]
fn damage_is_named_and_written_over() {
    let shelf = Arc::new(Shelf::default());
    let before = evaluate(&mut fresh(chain(), &shelf), &[]);
    shelf.change(Vec::clear);
    let mut s = fresh(chain(), &shelf);
    let report = evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "executed a, executed b, executed c");
    assert_eq!(report.diagnostics, before.diagnostics);
    let told: Vec<_> = report.cache.iter().map(|d| (d.severity, &*d.code, d.node.as_deref())).collect();
    let warning = |node| (Severity::Warning, "cache-damaged", Some(node));
    assert_eq!(told, [warning("a"), warning("b"), warning("c")]);
    assert!(report.cache[0].message.contains("board ") && report.cache[0].message.contains("it is empty"));
    assert_eq!(report.to_json()["diagnostics"].as_array().map(Vec::len), Some(3));
    let mut s = fresh(chain(), &shelf);
    assert!(evaluate(&mut s, &[]).cache.is_empty());
    assert_eq!(log(&mut s), "disk a, disk b, disk c");
}

#[test]
fn a_store_that_cannot_be_written_is_told_once_and_nothing_else_changes() {
    let shelf = Arc::new(Shelf::default());
    shelf.full.store(true, Ordering::Relaxed);
    let mut s = fresh(chain(), &shelf);
    let report = evaluate(&mut s, &[]);
    assert_eq!(log(&mut s), "executed a, executed b, executed c");
    assert!(report.diagnostics.is_empty());
    let [told] = &report.cache[..] else { panic!("{:?}", report.cache) };
    assert_eq!(&*told.code, "cache-failed");
    assert!(told.message.contains("the shelf") && told.message.contains("it is full"), "{told}");
}

/// A result with gaps, branches, every built-in item type, odd floats and reports.
fn kept(floats: Vec<f64>, words: Vec<String>, gaps: Vec<bool>) -> Kept {
    let numbers: Vec<Option<f64>> =
        floats.iter().zip(gaps.iter().chain(std::iter::repeat(&true))).map(|(f, ok)| ok.then_some(*f)).collect();
    let files = words.iter().map(|w| File {
        name: w.as_str().into(),
        bytes: w.as_bytes().into(),
        withheld: (w.len() % 2 == 1).then(|| w.as_str().into()),
    });
    let fail = Fail::new(words.first().cloned().unwrap_or_default(), "a message").port("p").item(3).hint("do so");
    Kept {
        outputs: vec![
            Tree::from_branches(vec![
                (Path::new(vec![0, -3]), Column::with_gaps(numbers)),
                (Path::new(vec![]), Column::new(floats.clone())),
            ]),
            Tree::list(words.iter().map(|w| Text::from(w.as_str())).collect()),
            Tree::list(files.collect()),
            Tree::list(floats.iter().map(|f| f.to_bits() as i64).collect()),
            Tree::list(gaps),
            Tree::default(),
        ],
        reports: vec![(Severity::Warning, fail), (Severity::Note, Fail::new("x", ""))],
        failed: false,
        nanoseconds: u64::MAX,
    }
}

fn bits(tree: &Tree) -> Vec<u64> {
    tree.branches().iter().flat_map(|(_, c)| c.slice::<f64>().unwrap_or(&[]).iter().map(|f| f.to_bits())).collect()
}

proptest! {
    #[test]
    fn every_result_comes_back_bit_for_bit(
        floats in proptest::collection::vec(any::<u64>().prop_map(f64::from_bits), 0..20),
        words in proptest::collection::vec(".{0,9}", 0..5),
        gaps in proptest::collection::vec(any::<bool>(), 0..20),
    ) {
        let all = kept(floats, words, gaps);
        let bytes = all.encode().unwrap();
        let back = Kept::decode(&bytes, &Registry::new()).unwrap();
        prop_assert_eq!(&back, &all);
        prop_assert_eq!(back.encode().unwrap(), bytes);
        prop_assert_eq!(bits(&back.outputs[0]), bits(&all.outputs[0]));
    }

    #[test]
    fn bytes_that_are_no_result_are_refused(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        prop_assert!(Kept::decode(&bytes, &Registry::new()).is_err());
    }

    #[test]
    fn a_spoilt_result_never_panics_and_never_gives_other_values(
        at in any::<proptest::sample::Index>(), by in 1u8.., cut in any::<Option<proptest::sample::Index>>(),
    ) {
        let all = kept(vec![1.5, f64::NAN, -0.0], vec!["a".into(), "bb".into()], vec![true, false]);
        let mut bytes = all.encode().unwrap();
        let i = at.index(bytes.len());
        bytes[i] ^= by;
        if let Some(cut) = cut {
            bytes.truncate(cut.index(bytes.len()));
        }
        // Texts of reports have no digest of their own: that the store answers for. Values have.
        if let Ok(back) = Kept::decode(&bytes, &Registry::new()) {
            prop_assert_eq!(back.outputs, all.outputs);
        }
    }
}

#[test]
fn a_length_that_cannot_be_is_no_allocation() {
    // failed, nanoseconds, no reports, then 2^62 outputs; and one output with 2^62 branches; and one with 2^62 numbers.
    let huge = [0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x80, 0x40];
    for middle in [&[][..], &[1, 0][..], &[1, 0, 1, 0, 6, b'n', b'u', b'm', b'b', b'e', b'r', 1][..]] {
        let bytes = [&[0, 0, 0][..], middle, &huge, &[0, 0, 0]].concat();
        assert!(Kept::decode(&bytes, &Registry::new()).is_err());
    }
}

#[test]
fn another_build_of_what_brings_a_node_finds_nothing_of_the_first() {
    let shelf = Arc::new(Shelf::default());
    let run = |build: u128, value: f64| {
        let mut r = Registry::new();
        let node = NodeType::new("brought", 1).build(build).output(Port::item::<f64>("value")).run(move |c| {
            c.set("value", value);
            Ok(())
        });
        r.register(node).expect("it is sound");
        let store: Arc<dyn Store> = shelf.clone();
        let options = Options { store: Some(store), ..Options::default() };
        let mut s = Session::new(Arc::new(r), document(json!({"x": {"type": "brought"}})), options);
        evaluate(&mut s, &[]);
        (items(&s, "x.value"), log(&mut s))
    };
    assert_eq!(run(1, 1.0), (json!([1.0]), "executed x".into()));
    assert_eq!(run(1, 2.0), (json!([1.0]), "disk x".into()));
    assert_eq!(run(2, 2.0), (json!([2.0]), "executed x".into()));
}
