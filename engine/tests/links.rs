//! Clusters in files of their own: read through the host, pinned by version and digest.

use crate::clusters::{graph, rooted};
use crate::common::*;
use serde_json::json;
use std::collections::BTreeMap;
use std::io;
use std::sync::{Arc, Mutex};
use tenon_engine::*;

/// A folder in memory.
#[derive(Clone, Default)]
struct Folder(Arc<Mutex<BTreeMap<String, String>>>);

impl Host for Folder {
    fn read(&self, path: &str) -> io::Result<Arc<[u8]>> {
        let found = self.0.lock().unwrap().get(path).cloned();
        found.map(|t| t.into_bytes().into()).ok_or_else(|| io::Error::new(io::ErrorKind::NotFound, "no such file"))
    }
}

impl Folder {
    fn put(&self, path: &str, file: Json) {
        self.0.lock().unwrap().insert(path.into(), file.to_string());
    }

    fn open(&self, document: Document) -> Session {
        Session::new(registry(), document, Options { host: Arc::new(self.clone()), ..Options::default() })
    }
}

/// The cluster of the other tests as a file of its own.
fn file(version: u32, b: f64) -> Json {
    let mut file = rooted();
    file["format"] = "tenon".into();
    file["interface"]["version"] = version.into();
    file["nodes"]["add"]["params"]["b"] = b.into();
    file
}

fn told(document: &Document) -> Vec<String> {
    document.validate(&registry()).iter().map(ToString::to_string).collect()
}

#[test]
fn a_linked_graph_is_a_node() {
    let folder = Folder::default();
    folder.put("lib/rooted.tenon.json", file(1, 7.0));
    let nodes = json!({"x": {"type": "cluster:r", "params": {"a": 2}}, "y": {"type": "cluster:r", "params": {"a": 9}}});
    let mut s = folder.open(graph(json!({"r": {"file": "./lib/rooted.tenon.json"}}), nodes));
    let report = evaluate(&mut s, &["x.root", "y.root"]);
    assert!(report.diagnostics.is_empty(), "{:?}", lines(&report));
    assert_eq!((items(&s, "x.root"), items(&s, "y.root")), (json!([3.0]), json!([4.0])));
    // Without pins the file is followed, as soon as the graph is opened or edited anew.
    folder.put("lib/rooted.tenon.json", file(2, 0.0));
    s.replace(s.document().clone());
    evaluate(&mut s, &["x.root", "y.root"]);
    assert_eq!(items(&s, "y.root"), json!([3.0]));
}

#[test]
fn a_pinned_file_that_changed_is_told_with_both_digests_until_it_is_taken_over() {
    let folder = Folder::default();
    folder.put("r.tenon.json", file(2, 7.0));
    let mut document = graph(
        json!({"r": {"file": "r.tenon.json"}}),
        json!({"x": {"type": "cluster:r", "params": {"a": 2}}, "n": {"type": "number"}}),
    );
    assert!(told(&document)[0].contains("error[linked-file] x: cluster \"r\": r.tenon.json has not been read"));
    document.read_links(&folder);
    assert_eq!(document.update_links(), ["r"]);
    assert!(document.update_links().is_empty() && told(&document).is_empty());
    let Cluster::File(pinned) = document.clusters["r"].clone() else { panic!("it is linked") };
    assert_eq!(pinned.version, Some(2));
    let digest = pinned.digest.clone().unwrap();
    assert!(digest.starts_with("xxh3:") && digest.len() == 37);

    // Only the text is another: the same digest.
    let spaced = format!("{:#}", file(2, 7.0));
    folder.0.lock().unwrap().insert("r.tenon.json".into(), spaced);
    document.read_links(&folder);
    assert!(told(&document).is_empty());

    folder.put("r.tenon.json", file(2, 8.0));
    document.read_links(&folder);
    let (wrong, now) = (told(&document), Document::from_slice(file(2, 8.0).to_string().as_bytes()).unwrap().digest());
    assert_eq!(
        wrong,
        [format!(
            "error[linked-digest] x: cluster \"r\" is pinned to {digest}, but r.tenon.json has changed: it is {now} \
             (look at what changed, then take it over: tenon fmt --update-links)"
        )]
    );
    folder.put("r.tenon.json", file(3, 8.0));
    let mut s = folder.open(document.clone());
    let report = evaluate(&mut s, &["x.root", "n.value"]);
    assert_eq!(
        lines(&report)[0],
        "error[linked-version] x: cluster \"r\" is pinned to version 2 of r.tenon.json, which has version 3 \
         (look at what changed, then take it over: tenon fmt --update-links)"
    );
    // The rest of the graph runs.
    assert_eq!(items(&s, "n.value"), json!([0.0]));
    let mut document = s.document().clone();
    assert_eq!(document.update_links(), ["r"]);
    assert!(told(&document).is_empty());
}

#[test]
fn missing_and_broken_files_keep_only_their_instances_from_running() {
    let folder = Folder::default();
    folder.0.lock().unwrap().insert("bad.tenon.json".into(), "{\"format\": \"tenon\", \"nodes\": 3}".into());
    let nodes = json!({
        "x": {"type": "cluster:gone"},
        "y": {"type": "cluster:bad"},
        "n": {"type": "number", "params": {"value": 2}},
        "end": {"type": "floor", "inputs": {"a": {"from": "x.root"}}},
    });
    let clusters = json!({"gone": {"file": "gone.tenon.json"}, "bad": {"file": "bad.tenon.json"}});
    let mut s = folder.open(graph(clusters, nodes));
    let report = evaluate(&mut s, &["end.value", "n.value", "y.root"]);
    assert_eq!(items(&s, "n.value"), json!([2.0]));
    let all = lines(&report);
    let says = |start: &str| all.iter().any(|l| l.starts_with(start));
    assert!(says("error[linked-file] x: cluster \"gone\": gone.tenon.json cannot be used: no such file"), "{all:?}");
    assert!(says("note[blocked] end"), "{all:?}");
    let wrong = told(s.document());
    assert!(wrong.iter().any(|l| l.contains("bad.tenon.json cannot be used: it is not a readable graph: line 1")));
    assert_eq!(
        s.document().unread_links().map(|(path, _)| path).collect::<Vec<_>>(),
        ["bad.tenon.json", "gone.tenon.json"]
    );
}

#[test]
fn paths_in_a_linked_file_are_relative_to_its_folder() {
    let folder = Folder::default();
    let lib = json!({
        "format": "tenon",
        "interface": {"outputs": {"size": {"port": "read.size"}, "more": {"port": "in.size"}}},
        "clusters": {"next": {"file": "../next.tenon.json"}},
        "nodes": {"read": {"type": "read", "params": {"path": "data.txt"}}, "in": {"type": "cluster:next"}},
    });
    let next = json!({
        "format": "tenon",
        "interface": {"outputs": {"size": {"port": "read.size"}}},
        "nodes": {"read": {"type": "read", "params": {"path": "data.txt"}}},
    });
    folder.put("lib/lib.tenon.json", lib);
    folder.put("next.tenon.json", next);
    folder.put("lib/data.txt", json!(1234567));
    folder.put("data.txt", json!(12));
    let nodes = json!({"x": {"type": "cluster:lib"}});
    let document = graph(json!({"lib": {"file": "lib/lib.tenon.json"}}), nodes);
    let mut s = folder.open(document);
    let report = evaluate(&mut s, &["x.size", "x.more"]);
    assert!(report.diagnostics.is_empty(), "{:?}", lines(&report));
    assert_eq!((items(&s, "x.size"), items(&s, "x.more")), (json!([7]), json!([2])));

    // Taken into the file, the same: with the cluster that it needs, and with paths as seen from here.
    let embedded = s.document().embed("lib", &registry()).unwrap();
    s.edit(&embedded).unwrap();
    assert_eq!(s.document().clusters.keys().collect::<Vec<_>>(), ["lib", "next"]);
    evaluate(&mut s, &["x.size", "x.more"]);
    assert_eq!((items(&s, "x.size"), items(&s, "x.more")), (json!([7]), json!([2])));

    // Or in place of the instance.
    let mut s =
        folder.open(graph(json!({"lib": {"file": "lib/lib.tenon.json"}}), json!({"x": {"type": "cluster:lib"}})));
    let apart = s.document().explode("x", &registry()).unwrap();
    s.edit(&apart.operation).unwrap();
    let report = evaluate(&mut s, &["read.size", "in.size"]);
    assert!(report.diagnostics.is_empty(), "{:?}", lines(&report));
    assert_eq!((items(&s, "read.size"), items(&s, "in.size")), (json!([7]), json!([2])));
}

#[test]
fn files_that_link_to_each_other_are_read_once_and_named() {
    let folder = Folder::default();
    let linked =
        |to: &str| json!({"format": "tenon", "clusters": {"c": {"file": to}}, "nodes": {"i": {"type": "cluster:c"}}});
    folder.put("a.tenon.json", linked("b.tenon.json"));
    folder.put("b.tenon.json", linked("./a.tenon.json"));
    let mut document = graph(json!({"c": {"file": "a.tenon.json"}}), json!({"x": {"type": "cluster:c"}}));
    document.read_links(&folder);
    assert_eq!(
        told(&document),
        ["error[cluster-cycle] x/i: the cluster contains itself: a.tenon.json > b.tenon.json > a.tenon.json \
          (remove one of these instances)"]
    );
}
