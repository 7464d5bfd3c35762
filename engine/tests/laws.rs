//! Laws: the file's round trip, and an edited session equal to a fresh one.

use crate::common::*;
use proptest::prelude::*;
use serde_json::json;
use tenon_engine::*;

pub fn any_json() -> impl Strategy<Value = Json> {
    let leaf = prop_oneof![
        Just(Json::Null),
        any::<bool>().prop_map(Json::from),
        any::<i64>().prop_map(Json::from),
        any::<f64>().prop_filter("finite", |f| f.is_finite()).prop_map(Json::from),
        "[ -~äλ\"\\\\\n]{0,12}".prop_map(Json::from),
    ];
    leaf.prop_recursive(3, 40, 6, |inner| {
        prop_oneof![
            proptest::collection::vec(inner.clone(), 0..30).prop_map(Json::from),
            proptest::collection::btree_map("[a-z]{1,6}", inner, 0..6)
                .prop_map(|m| Json::Object(m.into_iter().collect())),
        ]
    })
}

fn any_document() -> impl Strategy<Value = Json> {
    let node = (
        "[a-z/-]{1,10}",
        1u32..9,
        proptest::collection::btree_map("[a-z]{1,6}", any_json(), 0..4),
        proptest::collection::btree_map(
            "[a-z]{1,6}",
            (proptest::collection::vec("[a-z]{1,4}\\.[a-z]{1,4}", 0..4), 0usize..16),
            0..3,
        ),
        0usize..4,
        0usize..4,
    )
        .prop_map(|(t, v, params, wires, rule, state)| {
            let ops = ["graft", "flatten", "simplify", "reverse"];
            let inputs: serde_json::Map<String, Json> = wires
                .into_iter()
                .map(|(port, (from, mask))| {
                    let tree: Vec<&str> = (0..4).filter(|i| mask >> i & 1 == 1).map(|i| ops[i]).collect();
                    (port, json!({"from": from, "tree": tree}))
                })
                .collect();
            let mut node = json!({"type": t, "v": v, "params": params, "inputs": inputs});
            if let Some(m) = ["longest", "shortest", "cross"].get(rule) {
                node["match"] = (*m).into();
            }
            if let Some(m) = ["on", "frozen", "disabled"].get(state) {
                node["state"] = (*m).into();
            }
            node
        });
    let nodes = proptest::collection::btree_map("[A-Za-z0-9_ ü-]{1,8}", node, 0..6);
    (nodes, proptest::option::of(any_json())).prop_map(|(nodes, x)| {
        let mut document = json!({"format": "tenon", "nodes": nodes});
        if let Some(x) = x {
            document["x"] = x;
        }
        document
    })
}

/// An edit: node, and what is done to it.
#[derive(Clone, Debug)]
enum Edit {
    Set(usize, f64),
    Reset(usize),
    Evaluate(usize),
    Rewire(usize, usize),
    State(usize, &'static str),
}

fn any_edit() -> impl Strategy<Value = Edit> {
    let value = prop_oneof![Just(-1.0), Just(0.0), Just(1.0), Just(2.25), -9.0..9.0f64];
    prop_oneof![
        4 => (0usize..COUNT, value).prop_map(|(n, v)| Edit::Set(n, v)),
        1 => (0usize..COUNT).prop_map(Edit::Reset),
        3 => (0usize..COUNT).prop_map(Edit::Evaluate),
        2 => (0usize..COUNT, 0usize..COUNT).prop_map(|(a, b)| Edit::Rewire(a, b)),
        1 => (0usize..COUNT, prop_oneof![Just("on"), Just("disabled")]).prop_map(|(n, s)| Edit::State(n, s)),
    ]
}

const COUNT: usize = 9;

/// Node `i` takes `a` from node `from[i]`, if that comes earlier (else from its parameter).
fn graph(kinds: &[usize], from: &[usize], params: &[Option<f64>], states: &[&str]) -> Json {
    let types = [("add", "sum"), ("floor", "value"), ("root", "value"), ("maybe", "value"), ("add", "sum")];
    let mut nodes = serde_json::Map::new();
    for i in 0..COUNT {
        let mut node = json!({"type": types[kinds[i]].0, "state": states[i]});
        if from[i] < i {
            let port = types[kinds[from[i]]].1;
            node["inputs"] = json!({"a": {"from": [format!("n{}.{port}", from[i])]}});
        } else if let Some(v) = params[i] {
            node["params"] = json!({"a": v});
        }
        nodes.insert(format!("n{i}"), node);
    }
    Json::Object(nodes)
}

fn outcome(s: &Session, report: &Report) -> (Vec<Option<u128>>, Vec<String>) {
    let values = (0..COUNT)
        .map(|i| ["sum", "value"].iter().find_map(|p| s.value(&format!("n{i}.{p}"))).map(|t| t.digest()))
        .collect();
    (values, lines(report))
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn load_then_write_then_load_is_identity(json in any_document()) {
        let text = json.to_string();
        let a = Document::from_slice(text.as_bytes()).map_err(|e| TestCaseError::fail(format!("{e:?}")))?;
        let canonical = a.to_string_canonical();
        let b = Document::from_slice(canonical.as_bytes()).map_err(|e| TestCaseError::fail(format!("{e:?} {canonical}")))?;
        prop_assert_eq!(&a, &b);
        prop_assert_eq!(b.to_string_canonical(), canonical.clone());
        prop_assert!(canonical.ends_with('\n'));
        let kept = a.to_string_canonical_for(&registry());
        let c = Document::from_slice(kept.as_bytes()).map_err(|e| TestCaseError::fail(format!("{e:?} {kept}")))?;
        prop_assert_eq!(c, a);
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
        if let Err(errors) = Document::from_slice(&bytes) {
            prop_assert!(!errors.is_empty());
        }
    }

    #[test]
    fn after_any_edits_a_session_equals_a_fresh_one(
        kinds in proptest::collection::vec(0usize..5, COUNT),
        from in proptest::collection::vec(0usize..COUNT + 4, COUNT),
        edits in proptest::collection::vec(any_edit(), 1..25),
        cache in prop_oneof![Just(0usize), Just(3000), Just(1 << 30)],
        threads in 1usize..3,
    ) {
        let (mut from, mut params, mut states) = (from, vec![Some(1.0); COUNT], vec!["on"; COUNT]);
        let options = Options { cache_bytes: cache, threads, ..Options::default() };
        let mut s = Session::new(registry(), document(graph(&kinds, &from, &params, &states)), options);
        for edit in edits {
            match edit {
                Edit::Set(n, v) if from[n] >= n => {
                    let set = s.set(&format!("n{n}.a"), json!(v));
                    prop_assert_eq!(set, Ok(()));
                    params[n] = Some(v);
                }
                Edit::Reset(n) if from[n] >= n => {
                    let set = s.set(&format!("n{n}.a"), Json::Null);
                    prop_assert_eq!(set, Ok(()));
                    params[n] = None;
                }
                Edit::Set(..) | Edit::Reset(_) => {}
                Edit::Evaluate(n) => {
                    let port = ["sum", "value", "value", "value", "sum"][kinds[n]];
                    evaluate(&mut s, &[&format!("n{n}.{port}")]);
                }
                Edit::Rewire(a, b) => {
                    from[a] = b;
                    s.replace(document(graph(&kinds, &from, &params, &states)));
                }
                Edit::State(n, state) => {
                    states[n] = state;
                    s.replace(document(graph(&kinds, &from, &params, &states)));
                }
            }
        }
        let report = evaluate(&mut s, &[]);
        let mut fresh = Session::new(registry(), document(graph(&kinds, &from, &params, &states)), Options::default());
        let fresh_report = evaluate(&mut fresh, &[]);
        prop_assert_eq!(outcome(&s, &report), outcome(&fresh, &fresh_report));
    }
}
