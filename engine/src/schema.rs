//! The JSON Schema (draft 2020-12) of the graph file, for editors that complete and for programs that make graphs.
//! It says what the loader accepts of the file's form, and with a registry also which parameters and inputs there are.

use crate::document::cluster::PREFIX;
use crate::document::model::TreeOp;
use crate::document::{DEPTH_LIMIT, NodeState};
use crate::evaluate::matching::Matching;
use crate::port::Port;
use crate::registry::{NodeType, Registry};
use crate::value::Json;
use serde_json::{Map, json};

/// `node.port`.
const ADDRESS: &str = r"^[^.]+\..+$";
/// A node's id: not empty, no dot, no control characters.
const ID: &str = r"^[^.\x00-\x1f\x7f-\x9f]+$";

/// The schema of the graph file as this version reads it; node types, parameters and ports by any name. O(1).
#[must_use]
pub fn schema() -> Json {
    build(None)
}

/// The schema of graph files that use only the node types of `registry`: each with its parameters (type, unit, range,
/// choices, default) and inputs. O(ports).
#[must_use]
pub fn schema_with_nodes(registry: &Registry) -> Json {
    build(Some(registry))
}

fn build(registry: Option<&Registry>) -> Json {
    let mut defs = Map::new();
    defs.insert("address".into(), json!({ "type": "string", "pattern": ADDRESS, "description": "node.port" }));
    defs.insert(
        "addresses".into(),
        json!({
            "anyOf": [
                { "$ref": "#/$defs/address" },
                { "type": "array", "items": { "$ref": "#/$defs/address" } },
            ],
        }),
    );
    let rules = [Matching::Longest, Matching::Shortest, Matching::Cross].map(Matching::as_str);
    defs.insert(
        "match".into(),
        json!({ "enum": rules, "description": "How lists of unequal length meet; the node's own rule goes first." }),
    );
    defs.insert("tree".into(), json!({ "enum": TreeOp::ALL.map(TreeOp::as_str) }));
    defs.insert(
        "wires".into(),
        json!({
            "description": "What comes to one input by wire.",
            "type": "object",
            "required": ["from"],
            "properties": {
                "from": { "$ref": "#/$defs/addresses", "description": "Sources, in order." },
                "tree": {
                    "description": "Applied in order to what arrives.",
                    "anyOf": [
                        { "$ref": "#/$defs/tree" },
                        { "type": "array", "items": { "$ref": "#/$defs/tree" } },
                    ],
                },
                "match": { "$ref": "#/$defs/match" },
            },
        }),
    );
    defs.insert("interface".into(), interface());
    defs.insert("cluster".into(), cluster());
    defs.insert(
        "nodes".into(),
        json!({
            "description": "The nodes by id.",
            "type": "object",
            "propertyNames": { "pattern": ID },
            "additionalProperties": { "$ref": "#/$defs/node" },
        }),
    );
    defs.insert("node".into(), node(registry));
    for node_type in registry.into_iter().flat_map(Registry::iter) {
        // Apart from the names above, whatever a node type is called.
        defs.insert(format!("node.{}", node_type.type_name()), of_type(node_type));
    }
    json!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Tenon graph",
        "description": format!("A graph of nodes: what *.tenon.json holds, nested at most {DEPTH_LIMIT} levels deep. \
                                Keys that are not named here are kept as they are."),
        "type": "object",
        "required": ["format"],
        "properties": {
            "format": { "const": "tenon" },
            "version": { "const": 1 },
            "units": { "const": "mm" },
            "requires": requires(),
            "interface": { "$ref": "#/$defs/interface" },
            "nodes": { "$ref": "#/$defs/nodes" },
            "groups": { "type": "object", "description": "Named groups of nodes." },
            "clusters": {
                "description": "Graphs that nodes of type cluster:NAME are instances of, by name.",
                "type": "object",
                "additionalProperties": { "$ref": "#/$defs/cluster" },
            },
            "x": { "description": "Data of other programs, kept byte for byte." },
        },
        "$defs": defs,
    })
}

/// Plugins by id.
fn requires() -> Json {
    json!({
        "description": "Plugins that the graph needs, by id.",
        "type": "object",
        "additionalProperties": {
            "anyOf": [
                { "type": "string", "description": "Range of versions, such as \">=1.2, <2\"." },
                {
                    "type": "object",
                    "properties": {
                        "version": { "type": "string", "description": "Range of versions." },
                        "isolation": {
                            "enum": ["process", "none"],
                            "description": "Whether it runs in a process of its own.",
                        },
                        "timeout_s": {
                            "type": "number",
                            "exclusiveMinimum": 0,
                            "description": "Longest time without an answer or progress in a process of its own, s.",
                        },
                        "memory_mib": {
                            "type": "number",
                            "exclusiveMinimum": 0,
                            "description": "The most memory that it may take in a process of its own, MiB.",
                        },
                    },
                    "additionalProperties": false,
                },
            ],
        },
    })
}

/// A definition in the file, or a link to another file.
fn cluster() -> Json {
    json!({
        "type": "object",
        "if": { "required": ["file"] },
        "then": {
            "description": "A cluster that is another graph's file.",
            "properties": {
                "file": { "type": "string", "description": "Path of the graph, relative to this file." },
                "version": {
                    "type": "integer",
                    "minimum": 1,
                    "maximum": u32::MAX,
                    "description": "The version that the file's interface must have.",
                },
                "digest": { "type": "string", "description": "The digest that the file's content must have." },
                "nodes": false,
                "interface": false,
            },
        },
        "else": {
            "description": "A cluster that stands in this file.",
            "properties": {
                "requires": requires(),
                "interface": { "$ref": "#/$defs/interface" },
                "nodes": { "$ref": "#/$defs/nodes" },
                "groups": { "type": "object", "description": "Named groups of nodes." },
                "clusters": false,
                "x": { "description": "Data of other programs, kept byte for byte." },
            },
        },
    })
}

fn interface() -> Json {
    let text = |doc: &str| json!({ "type": "string", "description": doc });
    json!({
        "description": "What a person, a script or a host sees of the graph.",
        "type": "object",
        "properties": {
            "version": {
                "type": "integer",
                "minimum": 1,
                "maximum": u32::MAX,
                "description": "Raised when instances of this graph as a cluster would mean something else; 1 if not said.",
            },
            "doc": text("What the graph does, for those who use it as a cluster."),
            "inputs": {
                "type": "object",
                "additionalProperties": {
                    "type": "object",
                    "required": ["port"],
                    "properties": {
                        "port": { "$ref": "#/$defs/addresses" },
                        "unit": text("Sign of the unit, for people."),
                        "min": { "type": "number", "description": "Smallest number accepted." },
                        "max": { "type": "number", "description": "Largest number accepted." },
                        "step": { "type": "number", "exclusiveMinimum": 0, "description": "By how much people slide it, above 0." },
                        "doc": text("What it means."),
                        "order": { "type": "integer", "description": "Its place among the others, the smallest first." },
                    },
                },
            },
            "outputs": {
                "type": "object",
                "additionalProperties": {
                    "type": "object",
                    "required": ["port"],
                    "properties": {
                        "port": { "$ref": "#/$defs/address" },
                        "unit": text("Sign of the unit, for people."),
                        "doc": text("What it means."),
                        "order": { "type": "integer", "description": "Its place among the others, the smallest first." },
                    },
                },
            },
        },
    })
}

/// What all nodes have; with a registry, what follows from the type as well.
fn node(registry: Option<&Registry>) -> Json {
    let states = NodeState::ALL.map(NodeState::as_str);
    let mut node = json!({
        "type": "object",
        "required": ["type"],
        "properties": {
            "type": { "type": "string", "description": "The node type." },
            "v": {
                "type": "integer",
                "minimum": 1,
                "maximum": u32::MAX,
                "description": "The version of the node type for which this was written.",
            },
            "params": { "type": "object", "description": "Literals by port." },
            "inputs": {
                "type": "object",
                "additionalProperties": { "$ref": "#/$defs/wires" },
                "description": "Wires by port; a wire overrules a literal.",
            },
            "match": { "$ref": "#/$defs/match" },
            "state": { "enum": states },
            "note": { "type": "string" },
        },
    });
    if let Some(registry) = registry {
        let names: Vec<&str> = registry.iter().map(|t| t.type_name()).collect();
        node["properties"]["type"] = json!({
            "type": "string",
            "description": "The node type.",
            "anyOf": [{ "enum": names }, { "pattern": format!("^{PREFIX}") }],
        });
        node["allOf"] = names
            .iter()
            .map(|name| {
                json!({
                    "if": { "properties": { "type": { "const": name } } },
                    "then": { "$ref": format!("#/$defs/node.{name}") },
                })
            })
            .collect();
    }
    node
}

fn of_type(node_type: &NodeType) -> Json {
    let params: Map<String, Json> = node_type.inputs().iter().map(|p| (p.name().into(), literal(p))).collect();
    let wires: Map<String, Json> = node_type
        .inputs()
        .iter()
        .map(|p| (p.name().into(), json!({ "$ref": "#/$defs/wires", "description": &*p.doc })))
        .collect();
    json!({
        "title": node_type.title(),
        "description": node_type.describe()["doc"],
        "properties": {
            "params": { "properties": params, "additionalProperties": false },
            "inputs": { "properties": wires, "additionalProperties": false },
        },
    })
}

/// What a parameter of that port may be. Types that only the program can judge (points, meshes) are left open here.
fn literal(port: &Port) -> Json {
    let facts = port.describe();
    let one = match port.type_name() {
        kind @ ("number" | "integer") => {
            let mut number = json!({ "type": kind });
            for (from, to) in [("min", "minimum"), ("max", "maximum")] {
                if facts[from].is_number() {
                    number[to] = facts[from].clone();
                }
            }
            // With a unit, only the program can tell the range.
            let quantity = json!({
                "type": "object",
                "required": ["value", "unit"],
                "properties": { "value": { "type": "number" }, "unit": { "type": "string" } },
                "additionalProperties": false,
            });
            Some(vec![number, json!({ "type": "string" }), quantity])
        }
        "boolean" => Some(vec![json!({ "type": "boolean" })]),
        "text" if facts["choices"].is_array() => Some(vec![json!({ "enum": facts["choices"] })]),
        "text" => Some(vec![json!({ "type": "string" })]),
        _ => None,
    };
    let mut schema = Map::new();
    if let Some(mut accepted) = one {
        let items = [&accepted[..], &[json!({ "type": "null" })]].concat();
        let mut list = json!({ "type": "array", "items": { "anyOf": items } });
        if port.access() == crate::Access::Item {
            list["minItems"] = 1.into();
        }
        accepted.push(list);
        schema.insert("anyOf".into(), Json::Array(accepted));
    } else {
        schema.insert("not".into(), json!({ "type": "null" }));
    }
    let unit = facts["unit"].as_str().map(|u| format!(" In {u}.")).unwrap_or_default();
    schema.insert("description".into(), format!("{}{unit}", port.doc).trim().into());
    if let Some(default) = &port.default {
        schema.insert("default".into(), default.clone());
    }
    Json::Object(schema)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::NodeType;

    #[test]
    fn a_port_says_range_choices_and_default() {
        let number = literal(&Port::item::<f64>("x").range(0.0, 5.0).default(2.0).doc("Wide."));
        assert_eq!(number["anyOf"][0], json!({ "type": "number", "minimum": 0.0, "maximum": 5.0 }));
        assert_eq!((&number["default"], &number["description"]), (&json!(2.0), &json!("Wide.")));
        let text = literal(&Port::item::<crate::Text>("x").choices(&["a", "b"]));
        assert_eq!(text["anyOf"][0], json!({ "enum": ["a", "b"] }));
    }

    #[test]
    fn only_a_registry_narrows_the_node_types() {
        let mut registry = Registry::new();
        registry.register(NodeType::new("t", 1).input(Port::item::<f64>("x")).run(|_| Ok(()))).unwrap();
        let narrow = schema_with_nodes(&registry);
        assert_eq!(narrow["$defs"]["node"]["properties"]["type"]["anyOf"][0]["enum"], json!(["t"]));
        assert_eq!(narrow["$defs"]["node.t"]["properties"]["params"]["additionalProperties"], false);
        assert!(schema()["$defs"]["node"].get("allOf").is_none());
    }
}
