//! The graphs that every engine gets.

/// What a node does.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash)]
pub enum Kind {
    /// Gives its own number.
    Source,
    /// Rounds its input down to thousands, so that small changes end here.
    Quantise,
    /// Its own number and all inputs together.
    Add,
}

impl Kind {
    /// What the node gives.
    pub fn apply(self, own: f64, inputs: impl Iterator<Item = f64>) -> f64 {
        match self {
            Self::Source => own,
            Self::Quantise => (inputs.sum::<f64>() / 1000.0).floor(),
            Self::Add => own + inputs.sum::<f64>(),
        }
    }
}

/// One node; inputs come before it.
#[derive(Clone, Debug)]
pub struct Node {
    pub kind: Kind,
    pub own: f64,
    pub inputs: Vec<usize>,
}

/// How the nodes hang together.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Shape {
    /// Each behind the one before.
    Chain,
    /// All behind the quantiser, and one that takes all of them.
    Fan,
}

impl Shape {
    /// Its name in figures.
    pub fn name(self) -> &'static str {
        match self {
            Self::Chain => "chain",
            Self::Fan => "fan",
        }
    }
}

/// Nodes in topological order: the source, the quantiser, and the others.
pub struct Graph {
    pub shape: Shape,
    pub nodes: Vec<Node>,
}

/// What the source gives at first.
pub const FIRST: f64 = 5000.0;

impl Graph {
    /// A graph of `size` nodes.
    pub fn new(shape: Shape, size: usize) -> Self {
        let node = |kind, own, inputs| Node { kind, own, inputs };
        let mut nodes = vec![node(Kind::Source, FIRST, vec![]), node(Kind::Quantise, 0.0, vec![0])];
        match shape {
            Shape::Chain => nodes.extend((2..size).map(|i| node(Kind::Add, i as f64, vec![i - 1]))),
            Shape::Fan => {
                nodes.extend((3..size).map(|i| node(Kind::Add, i as f64, vec![1])));
                let all = (2..nodes.len()).collect();
                nodes.push(node(Kind::Add, 0.0, all));
            }
        }
        Self { shape, nodes }
    }

    /// What the last node gives for a number of the source: a loop without any engine.
    pub fn expected(&self, first: f64) -> f64 {
        let mut values: Vec<f64> = Vec::with_capacity(self.nodes.len());
        for (i, node) in self.nodes.iter().enumerate() {
            let own = if i == 0 { first } else { node.own };
            values.push(node.kind.apply(own, node.inputs.iter().map(|n| values[*n])));
        }
        values.last().copied().unwrap_or_default()
    }
}
