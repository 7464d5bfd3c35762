//! What the machine makes of the graph: parts on boards, and programs as steps in time. Looked for among the values of the
//! graph, so that any node that gives a layout or programs will do.

use super::Model;
use std::collections::BTreeMap;
use std::sync::Arc;
use tenon_engine::{Document, Name, Tree};
use tenon_geometry::board::{Layout, PartSet};
use tenon_geometry::machine::{Machine, Tool};
use tenon_geometry::motion::PartPaths;
use tenon_geometry::panel::PanelSet;
use tenon_geometry::proof::ProofReport;
use tenon_geometry::{DVec3, proof};
use tenon_nodes::post::{MachineFile, PostedProgram};
use tenon_nodes::value::{Program, Standing, V};

/// Speed of rapid moves for estimates, mm/min; machine files do not say it.
pub const RAPID: f64 = 20_000.0;
/// Speed of turning without moving for estimates, radians per second.
const TURNING: f64 = 1.5;

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
}

/// `node.port` of all wires to a node.
fn sources<'a>(document: &'a Document, node: &str) -> impl Iterator<Item = &'a str> {
    let inputs = document.nodes().get(node).map(|n| &n.inputs);
    inputs.into_iter().flat_map(|i| i.values()).flat_map(|w| w.from.iter().map(Name::as_str))
}

/// All outputs of a type that have a value: selected nodes first, then by id.
fn outputs<'a>(model: &'a Model, type_name: &'a str) -> impl Iterator<Item = (&'a String, String, &'a Tree)> {
    let nodes = model.document().nodes();
    let chosen = nodes.iter().filter(|(id, _)| model.selection.contains(*id));
    let others = nodes.iter().filter(|(id, _)| !model.selection.contains(*id));
    chosen.chain(others).flat_map(move |(id, node)| {
        let ports = model.catalog.get(&node.type_name).into_iter().flat_map(|t| &t.outputs);
        ports.filter(move |p| p.type_name == type_name).filter_map(move |p| {
            let address = format!("{id}.{}", p.name);
            let tree = model.value(&address)?;
            Some((id, address, tree))
        })
    })
}

/// The parts of the first layout that there is; that of a selected node goes first.
#[must_use]
pub fn boards(model: &Model) -> Option<Boards> {
    outputs(model, "layout").find_map(|(node, _, tree)| {
        let layout = tree.first::<V<Layout>>()?.clone();
        let (from, parts) =
            sources(model.document(), node).find_map(|s| Some((s, model.value(s)?.first::<V<PartSet>>()?.clone())))?;
        let mapper = from.split_once('.')?.0;
        let panels = sources(model.document(), mapper)
            .find(|s| model.value(s).is_some_and(|t| t.first::<V<PanelSet>>().is_some()));
        Some(Boards { node: node.clone(), layout, parts, panels: panels.map(|p| model.path_of(p).into_owned()) })
    })
}

/// Tool paths with the parts that they cut, and a digest of both; none if no node gives them.
#[must_use]
pub fn paths(model: &Model) -> Option<(&PartPaths, &PartSet, u128)> {
    outputs(model, "tool_paths").find_map(|(node, _, tree)| {
        let all = sources(model.document(), node).filter_map(|s| model.value(s));
        let parts = all.filter(|t| t.first::<V<PartSet>>().is_some()).collect::<Vec<_>>();
        let from = parts.first()?;
        let digest = tree.digest() ^ from.digest().rotate_left(64);
        Some((&**tree.first::<V<PartPaths>>()?, &**from.first::<V<PartSet>>()?, digest))
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

/// All that proofs have found wrong, in their order.
#[must_use]
pub fn faults(model: &Model) -> Vec<Fault> {
    let proofs = outputs(model, "proof").filter_map(|(_, _, tree)| tree.first::<V<ProofReport>>());
    let programs = proofs.flat_map(|p| &p.programs);
    let fault = |board, r: &proof::Reason| Fault { board, line: r.line, at: r.at, words: r.to_string() };
    programs.flat_map(|p| p.reasons.iter().map(move |r| fault(p.board, r))).collect()
}

/// Programs with the machine that they are for.
pub struct Programs {
    /// The machine.
    pub machine: V<MachineFile>,
    /// The programs.
    pub all: Vec<Program>,
    /// Digest of the value that they come from.
    pub digest: u128,
}

/// The programs that are judged best: proven ones before others.
#[must_use]
pub fn programs(model: &Model) -> Option<Programs> {
    let found = outputs(model, "program").filter_map(|(node, _, tree)| {
        let machine =
            sources(model.document(), node).find_map(|s| model.value(s)?.first::<V<MachineFile>>().cloned())?;
        let columns = tree.branches().iter().map(|(_, c)| c);
        let all: Vec<Program> =
            columns.flat_map(|c| (0..c.len()).filter_map(|i| c.get::<Program>(i).cloned())).collect();
        (!all.is_empty()).then_some(Programs { machine, all, digest: tree.digest() })
    });
    let judged = |p: &Programs| p.all.iter().filter(|p| p.standing != Standing::Unproven).count();
    found.reduce(|a, b| if judged(&b) > judged(&a) { b } else { a })
}

/// What a step does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// At full speed.
    Rapid,
    /// Down into the material.
    Plunge,
    /// Through the material.
    Cut,
    /// Up again.
    Retract,
}

/// One straight motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// Line of the program, from 1.
    pub line: u32,
    /// What it does.
    pub kind: Kind,
    /// Index of the tool in the machine's list; none without a tool.
    pub tool: Option<usize>,
    /// When it begins and ends, seconds from the start.
    pub time: [f64; 2],
    /// Programmed coordinates at both ends, mm.
    linear: [DVec3; 2],
    /// Programmed angles at both ends, radians.
    angles: [[f64; 2]; 2],
    /// Where the tip is at the end, board coordinates, mm.
    pub tip: DVec3,
}

/// A program as steps in time.
pub struct Play {
    /// Name of its file.
    pub name: String,
    /// The board that it machines.
    pub board: u32,
    /// What is known of its proof.
    pub standing: Standing,
    /// The steps; the first one comes from where the machine happened to be.
    pub steps: Vec<Step>,
    /// Line and problem, if the text could not be read.
    pub refused: Option<(u32, String)>,
    /// The machine.
    pub machine: V<MachineFile>,
    posted: Arc<PostedProgram>,
    /// Where each line of the text begins.
    lines: Vec<usize>,
}

/// Where the tool is at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Now {
    /// The step that runs.
    pub step: usize,
    /// The tip, board coordinates, mm.
    pub tip: DVec3,
    /// From the tip to the spindle.
    pub axis: DVec3,
}

impl Play {
    /// Reads a program back as the control would. O(bytes).
    #[must_use]
    pub fn new(program: &Program, machine: &V<MachineFile>) -> Self {
        let posted = program.posted.clone();
        let read = posted.read(&machine.machine);
        let mut lines = vec![0];
        lines.extend(posted.text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1));
        Self {
            name: posted.file_name(),
            board: posted.board,
            standing: program.standing.clone(),
            steps: steps(&read, &machine.machine),
            refused: read.refused,
            machine: machine.clone(),
            posted,
            lines,
        }
    }

    /// Seconds from the start to the end, rapid moves at [`RAPID`].
    #[must_use]
    pub fn length(&self) -> f64 {
        self.steps.last().map_or(0.0, |s| s.time[1])
    }

    /// Number of lines of the text.
    #[must_use]
    pub fn line_count(&self) -> usize {
        self.lines.len()
    }

    /// A line of the text, from 1.
    #[must_use]
    pub fn line(&self, line: usize) -> &str {
        let start = line.checked_sub(1).and_then(|l| self.lines.get(l)).copied().unwrap_or(self.posted.text.len());
        let end = self.lines.get(line).copied().unwrap_or(self.posted.text.len());
        self.posted.text.get(start..end).unwrap_or_default().trim_end()
    }

    /// Seconds that every part takes, by its address, as the program's remarks name it; what belongs to none is under "".
    /// O(lines + steps).
    #[must_use]
    pub fn time_of_parts(&self) -> BTreeMap<String, f64> {
        let mut times = BTreeMap::new();
        let (mut line, mut part) = (0, String::new());
        for step in &self.steps {
            while line < step.line as usize {
                line += 1;
                if let Some(name) = part_named(self.line(line)) {
                    part = name.to_owned();
                }
            }
            *times.entry(part.clone()).or_insert(0.0) += step.time[1] - step.time[0];
        }
        times
    }

    /// The tool of a step.
    #[must_use]
    pub fn tool(&self, step: &Step) -> Option<&Tool> {
        self.machine.machine.tools.get(step.tool?)
    }

    /// Where the tool is at a time; none in a program without steps. O(log steps).
    #[must_use]
    pub fn at(&self, time: f64) -> Option<Now> {
        let i = self.steps.partition_point(|s| s.time[1] < time).min(self.steps.len().checked_sub(1)?);
        let s = &self.steps[i];
        let long = s.time[1] - s.time[0];
        let t = if long > 0.0 { ((time - s.time[0]) / long).clamp(0.0, 1.0) } else { 1.0 };
        let angles = [0, 1].map(|k| s.angles[0][k] + t * (s.angles[1][k] - s.angles[0][k]));
        let linear = s.linear[0].lerp(s.linear[1], t);
        let machine = &self.machine.machine;
        let (tip, axis) = match self.tool(s) {
            Some(tool) => {
                let pose = machine.pose(linear, angles, tool);
                (pose.tip, pose.axis)
            }
            None => (linear, machine.tool_axis(angles)),
        };
        Some(Now { step: i, tip, axis })
    }

    /// When the first step of a line begins; none if no motion stands on it or after it.
    #[must_use]
    pub fn time_of(&self, line: u32) -> Option<f64> {
        self.steps.get(self.steps.partition_point(|s| s.line < line)).map(|s| s.time[0])
    }
}

/// The address in a remark such as `(1.2.3 contour)`.
fn part_named(line: &str) -> Option<&str> {
    let remark = line.trim().strip_prefix(['(', ';'])?.trim_end_matches(')').trim();
    let (name, what) = remark.rsplit_once(' ')?;
    matches!(what, "fixing" | "engraving" | "drilling" | "contour").then_some(name.trim())
}

fn steps(program: &proof::Program, machine: &Machine) -> Vec<Step> {
    let mut steps: Vec<Step> = Vec::with_capacity(program.motions.len());
    for m in &program.motions {
        let (from, turned, start) =
            steps.last().map_or((m.linear, m.angles, 0.0), |s| (s.linear[1], s.angles[1], s.time[1]));
        let tool = machine.tools.iter().position(|t| t.number == m.tool);
        let tip = tool.map_or(m.linear, |t| machine.pose(m.linear, m.angles, &machine.tools[t]).tip);
        let before = steps.last().map_or(tip, |s| s.tip);
        let distance = from.distance(m.linear);
        let turn = (0..2).map(|k| (m.angles[k] - turned[k]).abs()).fold(0.0, f64::max);
        let speed = if m.rapid || m.feed <= 0.0 { RAPID } else { m.feed };
        let long = (distance / speed * 60.0).max(turn / TURNING);
        let (down, aside) = (before.z - tip.z, tip.truncate().distance(before.truncate()));
        let kind = match m.rapid {
            true => Kind::Rapid,
            false if down > aside => Kind::Plunge,
            false if -down > aside => Kind::Retract,
            false => Kind::Cut,
        };
        let time = [start, start + long];
        steps.push(Step { line: m.line, kind, tool, time, linear: [from, m.linear], angles: [turned, m.angles], tip });
    }
    steps
}
