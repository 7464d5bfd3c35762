//! The definitions that a graph uses, before anything is expanded: which cluster each instance means, circles among
//! definitions, and how much each of them comes to.

use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::document::cluster::{Cluster, Link, LinkedFile, PREFIX};
use crate::document::link::{folder_of, join};
use crate::document::model::{Document, InterfaceInput, InterfaceOutput, Node, split_port};
use petgraph::algo::kosaraju_scc;
use petgraph::graph::DiGraph;
use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;

/// Clusters nest no deeper than this.
pub(crate) const DEEPEST: u64 = 64;
/// All clusters of a graph together come to no more nodes and instances than this.
pub(crate) const MOST_NODES: u64 = 2_000_000;
/// Nor to more bytes of node paths.
pub(crate) const MOST_TEXT: u64 = 1 << 30;

/// Of circles among more definitions than this only the beginning is named: a search for each would cost their square.
const LONGEST_NAMED: usize = 100;

/// What the plan keeps of a definition: its name and its interface.
#[derive(Debug, Default)]
pub(crate) struct Interface {
    pub name: String,
    pub inputs: BTreeMap<String, InterfaceInput>,
    pub outputs: BTreeMap<String, InterfaceOutput>,
}

/// What a definition comes to when it is expanded.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Size {
    pub nodes: u64,
    /// Bytes of the paths of its nodes below it.
    pub text: u64,
    /// Levels of clusters inside.
    pub depth: u64,
}

/// An instance: the definition that it means, or why it means none.
pub(crate) type Meaning = Result<usize, Box<Diagnostic>>;

/// A graph whose nodes may be instances: the root, a cluster of a file, or a linked file.
pub(crate) struct Definition<'a> {
    /// Where its nodes and its interface stand.
    pub body: &'a Document,
    /// Where the clusters stand that its instances name.
    table: &'a Document,
    /// Its file from the root's folder; empty for the root's own.
    file: String,
    /// Folder of its file from the root's folder, with a slash at its end.
    pub folder: String,
    pub interface: Arc<Interface>,
    pub instances: BTreeMap<&'a str, Meaning>,
    /// For the ports that its interface's inputs lead to, by node: port and input.
    pub bound: HashMap<&'a str, Vec<(&'a str, &'a str)>>,
    pub size: Size,
}

/// All definitions that a graph reaches; the root is the first.
pub(crate) struct Definitions<'a> {
    pub all: Vec<Definition<'a>>,
    root: &'a Document,
    /// By file and name of the cluster in it, none for the file itself.
    known: HashMap<(String, Option<&'a str>), usize>,
    /// Faults of definitions, with the instance that uses it first.
    pub faults: Vec<Diagnostic>,
}

impl<'a> Definitions<'a> {
    /// O(definitions and what stands in them, each once).
    pub fn find(root: &'a Document) -> Self {
        let mut all = Self { all: Vec::new(), root, known: HashMap::new(), faults: Vec::new() };
        all.add(String::new(), None, root, root, String::new());
        let mut next = 0;
        while next < all.all.len() {
            all.find_instances(next);
            next += 1;
        }
        all.refuse_circles();
        all
    }

    fn add(
        &mut self,
        file: String,
        name: Option<&'a str>,
        body: &'a Document,
        table: &'a Document,
        said: String,
    ) -> usize {
        let mut bound: HashMap<&str, Vec<(&str, &str)>> = HashMap::new();
        if !self.all.is_empty() {
            for (input, i) in &body.inputs {
                for (node, port) in i.ports.iter().filter_map(|address| split_port(address)) {
                    let of_node = bound.entry(node).or_default();
                    let wired = body.nodes.get(node).is_some_and(|n| n.inputs.contains_key(port));
                    let fault = if let Some((_, other)) = of_node.iter().find(|(p, _)| *p == port) {
                        format!("inputs \"{other}\" and \"{input}\" of cluster \"{said}\" lead to the same port")
                    } else if wired {
                        format!("input \"{input}\" of cluster \"{said}\" leads to a port that has a wire")
                    } else {
                        of_node.push((port, input));
                        continue;
                    };
                    let fault = Diagnostic::error("wired-input", fault).port(port);
                    self.faults.push(fault.at(format!("{PREFIX}{said}/{node}")));
                }
            }
        }
        let interface = if self.all.is_empty() {
            Interface::default()
        } else {
            Interface { name: said, inputs: body.inputs.clone(), outputs: body.outputs.clone() }
        };
        let folder = folder_of(&file).to_owned();
        self.known.insert((file.clone(), name), self.all.len());
        let (interface, instances) = (Arc::new(interface), BTreeMap::new());
        self.all.push(Definition { body, table, file, folder, interface, instances, bound, size: Size::default() });
        self.all.len() - 1
    }

    fn find_instances(&mut self, at: usize) {
        let body = self.all[at].body;
        let named = body.nodes.iter().filter_map(|(id, node)| Some((id, node, node.cluster()?)));
        let mut instances = BTreeMap::new();
        for (id, node, name) in named {
            let meaning = self.meaning(at, name).and_then(|d| self.check_instance(at, id, node, d).map(|()| d));
            instances.insert(id.as_str(), meaning.map_err(Box::new));
        }
        self.all[at].instances = instances;
    }

    /// The definition that an instance of `name` means in the definition `at`.
    fn meaning(&mut self, at: usize, name: &str) -> Result<usize, Diagnostic> {
        let (table, folder) = (self.all[at].table, self.all[at].folder.clone());
        let Some((name, cluster)) = table.clusters.get_key_value(name) else {
            let hint = did_you_mean(name, table.clusters.keys().map(String::as_str));
            let none = table.clusters.is_empty().then(|| "the file has no clusters".to_owned());
            let message = format!("no cluster is called \"{name}\"");
            return Err(Diagnostic::error("unknown-cluster", message).maybe_hint(hint.or(none)));
        };
        match cluster {
            Cluster::Here(body) => {
                let key = (self.all[at].file.clone(), Some(name.as_str()));
                match self.known.get(&key) {
                    Some(d) => Ok(*d),
                    None => {
                        let said = if key.0.is_empty() { name.clone() } else { format!("{}:{name}", key.0) };
                        Ok(self.add(key.0, key.1, body, table, said))
                    }
                }
            }
            Cluster::File(link) => {
                let path = join(&folder, &link.file);
                let file = self.linked(name, link, &path)?;
                match self.known.get(&(path.clone(), None)) {
                    Some(d) => Ok(*d),
                    None => {
                        let document = &file.document;
                        Ok(self.add(path.clone(), None, document, document, path))
                    }
                }
            }
        }
    }

    fn linked(&self, name: &str, link: &Link, path: &str) -> Result<&'a LinkedFile, Diagnostic> {
        let file = match self.root.linked.0.get(path) {
            Some(Ok(file)) => file,
            Some(Err(why)) => {
                let message = format!("cluster \"{name}\": {path} cannot be used: {why}");
                return Err(Diagnostic::error("linked-file", message)
                    .hint("put the file there, or correct the cluster's \"file\""));
            }
            None => {
                let message = format!("cluster \"{name}\": {path} has not been read");
                return Err(Diagnostic::error("linked-file", message).hint("read the graph's links first"));
            }
        };
        let update = "look at what changed, then take it over: tenon fmt --update-links";
        let version = file.document.interface_version();
        if let Some(pinned) = link.version.filter(|v| *v != version) {
            let message =
                format!("cluster \"{name}\" is pinned to version {pinned} of {path}, which has version {version}");
            return Err(Diagnostic::error("linked-version", message).hint(update));
        }
        if let Some(pinned) = link.digest.as_ref().filter(|d| **d != file.digest) {
            let message =
                format!("cluster \"{name}\" is pinned to {pinned}, but {path} has changed: it is {}", file.digest);
            return Err(Diagnostic::error("linked-digest", message).hint(update));
        }
        Ok(file)
    }

    /// What keeps one instance from being expanded: ports that the cluster does not have, and names that lie inside it.
    fn check_instance(&self, at: usize, id: &str, node: &Node, definition: usize) -> Result<(), Diagnostic> {
        let (of, within) = (&self.all[definition], self.all[at].body);
        for port in node.params.keys().chain(node.inputs.keys()) {
            if !of.body.inputs.contains_key(port.as_str()) {
                let hint = did_you_mean(port, of.body.inputs.keys().map(String::as_str));
                let message = format!("cluster \"{}\" has no input \"{port}\"", of.interface.name);
                return Err(Diagnostic::error("unknown-port", message).port(port).maybe_hint(hint));
            }
        }
        let inside = format!("{id}/");
        if let Some((other, _)) = within.nodes.range(inside.clone()..).next().filter(|(o, _)| o.starts_with(&inside)) {
            let message = format!("node \"{other}\" has a name that belongs to the inside of \"{id}\"");
            return Err(Diagnostic::error("taken-path", message).hint("rename one of them"));
        }
        Ok(())
    }

    /// Instances that lead back to their own definition are errors; sizes of all definitions, those inside first.
    fn refuse_circles(&mut self) {
        let mut graph = DiGraph::<usize, ()>::new();
        let index: Vec<_> = (0..self.all.len()).map(|d| graph.add_node(d)).collect();
        for (d, definition) in self.all.iter().enumerate() {
            for inner in definition.instances.values().flatten() {
                graph.update_edge(index[d], index[*inner], ());
            }
        }
        // Components come in postorder: what a definition uses comes before it.
        for component in kosaraju_scc(&graph) {
            let mut members: Vec<usize> = component.into_iter().map(|i| graph[i]).collect();
            members.sort_unstable();
            for &d in &members {
                let inner: Vec<(&str, usize)> =
                    self.all[d].instances.iter().filter_map(|(id, m)| Some((*id, *m.as_ref().ok()?))).collect();
                for (id, inner) in inner {
                    if members.binary_search(&inner).is_ok() {
                        let name = self.name_circle(d, inner, &members);
                        let message = format!("the cluster contains itself: {name}");
                        let circle = Diagnostic::error("cluster-cycle", message).hint("remove one of these instances");
                        self.all[d].instances.insert(id, Err(Box::new(circle)));
                    }
                }
            }
            for d in members {
                self.measure(d);
            }
        }
    }

    /// "a > b > a": from `outer` into `inner` and back, by a shortest way.
    fn name_circle(&self, outer: usize, inner: usize, members: &[usize]) -> String {
        let name = |d: &usize| if *d == 0 { "this file" } else { self.all[*d].interface.name.as_str() };
        if members.len() > LONGEST_NAMED {
            return format!("{} > {} > ... > {0}", name(&outer), name(&inner));
        }
        let mut came_from: HashMap<usize, usize> = HashMap::new();
        let mut queue = std::collections::VecDeque::from([inner]);
        while let Some(d) = queue.pop_front().filter(|d| *d != outer) {
            // Instances that were refused already belong to the circle all the same.
            for next in self.uses(d).filter(|n| members.binary_search(n).is_ok()) {
                if next != inner && !came_from.contains_key(&next) {
                    came_from.insert(next, d);
                    queue.push_back(next);
                }
            }
        }
        // From the outer one backwards to the inner one; then the outer one before all of it.
        let mut walk = vec![outer];
        while let Some(d) = walk.last().filter(|d| **d != inner).and_then(|d| came_from.get(d)) {
            walk.push(*d);
        }
        walk.push(outer);
        walk.reverse();
        walk.iter().map(name).collect::<Vec<_>>().join(" > ")
    }

    /// The definitions that instances in `d` name, whether they are refused or not.
    fn uses(&self, d: usize) -> impl Iterator<Item = usize> {
        let Definition { body, table, folder, file, .. } = &self.all[d];
        body.nodes.values().filter_map(move |node| {
            let (name, cluster) = table.clusters.get_key_value(node.cluster()?)?;
            let key = match cluster {
                Cluster::Here(_) => (file.clone(), Some(name.as_str())),
                Cluster::File(link) => (join(folder, &link.file), None),
            };
            self.known.get(&key).copied()
        })
    }

    fn measure(&mut self, d: usize) {
        let mut size = Size::default();
        let body = self.all[d].body;
        for id in body.nodes.keys() {
            let long = id.len() as u64 + 1;
            // An instance counts as a node too: definitions without nodes must not nest for nothing.
            size.nodes = size.nodes.saturating_add(1);
            size.text = size.text.saturating_add(long);
            if let Some(Ok(inner)) = self.all[d].instances.get(id.as_str()) {
                let inner = self.all[*inner].size;
                size.nodes = size.nodes.saturating_add(inner.nodes);
                size.text = size.text.saturating_add(inner.text).saturating_add(inner.nodes.saturating_mul(long));
                size.depth = size.depth.max(inner.depth + 1);
            }
        }
        self.all[d].size = size;
    }
}
