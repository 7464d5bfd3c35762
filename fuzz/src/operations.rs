//! Random operations on a small document: refused without a trace, or done and taken back byte for byte.

use super::bytes::Bytes;
use super::registry;
use tenon_engine::{
    Document, History, InterfaceInput, InterfaceOutput, Json, Look, Matching, Node, NodeState, Operation, OuterWires,
    Table, TreeOp, Wires,
};

const IDS: [&str; 9] = ["a", "b", "c", "u", "new", "b-2", "", "x.y", "ä ß"];
const PORTS: [&str; 7] = ["value", "numbers", "start", "in", "", "count", "a.b"];
const SOURCES: [&str; 9] =
    ["a.value", "b.numbers", "c.value", "u.out", "gone.value", "nodot", ".x", "b.start", "new.value"];
const NAMES: [&str; 6] = ["g", "h", "nodes", "format", "inputs", ""];
const FOREIGN: [&str; 6] = ["{ \"k\":  1 }", "[", "1 2", "\"t\"", "{}, \"nodes\": {}", "null"];

const START: &str = r#"{"format": "tenon", "x": {"kept":   [1, 2]}, "later": 3,
    "interface": {"more": 1, "inputs": {"g": {"port": ["a.value", "b.start"], "min": 0}}, "outputs": {"h": {"port": "b.numbers"}}},
    "groups": {"g": {"nodes": ["a", "b"], "colour": "red"}},
    "nodes": {
        "a": {"type": "number", "params": {"value": "2 cm"}},
        "b": {"type": "series", "inputs": {"start": {"from": ["a.value"], "tree": ["graft"]}}, "x-key": 1},
        "c": {"type": "number"},
        "u": {"type":   "nobody/knows", "v": 7, "params": {"z": 1, "a": [1,  2.50]}, "inputs": {"in": {"from": ["b.numbers"]}}}
    }}"#;

fn name(b: &mut Bytes<'_>, all: &[&str]) -> String {
    (*b.of(all)).to_owned()
}

fn value(b: &mut Bytes<'_>) -> Json {
    match b.below(9) {
        0 => Json::Null,
        1 => Json::from(f64::from(b.byte()) / 8.0),
        2 => Json::from("a * 2"),
        3 => Json::from(vec![1, 2, 3]),
        4 => serde_json::json!({"value": 12, "unit": "mm"}),
        5 => Json::from(-0.0),
        6 => serde_json::json!({"nodes": ["a", "gone", 3], "z": {"b": 1, "a": 2}}),
        7 => Json::from(u64::MAX),
        _ => {
            // Nested around the limit.
            (0..90 + b.below(20)).fold(Json::from(1), |inner, _| Json::Array(vec![inner]))
        }
    }
}

fn wires(b: &mut Bytes<'_>) -> Wires {
    let mut wires = Wires::default();
    wires.from.extend((0..b.below(4)).map(|_| name(b, &SOURCES).into()));
    let ops = [TreeOp::Graft, TreeOp::Flatten, TreeOp::Simplify, TreeOp::Reverse];
    wires.more.tree.extend((0..b.below(3)).map(|_| *b.of(&ops)));
    wires.more.matching = matching(b);
    wires
}

fn matching(b: &mut Bytes<'_>) -> Option<Matching> {
    [None, Some(Matching::Longest), Some(Matching::Shortest), Some(Matching::Cross)][b.below(4)]
}

fn node(b: &mut Bytes<'_>, document: &Document) -> Box<Node> {
    let known = document.nodes().values().nth(b.below(6)).cloned();
    let mut node = known.unwrap_or_else(|| Node::new(if b.below(2) == 0 { "series" } else { "what?" }));
    match b.below(6) {
        0 => node.version = u32::from(b.byte()),
        1 => {
            node.params.insert(name(b, &PORTS), value(b));
        }
        2 => {
            node.inputs.insert(name(b, &PORTS), wires(b));
        }
        3 => node.more.note = Some("note \" \n".into()),
        _ => {}
    }
    Box::new(node)
}

fn input(b: &mut Bytes<'_>) -> InterfaceInput {
    let ports = (0..b.below(3)).map(|_| name(b, &SOURCES)).collect();
    let ends = [None, Some(0.0), Some(-0.0), Some(f64::NAN), Some(f64::INFINITY), Some(1e300)];
    let mut input = InterfaceInput::default();
    (input.ports, input.min, input.max) = (ports, *b.of(&ends), *b.of(&ends));
    input.step = *b.of(&ends);
    input
}

fn operation(b: &mut Bytes<'_>, document: &Document, depth: usize) -> Operation {
    use Operation as O;
    let tables = [Table::Requires, Table::Groups, Table::Interface, Table::Top, Table::Layout];
    let maybe = b.below(4) > 0;
    match b.below(20) {
        0 => O::AddNode { id: name(b, &IDS), node: node(b, document) },
        1 => O::RemoveNode { id: name(b, &IDS) },
        2 => O::PutNode { id: name(b, &IDS), node: maybe.then(|| node(b, document)) },
        3 => O::Rename { from: name(b, &IDS), to: name(b, &IDS) },
        4 => O::Connect {
            node: name(b, &IDS),
            port: name(b, &PORTS),
            from: name(b, &SOURCES),
            at: maybe.then(|| b.below(5)),
        },
        5 => O::Disconnect { node: name(b, &IDS), port: name(b, &PORTS), from: name(b, &SOURCES) },
        6 => O::PutWires { node: name(b, &IDS), port: name(b, &PORTS), wires: maybe.then(|| wires(b)) },
        7 | 8 => O::SetParam { node: name(b, &IDS), port: name(b, &PORTS), value: maybe.then(|| value(b)) },
        9 => O::SetMatching { node: name(b, &IDS), matching: matching(b) },
        10 => {
            let states = [NodeState::On, NodeState::Frozen, NodeState::Disabled];
            O::SetState { node: name(b, &IDS), state: *b.of(&states) }
        }
        11 => O::SetNote { node: name(b, &IDS), note: maybe.then(|| name(b, &IDS)) },
        12 => {
            let nodes = maybe.then(|| (0..b.below(4)).map(|_| name(b, &IDS)).collect());
            O::SetGroup { name: name(b, &NAMES), nodes }
        }
        13 => O::SetInput { name: name(b, &NAMES), input: maybe.then(|| input(b)) },
        14 => {
            let mut output = InterfaceOutput::default();
            output.port = name(b, &SOURCES);
            O::SetOutput { name: name(b, &NAMES), output: maybe.then_some(output) }
        }
        15 => O::SetEntry { table: *b.of(&tables), key: name(b, &NAMES), value: maybe.then(|| value(b)) },
        16 => O::SetForeign { text: maybe.then(|| name(b, &FOREIGN)) },
        17 => {
            let ends = [0.0, -0.0, f64::NAN, 1e308, -3.5];
            O::Move { node: name(b, &IDS), to: maybe.then(|| [*b.of(&ends), *b.of(&ends)]) }
        }
        18 => {
            let look = Look { shown: *b.of(&[None, Some(true), Some(false)]), open: maybe };
            O::SetLook { node: name(b, &IDS), look }
        }
        _ if depth > 3 => O::All(Vec::new()),
        _ => O::All((0..b.below(5)).map(|_| operation(b, document, depth + 1)).collect()),
    }
}

/// All that is written of a document.
fn written(document: &Document) -> (String, String) {
    (document.to_string_canonical_for(registry()), document.layout_to_string())
}

fn read_back(text: &(String, String)) -> Document {
    let read = Document::from_slice(text.0.as_bytes());
    let mut document = read.unwrap_or_else(|e| panic!("what was written is not read: {e:?}\n{}", text.0));
    document.read_layout(text.1.as_bytes()).unwrap_or_else(|e| panic!("{e}\n{}", text.1));
    document
}

pub fn check(bytes: &[u8]) {
    let mut b = Bytes(bytes);
    let Ok(start) = Document::from_slice(START.as_bytes()) else { panic!("the start is a graph") };
    let mut document = start.clone();
    let mut history = History::with_limit(0);
    let mut clipboard = Document::new();
    for _ in 0..16 {
        if b.is_empty() {
            break;
        }
        let before = written(&document);
        match b.below(10) {
            0 => {
                let ids: Vec<&str> = (0..b.below(4)).map(|_| *b.of(&IDS)).collect();
                if let Ok(fragment) = document.copy(&ids) {
                    read_back(&written(&fragment));
                    clipboard = fragment;
                }
                continue;
            }
            1 => {
                let outer = if b.below(2) == 0 { OuterWires::Keep } else { OuterWires::Drop };
                let paste = document.paste(&clipboard, outer, [1.0, 2.0]).operation;
                let inverse = paste.apply(&mut document).unwrap_or_else(|e| panic!("a paste is refused: {e}"));
                history.record(inverse);
            }
            2 => {
                let moved = if b.below(2) == 0 { history.undo(&mut document) } else { history.redo(&mut document) };
                moved.unwrap_or_else(|e| panic!("what was done cannot be taken back: {e}"));
            }
            3 => {
                if b.below(2) == 0 {
                    history.begin()
                } else {
                    history.commit()
                }
                continue;
            }
            _ => {
                let operation = operation(&mut b, &document, 0);
                match operation.apply(&mut document) {
                    Err(refused) => {
                        assert!(!refused.message.is_empty());
                        assert_eq!(written(&document), before, "{operation:?} was refused and changed something");
                        continue;
                    }
                    Ok(inverse) => {
                        let mut back = document.clone();
                        inverse.apply(&mut back).unwrap_or_else(|e| panic!("{operation:?} cannot be taken back: {e}"));
                        assert_eq!(written(&back), before, "{operation:?} is not taken back whole");
                        history.record(inverse);
                    }
                }
            }
        }
        let after = written(&document);
        let again = read_back(&after);
        assert_eq!(written(&again), after);
    }
    let _ = document.validate(registry());
    let last = written(&document);
    let mut built = start.clone();
    for operation in start.diff(&document) {
        operation.apply(&mut built).unwrap_or_else(|e| panic!("a difference is refused: {e}"));
    }
    assert_eq!(written(&built), last);
    let undone = history.steps().1;
    while history.undo(&mut document).unwrap_or_else(|e| panic!("what was done cannot be taken back: {e}")) {}
    assert_eq!(written(&document), written(&start));
    while history.steps().1 > undone {
        history.redo(&mut document).unwrap_or_else(|e| panic!("what was taken back cannot be done again: {e}"));
    }
    assert_eq!(written(&document), last);
}
