//! Inside clusters: which definition is worked on, seen through which instance. All changes go to the definition; values are
//! those of the instance.

use super::Model;
use super::handle::{self, Handle};
use std::borrow::Cow;
use std::collections::HashMap;
use tenon_engine::{Cluster, Diagnostic, Document, Node, Operation};
use tenon_nodes::value::Point;

/// A cluster that was entered.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Entered {
    /// The path of its instance, as results name it: `low` or `low/strip`.
    pub path: String,
    /// The name of its definition.
    pub cluster: String,
}

impl Model {
    /// What stands on the canvas: the graph, or the definition of the cluster that was entered last.
    #[must_use]
    pub fn document(&self) -> &Document {
        let body = self.inside.last().and_then(|e| self.document.clusters.get(&e.cluster));
        match body {
            Some(Cluster::Here(body)) => body,
            _ => &self.document,
        }
    }

    /// The whole graph.
    #[must_use]
    pub fn whole(&self) -> &Document {
        &self.document
    }

    /// The clusters that were entered, from the outside.
    #[must_use]
    pub fn trail(&self) -> &[Entered] {
        &self.inside
    }

    /// Goes into the cluster that a node on the canvas is an instance of.
    ///
    /// # Errors
    /// If it is no instance, or the definition is not in this file.
    pub fn enter(&mut self, id: &str) -> Result<(), Diagnostic> {
        let node = self.document().nodes().get(id);
        let Some(cluster) = node.and_then(Node::cluster).map(str::to_owned) else {
            return Err(Diagnostic::error("no-cluster", format!("{id} is no instance of a cluster")));
        };
        match self.document.clusters.get(&cluster) {
            Some(Cluster::Here(_)) => {}
            Some(Cluster::File(link)) => {
                let message = format!("the cluster {cluster} stands in {}", link.file);
                let hint = "open that file, or take the cluster into this one by the menu of its node";
                return Err(Diagnostic::error("linked-cluster", message).hint(hint));
            }
            None => return Err(Diagnostic::error("unknown-cluster", format!("there is no cluster {cluster}"))),
        }
        if self.inside.iter().any(|e| e.cluster == cluster) {
            return Err(Diagnostic::error("cluster-cycle", format!("the cluster {cluster} contains itself")));
        }
        let path = self.path_of(id).into_owned();
        self.inside.push(Entered { path, cluster });
        self.look_inside();
        Ok(())
    }

    /// Goes out until so many clusters are entered; the instance that was left is selected.
    pub fn leave_to(&mut self, depth: usize) {
        let Some(left) = self.inside.get(depth).cloned() else { return };
        self.inside.truncate(depth);
        self.look_inside();
        let id = left.path.rsplit('/').next().unwrap_or_default().to_owned();
        self.selection = if self.document().nodes().contains_key(&id) { [id].into() } else { Default::default() };
    }

    /// Goes out of clusters that are not there any more, as after undoing.
    pub(super) fn leave_what_is_gone(&mut self) {
        let there = |e: &Entered| matches!(self.document.clusters.get(&e.cluster), Some(Cluster::Here(_)));
        let depth = self.inside.iter().take_while(|e| there(e)).count();
        if depth < self.inside.len() {
            self.inside.truncate(depth);
            self.look_inside();
        }
    }

    fn look_inside(&mut self) {
        self.selection.clear();
        self.revision += 1;
        self.worker.look_inside(self.inside.last().cloned());
        self.show();
    }

    /// The path by which results name a node on the canvas.
    #[must_use]
    pub fn path_of<'a>(&self, id: &'a str) -> Cow<'a, str> {
        match self.inside.last() {
            Some(e) => format!("{}/{id}", e.path).into(),
            None => id.into(),
        }
    }

    /// The node on the canvas that a path (or `path.port`) of results belongs to: it, or the instance that it is inside of.
    #[must_use]
    pub fn local<'a>(&self, path: &'a str) -> Option<&'a str> {
        let path = path.split_once('.').map_or(path, |(id, _)| id);
        let below = match self.inside.last() {
            Some(e) => path.strip_prefix(&e.path)?.strip_prefix('/')?,
            None => path,
        };
        // Ids may have a slash in them, so the longest one that there is counts.
        let nodes = self.document().nodes();
        if nodes.contains_key(below) {
            return Some(below);
        }
        let ends = below.match_indices('/').map(|(i, _)| &below[..i]);
        ends.filter(|id| nodes.contains_key(*id)).max_by_key(|id| id.len())
    }

    /// Whether what is at a path (or `path.port`) belongs to a selected node.
    #[must_use]
    pub fn is_chosen(&self, path: &str) -> bool {
        !self.selection.is_empty() && self.local(path).is_some_and(|id| self.selection.contains(id))
    }

    /// Goes to the node at a path: out of clusters until it is inside what is seen, then selects it or its instance.
    pub fn go_to(&mut self, path: &str) {
        let depth = self.inside.iter().take_while(|e| path.starts_with(&format!("{}/", e.path))).count();
        if depth < self.inside.len() {
            self.leave_to(depth);
        }
        if let Some(id) = self.local(path).map(str::to_owned) {
            self.selection = [id].into();
        }
    }

    /// The value of an output (`node.port`) of a node on the canvas.
    #[must_use]
    pub fn value(&self, output: &str) -> Option<&tenon_engine::Tree> {
        match self.inside.last() {
            Some(e) => self.results.values.get(&format!("{}/{output}", e.path)),
            None => self.results.values.get(output),
        }
    }

    /// All points on the canvas that a hand can move. Inside a cluster, coordinates that the instance sets are where it has them, and
    /// stay. O(nodes + points).
    #[must_use]
    pub fn handles(&self) -> Vec<Handle> {
        let mut all = handle::handles(self.document(), &self.catalog);
        if self.inside.is_empty() {
            return all;
        }
        let exposed = |address: &str| self.document().inputs.values().any(|i| i.ports.iter().any(|p| p == address));
        for h in all.iter_mut().filter(|h| h.place == handle::Place::Coordinates) {
            let value = self.value(&format!("{}.point", h.node)).and_then(|t| t.first::<Point>());
            let Some(value) = value else { continue };
            for (k, axis) in ["x", "y", "z"].into_iter().enumerate() {
                if exposed(&format!("{}.{axis}", h.node)) {
                    (h.free[k], h.at[k]) = (false, value.0[k]);
                }
            }
        }
        all
    }

    /// Gives a definition another name; its instances follow.
    ///
    /// # Errors
    /// If the name is taken or cannot be one.
    pub fn rename_cluster(&mut self, from: &str, to: &str) -> Result<(), Diagnostic> {
        if self.document.clusters.contains_key(to) {
            return Err(Diagnostic::error("taken-id", format!("there is a cluster {to} already")));
        }
        let Some(cluster) = self.document.clusters.get(from).cloned() else {
            return Err(Diagnostic::error("unknown-cluster", format!("there is no cluster {from}")));
        };
        let renamed = |nodes: &std::collections::BTreeMap<String, Node>| -> Vec<Operation> {
            let instances = nodes.iter().filter(|(_, n)| n.cluster() == Some(from));
            let put = |(id, node): (&String, &Node)| {
                let mut node = node.clone();
                node.type_name = Node::instance(to).type_name;
                Operation::PutNode { id: id.clone(), node: Some(Box::new(node)) }
            };
            instances.map(put).collect()
        };
        let mut all = vec![Operation::SetCluster { name: to.to_owned(), cluster: Some(Box::new(cluster)) }];
        all.extend(renamed(self.document.nodes()));
        for (name, cluster) in &self.document.clusters {
            let Cluster::Here(body) = cluster else { continue };
            let name = if name == from { to } else { name };
            let inside = |o| Operation::InCluster { name: name.to_owned(), operation: Box::new(o) };
            all.extend(renamed(body.nodes()).into_iter().map(inside));
        }
        all.push(Operation::SetCluster { name: from.to_owned(), cluster: None });
        // Places of nodes are kept by id, so they stay.
        let entered: HashMap<&str, &str> = [(from, to)].into();
        let before = self.inside.clone();
        for e in &mut self.inside {
            if let Some(new) = entered.get(e.cluster.as_str()) {
                e.cluster = (*new).to_owned();
            }
        }
        let inside = std::mem::take(&mut self.inside);
        let done = self.apply(Operation::All(all));
        self.inside = if done.is_ok() { inside } else { before };
        self.worker.look_inside(self.inside.last().cloned());
        self.show();
        done
    }

    /// Takes the definition of a linked cluster into this file.
    ///
    /// # Errors
    /// If it is not linked, or its file could not be read.
    pub fn embed(&mut self, cluster: &str) -> Result<(), Diagnostic> {
        let operation = self.document.embed(cluster, &self.registry)?;
        self.apply_to_whole(operation)
    }
}
