//! Where nodes stand when nobody has said so: columns by the longest way from a node without inputs, in each column the
//! order in which wires cross least. Sugiyama, Tagawa, Toda 1981, with barycentres.

use std::collections::{BTreeMap, HashMap};
use tenon_engine::Document;

/// Room between columns and between nodes of a column, points.
const GAP: [f64; 2] = [70.0, 26.0];

/// Times that the columns are swept.
const SWEEPS: usize = 6;

/// Places for all nodes; `size` gives width and height of each. Nodes that go round in a ring stand behind the others.
/// O(sweeps · (nodes log nodes + wires)).
#[must_use]
pub fn arrange(document: &Document, size: impl Fn(&str) -> [f64; 2]) -> BTreeMap<String, [f64; 2]> {
    let ids: Vec<&str> = document.nodes().keys().map(String::as_str).collect();
    let number: HashMap<&str, usize> = ids.iter().enumerate().map(|(i, id)| (*id, i)).collect();
    let mut before = vec![Vec::new(); ids.len()];
    let mut after = vec![Vec::new(); ids.len()];
    for (i, node) in document.nodes().values().enumerate() {
        let sources = node.inputs.values().flat_map(|w| &w.from).filter_map(|f| f.split_once('.'));
        for source in sources.filter_map(|(id, _)| number.get(id)) {
            before[i].push(*source);
            after[*source].push(i);
        }
    }
    let columns = columns(&before, &after);
    let sizes: Vec<[f64; 2]> = ids.iter().map(|id| size(id)).collect();
    let mut y = vec![0.0; ids.len()];
    let mut columns: Vec<Vec<usize>> = columns;
    columns.iter().for_each(|c| stack(c, &sizes, &mut y));
    for sweep in 0..SWEEPS {
        let neighbours = if sweep % 2 == 0 { &before } else { &after };
        for c in &mut columns {
            let middle = |i: usize, y: &[f64]| y[i] + sizes[i][1] / 2.0;
            let wish = |i: usize| {
                let n = &neighbours[i];
                if n.is_empty() {
                    middle(i, &y)
                } else {
                    n.iter().map(|j| middle(*j, &y)).sum::<f64>() / n.len() as f64
                }
            };
            let mut keyed: Vec<(f64, usize)> = c.iter().map(|i| (wish(*i), *i)).collect();
            keyed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            *c = keyed.iter().map(|k| k.1).collect();
            stack(c, &sizes, &mut y);
        }
    }
    let mut x = 0.0;
    let mut places = BTreeMap::new();
    for c in &columns {
        let width = c.iter().map(|i| sizes[*i][0]).fold(0.0, f64::max);
        places.extend(c.iter().map(|i| (ids[*i].to_owned(), [x, y[*i]])));
        x += width + GAP[0];
    }
    places
}

/// Nodes by the longest way from the start; sources stand right before what they feed.
fn columns(before: &[Vec<usize>], after: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let count = before.len();
    let mut open: Vec<usize> = before.iter().map(Vec::len).collect();
    let mut height = vec![0_usize; count];
    let mut ready: Vec<usize> = (0..count).filter(|i| open[*i] == 0).collect();
    let mut order = Vec::with_capacity(count);
    while let Some(i) = ready.pop() {
        order.push(i);
        for &j in &after[i] {
            height[j] = height[j].max(height[i] + 1);
            open[j] -= 1;
            if open[j] == 0 {
                ready.push(j);
            }
        }
    }
    let last = order.iter().map(|i| height[*i] + 1).max().unwrap_or(0);
    for i in (0..count).filter(|i| open[*i] > 0) {
        height[i] = last;
    }
    for &i in order.iter().rev() {
        if let Some(nearest) = after[i].iter().map(|j| height[*j]).min()
            && before[i].is_empty()
        {
            height[i] = nearest.saturating_sub(1);
        }
    }
    let mut columns = vec![Vec::new(); height.iter().max().map_or(0, |h| h + 1)];
    (0..count).for_each(|i| columns[height[i]].push(i));
    columns
}

/// Stacks a column in its order around y = 0.
fn stack(column: &[usize], sizes: &[[f64; 2]], y: &mut [f64]) {
    let total: f64 = column.iter().map(|i| sizes[*i][1] + GAP[1]).sum();
    let mut at = -total / 2.0;
    for &i in column {
        y[i] = at.round();
        at += sizes[i][1] + GAP[1];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tenon_engine::Node;

    #[test]
    fn wires_go_to_the_right_and_no_two_nodes_overlap() {
        let mut d = Document::new();
        d.insert("a", Node::new("x")).unwrap();
        d.insert("b", Node::new("x").wire("i", "a.o")).unwrap();
        d.insert("c", Node::new("x").wire("i", "a.o")).unwrap();
        d.insert("d", Node::new("x").wire("i", "b.o").wire("j", "c.o").wire("k", "e.o")).unwrap();
        d.insert("e", Node::new("x")).unwrap();
        let places = arrange(&d, |_| [100.0, 50.0]);
        assert!(places["a"][0] < places["b"][0] && places["b"][0] < places["d"][0]);
        assert_eq!(places["e"][0], places["b"][0], "a source stands right before what it feeds");
        let all: Vec<_> = places.values().collect();
        for (i, p) in all.iter().enumerate() {
            for q in &all[i + 1..] {
                assert!((p[0] - q[0]).abs() >= 100.0 || (p[1] - q[1]).abs() >= 50.0, "{p:?} {q:?}");
            }
        }
    }

    #[test]
    fn a_ring_is_placed_too() {
        let mut d = Document::new();
        d.insert("a", Node::new("x").wire("i", "b.o")).unwrap();
        d.insert("b", Node::new("x").wire("i", "a.o")).unwrap();
        assert_eq!(arrange(&d, |_| [1.0, 1.0]).len(), 2);
    }
}
