//! Files: whole or not at all.

use crate::tenon::{Folder, NUMBERS, list};

#[test]
fn an_output_folder_that_cannot_be_made_ends_the_call_before_the_work() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    folder.write("taken", "a file");
    folder.tenon(&["run", ".", "--out", "taken"]).code(2).says(&["taken", "cannot be written"]);
    folder.tenon(&["run", ".", "--out", "taken/below"]).code(2).says(&["cannot be written"]);
    assert_eq!(folder.read("taken"), "a file");
}

#[test]
fn if_one_file_cannot_be_written_none_is() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    folder.write("taken", "a file");
    folder.tenon(&["run", ".", "--get", "numbers=n.json", "--report", "taken/report.json"]).code(2).says(&["taken"]);
    assert_eq!(folder.files(), ["g.tenon.json", "taken"]);
    folder.tenon(&["run", ".", "--get", "numbers=n.json", "--report", "."]).code(2).says(&["cannot be written"]);
    assert_eq!(folder.files(), ["g.tenon.json", "taken"]);
}

#[test]
fn a_file_is_replaced_whole() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    folder.write("n.json", "x".repeat(100_000));
    folder.tenon(&["run", ".", "--get", "n.value=n.json"]).code(0);
    let written: serde_json::Value = serde_json::from_str(&folder.read("n.json")).unwrap();
    assert_eq!(list(&written), serde_json::json!([10.0]));
}
