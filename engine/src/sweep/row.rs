//! A row of a sweep and the key that names its result.

use crate::document::{Cluster, Document, Node};
use crate::registry::Registry;
use crate::value::{Digester, Json, digest_bytes};
use std::collections::BTreeMap;

/// One variant of a graph: a line of a plan, `{"key", "graph", "set"}`.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Digest of everything that makes it another than other rows, 32 hexadecimal digits.
    pub key: String,
    /// Where the graph is, as the host says it.
    pub graph: String,
    /// Values of inputs by name; set in order of names.
    pub set: BTreeMap<String, Json>,
}

/// What of a graph goes into the keys of its rows: its text, the files that its clusters are linked from, as
/// [`Document::read_links`] has read them last, and the builds of the plugins whose nodes it has
/// ([`crate::NodeType::build`]). O(document).
#[must_use]
pub fn document_digest(document: &Document, registry: &Registry) -> u128 {
    let text = digest_bytes(document.to_string_canonical().as_bytes());
    let builds = builds(document, registry);
    if document.linked.0.is_empty() && builds.is_empty() {
        return text;
    }
    let mut d = Digester::new();
    d.u128(text);
    for (name, build) in builds {
        d.str(name);
        d.u128(build);
    }
    for (path, file) in &document.linked.0 {
        d.str(path);
        // A file that could not be read is none, whatever the reason was.
        d.str(file.as_ref().map_or("", |file| &file.digest));
    }
    d.finish()
}

/// The builds on which results of the graph's nodes depend, by node type; those inside of its clusters too.
fn builds<'a>(document: &'a Document, registry: &Registry) -> BTreeMap<&'a str, u128> {
    let linked = document.linked.0.values().flatten().map(|file| &file.document);
    let mut all = BTreeMap::new();
    for document in linked.chain([document]) {
        let inner =
            document.clusters.values().filter_map(|c| if let Cluster::Here(body) = c { Some(body) } else { None });
        let nodes = inner.flat_map(|body| body.nodes().values()).chain(document.nodes().values());
        let build = |node: &'a Node| Some((&*node.type_name, registry.get(&node.type_name)?.build));
        all.extend(nodes.filter_map(build).filter(|(_, build)| *build != 0));
    }
    all
}

/// The key of a row; it changes with the engine's version, since results may.
fn key(document: u128, set: &BTreeMap<String, Json>) -> String {
    let mut d = Digester::new();
    d.str("tenon sweep row");
    d.str(env!("CARGO_PKG_VERSION"));
    d.u128(document);
    for (name, value) in set {
        d.str(name);
        d.str(&value.to_string());
    }
    format!("{:032x}", d.finish())
}

impl Row {
    /// The row of a graph with that [`document_digest`].
    #[must_use]
    pub fn new(graph: impl Into<String>, document: u128, set: BTreeMap<String, Json>) -> Self {
        Self { key: key(document, &set), graph: graph.into(), set }
    }

    /// Whether it was planned for a document of that digest, by a program of this version.
    #[must_use]
    pub fn is_of(&self, document: u128) -> bool {
        key(document, &self.set) == self.key
    }

    /// Its line in a plan, without the line's end.
    #[must_use]
    pub fn to_line(&self) -> String {
        serde_json::json!({ "key": self.key, "graph": self.graph, "set": self.set }).to_string()
    }

    /// The row that a line of a plan is; none if it is not one. A key that could not be a file's name is not one.
    #[must_use]
    pub fn from_line(line: &str) -> Option<Self> {
        let row: Json = serde_json::from_str(line).ok()?;
        let key = row["key"].as_str()?.to_owned();
        if key.len() != 32 || !key.bytes().all(|b| b.is_ascii_hexdigit() && !b.is_ascii_uppercase()) {
            return None;
        }
        let set = row["set"].as_object()?.iter().map(|(name, value)| (name.clone(), value.clone())).collect();
        Some(Self { key, graph: row["graph"].as_str()?.to_owned(), set })
    }
}

/// Every combination of the values of several inputs, the last one varying fastest. None if an input has no values.
pub fn combinations(axes: &[(String, Vec<Json>)]) -> impl Iterator<Item = BTreeMap<String, Json>> {
    let count = axes.iter().fold(1_usize, |n, (_, values)| n.saturating_mul(values.len()));
    (0..count).map(|i| {
        let (mut set, mut rest) = (BTreeMap::new(), i);
        for (name, values) in axes.iter().rev() {
            set.insert(name.clone(), values[rest % values.len()].clone());
            rest /= values.len();
        }
        set
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_row_is_read_back_and_what_is_none_is_refused() {
        let row = Row::new("g.tenon.json", 7, BTreeMap::from([("a".into(), json!(1))]));
        let line = row.to_line();
        assert_eq!(Row::from_line(&line), Some(row.clone()));
        assert!(row.is_of(7) && !row.is_of(8));
        for bad in ["7", "{}", &line.replace("\"key\":\"", "\"key\":\"../"), &line.replace("set", "sets"), &line[1..]] {
            assert_eq!(Row::from_line(bad), None, "{bad}");
        }
    }

    #[test]
    fn another_build_of_a_plugin_is_another_key_and_only_for_graphs_that_use_it() {
        let with = |build| {
            let mut registry = Registry::new();
            for (name, build) in [("own", 0), ("bought", build)] {
                registry.register(crate::NodeType::new(name, 1).build(build).run(|_| Ok(()))).unwrap();
            }
            registry
        };
        let graph = |type_name: &str| {
            let mut document = Document::new();
            document.insert("n", Node::new(type_name)).unwrap();
            document
        };
        let (mut clustered, body) = (Document::new(), graph("bought"));
        clustered.clusters.insert("c".into(), Cluster::Here(Box::new(body)));
        let digest = |document: &Document, build| document_digest(document, &with(build));
        assert_ne!(digest(&graph("bought"), 1), digest(&graph("bought"), 2));
        assert_ne!(digest(&clustered, 1), digest(&clustered, 2));
        assert_eq!(digest(&graph("own"), 1), digest(&graph("own"), 2));
    }

    #[test]
    fn the_last_input_varies_fastest() {
        let axis = |name: &str, values: &[i32]| (name.to_owned(), values.iter().map(|v| json!(v)).collect());
        let all: Vec<_> = combinations(&[axis("a", &[1, 2]), axis("b", &[5, 6, 7])]).collect();
        assert_eq!(all.len(), 6);
        assert_eq!(
            (&all[0]["a"], &all[0]["b"], &all[1]["a"], &all[1]["b"]),
            (&json!(1), &json!(5), &json!(1), &json!(6))
        );
        assert_eq!(combinations(&[axis("a", &[1]), axis("b", &[])]).count(), 0);
        assert_eq!(combinations(&[]).count(), 1, "the graph as it stands");
    }
}
