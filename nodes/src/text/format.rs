//! `format`: a text out of a template and values.

use super::template::fill;
use tenon_engine::{Access, Fail, NodeType, Port, Text};

/// Inputs that a template can name.
const INPUTS: [&str; 6] = ["a", "b", "c", "d", "e", "f"];

pub(super) fn node() -> NodeType {
    let mut node = NodeType::new("format", 1)
        .name("Format text")
        .category("Text")
        .doc(
            "A text with places for values: \"Panel {a}: {b:.1} mm\". {a:.2} asks for decimals, {a:5} for a width, {a:03} \
             for leading zeros; {{ and }} are the braces themselves.",
        )
        .keywords(&["concatenate", "string", "template", "label"])
        .input(Port::item::<Text>("template").doc("The text with its places."));
    for input in INPUTS {
        node = node.input(Port::any(input, Access::Item).optional().doc("A value of any type."));
    }
    node.output(Port::item::<Text>("text").doc("The text with the values in their places.")).run(|c| {
        let value =
            |name: &str| INPUTS.contains(&name).then(|| c.column(name).ok()).flatten().filter(|v| !v.is_empty());
        let text = fill(c.text("template")?, value).map_err(|why| Fail::new("bad-template", why).port("template"))?;
        c.set("text", Text::from(text));
        Ok(())
    })
}
