//! Values that people choose on the canvas: a number between two ends, one of several entries.

use std::fmt::Display;
use tenon_engine::{Access, Fail, NodeType, Port, Quantity, Text};

pub(super) fn nodes() -> Vec<NodeType> {
    vec![slider(), integer_slider(), value_list()]
}

fn slider() -> NodeType {
    NodeType::new("slider", 1)
        .cheap()
        .name("Slider")
        .category("Parameters")
        .doc(
            "A number between two ends that a person slides. With a unit it gives millimetres, degrees and so on: 2 cm are 20.",
        )
        .keywords(&["number slider", "parameter", "input", "range"])
        .input(Port::item::<f64>("value").default(5.0).doc("The number, in its own unit."))
        .input(Port::item::<f64>("min").default(0.0).doc("The smallest number that it can be."))
        .input(Port::item::<f64>("max").default(10.0).doc("The largest number that it can be."))
        .input(
            Port::item::<f64>("step")
                .range(0.0, 1e9)
                .default(0.0)
                .doc("By how much it slides, from the smallest number on; 0: by round parts of the whole way."),
        )
        .input(Port::item::<Text>("unit").default("").doc("Sign of the unit, such as cm or deg; none for a plain number."))
        .output(Port::item::<f64>("value").doc("The number in millimetres, degrees or their powers; a plain one as it is."))
        .run(|c| {
            let (value, min, max) = (c.number("value")?, c.number("min")?, c.number("max")?);
            let sign = c.text("unit")?.trim();
            check_ends(value, min, max)?;
            let unit = if sign.is_empty() { Some(Quantity::plain(1.0)) } else { Quantity::unit(sign) };
            let unknown = || Fail::new("bad-parameter", format!("\"{sign}\" is no unit that is known here")).port("unit");
            c.set("value", value * unit.ok_or_else(unknown)?.value);
            Ok(())
        })
}

fn integer_slider() -> NodeType {
    NodeType::new("integer_slider", 1)
        .cheap()
        .name("Integer slider")
        .category("Parameters")
        .doc("A whole number between two ends that a person slides.")
        .keywords(&["parameter", "input", "range", "count"])
        .input(Port::item::<i64>("value").default(5).doc("The number."))
        .input(Port::item::<i64>("min").default(0).doc("The smallest number that it can be."))
        .input(Port::item::<i64>("max").default(10).doc("The largest number that it can be."))
        .input(
            Port::item::<i64>("step")
                .range(1.0, 1e9)
                .default(1)
                .doc("By how much it slides, from the smallest number on."),
        )
        .output(Port::item::<i64>("value").doc("The number."))
        .run(|c| {
            let (value, min, max) = (c.integer("value")?, c.integer("min")?, c.integer("max")?);
            check_ends(value, min, max)?;
            c.set("value", value);
            Ok(())
        })
}

/// Refuses a value that does not lie between its ends, and ends that hold nothing between them.
fn check_ends<T: PartialOrd + Display>(value: T, min: T, max: T) -> Result<(), Fail> {
    if min > max {
        let message = format!("the smallest number, {min}, is larger than the largest, {max}");
        return Err(Fail::new("bad-parameter", message).port("min"));
    }
    if value >= min && value <= max {
        return Ok(());
    }
    let message = format!("{value} does not lie between {min} and {max}");
    let nearest = if value < min { min } else { max };
    Err(Fail::new("bad-parameter", message).port("value").hint(format!("the nearest that works is {nearest}")))
}

fn value_list() -> NodeType {
    NodeType::new("value_list", 1)
        .name("Value list")
        .category("Parameters")
        .doc("One of several values, chosen by its name.")
        .keywords(&["choice", "option", "dropdown", "combo", "select", "input"])
        .input(Port::list::<Text>("names").default(vec!["one", "two", "three"]).doc("Names of the entries."))
        .input(
            Port::any("values", Access::List)
                .default(vec![1, 2, 3])
                .doc("Their values in the same order: numbers, texts, or anything by wire."),
        )
        .input(Port::item::<Text>("chosen").optional().doc("Name of the entry that is chosen; none: the first."))
        .output(Port::any("value", Access::Item).doc("The value of the chosen entry."))
        .run(|c| {
            let (names, values) = (c.list::<Text>("names")?, c.column("values")?);
            if names.len() != values.len() {
                let message = format!("there are {} names and {} values", names.len(), values.len());
                return Err(Fail::new("lengths-differ", message).port("values"));
            }
            let chosen = c.optional::<Text>("chosen");
            let place = chosen.map_or((!names.is_empty()).then_some(0), |name| names.iter().position(|n| n == name));
            let Some(place) = place else {
                let known: Vec<&str> = names.iter().map(|n| &*n.0).take(20).collect();
                let message = match chosen {
                    Some(name) => format!("no entry is called \"{name}\""),
                    None => "there are no entries".to_owned(),
                };
                return Err(Fail::new("no-such-entry", message).port("chosen").hint(known.join(", ")));
            };
            c.set_column("value", values.pick(&[Some(place)]));
            Ok(())
        })
}
