//! `random`: numbers from a seed.

use tenon_engine::{Fail, NodeType, Port, Random, Unit};

pub(super) fn node() -> NodeType {
    NodeType::new("random", 1)
        .name("Random")
        .category("Numbers")
        .doc(
            "Random numbers between two bounds, spread evenly; the same seed gives the same numbers on every machine, and a \
             longer list begins like a shorter one. (SplitMix64, upper 53 bits.)",
        )
        .keywords(&["noise", "seed", "scatter"])
        .input(Port::item::<f64>("start").default(0.0).doc("Lower bound, included."))
        .input(Port::item::<f64>("end").default(1.0).doc("Upper bound, not included."))
        .input(
            Port::item::<i64>("count").unit(Unit::Count).range(0.0, crate::params::LONGEST).default(10).doc("How many numbers."),
        )
        .input(Port::item::<i64>("seed").default(1).doc("Where the sequence starts; any whole number."))
        .output(Port::list::<f64>("numbers").doc("The numbers."))
        .run(|c| {
            let (start, end, count) = (c.number("start")?, c.number("end")?, c.integer("count")?);
            if !(end - start).is_finite() {
                let message = format!("from {start} to {end} is wider than a number can hold");
                return Err(Fail::new("range-too-wide", message).port("end"));
            }
            let count = usize::try_from(count).unwrap_or(0);
            let all = Random::new(c.integer("seed")?).map(|u| start + (end - start) * u);
            let numbers = crate::params::numbers(c, count, all)?;
            c.set_list("numbers", numbers);
            Ok(())
        })
}
