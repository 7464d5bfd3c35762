//! The order of the plan: who comes after whom, at what height, and which nodes wait for each other in circles.

use super::{Plan, Slot, UNKNOWN};
use crate::diagnostic::Diagnostic;
use petgraph::algo::kosaraju_scc;
use petgraph::graph::DiGraph;
use std::collections::{HashMap, VecDeque};
use std::fmt::Write;

impl Plan {
    pub(super) fn find_successors(&mut self) {
        let count = self.nodes.len();
        // Counting sort by source; a successor reached by several wires counts once.
        let mut start = vec![0u32; count + 1];
        let mut last = vec![UNKNOWN; count];
        let mut edges = Vec::with_capacity(count);
        for n in 0..count {
            for source in self.predecessors(n) {
                if last[source as usize] != n as u32 {
                    last[source as usize] = n as u32;
                    start[source as usize + 1] += 1;
                    edges.push((source, n as u32));
                }
            }
        }
        for i in 0..count {
            start[i + 1] += start[i];
            self.nodes[i].successors = start[i];
        }
        self.successors = vec![0; edges.len()];
        for (source, n) in edges {
            let at = &mut start[source as usize];
            self.successors[*at as usize] = n;
            *at += 1;
        }
    }

    /// Heights by Kahn's order; what stays behind contains the cycles, which are named and then taken as sources.
    pub(super) fn order(&mut self) {
        let mut left = self.heights();
        if left.is_empty() {
            return;
        }
        left.sort_unstable();
        let mut graph = DiGraph::<u32, ()>::with_capacity(left.len(), left.len());
        let index: Vec<_> = left.iter().map(|n| graph.add_node(*n)).collect();
        for (i, n) in left.iter().enumerate() {
            for s in self.successors(*n as usize) {
                if let Ok(j) = left.binary_search(s) {
                    graph.add_edge(index[i], index[j], ());
                }
            }
        }
        let mut cycles: Vec<Vec<u32>> = kosaraju_scc(&graph)
            .into_iter()
            .map(|scc| {
                let mut nodes: Vec<u32> = scc.into_iter().map(|i| graph[i]).collect();
                nodes.sort_unstable();
                nodes
            })
            .filter(|c| c.len() > 1 || self.successors(c[0] as usize).contains(&c[0]))
            .collect();
        cycles.sort();
        for cycle in cycles {
            let name = self.name_cycle(&cycle);
            for n in cycle {
                let message = format!("the node waits for itself: {name}");
                let diagnostic = Diagnostic::error("cycle", message).hint("remove one of these wires");
                self.error(n as usize, None, diagnostic.at(self.ids[n as usize].to_owned()));
                for p in 0..self.slot_count(n as usize) {
                    let at = self.nodes[n as usize].slots as usize + p;
                    if self.slots[at].is_wired() {
                        self.slots[at] = Slot::Missing;
                    }
                }
            }
        }
        self.find_successors();
        self.heights();
    }

    /// Sets heights; gives the nodes that could not be reached because they wait for each other.
    fn heights(&mut self) -> Vec<u32> {
        let count = self.nodes.len();
        self.nodes.iter_mut().for_each(|n| n.height = 0);
        let mut waiting = vec![0u32; count];
        for s in &self.successors {
            waiting[*s as usize] += 1;
        }
        let mut ready: Vec<u32> = (0..count as u32).filter(|n| waiting[*n as usize] == 0).collect();
        let mut next = 0;
        while next < ready.len() {
            let n = ready[next] as usize;
            next += 1;
            let height = self.nodes[n].height + 1;
            for at in self.successor_range(n) {
                let s = self.successors[at] as usize;
                self.nodes[s].height = self.nodes[s].height.max(height);
                waiting[s] -= 1;
                if waiting[s] == 0 {
                    ready.push(s as u32);
                }
            }
        }
        self.levels = self.nodes.iter().map(|n| n.height as usize + 1).max().unwrap_or(0);
        (0..count as u32).filter(|n| waiting[*n as usize] > 0).collect()
    }

    /// "a.x -> b.y -> a.x": a shortest cycle through the first node.
    fn name_cycle(&self, cycle: &[u32]) -> String {
        let first = cycle[0];
        let mut came_from: HashMap<u32, u32> = HashMap::new();
        let mut queue = VecDeque::from([first]);
        let mut end = first;
        'search: while let Some(n) = queue.pop_front() {
            for s in self.successors(n as usize) {
                if *s == first {
                    end = n;
                    break 'search;
                }
                if cycle.binary_search(s).is_ok() && !came_from.contains_key(s) {
                    came_from.insert(*s, n);
                    queue.push_back(*s);
                }
            }
        }
        let mut walk = vec![end];
        while let Some(n) = walk.last().and_then(|n| came_from.get(n)) {
            if walk.last() == Some(&first) {
                break;
            }
            walk.push(*n);
        }
        walk.reverse();
        let mut text = String::new();
        for (i, n) in walk.iter().enumerate() {
            if walk.len() > 12 && (6..walk.len() - 5).contains(&i) {
                if i == 6 {
                    let _ = write!(text, "… {} more -> ", walk.len() - 11);
                }
                continue;
            }
            let next = walk.get(i + 1).copied().unwrap_or(first);
            let _ = write!(text, "{} -> ", self.output_towards(*n, next));
        }
        let back = self.output_towards(first, walk.get(1).copied().unwrap_or(first));
        text + &back
    }

    fn output_towards(&self, n: u32, next: u32) -> String {
        let id = &self.ids[n as usize];
        let wire = self.node_wires(next as usize).find(|w| self.output_node[*w as usize] == n);
        let port = wire.and_then(|w| {
            let o = (w - self.nodes[n as usize].outputs) as usize;
            self.node_type(n as usize).and_then(|t| t.outputs.get(o))
        });
        port.map_or_else(|| id.to_string(), |p| format!("{id}.{}", p.name))
    }
}
