//! `tenon check`: what is wrong with a graph, without evaluating it.

use crate::tenon::{Folder, HALF_BROKEN, NUMBERS};

#[test]
fn a_good_graph_has_no_errors() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let ended = folder.tenon(&["check", "g.tenon.json"]).code(0);
    assert!(ended.stdout.contains("no errors"), "{ended:#?}");
    let json = folder.tenon(&["check", "--json", "."]).code(0).json();
    assert_eq!(json["ok"], true);
}

#[test]
fn nothing_is_evaluated() {
    Folder::with("g.tenon.json", HALF_BROKEN).tenon(&["check", "."]).code(0);
}

#[test]
fn an_unknown_node_type_gets_the_nearest() {
    let folder = Folder::with("g.tenon.json", NUMBERS.replace("\"series\"", "\"seris\""));
    folder.tenon(&["check", "."]).code(1).says(&["seris", "series", "at pair"]);
}

#[test]
fn an_unknown_port_gets_the_nearest() {
    let folder = Folder::with("g.tenon.json", NUMBERS.replace("\"count\"", "\"cuont\""));
    folder.tenon(&["check", "."]).code(1).says(&["cuont", "count"]);
}

#[test]
fn a_cycle_is_named() {
    let loops = NUMBERS.replace(
        r#""n": {"type": "number", "v": 1, "params": {"value": 10}}"#,
        r#""n": {"type": "number", "v": 1, "inputs": {"value": {"from": ["pair.numbers"]}}}"#,
    );
    let folder = Folder::with("g.tenon.json", loops);
    let ended = folder.tenon(&["check", ".", "--json"]).code(1).says(&["n.value", "pair.numbers", "->"]);
    assert_eq!(ended.json()["ok"], false);
    folder.tenon(&["run", "."]).code(1).says(&["->"]);
}

#[test]
fn a_wire_between_types_that_do_not_fit_names_both_ends() {
    let wrong = NUMBERS.replace("\"n.value\"]", "\"label.value\"]");
    Folder::with("g.tenon.json", wrong).tenon(&["check", "."]).code(1).says(&[
        "label.value",
        "pair.start",
        "text",
        "number",
    ]);
}
