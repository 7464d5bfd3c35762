//! Random edit scripts. A step stays meaningful when others are taken out of the script, so failing ones can be shrunk.

use super::world::{LIBRARY, TYPES, ports_of};
use serde_json::json;
use tenon_engine::*;

/// One step.
#[derive(Clone, Debug)]
pub enum Step {
    /// `Session::edit`, one step of the history.
    Edit(Operation),
    /// `Session::set`.
    Set(String, Json),
    /// The document is written, read and handed over whole.
    Reload,
    Begin,
    Commit,
    Undo,
    Redo,
    /// The nodes of the first few ids copied and pasted.
    Paste(Vec<String>),
    /// A file gets other content, or goes.
    File(String, Option<usize>),
    /// These nodes become a cluster of that name, with an instance of that id.
    Gather(Vec<String>, String, String),
    /// An instance is taken apart.
    Explode(String),
    /// From now on there is room for so many bytes in the cache, where it is not to keep everything.
    Room(usize),
    /// The file that clusters are linked from changes, or goes.
    Library(Option<f64>),
    Evaluate(Vec<String>),
    /// An evaluation that is cancelled from within its n-th call of a node.
    Cancel(usize, Vec<String>),
}

/// Choices from a seed.
pub struct Dice(Random);

impl Dice {
    pub fn new(seed: i64) -> Self {
        Self(Random::new(seed))
    }

    pub fn below(&mut self, n: usize) -> usize {
        (self.0.next().unwrap_or(0.0) * n as f64) as usize
    }

    fn of<'a, T>(&mut self, all: &'a [T]) -> &'a T {
        &all[self.below(all.len())]
    }

    fn chance(&mut self, percent: usize) -> bool {
        self.below(100) < percent
    }
}

const IDS: usize = 11;

fn id(dice: &mut Dice) -> String {
    format!("n{}", dice.below(IDS))
}

/// A node that is there, mostly.
fn known(dice: &mut Dice, document: &Document) -> String {
    let ids: Vec<&String> = document.nodes().keys().collect();
    if ids.is_empty() || dice.chance(3) { id(dice) } else { (*dice.of(&ids)).clone() }
}

fn one(dice: &mut Dice, all: &[String], or: &str) -> String {
    if all.is_empty() { or.to_owned() } else { dice.of(all).clone() }
}

fn input_of(dice: &mut Dice, document: &Document, node: &str) -> String {
    let found = document.nodes().get(node).map(|n| ports_of(document, &n.type_name).0).unwrap_or_default();
    if dice.chance(2) { "nowhere".into() } else { one(dice, &found, "a") }
}

/// An output of another node; hardly ever one that makes a circle.
fn source(dice: &mut Dice, document: &Document, of: &str) -> String {
    let earlier: Vec<&String> = document.nodes().keys().filter(|k| dice.below(40) == 0 || k.as_str() < of).collect();
    if earlier.is_empty() {
        return format!("{}.value", id(dice));
    }
    let node = *dice.of(&earlier);
    let ports = document.nodes().get(node).map(|n| ports_of(document, &n.type_name).1).unwrap_or_default();
    let port = one(dice, &ports, "value");
    format!("{node}.{port}")
}

fn value(dice: &mut Dice) -> Json {
    match dice.below(40) {
        0..19 => json!(dice.of(&[-4.0, -1.0, 0.0, 0.5, 1.0, 1.7, 2.0, 3.0, 3.5, 5.0])),
        19..23 => json!(dice.below(5)),
        23..32 => (0..dice.below(4)).map(|_| json!(dice.below(7) as f64 - 2.0)).collect(),
        32 | 33 => json!(13.0),
        34..37 => json!(dice.of(&["in0 * 2", "in1 + 1", "in0 / 4", "in0 mm"])),
        37 => json!(dice.of(&["what", "a.txt", "b.txt"])),
        38 => json!([1.0, null, -2.0]),
        _ => Json::Null,
    }
}

fn node(dice: &mut Dice, document: &Document, id: &str) -> Node {
    let (type_name, inputs, _) = dice.of(&TYPES);
    let mut node = Node::new(if dice.chance(2) { "nobody/knows" } else { *type_name });
    // Half of the nodes can be told apart by their calls, the other half share results.
    if dice.chance(50) {
        let tag = 1 + id.bytes().map(i64::from).sum::<i64>() + 1000 * dice.below(1000) as i64;
        node.params.insert("tag", json!(tag));
    }
    for port in *inputs {
        // Its defaults are lists of different lengths.
        if *type_name == "grid" && dice.chance(60) {
            continue;
        }
        if *port == "path" {
            node.params.insert("path", json!(dice.of(&["a.txt", "b.txt", "c.txt"])));
        } else if dice.chance(60) && !document.nodes().is_empty() {
            node.inputs.insert(*port, wires(dice, document, id));
        } else if dice.chance(70) {
            node.params.insert(*port, value(dice));
        }
    }
    if dice.chance(15) {
        node.matching = matching(dice);
    }
    if dice.chance(5) {
        node.state = state(dice);
    }
    node
}

/// An instance of one of the clusters that are there.
fn instance(dice: &mut Dice, document: &Document, id: &str) -> Option<Node> {
    let names: Vec<&String> = document.clusters.keys().collect();
    if names.is_empty() {
        return None;
    }
    let mut node = Node::instance(names[dice.below(names.len())]);
    for port in ports_of(document, &node.type_name).0 {
        if dice.chance(60) {
            node.inputs.insert(port, wires(dice, document, id));
        } else if dice.chance(50) {
            node.params.insert(port, value(dice));
        }
    }
    Some(node)
}

/// Something done to a node within a cluster, and seldom to the cluster itself.
fn in_cluster(dice: &mut Dice, document: &Document) -> Option<Operation> {
    let names: Vec<&String> = document.clusters.keys().collect();
    if names.is_empty() {
        return None;
    }
    let name = (*dice.of(&names)).clone();
    if dice.chance(8) {
        return Some(Operation::SetCluster { name, cluster: None });
    }
    let Some(Cluster::Here(body)) = document.clusters.get(&name) else { return None };
    let node = known(dice, body);
    let operation = match dice.below(10) {
        0..6 => {
            Operation::SetParam { port: input_of(dice, body, &node), value: dice.chance(80).then(|| value(dice)), node }
        }
        6 => Operation::Connect { port: input_of(dice, body, &node), from: source(dice, body, &node), at: None, node },
        7 => Operation::SetState { node, state: *dice.of(&[NodeState::On, NodeState::Disabled, NodeState::Bypassed]) },
        8 => Operation::RemoveNode { id: node },
        _ => {
            let id = id(dice);
            Operation::AddNode { node: Box::new(self::node(dice, body, &id)), id }
        }
    };
    // What is in a cluster keeps nothing: it would be another one's in every instance.
    let frozen = |o: &Operation| matches!(o, Operation::AddNode { node, .. } if node.state == NodeState::Frozen);
    (!frozen(&operation)).then(|| Operation::InCluster { name, operation: Box::new(operation) })
}

/// Nodes become a cluster; those that are frozen are left alone.
fn gather(dice: &mut Dice, shadow: &mut Document) -> Step {
    let mut ids: Vec<String> = (0..1 + dice.below(4)).map(|_| known(dice, shadow)).collect();
    ids.retain(|id| shadow.nodes().get(id).is_none_or(|n| n.state != NodeState::Frozen));
    let (name, instance) = (format!("c{}", dice.below(4)), id(dice));
    let names: Vec<&str> = ids.iter().map(String::as_str).collect();
    if let Ok(operation) = shadow.gather(&names, &name, &instance) {
        let _ = operation.apply(shadow);
    }
    Step::Gather(ids, name, instance)
}

fn wires(dice: &mut Dice, document: &Document, of: &str) -> Wires {
    let mut wires = Wires::default();
    let count = if dice.chance(25) { 2 } else { 1 };
    wires.from = (0..count).map(|_| source(dice, document, of).into()).collect();
    if dice.chance(20) {
        wires.more.tree.push(*dice.of(&[TreeOp::Graft, TreeOp::Flatten, TreeOp::Simplify, TreeOp::Reverse]));
    }
    if dice.chance(10) {
        wires.more.matching = matching(dice);
    }
    wires
}

fn matching(dice: &mut Dice) -> Option<Matching> {
    *dice.of(&[None, Some(Matching::Longest), Some(Matching::Shortest), Some(Matching::Cross)])
}

fn state(dice: &mut Dice) -> NodeState {
    use NodeState::{Bypassed, Disabled, Frozen, On};
    *dice.of(&[On, On, Frozen, Frozen, Disabled, Bypassed])
}

fn operation(dice: &mut Dice, document: &Document) -> Operation {
    use Operation as O;
    let node_id = known(dice, document);
    match dice.below(58) {
        0..7 => {
            let id = id(dice);
            O::AddNode { node: Box::new(node(dice, document, &id)), id }
        }
        48..52 => {
            let id = id(dice);
            let made = instance(dice, document, &id).unwrap_or_else(|| node(dice, document, &id));
            O::PutNode { node: Some(Box::new(made)), id }
        }
        52 => {
            let cluster = Some(Box::new(Cluster::File(Link::new(LIBRARY))));
            O::SetCluster { name: format!("l{}", dice.below(2)), cluster }
        }
        53..58 => in_cluster(dice, document).unwrap_or_else(|| O::SetNote { node: node_id, note: None }),
        7 | 8 => O::RemoveNode { id: node_id },
        9 => O::PutNode { node: Some(Box::new(node(dice, document, &node_id))), id: node_id },
        10 => O::Rename { from: node_id, to: id(dice) },
        11..16 => O::Connect {
            port: input_of(dice, document, &node_id),
            from: source(dice, document, &node_id),
            at: dice.chance(30).then_some(0),
            node: node_id,
        },
        16..18 => {
            let wired: Vec<(String, String)> = document.nodes().get(&node_id).map_or_else(Vec::new, |n| {
                n.inputs.iter().flat_map(|(p, w)| w.from.iter().map(|f| (p.to_string(), f.to_string()))).collect()
            });
            let gone = ("a".to_owned(), "n0.value".to_owned());
            let (port, from) = if wired.is_empty() { gone } else { dice.of(&wired).clone() };
            O::Disconnect { node: node_id, port, from }
        }
        18..20 => O::PutWires {
            port: input_of(dice, document, &node_id),
            wires: dice.chance(70).then(|| wires(dice, document, &node_id)),
            node: node_id,
        },
        20..32 => O::SetParam {
            port: input_of(dice, document, &node_id),
            value: dice.chance(85).then(|| value(dice)),
            node: node_id,
        },
        // Where it matters: at nodes with several ports.
        32 => {
            let several = document.nodes().iter().filter(|(_, n)| n.type_name == "grid").map(|(id, _)| id);
            let ids: Vec<&String> = several.collect();
            let node = if ids.is_empty() { node_id } else { (*dice.of(&ids)).clone() };
            O::SetMatching { node, matching: matching(dice) }
        }
        // The same wires in another shape.
        33 => {
            let found = document.nodes().get(&node_id).and_then(|n| n.inputs.iter().next());
            let (port, mut wires) = found.map_or_else(Default::default, |(p, w)| (p.to_string(), w.clone()));
            wires.more.tree = vec![*dice.of(&[TreeOp::Graft, TreeOp::Flatten, TreeOp::Simplify, TreeOp::Reverse])];
            O::PutWires { node: node_id, port, wires: Some(wires) }
        }
        34..41 => {
            let is_instance = document.nodes().get(&node_id).is_some_and(|n| n.cluster().is_some());
            let state = match state(dice) {
                NodeState::Frozen if is_instance => NodeState::Bypassed,
                state => state,
            };
            O::SetState { node: node_id, state }
        }
        41 => O::SetNote { node: node_id, note: Some("remark".into()) },
        42 => O::Move { node: node_id, to: Some([1.0, 2.0]) },
        43 => {
            let nodes = (0..2).map(|_| known(dice, document)).collect();
            O::SetGroup { name: "g".into(), nodes: dice.chance(70).then_some(nodes) }
        }
        44..46 => {
            let mut input = InterfaceInput::default();
            let bound = |dice: &mut Dice| {
                let node = known(dice, document);
                format!("{node}.{}", input_of(dice, document, &node))
            };
            input.ports = (0..1 + dice.below(2)).map(|_| bound(dice)).collect();
            input.max = dice.chance(20).then_some(3.0);
            O::SetInput { name: format!("in{}", dice.below(2)), input: dice.chance(85).then_some(input) }
        }
        _ => {
            let mut output = InterfaceOutput::default();
            output.port = source(dice, document, "z");
            O::SetOutput { name: format!("out{}", dice.below(2)), output: dice.chance(50).then_some(output) }
        }
    }
}

fn targets(dice: &mut Dice, document: &Document) -> Vec<String> {
    match dice.below(10) {
        0..5 => Vec::new(),
        5 => document.outputs.keys().cloned().collect(),
        _ => (0..1 + dice.below(3)).map(|_| source(dice, document, "z")).collect(),
    }
}

fn parameter(dice: &mut Dice, shadow: &mut Document) -> Step {
    let node = known(dice, shadow);
    let port = input_of(dice, shadow, &node);
    let operation = Operation::SetParam { node, port, value: dice.chance(90).then(|| value(dice)) };
    let _ = operation.apply(shadow);
    Step::Edit(operation)
}

fn set(dice: &mut Dice, shadow: &Document) -> Step {
    let names: Vec<String> = shadow.inputs.keys().cloned().collect();
    let node = known(dice, shadow);
    let port = format!("{node}.{}", input_of(dice, shadow, &node));
    let name = if names.is_empty() || dice.chance(40) { port } else { dice.of(&names).clone() };
    Step::Set(name, value(dice))
}

fn explode(dice: &mut Dice, shadow: &mut Document) -> Step {
    let ids: Vec<String> =
        shadow.nodes().iter().filter(|(_, n)| n.cluster().is_some()).map(|(id, _)| id.clone()).collect();
    let id = one(dice, &ids, "n0");
    if let Ok(paste) = shadow.explode(&id, &super::world::plain()) {
        let _ = paste.operation.apply(shadow);
    }
    Step::Explode(id)
}

/// The same wires in one shape and then in another: only the kind of what is done to the tree differs.
fn shapes(dice: &mut Dice, shadow: &mut Document) -> Vec<Step> {
    let all = [TreeOp::Graft, TreeOp::Flatten, TreeOp::Simplify, TreeOp::Reverse];
    let wired: Vec<(String, String, Wires)> = shadow
        .nodes()
        .iter()
        .flat_map(|(id, n)| n.inputs.iter().map(move |(port, wires)| (id.clone(), port.to_string(), wires.clone())))
        .collect();
    if wired.is_empty() {
        return Vec::new();
    }
    let (node, port, mut wires) = dice.of(&wired).clone();
    let mut steps = Vec::new();
    for _ in 0..2 {
        wires.more.tree = vec![*dice.of(&all)];
        let operation = Operation::PutWires { node: node.clone(), port: port.clone(), wires: Some(wires.clone()) };
        let _ = operation.apply(shadow);
        steps.extend([Step::Edit(operation), Step::Evaluate(Vec::new())]);
    }
    steps
}

/// About `length` steps: bursts of edits, each followed by an evaluation.
pub fn script(seed: i64, length: usize) -> Vec<Step> {
    let mut dice = Dice::new(seed);
    // What the script has made so far, so that most of its steps find what they name.
    let mut shadow = Document::new();
    let mut steps = Vec::new();
    let edit = |dice: &mut Dice, shadow: &mut Document| {
        let operation = if dice.chance(6) {
            Operation::All((0..dice.below(4)).map(|_| operation(dice, shadow)).collect())
        } else {
            operation(dice, shadow)
        };
        // Refused ones stay in the script: they must change nothing.
        let _ = operation.apply(shadow);
        Step::Edit(operation)
    };
    for i in 0..9 {
        let id = format!("n{}", (i * 7) % IDS);
        let operation = Operation::AddNode { node: Box::new(node(&mut dice, &shadow, &id)), id };
        let _ = operation.apply(&mut shadow);
        steps.push(Step::Edit(operation));
    }
    while steps.len() < length {
        // After half of the evaluations nothing is rewired: then only what changes may be looked at.
        let quiet = dice.chance(50);
        for _ in 0..1 + dice.below(4) {
            let step = match dice.below(if quiet { 60 } else { 100 }) {
                0..40 => parameter(&mut dice, &mut shadow),
                40..50 => set(&mut dice, &shadow),
                50..60 => {
                    let name = (*dice.of(&["a.txt", "a.txt", "b.txt"])).to_owned();
                    Step::File(name, dice.chance(85).then(|| dice.below(5)))
                }
                60..64 => Step::Undo,
                64 | 65 => Step::Redo,
                66 => Step::Reload,
                67 if dice.chance(50) => Step::Room(*dice.of(&[0, 300, 1500, 6000])),
                67 => Step::Begin,
                68 => Step::Commit,
                70..76 => gather(&mut dice, &mut shadow),
                76 | 77 => explode(&mut dice, &mut shadow),
                78 | 79 => Step::Library(dice.chance(85).then(|| dice.below(3) as f64)),
                69 => Step::Paste((0..2).map(|_| known(&mut dice, &shadow)).collect()),
                _ => edit(&mut dice, &mut shadow),
            };
            steps.push(step);
        }
        if dice.chance(12) {
            let targets = targets(&mut dice, &shadow);
            steps.push(Step::Cancel(1 + dice.below(8), targets.clone()));
            // Back to what was before, and on to it again: nothing of what was cancelled may have stayed.
            if dice.chance(50) {
                steps.extend([Step::Undo, Step::Evaluate(targets.clone()), Step::Redo, Step::Evaluate(targets)]);
            }
        }
        if dice.chance(12) {
            steps.extend(shapes(&mut dice, &mut shadow));
        }
        steps.push(Step::Evaluate(targets(&mut dice, &shadow)));
    }
    steps.push(Step::Evaluate(Vec::new()));
    steps
}
