//! `remap`: from one interval to another.

use tenon_engine::{Fail, NodeType, Port};

pub(super) fn node() -> NodeType {
    NodeType::new("remap", 1)
        .name("Remap")
        .category("Numbers")
        .doc("Maps a number from one interval to another: the ends of the one to the ends of the other, in proportion between.")
        .keywords(&["scale", "interval", "domain", "map"])
        .cheap()
        .input(Port::item::<f64>("value").doc("The number."))
        .input(Port::item::<f64>("from_start").default(0.0).doc("Start of the interval that it comes from."))
        .input(Port::item::<f64>("from_end").default(1.0).doc("End of the interval that it comes from."))
        .input(Port::item::<f64>("to_start").default(0.0).doc("Start of the interval that it goes to."))
        .input(Port::item::<f64>("to_end").default(1.0).doc("End of the interval that it goes to."))
        .output(Port::item::<f64>("mapped").doc("The number in proportion, beyond the ends as well."))
        .output(Port::item::<f64>("clipped").doc("The same, held between the ends."))
        .run(|c| {
            let (a, b) = (c.number("from_start")?, c.number("from_end")?);
            let (x, y) = (c.number("to_start")?, c.number("to_end")?);
            if a == b {
                let message = format!("the interval from {a} to {b} has no length");
                return Err(Fail::new("empty-interval", message).port("from_end"));
            }
            let t = (c.number("value")? - a) / (b - a);
            // In this form both ends are met exactly.
            let mapped = x * (1.0 - t) + y * t;
            if !mapped.is_finite() {
                return Err(Fail::new("too-large", "the mapped number is beyond what a number can hold").port("value"));
            }
            c.set("mapped", mapped);
            c.set("clipped", mapped.clamp(x.min(y), x.max(y)));
            Ok(())
        })
}
