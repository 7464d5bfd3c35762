//! One list at a time, branch by branch: pick items, a part, shift, dispatch, sort.

use tenon_engine::stop::{Pending, Stoppable};
use tenon_engine::{Access, Column, Fail, NodeType, Port};

pub(super) fn nodes() -> Vec<NodeType> {
    vec![list_item(), sublist(), shift(), dispatch(), sort()]
}

fn node(id: &'static str, name: &'static str) -> NodeType {
    NodeType::new(id, 1).name(name).category("Trees")
}

fn wrap_port(default: bool, doc: &'static str) -> Port {
    Port::item::<bool>("wrap").default(default).doc(doc)
}

/// The place of `index` in a list of `len`; indices beyond an end go round if `wrap`.
fn place(index: i64, len: usize, wrap: bool) -> Option<usize> {
    let index = if wrap && len > 0 { index.rem_euclid(len as i64) } else { index };
    usize::try_from(index).ok().filter(|i| *i < len)
}

fn list_item() -> NodeType {
    node("list_item", "List item")
        .doc("The items at the given places of a list, counting from 0. A place that the list does not have leaves a gap.")
        .keywords(&["index", "pick", "get", "nth"])
        .input(Port::any("list", Access::List).doc("The list."))
        .input(Port::list::<i64>("index").default(vec![0]).doc("Places, from 0."))
        .input(wrap_port(false, "Whether places beyond the ends go round; −1 is then the last item."))
        .output(Port::any("items", Access::List).doc("The items there, in the order of the places."))
        .run(|c| {
            let (list, wrap) = (c.column("list")?, c.boolean("wrap")?);
            let mut order = Vec::new();
            for (k, index) in c.list_gaps::<i64>("index").into_iter().enumerate().stoppable() {
                let at = index.and_then(|i| place(*i, list.len(), wrap));
                if let (Some(index), None) = (index, at) {
                    c.report(no_such_place(*index, list.len()).item(k));
                }
                order.push(at);
            }
            c.set_column("items", list.pick(&order));
            Ok(())
        })
}

fn no_such_place(index: i64, len: usize) -> Fail {
    let fail = Fail::new("no-such-item", format!("there is no item {index} in a list of {len}")).port("index");
    if len == 0 { fail } else { fail.hint(format!("the last is {}; wrap goes round", len - 1)) }
}

fn sublist() -> NodeType {
    node("sublist", "Sublist")
        .doc("The items of a list between two places, both included. From the larger to the smaller place it runs backwards.")
        .keywords(&["sub list", "slice", "part", "domain"])
        .input(Port::any("list", Access::List).doc("The list."))
        .input(Port::item::<i64>("from").default(0).doc("First place, from 0."))
        .input(Port::item::<i64>("to").doc("Last place, included."))
        .input(wrap_port(false, "Whether places beyond the ends go round; if not, they are left out."))
        .output(Port::any("items", Access::List).doc("The items from the first place to the last."))
        .output(Port::list::<i64>("index").doc("Their places in the list."))
        .run(|c| {
            let (list, wrap) = (c.column("list")?, c.boolean("wrap")?);
            let (from, to) = (c.integer("from")?, c.integer("to")?);
            let (mut low, mut high) = (from.min(to), from.max(to));
            if wrap {
                let most = super::pair::MOST as u64;
                if high.abs_diff(low) >= most {
                    let message = format!("{from} to {to} are more than {most} places");
                    return Err(Fail::new("too-many-items", message).port("to"));
                }
                c.reserve(2 * (high.abs_diff(low) as usize + 1))?;
            } else {
                // Places that are not there need not be counted through.
                (low, high) = (low.max(0), high.min(list.len() as i64 - 1));
            }
            let mut order: Vec<usize> = (low..=high).stoppable().filter_map(|i| place(i, list.len(), wrap)).collect();
            if from > to {
                order.reverse();
            }
            c.set_column("items", pick(&list, &order));
            c.set_list("index", order.into_iter().stoppable().map(|i| i as i64).collect());
            Ok(())
        })
}

fn pick(list: &Column, order: &[usize]) -> Column {
    let mut places = Pending::new(Vec::with_capacity(order.len()));
    places.extend(order.iter().stoppable().copied().map(Some));
    list.pick(&places)
}

fn shift() -> NodeType {
    node("shift", "Shift list")
        .doc("Moves every item of a list towards its start by a number of places; by 1, the second item comes first.")
        .keywords(&["rotate", "offset", "neighbour"])
        .input(Port::any("list", Access::List).doc("The list."))
        .input(Port::item::<i64>("by").default(1).doc("Places; negative: towards the end."))
        .input(wrap_port(true, "Whether items that leave at one end come in at the other; if not, they are dropped."))
        .output(Port::any("items", Access::List).doc("The shifted list."))
        .run(|c| {
            let (list, by) = (c.column("list")?, c.integer("by")?);
            let n = list.len();
            let places = usize::try_from(by.unsigned_abs()).unwrap_or(usize::MAX);
            let shifted = if c.boolean("wrap")? {
                let first = place(by, n, true).unwrap_or(0);
                pick(&list, &(first..n).chain(0..first).stoppable().collect::<Vec<_>>())
            } else if by >= 0 {
                list.part(places.min(n), n)
            } else {
                list.part(0, n.saturating_sub(places))
            };
            c.set_column("items", shifted);
            Ok(())
        })
}

fn dispatch() -> NodeType {
    node("dispatch", "Dispatch")
        .doc("Deals the items of a list out to two lists by a pattern of true and false, which repeats.")
        .keywords(&["cull", "filter", "pattern", "split"])
        .input(Port::any("list", Access::List).doc("The list."))
        .input(Port::list::<bool>("pattern").default(vec![true, false]).doc("True: to a, false: to b."))
        .output(Port::any("a", Access::List).doc("Items where the pattern is true."))
        .output(Port::any("b", Access::List).doc("Items where the pattern is false."))
        .run(|c| {
            let (list, pattern) = (c.column("list")?, c.list::<bool>("pattern")?);
            if pattern.is_empty() {
                return Err(Fail::new("empty-list", "the pattern has no entry").port("pattern"));
            }
            let (a, b): (Vec<usize>, Vec<usize>) =
                (0..list.len()).stoppable().partition(|i| pattern[i % pattern.len()]);
            c.set_column("a", pick(&list, &a));
            c.set_column("b", pick(&list, &b));
            Ok(())
        })
}

fn sort() -> NodeType {
    node("sort", "Sort list")
        .doc(
            "Sorts a list by its keys, and another list along with it. Equal keys keep their order; keys that failed \
             upstream come last.",
        )
        .keywords(&["order", "ascending", "descending"])
        .input(Port::any("keys", Access::List).doc("Numbers, integers, texts or booleans."))
        .input(Port::any("values", Access::List).optional().doc("Sorted in the same way; as many as there are keys."))
        .input(Port::item::<bool>("descending").default(false).doc("Whether the largest comes first."))
        .output(Port::any("keys", Access::List).doc("The keys in order."))
        .output(Port::any("values", Access::List).doc("The values in the order of their keys."))
        .output(Port::list::<i64>("index").doc("Where each of them was before."))
        .run(|c| {
            let (keys, values) = (c.column("keys")?, c.column("values")?);
            let monitor = c.monitor();
            let go = || !monitor.cancelled();
            let order = if c.boolean("descending")? { keys.descending(&go) } else { keys.ascending(&go) };
            if c.cancelled() {
                return Err(Fail::cancelled());
            }
            let order = order.ok_or_else(|| {
                Fail::new("no-order", format!("items of type {} have no order", keys.type_name()))
                    .port("keys")
                    .hint("sort them as values, by keys that are numbers or texts")
            })?;
            c.set_column("keys", pick(&keys, &order));
            c.set_column("values", along(&values, &keys, &order)?);
            c.set_list("index", order.into_iter().stoppable().map(|i| i as i64).collect());
            Ok(())
        })
}

fn along(values: &Column, keys: &Column, order: &[usize]) -> Result<Column, Fail> {
    // A port that is not wired brings an empty column.
    if values.is_empty() {
        return Ok(values.clone());
    }
    if values.len() != keys.len() {
        let message = format!("there are {} values, but {} keys", values.len(), keys.len());
        return Err(Fail::new("lengths-differ", message).port("values"));
    }
    Ok(pick(values, order))
}
