//! `tenon watch`: what is changed on disk is evaluated again, and only what has changed.
#![cfg(unix)]

use crate::tenon::{Folder, NUMBERS};
use serde_json::Value;
use std::io::{BufRead, BufReader};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

/// A `tenon watch` that runs, and the lines of its standard output and standard error.
struct Watch {
    child: Child,
    out: Receiver<String>,
    err: Receiver<String>,
}

fn lines(from: impl std::io::Read + Send + 'static) -> Receiver<String> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        BufReader::new(from).lines().map_while(Result::ok).try_for_each(|line| sender.send(line))
    });
    receiver
}

/// Generous: the machine may be busy with other tests.
fn next(lines: &Receiver<String>) -> String {
    lines.recv_timeout(Duration::from_secs(60)).expect("something is said")
}

fn until(lines: &Receiver<String>, words: &str) {
    while !next(lines).contains(words) {}
}

impl Watch {
    fn start(folder: &Folder, args: &[&str]) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_tenon"))
            .arg("watch")
            .args(args)
            .current_dir(&folder.0)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let (out, err) = (lines(child.stdout.take().unwrap()), lines(child.stderr.take().unwrap()));
        Self { child, out, err }
    }

    fn json(&self) -> Value {
        serde_json::from_str(&next(&self.out)).unwrap()
    }

    fn end(mut self) -> Option<i32> {
        assert!(Command::new("kill").args(["-INT", &self.child.id().to_string()]).status().unwrap().success());
        self.child.wait().unwrap().code()
    }
}

/// What happened to a node.
fn happened<'a>(line: &'a Value, id: &str) -> Option<&'a str> {
    let node = line["nodes"].as_array().unwrap().iter().find(|n| n["id"] == id);
    node.and_then(|n| n["happened"].as_str())
}

const TRIANGLE: &str = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";

/// A mesh that is read and written again, and a node beside it.
const COPY: &str = r#"{"format": "tenon", "version": 1, "units": "mm",
  "interface": {"inputs": {}, "outputs": {"side": {"port": "n.value"}}},
  "nodes": {
    "n": {"type": "number", "v": 1, "params": {"value": 1}},
    "r": {"type": "read_mesh", "v": 1, "params": {"path": "in.obj"}},
    "w": {"type": "write_obj", "v": 1, "inputs": {"mesh": {"from": ["r.mesh"]}}, "params": {"name": "copy.obj"}}
  }}"#;

#[test]
fn a_changed_input_runs_what_reads_it_and_writes_the_files_again() {
    let folder = Folder::with("g.tenon.json", COPY);
    folder.write("in.obj", TRIANGLE);
    let watch = Watch::start(&folder, &[".", "--out", "out", "--json"]);
    let first = watch.json();
    assert_eq!((&first["ok"], happened(&first, "r")), (&Value::from(true), Some("executed")), "{first}");
    let before = folder.read("out/copy.obj");
    folder.write("in.obj", TRIANGLE.replace("v 1 0 0", "v 7 0 0"));
    let second = watch.json();
    assert_eq!((happened(&second, "r"), happened(&second, "n")), (Some("executed"), None), "{second}");
    assert!(folder.read("out/copy.obj") != before && folder.read("out/copy.obj").contains('7'));
    // Missing for a while: said, and over when it is there again.
    std::fs::remove_file(folder.0.join("in.obj")).unwrap();
    assert_eq!(watch.json()["ok"], false);
    folder.write("in.obj", TRIANGLE);
    let back = watch.json();
    assert_eq!((&back["ok"], happened(&back, "r")), (&Value::from(true), Some("memo")), "{back}");
    assert_eq!(folder.read("out/copy.obj"), before);
    assert_eq!(watch.end(), Some(0));
}

#[test]
fn a_changed_graph_runs_what_is_new_and_half_a_graph_is_waited_out() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let watch = Watch::start(&folder, &["g.tenon.json", "--json", "--set", "thickness=4"]);
    until(&watch.err, "watching");
    let first = watch.json();
    assert_eq!((happened(&first, "n"), happened(&first, "pair")), (Some("executed"), Some("executed")));
    let more = NUMBERS.replace(r#""count": 2"#, r#""count": 3"#);
    folder.write("g.tenon.json", &more[..more.len() / 2]);
    until(&watch.err, "is not a readable graph");
    folder.write("g.tenon.json", &more);
    let second = watch.json();
    assert_eq!((&second["ok"], happened(&second, "pair")), (&Value::from(true), Some("executed")), "{second}");
    let digest =
        |line: &Value| line["nodes"].as_array().unwrap().iter().find(|n| n["id"] == "n").unwrap()["digest"].clone();
    assert_eq!(digest(&first), digest(&second), "--set stays, whatever the file says");
    assert_eq!(watch.end(), Some(0));
}

/// A graph that links a cluster, and that cluster's file.
const LINKS: &str = r#"{"format": "tenon", "version": 1, "units": "mm",
  "clusters": {"lib": {"file": "lib.tenon.json"}},
  "nodes": {"k": {"type": "cluster:lib", "v": 1}, "n": {"type": "number", "v": 1, "params": {"value": 1}}}}"#;
const LINKED: &str = r#"{"format": "tenon", "version": 1, "units": "mm",
  "interface": {"version": 1, "inputs": {}, "outputs": {"value": {"port": "inner.value"}}},
  "nodes": {"inner": {"type": "number", "v": 1, "params": {"value": 1}}}}"#;

#[test]
fn a_changed_file_of_a_linked_cluster_runs_what_is_new_in_it() {
    let folder = Folder::with("g.tenon.json", LINKS);
    folder.write("lib.tenon.json", LINKED);
    let watch = Watch::start(&folder, &["g.tenon.json", "--json"]);
    let first = watch.json();
    assert_eq!((&first["ok"], happened(&first, "k/inner")), (&Value::from(true), Some("executed")), "{first}");
    folder.write("lib.tenon.json", LINKED.replace(r#""value": 1}"#, r#""value": 2}"#));
    let second = watch.json();
    assert_eq!((happened(&second, "k/inner"), happened(&second, "n")), (Some("executed"), Some("cut-off")), "{second}");
    assert_eq!(watch.end(), Some(0));
}

#[test]
fn people_are_told_what_ran_and_for_how_long() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let watch = Watch::start(&folder, &["."]);
    let mut said = String::new();
    while !said.contains("no errors") {
        said.push_str(&next(&watch.out));
        said.push('\n');
    }
    assert!(said.contains("executed n\n") && said.contains("numbers:") && said.contains("2 executed in "), "{said}");
    assert_eq!(watch.end(), Some(0));
}

#[test]
fn only_what_is_asked_for_is_evaluated_and_shown() {
    let folder = Folder::with("g.tenon.json", COPY);
    folder.write("in.obj", TRIANGLE);
    let watch = Watch::start(&folder, &[".", "--get", "n.value", "--json"]);
    let first = watch.json();
    assert_eq!(first["values"]["n.value"]["branches"]["{0}"], serde_json::json!([1.0]), "{first}");
    assert_eq!((happened(&first, "n"), happened(&first, "r")), (Some("executed"), None), "{first}");
    folder.write("g.tenon.json", COPY.replace(r#""value": 1"#, r#""value": 5"#));
    let second = watch.json();
    assert_eq!(second["values"]["n.value"]["branches"]["{0}"], serde_json::json!([5.0]), "{second}");
    assert_eq!(watch.end(), Some(0));
    let people = Watch::start(&folder, &[".", "--get", "n.value"]);
    until(&people.out, "n.value: 5.000");
    assert_eq!(people.end(), Some(0));
    folder.tenon(&["watch", ".", "--get", "n.value", "--out", "out"]).code(2);
}

#[test]
fn what_cannot_be_watched_ends_at_once() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    folder.tenon(&["watch", "gone.tenon.json"]).code(2);
    folder.tenon(&["watch", ".", "--set", "width=1"]).code(2).says(&["width"]);
}
