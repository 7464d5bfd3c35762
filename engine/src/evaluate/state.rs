//! What a session keeps of each node and of each output: a few bytes, since there may be a million of them.

use super::cache::Reports;
use crate::value::Tree;
use crate::value::digest::Packed;

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Status {
    /// Never evaluated.
    #[default]
    New,
    Good,
    Failed,
    Blocked,
    Disabled,
}

/// What a session knows of one node.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct NodeRun {
    /// Digest of type and inputs that led to what it has; 0: of none.
    pub key: Packed,
    pub status: Status,
    /// It must be looked at: an input may have changed.
    pub dirty: bool,
    /// Its outputs are in memory.
    pub present: bool,
    /// Its outputs are needed even if nothing changed: somebody must read them.
    pub wanted: bool,
    /// It belongs to what was asked for last.
    pub needed: bool,
}

impl NodeRun {
    pub fn new(key: u128, status: Status) -> Self {
        Self { key: key.into(), status, ..Self::default() }
    }
}

/// What few nodes have: something to say, or a reason why they did not run.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Told {
    pub reports: Reports,
    /// The node whose failure blocks this one; itself if it is at the root.
    pub blocked_by: Option<u32>,
}

impl Told {
    /// What a node says that ran or failed; none if it is good and silent.
    pub fn of(status: Status, n: u32, reports: Reports) -> Option<Self> {
        (status != Status::Good || reports.is_some()).then_some(Self { reports, blocked_by: Some(n) })
    }
}

/// What stands at an output.
#[derive(Clone, Debug, Default)]
pub(crate) enum Value {
    #[default]
    Nothing,
    /// Dropped from memory; the digest stays.
    Gone(Packed),
    Here(Tree),
}

impl Value {
    #[inline]
    pub fn number(v: f64) -> Self {
        Self::Here(Tree::item(v))
    }

    #[inline]
    pub fn tree(&self) -> Option<&Tree> {
        match self {
            Self::Here(tree) => Some(tree),
            Self::Nothing | Self::Gone(_) => None,
        }
    }

    /// 0 for nothing.
    #[inline]
    pub fn digest(&self) -> u128 {
        match self {
            Self::Nothing => 0,
            Self::Gone(digest) => (*digest).into(),
            Self::Here(tree) => tree.digest(),
        }
    }

    #[inline]
    pub fn bytes(&self) -> usize {
        self.tree().map_or(0, Tree::bytes)
    }

    /// Drops the tree and keeps its digest; a number alone takes no more room than that.
    pub fn drop_tree(&mut self) {
        if let Self::Here(tree) = self
            && tree.as_number().is_none()
        {
            *self = Self::Gone(tree.digest().into());
        }
    }
}

impl From<Option<Tree>> for Value {
    #[inline]
    fn from(tree: Option<Tree>) -> Self {
        tree.map_or(Self::Nothing, Self::Here)
    }
}

/// The same, whether in memory or dropped from it.
impl PartialEq for Value {
    #[inline]
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Here(a), Self::Here(b)) => a == b,
            _ => self.digest() == other.digest(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_the_same_when_it_is_gone() {
        for tree in [Tree::item(1.5), Tree::list(vec![1, 2]), Tree::list(vec![1.0, 2.0]).graft()] {
            let here = Value::Here(tree);
            let mut gone = here.clone();
            gone.drop_tree();
            // A number takes no more room than its digest would.
            assert_eq!(gone.tree().is_some(), here.tree().is_some_and(|t| t.as_number().is_some()));
            assert!(gone == here && gone.digest() == here.digest());
            assert!(here != Value::Nothing && here != Value::Here(Tree::item(2.5)));
        }
        // A million nodes have a million of these.
        assert!(size_of::<Value>() <= 32 && size_of::<NodeRun>() <= 24);
    }
}
