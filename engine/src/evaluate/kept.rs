//! A node's result as bytes: outputs, what the node said, and what it cost; and back, checked by the outputs' digests.

use crate::diagnostic::{Fail, Severity};
use crate::registry::Registry;
use crate::stop::Stoppable;
use crate::value::{Path, Tree, pack, unpack};
use serde::{Deserialize, Serialize};

/// Version of the layout below; part of every key, so that no entry of another version is ever met.
pub(crate) const FORMAT: u32 = 2;

/// A node's result as it outlives the process. Without outputs: the node failed.
#[derive(Clone, Debug, PartialEq)]
pub struct Kept {
    /// By output port.
    pub outputs: Vec<Tree>,
    /// What the node said; told again when the result is used again.
    pub reports: Vec<(Severity, Fail)>,
    /// It gave nothing.
    pub failed: bool,
    /// What it took to compute, ns.
    pub nanoseconds: u64,
}

/// Why bytes are no result.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NotKept {
    /// Of an item type that this program does not know, or writes in another way: another program's, as good as not there.
    Foreign,
    /// Not what [`Kept::encode`] has written, for this reason.
    Damaged(&'static str),
}

#[derive(Serialize, Deserialize)]
struct Head<'a> {
    failed: bool,
    nanoseconds: u64,
    reports: Vec<(Severity, Fail)>,
    #[serde(borrow)]
    outputs: Vec<TreeHead<'a>>,
}

#[derive(Serialize, Deserialize)]
struct TreeHead<'a> {
    digest: u128,
    #[serde(borrow)]
    branches: Vec<BranchHead<'a>>,
}

/// The items follow after the head, branch by branch.
#[derive(Serialize, Deserialize)]
struct BranchHead<'a> {
    path: Vec<i32>,
    type_name: &'a str,
    format: u32,
    len: u64,
    valid: Option<Vec<bool>>,
}

impl Kept {
    /// The result as bytes; `None` if an item is of a type that is not kept. O(bytes).
    #[must_use]
    pub fn encode(&self) -> Option<Vec<u8>> {
        encode(&self.outputs, &self.reports, self.failed, self.nanoseconds)
    }

    /// The result that [`Kept::encode`] made `bytes` of. Bytes may be anything: this neither panics nor takes memory out
    /// of proportion to their number. O(bytes).
    ///
    /// # Errors
    /// If they are no result, or one of item types that `registry` does not have in this form.
    pub fn decode(mut bytes: &[u8], registry: &Registry) -> Result<Self, NotKept> {
        let head: Head<'_> = unpack(&mut bytes).ok_or(NotKept::Damaged("its head cannot be read"))?;
        let mut outputs = Vec::with_capacity(head.outputs.len());
        for TreeHead { digest, branches: heads } in head.outputs {
            let mut branches = Vec::with_capacity(heads.len());
            for b in heads.into_iter().stoppable() {
                let empty = registry.empty_column(b.type_name).ok_or(NotKept::Foreign)?;
                if empty.format() == 0 || empty.format() != b.format {
                    return Err(NotKept::Foreign);
                }
                let len = usize::try_from(b.len).ok();
                let column = len.and_then(|len| empty.decode(len, b.valid, &mut bytes));
                branches.push((Path::new(b.path), column.ok_or(NotKept::Damaged("its items cannot be read"))?));
            }
            let tree = Tree::from_branches(branches);
            if tree.digest() != digest {
                return Err(NotKept::Damaged("its values have another digest than they had"));
            }
            outputs.push(tree);
        }
        if !bytes.is_empty() {
            return Err(NotKept::Damaged("it has more bytes than belong to it"));
        }
        Ok(Self { outputs, reports: head.reports, failed: head.failed, nanoseconds: head.nanoseconds })
    }
}

/// As [`Kept::encode`], of parts.
pub(crate) fn encode(
    outputs: &[Tree],
    reports: &[(Severity, Fail)],
    failed: bool,
    nanoseconds: u64,
) -> Option<Vec<u8>> {
    let mut heads = Vec::with_capacity(outputs.len());
    for tree in outputs {
        let mut branches = Vec::with_capacity(tree.branches().len());
        for (path, column) in tree.branches().iter().stoppable() {
            branches.push(BranchHead {
                path: path.steps().to_vec(),
                type_name: column.type_name(),
                format: column.format(),
                len: column.len() as u64,
                valid: column.valid().map(<[bool]>::to_vec),
            });
        }
        heads.push(TreeHead { digest: tree.digest(), branches });
    }
    let mut out = Vec::new();
    let head = Head { failed, nanoseconds, reports: reports.to_vec(), outputs: heads };
    let mut columns = outputs.iter().flat_map(|tree| tree.branches()).stoppable();
    (pack(&head, &mut out) && columns.all(|(_, column)| column.encode(&mut out))).then_some(out)
}
