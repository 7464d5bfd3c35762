//! Calls and files that are wrong: exit code 2, and words that say what would be right.

use crate::tenon::{Folder, NUMBERS};

#[test]
fn a_graph_that_is_not_there_is_named() {
    Folder::new().tenon(&["run", "nowhere.tenon.json"]).code(2).says(&["nowhere.tenon.json", "cannot be read"]);
}

#[test]
fn a_truncated_file_is_refused_with_its_place() {
    for length in [0, 1, NUMBERS.len() / 2, NUMBERS.len() - 3] {
        let folder = Folder::with("g.tenon.json", &NUMBERS[..length]);
        for command in ["run", "check", "fmt"] {
            let ended = folder.tenon(&[command, "g.tenon.json"]).code(2);
            let ended = ended.says(&["g.tenon.json is not a readable graph"]);
            let place = if length == 0 { "the file is empty" } else { "line " };
            assert!(ended.stderr.contains(place), "{length}: {ended:#?}");
        }
        assert_eq!(folder.read("g.tenon.json"), NUMBERS[..length]);
    }
}

#[test]
fn garbage_and_deep_nesting_are_refused() {
    let deep = "[".repeat(10_000_000);
    let noise: Vec<u8> = (0..1_000_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect();
    for bytes in [deep.as_bytes(), noise.as_slice(), b"{}", b"[]", b"null", b"\xff\xfe"] {
        let folder = Folder::with("g.tenon.json", bytes);
        folder.tenon(&["check", "."]).code(2).says(&["not a readable graph"]);
    }
}

#[test]
fn a_file_of_200_mb_is_refused_without_reading_it_all() {
    let folder = Folder::new();
    let file = std::fs::File::create(folder.0.join("g.tenon.json")).unwrap();
    file.set_len(200 << 20).unwrap();
    folder.tenon(&["check", "g.tenon.json"]).code(2).says(&["larger than a graph may be (64 MiB)"]);
}

#[test]
fn a_folder_must_hold_exactly_one_graph() {
    let folder = Folder::with("a.tenon.json", NUMBERS);
    folder.tenon(&["run", "."]).code(0);
    folder.write("b.tenon.json", NUMBERS);
    folder.tenon(&["run", "."]).code(2).says(&["holds 2 graphs", "a.tenon.json"]);
    Folder::new().tenon(&["run", "."]).code(2).says(&["holds no file that ends in .tenon.json"]);
}

#[test]
fn without_a_command_the_default_graph_is_looked_for() {
    Folder::new().tenon(&[]).code(2).says(&["graphs/shell-256", "tenon run GRAPH"]);
    let folder = Folder::with("graphs/shell-256/g.tenon.json", NUMBERS);
    folder.tenon(&[]).code(0);
}

#[test]
fn an_unknown_option_is_refused() {
    Folder::new().tenon(&["run", "x", "--sett", "a=1"]).code(2).says(&["--set"]);
    Folder::new().tenon(&["run"]).code(2).says(&["GRAPH"]);
    Folder::new().tenon(&["--help"]).code(0);
}

#[test]
fn wrong_calls_are_json_too() {
    let ended = Folder::new().tenon(&["run", "nowhere", "--json"]).code(2);
    let json = ended.json();
    assert_eq!(json["ok"], false);
    assert_eq!(json["error"]["code"], "unreadable");
}
