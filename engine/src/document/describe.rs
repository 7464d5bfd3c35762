//! A cluster as a node type: its ports with docs, units, ranges and defaults, as far as its interface and what lies behind
//! it say.

use super::cluster::{Cluster, PREFIX};
use super::link::{folder_of, join};
use super::model::{Document, Node, split_port};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::plan::define::DEEPEST;
use crate::plan::{Plan, Slot};
use crate::port::{Access, Port};
use crate::registry::{NodeType, Registry};
use crate::value::{Json, Tree};

/// The id of the one instance that is looked at.
const ONE: &str = "instance";

impl Document {
    /// What an instance of the cluster looks like: type, access, unit, range and default of the first port behind each input
    /// and of the port behind each output, with the interface's own words. Such a node type describes; it is in no registry
    /// and does not run. O(cluster after expansion).
    ///
    /// # Errors
    /// If there is no such cluster, or it cannot be used.
    pub fn cluster_type(&self, name: &str, registry: &Registry) -> Result<NodeType, Diagnostic> {
        let body = match self.clusters.get(name) {
            Some(Cluster::Here(body)) => Some(&**body),
            Some(Cluster::File(link)) => {
                self.linked.0.get(&join("", &link.file)).and_then(|f| f.as_ref().ok()).map(|f| &f.document)
            }
            None => {
                let hint = did_you_mean(name, self.clusters.keys().map(String::as_str));
                let message = format!("no cluster is called \"{name}\"");
                return Err(Diagnostic::error("unknown-cluster", message).maybe_hint(hint));
            }
        };
        let mut alone = Self { clusters: self.clusters.clone(), linked: self.linked.clone(), ..Self::default() };
        alone.nodes.insert(ONE.into(), Node::instance(name));
        let plan = Plan::compile(&alone, registry);
        let Some(body) = body.filter(|_| plan.is_instance(ONE)) else {
            let unusable = || Diagnostic::error("unknown-cluster", format!("cluster \"{name}\" cannot be used"));
            return Err(plan.find(ONE).and_then(|n| plan.errors(n).next().cloned()).unwrap_or_else(unusable));
        };
        let version = body.interface_version();
        let mut node_type =
            NodeType::new(format!("{PREFIX}{name}"), version).name(name.to_owned()).category("Clusters");
        node_type = node_type.doc(body.doc().unwrap_or_default().to_owned());
        for (name, input) in body.inputs_in_order() {
            let Ok((n, p)) = plan.find_input(&format!("{ONE}.{name}")) else { continue };
            let Some(behind) = plan.node_type(n).and_then(|t| t.inputs.get(p)) else { continue };
            let mut port = named(behind, name, input.doc.as_deref());
            if let (Slot::Literal(_), Some(tree)) = (plan.slot(n, p), plan.value_at(n, p)) {
                port.default = literal_of(tree, port.access);
            }
            node_type = node_type.input(port);
        }
        for (name, output) in body.outputs_in_order() {
            let Ok((n, o)) = plan.find_output(&format!("{ONE}.{name}")) else { continue };
            let Some(behind) = plan.node_type(n).and_then(|t| t.outputs.get(o)) else { continue };
            node_type = node_type.output(named(behind, name, output.doc.as_deref()));
        }
        Ok(node_type)
    }
}

impl Document {
    /// The definition that one gets to from here by names of clusters, each looked up in the file that the one before stands in;
    /// and the path of its file, if that is another than this one. None if a name is not there, or its file could not be
    /// read. O(names).
    #[must_use]
    pub fn definition<'a>(&'a self, names: impl IntoIterator<Item = &'a str>) -> Option<(&'a Self, Option<String>)> {
        let (mut body, mut table, mut path) = (self, self, None::<String>);
        for name in names {
            match table.clusters.get(name)? {
                Cluster::Here(inner) => body = inner,
                Cluster::File(link) => {
                    let file = join(path.as_deref().map_or("", folder_of), &link.file);
                    body = &self.linked.0.get(&file)?.as_ref().ok()?.document;
                    (table, path) = (body, Some(file));
                }
            }
        }
        Some((body, path))
    }

    /// The definition of a cluster of this file as a graph of its own, with the clusters of the file beside it: what is prepared
    /// with it (copies, pastes, new clusters) is brought back by [`super::Operation::inside`]. None if there is no such
    /// cluster in this file. O(definition + clusters).
    #[must_use]
    pub fn alone(&self, cluster: &str) -> Option<Self> {
        let Some(Cluster::Here(body)) = self.clusters.get(cluster) else { return None };
        Some(Self { clusters: self.clusters.clone(), linked: self.linked.clone(), ..Self::clone(body) })
    }

    /// The port of a node type that `node.port` stands for as an input: at an instance the first one behind its own. With the
    /// port's own range: those of interfaces are [`Document::cluster_type`]'s matter. O(levels of clusters).
    #[must_use]
    pub fn input_port<'a>(&'a self, registry: &'a Registry, address: &'a str) -> Option<&'a Port> {
        let (t, port) = self.behind(registry, address, |body, port| body.inputs.get(port)?.ports.first())?;
        t.inputs.iter().find(|p| p.name == port)
    }

    /// The port of a node type that `node.port` stands for as an output.
    #[must_use]
    pub fn output_port<'a>(&'a self, registry: &'a Registry, address: &'a str) -> Option<&'a Port> {
        let (t, port) = self.behind(registry, address, |body, port| Some(&body.outputs.get(port)?.port))?;
        t.outputs.iter().find(|p| p.name == port)
    }

    fn behind<'a>(
        &'a self,
        registry: &'a Registry,
        mut address: &'a str,
        inside: fn(&'a Self, &str) -> Option<&'a String>,
    ) -> Option<(&'a NodeType, &'a str)> {
        let (mut body, mut table, mut folder) = (self, self, String::new());
        // Clusters that contain themselves must come to an end too.
        for _ in 0..=DEEPEST {
            let (id, port) = split_port(address)?;
            let node = body.nodes.get(id)?;
            let Some(name) = node.cluster() else {
                return registry.get(&node.type_name).map(|t| (&**t, port));
            };
            match table.clusters.get(name)? {
                Cluster::Here(inner) => body = inner,
                Cluster::File(link) => {
                    let path = join(&folder, &link.file);
                    body = &self.linked.0.get(&path)?.as_ref().ok()?.document;
                    (table, folder) = (body, folder_of(&path).to_owned());
                }
            }
            address = inside(body, port)?;
        }
        None
    }
}

fn named(behind: &Port, name: &str, doc: Option<&str>) -> Port {
    let mut port = behind.clone();
    port.name = name.to_owned().into();
    if let Some(doc) = doc {
        port.doc = doc.to_owned().into();
    }
    port
}

/// A literal's tree as one writes it.
fn literal_of(tree: &Tree, access: Access) -> Option<Json> {
    let (_, column) = tree.branches().first()?;
    let json = column.to_json();
    match json.as_array()?.as_slice() {
        [one] if access == Access::Item => Some(one.clone()),
        _ => Some(json),
    }
}
