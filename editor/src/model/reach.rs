//! Where values come from, across the borders of clusters: nodes of the whole graph by the paths of results.

use super::results::instances;
use std::collections::{BTreeSet, HashMap};
use std::sync::Arc;
use tenon_engine::{Document, Literal, Name, Node, Registry};

/// No cluster lies in more of them than this, unless it lies in itself.
const DEEPEST: usize = 64;

/// So many outputs inside instances are found at most.
const MOST: usize = 10_000;

/// A node where it stands.
pub(super) struct Place<'a> {
    /// What its path begins with: the path of the instance that it stands in with a slash, or nothing.
    prefix: &'a str,
    body: &'a Document,
    /// The clusters that lead to it, from the outside.
    names: Vec<&'a str>,
    /// The node.
    pub node: &'a Node,
}

/// What comes to an input.
pub(super) enum Given<'a> {
    /// The outputs (`path.port`) that wires bring it from; they are those of nodes, never of instances.
    Wires(Vec<String>),
    /// A value of its own.
    Value(&'a Literal),
}

/// The node at a path. O(levels of clusters).
pub(super) fn place<'a>(whole: &'a Document, path: &'a str) -> Option<Place<'a>> {
    let (mut prefix, mut body, mut names) = ("", whole, Vec::new());
    for instance in instances(whole, path)? {
        names.push(body.nodes().get(instance.strip_prefix(prefix)?)?.cluster()?);
        body = whole.definition(names.iter().copied())?.0;
        prefix = path.get(..=instance.len())?;
    }
    let node = body.nodes().get(path.strip_prefix(prefix)?)?;
    Some(Place { prefix, body, names, node })
}

/// The output of a node that an output (`path.port`) is: at an instance the one behind it. None if there is no such node.
pub(super) fn origin(whole: &Document, output: &str) -> Option<String> {
    let mut output = output.to_owned();
    loop {
        let (path, port) = output.split_once('.')?;
        let at = place(whole, path)?;
        let Some(cluster) = at.node.cluster() else { return Some(output) };
        if at.names.len() >= DEEPEST {
            return None;
        }
        let names = at.names.iter().copied().chain([cluster]);
        let inner = &whole.definition(names)?.0.outputs.get(port)?.port;
        output = format!("{path}/{inner}");
    }
}

/// What comes to an input of the node at a path. What its instance is given for it counts before what its definition says.
pub(super) fn given<'a>(whole: &'a Document, path: &'a str, port: &str) -> Option<Given<'a>> {
    let at = place(whole, path)?;
    if let Some(instance) = at.prefix.strip_suffix('/') {
        let address = format!("{}.{port}", path.strip_prefix(at.prefix)?);
        let mut exposed = at.body.inputs.iter().filter(|(_, i)| i.ports.contains(&address));
        if let Some(given) = exposed.find_map(|(name, _)| given(whole, instance, name)) {
            return Some(given);
        }
    }
    let wires = at.node.inputs.get(port).map_or(&[][..], |w| &w.from);
    if wires.is_empty() {
        return at.node.params.get(port).map(Given::Value);
    }
    let from = wires.iter().map(Name::as_str).filter_map(|from| origin(whole, &format!("{}{from}", at.prefix)));
    Some(Given::Wires(from.collect()))
}

/// The outputs (`path.port`) of all nodes that wires lead from to the node at a path.
pub(super) fn sources(whole: &Document, path: &str) -> Vec<String> {
    let Some(at) = place(whole, path) else { return Vec::new() };
    let mut ports: BTreeSet<&str> = at.node.inputs.iter().map(|(port, _)| port.as_str()).collect();
    if !at.prefix.is_empty() {
        let exposed = at.body.inputs.values().flat_map(|i| &i.ports).filter_map(|p| p.split_once('.'));
        ports.extend(exposed.filter(|(id, _)| path.strip_prefix(at.prefix) == Some(id)).map(|(_, port)| port));
    }
    let wired = |port| match given(whole, path, port) {
        Some(Given::Wires(from)) => from,
        _ => Vec::new(),
    };
    ports.into_iter().flat_map(wired).collect()
}

/// The outputs (`path.port`) of some types inside all instances of a graph. O(definitions + what is found).
pub(super) fn inside(whole: &Document, registry: &Registry, types: &[&str]) -> Arc<Vec<String>> {
    Inside { whole, registry, types, known: HashMap::new() }.of(&mut Vec::new(), whole)
}

struct Inside<'a> {
    whole: &'a Document,
    registry: &'a Registry,
    types: &'a [&'a str],
    known: HashMap<*const Document, Arc<Vec<String>>>,
}

impl<'a> Inside<'a> {
    /// Inside the instances of a body, and if it is that of a cluster also its own.
    fn of(&mut self, names: &mut Vec<&'a str>, body: &'a Document) -> Arc<Vec<String>> {
        if let Some(known) = self.known.get(&std::ptr::from_ref(body)) {
            return known.clone();
        }
        // A cluster that contains itself ends here.
        self.known.insert(body, Arc::default());
        let mut found = Vec::new();
        for (id, node) in body.nodes() {
            if let Some(cluster) = node.cluster() {
                names.push(cluster);
                if names.len() <= DEEPEST
                    && let Some((inner, _)) = self.whole.definition(names.iter().copied())
                {
                    let inner = self.of(names, inner);
                    found.extend(inner.iter().take(MOST - found.len()).map(|address| format!("{id}/{address}")));
                }
                names.pop();
            } else if !names.is_empty() {
                let ports = self.registry.get(&node.type_name).map_or(&[][..], |t| t.outputs());
                let ports = ports.iter().filter(|p| self.types.contains(&p.type_name()));
                found.extend(ports.take(MOST - found.len()).map(|p| format!("{id}.{}", p.name())));
            }
        }
        let found = Arc::new(found);
        self.known.insert(body, found.clone());
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = r#"{
  "format": "tenon",
  "version": 1,
  "clusters": {
    "in": {
      "interface": {
        "version": 1,
        "inputs": { "b": { "port": ["n.x", "n.y"] } },
        "outputs": { "out": { "port": "n.point" } }
      },
      "nodes": {
        "s": { "type": "series", "v": 1 },
        "n": { "type": "point", "v": 1, "inputs": { "x": { "from": ["s.numbers"] }, "z": { "from": ["s.numbers"] } } }
      }
    },
    "out": {
      "interface": {
        "version": 1, "inputs": { "a": { "port": "a/b.b" } }, "outputs": { "out": { "port": "a/b.out" } }
      },
      "nodes": { "a/b": { "type": "cluster:in", "v": 1 } }
    }
  },
  "nodes": {
    "given": { "type": "cluster:out", "v": 1, "inputs": { "a": { "from": ["x.out"] } } },
    "set": { "type": "cluster:out", "v": 1, "params": { "a": 7 } },
    "x": { "type": "cluster:out", "v": 1 },
    "p": { "type": "point", "v": 1, "inputs": { "x": { "from": ["given.out"] } } }
  }
}"#;

    #[test]
    fn a_cluster_that_lies_in_itself_leads_nowhere() {
        let text = r#"{
  "format": "tenon",
  "version": 1,
  "clusters": {
    "c": {
      "interface": { "version": 1, "outputs": { "out": { "port": "self.out" } } },
      "nodes": { "self": { "type": "cluster:c", "v": 1 } }
    }
  },
  "nodes": {
    "a": { "type": "cluster:c", "v": 1 },
    "p": { "type": "point", "v": 1, "inputs": { "x": { "from": ["a.out"] } } }
  }
}"#;
        let whole = Document::from_slice(text.as_bytes()).unwrap();
        assert_eq!(origin(&whole, "a.out"), None);
        assert!(sources(&whole, "p").is_empty());
    }

    #[test]
    fn wires_are_followed_into_instances_and_out_of_them() {
        let whole = Document::from_slice(TEXT.as_bytes()).unwrap();
        assert_eq!(origin(&whole, "given.out").as_deref(), Some("given/a/b/n.point"));
        assert_eq!(origin(&whole, "given.none"), None);
        assert_eq!(sources(&whole, "p"), ["given/a/b/n.point"]);
        assert_eq!(sources(&whole, "x/a/b/n"), ["x/a/b/s.numbers"; 2], "nothing is given, so its own wires count");
        let out = "x/a/b/n.point";
        assert_eq!(sources(&whole, "given/a/b/n"), [out, out, "given/a/b/s.numbers"], "through two borders");
        let Some(Given::Value(seven)) = given(&whole, "set/a/b/n", "x") else {
            panic!("the outermost instance sets it")
        };
        assert_eq!(seven.to_json(), 7);
        assert!(given(&whole, "x/a/b/n", "y").is_none() && place(&whole, "x/a").is_none());
    }
}
