//! `tenon nodes`: the registry for people and programs.

use crate::tenon::Folder;

#[test]
fn every_node_type_is_listed_with_its_doc() {
    let folder = Folder::new();
    let list = folder.tenon(&["nodes"]).code(0).stdout;
    let all = folder.tenon(&["nodes", "--json"]).code(0).json();
    let all = all.as_array().unwrap();
    assert!(!all.is_empty());
    for node in all {
        let name = node["type"].as_str().unwrap();
        assert!(list.contains(&format!("  {name} ")), "{name} is not in the list");
        assert!(!node["doc"].as_str().unwrap().is_empty(), "{name} has no doc");
    }
}

#[test]
fn one_type_is_described_with_its_ports() {
    let folder = Folder::new();
    let series = folder.tenon(&["nodes", "series"]).code(0).stdout;
    for word in ["series", "start", "step", "count", "default 10", "numbers"] {
        assert!(series.contains(word), "no {word} in {series}");
    }
    assert_eq!(folder.tenon(&["nodes", "series", "--json"]).code(0).json()["type"], "series");
}

#[test]
fn the_conversions_are_those_of_the_book() {
    let folder = Folder::new();
    let list = folder.tenon(&["nodes", "--conversions"]).code(0).stdout;
    assert_eq!(list, "curve -> polygon\ninteger -> number\nitem -> list\npoint -> vector\nvector -> point\n");
    let json = folder.tenon(&["nodes", "--conversions", "--json"]).code(0).json();
    let book = include_str!("../../docs/values.md");
    for conversion in json.as_array().unwrap() {
        let (from, to) = (conversion["from"].as_str().unwrap(), conversion["to"].as_str().unwrap());
        assert!(book.contains(&format!("| {from} | {to} |")), "{from} -> {to} is not in docs/values.md");
    }
    assert_eq!(json.as_array().unwrap().len(), list.lines().count());
    folder.tenon(&["nodes", "--conversions", "series"]).code(2);
}

#[test]
fn an_unknown_type_gets_the_nearest() {
    Folder::new().tenon(&["nodes", "seris"]).code(2).says(&["seris", "did you mean \"series\"?"]);
}
