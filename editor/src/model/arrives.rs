//! What arrives at an input: what its wires bring, one behind the other and shaped as the graph says, or what stands there.

use super::Model;
use std::hash::{DefaultHasher, Hash, Hasher};
use tenon_engine::{Column, Json, Path, Text, Tree, TreeOp};

/// What an input is made of; putting it together may take long and needs nothing else.
#[derive(Clone, Debug)]
pub struct Arriving {
    /// What the wires bring.
    trees: Vec<Tree>,
    ops: Vec<TreeOp>,
}

impl From<&Tree> for Arriving {
    fn from(tree: &Tree) -> Self {
        Self { trees: vec![tree.clone()], ops: Vec::new() }
    }
}

impl Arriving {
    /// Differs where the value does. O(wires).
    #[must_use]
    pub fn key(&self) -> u128 {
        let mut hasher = DefaultHasher::new();
        self.trees.iter().for_each(|tree| tree.digest().hash(&mut hasher));
        self.ops.hash(&mut hasher);
        hasher.finish().into()
    }

    /// The value; none if what the wires bring is of several types. O(1) for one wire as it is, else O(items).
    #[must_use]
    pub fn value(&self) -> Option<Tree> {
        let tree = match &self.trees[..] {
            [one] => one.clone(),
            all => merged(all)?,
        };
        Some(self.ops.iter().fold(tree, |tree, op| shaped(&tree, *op)))
    }
}

impl Model {
    /// What arrives at an input of a node on the canvas: by its wires, else its parameter or default. None if there is
    /// nothing yet. O(wires).
    #[must_use]
    pub fn arriving(&self, node: &str, port: &str) -> Option<Arriving> {
        let there = self.document().nodes().get(node)?;
        let wires = there.inputs.get(port).filter(|w| !w.from.is_empty());
        let Some(wires) = wires else {
            let default = || self.catalog.of(there).inputs.iter().find(|p| p.name == port)?.default.clone();
            return self.param(node, port).or_else(default).map(|json| Arriving::from(&of_json(&json)));
        };
        let trees = wires.from.iter().map(|from| self.value(from).cloned()).collect::<Option<_>>()?;
        Some(Arriving { trees, ops: wires.more.tree.clone() })
    }
}

/// Branches of equal path become one, in the order of the wires.
fn merged(trees: &[Tree]) -> Option<Tree> {
    let mut branches: Vec<(Path, Vec<Column>)> = Vec::new();
    let mut place: std::collections::BTreeMap<String, usize> = Default::default();
    for (path, column) in trees.iter().flat_map(|tree| tree.branches()) {
        let at = *place.entry(path.to_string()).or_insert_with(|| {
            branches.push((path.clone(), Vec::new()));
            branches.len() - 1
        });
        branches[at].1.push(column.clone());
    }
    let all = branches.into_iter().map(|(path, columns)| Some((path, Column::concat(&columns)?)));
    all.collect::<Option<Vec<_>>>().map(Tree::from_branches)
}

fn shaped(tree: &Tree, op: TreeOp) -> Tree {
    match op {
        TreeOp::Graft => tree.graft(),
        TreeOp::Flatten => tree.flatten(),
        TreeOp::Simplify => tree.simplify(),
        TreeOp::Reverse => tree.reverse(),
    }
}

/// A literal as people wrote it: numbers as numbers, everything else as text.
fn of_json(json: &Json) -> Tree {
    let items = match json {
        Json::Array(items) => items.as_slice(),
        one => std::slice::from_ref(one),
    };
    let numbers: Option<Vec<f64>> = items.iter().map(Json::as_f64).collect();
    match numbers {
        Some(numbers) => Tree::list(numbers),
        None => Tree::list(items.iter().map(|j| Text::from(super::param::to_text(Some(j)).as_str())).collect()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wires_follow_one_another_branch_by_branch() {
        let (a, b) = (Tree::list(vec![1.0, 2.0]), Tree::list(vec![3.0]));
        let both = merged(&[a.clone(), b.clone()]).unwrap();
        assert_eq!((both.branches().len(), both.len()), (1, 3));
        let grafted = merged(&[a.graft(), b.graft()]).unwrap();
        assert_eq!((grafted.branches().len(), grafted.len()), (2, 3), "{{0;0}} of both is one branch");
        assert_eq!(shaped(&grafted, TreeOp::Flatten).branches().len(), 1);
    }

    #[test]
    fn another_value_has_another_key() {
        let (a, b) = (Tree::list(vec![1.0, 2.0]), Tree::list(vec![3.0]));
        let all = [
            Arriving::from(&a),
            Arriving { trees: vec![a.clone(), b.clone()], ops: Vec::new() },
            Arriving { trees: vec![b, a.clone()], ops: Vec::new() },
            Arriving { trees: vec![a.clone(), a.clone()], ops: Vec::new() },
            Arriving { trees: vec![a.clone()], ops: vec![TreeOp::Graft] },
            Arriving { trees: vec![a], ops: vec![TreeOp::Reverse] },
        ];
        let keys: std::collections::BTreeSet<u128> = all.iter().map(Arriving::key).collect();
        assert_eq!(keys.len(), all.len());
    }

    #[test]
    fn literals_are_lists_too() {
        assert_eq!(of_json(&serde_json::json!([1, 2.5])).len(), 2);
        assert_eq!(of_json(&serde_json::json!([[0, 0], [1, 2]])).type_name(), "text");
    }
}
