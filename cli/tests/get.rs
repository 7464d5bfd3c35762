//! `--get`: values on stdout and in files.

use crate::tenon::{Folder, HALF_BROKEN, NUMBERS, list};
use serde_json::{Value, json};

#[test]
fn one_value_is_printed_alone_and_several_by_name() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let one = folder.tenon(&["run", ".", "--get", "n.value"]).code(0).json();
    assert_eq!(one, json!({"type": "number", "branches": {"{0}": [10.0]}}));
    let both = folder.tenon(&["run", ".", "--get", "n.value", "--get", "numbers"]).code(0).json();
    assert_eq!(list(&both["n.value"]), json!([10.0]));
    assert_eq!(list(&both["numbers"]), json!([10.0, 11.0]));
}

#[test]
fn a_value_can_be_written_to_a_file() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let ended = folder.tenon(&["run", ".", "--get", "numbers=values/n.json"]).code(0);
    assert!(ended.stdout.contains("wrote values/n.json") && !ended.stdout.contains("branches"), "{ended:#?}");
    let written: Value = serde_json::from_str(&folder.read("values/n.json")).unwrap();
    assert_eq!(list(&written), json!([10.0, 11.0]));
    assert_eq!(folder.files(), ["g.tenon.json", "values/n.json"]);
}

#[test]
fn an_unknown_name_gets_the_nearest() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    folder.tenon(&["run", ".", "--get", "numers"]).code(2).says(&["numers", "numbers"]);
    folder.tenon(&["run", ".", "--get", "pair.nubmers"]).code(2).says(&["pair.nubmers", "numbers"]);
}

#[test]
fn only_what_is_asked_for_is_evaluated() {
    let folder = Folder::with("g.tenon.json", HALF_BROKEN);
    assert_eq!(list(&folder.tenon(&["run", ".", "--get", "good"]).code(0).json()), json!([1.0]));
    let ended = folder.tenon(&["run", ".", "--get", "bad"]).code(1).says(&["series-too-far", "at broken.step"]);
    assert_eq!(ended.stdout, "");
}

#[test]
fn what_failed_does_not_lose_what_worked() {
    let folder = Folder::with("g.tenon.json", HALF_BROKEN);
    let ended = folder.tenon(&["run", ".", "--json", "--get", "good", "--get", "bad"]).code(1);
    let json = ended.json();
    assert_eq!(json["ok"], false);
    assert_eq!(list(&json["values"]["good"]), json!([1.0]));
}
