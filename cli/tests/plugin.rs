//! Plugins: loaded, described, run in graphs, refused.

use crate::tenon::{Folder, NUMBERS};
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;
use std::process::Command;
use std::sync::OnceLock;

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// Compiles C into a library.
#[track_caller]
pub fn compile(source: &Path, name: &str, extra: &[&str]) -> String {
    let library = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name).with_extension(std::env::consts::DLL_EXTENSION);
    let done = Command::new("cc")
        .args(["-std=c11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-shared", "-fPIC", "-I"])
        .arg(root().join("plugin-sdk/include"))
        .args(extra)
        .arg(source)
        .arg("-o")
        .arg(&library)
        .arg("-lm")
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    library.display().to_string()
}

pub fn hinges() -> &'static str {
    static LIBRARY: OnceLock<String> = OnceLock::new();
    LIBRARY.get_or_init(|| compile(&root().join("plugin-sdk/examples/fastener-c/hinge.c"), "hinges", &[]))
}

/// Builds an example in Rust, as its README says.
#[track_caller]
fn rust_example(package: &str) -> String {
    let target = Path::new(env!("CARGO_BIN_EXE_tenon")).parent().unwrap().parent().unwrap();
    let done = Command::new(env!("CARGO"))
        .args(["build", "--quiet", "-p", package, "--target-dir"])
        .arg(target)
        .current_dir(root())
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let name = format!("{}{}{}", std::env::consts::DLL_PREFIX, package.replace('-', "_"), std::env::consts::DLL_SUFFIX);
    target.join("debug").join(name).display().to_string()
}

/// The graph of 256 panels with a fastener more, whose features join those of the screws.
pub fn shell_with(node: Value) -> Vec<u8> {
    let text = std::fs::read(root().join("graphs/shell-256/shell-256.tenon.json")).unwrap();
    let mut graph: Value = serde_json::from_slice(&text).unwrap();
    graph["nodes"]["more"] = node;
    for reader in ["map", "hardware"] {
        graph["nodes"][reader]["inputs"]["features"] = json!({ "from": ["more.features"] });
    }
    graph.to_string().into_bytes()
}

fn fastener(type_name: &str, params: Value) -> Vec<u8> {
    let wires = json!({ "panels": { "from": ["thicken.panels"] }, "machine": { "from": ["machine.machine"] } });
    shell_with(json!({ "type": type_name, "inputs": wires, "params": params }))
}

fn graph(node: Value) -> String {
    json!({ "format": "tenon", "version": 1, "units": "mm", "nodes": { "n": node } }).to_string()
}

#[test]
fn hinges_in_c_are_laid_on_every_edge_along_rows() {
    let folder = Folder::with("g.tenon.json", fastener("hinges.butt_hinge", json!({ "edges": "along rows" })));
    let ended = folder.tenon(&["run", "g.tenon.json", "--plugin", hinges(), "--get", "more.features"]).code(0);
    let features = &ended.json()["branches"]["{0}"][0];
    let drills = features["features"].as_array().unwrap();
    // 16 columns of 15 inner edges along rows, each 130 to 390 mm long; two holes in either panel.
    let hinges = features["hardware"][0]["count"].as_u64().unwrap();
    assert!(hinges >= 240, "{}", features["hardware"]);
    assert_eq!(features["hardware"][1], json!({ "name": "Screw 3 x 10", "count": 4 * hinges }));
    assert_eq!(drills.len() as u64, 4 * hinges);
    // The four holes of a hinge share a number and lie at the corners of a rectangle of 25 mm, 14 mm from the edge.
    let first: Vec<&Value> = drills.iter().filter(|d| d["joint"] == 0).collect();
    assert_eq!(first.len(), 4);
    let at =
        |d: &Value| d["shape"]["entry"].as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect::<Vec<_>>();
    let distance = |a: &Value, b: &Value| at(a).iter().zip(at(b)).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt();
    assert!((distance(first[0], first[1]) - 25.0).abs() < 1e-6);
    assert_ne!(first[0]["panel"], first[2]["panel"]);
}

#[test]
fn hinges_go_all_the_way_to_proven_programs() {
    let folder = Folder::with("g.tenon.json", fastener("hinges.butt_hinge", json!({})));
    let ended = folder.tenon(&["run", "g.tenon.json", "--plugin", hinges(), "--out", "out"]).code(0);
    assert!(ended.stderr.is_empty() || !ended.stderr.contains("error"), "{ended:#?}");
    assert!(folder.read("out/hardware.csv").contains("Butt hinge 40 x 40"));
}

#[test]
fn a_fastener_and_a_curve_in_rust() {
    let cams = rust_example("fastener-rust");
    let folder = Folder::with("g.tenon.json", fastener("cams.cam_connector", json!({ "spacing": 1 })));
    folder.tenon(&["run", "g.tenon.json", "--plugin", &cams, "--get", "more.count"]).code(1).says(&["spacing"]);
    // The machine has no drill for the default housing.
    folder.write("g.tenon.json", fastener("cams.cam_connector", json!({})));
    let ended = folder.tenon(&["run", "g.tenon.json", "--plugin", &cams, "--get", "more.count"]).code(1);
    ended.says(&["feature-out-of-reach", "cam: the machine has no drill of 15 mm"]);
    folder.write("g.tenon.json", fastener("cams.cam_connector", json!({ "diameter": 8 })));
    let count = folder.tenon(&["run", "g.tenon.json", "--plugin", &cams, "--get", "more.count"]).code(0).json();
    assert!(count["branches"]["{0}"][0].as_u64().unwrap() >= 480, "{count}");
    folder.write("g.tenon.json", fastener("cams.cam_connector", json!({ "depth": 12 })));
    // A plugin's own codes are the plugin's to explain, not the book's, so this call is made without asking the book.
    let mut tenon = Command::new(env!("CARGO_BIN_EXE_tenon"));
    let tenon = tenon.args(["run", "g.tenon.json", "--plugin", &cams, "--get", "more.count"]).current_dir(&folder.0);
    let ended = tenon.output().unwrap();
    let told = String::from_utf8_lossy(&ended.stderr);
    assert_eq!(ended.status.code(), Some(1));
    for words in ["bore-too-deep", "more.depth", "12 mm goes through panels of 10 mm"] {
        assert!(told.contains(words), "{told}");
    }

    let curves = rust_example("curve-rust");
    folder.write(
        "g.tenon.json",
        graph(json!({ "type": "curves.helix", "params": { "radius": 100, "segments": 4, "pitch": "1 cm" } })),
    );
    let curve = folder.tenon(&["run", "g.tenon.json", "--plugin", &curves, "--get", "n.curve"]).code(0).json();
    let points = &curve["branches"]["{0}"][0]["points"];
    assert_eq!((points[0].clone(), points.as_array().unwrap().len()), (json!([100.0, 0.0, 0.0]), 5));
    assert_eq!(points[4][2], 10.0);
    // Lists iterate as with any node.
    folder.write("g.tenon.json", graph(json!({ "type": "curves.helix", "params": { "radius": [1, 2, 3] } })));
    let lengths = folder.tenon(&["run", "g.tenon.json", "--plugin", &curves, "--get", "n.length"]).code(0).json();
    assert_eq!(lengths["branches"]["{0}"].as_array().unwrap().len(), 3);
}

#[test]
fn plugins_are_listed_described_and_found_in_folders() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let info = folder.tenon(&["plugin", "info", hinges(), "--json"]).code(0).json();
    assert_eq!((&info["id"], &info["nodes"][0]["type"]), (&json!("hinges"), &json!("hinges.butt_hinge")));
    let list = folder.tenon(&["plugin", "list", "--json", "--plugin", hinges()]).code(0).json();
    assert_eq!(list["plugins"][0]["nodes"], json!(["hinges.butt_hinge"]));
    folder.tenon(&["nodes", "hinges.butt_hinge", "--plugin", hinges()]).code(0);
    // A folder that the variable names; a relative one is not looked into.
    let place = folder.0.join("plugins");
    std::fs::create_dir(&place).unwrap();
    std::fs::copy(hinges(), place.join("hinges.so")).unwrap();
    std::fs::write(place.join("broken.so"), b"no library").unwrap();
    let run = |path: &str| {
        let mut tenon = Command::new(env!("CARGO_BIN_EXE_tenon"));
        let tenon = tenon.args(["plugin", "list", "--json"]).current_dir(&folder.0).env("XDG_DATA_HOME", &folder.0);
        let out = tenon.env("TENON_PLUGIN_PATH", path).output().unwrap();
        serde_json::from_slice::<Value>(&out.stdout).unwrap()
    };
    let found = run(&place.display().to_string());
    assert_eq!(
        (found["plugins"].as_array().unwrap().len(), found["refused"].as_array().unwrap().len()),
        (1, 1),
        "{found}"
    );
    assert!(found["refused"][0].as_str().unwrap().contains("broken.so"));
    assert_eq!(run("plugins:.:")["plugins"], json!([]));
    // The user's own folder, which needs no variable.
    let own = folder.0.join("tenon/plugins");
    std::fs::create_dir_all(&own).unwrap();
    std::fs::copy(hinges(), own.join("mine.so")).unwrap();
    let found = run("");
    assert_eq!(found["plugins"][0]["path"], json!(own.canonicalize().unwrap().join("mine.so").display().to_string()));
    assert_eq!((&found["plugins"][0]["id"], &found["refused"]), (&json!("hinges"), &json!([])));
    let mut tenon = Command::new(env!("CARGO_BIN_EXE_tenon"));
    let tenon = tenon.args(["nodes", "hinges.butt_hinge"]).current_dir(&folder.0).env("XDG_DATA_HOME", &folder.0);
    assert!(tenon.env_remove("TENON_PLUGIN_PATH").status().unwrap().success());
}

#[test]
fn a_graph_says_which_plugins_it_needs() {
    let requires = |range: &str| {
        let mut graph: Value = serde_json::from_slice(&fastener("hinges.butt_hinge", json!({}))).unwrap();
        graph["requires"] = json!({ "hinges": range });
        graph.to_string()
    };
    let folder = Folder::with("g.tenon.json", requires(">=1, <2"));
    folder.tenon(&["check", "g.tenon.json", "--plugin", hinges()]).code(0);
    let without = folder.tenon(&["check", "g.tenon.json"]).code(1);
    without.says(&["missing-plugin", "hinges", "--plugin LIBRARY"]);
    // The rest of the graph is evaluated, and the node says what to install.
    let before = folder.read("g.tenon.json");
    let ended = folder.tenon(&["run", "g.tenon.json", "--get", "thicken.panels", "--json"]).code(1);
    let report = ended.json();
    assert!(!report["values"]["thicken.panels"].is_null());
    let of = |code: &str| report["diagnostics"].as_array().unwrap().iter().find(|d| d["code"] == code).cloned();
    assert!(of("missing-plugin").unwrap()["hint"].as_str().unwrap().contains("--plugin LIBRARY"));
    let ended = folder.tenon(&["run", "g.tenon.json", "--out", "out"]).code(1);
    ended.says(&["unknown-node", "at more", "needs the plugin hinges >=1, <2", "--plugin LIBRARY", "blocked"]);
    folder.tenon(&["run", "g.tenon.json", "--get", "more.count"]).code(2).says(&["--plugin LIBRARY"]);
    folder.tenon(&["fmt", "g.tenon.json"]).code(0);
    let again: Value = serde_json::from_str(&folder.read("g.tenon.json")).unwrap();
    let before: Value = serde_json::from_str(&before).unwrap();
    assert_eq!(
        (&again["nodes"]["more"]["inputs"], &again["requires"]),
        (&before["nodes"]["more"]["inputs"], &before["requires"])
    );
    assert_eq!(again["nodes"].as_object().unwrap().len(), before["nodes"].as_object().unwrap().len());
    // One of another version is as good as none.
    folder.write("g.tenon.json", requires(">=2"));
    folder.tenon(&["check", "g.tenon.json", "--plugin", hinges()]).code(1).says(&["hinges >=2", "1.0.0", "at more"]);
    folder.write("g.tenon.json", requires("new"));
    folder.tenon(&["check", "g.tenon.json", "--plugin", hinges()]).code(1).says(&["range of versions"]);
}

#[test]
fn libraries_that_are_no_plugins_are_refused() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    for (text, told) in [
        ("int nothing;", "does not export tenon_plugin_v1"),
        (
            "const void *tenon_plugin_v1(void); const void *tenon_plugin_v1(void) { return 0; }",
            "tenon_plugin_v1 gave 0x0",
        ),
    ] {
        folder.write("p.c", text);
        let library = compile(&folder.0.join("p.c"), &format!("refused{}", told.len()), &[]);
        folder.tenon(&["run", "g.tenon.json", "--plugin", &library]).code(2).says(&[told]);
    }
    folder.tenon(&["run", "g.tenon.json", "--plugin", "nowhere.so"]).code(2).says(&["nowhere.so", "cannot be loaded"]);
    // The example with one thing changed: magic number, version of the contract, ids, ranges, missing words.
    let example = std::fs::read_to_string(root().join("plugin-sdk/examples/fastener-c/hinge.c")).unwrap();
    for (n, (from, to, told)) in [
        (".magic = TENON_PLUGIN_MAGIC", ".magic = 7", "magic number is 0x7"),
        (".abi_major = TENON_PLUGIN_MAJOR", ".abi_major = 2", "version 2 of the plugin contract"),
        (".abi_major = TENON_PLUGIN_MAJOR", ".abi_major = 0", "build it with the plugin-sdk of this Tenon"),
        ("return &plugin; }", "return (const void *)((const char *)&plugin + 1); }", "tenon_plugin_v1 gave 0x"),
        (".nodes = nodes", ".nodes = NULL", "1 node types at 0x0"),
        (".nodes = nodes", ".nodes = (const void *)((const char *)nodes + 4)", "1 node types at 0x"),
        (".inputs = inputs", ".inputs = (const void *)((const char *)inputs + 2)", "5 ports at 0x"),
        (".input_count = COUNT(inputs)", ".input_count = 1000", "1000 ports at 0x"),
        (".port_stride = sizeof(tenon_port)", ".port_stride = 113", "port_stride is 113"),
        (".size = sizeof(tenon_node_type)", ".size = 100", "the size of tenon_node_type is 100"),
        (
            "{sizeof(tenon_port), TENON_RANGE, TENON_NUMBER",
            "{8, TENON_RANGE, TENON_NUMBER",
            "the size of tenon_port is 8",
        ),
        ("{sizeof(tenon_port), TENON_RANGE, TENON_NUMBER", "{sizeof(tenon_port), TENON_RANGE, 77", "its kind is 77"),
        (".node_stride = sizeof(tenon_node_type)", ".node_stride = 157", "node_stride is 157"),
        (".id = TEXT(\"hinges\")", ".id = {\"hinges\", UINT64_MAX}", "longer than 1 MiB"),
        (".size = sizeof(tenon_plugin)", ".size = 24", "the size of tenon_plugin is 24"),
        ("TEXT(\"hinges.butt_hinge\")", "TEXT(\"butt_hinge\")", "must be \"hinges.\""),
        ("TEXT(\"hinges.butt_hinge\")", "TEXT(\"hinges.\\xff\")", "UTF-8"),
        (".evaluate = evaluate", ".evaluate = NULL", "evaluate is NULL"),
        (".version = 1,", ".version = 0,", "version is 0"),
        ("\"200\", 20, 1e4", "\"200\", 20, 10", "range 20 to 10"),
        ("\"200\", 20, 1e4", "\"wide\", 20, 1e4", "is not JSON"),
        ("\"200\", 20, 1e4", "\"2\", 20, 1e4", "outside 20 to 10000"),
        ("TEXT(\"mm\")", "TEXT(\"ell\")", "unit \"ell\""),
        (".node_count = COUNT(nodes)", ".node_count = 0", "0 node types"),
        (".node_stride = sizeof(tenon_node_type)", ".node_stride = 8", "node_stride is 8"),
        ("MM(\"setback\"", "MM(\"spacing\"", "\"spacing\" twice"),
    ]
    .into_iter()
    .enumerate()
    {
        assert!(example.contains(from), "{from}");
        folder.write("p.c", example.replace(from, to));
        let library = compile(&folder.0.join("p.c"), &format!("spoilt{n}"), &["-Wno-error", "-w"]);
        folder.tenon(&["plugin", "info", &library]).code(2).says(&[told]);
    }
}

/// As one in Rust would be that was built from a changed source: both lines of why are shown.
#[test]
fn a_plugin_that_was_laid_out_otherwise_is_refused_by_the_field() {
    let folder = Folder::with(
        "p.c",
        r#"
#define tenon_plugin_v1 unchanged
#include "hinge.c"
#undef tenon_plugin_v1
static const tenon_field fields[] = {{TEXT("tenon_vec3"), TEXT("x"), 0, 8}, {TEXT("tenon_feature"), TEXT("depth"), 100, 8}};
static const tenon_layout layout = {sizeof layout, sizeof(tenon_field), 0, fields, COUNT(fields)};
TENON_EXPORT const tenon_plugin *tenon_plugin_v1(void);
const tenon_plugin *tenon_plugin_v1(void) {
    static tenon_plugin changed;
    changed = *unchanged();
    changed.layout = &layout;
    return &changed;
}
"#,
    );
    let beside = root().join("plugin-sdk/examples/fastener-c").display().to_string();
    let library = compile(&folder.0.join("p.c"), "laid-out-otherwise", &["-I", &beside]);
    let lines = [
        "tenon_feature.depth is 8 bytes after 100 in the plugin and 8 bytes after 96 in this program\n",
        "build it anew, for this program's system, with the plugin-sdk of this Tenon (contract 1.",
    ];
    folder.tenon(&["plugin", "info", &library]).code(2).says(&lines);
    let place = folder.0.join("plugins");
    std::fs::create_dir(&place).unwrap();
    std::fs::copy(&library, place.join("changed.so")).unwrap();
    let mut tenon = Command::new(env!("CARGO_BIN_EXE_tenon"));
    let tenon = tenon.args(["plugin", "list"]).current_dir(&folder.0).env("XDG_DATA_HOME", &folder.0);
    let listed = tenon.env("TENON_PLUGIN_PATH", &place).output().unwrap();
    let told = String::from_utf8_lossy(&listed.stdout);
    assert!(lines.iter().all(|line| told.contains(line)), "{told}");
    assert_eq!(listed.status.code(), Some(1));
}

fn faulty() -> &'static str {
    static LIBRARY: OnceLock<String> = OnceLock::new();
    let source = || root().join("cli/tests/data/faulty.c");
    LIBRARY.get_or_init(|| compile(&source(), "faulty", &["-Wno-missing-field-initializers"]))
}

#[test]
fn what_cannot_be_is_refused_here_and_apart() {
    // By number: what is said of it. The faults are those of `faulty.c`.
    const SAID: [&str; 23] = [
        "",
        "numbers is NULL",
        "numbers is misaligned",
        "numbers: 1152921504606846976 is impossible",
        "column.stride: 4 is impossible; set it to sizeof one item",
        "kind 99 is not known",
        "text is not UTF-8 after byte 0",
        "tree.size: 0 is impossible; set it to sizeof(tenon_tree)",
        "branches: 3 is impossible as the bytes from one to the next",
        "branches is NULL",
        "tree is NULL",
        "tree is misaligned",
        "output 7: there is no such output",
        "face_start must begin with 0, never fall, and end with the number of entries",
        "face_vertices: 9 is not below 3",
        "feature.kind 9 is not known",
        "tell: message is NULL",
        "output 0: there is no input 5",
        "tell: message is misaligned",
        "evaluate gave the status -77",
        "path is misaligned",
        "tree is NULL",
        "kind 0 is not known",
    ];
    let folder = Folder::new();
    let numbers: Vec<usize> = (0..SAID.len()).collect();
    folder.write("g.tenon.json", graph(json!({ "type": "faulty.value", "v": 3, "params": { "x": numbers } })));
    let run = |more: &[&str]| {
        let call = ["run", "g.tenon.json", "--plugin", faulty(), "--json"];
        folder.tenon(&[&call[..], more].concat()).code(1).json()["diagnostics"].clone()
    };
    let here = run(&[]);
    let told = here.as_array().unwrap();
    assert_eq!(told.len(), SAID.len() - 1, "{here:#}");
    for (d, (n, said)) in told.iter().zip(SAID.iter().enumerate().skip(1)) {
        assert_eq!((&d["code"], &d["item"]), (&json!("plugin-fault"), &json!(n)), "{d}");
        assert!(d["message"].as_str().unwrap().contains(said), "{n}: {d}");
    }
    #[cfg(target_os = "linux")]
    assert_eq!(run(&["--isolate", "all"]), here);
}

#[test]
fn nodes_of_older_versions_are_brought_forward_by_their_plugin() {
    let folder = Folder::new();
    let old = |v: u32, params: Value| graph(json!({ "type": "faulty.value", "v": v, "params": params }));
    let isolated: &[&str] = if cfg!(target_os = "linux") { &["--isolate", "all"] } else { &[] };
    for isolate in [&[][..], isolated] {
        let tenon = |args: &[&str]| folder.tenon(&[args, &["--plugin", faulty()], isolate].concat());
        folder.write("g.tenon.json", old(1, json!({ "old": 0 })));
        let ended = tenon(&["run", "g.tenon.json", "--get", "n.y"]).code(0);
        assert_eq!(ended.json()["branches"]["{0}"], json!([1.0]));
        ended.says(&["migrated-node", "from version 1 of \"faulty.value\" to 3"]);
        tenon(&["fmt", "g.tenon.json"]).code(0);
        let now: Value = serde_json::from_str(&folder.read("g.tenon.json")).unwrap();
        assert_eq!(now["nodes"]["n"], json!({ "params": { "x": 0 }, "type": "faulty.value", "v": 3 }));
        folder.write("g.tenon.json", old(2, json!({ "x": "stuck" })));
        tenon(&["check", "g.tenon.json"]).code(1).says(&["migration-failed", "it is stuck"]);
    }
}

#[test]
fn tables_cross_both_ways_with_their_gaps() {
    let node = |type_name: &str, from: &[(&str, &str)], params: Value| {
        let inputs: serde_json::Map<String, Value> =
            from.iter().map(|(port, wire)| ((*port).to_owned(), json!({ "from": [wire] }))).collect();
        json!({ "type": type_name, "v": 1, "inputs": inputs, "params": params })
    };
    // The third place is a gap.
    let nodes = json!({
        "gaps": node("list_item", &[], json!({ "list": [2.5, 7.5], "index": [0, 1, 5] })),
        "one": node("set_attribute", &[("values", "gaps.items")], json!({ "name": "length" })),
        "two": node("set_attribute", &[("table", "one.table")], json!({ "name": "kind", "values": ["a", "b", "c"] })),
        "rows": node("faulty.number_rows", &[("table", "two.table")], json!({})),
        "row": node("attribute", &[("table", "rows.table")], json!({ "name": "row" })),
        "none": node("attribute", &[("table", "rows.table")], json!({ "name": "colour" })),
        "short": node("set_attribute", &[("table", "one.table")], json!({ "name": "few", "values": [1] })),
    });
    let folder = Folder::new();
    folder.write("g.tenon.json", json!({ "format": "tenon", "version": 1, "units": "mm", "nodes": nodes }).to_string());
    let run = |more: &[&str]| {
        let call = ["run", "g.tenon.json", "--plugin", faulty(), "--get", "rows.table", "--get", "row.values"];
        folder.tenon(&[&call[..], more].concat()).code(1).json()
    };
    let here = run(&[]);
    let table =
        json!({ "rows": 3, "attributes": { "length": [2.5, 7.5, null], "kind": ["a", "b", "c"], "row": [0, 1, 2] } });
    assert_eq!(here["rows.table"]["branches"]["{0}"][0], table);
    assert_eq!(here["row.values"]["branches"]["{0}"], json!([0, 1, 2]));
    let ended = folder.tenon(&["run", "g.tenon.json", "--plugin", faulty()]).code(1);
    ended.says(&["no-attribute", "it has length, kind, row", "attribute-length", "1 items for a table of 3 rows"]);
    #[cfg(target_os = "linux")]
    assert_eq!(run(&["--isolate", "all"]), here);
}

#[test]
fn two_plugins_with_one_id_are_one_too_many() {
    let folder = Folder::with("g.tenon.json", NUMBERS);
    let other = folder.0.join("other.so").display().to_string();
    std::fs::copy(hinges(), &other).unwrap();
    let ended = folder.tenon(&["run", "g.tenon.json", "--plugin", hinges(), "--plugin", &other]).code(2);
    ended.says(&["other.so", "hinges.butt_hinge"]);
}

/// A plugin of a later minor version: its structs have grown, it says so, and it is loaded as far as we know it.
#[test]
fn a_plugin_of_a_later_version_is_loaded() {
    let (folder, mut raised) = (Folder::new(), 0);
    for name in ["tenon_value.h", "tenon_plugin.h"] {
        let text = std::fs::read_to_string(root().join("plugin-sdk/include").join(name)).unwrap();
        let mut out = String::new();
        let mut grows = "";
        for line in text.lines() {
            if let Some(rest) = line.strip_prefix("typedef struct ") {
                let names =
                    "curve mesh panels feature features column attribute branch table port message node_type plugin"
                        .split(' ');
                let name = rest.trim_end_matches(" {");
                grows = if names.clone().any(|n| name == format!("tenon_{n}")) { "  uint64_t later[3];\n" } else { "" };
            } else if line.starts_with("} tenon_") {
                out += grows;
            }
            let minor = line.starts_with("#define TENON_PLUGIN_MINOR ");
            raised += u32::from(minor);
            out += if minor { "#define TENON_PLUGIN_MINOR 9" } else { line };
            out += "\n";
        }
        folder.write(name, out);
    }
    assert_eq!(raised, 1);
    std::fs::copy(root().join("plugin-sdk/examples/fastener-c/hinge.c"), folder.0.join("hinge.c")).unwrap();
    // Its own headers come first: they stand beside it.
    let newer = compile(&folder.0.join("hinge.c"), "newer", &["-w"]);
    folder.write("g.tenon.json", fastener("hinges.butt_hinge", json!({})));
    let run = |library: &str| {
        folder.tenon(&["run", "g.tenon.json", "--plugin", library, "--get", "more.features"]).code(0).json()
    };
    assert_eq!(run(&newer), run(hinges()));
}

/// The checks that a library fails, each with what it found.
fn failed(folder: &Folder, library: &str, code: i32) -> BTreeMap<String, String> {
    let told = folder.tenon(&["plugin", "check", library, "--json", "--junit", "checks.xml"]).code(code).json();
    let checks = told["checks"].as_array().unwrap();
    assert!(checks.len() >= 40, "{}", checks.len());
    assert_eq!(folder.read("checks.xml").matches("<testcase").count(), checks.len());
    let book = std::fs::read_to_string(root().join("docs/plugins.md")).unwrap();
    for check in checks {
        assert!(book.contains(&format!("`{}`", check["check"].as_str().unwrap())), "{check} is not in the book");
    }
    let found = |c: &Value| (c["check"].as_str().unwrap().to_owned(), c["faults"].to_string());
    checks.iter().filter(|c| c["passed"] == false).map(found).collect()
}

#[test]
fn the_examples_pass_every_check() {
    let folder = Folder::new();
    for library in [hinges().to_owned(), rust_example("fastener-rust"), rust_example("curve-rust")] {
        assert_eq!(failed(&folder, &library, 0), BTreeMap::new(), "{library}");
    }
}

#[test]
fn a_plugin_that_misbehaves_fails_the_checks_that_it_should() {
    let source = root().join("plugin-sdk/examples/misbehaving-c/misbehaving.c");
    let found = failed(&Folder::new(), &compile(&source, "misbehaving", &["-pthread"]), 1);
    // What the comments in the source name: the checks that the node below fails, and no others.
    let text = std::fs::read_to_string(source).unwrap();
    let mut named: BTreeMap<&str, BTreeSet<&str>> = BTreeMap::new();
    let mut checks: Vec<&str> = Vec::new();
    for line in text.lines() {
        if let Some(comment) = line.strip_prefix("/* ").and_then(|l| l.strip_suffix(" */")) {
            let names = comment.split(':').next().unwrap().split(", ");
            checks = names.filter(|name| !name.contains(' ')).collect();
            for check in &checks {
                named.entry(check).or_default();
            }
        } else if let Some(node) = line.strip_prefix("EVALUATE(") {
            let node = node.split(')').next().unwrap();
            for check in checks.drain(..) {
                named.entry(check).or_default().insert(node);
            }
        }
    }
    assert_eq!(found.keys().map(String::as_str).collect::<Vec<_>>(), named.keys().copied().collect::<Vec<_>>());
    let nodes: BTreeSet<&str> = named.values().flatten().copied().collect();
    for (check, told) in &found {
        let told_of = |node: &&&str| told.contains(&format!("misbehaving.{node}"));
        let guilty: BTreeSet<&str> = nodes.iter().filter(told_of).copied().collect();
        // A crash and what is wrong with the whole library name no node.
        assert!(guilty.is_empty() || guilty == named[check.as_str()], "{check}: {told}");
    }
    for (check, words) in [
        ("leaves-inputs-alone", "misbehaving.furtive: it wrote to an input"),
        ("older-host", "misbehaving.presumptuous: it reads behind what it is given"),
        ("newer-host", "misbehaving.strict: "),
    ] {
        assert!(found[check].contains(words), "{}", found[check]);
    }
}

#[test]
fn a_crash_in_one_check_is_a_finding() {
    let folder = Folder::with(
        "p.c",
        "#include <stdlib.h>\nconst void *tenon_plugin_v1(void);\nconst void *tenon_plugin_v1(void) { abort(); }",
    );
    let library = compile(&folder.0.join("p.c"), "abort", &[]);
    let told = folder.tenon(&["plugin", "check", &library, "--only", "loads"]).code(1);
    assert!(told.stdout.contains("FAILED  loads") && told.stdout.contains("signal"), "{told:#?}");
    folder.tenon(&["plugin", "check", &library, "--only", "nothing"]).code(2).says(&["nothing", "same-again"]);
    folder.tenon(&["plugin", "check", "nowhere.so"]).code(2).says(&["nowhere.so"]);
}

#[test]
fn a_new_plugin_builds_loads_and_passes() {
    let folder = Folder::new();
    folder.tenon(&["plugin", "new", "acme", "--c"]).code(0);
    let library = compile(&folder.0.join("acme/acme.c"), "acme", &[]);
    let info = folder.tenon(&["plugin", "info", &library, "--json"]).code(0).json();
    assert_eq!((&info["id"], &info["nodes"][0]["type"]), (&json!("acme"), &json!("acme.butt_hinge")));
    assert_eq!(failed(&folder, &library, 0), BTreeMap::new());
    folder.tenon(&["plugin", "new", "acme"]).code(2).says(&["there already"]);
    folder.tenon(&["plugin", "new", "../acme"]).code(2).says(&["lower case"]);
    folder.tenon(&["plugin", "new", "rusty"]).code(0);
    assert!(folder.read("rusty/src/lib.rs").contains("\"rusty.cam_connector\""));
}

/// The C example as it was compiled when version 1.0 of the contract was new. It is never compiled anew.
#[test]
#[cfg(all(target_os = "linux", target_arch = "x86_64"))]
fn a_plugin_of_the_first_version_is_loaded_for_ever() {
    let old = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/hinges-1.0-x86_64-linux.so");
    let folder = Folder::with("g.tenon.json", fastener("hinges.butt_hinge", json!({ "edges": "along rows" })));
    let run = |library: &str| {
        folder.tenon(&["run", "g.tenon.json", "--plugin", library, "--get", "more.features"]).code(0).json()
    };
    assert_eq!(run(old), run(hinges()));
}
