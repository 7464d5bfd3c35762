//! Every node is described well enough to be found and used.

use std::collections::BTreeSet;

#[test]
fn every_node_and_port_is_documented() {
    let registry = tenon_nodes::registry();
    for node in registry.iter() {
        let about = node.describe();
        let text = |key: &str| about[key].as_str().unwrap_or_default().to_string();
        assert!(!text("doc").is_empty() && !text("name").is_empty() && !text("category").is_empty(), "{about:#}");
        for port in node.inputs().iter().chain(node.outputs()) {
            let doc = port.describe()["doc"].as_str().unwrap_or_default().to_string();
            assert!(doc.ends_with('.'), "{}.{}: \"{doc}\"", node.type_name(), port.name());
        }
        let names: Vec<&str> = node.inputs().iter().map(|p| p.name()).collect();
        assert_eq!(names.iter().collect::<BTreeSet<_>>().len(), names.len(), "{} names a port twice", node.type_name());
    }
}

#[test]
fn the_nodes_of_the_chain_are_there() {
    let registry = tenon_nodes::registry();
    for name in [
        "ifs_curve",
        "vector_sum",
        "tensor_product",
        "planarize",
        "order_faces",
        "thicken",
        "detail",
        "map",
        "pack",
        "toolpath",
        "post",
        "prove",
        "number",
        "integer",
        "text",
        "boolean",
        "point",
        "vector",
        "plane",
        "list",
        "range",
        "series",
        "read_mesh",
        "write_obj",
        "write_dxf",
        "write_svg",
        "write_pieces",
        "write_gcode",
    ] {
        assert!(registry.get(name).is_some(), "{name} is missing");
    }
}
