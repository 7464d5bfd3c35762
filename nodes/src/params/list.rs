//! List, range and series.

use tenon_engine::{Access, Call, Fail, MOST_ITEMS, NodeType, Port, Unit};

/// Longer lists are refused: they are typing errors that would fill the memory.
pub(crate) const LONGEST: f64 = MOST_ITEMS as f64;

pub(super) fn nodes() -> Vec<NodeType> {
    vec![list(), range(), series()]
}

/// So many numbers are made before it is looked whether to stop.
const STRIDE: usize = 1 << 16;

/// `count` numbers of a sequence, as a list.
pub(crate) fn numbers(c: &Call, count: usize, mut all: impl Iterator<Item = f64>) -> Result<Vec<f64>, Fail> {
    c.reserve(count)?;
    let mut numbers = Vec::with_capacity(count);
    while numbers.len() < count {
        if c.cancelled() {
            return Err(Fail::cancelled());
        }
        let some = STRIDE.min(count - numbers.len());
        numbers.extend(all.by_ref().take(some));
    }
    Ok(numbers)
}

fn list() -> NodeType {
    NodeType::new("list", 1)
        .name("List")
        .category("Parameters")
        .doc("Collects items of one type into a list, in the order of the wires.")
        .keywords(&["merge", "collect"])
        .input(Port::any("items", Access::List).doc("Items or lists; many wires follow one another."))
        .output(Port::any("items", Access::List).doc("All of them as one list."))
        .run(|c| {
            let items = c.column("items")?;
            c.set_column("items", items);
            Ok(())
        })
}

fn range() -> NodeType {
    NodeType::new("range", 1)
        .name("Range")
        .category("Parameters")
        .doc("Numbers from start to end in equal steps, both ends included.")
        .keywords(&["divide", "interval", "domain"])
        .input(Port::item::<f64>("start").default(0.0).doc("First number."))
        .input(Port::item::<f64>("end").default(1.0).doc("Last number."))
        .input(
            Port::item::<i64>("steps")
                .unit(Unit::Count)
                .range(1.0, LONGEST - 1.0)
                .default(10)
                .doc("Number of steps; steps + 1 numbers."),
        )
        .output(Port::list::<f64>("numbers").doc("The numbers."))
        .run(|c| {
            let (start, end, steps) = (c.number("start")?, c.number("end")?, c.integer("steps")?);
            if !(end - start).is_finite() {
                return Err(Fail::new(
                    "range-too-wide",
                    format!("from {start} to {end} is wider than a number can hold"),
                ));
            }
            let numbers =
                (0..=steps).map(|i| if i == steps { end } else { start + (end - start) * (i as f64 / steps as f64) });
            let numbers = self::numbers(c, usize::try_from(steps).unwrap_or(0) + 1, numbers)?;
            c.set_list("numbers", numbers);
            Ok(())
        })
}

fn series() -> NodeType {
    NodeType::new("series", 1)
        .name("Series")
        .category("Parameters")
        .doc("Numbers from start by a constant step.")
        .keywords(&["count", "arithmetic"])
        .input(Port::item::<f64>("start").default(0.0).doc("First number."))
        .input(Port::item::<f64>("step").default(1.0).doc("Difference of neighbours."))
        .input(Port::item::<i64>("count").unit(Unit::Count).range(0.0, LONGEST).default(10).doc("How many numbers."))
        .output(Port::list::<f64>("numbers").doc("The numbers."))
        .run(|c| {
            let (start, step, count) = (c.number("start")?, c.number("step")?, c.integer("count")?);
            if !(start + step * count as f64).is_finite() {
                return Err(Fail::new(
                    "series-too-far",
                    format!("{count} steps of {step} from {start} leave the numbers"),
                )
                .port("step"));
            }
            let all = (0..count).map(|i| start + step * i as f64);
            let numbers = numbers(c, usize::try_from(count).unwrap_or(0), all)?;
            c.set_list("numbers", numbers);
            Ok(())
        })
}
