//! What a graph offers its host: inputs and outputs with what a host needs to show them.

use crate::error::{Failure, guard, tenon_error};
use crate::graph::tenon_graph;
use crate::handle;
use crate::read;
use crate::text::{self, tenon_text};
use ::tenon_engine::{Document, Json, Registry};

/// What an interface lists: its inputs or its outputs.
pub type tenon_side_of_graph = u32;
/// Inputs.
pub const TENON_INPUTS: tenon_side_of_graph = 0;
/// Outputs.
pub const TENON_OUTPUTS: tenon_side_of_graph = 1;

/// Describes the interface as JSON: a list of objects in order of their names, each with `name`, `ports` (`node.port`), `doc`,
/// `unit`, `type` and `access` ("item", "list", "tree"); inputs besides with `min`, `max`, `choices` (the texts accepted; none:
/// any), `default` and `value` (what is set, as a graph file says it). What the interface does not say is that of the first
/// port behind it. What is not known is null. Fails if `side` is neither of the two. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_interface(
    graph: *const tenon_graph,
    side: tenon_side_of_graph,
    out: *mut *mut tenon_text,
) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let graph = handle::graph(graph)?;
        let list: Json = {
            let front = graph.front();
            let (document, registry) = (front.draft.document(), &**front.draft.registry());
            match side {
                TENON_INPUTS => inputs(document, registry),
                TENON_OUTPUTS => outputs(document, registry),
                other => {
                    return Err(Failure::argument(format!(
                        "side is {other}; there are TENON_INPUTS and TENON_OUTPUTS"
                    )));
                }
            }
        };
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(text::give(list.to_string())) };
        Ok(())
    })
}

fn inputs(document: &Document, registry: &Registry) -> Json {
    let one = |(name, input): (&String, &tenon_engine::InterfaceInput)| {
        let first = input.ports.first().map_or("", String::as_str);
        let port = document.input_port(registry, first).map_or(Json::Null, |p| p.describe());
        let set = first
            .split_once('.')
            .and_then(|(id, port)| document.nodes().get(id)?.params.get(port))
            .map(|v| v.to_json());
        serde_json::json!({
            "name": name,
            "ports": input.ports,
            "doc": said(&input.doc, &port["doc"]),
            "unit": said(&input.unit, &port["unit"]),
            "type": port["type"],
            "access": port["access"],
            "min": said(&input.min, &port["min"]),
            "max": said(&input.max, &port["max"]),
            "choices": port.get("choices").cloned().unwrap_or_else(|| Json::Array(Vec::new())),
            "default": port["default"],
            "value": set,
        })
    };
    document.inputs.iter().map(one).collect()
}

fn outputs(document: &Document, registry: &Registry) -> Json {
    let one = |(name, output): (&String, &tenon_engine::InterfaceOutput)| {
        let port = document.output_port(registry, &output.port).map_or(Json::Null, |p| p.describe());
        serde_json::json!({
            "name": name,
            "ports": [output.port],
            "doc": said(&output.doc, &port["doc"]),
            "unit": said(&output.unit, &port["unit"]),
            "type": port["type"],
            "access": port["access"],
        })
    };
    document.outputs.iter().map(one).collect()
}

/// What the interface says, else what stands behind it.
fn said<T: Clone + Into<Json>>(own: &Option<T>, behind: &Json) -> Json {
    own.clone().map_or_else(|| behind.clone(), Into::into)
}
