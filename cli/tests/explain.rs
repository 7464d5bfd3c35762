//! `tenon explain`: what codes mean.

use crate::tenon::Folder;

#[test]
fn a_code_is_explained_as_it_stands_in_a_message() {
    let folder = Folder::new();
    let plain = folder.tenon(&["explain", "cycle"]).code(0);
    assert!(plain.stdout.starts_with("cycle\n") && plain.stdout.contains("ring"), "{plain:#?}");
    assert_eq!(folder.tenon(&["explain", "error[cycle]"]).code(0).stdout, plain.stdout);
    let json = folder.tenon(&["explain", "hole-thin-wood", "--json"]).code(0).json();
    assert!(json["code"] == "hole-thin-wood" && json["help"].is_string(), "{json}");
    folder.tenon(&["explain", "cicle"]).code(2).says(&["did you mean \"cycle\"?"]);
}

#[test]
fn without_a_code_all_are_listed_once() {
    let all = Folder::new().tenon(&["explain", "--json"]).code(0).json();
    let names: Vec<&str> = all.as_array().unwrap().iter().map(|c| c["code"].as_str().unwrap()).collect();
    assert!(names.len() > 100 && names.is_sorted_by(|a, b| a < b), "{names:?}");
    for known in ["blocked", "face-concave", "stale-plan"] {
        assert!(names.contains(&known));
    }
}
