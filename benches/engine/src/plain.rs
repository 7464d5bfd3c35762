//! The engine that one writes first: petgraph, a topological sort, values in a hash map; a node whose value stays the
//! same does not wake those behind it.

use crate::Engine;
use crate::graph::{Graph, Kind};
use petgraph::Direction;
use petgraph::stable_graph::{NodeIndex, StableDiGraph};
use petgraph::visit::EdgeRef;
use std::collections::{HashMap, HashSet};
use std::sync::Arc;

/// What flows: a number, or a list (which these graphs have none of).
#[derive(Clone, Debug, PartialEq)]
enum Value {
    Number(f64),
    #[allow(dead_code)]
    List(Arc<[f64]>),
}

/// Kind and own number by node, port number by edge.
pub struct Plain {
    graph: StableDiGraph<(Kind, f64), u32>,
    values: HashMap<NodeIndex, Value>,
    dirty: HashSet<NodeIndex>,
    first: NodeIndex,
    last: NodeIndex,
}

impl Plain {
    pub fn new(from: &Graph) -> Self {
        let mut graph = StableDiGraph::new();
        let mut nodes = Vec::with_capacity(from.nodes.len());
        for node in &from.nodes {
            let n = graph.add_node((node.kind, node.own));
            for (port, input) in node.inputs.iter().enumerate() {
                graph.add_edge(nodes[*input], n, port as u32);
            }
            nodes.push(n);
        }
        let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
        Self { graph, values: HashMap::new(), dirty: nodes.into_iter().collect(), first, last }
    }
}

impl Engine for Plain {
    fn set(&mut self, value: f64) {
        self.graph[self.first].1 = value;
        self.dirty.insert(self.first);
    }

    fn evaluate(&mut self) -> f64 {
        let order = petgraph::algo::toposort(&self.graph, None).expect("no cycle");
        for n in order {
            if !self.dirty.remove(&n) {
                continue;
            }
            let edges = self.graph.edges_directed(n, Direction::Incoming);
            let mut inputs: Vec<(u32, NodeIndex)> = edges.map(|e| (*e.weight(), e.source())).collect();
            inputs.sort_unstable();
            let (kind, own) = self.graph[n];
            let number = |(_, source): &(u32, NodeIndex)| match &self.values[source] {
                Value::Number(v) => *v,
                Value::List(l) => l.iter().sum(),
            };
            let value = Value::Number(kind.apply(own, inputs.iter().map(number)));
            if self.values.get(&n) != Some(&value) {
                self.values.insert(n, value);
                self.dirty.extend(self.graph.neighbors(n));
            }
        }
        match &self.values[&self.last] {
            Value::Number(v) => *v,
            Value::List(l) => l.iter().sum(),
        }
    }
}
