//! Migrations: nodes written for older versions of their types, brought to today's, one version at a time.

use super::cluster::{Cluster, PREFIX};
use super::format::node_text;
use super::load::{object_of, read_node};
use super::model::{Document, Node};
use crate::diagnostic::{Diagnostic, Severity};
use crate::registry::Registry;
use crate::value::Json;
use std::sync::Arc;

impl Document {
    /// Brings every node of an older version as far forward as the registry has steps for, and says which: a note for each
    /// node that was changed, an error for each whose step failed; that one stays as it was. Nodes of unknown types
    /// and of today's version stay byte for byte. O(nodes + text of what is migrated).
    pub fn migrate(&mut self, registry: &Registry) -> Vec<Diagnostic> {
        let mut all = self.migrate_own(registry);
        for (name, cluster) in &mut self.clusters {
            if let Cluster::Here(body) = cluster {
                all.extend(within(name, body.migrate_own(registry)));
            }
        }
        for (path, file) in &mut self.linked.0 {
            // What is read here is not saved here, so only failures are told.
            if let Ok(file) = file
                && file.document.needs_migration(registry)
            {
                let told = Arc::make_mut(file).document.migrate(registry);
                all.extend(within(path, told.into_iter().filter(|d| d.severity == Severity::Error).collect()));
            }
        }
        all
    }

    fn migrate_own(&mut self, registry: &Registry) -> Vec<Diagnostic> {
        let mut all = Vec::new();
        for (id, node) in self.nodes.iter_mut().filter(|(_, node)| is_old(node, registry)) {
            match forward(node, registry) {
                Ok(new) => {
                    let message =
                        format!("brought from version {} of \"{}\" to {}", node.version, node.type_name, new.version);
                    let note = Diagnostic::error("migrated-node", message).with_severity(Severity::Note);
                    all.push(note.at(id).hint("save the graph to keep it so"));
                    *node = new;
                }
                Err(why) => {
                    let message =
                        format!("version {} of \"{}\" cannot be brought forward: {why}", node.version, node.type_name);
                    all.push(Diagnostic::error("migration-failed", message).at(id));
                }
            }
        }
        all
    }

    /// True if [`Document::migrate`] has something to do. O(nodes).
    pub(crate) fn needs_migration(&self, registry: &Registry) -> bool {
        let clusters = self.clusters.values().any(|cluster| match cluster {
            Cluster::Here(body) => body.nodes.values().any(|node| is_old(node, registry)),
            Cluster::File(_) => false,
        });
        let mut linked = self.linked.0.values().flatten();
        clusters
            || self.nodes.values().any(|node| is_old(node, registry))
            || linked.any(|file| file.document.needs_migration(registry))
    }
}

/// Diagnostics of a cluster's nodes as those of the file that it stands in.
fn within(cluster: &str, told: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let place = |d: Diagnostic| {
        let node = d.node.clone().unwrap_or_default();
        let node = match node.strip_prefix(PREFIX) {
            Some(inner) => format!("{cluster}:{inner}"),
            None => format!("{cluster}/{node}"),
        };
        d.at(format!("{PREFIX}{node}"))
    };
    told.into_iter().map(place).collect()
}

fn is_old(node: &Node, registry: &Registry) -> bool {
    registry.get(&node.type_name).is_some_and(|t| node.version < t.version)
        && registry.migration(&node.type_name, node.version).is_some()
}

/// The node after all steps that there are.
fn forward(node: &Node, registry: &Registry) -> Result<Node, String> {
    let newest = registry.get(&node.type_name).map_or(0, |t| t.version);
    let mut json = Json::Object(object_of(&node_text(node, 0)).ok_or("it cannot be written as JSON")?);
    let mut version = node.version;
    while version < newest {
        let Some(step) = registry.migration(&node.type_name, version) else { break };
        json = step(json)?;
        let Some(object) = json.as_object_mut() else { return Err("the step gives no object".into()) };
        if object.get("type").and_then(Json::as_str) != Some(&node.type_name) {
            return Err("the step changes the type".into());
        }
        version += 1;
        object.insert("v".into(), version.into());
    }
    let mut new = read_node(&json.to_string()).ok_or("the step gives no node")?;
    // Text made here is nobody's spacing.
    new.forget_source();
    Ok(new)
}
