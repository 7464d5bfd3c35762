//! Writing the file in its one canonical form: keys sorted, two spaces, one node per block, shortest floats that read
//! back the same, a newline at the end. What nobody here understands is written as it was read.

use super::cluster::{Cluster, Link};
use super::model::{Document, InterfaceInput, InterfaceOutput, Node, NodeState, Wires};
use crate::registry::Registry;
use crate::value::Json;
use std::collections::BTreeMap;
use std::fmt::Write;

/// A value inside a node stands on one line if it ends before this column.
const LINE: usize = 110;

/// A block under construction: sorted keys, values already written.
type Block = BTreeMap<String, String>;

impl Document {
    /// The file's text. O(n log n). Nodes of types that nobody knows lose their own spacing here; to keep them byte for byte
    /// use [`Document::to_string_canonical_for`].
    #[must_use]
    pub fn to_string_canonical(&self) -> String {
        self.write(&|_| true)
    }

    /// The file's text; nodes whose type `registry` does not know are kept byte for byte. O(n log n).
    #[must_use]
    pub fn to_string_canonical_for(&self, registry: &Registry) -> String {
        self.write(&|node| node.cluster().is_some() || registry.get(&node.type_name).is_some())
    }

    fn write(&self, known: &dyn Fn(&Node) -> bool) -> String {
        let mut top = self.content(0, known);
        top.insert("format".into(), "\"tenon\"".into());
        top.insert("version".into(), "1".into());
        top.insert("units".into(), "\"mm\"".into());
        if !self.clusters.is_empty() {
            let clusters = self.clusters.iter().map(|(name, cluster)| (name.clone(), cluster_text(cluster, known)));
            top.insert("clusters".into(), block_text(&clusters.collect(), 1));
        }
        let mut text = block_text(&top, 0);
        text.push('\n');
        text
    }

    /// What the top of a file and a cluster have in common; `depth` is that of the braces around it.
    fn content(&self, depth: usize, known: &dyn Fn(&Node) -> bool) -> Block {
        let mut top = Block::new();
        for (key, value) in &self.extra {
            top.insert(key.clone(), value_text(value, depth + 1));
        }
        if !self.requires.is_empty() {
            top.insert("requires".into(), map_text(&self.requires, depth + 1));
        }
        if !self.groups.is_empty() {
            top.insert("groups".into(), map_text(&self.groups, depth + 1));
        }
        if let Some(x) = &self.foreign {
            top.insert("x".into(), x.to_string());
        }
        if !(self.inputs.is_empty() && self.outputs.is_empty() && self.interface_extra.is_empty()) {
            let mut interface: Block =
                self.interface_extra.iter().map(|(k, v)| (k.clone(), value_text(v, depth + 2))).collect();
            let inputs: Block = self.inputs.iter().map(|(k, v)| (k.clone(), input_text(v, depth + 3))).collect();
            let outputs: Block = self.outputs.iter().map(|(k, v)| (k.clone(), output_text(v, depth + 3))).collect();
            if !inputs.is_empty() {
                interface.insert("inputs".into(), block_text(&inputs, depth + 2));
            }
            if !outputs.is_empty() {
                interface.insert("outputs".into(), block_text(&outputs, depth + 2));
            }
            top.insert("interface".into(), block_text(&interface, depth + 1));
        }
        let nodes = self.nodes.iter().map(|(id, node)| match &node.more.raw.0 {
            Some(raw) if !known(node) => (id.clone(), raw.to_string()),
            _ => (id.clone(), node_text(node, depth)),
        });
        top.insert("nodes".into(), block_text(&nodes.collect(), depth + 1));
        top
    }
}

fn cluster_text(cluster: &Cluster, known: &dyn Fn(&Node) -> bool) -> String {
    match cluster {
        Cluster::Here(body) => block_text(&body.content(2, known), 2),
        Cluster::File(link) => link_text(link),
    }
}

pub(crate) fn link_text(link: &Link) -> String {
    let mut map = link.extra.clone();
    map.insert("file".into(), Json::from(link.file.as_str()));
    if let Some(version) = link.version {
        map.insert("version".into(), Json::from(version));
    }
    if let Some(digest) = &link.digest {
        map.insert("digest".into(), Json::from(digest.as_str()));
    }
    map_text(&map, 2)
}

fn quoted(text: &str) -> String {
    Json::from(text).to_string()
}

fn texts<T: AsRef<str>>(list: &[T]) -> Json {
    list.iter().map(|text| Json::from(text.as_ref())).collect()
}

pub(crate) fn input_text(input: &InterfaceInput, depth: usize) -> String {
    let mut map = input.extra.clone();
    let port = if let [one] = input.ports.as_slice() { Json::from(one.as_str()) } else { texts(&input.ports) };
    map.insert("port".into(), port);
    let mut put = |key: &str, value: Option<Json>| value.map(|v| map.insert(key.into(), v));
    put("unit", input.unit.clone().map(Json::from));
    put("min", input.min.map(Json::from));
    put("max", input.max.map(Json::from));
    put("step", input.step.map(Json::from));
    put("doc", input.doc.clone().map(Json::from));
    put("order", input.order.map(Json::from));
    map_text(&map, depth)
}

pub(crate) fn output_text(output: &InterfaceOutput, depth: usize) -> String {
    let mut map = output.extra.clone();
    map.insert("port".into(), Json::from(output.port.as_str()));
    if let Some(unit) = &output.unit {
        map.insert("unit".into(), Json::from(unit.as_str()));
    }
    if let Some(doc) = &output.doc {
        map.insert("doc".into(), Json::from(doc.as_str()));
    }
    if let Some(order) = output.order {
        map.insert("order".into(), Json::from(order));
    }
    map_text(&map, depth)
}

/// A node of the document whose braces stand at `depth`: 0, or 2 for a cluster.
pub(crate) fn node_text(node: &Node, depth: usize) -> String {
    let mut block: Block = node.more.extra.iter().map(|(k, v)| (k.clone(), value_text(v, depth + 3))).collect();
    block.insert("type".into(), quoted(&node.type_name));
    block.insert("v".into(), node.version.to_string());
    if !node.params.is_empty() {
        let params: Block =
            node.params.iter().map(|(k, v)| (k.to_string(), value_text(&v.json(), depth + 4))).collect();
        block.insert("params".into(), block_text(&params, depth + 3));
    }
    if !node.inputs.is_empty() {
        let inputs: Block = node.inputs.iter().map(|(k, v)| (k.to_string(), wires_text(v, depth + 4))).collect();
        block.insert("inputs".into(), block_text(&inputs, depth + 3));
    }
    if let Some(matching) = node.matching {
        block.insert("match".into(), quoted(matching.as_str()));
    }
    if node.state != NodeState::On {
        block.insert("state".into(), quoted(node.state.as_str()));
    }
    if let Some(note) = &node.more.note {
        block.insert("note".into(), quoted(note));
    }
    block_text(&block, depth + 2)
}

fn wires_text(wires: &Wires, depth: usize) -> String {
    let mut map = wires.more.extra.clone();
    map.insert("from".into(), texts(&wires.from));
    if !wires.more.tree.is_empty() {
        map.insert("tree".into(), wires.more.tree.iter().map(|op| Json::from(op.as_str())).collect());
    }
    if let Some(matching) = wires.more.matching {
        map.insert("match".into(), Json::from(matching.as_str()));
    }
    map_text(&map, depth)
}

/// One key per line.
fn block_text(block: &Block, depth: usize) -> String {
    if block.is_empty() {
        return "{}".into();
    }
    let mut out = String::from("{");
    for (i, (key, value)) in block.iter().enumerate() {
        let comma = if i > 0 { "," } else { "" };
        let _ = write!(out, "{comma}\n{:width$}{}: {value}", "", quoted(key), width = 2 * (depth + 1));
    }
    let _ = write!(out, "\n{:width$}}}", "", width = 2 * depth);
    out
}

fn map_text(map: &BTreeMap<String, Json>, depth: usize) -> String {
    value_text(&Json::Object(map.iter().map(|(k, v)| (k.clone(), v.clone())).collect()), depth)
}

/// A value on one line if it is short, else broken up. Loading has bounded the nesting, so recursion is safe.
fn value_text(value: &Json, depth: usize) -> String {
    let mut line = String::new();
    one_line(value, &mut line);
    if depth > 1 && 2 * depth + line.len() <= LINE || !(value.is_array() || value.is_object()) {
        return line;
    }
    let width = 2 * (depth + 1);
    let mut out = String::new();
    match value {
        Json::Array(list) if list.is_empty() => out.push_str("[]"),
        Json::Array(list) => {
            // Long lists of short things fill their lines.
            let items: Vec<String> = list.iter().map(|v| value_text(v, depth + 1)).collect();
            let short = items.iter().all(|t| t.len() <= 40 && !t.contains('\n'));
            let mut column = LINE + 1;
            for (i, text) in items.iter().enumerate() {
                out.push_str(if i == 0 { "[" } else { "," });
                if !short || column + text.len() + 2 > LINE {
                    let _ = write!(out, "\n{:width$}", "");
                    column = width;
                } else {
                    out.push(' ');
                    column += 1;
                }
                out.push_str(text);
                column += text.len() + 1;
            }
            let _ = write!(out, "\n{:w$}]", "", w = 2 * depth);
        }
        Json::Object(map) => {
            let block = map.iter().map(|(k, v)| (k.clone(), value_text(v, depth + 1))).collect();
            out = block_text(&block, depth);
        }
        other => one_line(other, &mut out),
    }
    out
}

/// A value on one line, keys sorted.
pub(crate) fn json_text(value: &Json) -> String {
    let mut text = String::new();
    one_line(value, &mut text);
    text
}

fn one_line(value: &Json, out: &mut String) {
    match value {
        Json::Array(list) => {
            out.push('[');
            for (i, v) in list.iter().enumerate() {
                out.push_str(if i > 0 { ", " } else { "" });
                one_line(v, out);
            }
            out.push(']');
        }
        Json::Object(map) => {
            let sorted: BTreeMap<&String, &Json> = map.iter().collect();
            out.push('{');
            for (i, (k, v)) in sorted.into_iter().enumerate() {
                out.push_str(if i > 0 { ", " } else { " " });
                let _ = write!(out, "{}: ", quoted(k));
                one_line(v, out);
            }
            out.push_str(if map.is_empty() { "}" } else { " }" });
        }
        other => {
            let _ = write!(out, "{other}");
        }
    }
}
