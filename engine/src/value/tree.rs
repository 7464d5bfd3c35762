//! A tree: what flows on a wire. Branches with paths, each branch a typed column, sorted by path.

use super::column::Column;
use super::digest::{Digester, bits};
use super::item::{Item, Json};
use crate::stop::{Pending, Stoppable, Ticker, let_go};
use std::sync::Arc;

/// Where a branch hangs, `{0;1}`. Nearly every path is `{0}`, which takes no memory of its own.
#[derive(Clone, PartialEq, Eq)]
pub struct Path(Option<Arc<Vec<i32>>>);

impl Path {
    /// The path of these steps.
    #[must_use]
    pub fn new(steps: Vec<i32>) -> Self {
        Self((steps != [0]).then(|| Arc::new(steps)))
    }

    /// The path `{0}` of a tree with one branch.
    #[must_use]
    pub fn root() -> Self {
        Self::ROOT
    }

    pub(crate) const ROOT: Self = Self(None);

    #[inline]
    pub(crate) fn is_root(&self) -> bool {
        self.0.is_none()
    }

    /// The steps from the root.
    #[must_use]
    pub fn steps(&self) -> &[i32] {
        self.0.as_ref().map_or(&[0], |steps| steps)
    }

    /// This path with one more step.
    #[must_use]
    pub fn child(&self, step: usize) -> Self {
        self.below(&[i32::try_from(step).unwrap_or(i32::MAX)])
    }

    /// This path with more steps.
    #[must_use]
    pub fn below(&self, more: &[i32]) -> Self {
        Self::new([self.steps(), more].concat())
    }

    fn heap_bytes(&self) -> usize {
        self.0.as_ref().map_or(0, |steps| size_of::<Vec<i32>>() + size_of_val(steps.as_slice()))
    }
}

impl PartialOrd for Path {
    fn partial_cmp(&self, other: &Self) -> Option<std::cmp::Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Path {
    fn cmp(&self, other: &Self) -> std::cmp::Ordering {
        self.steps().cmp(other.steps())
    }
}

impl std::hash::Hash for Path {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.steps().hash(state);
    }
}

impl std::fmt::Debug for Path {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{self}")
    }
}

impl std::fmt::Display for Path {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("{")?;
        for (i, step) in self.steps().iter().enumerate() {
            write!(f, "{}{step}", if i > 0 { ";" } else { "" })?;
        }
        f.write_str("}")
    }
}

/// Branches of items. Immutable; clones share the data.
#[derive(Clone)]
pub struct Tree(Branches);

/// Most trees have one branch, and then need no list of branches; their digest is a few steps from that of the column.
#[derive(Clone)]
enum Branches {
    One((Path, Column)),
    Many(Arc<Many>),
}

struct Many {
    branches: Vec<(Path, Column)>,
    bytes: usize,
    digest: u128,
}

impl Drop for Many {
    fn drop(&mut self) {
        let_go(std::mem::take(&mut self.branches));
    }
}

fn bytes(branches: &[(Path, Column)]) -> usize {
    let one = |(p, c): &(Path, Column)| size_of::<(Path, Column)>() + p.heap_bytes() + c.bytes();
    branches.iter().stoppable().map(one).sum()
}

/// Turns the digest of a column into that of the tree which has it at `{0}` and nothing else.
const ALONE: u128 = 0x6a09_e667_f3bc_c908_bb67_ae85_84ca_a73b;

/// Digest of paths and columns.
fn digest(branches: &[(Path, Column)]) -> u128 {
    let mut d = Digester::new();
    d.u32(branches.len() as u32);
    for (path, column) in branches {
        d.u32(path.steps().len() as u32);
        for step in path.steps() {
            d.u32(*step as u32);
        }
        d.u128(column.digest());
    }
    d.finish()
}

impl Tree {
    /// One item at `{0}`.
    #[must_use]
    pub fn item<T: Item>(item: T) -> Self {
        Self::column(Column::single(item))
    }

    /// One list at `{0}`.
    #[must_use]
    pub fn list<T: Item>(items: Vec<T>) -> Self {
        Self::column(Column::new(items))
    }

    /// One branch at `{0}`.
    #[must_use]
    pub fn column(column: Column) -> Self {
        Self::branch(Path::root(), column)
    }

    pub(crate) fn branch(path: Path, column: Column) -> Self {
        Self(Branches::One((path, column)))
    }

    /// Branches in any order; branches of the same path are joined in the order given (if their types differ, the first stays).
    /// O(n log n).
    #[must_use]
    pub fn from_branches(branches: Vec<(Path, Column)>) -> Self {
        let (mut branches, ticker) = (Pending::new(branches), Ticker::new());
        branches.sort_by(|a, b| {
            ticker.tick();
            a.0.cmp(&b.0)
        });
        if branches.windows(2).stoppable().any(|w| w[0].0 == w[1].0) {
            let mut joined: Pending<(Path, Vec<Column>)> = Pending::new(Vec::new());
            for (path, column) in branches.each().stoppable() {
                match joined.last_mut() {
                    Some((last, columns)) if *last == path => columns.push(column),
                    _ => joined.push((path, vec![column])),
                }
            }
            branches = Pending::new(Vec::with_capacity(joined.len()));
            for (path, columns) in joined.each().stoppable() {
                let column = Column::concat(&columns).or_else(|| columns.into_iter().next());
                branches.extend(column.map(|c| (path, c)));
            }
        }
        Self::sorted(branches)
    }

    fn sorted(mut branches: Pending<(Path, Column)>) -> Self {
        if branches.len() == 1
            && let Some((path, column)) = branches.pop()
        {
            return Self::branch(path, column);
        }
        let (digest, bytes) = (digest(&branches), bytes(&branches));
        Self(Branches::Many(Arc::new(Many { branches: branches.take(), bytes, digest })))
    }

    /// The branches, sorted by path.
    #[must_use]
    pub fn branches(&self) -> &[(Path, Column)] {
        match &self.0 {
            Branches::One(one) => std::slice::from_ref(one),
            Branches::Many(many) => &many.branches,
        }
    }

    /// The first item of the first branch, if it is a `T` and not a gap.
    #[must_use]
    pub fn first<T: Item>(&self) -> Option<&T> {
        self.branches().iter().find(|(_, c)| !c.is_empty()).and_then(|(_, c)| c.get(0))
    }

    /// Number of items in all branches, gaps included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.branches().iter().stoppable().map(|(_, c)| c.len()).sum()
    }

    /// True if no branch has an item.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.branches().iter().all(|(_, c)| c.is_empty())
    }

    /// Digest of paths and columns. O(1).
    #[must_use]
    #[inline]
    pub fn digest(&self) -> u128 {
        match &self.0 {
            // The column's digest, told apart from those of trees with several branches or another path.
            Branches::One((path, column)) if path.is_root() => column.digest() ^ ALONE,
            Branches::One(one) => digest(std::slice::from_ref(one)),
            Branches::Many(many) => many.digest,
        }
    }

    /// The number, if that is all that the tree is.
    #[inline]
    pub(crate) fn as_number(&self) -> Option<f64> {
        self.number_column().map(|(_, v)| v)
    }

    /// ... with the column in which it stands.
    #[inline]
    pub(crate) fn number_column(&self) -> Option<(&Column, f64)> {
        match &self.0 {
            Branches::One((path, column)) if path.is_root() => Some((column, column.as_number()?)),
            _ => None,
        }
    }

    /// Memory in bytes; data that several trees share counts in each.
    #[must_use]
    pub fn bytes(&self) -> usize {
        match &self.0 {
            Branches::One(_) if self.as_number().is_some() => size_of::<(Path, Column)>(),
            Branches::One(one) => bytes(std::slice::from_ref(one)),
            Branches::Many(many) => many.bytes,
        }
    }

    /// Name of the item type; of the first branch, or `"nothing"`.
    #[must_use]
    pub fn type_name(&self) -> &'static str {
        self.branches().first().map_or("nothing", |(_, c)| c.type_name())
    }

    /// `{"type": name, "branches": {"{0}": [items, null at gaps]}}`.
    #[must_use]
    pub fn to_json(&self) -> Json {
        let branches: serde_json::Map<String, Json> =
            self.branches().iter().map(|(p, c)| (p.to_string(), c.to_json())).collect();
        serde_json::json!({ "type": self.type_name(), "branches": branches })
    }

    /// One line for people.
    #[must_use]
    pub fn summary(&self) -> String {
        match self.branches() {
            [(_, one)] if one.len() == 1 => format!("{}: {}", self.type_name(), one.summary(0)),
            [(_, one)] => format!("{} × {}", one.len(), self.type_name()),
            many => format!("{} × {} in {} branches", self.len(), self.type_name(), many.len()),
        }
    }

    /// Every item in its own branch.
    #[must_use]
    pub fn graft(&self) -> Self {
        let (mut out, ticker) = (Pending::new(Vec::with_capacity(self.len())), Ticker::new());
        for (path, column) in self.branches().iter() {
            for i in 0..column.len() {
                ticker.tick();
                out.push((path.child(i), column.part(i, i + 1)));
            }
        }
        Self::sorted(out)
    }

    /// All items in one branch, in path order; unchanged if the branches' types differ.
    #[must_use]
    pub fn flatten(&self) -> Self {
        let columns: Vec<Column> = self.branches().iter().stoppable().map(|(_, c)| c.clone()).collect();
        Column::concat(&columns).map_or_else(|| self.clone(), Self::column)
    }

    /// Paths without the steps that all of them begin with; at least one step stays.
    #[must_use]
    pub fn simplify(&self) -> Self {
        let Some((first, _)) = self.branches().first() else { return self.clone() };
        let shortest = self.branches().iter().stoppable().map(|(p, _)| p.steps().len()).min().unwrap_or(0);
        let mut shared = 0;
        while shared + 1 < shortest
            && self.branches().iter().stoppable().all(|(p, _)| p.steps()[shared] == first.steps()[shared])
        {
            shared += 1;
        }
        self.each(|p, c| (Path::new(p.steps()[shared..].to_vec()), c.clone()))
    }

    /// The items of each branch in reverse order.
    #[must_use]
    pub fn reverse(&self) -> Self {
        self.each(|p, c| (p.clone(), c.pick(&(0..c.len()).rev().stoppable().map(Some).collect::<Vec<_>>())))
    }

    /// Every branch as `change` makes it; their order stays.
    fn each(&self, change: impl Fn(&Path, &Column) -> (Path, Column)) -> Self {
        let mut out = Pending::new(Vec::with_capacity(self.branches().len()));
        out.extend(self.branches().iter().stoppable().map(|(p, c)| change(p, c)));
        Self::sorted(out)
    }
}

impl Default for Tree {
    fn default() -> Self {
        Self::from_branches(Vec::new())
    }
}

impl std::fmt::Debug for Tree {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}", self.to_json())
    }
}

impl PartialEq for Tree {
    #[inline]
    fn eq(&self, other: &Self) -> bool {
        match (self.as_number(), other.as_number()) {
            (Some(a), Some(b)) => bits(a) == bits(b),
            _ => self.digest() == other.digest(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn shape(t: &Tree) -> Json {
        t.to_json()["branches"].clone()
    }

    #[test]
    fn graft_flatten_simplify_reverse() {
        let t = Tree::list(vec![1.0, 2.0]);
        assert_eq!(shape(&t.graft()), json!({"{0;0}": [1.0], "{0;1}": [2.0]}));
        assert_eq!(shape(&t.graft().simplify()), json!({"{0}": [1.0], "{1}": [2.0]}));
        assert_eq!(t.graft().flatten(), t);
        assert_eq!(shape(&t.reverse()), json!({"{0}": [2.0, 1.0]}));
    }

    #[test]
    fn branches_are_sorted_and_equal_paths_join() {
        let b = |p: &[i32], v: f64| (Path::new(p.to_vec()), Column::new(vec![v]));
        let t = Tree::from_branches(vec![b(&[1], 1.0), b(&[0, 2], 2.0), b(&[1], 3.0)]);
        assert_eq!(shape(&t), json!({"{0;2}": [2.0], "{1}": [1.0, 3.0]}));
    }
}
