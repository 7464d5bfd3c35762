//! `tenon schema`: what is printed is what is documented. A validator that nobody here wrote judges with it elsewhere.

use crate::tenon::Folder;

#[test]
fn the_documented_schema_is_the_one_that_is_printed() {
    let printed = Folder::new().tenon(&["schema"]).code(0).stdout;
    let documented = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/graph.schema.json");
    let documented = std::fs::read_to_string(documented).unwrap();
    assert!(printed == documented, "write it anew: tenon schema > docs/graph.schema.json");
}

#[test]
fn with_nodes_every_installed_type_has_its_ports() {
    let folder = Folder::new();
    let schema = folder.tenon(&["schema", "--nodes"]).code(0).json();
    let nodes = folder.tenon(&["nodes", "--json"]).code(0).json();
    for node in nodes.as_array().unwrap() {
        let name = node["type"].as_str().unwrap();
        let known = &schema["$defs"][format!("node.{name}")]["properties"];
        for port in node["inputs"].as_array().unwrap() {
            let port = port["name"].as_str().unwrap();
            assert!(known["params"]["properties"][port].is_object(), "{name}.{port}");
            assert!(known["inputs"]["properties"][port].is_object(), "{name}.{port}");
        }
    }
}
