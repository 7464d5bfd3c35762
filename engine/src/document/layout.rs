//! Where nodes stand on a canvas: the sibling file `*.layout.json`. It never changes what a graph means.

use super::cluster::Cluster;
use super::load::{check_foreign, object_of};
use super::model::Document;
use crate::diagnostic::Diagnostic;
use crate::value::Json;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Where nodes stand, by id.
type Positions = BTreeMap<String, [f64; 2]>;

/// Positions of nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Layout {
    /// By id; only of nodes that the document has.
    pub positions: Positions,
}

impl Document {
    /// Where a node stands: x to the right and y down, in points of the canvas.
    #[must_use]
    pub fn position(&self, node: &str) -> Option<[f64; 2]> {
        self.layout.positions.get(node).copied()
    }

    /// The text of the layout file: nodes by id, one per line, those of clusters apart. O(n).
    #[must_use]
    pub fn layout_to_string(&self) -> String {
        let mut text = String::from("{\n");
        let mut first = true;
        for (name, body) in self.bodies().filter(|(_, body)| !body.layout.positions.is_empty()) {
            let before = if first { "  \"clusters\": {\n    " } else { ",\n    " };
            let _ = write!(text, "{before}{}: ", Json::from(name));
            write_positions(&mut text, &body.layout.positions, 4);
            first = false;
        }
        if !first {
            text.push_str("\n  },\n");
        }
        text.push_str("  \"format\": \"tenon-layout\",\n  \"positions\": ");
        write_positions(&mut text, &self.layout.positions, 2);
        text.push_str(",\n  \"version\": 1\n}\n");
        text
    }

    /// The clusters that stand in this file.
    fn bodies(&self) -> impl Iterator<Item = (&str, &Self)> {
        self.clusters.iter().filter_map(|(name, cluster)| match cluster {
            Cluster::Here(body) => Some((name.as_str(), &**body)),
            Cluster::File(_) => None,
        })
    }

    /// Takes positions from a layout file in place of all there were. Nodes that the document does not have are left out: the
    /// graph file may have been edited since.
    ///
    /// # Errors
    /// If it is no layout file; then nothing has changed.
    pub fn read_layout(&mut self, bytes: &[u8]) -> Result<(), Diagnostic> {
        let wrong = |why: String| Diagnostic::error("bad-layout", why);
        let text = std::str::from_utf8(bytes).map_err(|_| wrong("the layout file is not UTF-8 text".into()))?;
        check_foreign(text, 0).map_err(|d| wrong(d.message))?;
        let file = object_of(text).ok_or_else(|| wrong("the layout file is no object".into()))?;
        if file.get("format").and_then(Json::as_str) != Some("tenon-layout") || file.get("version") != Some(&1.into()) {
            return Err(wrong("\"format\": \"tenon-layout\", \"version\": 1 is missing".into()));
        }
        let positions = self.known_positions(file.get("positions"))?;
        let inside = file.get("clusters").and_then(Json::as_object);
        let inside: Vec<(String, Positions)> = self
            .bodies()
            .map(|(name, body)| Ok((name.to_owned(), body.known_positions(inside.and_then(|c| c.get(name)))?)))
            .collect::<Result<_, Diagnostic>>()?;
        for (name, positions) in inside {
            if let Some(Cluster::Here(body)) = self.clusters.get_mut(&name) {
                body.layout.positions = positions;
            }
        }
        self.layout.positions = positions;
        Ok(())
    }

    /// The positions of nodes that there are.
    fn known_positions(&self, said: Option<&Json>) -> Result<Positions, Diagnostic> {
        let wrong = |why: String| Diagnostic::error("bad-layout", why);
        let mut positions = BTreeMap::new();
        for (id, value) in said.and_then(Json::as_object).into_iter().flatten() {
            let Some([Some(x), Some(y)]) = value.as_array().map(|v| [0, 1].map(|i| v.get(i).and_then(Json::as_f64)))
            else {
                return Err(wrong(format!("the position of \"{id}\" is not a pair of numbers")));
            };
            if self.nodes.contains_key(id) {
                positions.insert(id.clone(), [x, y]);
            }
        }
        Ok(positions)
    }
}

/// One per line, in braces that stand at so many spaces.
fn write_positions(text: &mut String, positions: &Positions, indent: usize) {
    text.push('{');
    for (i, (id, [x, y])) in positions.iter().enumerate() {
        let comma = if i > 0 { "," } else { "" };
        let (id, x, y) = (Json::from(id.as_str()), Json::from(*x), Json::from(*y));
        let _ = write!(text, "{comma}\n{:width$}{id}: [{x}, {y}]", "", width = indent + 2);
    }
    if !positions.is_empty() {
        let _ = write!(text, "\n{:indent$}", "");
    }
    text.push('}');
}
