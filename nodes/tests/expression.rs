//! The node that computes formulas.

use crate::common::*;
use serde_json::{Value, json};

fn graph(formula: Value, numbers: Value) -> Value {
    json!({
        "format": "tenon",
        "nodes": {
            "numbers": { "type": "list", "v": 1, "inputs": { "items": wire("one.value") } },
            "one": { "type": "number", "v": 1, "params": { "value": numbers } },
            "e": { "type": "expression", "v": 1, "params": { "formula": formula, "y": 4 }, "inputs": { "x": wire("numbers.items") } },
        },
    })
}

#[test]
fn a_formula_is_computed_for_every_item() {
    let (session, report) = run(&graph(json!("sqrt(x^2 + y^2)"), json!([3, 0, 7.5])), &["e.value"]);
    assert_eq!(report.diagnostics, []);
    let value = session.value("e.value").unwrap();
    assert_eq!(value.branches()[0].1.slice::<f64>(), Some(&[5.0, 4.0, 8.5][..]));
    let (session, _) = run(&graph(json!("cos(60 deg) * x * 1 cm"), json!(3)), &["e.value"]);
    let value = *session.value("e.value").unwrap().first::<f64>().unwrap();
    assert!((value - 15.0).abs() < 1e-12, "{value}");
}

#[test]
fn one_bad_item_leaves_a_gap_and_says_where() {
    let (session, report) = run(&graph(json!("y / x"), json!([2, 0, 4])), &["e.value"]);
    let found = told(&report, "bad-formula");
    assert_eq!(found.item, Some(1));
    assert_eq!(found.message, "\"y / x\", column 3: division by zero gives no finite number");
    let value = session.value("e.value").unwrap();
    let column = &value.branches()[0].1;
    assert_eq!((column.get::<f64>(0), column.get::<f64>(1), column.get::<f64>(2)), (Some(&2.0), None, Some(&1.0)));
}

#[test]
fn names_without_numbers_are_told() {
    let (_, report) = run(&graph(json!("x + z"), json!(1)), &["e.value"]);
    assert_eq!(told(&report, "bad-formula").message, "\"x + z\", column 5: z has no value");
    let (_, report) = run(&graph(json!("x + w"), json!(1)), &["e.value"]);
    assert_eq!(told(&report, "bad-formula").message, "\"x + w\", column 5: \"w\" is none of x, y and z");
}
