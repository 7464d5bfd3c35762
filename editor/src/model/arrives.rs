//! What arrives at an input: what its wires bring, one behind the other and shaped as the graph says, or what stands there.

use super::Model;
use std::borrow::Cow;
use tenon_engine::{Column, Json, Path, Text, Tree, TreeOp};

impl Model {
    /// The value at an input of a node on the canvas: that of its wires, else its parameter or default. None if there is none
    /// yet, or what the wires bring is of several types. O(1) for one wire as it is, else O(items).
    #[must_use]
    pub fn arrives(&self, node: &str, port: &str) -> Option<Cow<'_, Tree>> {
        let there = self.document().nodes().get(node)?;
        let wires = there.inputs.get(port).filter(|w| !w.from.is_empty());
        let Some(wires) = wires else {
            let default = || self.catalog.of(there).inputs.iter().find(|p| p.name == port)?.default.clone();
            return self.param(node, port).or_else(default).map(|json| Cow::Owned(of_json(&json)));
        };
        let trees: Vec<&Tree> = wires.from.iter().map(|from| self.value(from)).collect::<Option<_>>()?;
        let tree = match trees[..] {
            [one] => Cow::Borrowed(one),
            _ => Cow::Owned(merged(&trees)?),
        };
        Some(wires.more.tree.iter().fold(tree, |tree, op| Cow::Owned(shaped(&tree, *op))))
    }
}

/// Branches of equal path become one, in the order of the wires.
fn merged(trees: &[&Tree]) -> Option<Tree> {
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
        let both = merged(&[&a, &b]).unwrap();
        assert_eq!((both.branches().len(), both.len()), (1, 3));
        let grafted = merged(&[&a.graft(), &b.graft()]).unwrap();
        assert_eq!((grafted.branches().len(), grafted.len()), (2, 3), "{{0;0}} of both is one branch");
        assert_eq!(shaped(&grafted, TreeOp::Flatten).branches().len(), 1);
    }

    #[test]
    fn literals_are_lists_too() {
        assert_eq!(of_json(&serde_json::json!([1, 2.5])).len(), 2);
        assert_eq!(of_json(&serde_json::json!([[0, 0], [1, 2]])).type_name(), "text");
    }
}
