//! What arrives at an input: what its wires bring, put together as the engine does it, or what stands there, read as the engine
//! reads it.

use super::Model;
use std::hash::{DefaultHasher, Hash, Hasher};
use tenon_engine::{Access, Options, Port, Session, Tree, TreeOp};

/// What a value is made of. To look at this costs nothing; to make the value may take long.
#[derive(Clone)]
pub enum Arriving {
    /// A value as it is.
    Value(Tree),
    /// What wires bring to a port.
    Wires {
        /// The port that takes it.
        port: Box<Port>,
        /// By wire, in their order.
        trees: Vec<Tree>,
        /// How the graph shapes all of it.
        shape: Vec<TreeOp>,
    },
    /// What stands in the graph.
    Literal {
        /// The input's `node.port`, with the path of its node.
        address: String,
        /// Of the document that it stands in.
        revision: u64,
    },
}

/// Makes a value, on whichever thread; none if there is none. An error says for people why there cannot be any.
pub type Make = Box<dyn FnOnce() -> Result<Option<Tree>, String> + Send>;

impl Arriving {
    /// Differs where the value may differ. O(wires).
    #[must_use]
    pub fn key(&self) -> u128 {
        let mut hasher = DefaultHasher::new();
        match self {
            Self::Value(tree) => return tree.digest(),
            Self::Wires { port, trees, shape } => {
                (port.type_name(), shape).hash(&mut hasher);
                trees.iter().for_each(|tree| tree.digest().hash(&mut hasher));
            }
            Self::Literal { address, revision } => (address, revision).hash(&mut hasher),
        }
        hasher.finish().into()
    }
}

impl Model {
    /// What arrives at an input of a node on the canvas: by its wires, else its parameter or default. None if there is
    /// nothing yet. O(wires).
    #[must_use]
    pub fn arriving(&self, node: &str, port: &str) -> Option<Arriving> {
        let there = self.document().nodes().get(node)?;
        let Some(wires) = there.inputs.get(port).filter(|w| !w.from.is_empty()) else {
            let address = format!("{}.{port}", self.path_of(node));
            return Some(Arriving::Literal { address, revision: self.revision() });
        };
        let trees = wires.from.iter().map(|from| self.value(from).cloned()).collect::<Option<_>>()?;
        let info = self.catalog.of(there);
        let takes = info.inputs.iter().find(|p| p.name == port).map_or("any", |p| p.type_name.as_str());
        let known = |name| self.registry.port(port, name, Access::Tree).map(Box::new);
        Some(Arriving::Wires { port: known(takes).or_else(|| known("any"))?, trees, shape: wires.more.tree.clone() })
    }

    /// How a value is made. O(document) for what stands in the graph: formulas in it may name all inputs.
    #[must_use]
    pub fn make(&self, arriving: Arriving) -> Make {
        let registry = self.registry.clone();
        match arriving {
            Arriving::Value(tree) => Box::new(|| Ok(Some(tree))),
            Arriving::Wires { port, trees, shape } => {
                Box::new(move || registry.arriving(&port, &trees, &shape).map(Some).map_err(|why| why.to_string()))
            }
            Arriving::Literal { address, .. } => {
                let (document, host) = (self.whole().clone(), self.host());
                Box::new(move || {
                    let session = Session::new(registry, document, Options { host, ..Options::default() });
                    literal(&session, &address)
                })
            }
        }
    }
}

/// What stands at an input before anything has run.
fn literal(session: &Session, address: &str) -> Result<Option<Tree>, String> {
    if session.sources(address).is_ok_and(|from| !from.is_empty()) {
        return Err("It comes from outside of the cluster.".to_owned());
    }
    session.input(address).map_err(|why| why.message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;
    use tenon_engine::{Node, Operation};

    fn model(nodes: impl IntoIterator<Item = (&'static str, Node)>) -> Model {
        let mut model = Model::new(|| ()).unwrap();
        for (id, node) in nodes {
            model.apply(Operation::AddNode { id: id.into(), node: Box::new(node) }).unwrap();
        }
        model
    }

    fn value(model: &Model, node: &str, port: &str) -> Result<Option<Tree>, String> {
        model.make(model.arriving(node, port).unwrap())()
    }

    #[test]
    fn literals_are_what_the_port_makes_of_them() {
        let model = model([
            ("curve", Node::new("ifs_curve").param("points", json!([1, 2, 3]))),
            ("n", Node::new("pack").param("board_x", json!("1.2 m"))),
            ("wrong", Node::new("number").param("value", json!("wide"))),
        ]);
        let point = value(&model, "curve", "points").unwrap().unwrap();
        assert_eq!((point.type_name(), point.len()), ("point", 1));
        assert_eq!(value(&model, "curve", "weights"), Ok(None), "it may stay empty");
        assert_eq!(value(&model, "n", "board_x"), Ok(Some(Tree::item(1200.0))));
        assert!(value(&model, "wrong", "value").is_ok_and(|tree| tree.is_none()), "its node says what is wrong");
    }

    #[test]
    fn another_value_has_another_key() {
        let (a, b) = (Tree::list(vec![1.0, 2.0]), Tree::list(vec![3.0]));
        let registry = tenon_nodes::registry();
        let wires = |trees: &[&Tree], shape: &[TreeOp]| Arriving::Wires {
            port: registry.port("x", "number", Access::Tree).unwrap().into(),
            trees: trees.iter().map(|tree| (*tree).clone()).collect(),
            shape: shape.to_vec(),
        };
        let literal = |address: &str, revision| Arriving::Literal { address: address.to_owned(), revision };
        let all = [
            Arriving::Value(a.clone()),
            wires(&[&a], &[]),
            wires(&[&a, &b], &[]),
            wires(&[&b, &a], &[]),
            wires(&[&a, &a], &[]),
            wires(&[&a], &[TreeOp::Graft]),
            wires(&[&a], &[TreeOp::Reverse]),
            literal("a.x", 1),
            literal("a.x", 2),
            literal("a.y", 1),
        ];
        let keys: std::collections::BTreeSet<u128> = all.iter().map(Arriving::key).collect();
        assert_eq!(keys.len(), all.len());
    }
}
