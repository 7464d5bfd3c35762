//! `statistics`: a list of numbers in short.

use tenon_engine::stop::Stoppable;
use tenon_engine::{Fail, NodeType, Port, Statistics, Unit};

pub(super) fn node() -> NodeType {
    let node = NodeType::new("statistics", 1)
        .name("Statistics")
        .category("Numbers")
        .doc(
            "Count, sum, mean and spread of a list of numbers; numbers that failed upstream are counted, but not used.",
        )
        .keywords(&["average", "mean", "median", "minimum", "maximum", "sum", "bounds"])
        .input(Port::list::<f64>("numbers").doc("The numbers."))
        .output(Port::item::<i64>("count").unit(Unit::Count).doc("How many numbers there are."))
        .output(Port::item::<i64>("missing").unit(Unit::Count).doc("How many more failed upstream."));
    [
        ("sum", "Sum."),
        ("mean", "Sum over count."),
        ("min", "Smallest."),
        ("max", "Largest."),
        ("median", "The middle one in order, or the mean of the two in the middle."),
        ("deviation", "Standard deviation of the list itself (divided by the count)."),
    ]
    .into_iter()
    .fold(node, |node, (name, doc)| node.output(Port::item::<f64>(name).doc(doc)))
    .run(|c| {
        let all = c.list_gaps::<f64>("numbers");
        let numbers: Vec<f64> = all.iter().stoppable().flatten().map(|x| **x).collect();
        let s = Statistics::of(&numbers)
            .ok_or_else(|| Fail::new("empty-list", "there is no number in the list").port("numbers"))?;
        if !(s.sum.is_finite() && s.deviation.is_finite()) {
            let message = "the sum or the spread is beyond what a number can hold";
            return Err(Fail::new("too-large", message).port("numbers"));
        }
        c.set("count", numbers.len() as i64);
        c.set("missing", (all.len() - numbers.len()) as i64);
        c.set("sum", s.sum);
        c.set("mean", s.mean);
        c.set("min", s.min);
        c.set("max", s.max);
        c.set("median", s.median);
        c.set("deviation", s.deviation);
        Ok(())
    })
}
