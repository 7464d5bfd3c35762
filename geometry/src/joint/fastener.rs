//! Fasteners laid along edges: spacing, matched holes in both panels, hardware (METHODS §6, 000 §6.4).

use super::cover::{Hole, PanelPlanes, segment_distance};
use super::edges::{JointEdge, select_edges};
use super::feature::{Feature, FeatureSet, Hardware, Machining};
use super::issue::{FastenerError, JointIssue};
use super::rule::{Direction, Fastener, FastenerRule, Head, Height, Pin, PinKind, ShortEdge, Toe, ToeLength};
use crate::board::Up;
use crate::panel::{EdgeRef, PanelSet};
use crate::plane::Plane;
use glam::DVec3;
use std::collections::BTreeMap;

/// Lengths in which dowels of hard wood are sold, mm.
pub const DOWEL_LENGTHS: [f64; 10] = [20.0, 25.0, 30.0, 35.0, 40.0, 50.0, 60.0, 80.0, 100.0, 120.0];

/// Lengths in which screws are sold, mm.
pub const SCREW_LENGTHS: [f64; 16] =
    [10.0, 12.0, 16.0, 20.0, 25.0, 30.0, 35.0, 40.0, 45.0, 50.0, 60.0, 70.0, 80.0, 90.0, 100.0, 120.0];

/// Lays the fasteners of one rule; see [`lay_all`].
///
/// # Errors
/// A parameter out of its range.
pub fn lay_fasteners(set: &PanelSet, rule: &FastenerRule) -> Result<(FeatureSet, Vec<JointIssue>), FastenerError> {
    lay_all(set, std::slice::from_ref(rule), &|| true)
}

/// Lays the fasteners of several rules, one after the other.
///
/// Each edge is treated once: on the line `height` of its chamfer, as far as both panels' chamfers reach, `L = line − 2
/// end_distance` is divided into `ceil(L / spacing)` equal intervals with a fastener at each end (000 §6.4.1). The holes
/// of one fastener share a joint number and lie on one axis. A fastener that leaves too little wood, or meets a hole
/// laid before it, is left out on both panels and gives a fatal issue. Features are ordered by panel. Time O(e + p·h²)
/// for e edges and h holes in each of p panels.
///
/// # Errors
/// A parameter out of its range, or `go` says no: [`FastenerError::Cancelled`].
pub fn lay_all(
    set: &PanelSet,
    rules: &[FastenerRule],
    go: &(dyn Fn() -> bool + Sync),
) -> Result<(FeatureSet, Vec<JointIssue>), FastenerError> {
    rules.iter().try_for_each(FastenerRule::check)?;
    let mut lay = Lay::new(set);
    for rule in rules {
        let edges: Vec<EdgeRef> = select_edges(set, rule.edges, rule.head).iter().map(JointEdge::own).collect();
        lay.edges(rule, &edges, go)?;
    }
    Ok(lay.done())
}

/// Lays the fasteners of one rule along edges that were selected before; the rule's own selection does not count. Which
/// of an edge's panels is the first follows `rule.head` alone. Otherwise as [`lay_all`].
///
/// # Errors
/// As [`lay_all`], or an edge is not of the set.
pub fn lay_edges(
    set: &PanelSet,
    edges: &[JointEdge],
    rule: &FastenerRule,
    go: &dyn Fn() -> bool,
) -> Result<(FeatureSet, Vec<JointIssue>), FastenerError> {
    rule.check()?;
    let own: Vec<EdgeRef> = edges.iter().map(JointEdge::own).collect();
    let strange = own.iter().find(|e| e.edge as usize >= corners(set, e.panel));
    if let Some(&EdgeRef { panel, edge }) = strange {
        return Err(FastenerError::NoSuchEdge { panel, edge });
    }
    let mut lay = Lay::new(set);
    lay.edges(rule, &own, go)?;
    Ok(lay.done())
}

/// Number of corners of a panel; 0 past the end.
fn corners(set: &PanelSet, panel: u32) -> usize {
    if (panel as usize) < set.len() { set.corners(panel as usize).len() } else { 0 }
}

struct Lay<'a> {
    set: &'a PanelSet,
    planes: PanelPlanes,
    features: Vec<Feature>,
    /// The holes of each panel.
    bores: Vec<Vec<Bore>>,
    /// By name, and bits of diameter and length.
    hardware: BTreeMap<(&'static str, [u64; 2]), u64>,
    issues: Vec<JointIssue>,
    joints: u32,
}

/// One panel's view of an edge.
#[derive(Clone, Copy)]
struct Half {
    panel: u32,
    edge: u32,
    /// Unit direction of the edge.
    along: DVec3,
    /// Plane of the front face.
    front: Plane,
    chamfer: Plane,
}

impl Half {
    /// In the front face, perpendicular to the edge, away from the panel.
    fn outward(&self) -> DVec3 {
        self.along.cross(self.front.normal)
    }
}

/// Where one fastener goes.
#[derive(Clone, Copy)]
struct Place<'a> {
    rule: &'a FastenerRule,
    first: Half,
    second: Option<Half>,
    at: DVec3,
    /// Along the edge, from 0.
    number: u32,
}

impl Place<'_> {
    fn hole(&self, entry: DVec3, axis: DVec3) -> Hole {
        let radius = 0.5 * self.rule.hole();
        Hole { entry, axis, radius, point: (radius / (0.5 * self.rule.point_angle).tan()).max(0.0) }
    }

    /// Cosine between the axis and the chamfer's normal, if the fastener crosses the chamfer steeply enough.
    fn crossing(&self, axis: DVec3) -> Result<f64, JointIssue> {
        let across = axis.dot(self.first.chamfer.normal);
        let (angle, least) = (across.clamp(-1.0, 1.0).asin(), self.rule.least_crossing);
        if angle < least {
            let (panel, edge) = (self.first.panel, self.first.edge);
            return Err(JointIssue::AlongChamfer { panel, edge, angle, least });
        }
        Ok(across)
    }

    fn enough_wood(&self, half: Half, remains: f64) -> Result<(), JointIssue> {
        let cover = self.rule.cover;
        if remains < cover {
            let (panel, edge, number) = (half.panel, half.edge, self.number);
            return Err(JointIssue::ThinWood { panel, edge, number, diameter: self.rule.hole(), remains, cover });
        }
        Ok(())
    }
}

impl<'a> Lay<'a> {
    fn new(set: &'a PanelSet) -> Self {
        Self {
            set,
            planes: PanelPlanes::new(set),
            features: Vec::new(),
            bores: (0..set.len()).map(|_| Vec::new()).collect(),
            hardware: BTreeMap::new(),
            issues: Vec::new(),
            joints: 0,
        }
    }

    /// Lays a rule along edges, each given from the side that comes first in the set.
    fn edges(&mut self, rule: &FastenerRule, edges: &[EdgeRef], go: &dyn Fn() -> bool) -> Result<(), FastenerError> {
        let mut before = None;
        for edge in edges {
            if before.replace(edge.panel) != Some(edge.panel) && !go() {
                return Err(FastenerError::Cancelled);
            }
            self.edge(rule, *edge);
        }
        Ok(())
    }

    /// The features by panel, and the hardware.
    fn done(self) -> (FeatureSet, Vec<JointIssue>) {
        let mut features = self.features;
        // Features are large: their numbers are sorted first, then each is moved once.
        features.sort_by_cached_key(|f| f.panel);
        let name = |name: &str, [d, l]: [u64; 2]| format!("{name} {} x {}", f64::from_bits(d), f64::from_bits(l));
        let hardware = self.hardware.into_iter();
        let hardware = hardware.map(|((kind, size), count)| Hardware { name: name(kind, size), count }).collect();
        (FeatureSet { features, by_hand: Vec::new(), hardware }, self.issues)
    }

    fn half(&self, panel: u32, edge: u32) -> Half {
        let corners = self.set.corners(panel as usize);
        let c = corners.start + edge as usize;
        let next = corners.start + (edge as usize + 1) % corners.len();
        Half {
            panel,
            edge,
            along: (self.set.front[next] - self.set.front[c]).normalize(),
            front: Plane::through(self.set.front[corners.start], self.set.normal[panel as usize]),
            chamfer: self.set.chamfer[c],
        }
    }

    /// The line at `height` on an edge's chamfer.
    fn chord(&self, panel: u32, edge: u32, height: f64) -> [DVec3; 2] {
        let (set, corners) = (self.set, self.set.corners(panel as usize));
        let c = corners.start + edge as usize;
        let next = corners.start + (edge as usize + 1) % corners.len();
        [set.front[c].lerp(set.back_start[c], height), set.front[next].lerp(set.back_end[c], height)]
    }

    fn edge(&mut self, rule: &FastenerRule, EdgeRef { panel, edge }: EdgeRef) {
        let c = self.set.corners(panel as usize).start + edge as usize;
        let neighbour = self.set.neighbour[c].get();
        let (own, other) = (self.half(panel, edge), neighbour.map(|n| self.half(n.panel, n.edge)));
        let height = match rule.height {
            Height::At(height) => height,
            Height::Balanced => {
                let (first, second) = self.by_head(rule.head, own, other, 0);
                self.balanced(&Place { rule, first, second, at: DVec3::ZERO, number: 0 })
            }
        };
        let [from, to] = self.chord(panel, edge, height);
        let along = (to - from).normalize();
        let (mut start, mut end) = (0.0, from.distance(to));
        if let Some(n) = neighbour {
            let [b, a] = self.chord(n.panel, n.edge, height).map(|p| along.dot(p - from));
            (start, end) = (f64::max(start, a), f64::min(end, b));
        }
        for (number, s) in self.places(rule, panel, edge, [start, end]).into_iter().enumerate() {
            let (first, second) = self.by_head(rule.head, own, other, number);
            let place = Place { rule, first, second, at: from + along * s, number: number as u32 };
            let laid = match rule.fastener {
                Fastener::Toe(toe) => self.toe(&place, &toe),
                Fastener::Pin(pin) => self.pin(&place, &pin),
            };
            if let Err(issue) = laid.and_then(|laid| self.keep(rule, laid)) {
                self.issues.push(issue);
            }
        }
    }

    /// Where the fasteners stand between `start` and `end` of the line.
    fn places(&mut self, rule: &FastenerRule, panel: u32, edge: u32, [start, end]: [f64; 2]) -> Vec<f64> {
        let length = end - start;
        let free = length - 2.0 * rule.end_distance;
        if free > 0.0 && free >= rule.least_spacing {
            let intervals = (free / rule.spacing).ceil();
            let step = free / intervals;
            return (0..=intervals as u64).map(|k| start + rule.end_distance + step * k as f64).collect();
        }
        let laid = rule.short_edge == ShortEdge::Middle && length > 0.0;
        let needed = 2.0 * rule.end_distance + rule.least_spacing;
        self.issues.push(JointIssue::EdgeTooShort { panel, edge, length, needed, laid });
        if laid { vec![0.5 * (start + end)] } else { Vec::new() }
    }

    /// The panel with the head first.
    fn by_head(&self, head: Head, own: Half, other: Option<Half>, number: usize) -> (Half, Option<Half>) {
        let Some(other) = other else { return (own, None) };
        let key = |h: Half| (self.set.address[h.panel as usize], h.panel);
        let want_lower = match head {
            Head::LowerAddress => true,
            Head::HigherAddress => false,
            Head::Alternate => number.is_multiple_of(2),
        };
        if (key(own) <= key(other)) == want_lower { (own, Some(other)) } else { (other, Some(own)) }
    }

    /// The height at which the holes of a place keep as much wood towards the front as towards the back.
    fn balanced(&self, place: &Place) -> f64 {
        let mut reach = [0f64; 2];
        let mut widen = |half: Half, axis: DVec3, depth: f64| {
            let hole = place.hole(DVec3::ZERO, axis);
            let mouth = hole.mouth_reach(half.front.normal, half.chamfer.normal);
            for (side, reach) in [1.0, -1.0].into_iter().zip(&mut reach) {
                let towards = side * axis.dot(half.front.normal);
                let rim = hole.radius * (1.0 - towards * towards).max(0.0).sqrt();
                let tip = (depth * towards).max((depth - hole.point) * towards + rim);
                *reach = reach.max(mouth).max(if depth > 0.0 { tip } else { 0.0 });
            }
        };
        match place.rule.fastener {
            Fastener::Toe(toe) => {
                let axis = self.toe_axis(&toe, &place.first).1;
                [Some(place.first), place.second].into_iter().flatten().for_each(|half| widen(half, axis, 0.0));
            }
            Fastener::Pin(pin) => {
                let axis = pin_axis(&pin, &place.first);
                widen(place.first, -axis, pin.depth[0]);
                if let Some(second) = place.second {
                    widen(second, axis, pin.depth[1]);
                }
            }
        }
        (0.5 + 0.5 * (reach[0] - reach[1]) / self.set.thickness).clamp(0.0, 1.0)
    }

    /// The face from which an oblique fastener is driven, and its direction.
    fn toe_axis(&self, toe: &Toe, first: &Half) -> (Plane, DVec3) {
        let face = match toe.up {
            Up::Front => first.front,
            Up::Back => Plane { normal: -first.front.normal, offset: self.set.thickness - first.front.offset },
        };
        let (sin, cos) = toe.angle.sin_cos();
        (face, (first.outward() * cos - face.normal * sin).normalize())
    }

    /// The holes of an oblique fastener, and its name.
    fn toe(&self, place: &Place, toe: &Toe) -> Result<Laid, JointIssue> {
        let Place { rule, first, second, at, number } = *place;
        let (panel, edge, cover) = (first.panel, first.edge, rule.cover);
        let (purpose, name, sold) = match toe.kind {
            PinKind::Screw => ("toe screw", "Screw", &SCREW_LENGTHS[..]),
            PinKind::Dowel => ("toe dowel", "Dowel", &DOWEL_LENGTHS[..]),
        };
        let (face, axis) = self.toe_axis(toe, &first);
        let across = place.crossing(axis)?;
        let in_first = -face.distance(at) / toe.angle.sin();
        let hole = place.hole(at - axis * in_first, axis);
        let mouth = hole.beside_mouth(hole.entry, face, self.planes.others(panel, face));
        let exit = hole.beside_mouth(at, first.chamfer, self.planes.others(panel, first.chamfer));
        place.enough_wood(first, mouth.min(exit))?;
        // Through the chamfer with the full diameter, into the waste beside the panel.
        let through = in_first + hole.radius * (1.0 - across * across).max(0.0).sqrt() / across + hole.point;
        let mut holes = [Some(drill(first, &hole, through, purpose)), None];
        let bite = match second {
            Some(q) => {
                let hole = place.hole(at, axis);
                let others = self.planes.others(q.panel, q.chamfer);
                place.enough_wood(q, hole.beside_mouth(at, q.chamfer, others.clone()))?;
                let largest = hole.deepest(cover, others);
                let bite = largest.min(toe.bite);
                if bite < toe.least_bite {
                    let (panel, edge, depth) = (q.panel, q.edge, toe.least_bite);
                    return Err(JointIssue::TooDeep { panel, edge, number, depth, cover, largest });
                }
                holes[1] = Some(drill(q, &hole, bite, purpose));
                bite
            }
            None => toe.bite,
        };
        let longest = in_first + bite;
        let length = match toe.length {
            ToeLength::Given(length) => length,
            ToeLength::Longest => sold.iter().rev().copied().find(|&l| l <= longest).unwrap_or(sold[0]),
        };
        if length > longest {
            return Err(JointIssue::TooLong { panel, edge, number, length, longest });
        }
        Ok(Laid { holes, name, size: [toe.diameter, length] })
    }

    /// The holes of a pin, and the pin's name.
    fn pin(&self, place: &Place, pin: &Pin) -> Result<Laid, JointIssue> {
        let Place { rule, first, second, at, number } = *place;
        let axis = pin_axis(pin, &first);
        place.crossing(axis)?;
        let (purpose, name) = match pin.kind {
            PinKind::Screw => ("screw", "Screw"),
            PinKind::Dowel => ("dowel", "Dowel"),
        };
        let mut holes = [None, None];
        let sides = [(Some(first), -axis, pin.depth[0]), (second, axis, pin.depth[1])];
        for (place_of, (half, axis, depth)) in holes.iter_mut().zip(sides) {
            let Some(half) = half else { continue };
            let hole = place.hole(at, axis);
            let others = self.planes.others(half.panel, half.chamfer);
            place.enough_wood(half, hole.beside_mouth(at, half.chamfer, others.clone()))?;
            let largest = hole.deepest(rule.cover, others);
            if largest < depth {
                let (panel, edge, cover) = (half.panel, half.edge, rule.cover);
                return Err(JointIssue::TooDeep { panel, edge, number, depth, cover, largest });
            }
            *place_of = Some(drill(half, &hole, depth, purpose));
        }
        Ok(Laid { holes, name, size: [pin.diameter, pin.length] })
    }

    /// Keeps the holes of one fastener unless they meet others.
    fn keep(&mut self, rule: &FastenerRule, laid: Laid) -> Result<(), JointIssue> {
        let radius = 0.5 * rule.hole();
        let bores = laid.holes.each_ref().map(|hole| hole.as_ref().and_then(|f| Bore::of(f, radius)));
        for (hole, bore) in laid.holes.iter().zip(&bores) {
            let (Some(hole), Some(bore)) = (hole, bore) else { continue };
            for other in &self.bores[hole.panel as usize] {
                let gap = segment_distance(bore.axis, other.axis) - bore.radius - other.radius;
                if gap < rule.cover {
                    let edges = [other.edge, bore.edge];
                    return Err(JointIssue::HolesMeet { panel: hole.panel, edges, gap, cover: rule.cover });
                }
            }
        }
        for (hole, bore) in laid.holes.into_iter().zip(bores) {
            let (Some(hole), Some(bore)) = (hole, bore) else { continue };
            self.bores[hole.panel as usize].push(bore);
            self.features.push(Feature { joint: Some(self.joints), ..hole });
        }
        self.joints += 1;
        // Positive numbers order as their bits do.
        *self.hardware.entry((laid.name, laid.size.map(f64::to_bits))).or_default() += 1;
        Ok(())
    }
}

/// The holes of one fastener, and its trade name with diameter and length.
struct Laid {
    holes: [Option<Feature>; 2],
    name: &'static str,
    size: [f64; 2],
}

/// A hole as its neighbours see it.
struct Bore {
    axis: [DVec3; 2],
    radius: f64,
    edge: u32,
}

impl Bore {
    fn of(feature: &Feature, radius: f64) -> Option<Self> {
        match feature.machining {
            Machining::Drill { entry, axis, depth, .. } => {
                Some(Self { axis: [entry, entry + axis * depth], radius, edge: feature.edge? })
            }
            _ => None,
        }
    }
}

/// Unit direction of a pin from the first panel to the second.
fn pin_axis(pin: &Pin, first: &Half) -> DVec3 {
    let axis = match pin.direction {
        Direction::ChamferNormal => first.chamfer.normal,
        Direction::Section(angle) => first.outward() * angle.cos() - first.front.normal * angle.sin(),
        Direction::Given(v) => v.normalize() * v.dot(first.chamfer.normal).signum(),
    };
    axis.normalize()
}

fn drill(half: Half, hole: &Hole, depth: f64, purpose: &'static str) -> Feature {
    Feature {
        panel: half.panel,
        edge: Some(half.edge),
        joint: None,
        purpose: purpose.into(),
        machining: Machining::Drill { entry: hole.entry, axis: hole.axis, depth, diameter: 2.0 * hole.radius },
    }
}
