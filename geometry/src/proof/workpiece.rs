//! A placed part as the proof sees it: half-spaces, faces, designed holes and engravings, in board coordinates.

use super::report::PartFace;
use super::sweep::{Aabb, Sweep};
use crate::board::{PartSet, Placement};
use crate::joint::{Feature, Machining};
use crate::motion::glyph::text_strokes;
use crate::plane::Plane;
use glam::DVec3;

/// A face to be cut.
pub(crate) struct Face {
    pub name: PartFace,
    pub normal: DVec3,
    pub corners: Vec<DVec3>,
}

/// A designed hole. It may be entered along its axis from outside; one that ends at the part's surface goes through.
pub(crate) struct Hole {
    pub feature: u32,
    pub entry: DVec3,
    /// Into the wood.
    pub axis: DVec3,
    pub depth: f64,
    pub radius: f64,
    pub through: bool,
}

/// A designed engraving: the lines that the tool's point follows.
pub(crate) struct Engraving {
    pub feature: u32,
    pub text: String,
    /// Into the wood.
    pub axis: DVec3,
    pub strokes: Vec<[DVec3; 2]>,
}

pub(crate) struct Workpiece {
    pub part: u32,
    pub planes: Vec<Plane>,
    pub faces: Vec<Face>,
    pub aabb: Aabb,
    pub holes: Vec<Hole>,
    pub engravings: Vec<Engraving>,
    /// Features of kinds that cannot be followed.
    pub unproven: Vec<u32>,
}

impl Workpiece {
    /// The part of `placement` with its features (of the part's own, by index); `None` for a part that was not made.
    pub fn new(parts: &PartSet, placement: &Placement, features: &[(u32, &Feature)]) -> Option<Self> {
        let part = placement.part as usize;
        if part >= parts.panels.len() || !parts.panels.is_valid(part) {
            return None;
        }
        let solid = parts.panels.solid(part);
        let corners = parts.panels.corners(part).len() as u32;
        let facets = (0..corners).filter(|k| parts.panels.facet(part, *k as usize).is_some()).map(PartFace::Node);
        let names = [PartFace::Front, PartFace::Back].into_iter().chain((0..corners).map(PartFace::Edge)).chain(facets);
        let points: Vec<DVec3> = solid.points.iter().map(|p| placement.point(*p)).collect();
        let shift = placement.offset.extend(0.0);
        let placed: Vec<Plane> = solid
            .planes
            .iter()
            .map(|p| {
                let normal = placement.vector(p.normal);
                Plane { normal, offset: p.offset + normal.dot(shift) }
            })
            .collect();
        let faces = names
            .zip(&placed)
            .enumerate()
            .map(|(f, (name, plane))| Face {
                name,
                normal: plane.normal,
                corners: solid.face(f).iter().map(|v| points[*v as usize]).collect(),
            })
            .collect();
        // Facets on borders lie in a chamfer and have its plane.
        let mut planes: Vec<Plane> = Vec::with_capacity(placed.len());
        for plane in placed {
            if !planes.contains(&plane) {
                planes.push(plane);
            }
        }
        let mut piece = Self {
            part: placement.part,
            aabb: Aabb::of(points),
            planes,
            faces,
            holes: Vec::new(),
            engravings: Vec::new(),
            unproven: Vec::new(),
        };
        for (index, feature) in features {
            piece.add(*index, feature, placement);
        }
        Some(piece)
    }

    fn add(&mut self, index: u32, feature: &Feature, placement: &Placement) {
        match &feature.machining {
            Machining::Drill { entry, axis, depth, diameter } => {
                let (entry, axis) = (placement.point(*entry), placement.vector(*axis));
                let inside = self.inside(entry + axis * *depth);
                let through = inside < 1e-6;
                self.holes.push(Hole { feature: index, entry, axis, depth: *depth, radius: 0.5 * diameter, through });
            }
            Machining::Engraving { origin, along, axis, height, depth, text } => {
                let Ok(lines) = text_strokes(text, *height) else {
                    self.unproven.push(index);
                    return;
                };
                // Seen against `axis`, text runs along `along` and up along this.
                let up = along.cross(*axis);
                let tip = |p: &glam::DVec2| placement.point(*origin + *along * p.x + up * p.y + *axis * *depth);
                let strokes = lines.iter().flat_map(|line| line.windows(2).map(|w| [tip(&w[0]), tip(&w[1])])).collect();
                let (axis, text) = (placement.vector(*axis), text.clone());
                self.engravings.push(Engraving { feature: index, text, axis, strokes });
            }
            Machining::Slot { .. } | Machining::Pocket { .. } | Machining::Contour { .. } => self.unproven.push(index),
        }
    }

    /// How far inside the part a point lies, mm; negative outside.
    pub fn inside(&self, p: DVec3) -> f64 {
        self.planes.iter().map(|plane| -plane.distance(p)).fold(f64::INFINITY, f64::min)
    }
}

impl Hole {
    /// How far a sweep reaches beyond the hole, taken as open outwards: no point of it is farther from the hole, mm.
    pub fn protrusion(&self, sweep: &Sweep) -> f64 {
        let mut most = f64::NEG_INFINITY;
        for d in &sweep.discs {
            let from_entry = d.center - self.entry;
            let along = from_entry.dot(self.axis);
            let aside = (from_entry - self.axis * along).length() + d.radius - self.radius;
            most = most.max(aside);
            if !self.through {
                let cosine = d.axis.dot(self.axis);
                most = most.max(along + d.radius * (1.0 - cosine * cosine).max(0.0).sqrt() - self.depth);
            }
        }
        most + sweep.margin
    }
}

impl Engraving {
    /// How far a move of an engraver's point leaves every stroke, sideways or downwards, mm. The groove is what the
    /// tool's cone makes with its point on a stroke, so a tool whose point stays within e of a stroke stays within e
    /// of the groove.
    pub fn protrusion(&self, tips: &[DVec3; 2], tool_axis: DVec3) -> f64 {
        if tool_axis.dot(self.axis) > -0.999_999_5 {
            return f64::INFINITY;
        }
        self.strokes
            .iter()
            .map(|stroke| {
                tips.iter()
                    .map(|tip| {
                        let deeper = (*tip - stroke[0]).dot(self.axis);
                        let flat = *tip - self.axis * deeper;
                        distance_to_segment(flat, stroke).max(deeper)
                    })
                    .fold(0.0, f64::max)
            })
            .fold(f64::INFINITY, f64::min)
    }
}

/// Distance of `p` from the segment `s`.
fn distance_to_segment(p: DVec3, s: &[DVec3; 2]) -> f64 {
    let along = s[1] - s[0];
    let length = along.length_squared();
    let t = if length > 0.0 { ((p - s[0]).dot(along) / length).clamp(0.0, 1.0) } else { 0.0 };
    (p - s[0] - along * t).length()
}
