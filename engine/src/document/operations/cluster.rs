//! The table of clusters under change: putting a definition or a link in its place, and editing inside a definition.

use super::super::cluster::{Cluster, is_version};
use super::super::literal::Literal;
use super::super::load::check_foreign;
use super::super::model::{Document, valid_id};
use super::Operation;
use super::apply::{Edit, apply_at, check_address, check_depth, check_input, check_wires, put, refuse};
use crate::diagnostic::{Diagnostic, did_you_mean};
use crate::value::Json;

/// Levels of braces between a file and what stands in one of its clusters.
const INSIDE: usize = 2;

impl Edit<'_> {
    pub(super) fn set_cluster(&mut self, name: &str, cluster: Option<&Cluster>) -> Result<(), Diagnostic> {
        if self.above > 0 {
            return refuse("cluster-in-cluster", "clusters stand at the top of the file, not in a cluster".into());
        }
        let cluster = cluster.map(|cluster| checked(name, cluster)).transpose()?;
        let old = put(&mut self.document.clusters, name, cluster);
        self.undo.push(Operation::SetCluster { name: name.into(), cluster: old.map(Box::new) });
        Ok(())
    }

    pub(super) fn in_cluster(&mut self, name: &str, operation: &Operation) -> Result<(), Diagnostic> {
        match self.document.clusters.get_mut(name) {
            Some(Cluster::Here(body)) => {
                let inverse = apply_at(operation, body, self.above + INSIDE)?;
                self.undo.push(Operation::InCluster { name: name.into(), operation: Box::new(inverse) });
                Ok(())
            }
            Some(Cluster::File(link)) => {
                let message = format!("cluster \"{name}\" stands in {}", link.file);
                Err(Diagnostic::error("linked-cluster", message)
                    .hint("edit that file, or take the cluster into this one"))
            }
            None => {
                let hint = did_you_mean(name, self.document.clusters.keys().map(String::as_str));
                let message = format!("no cluster is called \"{name}\"");
                Err(Diagnostic::error("unknown-cluster", message).maybe_hint(hint))
            }
        }
    }
}

/// A cluster that can be written to a file and read back the same.
fn checked(name: &str, cluster: &Cluster) -> Result<Cluster, Diagnostic> {
    match cluster {
        Cluster::File(link) => {
            if link.version == Some(0) {
                return refuse("bad-version", format!("the version of cluster \"{name}\" must be a number from 1"));
            }
            link.extra.values().try_for_each(|v| check_depth(v, INSIDE))?;
            Ok(cluster.clone())
        }
        Cluster::Here(body) => {
            check_body(name, body)?;
            let mut body = body.clone();
            body.linked = Default::default();
            body.nodes.values_mut().for_each(|node| node.check_source());
            let nodes = &body.nodes;
            body.layout.positions.retain(|id, _| nodes.contains_key(id));
            body.layout.looks.retain(|id, look| nodes.contains_key(id) && *look != Default::default());
            Ok(Cluster::Here(body))
        }
    }
}

fn check_body(name: &str, body: &Document) -> Result<(), Diagnostic> {
    if !body.clusters.is_empty() {
        let message = format!("cluster \"{name}\" has clusters of its own; they stand at the top of the file");
        return refuse("cluster-in-cluster", message);
    }
    for (id, node) in &body.nodes {
        if !valid_id(id) || node.version == 0 {
            return refuse("bad-id", format!("node \"{id}\" of cluster \"{name}\" has no possible id or version"));
        }
        node.params.values().filter_map(Literal::nested).try_for_each(|v| check_depth(v, 4 + INSIDE))?;
        node.more.extra.values().try_for_each(|v| check_depth(v, 3 + INSIDE))?;
        node.inputs.values().try_for_each(check_wires)?;
    }
    body.inputs.iter().try_for_each(|(input, i)| check_input(input, i))?;
    body.outputs.values().try_for_each(|o| check_address(&o.port))?;
    let tables = [&body.requires, &body.groups, &body.interface_extra];
    tables.into_iter().flat_map(|t| t.values()).try_for_each(|v| check_depth(v, 2 + INSIDE))?;
    body.extra.values().try_for_each(|v| check_depth(v, 1 + INSIDE))?;
    if let Some(key) = body.extra.keys().find(|key| CLUSTER_KEYS.contains(&key.as_str())) {
        return refuse("reserved-key", format!("\"{key}\" has a meaning of its own in a cluster"));
    }
    body.interface_extra.iter().try_for_each(|(key, value)| check_interface_key(key, value))?;
    body.foreign.as_deref().map_or(Ok(()), |text| check_foreign(text, INSIDE))
}

/// Keys of a cluster that have a meaning of their own.
pub(super) const CLUSTER_KEYS: &[&str] = &["file", "clusters", "requires", "groups", "x", "interface", "nodes"];

/// Refuses what the file's reader would refuse in an interface.
pub(super) fn check_interface_key(key: &str, value: &Json) -> Result<(), Diagnostic> {
    match key {
        "version" if !is_version(value) => {
            refuse("bad-version", format!("the version of an interface must be a whole number from 1, not {value}"))
        }
        "doc" if !value.is_string() => refuse("bad-doc", "the doc of an interface must be text".into()),
        _ => Ok(()),
    }
}
