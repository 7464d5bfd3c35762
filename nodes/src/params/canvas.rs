//! What only serves the canvas: notes, panels that show what a wire brings, and points that wires are led through.

use tenon_engine::{Access, NodeType, Port, Text};

pub(super) fn nodes() -> Vec<NodeType> {
    vec![note(), text_panel(), reroute()]
}

fn note() -> NodeType {
    NodeType::new("note", 1)
        .cheap()
        .name("Note")
        .category("Parameters")
        .doc("A remark that stands on the canvas by itself. It gives nothing.")
        .keywords(&["comment", "scribble", "remark"])
        .input(Port::item::<Text>("text").default("").doc("The remark."))
        .run(|_| Ok(()))
}

fn text_panel() -> NodeType {
    NodeType::new("text_panel", 1)
        .cheap()
        .name("Text panel")
        .category("Parameters")
        .doc("Shows on the canvas what a wire brings, item by item, and passes it on.")
        .keywords(&["panel", "view", "watch", "show", "display", "print"])
        .input(Port::any("data", Access::Tree).doc("Anything; several wires are merged."))
        .output(Port::any("data", Access::Tree).doc("The same."))
        .run(|c| {
            let tree = c.tree("data").clone();
            c.set_tree("data", tree);
            Ok(())
        })
}

fn reroute() -> NodeType {
    NodeType::new("reroute", 1)
        .cheap()
        .name("Reroute")
        .category("Parameters")
        .doc("A point that wires are led through: it passes on what comes in.")
        .keywords(&["relay", "wire", "dot", "knot"])
        .input(Port::any("value", Access::Tree).doc("Anything; several wires are merged."))
        .output(Port::any("value", Access::Tree).doc("The same."))
        .run(|c| {
            let tree = c.tree("value").clone();
            c.set_tree("value", tree);
            Ok(())
        })
}
