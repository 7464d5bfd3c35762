//! The edges that a fastener is asked to join, and whether what it gave lies in the panels.

use super::feature::{Feature, FeatureSet, Machining};
use super::rule::{EdgeSelection, Head};
use crate::panel::{EdgeRef, PanelSet, Side};
use glam::DVec3;

/// An edge with the panel that comes first, which holds a screw's head.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointEdge {
    /// The first panel's edge.
    pub first: EdgeRef,
    /// The second panel's; none at the border.
    pub second: Option<EdgeRef>,
    /// Where it starts on the first panel's front face, mm.
    pub start: DVec3,
    /// Where it ends, mm.
    pub end: DVec3,
    /// Angle between the two panels' front faces through the wood, radians: π where they lie in one plane; 0 at the
    /// border.
    pub angle: f64,
}

impl JointEdge {
    /// The side that comes first in the set.
    pub(super) fn own(&self) -> EdgeRef {
        self.second.map_or(self.first, |second| self.first.min(second))
    }
}

/// Whether a rule for `selection` is for this edge.
fn selects(set: &PanelSet, selection: EdgeSelection, edge: EdgeRef) -> bool {
    let c = set.corners(edge.panel as usize).start + edge.edge as usize;
    let inner = set.neighbour[c].get().is_some();
    match selection {
        EdgeSelection::All => true,
        EdgeSelection::Inner => inner,
        EdgeSelection::Border => !inner,
        EdgeSelection::AlongRows => inner && matches!(set.side[c], Side::Bottom | Side::Top),
        EdgeSelection::AcrossRows => inner && matches!(set.side[c], Side::Left | Side::Right),
    }
}

/// The selected edges, each once, by panel and edge of the side that comes first in the set. With [`Head::Alternate`]
/// the lower address is first on every other edge. O(edges).
#[must_use]
pub fn select_edges(set: &PanelSet, selection: EdgeSelection, head: Head) -> Vec<JointEdge> {
    let mut all = Vec::new();
    for panel in 0..set.len() as u32 {
        for edge in 0..set.corners(panel as usize).len() as u32 {
            let own = EdgeRef { panel, edge };
            let c = set.corners(panel as usize).start + edge as usize;
            let other = set.neighbour[c].get();
            if !selects(set, selection, own) || other.is_some_and(|n| n < own) {
                continue;
            }
            let key = |e: EdgeRef| (set.address[e.panel as usize], e.panel);
            let want_lower = match head {
                Head::LowerAddress => true,
                Head::HigherAddress => false,
                Head::Alternate => all.len().is_multiple_of(2),
            };
            let (first, second) = match other {
                Some(other) if (key(own) <= key(other)) != want_lower => (other, Some(own)),
                other => (own, other),
            };
            let corners = set.corners(first.panel as usize);
            let at = |k: usize| set.front[corners.start + k % corners.len()];
            let (start, end) = (at(first.edge as usize), at(first.edge as usize + 1));
            let angle = second.map_or(0.0, |second| {
                let (a, b) = (set.normal[first.panel as usize], set.normal[second.panel as usize]);
                let along = (end - start).normalize_or_zero();
                std::f64::consts::PI - a.cross(b).dot(along).atan2(a.dot(b))
            });
            all.push(JointEdge { first, second, start, end, angle });
        }
    }
    all
}

/// A feature that does not lie at its panel.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Misplaced {
    /// There is no such panel, or it could not be made.
    #[error("feature {feature}: there is no panel {panel}")]
    Panel {
        /// Index of the feature.
        feature: usize,
        /// Panel.
        panel: u32,
    },
    /// The panel has no such edge.
    #[error("feature {feature}: panel {panel} has no edge {edge}")]
    Edge {
        /// Index of the feature.
        feature: usize,
        /// Panel.
        panel: u32,
        /// Edge.
        edge: u32,
    },
    /// Nothing was to be made at its edge, or, if it names none, anywhere at its panel.
    #[error("feature {feature}: {} of panel {panel} was not selected", edge.map_or("no edge".into(), |e| format!("edge {e}")))]
    Unselected {
        /// Index of the feature.
        feature: usize,
        /// Panel.
        panel: u32,
        /// Edge that it names.
        edge: Option<u32>,
    },
    /// A point that it is given by lies off the panel.
    #[error("feature {feature}: {distance:.2} mm outside panel {panel}")]
    Outside {
        /// Index of the feature.
        feature: usize,
        /// Panel.
        panel: u32,
        /// How far, mm.
        distance: f64,
    },
}

impl Misplaced {
    /// The panel concerned.
    #[must_use]
    pub fn panel(&self) -> u32 {
        match *self {
            Self::Panel { panel, .. }
            | Self::Edge { panel, .. }
            | Self::Unselected { panel, .. }
            | Self::Outside { panel, .. } => panel,
        }
    }
}

/// Takes out features that do not lie at their panel and at one of `edges`, which were selected: the points that they are
/// given by may be `tolerance` outside the panel's front, back and chamfers, mm. O(edges + features · edges of a panel).
pub fn take_misplaced(
    set: &PanelSet,
    edges: &[JointEdge],
    features: &mut FeatureSet,
    tolerance: f64,
) -> Vec<Misplaced> {
    // Per edge of every panel, in the order of the set.
    let mut selected = vec![false; set.front.len()];
    let sides = edges.iter().flat_map(|e| [Some(e.first), e.second]).flatten();
    for side in sides.filter(|side| (side.panel as usize) < set.len()) {
        if let Some(place) = selected.get_mut(set.corners(side.panel as usize).start + side.edge as usize) {
            *place = true;
        }
    }
    let mut issues = Vec::new();
    let mut number = 0;
    for list in [&mut features.features, &mut features.by_hand] {
        list.retain(|f| {
            let index = number;
            number += 1;
            let issue = misplaced(set, f, tolerance, index).or_else(|| unselected(set, f, &selected, index));
            issues.extend(issue);
            issue.is_none()
        });
    }
    issues
}

/// For a feature of a panel and an edge that there are.
fn unselected(set: &PanelSet, f: &Feature, selected: &[bool], feature: usize) -> Option<Misplaced> {
    let edges = &selected[set.corners(f.panel as usize)];
    let wanted = f.edge.map_or_else(|| edges.contains(&true), |edge| edges[edge as usize]);
    (!wanted).then_some(Misplaced::Unselected { feature, panel: f.panel, edge: f.edge })
}

fn misplaced(set: &PanelSet, f: &Feature, tolerance: f64, feature: usize) -> Option<Misplaced> {
    let Feature { panel, edge, ref machining, .. } = *f;
    let i = panel as usize;
    if i >= set.len() || !set.is_valid(i) {
        return Some(Misplaced::Panel { feature, panel });
    }
    if let Some(edge) = edge.filter(|e| *e as usize >= set.corners(i).len()) {
        return Some(Misplaced::Edge { feature, panel, edge });
    }
    let points: &[DVec3] = match machining {
        Machining::Drill { entry, .. } => &[*entry],
        Machining::Slot { from, to, .. } => &[*from, *to],
        Machining::Pocket { outline, .. } => outline,
        Machining::Contour { line, .. } => line,
        Machining::Engraving { origin, .. } => &[*origin],
    };
    let planes = [set.front_plane(i), set.back_plane(i)].into_iter().flatten();
    let distance = planes
        .chain(set.chamfer[set.corners(i)].iter().copied())
        .flat_map(|plane| points.iter().map(move |p| plane.distance(*p)))
        .fold(f64::NEG_INFINITY, f64::max);
    (distance > tolerance).then_some(Misplaced::Outside { feature, panel, distance })
}
