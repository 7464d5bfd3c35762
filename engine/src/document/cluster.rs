//! Clusters: a graph with an interface that other graphs use as a node. The definition stands in the same file or in a
//! file of its own, pinned by version and digest.

use super::model::{Document, Node};
use crate::value::{Json, digest_bytes};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What a node's type begins with if it is an instance of a cluster: `cluster:NAME`.
pub(crate) const PREFIX: &str = "cluster:";

/// A definition that nodes of type `cluster:NAME` are instances of.
#[derive(Clone, Debug, PartialEq)]
pub enum Cluster {
    /// It stands in this file. Of the document only interface, nodes, groups, foreign data and positions count:
    /// clusters stand at the top of a file.
    Here(Box<Document>),
    /// It is another graph's file, used through its interface.
    File(Link),
}

/// A cluster in another file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Link {
    /// Path of the graph file, relative to the file that links to it.
    pub file: String,
    /// The version that the file's interface must have.
    pub version: Option<u32>,
    /// The digest that the file's content must have, see [`Document::digest`].
    pub digest: Option<String>,
    pub(crate) extra: BTreeMap<String, Json>,
}

impl Link {
    /// A link that follows the file, whatever stands in it.
    #[must_use]
    pub fn new(file: impl Into<String>) -> Self {
        Self { file: file.into(), ..Self::default() }
    }
}

/// A linked file as it was read.
#[derive(Clone, Debug)]
pub(crate) struct LinkedFile {
    /// Of the bytes, so that a file that stays as it was is not parsed again.
    pub bytes: u128,
    /// Of what the file says, as links pin it.
    pub digest: String,
    pub document: Document,
}

/// Linked files by their path from the graph's own folder, or why they could not be read. They do not count when
/// documents are compared.
#[derive(Clone, Debug, Default)]
pub(crate) struct Linked(pub BTreeMap<String, Result<Arc<LinkedFile>, String>>);

impl Linked {
    /// True if other files, or other content of files, were read.
    pub fn differs(&self, other: &Self) -> bool {
        let content = |linked: &Self| -> Vec<(String, Result<u128, String>)> {
            let files = linked.0.iter();
            files.map(|(path, f)| (path.clone(), f.as_ref().map(|f| f.bytes).map_err(Clone::clone))).collect()
        };
        content(self) != content(other)
    }
}

impl PartialEq for Linked {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Node {
    /// An instance of the cluster of that name.
    #[must_use]
    pub fn instance(cluster: &str) -> Self {
        Self::new(format!("{PREFIX}{cluster}"))
    }

    /// The name of the cluster that this node is an instance of.
    #[must_use]
    pub fn cluster(&self) -> Option<&str> {
        self.type_name.strip_prefix(PREFIX)
    }
}

impl Document {
    /// The version of the interface (`interface.version`), 1 if it says none: raised when instances would mean something
    /// else than before.
    #[must_use]
    pub fn interface_version(&self) -> u32 {
        let version = self.interface_extra.get("version").and_then(Json::as_u64);
        version.and_then(|v| u32::try_from(v).ok()).unwrap_or(1)
    }

    /// What the graph does, for those who use it as a cluster (`interface.doc`).
    #[must_use]
    pub fn doc(&self) -> Option<&str> {
        self.interface_extra.get("doc").and_then(Json::as_str)
    }

    /// The digest of what the file says (`xxh3:` and 32 hexadecimal digits): spaces, order of keys and the layout do not
    /// matter. Files that it links to do not count; they have pins of their own. O(n log n).
    #[must_use]
    pub fn digest(&self) -> String {
        format!("xxh3:{:032x}", digest_bytes(self.to_string_canonical().as_bytes()))
    }
}

/// The value as an interface's version, if it can be one.
pub(crate) fn is_version(value: &Json) -> bool {
    value.as_u64().is_some_and(|v| (1..=u64::from(u32::MAX)).contains(&v))
}
