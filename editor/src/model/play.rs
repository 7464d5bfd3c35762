//! Programs as steps in time, read back as the control would read them.

use std::collections::{BTreeMap, HashMap};
use std::sync::Arc;
use tenon_geometry::machine::{Machine, Pose, Tool};
use tenon_geometry::{DVec3, proof};
use tenon_nodes::post::{MachineFile, PostedProgram};
use tenon_nodes::value::{Program, Standing, V};

/// Speed of rapid moves for estimates, mm/min; machine files do not say it.
pub const RAPID: f64 = 20_000.0;
/// Speed of turning without moving for estimates, radians per second.
const TURNING: f64 = 1.5;

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
    /// Index of the part's address among those that the program's remarks name; none outside of parts.
    pub part: Option<u32>,
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
    /// Addresses of parts in the order in which the program comes to them, and the seconds that each takes.
    parts: Vec<(String, f64)>,
}

/// Where the tool is at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Now {
    /// The step that runs.
    pub step: usize,
    /// How much of it is done, 0 to 1.
    pub part_way: f64,
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
        let mut play = Self {
            name: posted.file_name(),
            board: posted.board,
            standing: program.standing.clone(),
            steps: steps(&read, &machine.machine),
            refused: read.refused,
            machine: machine.clone(),
            posted,
            lines,
            parts: Vec::new(),
        };
        play.find_parts();
        play
    }

    /// Gives every step its part, as the program's remarks name it. O(lines + steps).
    fn find_parts(&mut self) {
        let mut steps = std::mem::take(&mut self.steps);
        let mut numbers: HashMap<String, u32> = HashMap::new();
        let mut parts: Vec<(String, f64)> = Vec::new();
        let (mut line, mut part) = (0, None);
        for step in &mut steps {
            while line < step.line as usize {
                line += 1;
                if let Some(name) = part_named(self.line(line)) {
                    part = Some(*numbers.entry(name.to_owned()).or_insert_with(|| {
                        parts.push((name.to_owned(), 0.0));
                        parts.len() as u32 - 1
                    }));
                }
            }
            step.part = part;
            if let Some((_, time)) = part.and_then(|p| parts.get_mut(p as usize)) {
                *time += step.time[1] - step.time[0];
            }
        }
        (self.steps, self.parts) = (steps, parts);
    }

    /// Address of the part that a step belongs to, and the seconds that it takes in all.
    #[must_use]
    pub fn part(&self, step: &Step) -> Option<(&str, f64)> {
        self.parts.get(step.part? as usize).map(|(name, time)| (name.as_str(), *time))
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
    /// O(parts).
    #[must_use]
    pub fn time_of_parts(&self) -> BTreeMap<&str, f64> {
        let mut times: BTreeMap<&str, f64> = self.parts.iter().map(|(name, time)| (name.as_str(), *time)).collect();
        let rest = self.length() - times.values().sum::<f64>();
        if rest > 1e-9 {
            *times.entry("").or_insert(0.0) += rest;
        }
        times
    }

    /// Seconds that a part takes; none if the program does not name it. O(parts).
    #[must_use]
    pub fn time_of_part(&self, address: &str) -> Option<f64> {
        self.parts.iter().find(|(name, _)| name == address).map(|(_, time)| *time)
    }

    /// The tool of a step.
    #[must_use]
    pub fn tool(&self, step: &Step) -> Option<&Tool> {
        self.machine.machine.tools.get(step.tool?)
    }

    /// Where the tool is at a time; where a step ends the next one runs. None in a program without steps. O(log steps).
    #[must_use]
    pub fn at(&self, time: f64) -> Option<Now> {
        let i = self.steps.partition_point(|s| s.time[1] <= time).min(self.steps.len().checked_sub(1)?);
        let s = &self.steps[i];
        let long = s.time[1] - s.time[0];
        let t = if long > 0.0 { ((time - s.time[0]) / long).clamp(0.0, 1.0) } else { 1.0 };
        let Pose { tip, axis } = self.pose(s, t);
        Some(Now { step: i, part_way: t, tip, axis })
    }

    /// Where the tool is in a step, `t` from 0 to 1.
    #[must_use]
    pub fn pose(&self, s: &Step, t: f64) -> Pose {
        let angles = [0, 1].map(|k| s.angles[0][k] + t * (s.angles[1][k] - s.angles[0][k]));
        let linear = s.linear[0].lerp(s.linear[1], t);
        let machine = &self.machine.machine;
        match self.tool(s) {
            Some(tool) => machine.pose(linear, angles, tool),
            None => Pose { tip: linear, axis: machine.tool_axis(angles) },
        }
    }

    /// Whether the head turns in a step.
    #[must_use]
    pub fn turns(&self, s: &Step) -> bool {
        s.angles[0] != s.angles[1]
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
        let (linear, angles) = ([from, m.linear], [turned, m.angles]);
        steps.push(Step { line: m.line, kind, tool, time, part: None, linear, angles, tip });
    }
    steps
}
