//! The critical path: the chain of nodes that takes longest one after another. Nothing can be done sooner than it, however many
//! cores there are.

use std::collections::{BTreeMap, HashMap};
use std::time::Duration;
use tenon_engine::Document;

/// The ids of the nodes on it in order, and how long they take together. Nodes that go round in a ring are left out.
/// O(nodes + wires).
#[must_use]
pub fn critical_path(document: &Document, time: impl Fn(&str) -> Duration) -> (Vec<String>, Duration) {
    let nodes = document.nodes();
    let sources = |id: &str| -> Vec<&str> {
        let inputs = nodes.get(id).map(|n| &n.inputs);
        let wires = inputs.into_iter().flat_map(|i| i.values()).flat_map(|w| &w.from);
        wires
            .filter_map(|f| f.as_str().split_once('.'))
            .map(|(id, _)| id)
            .filter(|id| nodes.contains_key(*id))
            .collect()
    };
    let mut open: HashMap<&str, usize> = HashMap::new();
    let mut after: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for id in nodes.keys() {
        let from = sources(id);
        open.insert(id, from.len());
        from.into_iter().for_each(|f| after.entry(f).or_default().push(id));
    }
    let mut ready: Vec<&str> = nodes.keys().map(String::as_str).filter(|id| open.get(id) == Some(&0)).collect();
    // When a node is done at the earliest, and after which one it waits.
    let mut done: HashMap<&str, (Duration, Option<&str>)> = HashMap::new();
    while let Some(id) = ready.pop() {
        let latest = sources(id).into_iter().filter_map(|s| Some((done.get(s)?.0, s))).max();
        done.insert(id, (latest.map_or(Duration::ZERO, |l| l.0) + time(id), latest.map(|l| l.1)));
        for next in after.get(id).into_iter().flatten() {
            if let Some(n) = open.get_mut(next) {
                *n -= 1;
                if *n == 0 {
                    ready.push(next);
                }
            }
        }
    }
    let last = done.iter().max_by_key(|(id, (t, _))| (*t, std::cmp::Reverse(**id)));
    let Some((last, (total, _))) = last else { return (Vec::new(), Duration::ZERO) };
    let mut path = vec![(*last).to_owned()];
    let mut at = *last;
    while let Some((_, Some(before))) = done.get(at) {
        path.push((*before).to_owned());
        at = before;
    }
    path.reverse();
    (path, *total)
}

#[cfg(test)]
mod tests {
    use super::*;
    use tenon_engine::Node;

    #[test]
    fn the_longest_chain_counts_and_rings_do_not() {
        let mut d = Document::new();
        d.insert("a", Node::new("x")).unwrap();
        d.insert("b", Node::new("x")).unwrap();
        d.insert("c", Node::new("x").wire("i", "a.o").wire("j", "b.o")).unwrap();
        d.insert("r", Node::new("x").wire("i", "s.o")).unwrap();
        d.insert("s", Node::new("x").wire("i", "r.o")).unwrap();
        let time = |id: &str| {
            Duration::from_millis(match id {
                "a" => 3,
                "b" => 5,
                "c" => 1,
                _ => 1000,
            })
        };
        let (path, total) = critical_path(&d, time);
        assert_eq!((path, total), (vec!["b".to_owned(), "c".to_owned()], Duration::from_millis(6)));
        assert_eq!(critical_path(&Document::new(), time), (Vec::new(), Duration::ZERO));
    }
}
