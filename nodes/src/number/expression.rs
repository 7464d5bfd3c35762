//! `expression`: a formula over up to three numbers.

use tenon_engine::{Expression, Fail, NodeType, Port, Quantity, Text};

pub(super) fn node() -> NodeType {
    NodeType::new("expression", 1)
        .name("Expression")
        .category("Numbers")
        .doc(
            "A formula over the numbers x, y and z, in the language of formulas in parameters: + - * / ^, brackets, pi, \
             sin, cos, tan (degrees), sqrt, min, max, abs, round, floor, ceil, and numbers with units. A result with a \
             unit is given in mm, mm2, mm3 or degrees.",
        )
        .keywords(&["formula", "evaluate", "maths", "calculate"])
        .cheap()
        .input(Port::item::<Text>("formula").doc("Such as `sqrt(x^2 + y^2)`."))
        .input(Port::item::<f64>("x").optional().doc("The number that x stands for."))
        .input(Port::item::<f64>("y").optional().doc("The number that y stands for."))
        .input(Port::item::<f64>("z").optional().doc("The number that z stands for."))
        .output(Port::item::<f64>("value").doc("The formula's value."))
        .run(|c| {
            let text = c.text("formula")?;
            let number = |name: &str| match name {
                "x" | "y" | "z" => {
                    c.optional::<f64>(name).map(|v| Quantity::plain(*v)).ok_or_else(|| format!("{name} has no value"))
                }
                _ => Err(format!("\"{name}\" is none of x, y and z")),
            };
            let value = Expression::parse(text).and_then(|formula| formula.evaluate(&number));
            let value = value.map_err(|e| {
                let start: String = text.chars().take(80).collect();
                Fail::new("bad-formula", format!("\"{start}\", {e}")).port("formula")
            })?;
            c.set("value", value.value);
            Ok(())
        })
}
