//! What can be read of a graph that cannot be read whole. It is opened without the file's name, so that the file stays as it
//! is.

use super::Model;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};
use tenon_engine::{Diagnostic, Document};
use tenon_nodes::host::graph::{self, GraphError};

/// What was found in a file.
#[derive(Debug)]
pub struct Salvaged {
    /// The graph of what could be read.
    pub document: Document,
    /// Nodes that could be read.
    pub kept: usize,
    /// Nodes that could not, by id, with the reason.
    pub lost: Vec<(String, String)>,
}

/// What of a graph that is open could not be read from its file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Lost {
    /// The file.
    pub file: PathBuf,
    /// Nodes that could be read.
    pub kept: usize,
    /// Nodes that could not, by id, with the reason.
    pub nodes: Vec<(String, String)>,
    /// What is wrong with the file as a whole.
    pub why: String,
}

impl Lost {
    /// The line that is told of it.
    #[must_use]
    pub fn words(&self) -> String {
        let lost = match self.nodes.as_slice() {
            [] => String::new(),
            all => {
                let ids: Vec<&str> = all.iter().map(|(id, _)| id.as_str()).take(12).collect();
                let more = if all.len() > ids.len() { " …" } else { "" };
                format!(", not {} others: {}{more}", all.len(), ids.join(", "))
            }
        };
        format!("{} nodes of {} could be read{lost}", self.kept, self.file.display())
    }
}

/// A text of JSON that ends too early or goes wrong somewhere, as far as whole values go. O(text).
fn closed(text: &str) -> String {
    let (mut stack, mut quoted, mut escaped) = (Vec::new(), false, false);
    // The last place where every open object or array could end, and what closes them there.
    let mut good: Option<(usize, Vec<char>)> = None;
    for (i, c) in text.char_indices() {
        if quoted {
            quoted = escaped || c != '"';
            escaped = c == '\\' && !escaped;
            continue;
        }
        match c {
            '"' => quoted = true,
            '{' => stack.push('}'),
            '[' => stack.push(']'),
            '}' | ']' => {
                if stack.pop() != Some(c) {
                    break;
                }
                good = Some((i + 1, stack.clone()));
                if stack.len() > 64 || stack.is_empty() {
                    break;
                }
            }
            ',' => good = Some((i, stack.clone())),
            _ => {}
        }
    }
    let Some((end, open)) = good else { return String::new() };
    let mut whole = text.get(..end).unwrap_or_default().to_owned();
    whole.extend(open.iter().rev());
    whole
}

/// The longest start of a text that can be read as JSON once it is closed.
fn parse(text: &str) -> Option<Value> {
    let mut end = text.len();
    // Every failure names its place; what stands before it is tried next.
    for _ in 0..64 {
        let part = closed(text.get(..end)?);
        match serde_json::from_str::<Value>(&part) {
            Ok(value) => return Some(value),
            Err(e) => {
                let line_start: usize = part.split_inclusive('\n').take(e.line().saturating_sub(1)).map(str::len).sum();
                let mut at = (line_start + e.column()).saturating_sub(1).min(end.saturating_sub(1));
                while at > 0 && !text.is_char_boundary(at) {
                    at -= 1;
                }
                // Up to the last comma before it.
                end = text.get(..at)?.rfind(',')?;
            }
        }
    }
    None
}

fn graph_of(nodes: &Map<String, Value>, others: &Map<String, Value>) -> Value {
    let mut graph = others.clone();
    graph.insert("format".into(), json!("tenon"));
    graph.insert("version".into(), json!(1));
    graph.insert("nodes".into(), Value::Object(nodes.clone()));
    Value::Object(graph)
}

fn read(graph: &Value) -> Result<Document, String> {
    let wrong = |all: Vec<Diagnostic>| all.into_iter().next().map_or_else(String::new, |d| d.message);
    Document::from_slice(graph.to_string().as_bytes()).map_err(wrong)
}

/// What can be read of a graph's text; `None` if not a single node can. O(nodes · text) at worst.
#[must_use]
pub fn salvage(text: &str) -> Option<Salvaged> {
    let whole = parse(text)?;
    let file = whole.as_object()?;
    let (mut kept, mut lost) = (Map::new(), Vec::new());
    for (id, node) in file.get("nodes")?.as_object()? {
        let alone: Map<String, Value> = [(id.clone(), node.clone())].into_iter().collect();
        match read(&graph_of(&alone, &Map::new())) {
            Ok(_) => drop(kept.insert(id.clone(), node.clone())),
            Err(why) => lost.push((id.clone(), why)),
        }
    }
    if kept.is_empty() {
        return None;
    }
    // Of the rest, every part that the graph can be read with.
    let mut others = Map::new();
    for (key, value) in file.iter().filter(|(k, _)| !matches!(k.as_str(), "format" | "version" | "nodes")) {
        others.insert(key.clone(), value.clone());
        if read(&graph_of(&kept, &others)).is_err() {
            others.remove(key);
        }
    }
    let document = read(&graph_of(&kept, &others)).ok()?;
    Some(Salvaged { document, kept: kept.len(), lost })
}

impl Model {
    /// Opens what can be read of a graph that cannot be read whole, without its name; false if there is nothing.
    pub fn salvage(&mut self, path: &Path, why: &GraphError) -> bool {
        let GraphError::NotAGraph { file, .. } = why else { return false };
        let bytes = graph::read(file).unwrap_or_default();
        let Some(found) = salvage(&String::from_utf8_lossy(&bytes)) else { return false };
        self.take(found.document, None);
        // It is no file's content, so that it counts as unsaved.
        self.saved = Default::default();
        let why = why.diagnostic().message;
        let lost = Lost { file: path.to_owned(), kept: found.kept, nodes: found.lost, why };
        let hint = format!("the file stays as it is; save under another name. {}", lost.why);
        self.message = Some(Diagnostic::error("salvaged", lost.words()).hint(hint));
        self.lost = Some(lost);
        true
    }

    /// What of the graph could not be read from its file, until it is put away or another graph is opened.
    #[must_use]
    pub fn lost(&self) -> Option<&Lost> {
        self.lost.as_ref()
    }

    /// Puts away what is told of it.
    pub fn put_lost_away(&mut self) {
        self.lost = None;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = r#"{ "format": "tenon", "version": 1, "nodes": {
        "a": { "type": "number", "v": 1, "params": { "value": 3 } },
        "b": { "type": "point", "v": 1, "inputs": { "x": { "from": ["a.value"] } } }
    } }"#;

    #[test]
    fn a_file_that_ends_too_early_gives_what_is_whole() {
        let most = GOOD.len();
        let mut best = 0;
        for end in (0..most).filter(|e| GOOD.is_char_boundary(*e)) {
            if let Some(found) = salvage(&GOOD[..end]) {
                assert!(found.kept >= best, "more text gives no fewer nodes");
                best = found.kept;
            }
        }
        assert_eq!(best, 2);
        assert!(salvage("{").is_none() && salvage("no graph").is_none() && salvage("").is_none());
    }

    #[test]
    fn nodes_that_make_no_sense_are_named_and_left_out() {
        let text = GOOD.replace("\"type\": \"number\"", "\"type\": 7");
        let found = salvage(&text).unwrap();
        assert_eq!((found.kept, found.lost.len(), found.lost[0].0.as_str()), (1, 1, "a"));
        assert!(!found.lost[0].1.is_empty());
        assert!(found.document.nodes().contains_key("b"));
    }
}
