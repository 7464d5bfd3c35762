//! What node types there are, in the words that views need: ports with units, ranges and defaults, which wires fit, and
//! the search of the finder.

use std::collections::{BTreeMap, HashSet};
use std::sync::Arc;
use tenon_engine::{Access, Document, Json, Name, Node, NodeType, Registry};

/// One input or output.
#[derive(Clone, Debug)]
pub struct PortInfo {
    /// Its name.
    pub name: String,
    /// Name of its item type; `any` takes and gives all.
    pub type_name: String,
    /// How the node sees what arrives.
    pub access: Access,
    /// Sign of its unit, or empty.
    pub unit: String,
    /// Smallest and largest number accepted.
    pub range: Option<(f64, f64)>,
    /// A person has set the range.
    pub chosen: bool,
    /// By how much it slides; 0: nobody has said.
    pub step: f64,
    /// The literal used without wire and parameter.
    pub default: Option<Json>,
    /// The texts accepted; empty: all.
    pub choices: Vec<String>,
    /// The node runs without it.
    pub optional: bool,
    /// The text names a file.
    pub file: bool,
    /// What it means.
    pub doc: String,
}

/// A node type.
#[derive(Clone, Debug)]
pub struct TypeInfo {
    /// Name in the file.
    pub type_name: String,
    /// Its version.
    pub version: u32,
    /// Name for people.
    pub title: String,
    /// Where a palette shows it.
    pub category: String,
    /// What it does.
    pub doc: String,
    /// Other words to find it by.
    pub keywords: Vec<String>,
    /// Its inputs.
    pub inputs: Vec<PortInfo>,
    /// Its outputs.
    pub outputs: Vec<PortInfo>,
    /// False for a type that nobody here knows.
    pub known: bool,
}

/// All node types, and what turns into what on wires.
#[derive(Debug, Default)]
pub struct Catalog {
    types: BTreeMap<String, Arc<TypeInfo>>,
    /// The clusters of the document, by the type of their instances.
    clusters: BTreeMap<String, Arc<TypeInfo>>,
    conversions: HashSet<(String, String)>,
}

fn text(json: &Json, key: &str) -> String {
    json.get(key).and_then(Json::as_str).unwrap_or_default().to_owned()
}

fn texts(json: &Json, key: &str) -> Vec<String> {
    let list = json.get(key).and_then(Json::as_array);
    list.into_iter().flatten().filter_map(Json::as_str).map(str::to_owned).collect()
}

fn flag(json: &Json, key: &str) -> bool {
    json.get(key).and_then(Json::as_bool).unwrap_or(false)
}

fn port(port: &tenon_engine::Port) -> PortInfo {
    let json = port.describe();
    let number = |key: &str| json.get(key).and_then(Json::as_f64);
    PortInfo {
        name: port.name().to_owned(),
        type_name: port.type_name().to_owned(),
        access: port.access(),
        unit: text(&json, "unit"),
        range: number("min").zip(number("max")),
        chosen: false,
        step: 0.0,
        default: json.get("default").cloned(),
        choices: texts(&json, "choices"),
        optional: flag(&json, "optional"),
        file: flag(&json, "file"),
        doc: text(&json, "doc"),
    }
}

fn info(node_type: &NodeType) -> TypeInfo {
    let json = node_type.describe();
    TypeInfo {
        type_name: node_type.type_name().to_owned(),
        version: node_type.version(),
        title: node_type.title().to_owned(),
        category: node_type.category_name().to_owned(),
        doc: text(&json, "doc"),
        keywords: texts(&json, "keywords"),
        inputs: node_type.inputs().iter().map(port).collect(),
        outputs: node_type.outputs().iter().map(port).collect(),
        known: true,
    }
}

impl Catalog {
    /// Everything that a registry knows.
    #[must_use]
    pub fn new(registry: &Registry) -> Self {
        Self {
            clusters: BTreeMap::new(),
            types: registry.iter().map(|t| (t.type_name().to_owned(), Arc::new(info(t)))).collect(),
            conversions: registry.conversions().iter().map(|c| (c.from.to_owned(), c.to.to_owned())).collect(),
        }
    }

    /// The node type of that name.
    #[must_use]
    pub fn get(&self, type_name: &str) -> Option<&Arc<TypeInfo>> {
        self.types.get(type_name).or_else(|| self.clusters.get(type_name))
    }

    /// Takes the clusters of a document in place of those there were. O(clusters after expansion).
    pub fn take_clusters(&mut self, document: &Document, registry: &Registry) {
        let types = document.clusters.keys().filter_map(|name| document.cluster_type(name, registry).ok());
        self.clusters = types.map(|t| (t.type_name().to_owned(), Arc::new(info(&t)))).collect();
    }

    /// The type of a node; of one that nobody knows, the inputs that the file speaks of.
    #[must_use]
    pub fn of(&self, node: &Node) -> Arc<TypeInfo> {
        if let Some(known) = self.get(&node.type_name) {
            return known.clone();
        }
        let mut names: Vec<&Name> = node.inputs.keys().chain(node.params.keys()).collect();
        names.sort();
        names.dedup();
        Arc::new(TypeInfo {
            type_name: node.type_name.to_string(),
            version: node.version,
            title: node.type_name.to_string(),
            category: String::new(),
            doc: format!("The node type \"{}\" is not known here. The node is kept as it is.", node.type_name),
            keywords: Vec::new(),
            inputs: names.into_iter().map(|n| Self::unknown_port(n)).collect(),
            outputs: Vec::new(),
            known: false,
        })
    }

    /// A port that only a wire speaks of.
    #[must_use]
    pub fn unknown_port(name: &str) -> PortInfo {
        PortInfo {
            name: name.to_owned(),
            type_name: "any".to_owned(),
            access: Access::Tree,
            unit: String::new(),
            range: None,
            chosen: false,
            step: 0.0,
            default: None,
            choices: Vec::new(),
            optional: true,
            file: false,
            doc: "Not known here.".to_owned(),
        }
    }

    /// Whether a wire may go from an output of one type to an input of another.
    #[must_use]
    pub fn fits(&self, from: &str, to: &str) -> bool {
        from == to || from == "any" || to == "any" || self.conversions.contains(&(from.to_owned(), to.to_owned()))
    }

    /// The port that a wire does best with among those that it fits: of its own type rather than by conversion, and that rather
    /// than of any type; one that waits for something rather than one that has it already. `waits` says so of a port by
    /// its number. O(ports).
    #[must_use]
    pub fn best(&self, wire: &str, output: bool, ports: &[PortInfo], waits: impl Fn(usize) -> bool) -> Option<usize> {
        let fits = |p: &PortInfo| if output { self.fits(wire, &p.type_name) } else { self.fits(&p.type_name, wire) };
        let far = |p: &PortInfo| match (p.type_name == wire, p.type_name == "any" || wire == "any") {
            (true, _) => 0,
            (_, false) => 1,
            (_, true) => 2,
        };
        let needed = |p: &PortInfo| p.default.is_none() && !p.optional;
        let fitting = ports.iter().enumerate().filter(|(_, p)| fits(p));
        fitting.min_by_key(|(i, p)| (!waits(*i), far(p), !needed(p), *i)).map(|(i, _)| i)
    }

    /// Node types by how well they fit what was typed, the best first; all of them for an empty text. `like` keeps only
    /// those that pass. O(types).
    #[must_use]
    pub fn find(&self, typed: &str, like: impl Fn(&TypeInfo) -> bool) -> Vec<Arc<TypeInfo>> {
        let typed = typed.trim().to_lowercase();
        let mut found: Vec<(u32, &Arc<TypeInfo>)> = self
            .types
            .values()
            .chain(self.clusters.values())
            .filter(|t| like(t))
            .filter_map(|t| rank(t, &typed).map(|r| (r, t)))
            .collect();
        found.sort_by(|a, b| (a.0, &a.1.category, &a.1.title).cmp(&(b.0, &b.1.category, &b.1.title)));
        found.into_iter().map(|(_, t)| t.clone()).collect()
    }
}

/// How far a type is from what was typed; lower is better, `None` if it has nothing of it. As one, else word by word: then
/// each of them must be somewhere.
fn rank(t: &TypeInfo, typed: &str) -> Option<u32> {
    if typed.is_empty() {
        return Some(0);
    }
    let whole = rank_word(t, typed);
    let words = || typed.split_whitespace().map(|word| rank_word(t, word)).sum::<Option<u32>>();
    whole.or_else(|| words().map(|sum| LAST + sum))
}

/// What is farther than any rank of one word.
const LAST: u32 = 10;

fn rank_word(t: &TypeInfo, typed: &str) -> Option<u32> {
    let (title, name, category) = (t.title.to_lowercase(), t.type_name.to_lowercase(), t.category.to_lowercase());
    let keywords: Vec<String> = t.keywords.iter().map(|k| k.to_lowercase()).collect();
    if title == typed || name == typed {
        return Some(0);
    }
    if title.starts_with(typed) || name.starts_with(typed) {
        return Some(1);
    }
    if title.contains(typed) || name.contains(typed) {
        return Some(2);
    }
    if keywords.iter().any(|k| k.starts_with(typed)) {
        return Some(3);
    }
    if keywords.iter().any(|k| k.contains(typed)) {
        return Some(4);
    }
    if category.contains(typed) {
        return Some(5);
    }
    let within = |text: &str| letters_in_order(typed, text);
    if within(&title) || within(&name) {
        return Some(6);
    }
    if typed.chars().count() > 2 && (keywords.iter().any(|k| within(k)) || within(&category)) {
        return Some(7);
    }
    t.doc.to_lowercase().contains(typed).then_some(8)
}

/// Whether a text has all letters that were typed, in their order, as one types in a hurry.
#[must_use]
pub fn letters_in_order(typed: &str, text: &str) -> bool {
    let mut letters = text.chars();
    typed.chars().filter(|c| !c.is_whitespace()).all(|c| letters.any(|l| l == c))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn catalog() -> Catalog {
        Catalog::new(&tenon_nodes::registry())
    }

    #[test]
    fn the_finder_knows_names_keywords_and_letters_in_order() {
        let first = |typed| catalog().find(typed, |_| true).first().map(|t| t.type_name.clone());
        assert_eq!(first("thicken").as_deref(), Some("thicken"));
        assert_eq!(first("takagi").as_deref(), Some("ifs_curve"));
        assert_eq!(first("itcrv").as_deref(), Some("ifs_curve"));
        assert_eq!(first("dxf write").as_deref(), Some("write_dxf"), "words in any order");
        assert_eq!(first("number slider").as_deref(), Some("slider"), "by keyword");
        assert!(catalog().find("no such thing", |_| true).is_empty());
        let all = catalog().find("boards", |_| true);
        assert!(all.iter().any(|t| t.type_name == "pack"), "by category or doc");
    }

    #[test]
    fn a_wire_takes_the_port_that_suits_it_best() {
        let c = catalog();
        let port = |name: &str, type_name: &str, needed: bool| PortInfo {
            type_name: type_name.into(),
            optional: !needed,
            ..Catalog::unknown_port(name)
        };
        let ports = [port("any", "any", true), port("count", "integer", true), port("size", "number", false)];
        assert_eq!(c.best("number", true, &ports, |_| true), Some(2), "its own type first");
        assert_eq!(c.best("integer", true, &ports, |_| true), Some(1));
        assert_eq!(c.best("integer", true, &ports, |i| i != 1), Some(2), "one that waits, by conversion");
        assert_eq!(c.best("curve", true, &ports, |_| true), Some(0));
        assert_eq!(c.best("curve", true, &ports[1..], |_| true), None);
    }

    #[test]
    fn wires_fit_equal_any_and_converted_types() {
        let c = catalog();
        assert!(c.fits("curve", "curve") && c.fits("any", "curve") && c.fits("integer", "number"));
        assert!(!c.fits("curve", "mesh") && !c.fits("number", "integer"));
    }
}
