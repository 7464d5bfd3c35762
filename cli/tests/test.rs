//! `tenon test`: expectations recorded beside a graph, met and not met, in words, JSON and JUnit.

use crate::tenon::{Folder, HALF_BROKEN, NUMBERS};
use serde_json::{Value, json};

/// The graph of numbers with its expectations recorded.
fn recorded(more: &[&str]) -> Folder {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    folder.tenon(&[&["test", ".", "--record"], more].concat()).code(0);
    folder
}

fn expectations(folder: &Folder) -> Value {
    serde_json::from_str(&folder.read("g.expect.json")).unwrap()
}

fn write(folder: &Folder, name: &str, text: &str) {
    std::fs::write(folder.0.join(name), text).unwrap();
}

#[test]
fn what_was_recorded_is_met_until_the_design_changes() {
    let folder = recorded(&[]);
    assert_eq!(
        expectations(&folder)["outputs"]["numbers"],
        json!({"type": "number", "items": 2, "value": [10.0, 11.0]})
    );
    let ended = folder.tenon(&["test", "."]).code(0);
    assert!(ended.stdout.contains("2 passed, 0 failed"), "{ended:#?}");

    write(&folder, "g.tenon.json", &NUMBERS.replace("\"value\": 10", "\"value\": 10.5"));
    let ended = folder.tenon(&["test", "."]).code(1);
    for words in ["1 passed, 1 failed", "numbers", "value[0]: expected 10.0, found 10.5, off by 5.000e-1"] {
        assert!(ended.stdout.contains(words), "no {words:?} in {ended:#?}");
    }
}

#[test]
fn a_tolerance_is_kept_when_it_is_recorded_again() {
    let folder = recorded(&[]);
    let mut wide = expectations(&folder);
    wide["outputs"]["numbers"]["tolerance"] = json!({"abs": 0.6});
    wide["set"] = json!({"thickness": 20});
    write(&folder, "g.expect.json", &wide.to_string());
    folder.tenon(&["test", "."]).code(1);
    folder.tenon(&["test", ".", "--record"]).code(0);
    let again = expectations(&folder);
    assert_eq!(again["outputs"]["numbers"]["value"], json!([20.0, 21.0]), "the inputs are set");
    assert_eq!(again["outputs"]["numbers"]["tolerance"], json!({"abs": 0.6}));

    let set = |value: f64| {
        let mut moved = again.clone();
        moved["set"] = json!({"thickness": value});
        write(&folder, "g.expect.json", &moved.to_string());
    };
    set(20.5);
    folder.tenon(&["test", "."]).code(0);
    set(20.7);
    folder.tenon(&["test", "."]).code(1);
}

#[test]
fn a_digest_allows_nothing() {
    let nearly = NUMBERS.replace("\"value\": 10", "\"value\": 10.000000000001");
    let folder = recorded(&[]);
    write(&folder, "g.tenon.json", &nearly);
    folder.tenon(&["test", "."]).code(0);
    let folder = recorded(&["--exact"]);
    write(&folder, "g.tenon.json", &nearly);
    assert!(folder.tenon(&["test", "."]).code(1).stdout.contains("digest: expected"));
}

#[test]
fn an_output_that_is_gone_and_errors_that_are_new_are_told() {
    let folder = recorded(&[]);
    write(&folder, "g.tenon.json", &NUMBERS.replace("\"numbers\": {\"port\"", "\"pairs\": {\"port\""));
    assert!(folder.tenon(&["test", "."]).code(1).stdout.contains("the graph has no output \"numbers\""));
    write(&folder, "g.tenon.json", &NUMBERS.replace("\"count\": 2", "\"count\": -2"));
    let ended = folder.tenon(&["test", "."]).code(1);
    assert!(ended.stdout.contains("diagnostics") && ended.stdout.contains("expected 0, found 1"), "{ended:#?}");
}

#[test]
fn a_graph_with_errors_is_not_recorded() {
    let folder = Folder::with("g.tenon.json", HALF_BROKEN);
    folder.tenon(&["test", ".", "--record"]).code(2).says(&["nothing was recorded", "series-too-far"]);
    assert_eq!(folder.files(), ["g.tenon.json"]);
}

#[test]
fn a_wrong_file_ends_with_2_and_the_other_graphs_are_tested() {
    let folder = recorded(&[]);
    write(&folder, "h.tenon.json", NUMBERS);
    let ended = folder.tenon(&["test", "h.tenon.json", "g.tenon.json"]).code(2).says(&["h.expect.json", "--record"]);
    assert!(ended.stdout.contains("2 passed"), "{ended:#?}");
    for broken in ["", "{}", r#"{"format": "tenon-expectations", "version": 1, "outputs": {"numbers": 1}}"#] {
        write(&folder, "h.expect.json", broken);
        folder.tenon(&["test", "h.tenon.json"]).code(2).says(&["bad-expectations"]);
    }
}

#[test]
fn json_and_junit_name_every_expectation() {
    let folder = recorded(&[]);
    write(&folder, "g.tenon.json", &NUMBERS.replace("\"value\": 10", "\"value\": 12"));
    write(&folder, "h.tenon.json", NUMBERS);
    let call = ["test", "g.tenon.json", "h.tenon.json", "--json", "--junit", "reports/junit.xml"];
    let json = folder.tenon(&call).code(2).json();
    assert_eq!(json["ok"], false);
    assert_eq!(json["graphs"][0]["expectations"][0], json!({"name": "diagnostics", "ok": true, "failures": []}));
    assert_eq!(json["graphs"][0]["expectations"][1]["ok"], false);
    assert_eq!(json["graphs"][1]["error"]["code"], "no-expectations");
    let xml = folder.read("reports/junit.xml");
    for part in [
        r#"<testsuite name="g.tenon.json" tests="2" failures="1" errors="0""#,
        r#"<testcase classname="g.tenon.json" name="numbers"><failure message="value[0]: expected 10.0, found 12.0"#,
        r#"<testsuite name="h.tenon.json" tests="1" failures="0" errors="1""#,
    ] {
        assert!(xml.contains(part), "no {part} in {xml}");
    }
}
