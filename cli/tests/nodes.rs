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
fn an_unknown_type_gets_the_nearest() {
    Folder::new().tenon(&["nodes", "seris"]).code(2).says(&["seris", "did you mean \"series\"?"]);
}
