//! Number, integer, text, boolean.

use tenon_engine::{Item, NodeType, Port, Text};

pub(super) fn nodes() -> Vec<NodeType> {
    vec![
        primitive::<f64>(
            "number",
            "Number",
            "A number that a person sets; its unit is that of the port it is wired to.",
        ),
        primitive::<i64>("integer", "Integer", "A whole number that a person sets."),
        primitive::<bool>("boolean", "Boolean", "True or false."),
        primitive::<Text>("text", "Text", "A text."),
    ]
}

fn primitive<T: Item>(id: &'static str, name: &'static str, doc: &'static str) -> NodeType {
    NodeType::new(id, 1)
        .cheap()
        .name(name)
        .category("Parameters")
        .doc(doc)
        .keywords(&["parameter", "input", "constant"])
        .input(Port::item::<T>("value").doc("The value, a literal or a wire."))
        .output(Port::item::<T>("value").doc("The same value."))
        .run(|c| {
            let value = c.item::<T>("value")?.clone();
            c.set("value", value);
            Ok(())
        })
}
