//! Mapping: every panel by a rigid motion of its own from the model to the machine plane (000 §7.1).

use super::marks::{self, AddressMark, FixingHoles, MarkIssue};
use super::part::{PartSet, Up};
use crate::joint::{Feature, FeatureSet, Machining};
use crate::panel::PanelSet;
use crate::plane::Plane;
use crate::shared::Shared;
use glam::{DAffine3, DMat3, DVec3};
use rayon::prelude::*;

/// So many features are moved before it is asked whether to go on: some milliseconds of work.
const OFTEN: usize = 1 << 14;

/// What of a panel is laid along the board's grain axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Align {
    /// The bottom edge v1 v2.
    FirstEdge,
    /// The left edge v1 v4 (from the first corner to the last).
    LastEdge,
    /// The grain: a direction in the model, projected to each face.
    Grain(DVec3),
}

/// Board axis along which `Align` lies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GrainAxis {
    /// Along +X.
    X,
    /// Along +Y.
    Y,
}

/// Parameters of [`map_parts`].
#[derive(Clone, Debug, PartialEq)]
pub struct MapParams {
    /// What is laid along the grain axis.
    pub align: Align,
    /// The grain axis of the board.
    pub axis: GrainAxis,
    /// Which face lies up.
    pub up: Up,
    /// Holes by which each part is screwed to the table; `None`: no such holes.
    pub fixing: Option<FixingHoles>,
    /// Addresses engraved on the upper face; `None`: no addresses.
    pub address: Option<AddressMark>,
}

impl Default for MapParams {
    fn default() -> Self {
        Self {
            align: Align::FirstEdge,
            axis: GrainAxis::X,
            up: Up::Back,
            fixing: Some(FixingHoles::default()),
            address: Some(AddressMark::default()),
        }
    }
}

/// What went wrong with one panel while mapping; the other panels are unaffected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MapIssue {
    /// The panel has no direction to align; it is laid along its longest edge.
    #[error(
        "panel {panel}: the {what} has no direction in the panel's plane, so the panel was laid along its longest edge"
    )]
    NoDirection {
        /// Panel index.
        panel: u32,
        /// What was to be aligned.
        what: &'static str,
    },
    /// A mark does not fit.
    #[error("panel {panel}: {issue}")]
    Mark {
        /// Panel index.
        panel: u32,
        /// Why.
        issue: MarkIssue,
    },
}

/// Maps every panel and its features to its part frame: first corner over the origin, lower designed face on z = 0,
/// upper one on z = thickness, by a rigid motion of determinant +1 (turning a panel over is a half-turn, never a
/// mirror). Fixing holes and addresses are added as features. Failed panels keep their empty place.
///
/// O(corners + features); every panel alone. Source: 000 §7.1, METHODS §7.
/// Stops early when `go` says no, and what there is then is of no use.
#[must_use]
pub fn map_parts(
    panels: &PanelSet,
    features: &FeatureSet,
    params: &MapParams,
    go: &(dyn Fn() -> bool + Sync),
) -> (PartSet, Vec<MapIssue>) {
    let mut issues = Vec::new();
    let mut mapped = panels.clone();
    let (normal, chamfer) = (mapped.normal.to_mut(), mapped.chamfer.to_mut());
    let lines = [&mut mapped.front, &mut mapped.back_start, &mut mapped.back_end];
    let mut lines = lines.map(Shared::to_mut);
    let mut frame = Vec::with_capacity(panels.len());
    for i in (0..panels.len()).take_while(|_| go()) {
        let (motion, issue) = if panels.is_valid(i) { motion(panels, i, params) } else { (DAffine3::IDENTITY, None) };
        issues.extend(issue);
        frame.push(motion);
        normal[i] = motion.transform_vector3(panels.normal[i]);
        for k in panels.corners(i) {
            for column in &mut lines {
                column[k] = motion.transform_point3(column[k]);
            }
            chamfer[k] = plane(&motion, panels.chamfer[k]);
        }
    }
    frame.resize(panels.len(), DAffine3::IDENTITY);
    let moved = |list: &[Feature]| -> Vec<Feature> {
        let one = |f: &Feature| {
            let m = frame.get(f.panel as usize).copied().unwrap_or(DAffine3::IDENTITY);
            Feature { machining: machining(&m, &f.machining), ..f.clone() }
        };
        let mut all = Vec::with_capacity(list.len());
        for some in list.chunks(OFTEN).take_while(|_| go()) {
            all.par_extend(some.par_iter().map(one));
        }
        all
    };
    let mut parts = PartSet {
        features: FeatureSet {
            features: moved(&features.features),
            by_hand: moved(&features.by_hand),
            hardware: features.hardware.clone(),
        },
        panels: mapped,
        frame,
        up: params.up,
    };
    let mark_issues = marks::add_marks(&mut parts, params.fixing.as_ref(), params.address.as_ref(), go);
    issues.extend(mark_issues.into_iter().map(|(panel, issue)| MapIssue::Mark { panel, issue }));
    (parts, issues)
}

/// The rigid motion of panel `i`.
fn motion(panels: &PanelSet, i: usize, params: &MapParams) -> (DAffine3, Option<MapIssue>) {
    let loop_ = &panels.front[panels.corners(i)];
    let n = loop_.len();
    let up = match params.up {
        Up::Front => panels.normal[i],
        Up::Back => -panels.normal[i],
    };
    let (wish, what) = match params.align {
        Align::FirstEdge => (loop_[1 % n] - loop_[0], "first edge"),
        Align::LastEdge => (loop_[n - 1] - loop_[0], "last edge"),
        Align::Grain(d) => (d, "grain"),
    };
    // A direction within about 0.1° of the normal is noise in the plane.
    let in_plane = |v: DVec3| {
        let flat = v - up * up.dot(v);
        (flat.length() > 2e-3 * v.length()).then(|| flat.normalize())
    };
    let (along, issue) = match in_plane(wish) {
        Some(d) => (d, None),
        None => {
            let longest = (0..n)
                .map(|k| loop_[(k + 1) % n] - loop_[k])
                .fold(DVec3::ZERO, |best, e| if e.length_squared() > best.length_squared() { e } else { best });
            let d = in_plane(longest).unwrap_or_else(|| up.any_orthonormal_vector());
            (d, Some(MapIssue::NoDirection { panel: i as u32, what }))
        }
    };
    let across = up.cross(along).normalize();
    // Rows of the rotation are the part frame's axes seen from the model.
    let rotation = match params.axis {
        GrainAxis::X => DMat3::from_cols(along, across, up),
        GrainAxis::Y => DMat3::from_cols(-across, along, up),
    }
    .transpose();
    let height = match params.up {
        Up::Front => panels.thickness,
        Up::Back => 0.0,
    };
    let translation = DVec3::new(0.0, 0.0, height) - rotation * loop_[0];
    (DAffine3 { matrix3: rotation, translation }, issue)
}

/// A plane under a rigid motion.
fn plane(motion: &DAffine3, p: Plane) -> Plane {
    Plane::through(motion.transform_point3(p.normal * p.offset), motion.transform_vector3(p.normal))
}

/// A feature's shape under a rigid motion.
fn machining(m: &DAffine3, shape: &Machining) -> Machining {
    let point = |p: &DVec3| m.transform_point3(*p);
    let turn = |v: &DVec3| m.transform_vector3(*v);
    match shape {
        Machining::Drill { entry, axis, depth, diameter } => {
            Machining::Drill { entry: point(entry), axis: turn(axis), depth: *depth, diameter: *diameter }
        }
        Machining::Slot { from, to, axis, width, depth } => {
            Machining::Slot { from: point(from), to: point(to), axis: turn(axis), width: *width, depth: *depth }
        }
        Machining::Pocket { outline, axis, depth } => {
            Machining::Pocket { outline: outline.iter().map(point).collect(), axis: turn(axis), depth: *depth }
        }
        Machining::Contour { line, axis } => {
            Machining::Contour { line: line.iter().map(point).collect(), axis: turn(axis) }
        }
        Machining::Engraving { origin, along, axis, height, depth, text } => Machining::Engraving {
            origin: point(origin),
            along: turn(along),
            axis: turn(axis),
            height: *height,
            depth: *depth,
            text: text.clone(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::testing::{panel_set, random_pose, slanted_quad};
    use proptest::prelude::*;

    fn bare(align: Align, axis: GrainAxis, up: Up) -> MapParams {
        MapParams { align, axis, up, fixing: None, address: None }
    }

    proptest! {
        #[test]
        fn mapping_is_an_isometry_of_determinant_one(
            pose in random_pose(),
            lean in prop::array::uniform4(-0.5..0.5f64),
            align in prop::sample::select(vec![Align::FirstEdge, Align::LastEdge, Align::Grain(DVec3::new(0.3, 0.2, 1.0))]),
            axis in prop::sample::select(vec![GrainAxis::X, GrainAxis::Y]),
            up in prop::sample::select(vec![Up::Front, Up::Back]),
        ) {
            let set = panel_set(&[slanted_quad(300.0, 110.0, 40.0, lean)], 10.0, pose);
            let (parts, _) = map_parts(&set, &FeatureSet::default(), &bare(align, axis, up), &|| true);
            let m = parts.frame[0].matrix3;
            prop_assert!((m.determinant() - 1.0).abs() < 1e-12);
            prop_assert!((m * m.transpose() - DMat3::IDENTITY).to_cols_array().iter().all(|v| v.abs() < 1e-12));
            let all = |p: &PanelSet| [&*p.front, &p.back_start, &p.back_end].concat();
            let (a, b) = (all(&set), all(&parts.panels));
            for i in 0..a.len() {
                for j in 0..i {
                    prop_assert!((a[i].distance(a[j]) - b[i].distance(b[j])).abs() < 1e-9);
                }
            }
            // Faces on their planes, first corner over the origin, chamfer planes still through their points.
            let (front, back) = if up == Up::Front { (10.0, 0.0) } else { (0.0, 10.0) };
            prop_assert!(parts.panels.front.iter().all(|p| (p.z - front).abs() < 1e-9));
            prop_assert!(parts.panels.back_start.iter().all(|p| (p.z - back).abs() < 1e-9));
            prop_assert!(parts.panels.front[0].truncate().length() < 1e-9);
            for k in 0..4 {
                prop_assert!(parts.panels.chamfer[k].distance(parts.panels.front[k]).abs() < 1e-9);
                prop_assert!(parts.panels.chamfer[k].distance(parts.panels.back_end[k]).abs() < 1e-9);
            }
            let e = match align {
                Align::FirstEdge => parts.panels.front[1],
                Align::LastEdge => parts.panels.front[3],
                Align::Grain(d) => parts.frame[0].transform_vector3(d),
            };
            let (along, off) = if axis == GrainAxis::X { (e.x, e.y) } else { (e.y, e.x) };
            prop_assert!(along > 0.0 && off.abs() < 1e-9 * along.max(1.0));
        }
    }

    #[test]
    fn a_grain_square_to_a_panel_is_named_and_the_panel_still_mapped() {
        let set = panel_set(&[slanted_quad(300.0, 110.0, 0.0, [0.0; 4])], 10.0, DAffine3::IDENTITY);
        let params = bare(Align::Grain(DVec3::Z), GrainAxis::X, Up::Front);
        let (parts, issues) = map_parts(&set, &FeatureSet::default(), &params, &|| true);
        assert_eq!(issues, [MapIssue::NoDirection { panel: 0, what: "grain" }]);
        assert!(parts.panels.front[1].x > 299.0);
    }

    #[test]
    fn features_travel_with_their_panel() {
        let pose = DAffine3::from_translation(DVec3::new(7.0, -3.0, 900.0));
        let set = panel_set(&[slanted_quad(300.0, 110.0, 0.0, [0.0; 4])], 10.0, pose);
        let entry = set.front[0] + DVec3::new(20.0, 30.0, 0.0);
        let drill = Machining::Drill { entry, axis: DVec3::NEG_Z, depth: 5.0, diameter: 6.0 };
        let feature = Feature { panel: 0, edge: None, joint: Some(4), purpose: "dowel".into(), machining: drill };
        let features = FeatureSet { features: vec![feature], ..FeatureSet::default() };
        let (parts, _) = map_parts(&set, &features, &bare(Align::FirstEdge, GrainAxis::X, Up::Back), &|| true);
        let Machining::Drill { entry, axis, .. } = parts.features.features[0].machining else { panic!() };
        assert!((entry - DVec3::new(20.0, -30.0, 0.0)).length() < 1e-9, "{entry}");
        assert!((axis - DVec3::Z).length() < 1e-12);
        assert_eq!(parts.features.features[0].joint, Some(4));
    }
}
