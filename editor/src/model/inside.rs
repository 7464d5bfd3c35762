//! Inside clusters: which definition is worked on, seen through which instance. All changes go to the definition; values are
//! those of the instance. A definition of another file is only looked at.

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
        self.definition(self.inside.len()).map_or(&self.document, |(body, _)| body)
    }

    /// The definition that the first so many of the entered clusters lead to, and its file if that is another one.
    fn definition(&self, depth: usize) -> Option<(&Document, Option<String>)> {
        self.document.definition(self.inside.iter().take(depth).map(|e| e.cluster.as_str()))
    }

    /// The file that the definition on the canvas stands in, if it is another one and can only be looked at.
    #[must_use]
    pub fn linked(&self) -> Option<String> {
        self.definition(self.inside.len())?.1
    }

    /// The top of the file that the definition on the canvas stands in: there are the clusters that it uses.
    fn table(&self) -> &Document {
        let path = self.linked();
        let first = (0..=self.inside.len()).find_map(|d| self.definition(d).filter(|(_, p)| *p == path));
        first.map_or(&self.document, |(body, _)| body)
    }

    /// What stands on the canvas with the clusters that it can use beside it.
    pub(super) fn scope(&self) -> Cow<'_, Document> {
        let alone = self.inside.last().and_then(|e| self.table().alone(&e.cluster));
        alone
            .filter(|_| !std::ptr::eq(self.table(), self.document()))
            .map_or(Cow::Borrowed(self.document()), Cow::Owned)
    }

    /// Refuses what would change another file, or put an instance of a cluster into its own definition. O(operation; with
    /// instances in it also O(clusters)).
    pub(super) fn check_inside(&self, operation: &Operation) -> Result<(), Diagnostic> {
        let Some(last) = self.inside.last() else { return Ok(()) };
        if let Some(file) = self.linked() {
            let message = format!("the cluster {} stands in {file} and can only be looked at here", last.cluster);
            let hint = "take it into this file by the button above the canvas";
            return Err(Diagnostic::error("linked-cluster", message).hint(hint));
        }
        let instances = operation.parts().filter_map(|o| match o {
            Operation::AddNode { node, .. } | Operation::PutNode { node: Some(node), .. } => node.cluster(),
            _ => None,
        });
        let mut open: Vec<&str> = instances.collect();
        let mut seen = std::collections::BTreeSet::new();
        while let Some(name) = open.pop() {
            if name == last.cluster {
                let message = format!("the cluster {name} would contain itself");
                return Err(Diagnostic::error("cluster-cycle", message));
            }
            if !seen.insert(name) {
                continue;
            }
            if let Some(Cluster::Here(body)) = self.document.clusters.get(name) {
                open.extend(body.nodes().values().filter_map(Node::cluster));
            }
        }
        Ok(())
    }

    /// Where a node on the canvas stands.
    #[must_use]
    pub fn position(&self, id: &str) -> Option<[f64; 2]> {
        self.document().position(id).or_else(|| self.places.get(id).copied())
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
    /// If it is no instance, or its definition is nowhere.
    pub fn enter(&mut self, id: &str) -> Result<(), Diagnostic> {
        let node = self.document().nodes().get(id);
        let Some(cluster) = node.and_then(Node::cluster).map(str::to_owned) else {
            return Err(Diagnostic::error("no-cluster", format!("{id} is no instance of a cluster")));
        };
        let names = self.inside.iter().map(|e| e.cluster.as_str()).chain([cluster.as_str()]);
        let Some((body, _)) = self.document.definition(names) else {
            let message = format!("there is no cluster {cluster}, or its file could not be read");
            return Err(Diagnostic::error("unknown-cluster", message));
        };
        if (1..=self.inside.len()).any(|d| self.definition(d).is_some_and(|(outer, _)| std::ptr::eq(outer, body))) {
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
        let depth = (0..=self.inside.len()).take_while(|d| self.definition(*d).is_some()).count().saturating_sub(1);
        if depth < self.inside.len() {
            self.inside.truncate(depth);
            self.look_inside();
        }
    }

    fn look_inside(&mut self) {
        self.selection.clear();
        self.revision += 1;
        self.places.clear();
        self.catalog_for_here();
        self.worker.look_inside(self.inside.clone());
        self.show();
    }

    /// Takes the clusters that can be used on the canvas into the catalog.
    pub(super) fn catalog_for_here(&mut self) {
        let mut catalog = std::mem::take(&mut self.catalog);
        catalog.take_clusters(self.table(), &self.registry);
        self.catalog = catalog;
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

    /// Goes to the node at a path as [`Model::go_to`] does, and into the instances that it stands in, as far as they can be
    /// entered.
    pub fn go_into(&mut self, path: &str) {
        self.go_to(path);
        while let Some(id) = self.local(path).map(str::to_owned)
            && path.strip_prefix(&*self.path_of(&id)).is_some_and(|rest| rest.starts_with('/'))
            && self.enter(&id).is_ok()
        {
            self.go_to(path);
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
        self.worker.look_inside(self.inside.clone());
        self.show();
        done
    }

    /// Takes the linked cluster that is being looked at into this file, so that it can be changed.
    ///
    /// # Errors
    /// If what is on the canvas stands in this file already, or its file could not be read.
    pub fn embed_here(&mut self) -> Result<(), Diagnostic> {
        let first = (0..self.inside.len()).find(|d| self.definition(d + 1).is_some_and(|(_, path)| path.is_some()));
        let name = first.and_then(|d| self.inside.get(d)).map(|e| e.cluster.clone()).unwrap_or_default();
        self.embed(&name)?;
        self.leave_what_is_gone();
        self.look_inside();
        Ok(())
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
