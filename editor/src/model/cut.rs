//! What the machine makes of the graph: parts on boards, tool paths, programs, and what a proof says of them. Looked for among
//! the values of the graph, so that any node that gives a layout or programs will do.

use super::Model;
use std::collections::{BTreeMap, BTreeSet};
use tenon_engine::{Document, Json, Literal, Name, Text, Tree};
use tenon_geometry::board::{Layout, PartSet};
use tenon_geometry::motion::PartPaths;
use tenon_geometry::panel::PanelSet;
use tenon_geometry::proof::ProofReport;
use tenon_geometry::{DVec2, DVec3, proof};
use tenon_nodes::post::MachineFile;
use tenon_nodes::value::{Program, Standing, V};

/// Parts on boards.
pub struct Boards {
    /// The node that laid them out.
    pub node: String,
    /// Where they lie.
    pub layout: V<Layout>,
    /// The parts themselves.
    pub parts: V<PartSet>,
    /// The output (`node.port`) whose panels the parts are, if it is seen in the viewport.
    pub panels: Option<String>,
    /// Along what the boards' grain runs; none if parts may be turned freely, so that there is none.
    pub grain: Option<DVec2>,
}

/// `node.port` of all wires to a node.
fn sources<'a>(document: &'a Document, node: &str) -> impl Iterator<Item = &'a str> {
    let inputs = document.nodes().get(node).map(|n| &n.inputs);
    inputs.into_iter().flat_map(|i| i.values()).flat_map(|w| w.from.iter().map(Name::as_str))
}

/// All outputs of a type that have a value: first those of selected nodes, then those of the node that was shown last, then
/// by id.
fn outputs<'a>(
    model: &'a Model,
    type_name: &'a str,
    last: Option<&str>,
) -> impl Iterator<Item = (&'a String, String, &'a Tree)> {
    let mut nodes: Vec<_> = model.document().nodes().iter().collect();
    nodes.sort_by_key(|(id, _)| (!model.selection.contains(*id), last != Some(id.as_str())));
    nodes.into_iter().flat_map(move |(id, node)| {
        let ports = model.catalog.get(&node.type_name).into_iter().flat_map(|t| &t.outputs);
        ports.filter(move |p| p.type_name == type_name).filter_map(move |p| {
            let address = format!("{id}.{}", p.name);
            let tree = model.value(&address)?;
            Some((id, address, tree))
        })
    })
}

/// The parts of a layout: of a selected node, or of one that a selected program or proof is for; else of the node whose boards
/// were shown `last`; else of the first that there is.
#[must_use]
pub fn boards(model: &Model, last: Option<&str>) -> Option<Boards> {
    let all: Vec<Boards> = outputs(model, "layout", last).filter_map(|(node, _, tree)| of(model, node, tree)).collect();
    let chosen = |b: &Boards| model.selection.contains(&b.node);
    let made = |b: &Boards| {
        let of = |type_name| outputs(model, type_name, None).take_while(|(node, _, _)| model.selection.contains(*node));
        of("program").chain(of("proof")).any(|(node, _, _)| comes_from(model, node, &b.node, &["program", "layout"]))
    };
    let meant = all.iter().position(chosen).or_else(|| all.iter().position(made));
    all.into_iter().nth(meant.unwrap_or(0))
}

fn of(model: &Model, node: &str, tree: &Tree) -> Option<Boards> {
    let layout = tree.first::<V<Layout>>()?.clone();
    let (from, parts) =
        sources(model.document(), node).find_map(|s| Some((s, model.value(s)?.first::<V<PartSet>>()?.clone())))?;
    let mapper = from.split_once('.')?.0;
    let panels =
        sources(model.document(), mapper).find(|s| model.value(s).is_some_and(|t| t.first::<V<PanelSet>>().is_some()));
    let panels = panels.map(|p| model.path_of(p).into_owned());
    let grain = grain(model, node, mapper);
    Some(Boards { node: node.to_owned(), layout, parts, panels, grain })
}

/// A text that an input has, by wire or of its own.
fn text(model: &Model, node: &str, port: &str) -> Option<String> {
    let node = model.document().nodes().get(node)?;
    let wired = node.inputs.get(port).and_then(|w| w.from.first());
    match wired {
        Some(from) => model.value(from)?.first::<Text>().map(|t| t.0.to_string()),
        None => node.params.get(port).map(Literal::to_json).as_ref().and_then(Json::as_str).map(str::to_owned),
    }
}

/// Along what the grain of the boards runs: the axis that the parts were mapped to, by default X; none where they may be
/// turned freely when they are packed.
fn grain(model: &Model, packer: &str, mapper: &str) -> Option<DVec2> {
    let free = text(model, packer, "turns").is_some_and(|t| t == "free");
    let along = if text(model, mapper, "axis").is_some_and(|a| a == "y") { DVec2::Y } else { DVec2::X };
    (!free).then_some(along)
}

/// Tool paths with the parts that they cut, and a digest of both; none if no node gives them.
#[must_use]
pub fn paths(model: &Model) -> Option<(V<PartPaths>, V<PartSet>, u128)> {
    outputs(model, "tool_paths", None).find_map(|(node, _, tree)| {
        let all = sources(model.document(), node).filter_map(|s| model.value(s));
        let parts = all.filter(|t| t.first::<V<PartSet>>().is_some()).collect::<Vec<_>>();
        let from = parts.first()?;
        let digest = tree.digest() ^ from.digest().rotate_left(64);
        Some((tree.first::<V<PartPaths>>()?.clone(), from.first::<V<PartSet>>()?.clone(), digest))
    })
}

/// What a proof has found wrong with programs.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// The board.
    pub board: u32,
    /// Line of the program, if it is known.
    pub line: Option<u32>,
    /// Where on the board, mm, if it is known.
    pub at: Option<DVec3>,
    /// In words.
    pub words: String,
}

/// What proofs have found wrong with programs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Faults {
    /// In their order.
    pub told: Vec<Fault>,
    /// How many more there are of boards, that proofs only count.
    more: BTreeMap<u32, usize>,
}

impl Faults {
    /// Those of a board.
    pub fn of(&self, board: u32) -> impl Iterator<Item = &Fault> {
        self.told.iter().filter(move |f| f.board == board)
    }

    /// How many more a board has than are told.
    #[must_use]
    pub fn more(&self, board: u32) -> usize {
        self.more.get(&board).copied().unwrap_or_default()
    }
}

/// What proofs have found wrong with the programs that a node gives.
#[must_use]
pub fn faults(model: &Model, programs: &str) -> Faults {
    let mut faults = Faults::default();
    let proofs = outputs(model, "proof", None).filter(|(node, _, _)| comes_from(model, node, programs, &["program"]));
    for p in proofs.filter_map(|(_, _, tree)| tree.first::<V<ProofReport>>()).flat_map(|p| &p.programs) {
        let fault = |r: &proof::Reason| Fault { board: p.board, line: r.line, at: r.at, words: r.to_string() };
        faults.told.extend(p.reasons.iter().map(fault));
        *faults.more.entry(p.board).or_default() += p.omitted;
    }
    faults
}

/// Programs with the machine that they are for.
pub struct Programs {
    /// The node that gives them.
    pub node: String,
    /// The machine.
    pub machine: V<MachineFile>,
    /// The programs.
    pub all: Vec<Program>,
    /// Digest of the value that they come from.
    pub digest: u128,
}

/// The programs of the layout that a node gives, those that are judged best: proven ones before others. Of equal ones those of
/// a selected node count, else those of the node whose programs were shown `last`.
#[must_use]
pub fn programs(model: &Model, layout: &str, last: Option<&str>) -> Option<Programs> {
    let own =
        outputs(model, "program", last).filter(|(node, _, _)| comes_from(model, node, layout, &["program", "layout"]));
    let found = own.filter_map(|(node, _, tree)| {
        let machine =
            sources(model.document(), node).find_map(|s| model.value(s)?.first::<V<MachineFile>>().cloned())?;
        let columns = tree.branches().iter().map(|(_, c)| c);
        let all: Vec<Program> =
            columns.flat_map(|c| (0..c.len()).filter_map(|i| c.get::<Program>(i).cloned())).collect();
        let node = node.clone();
        (!all.is_empty()).then_some(Programs { node, machine, all, digest: tree.digest() })
    });
    let judged = |p: &Programs| p.all.iter().filter(|p| p.standing != Standing::Unproven).count();
    found.reduce(|a, b| if judged(&b) > judged(&a) { b } else { a })
}

/// Whether what a node makes comes from another one, or it is that one. At each node those wires are followed that bring the
/// first of `types` that any of them brings, since programs say more of where a proof belongs than the layout beside them;
/// all, if none brings any. Another layout ends the way. O(wires).
fn comes_from(model: &Model, node: &str, origin: &str, types: &[&str]) -> bool {
    let document = model.document();
    let gives_layout = |id: &str| {
        let ports = document.nodes().get(id).and_then(|n| model.catalog.get(&n.type_name));
        ports.is_some_and(|t| t.outputs.iter().any(|p| p.type_name == "layout"))
    };
    let (mut open, mut seen) = (vec![node], BTreeSet::new());
    while let Some(id) = open.pop() {
        if id == origin {
            return true;
        }
        if !seen.insert(id) || gives_layout(id) {
            continue;
        }
        let brings = |s: &&str, name: &str| model.value(s).is_some_and(|t| t.type_name() == name);
        let kind = types.iter().find(|name| sources(document, id).any(|s| brings(&s, name)));
        let wires = sources(document, id).filter(|s| kind.is_none_or(|name| brings(s, name)));
        open.extend(wires.filter_map(|s| s.split_once('.')).map(|(id, _)| id));
    }
    false
}
