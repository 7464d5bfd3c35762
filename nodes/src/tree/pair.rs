//! Cross reference: pairs of the items of two lists.

use tenon_engine::stop::{self, Stoppable};
use tenon_engine::{Access, Fail, NodeType, Port};

/// The most items that a node makes out of few: more would fill the memory and is more likely a slip than a wish.
pub(super) const MOST: usize = 1 << 24;

pub(super) fn nodes() -> Vec<NodeType> {
    vec![cross_reference()]
}

/// Whether the pair of a place in a and a place in b is kept.
type Keep = fn(usize, usize) -> bool;

const PAIRS: [(&str, Keep); 7] = [
    ("all", |_, _| true),
    ("same", |i, j| i == j),
    ("other", |i, j| i != j),
    ("lower", |i, j| j <= i),
    ("below", |i, j| j < i),
    ("upper", |i, j| j >= i),
    ("above", |i, j| j > i),
];

fn cross_reference() -> NodeType {
    NodeType::new("cross_reference", 1)
        .name("Cross reference")
        .category("Trees")
        .doc("Pairs of the items of two lists; b turns fastest. Wires matched by \"cross\" do the same for one node alone.")
        .keywords(&["holistic", "product", "combine", "pairs"])
        .input(Port::any("a", Access::List).doc("First list."))
        .input(Port::any("b", Access::List).doc("Second list."))
        .input(Port::item::<tenon_engine::Text>("pairs").choices(&PAIRS.map(|p| p.0)).default("all").doc(
            "Which pairs, by their places in a and b: all; same or other places; b up to (lower) or before (below) the \
             place in a; b from (upper) or after (above) it on.",
        ))
        .output(Port::any("a", Access::List).doc("The first of each pair."))
        .output(Port::any("b", Access::List).doc("The second of each pair."))
        .run(|c| {
            let (a, b, pairs) = (c.column("a")?, c.column("b")?, c.text("pairs")?);
            let keep = PAIRS.iter().find(|p| p.0 == pairs).map_or(PAIRS[0].1, |p| p.1);
            let count = a.len().saturating_mul(b.len());
            if count > MOST {
                let message = format!("{} times {} are {count} pairs; the most is {MOST}", a.len(), b.len());
                return Err(Fail::new("too-many-items", message));
            }
            c.reserve(2 * count)?;
            let (mut first, mut second) = (Vec::new(), Vec::new());
            for i in 0..a.len() {
                stop::check();
                for j in (0..b.len()).stoppable().filter(|j| keep(i, *j)) {
                    first.push(Some(i));
                    second.push(Some(j));
                }
            }
            c.set_column("a", a.pick(&first));
            c.set_column("b", b.pick(&second));
            Ok(())
        })
}
