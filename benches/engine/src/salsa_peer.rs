//! The graph in salsa 0.28: nodes are inputs, their values a tracked function of a node.

use crate::Engine;
use crate::graph::{Graph, Kind};
use salsa::Setter;

/// Bits, so that values compare as salsa wants them to.
#[derive(Clone, Copy, PartialEq, Eq, Debug, salsa::SalsaValue)]
pub struct Number(u64);

/// The kind of a node; salsa wants its own trait on field types.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Hash, salsa::SalsaValue)]
pub struct Code(u8);

#[salsa::input]
pub struct Node {
    #[returns(copy)]
    pub kind: Code,
    #[returns(copy)]
    pub own: Number,
    #[returns(ref)]
    pub inputs: Vec<Node>,
}

#[salsa::tracked(returns(copy))]
fn value(db: &dyn salsa::Database, node: Node) -> Number {
    let kind = match node.kind(db).0 {
        0 => Kind::Source,
        1 => Kind::Quantise,
        _ => Kind::Add,
    };
    let inputs = node.inputs(db).iter().map(|n| f64::from_bits(value(db, *n).0));
    Number(kind.apply(f64::from_bits(node.own(db).0), inputs).to_bits())
}

/// The database and the nodes that are asked about.
pub struct Salsa {
    db: salsa::DatabaseImpl,
    first: Node,
    last: Node,
}

impl Salsa {
    pub fn new(graph: &Graph) -> Self {
        let db = salsa::DatabaseImpl::new();
        let mut nodes: Vec<Node> = Vec::with_capacity(graph.nodes.len());
        for node in &graph.nodes {
            let inputs: Vec<Node> = node.inputs.iter().map(|n| nodes[*n]).collect();
            let code = match node.kind {
                Kind::Source => 0,
                Kind::Quantise => 1,
                Kind::Add => 2,
            };
            // What stays while a user turns a slider is told to salsa: it then looks at less.
            let new = Node::builder(Code(code), Number(node.own.to_bits()), inputs)
                .kind_durability(salsa::Durability::HIGH)
                .inputs_durability(salsa::Durability::HIGH);
            nodes.push(new.new(&db));
        }
        let (first, last) = (nodes[0], nodes[nodes.len() - 1]);
        Self { db, first, last }
    }
}

impl Engine for Salsa {
    fn set(&mut self, number: f64) {
        self.first.set_own(&mut self.db).to(Number(number.to_bits()));
    }

    fn evaluate(&mut self) -> f64 {
        f64::from_bits(value(&self.db, self.last).0)
    }
}
