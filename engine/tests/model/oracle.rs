//! What a session must come to: a session that has never seen anything but the document as it is now. Nodes that are frozen
//! and have a result are there as constants, since what they keep is history.

use super::world::{Calls, Disk, registry};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use tenon_engine::*;

/// The outputs that a node had last.
#[derive(Clone)]
pub struct Last {
    pub type_name: String,
    pub outputs: Vec<Tree>,
}

/// What came of one node.
pub struct Came {
    pub type_name: String,
    pub happened: Happened,
    pub outputs: Vec<Option<Tree>>,
    pub digest: u128,
}

/// What must come out.
pub struct Expected {
    /// Per node that is needed: what happens to it in a fresh session, its outputs if it has some, and their digest.
    pub nodes: BTreeMap<String, Came>,
    pub diagnostics: Vec<String>,
    pub files: Vec<(String, File)>,
    pub held: BTreeSet<String>,
}

/// No script makes such an id.
const WATCH: &str = "~~~~~~~~~~~~~~~~ watch";

fn held_name(id: &str) -> String {
    format!("~~~~~~~~~~~~ held {id};")
}

fn held_type(id: &str, t: &NodeType, last: &Last) -> NodeType {
    let mut held = NodeType::new(held_name(id), 1);
    for port in t.outputs() {
        held = held.output(port.clone());
    }
    if t.is_writer() {
        held = held.writer();
    }
    let outputs: Vec<(String, Tree)> =
        t.outputs().iter().map(|p| p.name().to_owned()).zip(last.outputs.iter().cloned()).collect();
    held.run(move |c| {
        outputs.iter().for_each(|(port, tree)| c.set_tree(port, tree.clone()));
        Ok(())
    })
}

fn session(document: Document, more: Vec<NodeType>, disk: &Arc<Disk>) -> Session {
    let options = Options { threads: 1, host: disk.clone(), ..Options::default() };
    Session::new(registry(&Arc::new(Calls::default()), more), document, options)
}

fn evaluate(session: &mut Session, targets: &[&str]) -> Report {
    session.evaluate(targets, &Control::default())
}

/// Frozen nodes that have a result to keep, of those that are needed.
fn held<'a>(document: &Document, last: &'a BTreeMap<String, Last>, needed: &Report) -> BTreeMap<String, &'a Last> {
    let frozen = document.nodes().iter().filter(|(_, n)| n.state == NodeState::Frozen);
    let held = frozen.filter_map(|(id, n)| Some((id.clone(), last.get(id).filter(|l| l.type_name == n.type_name)?)));
    held.filter(|(id, _)| needed.node(id).is_some()).collect()
}

/// What must come out of `document` for those targets; `None` where it cannot be said: a node that keeps its result stands in
/// a circle of wires, or an interface input is bound to it.
pub fn expected(
    document: &Document,
    last: &BTreeMap<String, Last>,
    targets: &[String],
    disk: &Arc<Disk>,
) -> Option<Expected> {
    // What instances keep is not followed.
    if document.nodes().values().any(|n| n.cluster().is_some() && n.state == NodeState::Frozen)
        || keeps_inside(document)
    {
        return None;
    }
    let targets: Vec<&str> = targets.iter().map(String::as_str).collect();
    let mut fresh = session(document.clone(), Vec::new(), disk);
    let mut report = evaluate(&mut fresh, &targets);
    let held = held(document, last, &report);
    if !held.is_empty() {
        (fresh, report) = with_constants(document, &held, &targets, fresh, &report, disk)?;
    }
    let mut nodes = BTreeMap::new();
    for node in report.nodes.iter() {
        let t = fresh.registry().get(node.type_name);
        let value = |p: &Port| fresh.value(&format!("{}.{}", node.id, p.name()));
        let outputs = t.map_or_else(Vec::new, |t| t.outputs().iter().map(value).collect());
        let (type_name, happened, digest) = (node.type_name.to_string(), node.happened, node.digest);
        nodes.insert(node.id.to_string(), Came { type_name, happened, outputs, digest });
    }
    nodes.remove(WATCH);
    // A constant goes by the name of what it stands for.
    let words = |d: &Diagnostic| {
        held.iter().fold(d.to_string(), |words, (id, last)| words.replace(&held_name(id), &last.type_name))
    };
    let ids: BTreeSet<String> = held.keys().cloned().collect();
    let diagnostics = report.diagnostics.iter().filter(|d| concerns(d, &ids)).map(words).collect();
    let held = ids;
    Some(Expected { nodes, diagnostics, files: fresh.files(), held })
}

/// What a node has said that keeps its result is history too.
pub fn concerns(d: &Diagnostic, held: &BTreeSet<String>) -> bool {
    d.node.as_deref().is_none_or(|node| node != WATCH && !held.contains(node))
}

fn keeps_inside(document: &Document) -> bool {
    document.clusters.values().any(|c| match c {
        Cluster::Here(body) => body.nodes().values().any(|n| n.state == NodeState::Frozen),
        Cluster::File(_) => false,
    })
}

fn with_constants(
    document: &Document,
    held: &BTreeMap<String, &Last>,
    targets: &[&str],
    fresh: Session,
    report: &Report,
    disk: &Arc<Disk>,
) -> Option<(Session, Report)> {
    let of_held = |address: &String| held.contains_key(address.split('.').next().unwrap_or(""));
    let circle = |d: &Diagnostic| d.code == "cycle" && d.node.as_deref().is_some_and(|n| held.contains_key(n));
    if report.diagnostics.iter().any(circle) || document.inputs.values().any(|i| i.ports.iter().any(of_held)) {
        return None;
    }
    // What the nodes take in is needed, though nobody reads it.
    let mut sources = Wires::default();
    let mut more = Vec::new();
    let mut with = document.clone();
    for (id, last) in held {
        let node = with.nodes().get(id)?.clone();
        for from in node.inputs.values().flat_map(|w| &w.from) {
            let goes = fresh.knows(from).is_ok() && !sources.from.contains(from);
            // A wire that does not fit is none.
            let (gives, takes) = (format!("{from} gives "), format!(", but {id}."));
            let fits = !report.diagnostics.iter().any(|d| d.message.contains(&gives) && d.message.contains(&takes));
            if goes && fits {
                sources.from.push(from.clone());
            }
        }
        let t = fresh.registry().get(&node.type_name)?;
        let constant = held_type(id, t, last);
        let mut node = Node::new(constant.type_name());
        node.more.note = Some("kept".into());
        more.push(constant);
        with.insert(id.clone(), node).ok()?;
    }
    more.push(
        NodeType::new("~~~~~~~~~~~~ watch", 1)
            .input(Port::any("in", Access::List).optional())
            .output(Port::item::<i64>("count"))
            .run(|_| Ok(())),
    );
    let mut watch = Node::new("~~~~~~~~~~~~ watch");
    if !sources.from.is_empty() {
        watch.inputs.insert("in", sources);
    }
    with.insert(WATCH, watch).ok()?;
    let watched = format!("{WATCH}.count");
    let mut targets = targets.to_vec();
    if !targets.is_empty() {
        targets.push(&watched);
    } else {
        let writers =
            document.nodes().values().any(|n| fresh.registry().get(&n.type_name).is_some_and(|t| t.is_writer()));
        if writers || !document.outputs.is_empty() {
            let mut output = InterfaceOutput::default();
            output.port = watched.clone();
            with.outputs.insert(WATCH.into(), output);
        }
    }
    let mut fresh = session(with, more, disk);
    let report = evaluate(&mut fresh, &targets);
    Some((fresh, report))
}
