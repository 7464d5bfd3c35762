//! `--set`: values from the command line.

use crate::tenon::{Folder, NUMBERS, list};
use serde_json::json;

#[test]
fn an_interface_input_and_a_port_can_be_set() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    assert_eq!(list(&folder.tenon(&["run", ".", "--get", "numbers"]).code(0).json()), json!([10.0, 11.0]));
    let ended = folder.tenon(&["run", ".", "--set", "thickness=5", "--set", "pair.step=0.5", "--get", "numbers"]);
    assert_eq!(list(&ended.code(0).json()), json!([5.0, 5.5]));
}

#[test]
fn a_value_may_be_plain_text() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    for (given, expected) in [("shell one", "shell one"), ("\"quoted\"", "quoted"), ("12", "12"), ("a=b", "a=b")] {
        let ended = folder.tenon(&["run", ".", "--set", &format!("label.value={given}"), "--get", "label.value"]);
        assert_eq!(list(&ended.code(0).json()), json!([expected]));
    }
}

#[test]
fn an_unknown_name_gets_the_nearest() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    folder.tenon(&["run", ".", "--set", "thicknes=5"]).code(2).says(&["thicknes", "thickness"]);
    folder.tenon(&["run", ".", "--set", "pair.stp=5"]).code(2).says(&["pair.stp", "step"]);
    folder.tenon(&["run", ".", "--set", "pear.step=5"]).code(2).says(&["pear", "pair"]);
}

#[test]
fn a_value_that_does_not_fit_is_refused() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    folder.tenon(&["run", ".", "--set", "thickness=thick"]).code(2).says(&["thickness"]);
    let limited = NUMBERS.replace(r#""doc": "a number""#, r#""min": 4, "max": 30"#);
    folder.write("g.tenon.json", limited);
    for wide in ["50", "\"50\"", "[5, 50]"] {
        folder.tenon(&["run", ".", "--set", &format!("thickness={wide}")]).code(2);
    }
    folder.tenon(&["run", ".", "--set", "thickness=50"]).code(2).says(&["out-of-range", "4 to 30"]);
    folder.tenon(&["run", ".", "--set", "thickness=30"]).code(0);
    folder.tenon(&["run", ".", "--set", "thickness"]).code(2).says(&["NAME=VALUE"]);
    folder.tenon(&["run", ".", "--set", "=3"]).code(2).says(&["NAME=VALUE"]);
}
