//! Where nodes stand on a canvas and how they look there: the sibling file `*.layout.json`. It never changes what a graph
//! means.

use super::cluster::Cluster;
use super::format::json_text;
use super::load::{check_foreign, object_of};
use super::model::Document;
use crate::diagnostic::Diagnostic;
use crate::value::Json;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Where nodes stand, by id.
type Positions = BTreeMap<String, [f64; 2]>;

/// How nodes look that do not look as they would by themselves, by id.
type Looks = BTreeMap<String, Look>;

/// How a node looks. The default is how it looks by itself, and is not written.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Look {
    /// Whether views show what it makes; none: as they find right.
    pub shown: Option<bool>,
    /// It shows all its inputs.
    pub open: bool,
}

/// Positions and looks of nodes, and what views keep beside them.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Layout {
    /// By id; only of nodes that the document has.
    pub positions: Positions,
    /// By id; only of nodes that the document has, and none that is the default.
    pub looks: Looks,
    /// What views keep besides, by key; of the whole graph only.
    pub extra: BTreeMap<String, Json>,
}

/// Keys of the file that have a meaning here, in order.
pub(crate) const LAYOUT_KEYS: &[&str] = &["clusters", "format", "looks", "looks_inside", "positions", "version"];

impl Document {
    /// Where a node stands: x to the right and y down, in points of the canvas.
    #[must_use]
    pub fn position(&self, node: &str) -> Option<[f64; 2]> {
        self.layout.positions.get(node).copied()
    }

    /// How a node looks on a canvas.
    #[must_use]
    pub fn look(&self, node: &str) -> Look {
        self.layout.looks.get(node).copied().unwrap_or_default()
    }

    /// What a view keeps in the layout file under a key of its own ([`Table::Layout`](super::Table::Layout)).
    #[must_use]
    pub fn layout_entry(&self, key: &str) -> Option<&Json> {
        self.layout.extra.get(key)
    }

    /// The text of the layout file: nodes by id, one per line, those of clusters apart; keys in order. O(n).
    #[must_use]
    pub fn layout_to_string(&self) -> String {
        let mut positions = String::new();
        write_positions(&mut positions, &self.layout.positions, 2);
        let mut keys: BTreeMap<&str, String> = BTreeMap::new();
        keys.insert("format", "\"tenon-layout\"".into());
        keys.insert("positions", positions);
        keys.insert("version", "1".into());
        keys.extend(self.looks_texts());
        let mut clusters = String::new();
        for (name, body) in self.bodies().filter(|(_, body)| !body.layout.positions.is_empty()) {
            let before = if clusters.is_empty() { "{\n    " } else { ",\n    " };
            let _ = write!(clusters, "{before}{}: ", Json::from(name));
            write_positions(&mut clusters, &body.layout.positions, 4);
        }
        if !clusters.is_empty() {
            keys.insert("clusters", clusters + "\n  }");
        }
        keys.extend(self.layout.extra.iter().map(|(key, value)| (key.as_str(), json_text(value))));
        let lines: Vec<String> = keys.iter().map(|(key, text)| format!("  {}: {text}", Json::from(*key))).collect();
        format!("{{\n{}\n}}\n", lines.join(",\n"))
    }

    /// Ids by what is said of them, those of clusters apart; nothing if nothing is said.
    fn looks_texts(&self) -> Vec<(&'static str, String)> {
        let inside: Json = self
            .bodies()
            .filter(|(_, body)| !body.layout.looks.is_empty())
            .map(|(name, body)| (name.to_owned(), looks_json(&body.layout.looks)))
            .collect();
        let all = [("looks", looks_json(&self.layout.looks)), ("looks_inside", inside)];
        let said = |(_, value): &(&str, Json)| value.as_object().is_some_and(|o| !o.is_empty());
        all.into_iter().filter(said).map(|(key, value)| (key, json_text(&value))).collect()
    }

    /// The clusters that stand in this file.
    fn bodies(&self) -> impl Iterator<Item = (&str, &Self)> {
        self.clusters.iter().filter_map(|(name, cluster)| match cluster {
            Cluster::Here(body) => Some((name.as_str(), &**body)),
            Cluster::File(_) => None,
        })
    }

    /// Takes what a layout file says in place of all there was. Nodes that the document does not have are left out: the
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
        let said = |positions: &str, looks: &str, name: &str| {
            [positions, looks].map(|key| file.get(key).and_then(Json::as_object)?.get(name))
        };
        let mut own = self.known(file.get("positions"), file.get("looks"))?;
        let extra = file.iter().filter(|(key, _)| !LAYOUT_KEYS.contains(&key.as_str()));
        own.extra = extra.map(|(key, value)| (key.clone(), value.clone())).collect();
        let inside: Vec<(String, Layout)> = self
            .bodies()
            .map(|(name, body)| {
                let [positions, looks] = said("clusters", "looks_inside", name);
                Ok((name.to_owned(), body.known(positions, looks)?))
            })
            .collect::<Result<_, Diagnostic>>()?;
        for (name, layout) in inside {
            if let Some(Cluster::Here(body)) = self.clusters.get_mut(&name) {
                body.layout = layout;
            }
        }
        self.layout = own;
        Ok(())
    }

    /// What is said of nodes that there are.
    fn known(&self, positions: Option<&Json>, looks: Option<&Json>) -> Result<Layout, Diagnostic> {
        let (positions, looks) = (self.known_positions(positions)?, self.known_looks(looks));
        Ok(Layout { positions, looks, extra: BTreeMap::new() })
    }

    /// The looks of nodes that there are. What is not understood is left out: it is only looks.
    fn known_looks(&self, said: Option<&Json>) -> Looks {
        let mut looks = Looks::new();
        for (key, change) in LOOKS {
            let ids = said.and_then(|l| l.get(key)).and_then(Json::as_array);
            for id in ids.into_iter().flatten().filter_map(Json::as_str).filter(|id| self.nodes.contains_key(*id)) {
                change(looks.entry(id.to_owned()).or_default());
            }
        }
        looks
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

/// Puts in a look what being in a list says.
type Say = fn(&mut Look);

/// The lists of the file, and what being in one of them says of a node.
const LOOKS: [(&str, Say); 3] = [
    ("hidden", |look| look.shown = Some(false)),
    ("open", |look| look.open = true),
    ("shown", |look| look.shown = Some(true)),
];

fn looks_json(looks: &Looks) -> Json {
    let is_in = |key: &str, look: &Look| match key {
        "hidden" => look.shown == Some(false),
        "shown" => look.shown == Some(true),
        _ => look.open,
    };
    let list = |key: &str| -> Vec<Json> {
        looks.iter().filter(|(_, look)| is_in(key, look)).map(|(id, _)| Json::from(id.as_str())).collect()
    };
    let lists = LOOKS.map(|(key, _)| (key.to_owned(), list(key)));
    lists.into_iter().filter(|(_, list)| !list.is_empty()).map(|(key, list)| (key, Json::from(list))).collect()
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
