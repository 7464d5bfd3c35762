//! Marks that every part gets for making it: fixing holes through which it is screwed to the table, and its address
//! engraved on the upper face (000 §7.3.3, items 1 and 2).

use super::convex::{self, bounds, clip, hull, separation};
use super::facet::{facets, piece_outline};
use super::part::PartSet;
use crate::joint::{Feature, Machining};
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

/// Adds fixing holes and addresses to the features of every part; the features come out ordered by panel. Returns
/// the panels whose marks do not fit. O(parts · (features per part + candidates)).
pub(super) fn add_marks(
    parts: &mut PartSet,
    fixing: Option<&FixingHoles>,
    address: Option<&AddressMark>,
    go: &(dyn Fn() -> bool + Sync),
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
    let issues: Vec<Vec<MarkIssue>> = own
        .par_iter_mut()
        .enumerate()
        .map(|(i, features)| {
            let mut issues = Vec::new();
            if parts.panels.is_valid(i) && go() {
                let mut taken: Vec<Vec<DVec2>> = features.iter().filter_map(|f| shadow(&f.machining)).collect();
                if let Some(rule) = fixing {
                    issues.extend(fix(parts, i, rule, &mut taken, features));
                }
                if let Some(rule) = address {
                    let text = parts.panels.address[i].to_string();
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
        features.push(Feature { panel: i as u32, edge: None, joint: None, purpose: "fixing".into(), machining });
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
                    let feature =
                        Feature { panel: i as u32, edge: None, joint: None, purpose: "address".into(), machining };
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::testing::{Shape, panel_set, slanted_quad};
    use crate::board::{MapIssue, MapParams, Up, map_parts};
    use crate::joint::FeatureSet;
    use crate::mesh::Address;
    use crate::motion::glyph::text_strokes;
    use glam::DAffine3;
    use proptest::prelude::*;

    fn drill(at: DVec2, axis: DVec3, depth: f64) -> Feature {
        let machining = Machining::Drill { entry: at.extend(0.0), axis, depth, diameter: 6.0 };
        Feature { panel: 0, edge: None, joint: Some(0), purpose: "dowel".into(), machining }
    }

    fn map(shape: Shape, features: Vec<Feature>, params: &MapParams) -> (PartSet, Vec<MapIssue>) {
        let set = panel_set(&[shape], 10.0, DAffine3::IDENTITY);
        map_parts(&set, &FeatureSet { features, ..FeatureSet::default() }, params, &|| true)
    }

    /// Distance of a vertical line at `p` from the chamfers, seen in the board's plane.
    fn wood_around(parts: &PartSet, p: DVec2, z: f64) -> f64 {
        let gap = |f: &crate::board::Facet| -f.plane.distance(p.extend(z)) / f.plane.normal.truncate().length();
        facets(&parts.panels, 0).iter().map(gap).fold(f64::INFINITY, f64::min)
    }

    proptest! {
        #[test]
        fn marks_lie_in_the_wood_and_clear_of_all_features(
            lean in prop::array::uniform4(-0.5..0.5f64),
            shear in -60.0..60.0f64,
            up in prop::sample::select(vec![Up::Front, Up::Back]),
            holes in prop::collection::vec((40.0..260.0f64, 15.0..95.0f64, 0.0..6.2f64), 0..6),
        ) {
            let features: Vec<Feature> = holes
                .iter()
                .map(|(x, y, a)| drill(DVec2::new(*x, *y), DVec3::new(a.cos(), a.sin(), -1.0).normalize(), 12.0))
                .collect();
            let (parts, issues) = map(slanted_quad(300.0, 110.0, shear, lean), features, &MapParams { up, ..MapParams::default() });
            let (rule, mark) = (FixingHoles::default(), AddressMark::default());
            let all = &parts.features.features;
            let made: Vec<&Feature> = all.iter().filter(|f| f.purpose == "fixing").collect();
            prop_assert_eq!(made.len() < 2, issues.iter().any(|i| matches!(i, MapIssue::Mark { issue: MarkIssue::Fixing { .. }, .. })));
            let (drilled, marks): (Vec<_>, Vec<_>) = all.iter().partition(|f| f.purpose == "dowel");
            let shadows: Vec<Vec<DVec2>> = drilled.iter().filter_map(|f| shadow(&f.machining)).collect();
            for f in &marks {
                let own = shadow(&f.machining).unwrap();
                match &f.machining {
                    Machining::Drill { entry, axis, depth, .. } => {
                        prop_assert_eq!((entry.z, *axis, *depth), (10.0, DVec3::NEG_Z, 10.0));
                        for z in [0.0, 10.0] {
                            prop_assert!(wood_around(&parts, entry.truncate(), z) >= rule.edge + 2.0 - 1e-9);
                        }
                        prop_assert!(shadows.iter().all(|s| separation(&own, s) >= rule.feature - 1e-9));
                    }
                    Machining::Engraving { height, text, .. } => {
                        prop_assert_eq!(text.as_str(), "0.0");
                        prop_assert!(*height <= mark.height && *height >= mark.least_height);
                        prop_assert!(own.iter().all(|c| wood_around(&parts, *c, 10.0) >= mark.edge - 1e-9));
                        prop_assert!(shadows.iter().all(|s| separation(&own, s) >= mark.feature - 1e-9));
                        for hole in &made {
                            prop_assert!(separation(&own, &shadow(&hole.machining).unwrap()) >= mark.feature - 1e-9);
                        }
                    }
                    other => prop_assert!(false, "{other:?}"),
                }
            }
        }
    }

    #[test]
    fn holes_go_to_the_ends_of_the_part() {
        let (parts, issues) = map(slanted_quad(300.0, 110.0, 0.0, [0.0; 4]), Vec::new(), &MapParams::default());
        assert!(issues.is_empty());
        let at: Vec<DVec3> = parts
            .features
            .features
            .iter()
            .filter_map(|f| match f.machining {
                Machining::Drill { entry, .. } => Some(entry),
                _ => None,
            })
            .collect();
        // The diagonal of the 266 × 76 mm that are left at 15 + 2 mm from the edges.
        assert!((at[0].distance(at[1]) - 266f64.hypot(76.0)).abs() < 1e-9);
    }

    #[test]
    fn an_address_shrinks_and_turns_to_fit() {
        let height = |shape: Shape| {
            let params = MapParams { fixing: None, ..MapParams::default() };
            let (parts, issues) = map(shape, Vec::new(), &params);
            parts
                .features
                .features
                .iter()
                .find_map(|f| match &f.machining {
                    Machining::Engraving { height, along, .. } => Some((*height, *along)),
                    _ => None,
                })
                .ok_or(issues)
        };
        assert_eq!(height(slanted_quad(100.0, 40.0, 0.0, [0.0; 4])), Ok((15.0, DVec3::X)));
        // 15 mm wide: 5 mm are left between the edges.
        let (small, along) = height(slanted_quad(100.0, 15.0, 0.0, [0.0; 4])).unwrap();
        assert!((4.0..=5.0).contains(&small) && along == DVec3::X);
        let (_, along) = height(slanted_quad(20.0, 100.0, 0.0, [0.0; 4])).unwrap();
        assert_eq!(along, DVec3::Y);
        let issue = MarkIssue::Address { least_height: 4.0 };
        assert_eq!(height(slanted_quad(100.0, 13.0, 0.0, [0.0; 4])), Err(vec![MapIssue::Mark { panel: 0, issue }]));
    }

    #[test]
    fn a_part_too_small_for_its_holes_says_what_would_do() {
        let (parts, issues) = map(slanted_quad(200.0, 30.0, 0.0, [0.0; 4]), Vec::new(), &MapParams::default());
        assert!(parts.features.features.iter().all(|f| f.purpose != "fixing"));
        let [MapIssue::Mark { issue: MarkIssue::Fixing { wanted, placed, largest, .. }, .. }] = issues[..] else {
            panic!("{issues:?}")
        };
        assert_eq!((wanted, placed), (2, 0));
        assert!((largest - 13.0).abs() < 1e-6, "{largest}");
    }

    #[test]
    fn addresses_of_every_patch_can_be_engraved() {
        let address = Address { patch: 2, row: 3, column: 12 };
        assert!(text_strokes(&address.to_string(), 10.0).is_ok(), "{address}");
    }
}
