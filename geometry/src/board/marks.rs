//! Marks that every part gets for making it: fixing holes through which it is screwed to the table, and its address
//! engraved on the upper face (000 §7.3.3, items 1 and 2).

use super::convex::{self, bounds, clip, hull, separation};
use super::facet::{facets, piece_outline};
use super::part::PartSet;
use crate::joint::{Feature, Machining};
use crate::mesh::Address;
use crate::motion::glyph::text_size;
use glam::{DVec2, DVec3};
use rayon::prelude::*;

/// Holes by which parts are screwed to the sacrificial layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FixingHoles {
    /// Holes per part, as far from each other as they go; 0: none.
    pub count: u32,
    /// Diameter, mm.
    pub diameter: f64,
    /// Least wood between a hole and any chamfer, mm.
    pub edge: f64,
    /// Least distance between a hole and any other feature seen from above, mm.
    pub feature: f64,
}

impl Default for FixingHoles {
    fn default() -> Self {
        Self { count: 2, diameter: 4.0, edge: 15.0, feature: 5.0 }
    }
}

/// Addresses on the upper face.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AddressMark {
    /// Wanted glyph height, mm; shrinks where the face is small.
    pub height: f64,
    /// Least glyph height, mm.
    pub least_height: f64,
    /// Depth of the strokes, mm.
    pub depth: f64,
    /// Least distance from the upper face's border, mm.
    pub edge: f64,
    /// Least distance from any other feature seen from above, mm.
    pub feature: f64,
}

impl Default for AddressMark {
    fn default() -> Self {
        Self { height: 15.0, least_height: 4.0, depth: 0.5, edge: 5.0, feature: 3.0 }
    }
}

/// Why a mark was not made as wished.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MarkIssue {
    /// Fewer fixing holes than wished.
    #[error(
        "{placed} of {wanted} fixing holes of {diameter} mm fit at {edge} mm from the chamfers and clear of the other \
         holes (without those, the middle of the part would allow {largest:.1} mm)"
    )]
    Fixing {
        /// Wished.
        wanted: u32,
        /// Made.
        placed: u32,
        /// Diameter, mm.
        diameter: f64,
        /// Wanted distance from the chamfers, mm.
        edge: f64,
        /// Largest distance that leaves room for one hole, mm; negative: the hole is wider than the part.
        largest: f64,
    },
    /// The address does not fit.
    #[error("the address does not fit on the upper face at a height of {least_height} mm")]
    Address {
        /// Least height tried, mm.
        least_height: f64,
    },
}

/// The text of an address: `row.column`, with the patch in front where a set has several.
#[must_use]
pub fn address_text(address: Address, patches: bool) -> String {
    let Address { patch, row, column } = address;
    if patches { format!("{patch}.{row}.{column}") } else { format!("{row}.{column}") }
}

/// Adds fixing holes and addresses to the features of every part; the features come out ordered by panel. Returns
/// the panels whose marks do not fit. O(parts · (features per part + candidates)).
pub(super) fn add_marks(
    parts: &mut PartSet,
    fixing: Option<&FixingHoles>,
    address: Option<&AddressMark>,
) -> Vec<(u32, MarkIssue)> {
    let panels = parts.panels.len();
    let mut own: Vec<Vec<Feature>> = vec![Vec::new(); panels];
    let mut stray = Vec::new();
    for f in std::mem::take(&mut parts.features.features) {
        match own.get_mut(f.panel as usize) {
            Some(list) => list.push(f),
            None => stray.push(f),
        }
    }
    let patches = parts.panels.address.iter().any(|a| a.patch != 0);
    let issues: Vec<Vec<MarkIssue>> = own
        .par_iter_mut()
        .enumerate()
        .map(|(i, features)| {
            let mut issues = Vec::new();
            if parts.panels.is_valid(i) {
                let mut taken: Vec<Vec<DVec2>> = features.iter().filter_map(|f| shadow(&f.machining)).collect();
                if let Some(rule) = fixing {
                    issues.extend(fix(parts, i, rule, &mut taken, features));
                }
                if let Some(rule) = address {
                    let text = address_text(parts.panels.address[i], patches);
                    issues.extend(engrave(parts, i, rule, text, &taken, features));
                }
            }
            issues
        })
        .collect();
    parts.features.features = own.into_iter().flatten().chain(stray).collect();
    issues.into_iter().enumerate().flat_map(|(i, list)| list.into_iter().map(move |x| (i as u32, x))).collect()
}

/// The part's area at which wood is at least `inset` mm thick towards every chamfer, at all of `levels`.
fn inner_region(parts: &PartSet, i: usize, inset: f64, levels: &[f64]) -> Vec<DVec2> {
    let mut region = piece_outline(&parts.panels, i);
    for f in facets(&parts.panels, i) {
        let flat = f.plane.normal.truncate();
        for z in levels {
            let offset = f.plane.offset - f.plane.normal.z * z - inset * flat.length();
            region = clip(&region, flat, offset);
        }
    }
    region
}

/// Convex shadow of a feature seen from above; `None` for one without extent.
fn shadow(shape: &Machining) -> Option<Vec<DVec2>> {
    let swept = |points: &[DVec3], radius: f64| {
        let ring = octagon(radius);
        hull(&points.iter().flat_map(|p| ring.map(|r| p.truncate() + r)).collect::<Vec<_>>())
    };
    let polygon = match shape {
        Machining::Drill { entry, axis, depth, diameter } => swept(&[*entry, *entry + *axis * *depth], 0.5 * diameter),
        Machining::Slot { from, to, axis, width, depth } => {
            swept(&[*from, *to, *from - *axis * *depth, *to - *axis * *depth], 0.5 * width)
        }
        Machining::Pocket { outline, axis, depth } => {
            hull(&outline.iter().flat_map(|p| [p.truncate(), (*p + *axis * *depth).truncate()]).collect::<Vec<_>>())
        }
        Machining::Contour { line, .. } => hull(&line.iter().map(|p| p.truncate()).collect::<Vec<_>>()),
        Machining::Engraving { origin, along, axis, height, text, .. } => {
            let size = text_size(text, *height);
            let (u, v) = (*along * size.x, along.cross(*axis) * size.y);
            hull(&[*origin, *origin + u, *origin + u + v, *origin + v].map(|p| p.truncate()))
        }
    };
    (polygon.len() > 2).then_some(polygon)
}

/// A regular octagon around a circle of `radius`.
fn octagon(radius: f64) -> [DVec2; 8] {
    let (a, b) = (radius, radius * (2f64.sqrt() - 1.0));
    [(a, b), (b, a), (-b, a), (-a, b), (-a, -b), (-b, -a), (b, -a), (a, -b)].map(|(x, y)| DVec2::new(x, y))
}

/// Whether `polygon` is at least `by` mm from all of `taken`.
fn is_clear(polygon: &[DVec2], taken: &[Vec<DVec2>], by: f64) -> bool {
    let Some((lo, hi)) = bounds(polygon) else { return true };
    taken.iter().all(|other| match bounds(other) {
        Some((l, h)) if l.x < hi.x + by && l.y < hi.y + by && h.x > lo.x - by && h.y > lo.y - by => {
            separation(polygon, other) >= by
        }
        _ => true,
    })
}

/// Candidate points of a convex region: the wish first, then a lattice, nearest to the wish first.
fn candidates(region: &[DVec2], wish: DVec2) -> impl Iterator<Item = DVec2> {
    // The wish nearly always does, so the lattice is made only when it is asked for.
    std::iter::once(wish).chain(std::iter::once_with(move || lattice(region, wish)).flatten())
}

/// Points of a lattice of 13 × 13 over a convex region, nearest to `wish` first.
fn lattice(region: &[DVec2], wish: DVec2) -> Vec<DVec2> {
    let Some((lo, hi)) = bounds(region) else { return Vec::new() };
    let step = (hi - lo) / 12.0;
    let mut points: Vec<DVec2> = (0..13)
        .flat_map(|r| (0..13).map(move |c| DVec2::new(f64::from(c), f64::from(r))))
        .map(|g| lo + g * step)
        .filter(|p| holds(region, *p))
        .collect();
    points.sort_by(|a, b| a.distance_squared(wish).total_cmp(&b.distance_squared(wish)));
    points
}

/// Whether a convex polygon holds `p`, its border included.
fn holds(polygon: &[DVec2], p: DVec2) -> bool {
    (0..polygon.len()).all(|k| (polygon[(k + 1) % polygon.len()] - polygon[k]).perp_dot(p - polygon[k]) >= 0.0)
}

fn centroid(polygon: &[DVec2]) -> DVec2 {
    let first = polygon[0];
    let (sum, weight) = (1..polygon.len() - 1).fold((DVec2::ZERO, 0.0), |(sum, weight), k| {
        let (a, b) = (polygon[k] - first, polygon[k + 1] - first);
        let w = a.perp_dot(b);
        (sum + (a + b) * (w / 3.0), weight + w)
    });
    if weight > 0.0 { first + sum / weight } else { first }
}

/// Fixing holes of part `i`.
fn fix(
    parts: &PartSet,
    i: usize,
    rule: &FixingHoles,
    taken: &mut Vec<Vec<DVec2>>,
    features: &mut Vec<Feature>,
) -> Option<MarkIssue> {
    let t = parts.panels.thickness;
    let radius = 0.5 * rule.diameter;
    let region = inner_region(parts, i, rule.edge + radius, &[0.0, t]);
    let mut placed: Vec<DVec2> = Vec::new();
    while region.len() > 2 && placed.len() < rule.count as usize {
        // The first of several holes at one end of the part, every other one as far as possible from those before.
        let far = |from: &[DVec2]| {
            let reach = |p: &DVec2| from.iter().map(|q| p.distance_squared(*q)).fold(f64::INFINITY, f64::min);
            region.iter().copied().max_by(|a, b| reach(a).total_cmp(&reach(b)))
        };
        let wish = match (placed.is_empty(), rule.count) {
            (true, 1) => Some(centroid(&region)),
            (true, _) => far(&[centroid(&region)]),
            _ => far(&placed),
        };
        let ring = octagon(radius);
        let spot = candidates(&region, wish.unwrap_or(region[0])).find_map(|p| {
            let hole = ring.map(|r| p + r);
            is_clear(&hole, taken, rule.feature).then_some((p, hole))
        });
        let Some((p, hole)) = spot else { break };
        taken.push(hole.to_vec());
        placed.push(p);
        let machining = Machining::Drill { entry: p.extend(t), axis: DVec3::NEG_Z, depth: t, diameter: rule.diameter };
        features.push(Feature { panel: i as u32, edge: None, joint: None, purpose: "fixing", machining });
    }
    if placed.len() == rule.count as usize {
        return None;
    }
    // Only now is the largest possible distance worth a search.
    let (mut low, mut high) = (-radius, parts_width(parts, i));
    for _ in 0..40 {
        let mid = 0.5 * (low + high);
        if inner_region(parts, i, mid + radius, &[0.0, t]).len() > 2 { low = mid } else { high = mid }
    }
    Some(MarkIssue::Fixing {
        wanted: rule.count,
        placed: placed.len() as u32,
        diameter: rule.diameter,
        edge: rule.edge,
        largest: low,
    })
}

fn parts_width(parts: &PartSet, i: usize) -> f64 {
    bounds(&piece_outline(&parts.panels, i)).map_or(0.0, |(lo, hi)| (hi - lo).max_element())
}

/// The address of part `i`.
fn engrave(
    parts: &PartSet,
    i: usize,
    rule: &AddressMark,
    text: String,
    taken: &[Vec<DVec2>],
    features: &mut Vec<Feature>,
) -> Option<MarkIssue> {
    let t = parts.panels.thickness;
    let region = inner_region(parts, i, rule.edge, &[t]);
    let too_small = Some(MarkIssue::Address { least_height: rule.least_height });
    if region.len() < 3 || convex::area(&region) <= 0.0 {
        return too_small;
    }
    let wish = centroid(&region);
    let mut height = rule.height;
    loop {
        let size = text_size(&text, height);
        for (along, up) in [(DVec2::X, DVec2::Y), (DVec2::Y, DVec2::NEG_X)] {
            let (u, v) = (along * size.x * 0.5, up * size.y * 0.5);
            for middle in candidates(&region, wish) {
                let frame = [middle - u - v, middle + u - v, middle + u + v, middle - u + v];
                if frame.iter().all(|c| holds(&region, *c)) && is_clear(&frame, taken, rule.feature) {
                    let machining = Machining::Engraving {
                        origin: frame[0].extend(t),
                        along: along.extend(0.0),
                        axis: DVec3::NEG_Z,
                        height,
                        depth: rule.depth,
                        text,
                    };
                    let feature = Feature { panel: i as u32, edge: None, joint: None, purpose: "address", machining };
                    features.push(feature);
                    return None;
                }
            }
        }
        if height <= rule.least_height {
            return too_small;
        }
        height = (0.85 * height).max(rule.least_height);
    }
}
