//! `tenon fmt`: the canonical form.

use crate::tenon::{Folder, NUMBERS};

#[test]
fn formatting_twice_changes_nothing() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    folder.tenon(&["fmt", "--check", "g.tenon.json"]).code(1).says(&["g.tenon.json is not in canonical form"]);
    assert_eq!(folder.read("g.tenon.json"), NUMBERS, "--check changes nothing");
    folder.tenon(&["fmt", "g.tenon.json"]).code(0).says(&["formatted"]);
    let once = folder.read("g.tenon.json");
    assert_ne!(once, NUMBERS);
    assert!(once.ends_with("}\n"));
    folder.tenon(&["fmt", "--check", "."]).code(0);
    let again = folder.tenon(&["fmt", "."]).code(0);
    assert_eq!(again.stderr, "");
    assert_eq!(folder.read("g.tenon.json"), once);
    assert_eq!(folder.files(), ["g.tenon.json"]);
}

#[test]
fn the_graph_means_the_same_afterwards() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let before = folder.tenon(&["run", ".", "--get", "numbers"]).code(0).stdout;
    folder.tenon(&["fmt", "."]).code(0);
    assert_eq!(folder.tenon(&["run", ".", "--get", "numbers"]).code(0).stdout, before);
}

#[test]
fn a_broken_file_does_not_keep_the_others_from_being_formatted() {
    let folder = Folder::with("a.tenon.json", "{");
    folder.write("b.tenon.json", NUMBERS);
    folder.tenon(&["fmt", "a.tenon.json", "b.tenon.json"]).code(2).says(&["a.tenon.json", "formatted b.tenon.json"]);
    assert_eq!(folder.read("a.tenon.json"), "{");
    folder.tenon(&["fmt", "--check", "b.tenon.json"]).code(0);
}
