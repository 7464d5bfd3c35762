//! Where nodes stand on a canvas: the sibling file `*.layout.json`. It never changes what a graph means.

use super::load::{check_foreign, object_of};
use super::model::Document;
use crate::diagnostic::Diagnostic;
use crate::value::Json;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Positions of nodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Layout {
    /// By id; only of nodes that the document has.
    pub positions: BTreeMap<String, [f64; 2]>,
}

impl Document {
    /// Where a node stands: x to the right and y down, in points of the canvas.
    #[must_use]
    pub fn position(&self, node: &str) -> Option<[f64; 2]> {
        self.layout.positions.get(node).copied()
    }

    /// The text of the layout file: nodes by id, one per line. O(n).
    #[must_use]
    pub fn layout_to_string(&self) -> String {
        let mut text = String::from("{\n  \"format\": \"tenon-layout\",\n  \"positions\": {");
        for (i, (id, [x, y])) in self.layout.positions.iter().enumerate() {
            let comma = if i > 0 { "," } else { "" };
            let (id, x, y) = (Json::from(id.as_str()), Json::from(*x), Json::from(*y));
            let _ = write!(text, "{comma}\n    {id}: [{x}, {y}]");
        }
        let end = if self.layout.positions.is_empty() { "" } else { "\n  " };
        let _ = write!(text, "{end}}},\n  \"version\": 1\n}}\n");
        text
    }

    /// Takes positions from a layout file in place of all there were. Nodes that the document does not have are left out: the
    /// graph file may have been edited since.
    ///
    /// # Errors
    /// If it is no layout file; then nothing has changed.
    pub fn read_layout(&mut self, bytes: &[u8]) -> Result<(), Diagnostic> {
        let wrong = |why: String| Diagnostic::error("bad-layout", why);
        let text = std::str::from_utf8(bytes).map_err(|_| wrong("the layout file is not UTF-8 text".into()))?;
        check_foreign(text).map_err(|d| wrong(d.message))?;
        let file = object_of(text).ok_or_else(|| wrong("the layout file is no object".into()))?;
        if file.get("format").and_then(Json::as_str) != Some("tenon-layout") || file.get("version") != Some(&1.into()) {
            return Err(wrong("\"format\": \"tenon-layout\", \"version\": 1 is missing".into()));
        }
        let mut positions = BTreeMap::new();
        for (id, value) in file.get("positions").and_then(Json::as_object).into_iter().flatten() {
            let Some([Some(x), Some(y)]) = value.as_array().map(|v| [0, 1].map(|i| v.get(i).and_then(Json::as_f64)))
            else {
                return Err(wrong(format!("the position of \"{id}\" is not a pair of numbers")));
            };
            if self.nodes.contains_key(id) {
                positions.insert(id.clone(), [x, y]);
            }
        }
        self.layout.positions = positions;
        Ok(())
    }
}
