//! Whether a machine can drill a feature: from above, within its tilt, with a tool long enough, holder and spindle clear
//! (METHODS §6).

use super::feature::{Feature, FeatureSet, Machining};
use crate::board::Up;
use crate::machine::{KinematicsError, Machine, Revolved, Tool, ToolKind};
use crate::panel::PanelSet;
use crate::plane::Plane;
use glam::DVec3;
use rayon::prelude::*;
use std::borrow::Cow;

/// What is done with a feature that the machine cannot reach.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OutOfReach {
    /// It is left out; the issue is fatal.
    Refuse,
    /// It goes to the list of hand work.
    ByHand,
}

/// Parameters of [`check_reach`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReachRule {
    /// Which face lies up on the machine.
    pub up: Up,
    /// What is done with features out of reach.
    pub out_of_reach: OutOfReach,
    /// Least distance of holder and spindle from the board's upper plane, mm.
    pub clearance: f64,
    /// Greatest difference between a hole's and a drill's diameter, mm.
    pub diameter_within: f64,
}

impl ReachRule {
    /// Features out of reach are refused; 2 mm clearance, drills within 0.05 mm of the hole.
    #[must_use]
    pub fn new(up: Up) -> Self {
        Self { up, out_of_reach: OutOfReach::Refuse, clearance: 2.0, diameter_within: 0.05 }
    }
}

/// Why a tool cannot make a hole, by how much it fails and what would do.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ReachError {
    /// The machine has no drill of that diameter.
    #[error("the machine has no drill of {diameter} mm (its drills: {drills:?} mm)")]
    NoDrill {
        /// Diameter of the hole, mm.
        diameter: f64,
        /// Diameters of the drills there are, mm.
        drills: Vec<f64>,
    },
    /// The hole is drilled from below or level with the board.
    #[error("the drill would have to come from {:.2}° from the vertical, that is level with the board or from below; turn the panel over or drill at an angle to the face", .tilt.to_degrees())]
    FromBelow {
        /// Angle of the tool axis from the vertical, radians.
        tilt: f64,
    },
    /// The head cannot tilt as far.
    #[error("the tool would have to tilt {:.2}°: {cause}", .tilt.to_degrees())]
    Tilt {
        /// Angle of the tool axis from the vertical, radians.
        tilt: f64,
        /// What the machine says.
        cause: KinematicsError,
    },
    /// The cutting edges are too short for the hole and the waste above it.
    #[error("at a tilt of {:.2}° the drill {tool} goes through {needed:.1} mm of wood (hole and waste), it cuts {cutting_length} mm; {:.1} mm more would do", .tilt.to_degrees(), needed - cutting_length)]
    Shallow {
        /// Tool number.
        tool: u32,
        /// Angle of the tool axis from the vertical, radians.
        tilt: f64,
        /// Length in the wood, mm.
        needed: f64,
        /// Length that the tool cuts, mm.
        cutting_length: f64,
    },
    /// Shank, holder or spindle would touch the board.
    #[error("at a tilt of {:.2}° the {what} of drill {tool} comes {shortfall:.1} mm too low over the board; a drill {longer:.1} mm longer would do", .tilt.to_degrees())]
    Collision {
        /// Tool number.
        tool: u32,
        /// "shank", "holder" or "spindle".
        what: &'static str,
        /// Angle of the tool axis from the vertical, radians.
        tilt: f64,
        /// How much higher it would have to be, mm.
        shortfall: f64,
        /// How much longer the tool would have to be, mm.
        longer: f64,
    },
    /// The drill would go through the sacrificial layer into the table.
    #[error("drill {tool} would reach {below:.1} mm under the board, the sacrificial layer is {allowed} mm thick; make the hole {:.1} mm shallower", (below - allowed) / .tilt.cos())]
    Table {
        /// Tool number.
        tool: u32,
        /// Angle of the tool axis from the vertical, radians.
        tilt: f64,
        /// Lowest point of the drill under the board, mm.
        below: f64,
        /// Thickness of the sacrificial layer, mm.
        allowed: f64,
    },
}

/// A feature that the machine cannot reach.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("panel {panel}{}, {purpose}: {cause}{}", .edge.map_or(String::new(), |e| format!(", edge {e}")), if *.by_hand { " (on the list of hand work)" } else { "" })]
pub struct ReachIssue {
    /// Panel.
    pub panel: u32,
    /// Edge of the panel, if any.
    pub edge: Option<u32>,
    /// Joint number, if any.
    pub joint: Option<u32>,
    /// Purpose of the feature.
    pub purpose: Cow<'static, str>,
    /// Whether it went to the list of hand work; otherwise it was left out, and the issue is fatal.
    pub by_hand: bool,
    /// The reason, for the tool that comes nearest.
    pub cause: ReachError,
}

/// So many features are checked before it is asked whether to go on: some milliseconds of work.
const OFTEN: usize = 1 << 11;

/// Checks every drilled feature and sorts out those that `machine` cannot make; other features pass. Of several fitting
/// drills the first that reaches is good enough. Holder and spindle must stay above a board without end, so clamps,
/// table edges and other parts are not looked at here (the proof does). The order of features is kept. O(features ·
/// tools).
/// Stops early when `go` says no, and what there is then is of no use.
#[must_use]
pub fn check_reach(
    set: &PanelSet,
    features: FeatureSet,
    machine: &Machine,
    rule: &ReachRule,
    go: &(dyn Fn() -> bool + Sync),
) -> (FeatureSet, Vec<ReachIssue>) {
    let mut out = FeatureSet { by_hand: features.by_hand, hardware: features.hardware, ..FeatureSet::default() };
    let mut issues = Vec::new();
    let all = features.features;
    let mut faults = Vec::new();
    for (k, some) in all.chunks(OFTEN).enumerate() {
        if !go() {
            return (out, issues);
        }
        let fault = |(i, f)| reach(set, f, machine, rule).err().map(|cause| (k * OFTEN + i, cause));
        faults.par_extend(some.par_iter().enumerate().filter_map(fault));
    }
    if faults.is_empty() {
        out.features = all;
        return (out, issues);
    }
    let mut faults = faults.into_iter().peekable();
    for (i, feature) in all.into_iter().enumerate() {
        let Some((_, cause)) = faults.next_if(|(at, _)| *at == i) else {
            out.features.push(feature);
            continue;
        };
        let by_hand = rule.out_of_reach == OutOfReach::ByHand;
        let Feature { panel, edge, joint, ref purpose, .. } = feature;
        let purpose = purpose.clone();
        issues.push(ReachIssue { panel, edge, joint, purpose, by_hand, cause });
        if by_hand {
            out.by_hand.push(feature);
        }
    }
    out.by_hand.sort_by_key(|f| f.panel);
    (out, issues)
}

/// Whether any drill of `machine` reaches the feature; features other than holes pass. O(tools).
///
/// # Errors
/// The failure of the last fitting drill, or that there is none.
pub fn reach(set: &PanelSet, feature: &Feature, machine: &Machine, rule: &ReachRule) -> Result<(), ReachError> {
    let Machining::Drill { diameter, .. } = feature.machining else { return Ok(()) };
    let drills = || machine.tools.iter().filter(|t| matches!(t.kind, ToolKind::Drill { .. }));
    let mut failure = ReachError::NoDrill { diameter, drills: drills().map(|t| t.diameter).collect() };
    for tool in drills().filter(|t| (t.diameter - diameter).abs() <= rule.diameter_within) {
        match reach_with(set, feature, machine, tool, rule) {
            Ok(()) => return Ok(()),
            Err(e) => failure = e,
        }
    }
    Err(failure)
}

/// Whether `tool` reaches a hole of panel `feature.panel` on a board with `rule.up` up; features other than holes pass.
///
/// # Errors
/// What stands in the way, and what would do.
pub fn reach_with(
    set: &PanelSet,
    feature: &Feature,
    machine: &Machine,
    tool: &Tool,
    rule: &ReachRule,
) -> Result<(), ReachError> {
    let Machining::Drill { entry, axis, depth, .. } = feature.machining else { return Ok(()) };
    let i = feature.panel as usize;
    let Some(upper) = (match rule.up {
        Up::Front => set.front_plane(i),
        Up::Back => set.back_plane(i),
    }) else {
        return Ok(());
    };
    drill_reach(upper, set.thickness, [entry, axis], depth, machine, tool, rule.clearance)
}

fn drill_reach(
    upper: Plane,
    thickness: f64,
    [entry, axis]: [DVec3; 2],
    depth: f64,
    machine: &Machine,
    tool: &Tool,
    clearance: f64,
) -> Result<(), ReachError> {
    let cos = -axis.dot(upper.normal);
    let sin = axis.cross(upper.normal).length();
    let (tilt, number) = (sin.atan2(cos), tool.number);
    // A tool that is level with the board never leaves it.
    if cos <= f64::EPSILON {
        return Err(ReachError::FromBelow { tilt });
    }
    // Where the part will be turned to is not known yet, so only the tilt counts.
    let leaning = DVec3::new(sin, 0.0, cos).normalize();
    machine.angles(leaning, [0.0, 0.0]).map_err(|cause| ReachError::Tilt { tilt, cause })?;
    // Heights over the board's upper plane.
    let tip = upper.distance(entry + axis * depth);
    let needed = (-tip + 0.5 * tool.diameter * sin) / cos;
    if needed > tool.cutting_length {
        return Err(ReachError::Shallow { tool: number, tilt, needed, cutting_length: tool.cutting_length });
    }
    let lowest = |parts: &[Revolved]| {
        let ends = parts.iter().flat_map(|r| [(r.from, r.radius_from), (r.to, r.radius_to)]);
        ends.map(|(along, radius)| tip + along * cos - radius * sin).fold(f64::INFINITY, f64::min)
    };
    let body = machine.body(tool);
    for (what, parts, above) in
        [("shank", &body.shank, 0.0), ("holder", &body.holder, clearance), ("spindle", &body.spindle, clearance)]
    {
        let shortfall = above - lowest(parts);
        if shortfall > 0.0 {
            return Err(ReachError::Collision { tool: number, what, tilt, shortfall, longer: shortfall / cos });
        }
    }
    let (below, allowed) = (-thickness - lowest(&body.cutter), machine.table.sacrificial);
    if below > allowed {
        return Err(ReachError::Table { tool: number, tilt, below, allowed });
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::joint::{Direction, FastenerRule, lay_fasteners};
    use crate::machine::test_machine;
    use crate::panel::{ThickenParams, shells, thicken};
    use std::sync::atomic::{AtomicUsize, Ordering};

    fn shell(d: f64) -> PanelSet {
        let mesh = shells::vector_sum(&shells::arc(16, 4500.0, 1400.0), &shells::folded(16, 280.0, 25.0));
        thicken(&mesh, &ThickenParams::new(d)).unwrap().0
    }

    fn machine() -> Machine {
        let mut m = test_machine();
        let mut drill = m.tools[0].clone();
        (drill.number, drill.diameter, drill.shank_diameter) = (6, 6.0, 6.0);
        m.tools.push(drill);
        m
    }

    #[test]
    fn toe_pilots_are_reached_on_a_thin_board() {
        let set = shell(10.0);
        for up in [Up::Front, Up::Back] {
            let (laid, _) = lay_fasteners(&set, &FastenerRule::toe_screws(up)).unwrap();
            assert!(laid.features.len() > 1000);
            let (checked, issues) = check_reach(&set, laid.clone(), &machine(), &ReachRule::new(up), &|| true);
            assert_eq!(issues, []);
            assert_eq!(checked, laid);
            let other = if up == Up::Front { Up::Back } else { Up::Front };
            let (none, issues) = check_reach(&set, laid.clone(), &machine(), &ReachRule::new(other), &|| true);
            assert!(none.features.is_empty() && issues.len() == laid.features.len());
            assert!(issues.iter().all(|i| matches!(i.cause, ReachError::FromBelow { .. })));
        }
    }

    #[test]
    fn checking_stops_soon_after_it_is_told_to() {
        let set = shell(10.0);
        let (mut laid, _) = lay_fasteners(&set, &FastenerRule::toe_screws(Up::Back)).unwrap();
        while laid.features.len() < 4 * OFTEN {
            laid.features.extend_from_within(..);
        }
        let asked = AtomicUsize::new(0);
        let go = || asked.fetch_add(1, Ordering::Relaxed) < 2;
        let (checked, issues) = check_reach(&set, laid, &machine(), &ReachRule::new(Up::Front), &go);
        assert_eq!((asked.into_inner(), checked.features.len(), issues.len()), (3, 0, 0));
    }

    #[test]
    fn chamfer_normal_holes_are_not_reached_on_a_thin_board() {
        let set = shell(10.0);
        let rule = FastenerRule { cover: 1.0, ..FastenerRule::dowels(Direction::ChamferNormal) };
        let (laid, _) = lay_fasteners(&set, &rule).unwrap();
        assert!(laid.features.len() > 100);
        for out_of_reach in [OutOfReach::Refuse, OutOfReach::ByHand] {
            let reach = ReachRule { out_of_reach, ..ReachRule::new(Up::Back) };
            let (checked, issues) = check_reach(&set, laid.clone(), &machine(), &reach, &|| true);
            assert_eq!(checked.features, []);
            assert_eq!(issues.len(), laid.features.len());
            assert_eq!(
                checked.by_hand,
                if out_of_reach == OutOfReach::ByHand { laid.features.clone() } else { vec![] }
            );
            assert_eq!(checked.hardware, laid.hardware);
            let by_cause = |f: fn(&ReachError) -> bool| issues.iter().filter(|i| f(&i.cause)).count();
            let shallow = by_cause(|c| matches!(c, ReachError::Shallow { .. }));
            let below = by_cause(|c| matches!(c, ReachError::FromBelow { .. }));
            assert!(shallow > 0 && below > 0 && shallow + below == issues.len());
        }
    }

    #[test]
    fn toe_dowels_are_reached_where_straight_ones_are_not() {
        let set = shell(21.0);
        let rule = FastenerRule { end_distance: 50.0, ..FastenerRule::toe_dowels(Up::Back) };
        let (laid, issues) = lay_fasteners(&set, &rule).unwrap();
        assert_eq!(issues, []);
        let (checked, issues) = check_reach(&set, laid.clone(), &machine(), &ReachRule::new(Up::Back), &|| true);
        assert_eq!(issues, []);
        assert_eq!(checked, laid);
        assert!(laid.hardware.iter().all(|h| h.name.starts_with("Dowel 6 x ")));
        let rule = FastenerRule { end_distance: 50.0, ..FastenerRule::dowels(Direction::ChamferNormal) };
        let (laid, _) = lay_fasteners(&set, &rule).unwrap();
        let (checked, issues) = check_reach(&set, laid.clone(), &machine(), &ReachRule::new(Up::Back), &|| true);
        assert!(checked.features.is_empty() && issues.len() == laid.features.len());
    }

    /// A hole in the middle of a level board whose front is z = 0, `tilt` from the vertical.
    fn try_hole(tilt: f64, depth: f64, change: impl FnOnce(&mut Machine)) -> Result<(), ReachError> {
        let mut m = machine();
        change(&mut m);
        let axis = DVec3::new(tilt.sin(), 0.0, -tilt.cos());
        let upper = Plane { normal: DVec3::Z, offset: 0.0 };
        let tool = m.tool(1).cloned().unwrap();
        drill_reach(upper, 21.0, [DVec3::ZERO, axis], depth, &m, &tool, 2.0)
    }

    #[test]
    fn what_is_named_would_do() {
        assert_eq!(try_hole(0.0, 10.0, |_| ()), Ok(()));
        // Tilt.
        let Err(ReachError::Tilt { cause, .. }) =
            try_hole(0.8, 10.0, |m| (m.secondary.min, m.secondary.max) = (-30.0, 30.0))
        else {
            panic!()
        };
        assert!(cause.to_string().contains("axis B"));
        // Cutting length: 10 mm at 60° reach 10 mm along the axis, and the far side of the drill further.
        let tilt = 60f64.to_radians();
        let needed = 10.0 + 2.0 * tilt.tan();
        let cut = |length: f64| {
            try_hole(tilt, 10.0, |m| {
                m.tools[0].cutting_length = length;
                m.spindle.clear();
                m.tools[0].holder.clear();
            })
        };
        let Err(ReachError::Shallow { needed: named, .. }) = cut(13.0) else { panic!() };
        assert!((named - needed).abs() < 1e-12);
        assert_eq!(cut(needed + 1e-9), Ok(()));
        // Holder, then spindle: the length that is named does.
        for fat in [0, 1] {
            let stretched = |by: f64| {
                try_hole(tilt, 10.0, |m| {
                    let tool = &mut m.tools[0];
                    (tool.length, tool.cutting_length) = (40.0 + by, 30.0);
                    for (k, r) in tool.holder.iter_mut().enumerate() {
                        (r.from, r.to) = (40.0 + by + 45.0 * k as f64, 85.0 + by + 45.0 * k as f64);
                        (r.radius_from, r.radius_to) = if fat == 0 { (30.0, 30.0) } else { (5.0, 5.0) };
                    }
                    m.spindle[0].radius_from = 90.0;
                })
            };
            let Err(ReachError::Collision { what, longer, .. }) = stretched(0.0) else {
                panic!("{:?}", stretched(0.0))
            };
            assert_eq!(what, ["holder", "spindle"][fat]);
            assert_ne!(stretched(longer - 1e-6), Ok(()));
            let after = stretched(longer + 1e-9);
            assert!(!matches!(after, Err(ReachError::Collision { what: w, .. }) if w == what), "{after:?}");
        }
        // Table: 21 mm of board and 19 mm below it.
        assert_eq!(try_hole(0.0, 39.9, |_| ()), Ok(()));
        let Err(ReachError::Table { below, allowed, .. }) = try_hole(0.0, 41.0, |_| ()) else { panic!() };
        assert!((below - 20.0).abs() < 1e-12 && allowed == 19.0);
    }

    #[test]
    fn a_missing_drill_is_named() {
        let set = shell(21.0);
        let (laid, _) = lay_fasteners(&set, &FastenerRule::screws()).unwrap();
        let mut m = machine();
        m.tools.retain(|t| t.diameter != 3.0);
        let cause = reach(&set, &laid.features[0], &m, &ReachRule::new(Up::Front)).unwrap_err();
        assert_eq!(cause, ReachError::NoDrill { diameter: 3.0, drills: vec![4.0, 6.0] });
    }
}
