//! Reading the file. Size and nesting are looked at before anything is parsed, so that garbage costs no memory and
//! no stack; every refusal says line and column.

use super::cluster::{Cluster, Link, is_version};
use super::fields::Fields;
use super::model::{
    Document, InterfaceInput, InterfaceOutput, Node, NodeState, Raw, TreeOp, Wires, split_port, valid_id,
};
use super::model::{NodeMore, WiresMore};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::evaluate::matching::Matching;
use crate::value::Json;
use crate::value::item::kind_of;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use serde_json::value::RawValue;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::Arc;

/// Files larger than this are refused unless the caller allows more: 64 MiB.
pub const DEFAULT_SIZE_LIMIT: usize = 64 << 20;
/// Deepest nesting of lists and objects in a file.
pub const DEPTH_LIMIT: usize = 100;

/// No more errors of one file are told than this.
const MOST_ERRORS: usize = 50;

/// The members of an object in order, their values unread.
struct Members<'a>(Vec<(String, &'a RawValue)>);

impl<'de: 'a, 'a> Deserialize<'de> for Members<'a> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Each;
        impl<'de> Visitor<'de> for Each {
            type Value = Vec<(String, &'de RawValue)>;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Self::Value, A::Error> {
                let mut members = Vec::new();
                while let Some(member) = map.next_entry()? {
                    members.push(member);
                }
                Ok(members)
            }
        }
        deserializer.deserialize_map(Each).map(Members)
    }
}

struct Loader<'a> {
    text: &'a str,
    errors: Vec<Diagnostic>,
}

impl Document {
    /// Reads a graph file of at most [`DEFAULT_SIZE_LIMIT`] bytes.
    ///
    /// # Errors
    /// Everything that is wrong with the file's form, each with line and column. What is wrong with the graph
    /// (unknown nodes, cycles) is [`Document::validate`]'s matter.
    pub fn from_slice(bytes: &[u8]) -> Result<Self, Vec<Diagnostic>> {
        Self::from_slice_with_limit(bytes, DEFAULT_SIZE_LIMIT)
    }

    /// Reads a graph file of at most `limit` bytes. O(n).
    ///
    /// # Errors
    /// As [`Document::from_slice`].
    pub fn from_slice_with_limit(bytes: &[u8], limit: usize) -> Result<Self, Vec<Diagnostic>> {
        if bytes.len() > limit {
            let (size, most) = (bytes.len() as f64 / 1e6, limit as f64 / 1e6);
            let message = format!("the file has {size:.1} MB; a graph may have at most {most:.1} MB");
            return Err(vec![Diagnostic::error("file-too-large", message)]);
        }
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        look_ahead(bytes).map_err(|e| vec![e])?;
        let text = std::str::from_utf8(bytes).map_err(|e| {
            let message = format!("{}: the file is not UTF-8 text", place(bytes, e.valid_up_to()));
            vec![Diagnostic::error("not-utf8", message)]
        })?;
        // One pass over everything first: positions of syntax errors are those of the file.
        serde_json::from_str::<serde::de::IgnoredAny>(text).map_err(|e| vec![syntax(&e)])?;
        let mut loader = Loader { text, errors: Vec::new() };
        let document = loader.document();
        if loader.errors.is_empty() { Ok(document) } else { Err(loader.errors) }
    }
}

fn syntax(e: &serde_json::Error) -> Diagnostic {
    let text = e.to_string();
    let what = text.rsplit_once(" at line ").map_or(text.as_str(), |(what, _)| what);
    let diagnostic = Diagnostic::error("json-syntax", format!("line {}, column {}: {what}", e.line(), e.column()));
    if e.is_eof() { diagnostic.hint("the file ends too early; was it cut off?") } else { diagnostic }
}

/// Line and column of a byte, both from 1. O(n).
fn place(bytes: &[u8], at: usize) -> String {
    let before = &bytes[..at.min(bytes.len())];
    let line = before.iter().filter(|b| **b == b'\n').count() + 1;
    let column = before.iter().rev().take_while(|b| **b != b'\n').filter(|b| **b & 0xC0 != 0x80).count() + 1;
    format!("line {line}, column {column}")
}

/// Refuses deep nesting and files that do not begin like an object, without recursion and without memory.
fn look_ahead(bytes: &[u8]) -> Result<(), Diagnostic> {
    let start = bytes.iter().position(|b| !b.is_ascii_whitespace());
    match start.map(|s| (s, bytes[s])) {
        Some((_, b'{' | b'[')) => {}
        Some((s, _)) => {
            let message = format!("{}: a graph file begins with {{", place(bytes, s));
            return Err(Diagnostic::error("json-syntax", message).hint("is this a Tenon graph?"));
        }
        None => return Err(Diagnostic::error("json-syntax", "the file is empty")),
    }
    let (mut depth, mut in_text, mut escaped) = (0usize, false, false);
    for (i, b) in bytes.iter().enumerate() {
        if in_text {
            match b {
                _ if escaped => escaped = false,
                b'\\' => escaped = true,
                b'"' => in_text = false,
                _ => {}
            }
            continue;
        }
        match b {
            b'"' => in_text = true,
            b'{' | b'[' => {
                depth += 1;
                if depth > DEPTH_LIMIT {
                    let message = format!("{}: nested deeper than {DEPTH_LIMIT} levels", place(bytes, i));
                    return Err(Diagnostic::error("too-deep", message));
                }
            }
            b'}' | b']' => depth = depth.saturating_sub(1),
            _ => {}
        }
    }
    Ok(())
}

/// The node that a text of a file's `nodes` says; `None` if it is none. O(n).
pub(crate) fn read_node(text: &str) -> Option<Node> {
    let raw = serde_json::from_str::<&RawValue>(text).ok()?;
    let mut loader = Loader { text, errors: Vec::new() };
    let node = loader.node("", raw);
    loader.errors.is_empty().then_some(node)
}

/// Whether a text can stand in a file as the value of `x`, so many levels down: one JSON value, not nested too deep. O(n).
pub(crate) fn check_foreign(text: &str, above: usize) -> Result<(), Diagnostic> {
    let (open, close) = ("[".repeat(above), "]".repeat(above));
    look_ahead(format!("{open}{{\"x\":{text}}}{close}").as_bytes())?;
    serde_json::from_str::<serde::de::IgnoredAny>(text).map(|_| ()).map_err(|e| syntax(&e))
}

/// A JSON text as an object.
pub(crate) fn object_of(text: &str) -> Option<serde_json::Map<String, Json>> {
    serde_json::from_str(text).ok()
}

type Map<'a> = BTreeMap<String, &'a RawValue>;

impl<'a> Loader<'a> {
    fn error(&mut self, at: &str, what: impl std::fmt::Display) -> &mut Diagnostic {
        // Every piece is a slice of the whole text, so its address says where it stands.
        let offset = (at.as_ptr() as usize).saturating_sub(self.text.as_ptr() as usize);
        // Finding a line costs a pass over the text: a file wrong everywhere must not cost a pass per error.
        if self.errors.len() < MOST_ERRORS {
            let message = format!("{}: {what}", place(self.text.as_bytes(), offset));
            self.errors.push(Diagnostic::error("bad-file", message));
        }
        let last = self.errors.len() - 1;
        &mut self.errors[last]
    }

    fn object(&mut self, raw: &'a str, what: &str) -> Map<'a> {
        let Ok(Members(members)) = serde_json::from_str::<Members<'a>>(raw) else {
            self.error(raw, format!("{what} must be an object"));
            return Map::new();
        };
        let mut map = Map::new();
        for (key, value) in members {
            match map.entry(key) {
                Entry::Vacant(free) => {
                    free.insert(value);
                }
                Entry::Occupied(taken) => {
                    self.error(value.get(), format!("\"{}\" stands twice in {what}", taken.key()));
                }
            }
        }
        map
    }

    fn json(&mut self, raw: &'a RawValue) -> Json {
        match serde_json::from_str(raw.get()) {
            Ok(json) => json,
            Err(e) => {
                // Only numbers that no float can hold come here.
                self.error(raw.get(), e.to_string());
                Json::Null
            }
        }
    }

    fn rest(&mut self, map: Map<'a>) -> BTreeMap<String, Json> {
        map.into_iter().map(|(k, v)| (k, self.json(v))).collect()
    }

    fn text(&mut self, map: &mut Map<'a>, key: &str, what: &str) -> Option<String> {
        let raw = map.remove(key)?;
        match self.json(raw) {
            Json::String(s) => Some(s),
            other => {
                self.error(raw.get(), format!("\"{key}\" of {what} must be text, not {}", kind_of(&other)));
                None
            }
        }
    }

    fn number(&mut self, map: &mut Map<'a>, key: &str, what: &str) -> Option<f64> {
        let raw = map.remove(key)?;
        let json = self.json(raw);
        if json.as_f64().is_none() {
            self.error(raw.get(), format!("\"{key}\" of {what} must be a number, not {}", kind_of(&json)));
        }
        json.as_f64()
    }

    fn whole(&mut self, map: &mut Map<'a>, key: &str, what: &str) -> Option<i64> {
        let raw = map.remove(key)?;
        let json = self.json(raw);
        if json.as_i64().is_none() {
            self.error(raw.get(), format!("\"{key}\" of {what} must be a whole number, not {json}"));
        }
        json.as_i64()
    }

    /// A text or a list of texts.
    fn texts(&mut self, raw: &'a RawValue, what: &str) -> Vec<String> {
        match self.json(raw) {
            Json::String(s) => vec![s],
            Json::Array(list) if list.iter().all(Json::is_string) => {
                list.into_iter().filter_map(|j| j.as_str().map(str::to_owned)).collect()
            }
            other => {
                self.error(raw.get(), format!("{what} must be a text or a list of texts, not {}", kind_of(&other)));
                Vec::new()
            }
        }
    }

    fn one_of<T: Copy>(&mut self, raw: &str, name: &str, what: &str, all: &[(&'static str, T)]) -> Option<T> {
        let found = all.iter().find(|(n, _)| *n == name).map(|(_, t)| *t);
        if found.is_none() {
            let names: Vec<&str> = all.iter().map(|(n, _)| *n).collect();
            let hint = did_you_mean(name, names.iter().copied());
            self.error(raw, format!("\"{name}\" is no {what}; there are {}", names.join(", "))).hint =
                hint.map(Into::into);
        }
        found
    }

    fn address(&mut self, raw: &str, address: &str) {
        if split_port(address).is_none() {
            self.error(raw, format!("\"{address}\" is not of the form node.port"));
        }
    }

    fn matching(&mut self, map: &mut Map<'a>, what: &str) -> Option<Matching> {
        let raw = *map.get("match")?;
        let name = self.text(map, "match", what)?;
        let all = [Matching::Longest, Matching::Shortest, Matching::Cross].map(|m| (m.as_str(), m));
        self.one_of(raw.get(), &name, "matching rule", &all)
    }

    fn document(&mut self) -> Document {
        let text = self.text;
        let mut top = self.object(text.trim(), "a graph file");
        match self.text(&mut top, "format", "the file").as_deref() {
            Some("tenon") => {}
            Some(other) => {
                self.error(text, format!("this is a \"{other}\" file, not a \"tenon\" file"));
            }
            None if self.errors.is_empty() => {
                self.error(text, "this is no Tenon graph: \"format\": \"tenon\" is missing");
            }
            None => {}
        }
        match self.number(&mut top, "version", "the file") {
            None | Some(1.0) => {}
            Some(v) => {
                self.error(text, format!("the file has version {v}; this program reads version 1")).hint =
                    Some("use a newer Tenon".into());
            }
        }
        if let Some(units) = self.text(&mut top, "units", "the file")
            && units != "mm"
        {
            self.error(text, format!("units are \"{units}\"; a graph's lengths are in \"mm\""));
        }
        let clusters = top.remove("clusters");
        let mut document = self.content(top);
        if let Some(raw) = clusters {
            for (name, raw) in self.object(raw.get(), "\"clusters\"") {
                let cluster = self.cluster(&name, raw);
                document.clusters.insert(name, cluster);
            }
        }
        document
    }

    fn cluster(&mut self, name: &str, raw: &'a RawValue) -> Cluster {
        let what = format!("cluster \"{name}\"");
        let mut map = self.object(raw.get(), &what);
        let Some(file) = self.text(&mut map, "file", &what) else {
            if let Some(clusters) = map.get("clusters") {
                let message = format!("{what} has clusters of its own; they stand at the top of the file");
                self.error(clusters.get(), message);
            }
            return Cluster::Here(Box::new(self.content(map)));
        };
        for key in ["nodes", "interface"] {
            if let Some(raw) = map.get(key) {
                self.error(raw.get(), format!("{what} is in a file, so it cannot have \"{key}\" here"));
            }
        }
        let version = map.remove("version").and_then(|raw| {
            let json = self.json(raw);
            if !is_version(&json) {
                self.error(raw.get(), format!("\"version\" of {what} must be a whole number from 1, not {json}"));
            }
            json.as_u64().and_then(|v| u32::try_from(v).ok())
        });
        let digest = self.text(&mut map, "digest", &what);
        Cluster::File(Link { file, version, digest, extra: self.rest(map) })
    }

    /// What the top of a file and a cluster have in common; keys that are left are kept.
    fn content(&mut self, mut top: Map<'a>) -> Document {
        let mut document = Document::default();
        if let Some(raw) = top.remove("requires") {
            let map = self.object(raw.get(), "\"requires\"");
            document.requires = self.rest(map);
        }
        if let Some(raw) = top.remove("groups") {
            let map = self.object(raw.get(), "\"groups\"");
            document.groups = self.rest(map);
        }
        document.foreign = top.remove("x").map(|raw| Arc::from(raw.get()));
        if let Some(raw) = top.remove("interface") {
            self.interface(raw, &mut document);
        }
        if let Some(raw) = top.remove("nodes") {
            for (id, raw) in self.object(raw.get(), "\"nodes\"") {
                if valid_id(&id) {
                    let node = self.node(&id, raw);
                    document.nodes.insert(id, node);
                } else {
                    self.error(raw.get(), format!("\"{id}\" cannot be a node's id: it is empty or has a dot in it"));
                }
            }
        }
        document.extra = self.rest(top);
        document
    }

    fn interface(&mut self, raw: &'a RawValue, document: &mut Document) {
        let mut map = self.object(raw.get(), "\"interface\"");
        if let Some(raw) = map.remove("inputs") {
            for (name, raw) in self.object(raw.get(), "\"inputs\" of the interface") {
                let what = format!("input \"{name}\"");
                let mut map = self.object(raw.get(), &what);
                let ports = match map.remove("port") {
                    Some(port) => {
                        let ports = self.texts(port, &format!("\"port\" of {what}"));
                        ports.iter().for_each(|p| self.address(port.get(), p));
                        ports
                    }
                    None => {
                        self.error(raw.get(), format!("{what} has no \"port\""));
                        Vec::new()
                    }
                };
                let unit = self.text(&mut map, "unit", &what);
                let (min, max) = (self.number(&mut map, "min", &what), self.number(&mut map, "max", &what));
                let written = map.get("step").map(|raw| raw.get());
                let step = self.number(&mut map, "step", &what).filter(|step| {
                    if *step <= 0.0 {
                        self.error(written.unwrap_or(""), format!("\"step\" of {what} must be above 0, not {step}"));
                    }
                    *step > 0.0
                });
                let doc = self.text(&mut map, "doc", &what);
                let order = self.whole(&mut map, "order", &what);
                let extra = self.rest(map);
                document.inputs.insert(name, InterfaceInput { ports, unit, min, max, step, doc, order, extra });
            }
        }
        if let Some(raw) = map.remove("outputs") {
            for (name, raw) in self.object(raw.get(), "\"outputs\" of the interface") {
                let what = format!("output \"{name}\"");
                let mut map = self.object(raw.get(), &what);
                let port = self.text(&mut map, "port", &what);
                match &port {
                    Some(port) => self.address(raw.get(), port),
                    None => {
                        self.error(raw.get(), format!("{what} has no \"port\""));
                    }
                }
                let (unit, doc) = (self.text(&mut map, "unit", &what), self.text(&mut map, "doc", &what));
                let (order, extra) = (self.whole(&mut map, "order", &what), self.rest(map));
                let port = port.unwrap_or_default();
                document.outputs.insert(name, InterfaceOutput { port, unit, doc, order, extra });
            }
        }
        if let Some(raw) = map.get("version") {
            let json = self.json(raw);
            if !is_version(&json) {
                self.error(
                    raw.get(),
                    format!("\"version\" of the interface must be a whole number from 1, not {json}"),
                );
            }
        }
        if let Some(raw) = map.get("doc")
            && !self.json(raw).is_string()
        {
            self.error(raw.get(), "\"doc\" of the interface must be text");
        }
        document.interface_extra = self.rest(map);
    }

    fn node(&mut self, id: &str, raw: &'a RawValue) -> Node {
        let what = format!("node \"{id}\"");
        let mut map = self.object(raw.get(), &what);
        let type_name = self.text(&mut map, "type", &what).unwrap_or_else(|| {
            self.error(raw.get(), format!("{what} has no \"type\""));
            String::new()
        });
        let version = match self.number(&mut map, "v", &what) {
            None => 1,
            Some(v) if v >= 1.0 && v.fract() == 0.0 && v <= f64::from(u32::MAX) => v as u32,
            Some(v) => {
                self.error(raw.get(), format!("\"v\" of {what} must be a whole number from 1, not {v}"));
                1
            }
        };
        let params = match map.remove("params") {
            Some(raw) => {
                let map = self.object(raw.get(), &format!("\"params\" of {what}"));
                map.into_iter().map(|(k, v)| (k.into(), self.json(v).into())).collect()
            }
            None => Fields::new(),
        };
        let mut inputs = Fields::new();
        if let Some(raw) = map.remove("inputs") {
            for (port, raw) in self.object(raw.get(), &format!("\"inputs\" of {what}")) {
                let wires = self.wires(raw, &format!("input \"{port}\" of {what}"));
                inputs.insert(port, wires);
            }
        }
        let matching = self.matching(&mut map, &what);
        let state_at = map.get("state").map_or(raw.get(), |r| r.get());
        let states = NodeState::ALL.map(|s| (s.as_str(), s));
        let state = self.text(&mut map, "state", &what);
        let state = state.and_then(|s| self.one_of(state_at, &s, "node state", &states)).unwrap_or_default();
        let note = self.text(&mut map, "note", &what);
        let extra = self.rest(map);
        let raw = Raw(Some(Arc::from(raw.get())));
        Node {
            type_name: type_name.into(),
            version,
            params,
            inputs,
            matching,
            state,
            more: NodeMore { note, extra, raw }.into(),
        }
    }

    fn wires(&mut self, raw: &'a RawValue, what: &str) -> Wires {
        let mut map = self.object(raw.get(), what);
        let from = match map.remove("from") {
            Some(from) => {
                let sources = self.texts(from, &format!("\"from\" of {what}"));
                sources.iter().for_each(|s| self.address(from.get(), s));
                sources
            }
            None => {
                self.error(raw.get(), format!("{what} has no \"from\""));
                Vec::new()
            }
        };
        let tree = match map.remove("tree") {
            Some(raw) => {
                let names = self.texts(raw, &format!("\"tree\" of {what}"));
                let all = TreeOp::ALL.map(|op| (op.as_str(), op));
                names.iter().filter_map(|n| self.one_of(raw.get(), n, "tree operation", &all)).collect()
            }
            None => Vec::new(),
        };
        let matching = self.matching(&mut map, what);
        let extra = self.rest(map);
        let from = from.into_iter().map(Into::into).collect();
        Wires { from, more: WiresMore { tree, matching, extra }.into() }
    }
}
