//! Judges one part: how deep anything cuts into it, what is left on its faces, whether its holes and engravings are made.

use super::depth::{depth, depth_bound};
use super::ray::ray_interval;
use super::report::{Fault, PartVerdict, ProofParams, Reason};
use super::run::Cut;
use super::sweep::Aabb;
use super::workpiece::{Engraving, Face, Hole, Workpiece};
use crate::machine::{Machine, Tool, ToolKind};
use crate::mesh::Address;
use glam::DVec3;

/// How far beyond the part sweeps are looked for, mm: leftovers up to this size are measured to the next cut.
pub(crate) const AROUND: f64 = 5.0;

/// First, wide spacing of samples, mm: a face that fails there need not be looked at closely.
const WIDE: f64 = 12.0;

/// What judging a part needs.
pub(crate) struct Judge<'a> {
    pub machine: &'a Machine,
    pub params: &'a ProofParams,
    pub stock: Aabb,
    pub piece: &'a Workpiece,
    /// All sweeps near the part, in the order of the program.
    pub cuts: Vec<&'a Cut>,
    pub address: Address,
}

impl Judge<'_> {
    /// The verdict on the part, with reasons if it fails. O(sweeps · faces) where every face is cleared by one cut.
    pub fn verdict(&self, board: u32) -> (PartVerdict, Vec<Reason>) {
        let mut reasons = Vec::new();
        let beyond = self.beyond_board();
        if beyond > self.params.gouge {
            reasons.push(self.reason(None, None, beyond, Fault::OffBoard));
        }
        let (gouge, gouge_line, gouge_at) = self.gouge();
        if gouge > self.params.gouge {
            reasons.push(self.reason(gouge_line, Some(gouge_at), gouge, Fault::Gouge));
        }
        let (mut leftover, mut leftover_face, mut leftover_at) = (0.0, None, DVec3::ZERO);
        for face in &self.piece.faces {
            let (left, at) = self.leftover(face);
            if left > self.params.leftover {
                reasons.push(self.reason(None, Some(at), left, Fault::Leftover(face.name)));
            }
            if left > leftover || leftover_face.is_none() {
                (leftover, leftover_face, leftover_at) = (left, Some(face.name), at);
            }
        }
        for hole in &self.piece.holes {
            let missing = self.missing_hole(hole);
            if missing > self.params.leftover {
                let (feature, diameter, depth) = (hole.feature, 2.0 * hole.radius, hole.depth);
                let fault = Fault::MissingHole { feature, diameter, depth };
                reasons.push(self.reason(None, Some(hole.entry), missing, fault));
            }
        }
        for engraving in &self.piece.engravings {
            let (missing, at) = self.missing_engraving(engraving);
            if missing > self.params.leftover {
                let fault = Fault::MissingEngraving { feature: engraving.feature, text: engraving.text.clone() };
                reasons.push(self.reason(None, Some(at), missing, fault));
            }
        }
        for &feature in &self.piece.unproven {
            reasons.push(self.reason(None, None, 0.0, Fault::UnprovenFeature { feature }));
        }
        let verdict = PartVerdict {
            part: self.piece.part,
            board,
            passed: reasons.is_empty(),
            gouge,
            gouge_line,
            gouge_at,
            leftover,
            leftover_face,
            leftover_at,
        };
        (verdict, reasons)
    }

    fn reason(&self, line: Option<u32>, at: Option<DVec3>, by: f64, fault: Fault) -> Reason {
        Reason { line, part: Some((self.piece.part, self.address)), at, by, fault }
    }

    fn beyond_board(&self) -> f64 {
        let (p, s) = (&self.piece.aabb, &self.stock);
        (s.min - p.min).max(p.max - s.max).max_element()
    }

    /// The deepest cut. A point in a designed hole or groove is no gouge, and one near it is no deeper than its distance
    /// to it; so the least of all those bounds holds for a whole sweep.
    fn gouge(&self) -> (f64, Option<u32>, DVec3) {
        let planes = &self.piece.planes;
        let mut worst = (0.0, None, DVec3::ZERO);
        for cut in &self.cuts {
            if !cut.aabb.meets(&self.piece.aabb) {
                continue;
            }
            let mut bound = depth_bound(&cut.sweep, planes);
            if bound <= worst.0 {
                continue;
            }
            if bound > self.params.gouge && cut.cutting {
                bound = self.designed(cut).fold(bound, f64::min);
                if bound <= worst.0 {
                    continue;
                }
            }
            let mut at = cut.tips[1];
            if bound > self.params.gouge {
                let found = depth(&cut.sweep, planes, self.params.gouge, 5e-4);
                bound = bound.min(found.upper);
                at = found.at;
            }
            if bound > worst.0 {
                worst = (bound, Some(cut.line), at);
            }
        }
        worst
    }

    /// How far a cut leaves each designed hole and groove.
    fn designed(&self, cut: &Cut) -> impl Iterator<Item = f64> {
        let engraver = self.tool(cut).is_some_and(|t| matches!(t.kind, ToolKind::Engraver { .. }));
        let straight = cut.sweep.margin == 0.0;
        let holes = self.piece.holes.iter().map(|h| h.protrusion(&cut.sweep));
        let grooves = self.piece.engravings.iter().filter(move |_| engraver && straight);
        holes.chain(grooves.map(|e| e.protrusion(&cut.tips, cut.axis)))
    }

    fn tool(&self, cut: &Cut) -> Option<&Tool> {
        self.machine.tools.get(cut.tool as usize)
    }

    /// Most stock on a face and where. If one cut clears all corners it clears the face, because sweep and face are
    /// convex: no sampling then. Otherwise sample points are followed along the normal to the next cut, or out.
    fn leftover(&self, face: &Face) -> (f64, DVec3) {
        let Some(&first) = face.corners.first() else { return (0.0, DVec3::ZERO) };
        let exit = |q: DVec3| exit(&self.stock, q, face.normal);
        let out = out_of(&self.stock, &face.corners, face.normal);
        if out.0 <= self.params.leftover {
            return out;
        }
        let reach = Aabb::of(face.corners.iter().copied());
        let mut best = out;
        let wide = reach.grown(self.params.leftover);
        for cut in self.cuts.iter().filter(|c| c.cutting && c.aabb.meets(&wide)) {
            let mut most = (0.0, first);
            for q in &face.corners {
                let Some(left) = left_by(cut, *q, face.normal) else {
                    most.0 = f64::INFINITY;
                    break;
                };
                most = worse(most, (left, *q));
                if most.0 >= best.0 {
                    break;
                }
            }
            if most.0 < best.0 {
                best = most;
            }
        }
        if best.0 <= self.params.leftover {
            return best;
        }
        let near: Vec<&Cut> = {
            let wide = reach.grown(AROUND);
            self.cuts.iter().copied().filter(|c| c.cutting && c.aabb.meets(&wide)).collect()
        };
        let left = |q: DVec3| {
            let mut least = exit(q);
            for cut in &near {
                if least <= 0.0 {
                    break;
                }
                if let Some(left) = left_by(cut, q, face.normal) {
                    least = least.min(left);
                }
            }
            (least, q)
        };
        let coarse = samples(&face.corners, WIDE).map(left).fold((0.0, first), worse);
        if coarse.0 > self.params.leftover || self.params.sample >= WIDE {
            return coarse;
        }
        samples(&face.corners, self.params.sample.max(0.05)).map(left).fold(coarse, worse)
    }

    /// Depth missing to a hole that is drilled along its axis with its diameter, mm. What was drilled must reach from
    /// the entry to the full depth without a gap.
    fn missing_hole(&self, hole: &Hole) -> f64 {
        let tolerance = self.params.leftover;
        let mut drilled: Vec<(f64, f64)> = Vec::new();
        for cut in self.cuts.iter().filter(|c| c.cutting && c.sweep.margin == 0.0) {
            let Some(tool) = self.tool(cut) else { continue };
            let fits = (0.5 * tool.diameter - hole.radius).abs() <= tolerance;
            let aligned = cut.axis.dot(hole.axis) < 0.0 && (cut.axis + hole.axis).length() * hole.depth <= tolerance;
            if !fits || !aligned {
                continue;
            }
            let [u, v] = cut.tips.map(|tip| (tip - hole.entry).dot(hole.axis));
            let aside = |tip: DVec3, u: f64| (tip - hole.entry - hole.axis * u).length();
            if aside(cut.tips[0], u).max(aside(cut.tips[1], v)) <= tolerance {
                drilled.push((u.min(v) - tool.cutting_length, u.max(v)));
            }
        }
        drilled.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut reached = 0.0;
        for (from, to) in drilled {
            if from > reached + tolerance {
                break;
            }
            reached = f64::max(reached, to);
        }
        (hole.depth - reached).max(0.0)
    }

    /// Longest piece of a stroke that no engraver has followed at its depth, mm, and the stroke's start.
    fn missing_engraving(&self, engraving: &Engraving) -> (f64, DVec3) {
        let tolerance = self.params.leftover;
        let followed: Vec<&Cut> = self
            .cuts
            .iter()
            .copied()
            .filter(|c| {
                let engraver = self.tool(c).is_some_and(|t| matches!(t.kind, ToolKind::Engraver { .. }));
                c.cutting && engraver && c.sweep.margin == 0.0 && c.axis.dot(engraving.axis) < -0.999_999_5
            })
            .collect();
        let mut worst = (0.0, DVec3::ZERO);
        for stroke in &engraving.strokes {
            let length = stroke[0].distance(stroke[1]);
            let along = (stroke[1] - stroke[0]).normalize_or_zero();
            let mut done: Vec<(f64, f64)> = followed
                .iter()
                .filter(|c| c.tips.iter().all(|tip| off_line(*tip, stroke[0], along) <= tolerance))
                .map(|c| {
                    let [u, v] = c.tips.map(|tip| (tip - stroke[0]).dot(along));
                    (u.min(v), u.max(v))
                })
                .collect();
            done.sort_by(|a, b| a.0.total_cmp(&b.0));
            let (mut reached, mut gap) = (0.0, 0.0f64);
            for (from, to) in done {
                gap = gap.max(from.min(length) - reached);
                reached = f64::max(reached, to);
            }
            gap = gap.max(length - reached);
            if gap > worst.0 {
                worst = (gap, stroke[0]);
            }
        }
        worst
    }
}

fn off_line(p: DVec3, start: DVec3, along: DVec3) -> f64 {
    let by = p - start;
    (by - along * along.dot(by)).length()
}

fn worse(a: (f64, DVec3), b: (f64, DVec3)) -> (f64, DVec3) {
    if b.0 > a.0 { b } else { a }
}

/// Stock between a point of a face and a cut along the normal; `None` if the cut does not lie there.
fn left_by(cut: &Cut, q: DVec3, normal: DVec3) -> Option<f64> {
    let (near, far) = ray_interval(&cut.sweep, q, normal)?;
    // A cut that ends at the face from within the part leaves what is outside.
    (far > 1e-6).then_some(near.max(0.0))
}

/// Most stock outside a face that leaves the stock through one of its sides, and where: what is outside that side is
/// convex, so the corners speak for the face.
fn out_of(stock: &Aabb, corners: &[DVec3], normal: DVec3) -> (f64, DVec3) {
    let mut least = (f64::INFINITY, corners.first().copied().unwrap_or_default());
    for axis in 0..3 {
        let n = normal[axis];
        let side = if n > 0.0 { stock.max[axis] } else { stock.min[axis] };
        if n.abs() < 1e-9 {
            continue;
        }
        let way = |q: &DVec3| (((side - q[axis]) / n).max(0.0), *q);
        let most = corners.iter().map(way).fold((0.0, least.1), worse);
        if most.0 < least.0 {
            least = most;
        }
    }
    least
}

/// Way out of the stock from a point along a direction; 0 from outside.
fn exit(stock: &Aabb, q: DVec3, direction: DVec3) -> f64 {
    if !stock.grown(1e-9).contains(q) {
        return 0.0;
    }
    let way = |at: f64, v: f64, min: f64, max: f64| {
        if v > 1e-15 {
            (max - at) / v
        } else if v < -1e-15 {
            (min - at) / v
        } else {
            f64::INFINITY
        }
    };
    let x = way(q.x, direction.x, stock.min.x, stock.max.x);
    let y = way(q.y, direction.y, stock.min.y, stock.max.y);
    let z = way(q.z, direction.z, stock.min.z, stock.max.z);
    x.min(y).min(z).max(0.0)
}

/// Points of a convex polygon, corners and edges included, no farther apart than `spacing` along its longest sides.
fn samples(corners: &[DVec3], spacing: f64) -> impl Iterator<Item = DVec3> {
    let triangles = (2..corners.len()).map(|k| {
        let mut t = [corners[0], corners[k - 1], corners[k]];
        // The longest side first, so that thin triangles are not sampled densely at their far corner.
        let side = |i: usize| t[i].distance_squared(t[(i + 1) % 3]);
        let longest = (0..3).max_by(|a, b| side(*a).total_cmp(&side(*b))).unwrap_or(0);
        t.rotate_left(longest);
        t
    });
    triangles.flat_map(move |[a, b, c]| {
        let along = steps(a.distance(b), spacing);
        (0..=along).flat_map(move |i| {
            let foot = a.lerp(b, f64::from(i) / f64::from(along));
            let up = steps(foot.distance(c), spacing);
            (0..=up).map(move |j| foot.lerp(c, f64::from(j) / f64::from(up)))
        })
    })
}

fn steps(length: f64, spacing: f64) -> u32 {
    // A thousand points a side resolve any part; more would only hide a wrong unit.
    (length / spacing).ceil().clamp(1.0, 1000.0) as u32
}
