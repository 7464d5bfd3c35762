//! `tenon inspect`: any port as a summary, a table or JSON.

use crate::tenon::{Folder, HALF_BROKEN, NUMBERS, list, shipped};
use serde_json::json;

#[test]
fn a_summary_says_type_counts_and_range() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let ended = folder.tenon(&["inspect", ".", "pair.numbers", "--set", "thickness=4"]).code(0);
    for words in ["pair.numbers: number", "items     2", "branches  1", "4 to 5, mean 4.5", "{0}[1]  5"] {
        assert!(ended.stdout.contains(words), "no {words:?} in {ended:#?}");
    }
}

#[test]
fn a_table_has_a_line_per_item_and_a_column_per_member() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let table = folder.tenon(&["inspect", ".", "numbers", "--table"]).code(0).stdout;
    let lines: Vec<Vec<&str>> = table.lines().map(|l| l.split_whitespace().collect()).collect();
    assert_eq!(lines, [["path", "item", "value"], ["{0}", "0", "10.0"], ["{0}", "1", "11.0"]]);
    let points = folder.tenon(&["inspect", &shipped("shell-256"), "arc.points", "--table"]).code(0).stdout;
    assert_eq!(points.lines().next().unwrap().split_whitespace().collect::<Vec<_>>(), ["path", "item", "x", "y", "z"]);
    assert_eq!(points.lines().count(), 1 + 17, "four iterations make 16 segments");
}

#[test]
fn an_input_shows_what_its_node_sees() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let show = |port: &str| list(&folder.tenon(&["inspect", ".", port, "--json"]).code(0).json());
    assert_eq!(show("pair.start"), json!([10.0]), "a wire");
    assert_eq!(show("pair.count"), json!([2]), "a literal");
    assert_eq!(show("pair.step"), json!([1.0]), "a default");
    assert_eq!(show("thickness"), json!([10.0]), "an input of the graph");
}

#[test]
fn only_what_the_port_needs_is_evaluated() {
    let folder = Folder::with("g.tenon.json", HALF_BROKEN);
    folder.tenon(&["inspect", ".", "fine.value"]).code(0);
    folder.tenon(&["inspect", ".", "bad"]).code(1).says(&["series-too-far", "bad has no value"]);
    folder.tenon(&["inspect", ".", "after.start"]).code(1).says(&["after.start has no value"]);
}

#[test]
fn an_unknown_port_gets_the_nearest() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    folder.tenon(&["inspect", ".", "pair.nubmers"]).code(2).says(&["pair.nubmers", "numbers"]);
    folder.tenon(&["inspect", ".", "pair.strat"]).code(2).says(&["pair.strat", "start"]);
    let ended = folder.tenon(&["inspect", ".", "piar.start", "--json"]).code(2).says(&["pair"]);
    assert_eq!(ended.json()["error"]["code"], "inspect");
}
