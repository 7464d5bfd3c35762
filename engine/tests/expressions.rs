//! Units and formulas in parameters: what they give, what renews them, and that no text can hurt.

use crate::common::*;
use proptest::prelude::*;
use serde_json::json;
use std::fmt::Write as _;
use tenon_engine::*;

/// Two plates, the second computed from the first's thickness; and a number computed from it.
fn graph(formula: &str) -> Json {
    json!({
        "format": "tenon",
        "interface": {"inputs": {
            "thickness": {"port": ["a.t", "c.t"], "unit": "mm", "min": 1, "max": 100},
            "share": {"port": "share.value"},
            "edge": {"port": "edge.value", "unit": "cm"},
            "sizes": {"port": "sizes.values"},
        }},
        "nodes": {
            "a": {"type": "thick", "params": {"t": "1.2 cm"}},
            "b": {"type": "thick", "params": {"t": formula}},
            "c": {"type": "thick"},
            "share": {"type": "number", "params": {"value": 0.5}},
            "edge": {"type": "number", "params": {"value": 3}},
            "sizes": {"type": "sum", "params": {"values": [1, 2]}},
            "next": {"type": "add", "inputs": {"a": {"from": ["b.t"]}}},
        },
    })
}

fn open(formula: &str) -> Session {
    let document = Document::from_slice(graph(formula).to_string().as_bytes()).expect("its form is right");
    Session::new(registry(), document, Options::default())
}

fn told(s: &mut Session) -> Vec<String> {
    lines(&evaluate(s, &["b.t"]))
}

#[test]
fn a_parameter_is_computed_from_the_interface() {
    for (formula, expected) in [
        ("thickness * 2", 24.0),
        ("share * thickness + 1 mm", 7.0),
        ("edge + thickness", 42.0),
        ("sqrt(thickness * 3 mm)", 6.0),
        ("max(thickness, 2 cm)", 20.0),
        ("12 + 3", 15.0),
    ] {
        let mut s = open(formula);
        assert_eq!(told(&mut s), Vec::<String>::new(), "{formula}");
        assert_eq!(items(&s, "b.t"), json!([expected]), "{formula}");
    }
}

#[test]
fn an_input_renews_what_names_it_and_only_that() {
    let mut s = open("thickness * 2");
    evaluate(&mut s, &["next.sum", "sizes.sum"]);
    s.take_events();
    assert_eq!(s.set("thickness", json!("2 cm")), Ok(()));
    evaluate(&mut s, &["next.sum", "sizes.sum"]);
    assert_eq!(items(&s, "next.sum"), json!([40.0]));
    assert_eq!(log(&mut s), "executed b, executed next");
    // Another input: nothing runs.
    assert_eq!(s.set("share", json!(0.25)), Ok(()));
    evaluate(&mut s, &["next.sum", "sizes.sum"]);
    assert_eq!(log(&mut s), "");
    // The document keeps the formula, not its value.
    assert_eq!(s.document().nodes()["b"].params.get("t").map(Literal::to_json), Some(json!("thickness * 2")));
}

#[test]
fn a_formula_with_the_same_value_is_not_looked_at_again() {
    let mut s = open("floor(thickness / 10 mm) * 1 cm");
    evaluate(&mut s, &["next.sum"]);
    s.take_events();
    assert_eq!(s.set("thickness", json!(13)), Ok(()));
    evaluate(&mut s, &["next.sum"]);
    assert_eq!(log(&mut s), "");
    assert_eq!(s.set("thickness", json!(23)), Ok(()));
    evaluate(&mut s, &["next.sum"]);
    assert_eq!(log(&mut s), "executed b, executed next");
}

#[test]
fn faults_name_the_place_and_both_units() {
    for (formula, expected) in [
        ("thickness + 5", "\"thickness + 5\", column 11: mm and a number without a unit cannot be added"),
        ("thickness * 2 mm", "\"thickness * 2 mm\" is in mm2, but t takes mm"),
        (
            "thicknes",
            "\"thicknes\", column 1: expected a number or an input's name; there is no input \"thicknes\" (did you mean \"thickness\"?)",
        ),
        (
            "5 * mm",
            "\"5 * mm\", column 5: expected a number or an input's name; there is no input \"mm\" (a unit stands after a number: 1 mm)",
        ),
        ("3 deg", "\"3 deg\" is in deg, but t takes mm"),
        ("1 mm +", "\"1 mm +\", column 7: expected a number, a name or a bracket, found the end"),
    ] {
        assert_eq!(told(&mut open(formula)), [format!("error[bad-literal] b.t: {expected}")], "{formula}");
    }
    let sizes = told(&mut open("sizes * 1 mm"));
    assert!(sizes[0].contains("column 1: input \"sizes\" is not one number"), "{sizes:?}");
    let range = told(&mut open("thickness * 100"));
    assert!(range[0].starts_with("error[out-of-range] b.t: 1200 mm is outside 0.1 to 500 mm"), "{range:?}");
}

#[test]
fn what_cannot_be_computed_is_an_error_until_it_can() {
    let mut s = open("thickness * 20");
    assert_eq!(told(&mut s), Vec::<String>::new());
    assert_eq!(s.set("thickness", json!(50)), Ok(()));
    assert!(told(&mut s)[0].contains("1000 mm is outside"));
    assert_eq!(s.value("b.t").map(|t| t.len()), None);
    assert_eq!(s.set("thickness", json!(20)), Ok(()));
    assert_eq!(told(&mut s), Vec::<String>::new());
    assert_eq!(items(&s, "b.t"), json!([400.0]));
}

#[test]
fn formulas_are_set_and_taken_away() {
    let mut s = open("1");
    assert_eq!(s.set("b.t", json!("thickness / 2")), Ok(()));
    assert_eq!(s.set("thickness", json!(30)), Ok(()));
    evaluate(&mut s, &["b.t"]);
    assert_eq!(items(&s, "b.t"), json!([15.0]));
    // What is not accepted changes nothing.
    let refused = s.set("b.t", json!("thickness / 0")).map_err(|d| d.to_string());
    assert!(refused.is_err_and(|e| e.contains("column 11: division by zero")));
    assert_eq!(s.set("thickness", json!(40)), Ok(()));
    evaluate(&mut s, &["b.t"]);
    assert_eq!(items(&s, "b.t"), json!([20.0]));
    assert_eq!(s.set("b.t", Json::Null), Ok(()));
    assert_eq!(s.set("thickness", json!(50)), Ok(()));
    evaluate(&mut s, &["b.t"]);
    assert_eq!(items(&s, "b.t"), json!([10.0]));
}

#[test]
fn inputs_are_not_computed_from_inputs() {
    let mut s = open("thickness * 2");
    let refused = s.set("thickness", json!("share * 10 mm")).map_err(|d| d.to_string());
    assert!(refused.is_err_and(|e| e.contains("inputs cannot be computed from inputs")));
    let mut document = s.document().clone();
    document.node_mut("a").expect("it is there").params.insert("t", json!("thickness + 1 mm"));
    let found: Vec<String> = document.validate(&registry()).iter().map(ToString::to_string).collect();
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].contains("a.t") && found[0].contains("interface input \"thickness\" is set here"), "{found:?}");
    assert!(found[1].contains("b.t") && found[1].contains("\"thickness\" is not accepted"), "{found:?}");
}

#[test]
fn whole_numbers_and_lists_may_be_computed() {
    let text = json!({
        "format": "tenon",
        "interface": {"inputs": {"n": {"port": "n.count"}}},
        "nodes": {
            "n": {"type": "series", "params": {"count": 4}},
            "m": {"type": "series", "params": {"count": "n / 2"}},
            "odd": {"type": "series", "params": {"count": "n / 3"}},
            "sum": {"type": "sum", "params": {"values": ["n + 1", 2, "n^2"]}},
        },
    });
    let document = Document::from_slice(text.to_string().as_bytes()).expect("its form is right");
    let mut s = Session::new(registry(), document, Options::default());
    let report = evaluate(&mut s, &["m.values", "odd.values", "sum.sum"]);
    assert_eq!(items(&s, "m.values"), json!([0.0, 1.0]));
    assert_eq!(items(&s, "sum.sum"), json!([23.0]));
    assert!(
        lines(&report)[0].contains("odd.count") && lines(&report)[0].contains("whole number"),
        "{:?}",
        lines(&report)
    );
}

/// Every text of the corpus still gives what is written beside it. Texts that once made trouble are kept there.
#[test]
fn the_corpus_gives_what_it_gave() {
    let corpus = include_str!("corpus/expressions.txt");
    let mut now = String::new();
    for line in corpus.lines() {
        let text = line.split(" ⇒ ").next().unwrap_or_default();
        let names = |name: &str| match name {
            "thickness" => Ok(Quantity { value: 12.0, ..Quantity::unit("mm").unwrap_or_default() }),
            "x" => Ok(Quantity::plain(0.5)),
            _ => Err(format!("no {name}")),
        };
        let found = match Expression::parse(text).and_then(|e| e.evaluate(&names)) {
            Ok(q) if q.dimension.is_plain() => q.value.to_string(),
            Ok(q) => format!("{} {}", q.value, q.dimension),
            Err(e) => e.to_string(),
        };
        let _ = writeln!(now, "{text} ⇒ {found}");
    }
    assert_eq!(now, corpus, "what is found now:\n{now}");
}

/// Texts that nearly are formulas.
fn nearly() -> impl Strategy<Value = String> {
    let piece = prop_oneof![
        prop_oneof![Just("thickness"), Just("x"), Just("'x y'"), Just("pi"), Just("min"), Just("sqrt("), Just("max(")],
        prop_oneof![Just("+"), Just("-"), Just("*"), Just("/"), Just("^"), Just("("), Just(")"), Just(","), Just("'")],
        prop_oneof![Just("1"), Just("2.5"), Just("1e9"), Just("1e300"), Just("0"), Just("."), Just("9e"), Just("64")],
        prop_oneof![Just("mm"), Just("cm2"), Just("m^3"), Just("deg"), Just("mm/min"), Just("²"), Just("°"), Just(" ")],
    ];
    proptest::collection::vec(piece, 0..25).prop_map(|pieces| pieces.concat())
}

fn survives(text: &str) -> Result<(), TestCaseError> {
    let names = |name: &str| match name {
        "x" => Ok(Quantity::plain(0.5)),
        "thickness" => Ok(Quantity { value: -3.0, ..Quantity::unit("mm").unwrap_or_default() }),
        _ => Err(String::from("no such name")),
    };
    match Expression::parse(text).and_then(|e| e.evaluate(&names)) {
        Ok(q) => prop_assert!(q.value.is_finite(), "{text}"),
        Err(e) => prop_assert!(e.column >= 1 && e.column <= text.chars().count() + 1, "{text}: {e}"),
    }
    Ok(())
}

/// A formula, and its value as this test computes it by itself.
fn computed() -> impl Strategy<Value = (String, f64)> {
    let leaf = (-99i32..99).prop_map(|v| (format!("{v}"), f64::from(v)));
    leaf.prop_recursive(5, 40, 2, |inner| {
        (inner.clone(), inner, 0usize..6).prop_map(|((a, x), (b, y), o)| match o {
            0 => (format!("({a}+{b})"), x + y),
            1 => (format!("({a}) - ({b})"), x - y),
            2 => (format!("({a})*( {b} )"), x * y),
            3 => (format!("min({a}, {b})"), x.min(y)),
            4 => (format!("-({a})"), -x),
            _ => (format!("abs({a}) / 4"), x.abs() / 4.0),
        })
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(256))]

    #[test]
    fn no_text_can_hurt(text in any::<String>()) {
        survives(&text)?;
    }

    #[test]
    fn no_near_formula_can_hurt(text in nearly()) {
        survives(&text)?;
        let session = open(&text);
        let found = session.document().validate(&registry());
        prop_assert!(found.len() <= 1, "{found:?}");
    }

    #[test]
    fn values_are_those_of_arithmetic((text, expected) in computed()) {
        let found = Expression::parse(&text).and_then(|e| e.evaluate(&|n| Err(n.into())));
        prop_assert_eq!(found, Ok(Quantity::plain(expected)), "{}", text);
    }

    #[test]
    fn after_any_sets_a_session_equals_a_fresh_one(
        sets in proptest::collection::vec((0usize..4, 0usize..8), 1..12),
    ) {
        let values = ["1", "20", "thickness * 2", "share * 30 mm", "edge", "thickness * 30", "1 / share * 1 mm", "0"];
        let mut s = open("thickness * 2");
        for (name, value) in sets {
            let name = ["thickness", "share", "edge", "b.t"][name];
            // Some are refused, and then nothing may have changed.
            let _ = s.set(name, json!(values[value]));
            if value % 2 == 0 {
                evaluate(&mut s, &["next.sum"]);
            }
        }
        let report = evaluate(&mut s, &["next.sum", "c.t"]);
        let mut fresh = Session::new(registry(), s.document().clone(), Options::default());
        let fresh_report = evaluate(&mut fresh, &["next.sum", "c.t"]);
        prop_assert_eq!(lines(&report), lines(&fresh_report));
        prop_assert_eq!(items(&s, "next.sum"), items(&fresh, "next.sum"));
    }
}
