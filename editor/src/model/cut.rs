//! What the machine makes of the graph: parts on boards, tool paths, programs, and what a proof says of them. Looked for among
//! the values of the whole graph and of what is inside its clusters, so that any node that gives a layout or programs will do.

use super::Model;
use super::reach::{Given, given, origin, place, sources};
use std::collections::{BTreeMap, BTreeSet};
use tenon_engine::{Text, Tree};
use tenon_geometry::board::{Layout, PartSet};
use tenon_geometry::motion::PartPaths;
use tenon_geometry::panel::PanelSet;
use tenon_geometry::proof::ProofReport;
use tenon_geometry::{DVec2, DVec3, proof};
use tenon_nodes::post::MachineFile;
use tenon_nodes::value::{Program, Standing, V};

/// Types of values that tell what the machine makes.
pub(super) const MADE: [&str; 4] = ["layout", "program", "proof", "tool_paths"];

/// Those, and the types of what they are made of.
pub(super) const ASKED: [&str; 7] = ["layout", "program", "proof", "tool_paths", "machine", "panels", "parts"];

/// Parts on boards.
pub struct Boards {
    /// The node that laid them out, by its path.
    pub node: String,
    /// Where they lie.
    pub layout: V<Layout>,
    /// The parts themselves.
    pub parts: V<PartSet>,
    /// The output (`node.port`) whose panels the parts are: as the viewport names it, if it is seen there.
    pub panels: Option<String>,
    /// Along what the boards' grain runs; none if parts may be turned freely, so that there is none.
    pub grain: Option<DVec2>,
}

/// The value of an output (`path.port`), wherever it stands.
fn value<'a>(model: &'a Model, output: &str) -> Option<&'a Tree> {
    model.results.values.get(output)
}

/// Whether a node has outputs of a type, and if a port is named, that one.
fn gives(model: &Model, path: &str, type_name: &str, port: Option<&str>) -> bool {
    let at = place(model.whole(), path).filter(|at| at.node.cluster().is_none());
    let ports = at.and_then(|at| model.catalog.get(&at.node.type_name)).map_or(&[][..], |t| &t.outputs);
    ports.iter().any(|p| p.type_name == type_name && port.is_none_or(|port| p.name == port))
}

/// The nodes that give a type, by their paths, with each value of it that there is: first selected nodes and what is inside
/// selected instances, then the node that was shown last, then by path. O(what tells what the machine makes).
fn outputs<'a>(
    model: &'a Model,
    type_name: &'a str,
    last: Option<&str>,
) -> impl Iterator<Item = (&'a str, &'a Tree)> + use<'a> {
    let found = model.results.made.iter().filter_map(|output| {
        let (path, port) = output.split_once('.')?;
        let tree = value(model, output).filter(|t| t.type_name() == type_name)?;
        gives(model, path, type_name, Some(port)).then_some((path, tree))
    });
    let mut found: Vec<_> = found.collect();
    found.sort_by_key(|(path, _)| (!model.is_chosen(path), last != Some(*path)));
    found.into_iter()
}

/// The parts of a layout: of a selected node, or of one that a selected program or proof is for; else of the node whose boards
/// were shown `last`; else of the first that there is. An instance that is selected counts for what is inside it.
#[must_use]
pub fn boards(model: &Model, last: Option<&str>) -> Option<Boards> {
    let all: Vec<Boards> = outputs(model, "layout", last).filter_map(|(node, tree)| of(model, node, tree)).collect();
    let chosen = |b: &Boards| model.is_chosen(&b.node);
    let selected = |type_name| outputs(model, type_name, None).take_while(|(node, _)| model.is_chosen(node));
    let selected: Vec<&str> = selected("program").chain(selected("proof")).map(|(node, _)| node).collect();
    let made = |b: &Boards| selected.iter().any(|node| comes_from(model, node, &b.node, &["program", "layout"]));
    let meant = all.iter().position(chosen).or_else(|| all.iter().position(made));
    all.into_iter().nth(meant.unwrap_or(0))
}

fn of(model: &Model, node: &str, tree: &Tree) -> Option<Boards> {
    let whole = model.whole();
    let layout = tree.first::<V<Layout>>()?.clone();
    let (from, parts) = sources(whole, node)
        .into_iter()
        .find_map(|s| value(model, &s)?.first::<V<PartSet>>().cloned().map(|parts| (s, parts)))?;
    let mapper = from.split_once('.')?.0;
    let is_panels = |s: &String| value(model, s).is_some_and(|t| t.first::<V<PanelSet>>().is_some());
    let panels = sources(whole, mapper).into_iter().find(is_panels).map(|panels| seen_as(model, panels));
    let grain = grain(model, node, mapper);
    Some(Boards { node: node.to_owned(), layout, parts, panels, grain })
}

/// The name under which the viewport shows an output: its own, or that of an instance around it.
fn seen_as(model: &Model, output: String) -> String {
    let drawings = &model.results.drawings;
    if drawings.contains_key(&output) {
        return output;
    }
    let same = |shown: &&String| origin(model.whole(), shown).as_ref() == Some(&output);
    drawings.keys().find(same).cloned().unwrap_or(output)
}

/// Why there are no boards, in words; `what` of them would be seen.
#[must_use]
pub fn missing(model: &Model, what: &str) -> String {
    let is_layout = |output: &&String| value(model, output).is_some_and(|t| t.type_name() == "layout");
    match model.results.made.iter().find(is_layout).and_then(|output| output.split_once('.')) {
        Some((node, _)) => format!("{node} gives a layout, but the parts that lie on it cannot be reached from there."),
        None => format!("No node gives a layout yet. The {what} appear once parts are packed."),
    }
}

/// A text that an input has, by wire or of its own.
fn text(model: &Model, node: &str, port: &str) -> Option<String> {
    match given(model.whole(), node, port)? {
        Given::Wires(from) => value(model, from.first()?)?.first::<Text>().map(|t| t.0.to_string()),
        Given::Value(set) => set.to_json().as_str().map(str::to_owned),
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
    outputs(model, "tool_paths", None).find_map(|(node, tree)| {
        let all = sources(model.whole(), node);
        let from = all.iter().filter_map(|s| value(model, s)).find(|t| t.first::<V<PartSet>>().is_some())?;
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
    let proofs = outputs(model, "proof", None).filter(|(node, _)| comes_from(model, node, programs, &["program"]));
    for p in proofs.filter_map(|(_, tree)| tree.first::<V<ProofReport>>()).flat_map(|p| &p.programs) {
        let fault = |r: &proof::Reason| Fault { board: p.board, line: r.line, at: r.at, words: r.to_string() };
        faults.told.extend(p.reasons.iter().map(fault));
        *faults.more.entry(p.board).or_default() += p.omitted;
    }
    faults
}

/// Programs with the machine that they are for.
pub struct Programs {
    /// The node that gives them, by its path.
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
        outputs(model, "program", last).filter(|(node, _)| comes_from(model, node, layout, &["program", "layout"]));
    let found = own.filter_map(|(node, tree)| {
        let all = sources(model.whole(), node);
        let machine = all.iter().find_map(|s| value(model, s)?.first::<V<MachineFile>>().cloned())?;
        let columns = tree.branches().iter().map(|(_, c)| c);
        let all: Vec<Program> =
            columns.flat_map(|c| (0..c.len()).filter_map(|i| c.get::<Program>(i).cloned())).collect();
        let node = node.to_owned();
        (!all.is_empty()).then_some(Programs { node, machine, all, digest: tree.digest() })
    });
    let judged = |p: &Programs| p.all.iter().filter(|p| p.standing != Standing::Unproven).count();
    found.reduce(|a, b| if judged(&b) > judged(&a) { b } else { a })
}

/// Whether what a node makes comes from another one, or it is that one. At each node those wires are followed that bring the
/// first of `types` that any of them brings, since programs say more of where a proof belongs than the layout beside them;
/// all, if none brings any. Another layout ends the way. O(wires).
fn comes_from(model: &Model, node: &str, origin: &str, types: &[&str]) -> bool {
    let (mut open, mut seen) = (vec![node.to_owned()], BTreeSet::new());
    while let Some(path) = open.pop() {
        if path == origin {
            return true;
        }
        if seen.contains(&path) || gives(model, &path, "layout", None) {
            continue;
        }
        let sources = sources(model.whole(), &path);
        seen.insert(path);
        let brings = |s: &str, name: &str| value(model, s).is_some_and(|t| t.type_name() == name);
        let kind = types.iter().find(|name| sources.iter().any(|s| brings(s, name)));
        let wires = sources.iter().filter(|s| kind.is_none_or(|name| brings(s, name)));
        open.extend(wires.filter_map(|s| s.split_once('.')).map(|(path, _)| path.to_owned()));
    }
    false
}
