//! Runs one program through the machine: every move becomes sweeps of cutter, shank, holder and spindle; what may not
//! enter anything is checked against stock, sacrificial layer, table and clamps; what cuts is kept for the parts.
//!
//! The rule for bodies that do not cut: they stay out of the stock altogether, cleared or not. One exception is sound
//! without knowing what has been cleared: while a tool moves along its own axis, from a place where its shank stands
//! above the stock, the shank only fills what the cutter in front of it has passed through, if it is no wider.

use super::depth::{depth, depth_bound};
use super::motion::{Motion, Program};
use super::report::{Body, Fault, Obstacle, ProofParams, Reason};
use super::sweep::{Aabb, Disc, Sweep};
use crate::board::Board;
use crate::machine::{Machine, Pose, Revolved, Tool, ToolKind};
use crate::plane::Plane;
use glam::DVec3;

/// A sweep that is in the stock.
pub(crate) struct Cut {
    pub sweep: Sweep,
    pub aabb: Aabb,
    pub line: u32,
    /// Index into `Machine::tools`.
    pub tool: u32,
    /// Tip at both ends.
    pub tips: [DVec3; 2],
    pub axis: DVec3,
    /// A cutter at feed; anything else has no business here and clears nothing.
    pub cutting: bool,
}

/// Something not to be touched.
struct Keep {
    what: Obstacle,
    aabb: Aabb,
    planes: Vec<Plane>,
}

fn keep(what: Obstacle, min: DVec3, max: DVec3) -> Keep {
    let axes = [DVec3::X, DVec3::Y, DVec3::Z];
    let upper = axes.iter().map(|n| Plane { normal: *n, offset: n.dot(max) });
    let lower = axes.iter().map(|n| Plane { normal: -*n, offset: -n.dot(min) });
    Keep { what, aabb: Aabb { min, max }, planes: upper.chain(lower).collect() }
}

/// A frustum that moves, with its part of the machine.
struct Moving {
    body: Body,
    shape: Revolved,
}

/// A tool as it stands in the spindle.
struct Loaded<'a> {
    index: u32,
    tool: &'a Tool,
    moving: Vec<Moving>,
    /// Farthest point from what the control keeps in place while the head turns, mm.
    arm: f64,
    slim_shank: bool,
}

/// A stretch along the tool's own axis.
struct Straight {
    start: Pose,
    /// Whether the shank stood above the stock at its start.
    shank_above: bool,
}

/// How far a tool may stray from its own axis and still follow its own hole, mm: two roundings of a coordinate.
const STRAY: f64 = 0.003;

/// How far a written position may lie beyond a limit by rounding, mm or degrees.
const LAST_DECIMAL: f64 = 1e-3;

/// Most steps of one turn; coarser steps only widen the margin.
const MOST_STEPS: f64 = 1e5;

pub(crate) struct Runner<'a> {
    machine: &'a Machine,
    params: &'a ProofParams,
    obstacles: Vec<Keep>,
    stock: Aabb,
    /// Nothing but air from here up.
    ceiling: f64,
    pub cuts: Vec<Cut>,
    pub reasons: Vec<Reason>,
    pub omitted: usize,
}

impl<'a> Runner<'a> {
    pub fn new(machine: &'a Machine, board: &Board, params: &'a ProofParams) -> Self {
        let stock_max = board.size.extend(board.thickness);
        let table = &machine.table;
        let under = DVec3::new(table.max.x, table.max.y, 0.0);
        let over = DVec3::new(table.min.x, table.min.y, -table.sacrificial);
        let mut obstacles = vec![
            keep(Obstacle::Stock, DVec3::ZERO, stock_max),
            keep(Obstacle::Sacrificial, over, under),
            keep(Obstacle::Table, table.min, DVec3::new(table.max.x, table.max.y, -table.sacrificial)),
        ];
        let clamps = machine.clamps.iter().map(|c| keep(Obstacle::Clamp(c.name.clone()), c.min, c.max));
        obstacles.extend(clamps);
        let ceiling = obstacles.iter().map(|o| o.aabb.max.z).fold(0.0, f64::max);
        let stock = Aabb { min: DVec3::ZERO, max: stock_max };
        let (cuts, reasons) = (Vec::new(), Vec::new());
        Self { machine, params, obstacles, stock, ceiling, cuts, reasons, omitted: 0 }
    }

    /// Runs all motions; false if `go_on` said so. O(motions), times the steps of turns.
    pub fn run(&mut self, program: &Program, go_on: &dyn Fn(usize) -> bool) -> bool {
        let mut before: Option<(Motion, Pose)> = None;
        let mut loaded: Option<Loaded> = None;
        let mut straight: Option<Straight> = None;
        for (k, motion) in program.motions.iter().enumerate() {
            if k % 256 == 0 && !go_on(k) {
                return false;
            }
            if loaded.as_ref().is_none_or(|l| l.tool.number != motion.tool) {
                if let (Some(old), Some((_, pose))) = (&loaded, &before) {
                    let below = self.ceiling - lowest(old, *pose);
                    if below > self.params.gouge {
                        self.fault(motion.line, Some(pose.tip), below, Fault::ToolChange);
                    }
                }
                straight = None;
                loaded = self.load(motion.tool);
                // The same axis positions put another tool's tip elsewhere on a machine without tip control.
                before = before.zip(loaded.as_ref()).map(|((m, _), l)| (m, self.pose(&m, l.tool)));
            }
            let Some(tool) = &loaded else {
                self.fault(motion.line, None, 0.0, Fault::UnknownTool(motion.tool));
                before = None;
                continue;
            };
            if !self.check_limits(motion) {
                // Where the machine stands after that nobody knows.
                before = None;
                straight = None;
                continue;
            }
            let pose = self.pose(motion, tool.tool);
            if !motion.rapid {
                self.check_spindle(motion, tool.tool);
            }
            match &before {
                Some((start, from)) => self.motion(tool, (start, *from), (motion, pose), &mut straight),
                None => {
                    let below = self.ceiling - lowest(tool, pose);
                    if below > self.params.gouge || !motion.rapid {
                        self.fault(motion.line, Some(pose.tip), below.max(0.0), Fault::FirstMove);
                    }
                }
            }
            before = Some((*motion, pose));
        }
        true
    }

    fn pose(&self, m: &Motion, tool: &Tool) -> Pose {
        self.machine.pose(m.linear, m.angles, tool)
    }

    fn load(&self, number: u32) -> Option<Loaded<'a>> {
        let index = self.machine.tools.iter().position(|t| t.number == number)?;
        let tool = &self.machine.tools[index];
        let body = self.machine.body(tool);
        let moving: Vec<Moving> = [
            (Body::Cutter, body.cutter),
            (Body::Shank, body.shank),
            (Body::Holder, body.holder),
            (Body::Spindle, body.spindle),
        ]
        .into_iter()
        .flat_map(|(body, shapes)| shapes.into_iter().map(move |shape| Moving { body, shape }))
        .collect();
        let pivot = self.machine.reach_above_tip(tool);
        let far = |h: f64, r: f64| (h - pivot).hypot(r);
        let arm = moving
            .iter()
            .map(|m| far(m.shape.from, m.shape.radius_from).max(far(m.shape.to, m.shape.radius_to)))
            .fold(0.0, f64::max);
        let slim_shank = tool.shank_diameter <= tool.diameter;
        Some(Loaded { index: index as u32, tool, moving, arm, slim_shank })
    }

    fn fault(&mut self, line: u32, at: Option<DVec3>, by: f64, fault: Fault) {
        if self.reasons.len() < self.params.most_reasons {
            self.reasons.push(Reason { line: Some(line), part: None, at, by, fault });
        } else {
            self.omitted += 1;
        }
    }

    /// Whether all axes can go there; a fault for each that cannot.
    fn check_limits(&mut self, motion: &Motion) -> bool {
        let m = self.machine;
        let linear = m.linear.iter().zip(motion.linear.to_array()).map(|(a, v)| (a.letter, v, a.min, a.max));
        let rotary = [&m.primary, &m.secondary];
        let rotary = rotary.iter().zip(motion.angles).map(|(a, v)| (a.letter, v.to_degrees(), a.min, a.max));
        let mut within = true;
        for (axis, value, min, max) in linear.chain(rotary) {
            let by = (min - value).max(value - max);
            if by.is_nan() || by > LAST_DECIMAL {
                within = false;
                self.fault(motion.line, None, by, Fault::Limit { axis, value, min, max });
            }
        }
        within
    }

    fn check_spindle(&mut self, motion: &Motion, tool: &Tool) {
        if motion.speed <= 0.0 {
            self.fault(motion.line, None, 0.0, Fault::SpindleStopped);
        } else if (motion.speed - tool.speed).abs() > 0.5 {
            let fault = Fault::Speed { programmed: motion.speed, table: tool.speed };
            self.fault(motion.line, None, 0.0, fault);
        }
    }

    fn motion(
        &mut self,
        tool: &Loaded,
        (start, from): (&Motion, Pose),
        (motion, to): (&Motion, Pose),
        straight: &mut Option<Straight>,
    ) {
        let turn = (motion.angles[0] - start.angles[0]).abs() + (motion.angles[1] - start.angles[1]).abs();
        if turn == 0.0 {
            let stray = |s: &Straight| {
                let by = to.tip - s.start.tip;
                (by - s.start.axis * s.start.axis.dot(by)).length()
            };
            if straight.as_ref().is_none_or(|s| stray(s) > STRAY) {
                let start = from;
                let by = to.tip - from.tip;
                let axial = (by - from.axis * from.axis.dot(by)).length() <= STRAY;
                *straight = axial.then(|| Straight { start, shank_above: self.shank_above(tool, from) });
            }
            let follows = tool.slim_shank && !motion.rapid && straight.as_ref().is_some_and(|s| s.shank_above);
            self.step(tool, motion, from, to, 0.0, follows);
            return;
        }
        *straight = None;
        // Points of the tool run on arcs about what the control keeps in place; a chord leaves its arc by ω² R / 8.
        let steps = (turn / self.params.turn).ceil().clamp(1.0, MOST_STEPS);
        let margin = tool.arm * (turn / steps).powi(2) / 8.0;
        let mut last = from;
        for k in 1..=steps as u32 {
            let t = f64::from(k) / steps;
            let angles = [0, 1].map(|i| start.angles[i] + (motion.angles[i] - start.angles[i]) * t);
            let next = if f64::from(k) >= steps {
                to
            } else {
                self.machine.pose(start.linear.lerp(motion.linear, t), angles, tool.tool)
            };
            self.step(tool, motion, last, next, margin, false);
            last = next;
        }
    }

    /// Whether the shank stands above the stock and would rise if it were drawn back.
    fn shank_above(&self, tool: &Loaded, pose: Pose) -> bool {
        let above = |m: &Moving| sweep(&m.shape, pose, pose, 0.0).lowest() >= self.stock.max.z;
        pose.axis.z > 0.0 && tool.moving.iter().filter(|m| m.body == Body::Shank).all(above)
    }

    /// One step of a motion, its hull widened by `margin`.
    fn step(&mut self, tool: &Loaded, motion: &Motion, from: Pose, to: Pose, margin: f64, shank_follows: bool) {
        let by = to.tip - from.tip;
        let axial = margin == 0.0 && (by - from.axis * from.axis.dot(by)).length() <= STRAY;
        for moving in &tool.moving {
            let sweep = sweep(&moving.shape, from, to, margin);
            if sweep.lowest() >= self.ceiling {
                continue;
            }
            let aabb = sweep.aabb();
            let cuts = moving.body == Body::Cutter && !motion.rapid;
            let follows = moving.body == Body::Shank && shank_follows;
            let mut touched = cuts && aabb.meets(&self.stock);
            for k in 0..self.obstacles.len() {
                let obstacle = &self.obstacles[k];
                let allowed = (cuts || follows) && matches!(obstacle.what, Obstacle::Stock | Obstacle::Sacrificial);
                if allowed || !aabb.meets(&obstacle.aabb) {
                    continue;
                }
                let enough = self.params.gouge;
                if depth_bound(&sweep, &obstacle.planes) <= enough {
                    continue;
                }
                let found = depth(&sweep, &obstacle.planes, enough, 1e-3);
                if found.upper > enough {
                    touched |= obstacle.what == Obstacle::Stock;
                    let (rapid, body, obstacle) = (motion.rapid, moving.body, obstacle.what.clone());
                    self.fault(motion.line, Some(found.at), found.upper, Fault::Collision { rapid, body, obstacle });
                }
            }
            if touched {
                if cuts && !axial && matches!(tool.tool.kind, ToolKind::Drill { .. }) {
                    self.fault(motion.line, Some(to.tip), 0.0, Fault::DrillSideways);
                }
                self.cuts.push(Cut {
                    sweep,
                    aabb,
                    line: motion.line,
                    tool: tool.index,
                    tips: [from.tip, to.tip],
                    axis: from.axis,
                    cutting: cuts,
                });
            }
        }
    }
}

/// Height of the lowest point of tool, holder and spindle.
fn lowest(tool: &Loaded, pose: Pose) -> f64 {
    tool.moving.iter().map(|m| sweep(&m.shape, pose, pose, 0.0).lowest()).fold(f64::INFINITY, f64::min)
}

fn sweep(shape: &Revolved, from: Pose, to: Pose, margin: f64) -> Sweep {
    let disc = |pose: Pose, h: f64, radius: f64| Disc { center: pose.tip + pose.axis * h, axis: pose.axis, radius };
    Sweep {
        discs: [
            disc(from, shape.from, shape.radius_from),
            disc(from, shape.to, shape.radius_to),
            disc(to, shape.from, shape.radius_from),
            disc(to, shape.to, shape.radius_to),
        ],
        margin,
    }
}
