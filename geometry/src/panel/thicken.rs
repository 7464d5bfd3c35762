//! Faces become panels: offset faces, bisector chamfers, border cuts and voided nodes (METHODS §5, 000 §6.3).

use super::border::{BorderCut, BorderRule};
use super::issue::{PanelIssue, ThickenError};
use super::node::{Cone, Inset};
use super::set::{EdgeRef, PanelSet, Side};
use crate::mesh::{Address, Adjacency, Mesh};
use crate::plane::Plane;
use crate::shared::Shared;
use glam::DVec3;

/// What happens at nodes whose candidate back corners differ (000 §6.3.5).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Nodes {
    /// They are voided, so that no two panels overlap.
    Void,
    /// Every panel keeps its own corner: panels overlap or gape at nodes that are not conical. For study only.
    Keep,
}

/// Parameters of [`thicken`].
#[derive(Clone, Debug, PartialEq)]
pub struct ThickenParams {
    /// Thickness of the boards, mm; greater than zero.
    pub thickness: f64,
    /// How the border edges are cut.
    pub border: BorderRule,
    /// What happens at nodes that are not conical.
    pub nodes: Nodes,
    /// Faces further from planar than this are reported, mm.
    pub planar_within: f64,
    /// Faces further from planar than this are refused, mm; the others are projected to their fitted plane.
    pub project_up_to: f64,
    /// Points closer than this count as one, mm: a node whose candidate corners agree so far is not voided.
    pub merge: f64,
    /// Greatest lean of a chamfer from square, radians, below π/2: half the angle between neighbouring normals.
    pub max_lean: f64,
    /// Least turn of a face's outline at a corner, radians.
    pub min_turn: f64,
}

impl ThickenParams {
    /// Panels of `thickness` mm with square borders and voided nodes; faces may be 0.1 mm out of plane, chamfers lean
    /// up to 85°.
    #[must_use]
    pub fn new(thickness: f64) -> Self {
        Self {
            thickness,
            border: BorderRule::default(),
            nodes: Nodes::Void,
            planar_within: 1e-4,
            project_up_to: 0.1,
            merge: 1e-6,
            max_lean: 85f64.to_radians(),
            min_turn: 1e-6,
        }
    }

    fn check(&self) -> Result<(), ThickenError> {
        if !(self.thickness > 0.0 && self.thickness.is_finite()) {
            return Err(ThickenError::Thickness(self.thickness));
        }
        let wrong = |name, value, range| Err(ThickenError::Parameter { name, value, range });
        for (name, value) in
            [("planar_within", self.planar_within), ("project_up_to", self.project_up_to), ("merge", self.merge)]
        {
            if !(value >= 0.0 && value.is_finite()) {
                return wrong(name, value, "zero or a positive number of millimetres");
            }
        }
        for (name, value) in [("max_lean", self.max_lean), ("min_turn", self.min_turn)] {
            if !(0.0..std::f64::consts::FRAC_PI_2).contains(&value) {
                return wrong(name, value, "at least 0 and less than a right angle");
            }
        }
        let b = &self.border;
        for cut in [b.bottom, b.right, b.top, b.left, b.other].into_iter().chain(b.edges.iter().map(|e| e.cut)) {
            match cut {
                BorderCut::Angle(a) if !a.is_finite() => return wrong("border angle", a, "a finite angle"),
                BorderCut::InPlane { normal } if normal.try_normalize().is_none() => {
                    return wrong("length of the limit plane's normal", normal.length(), "positive and finite");
                }
                _ => {}
            }
        }
        Ok(())
    }
}

/// Makes a panel of every face of `mesh`. The faces are the fronts; the wood lies behind them.
///
/// Inner edges are cut in the bisector plane of their two faces, border edges by `params.border`. The back face is
/// parallel to the front at exactly `thickness`. At nodes that are not conical each end of a back edge takes, of the two
/// candidates that its two panels propose, the one further along the edge, which takes wood from the panels only: so
/// panels stay convex and do not overlap. A face that cannot become a panel leaves its panel empty at its index and
/// gives a fatal issue; its neighbours are chamfered as if it were there. Issues are ordered by face. Time O(c log v)
/// and memory O(c) for c corners with v edges at a vertex.
///
/// # Errors
/// Parameters out of range, a mesh that is broken, not manifold or not consistently oriented, a border cut for an edge
/// that is no border edge.
pub fn thicken(mesh: &Mesh, params: &ThickenParams) -> Result<(PanelSet, Vec<PanelIssue>), ThickenError> {
    thicken_while(mesh, params, &|| true)
}

/// As [`thicken`]; stops when `go`, asked every few hundred faces, says no.
///
/// # Errors
/// As [`thicken`], and [`ThickenError::Cancelled`].
pub fn thicken_while(
    mesh: &Mesh,
    params: &ThickenParams,
    go: &(dyn Fn() -> bool + Sync),
) -> Result<(PanelSet, Vec<PanelIssue>), ThickenError> {
    let on = || if go() { Ok(()) } else { Err(ThickenError::Cancelled) };
    params.check()?;
    let adjacency = Adjacency::new(mesh)?;
    on()?;
    let on = |count: u32| if count.is_multiple_of(OFTEN) { on() } else { Ok(()) };
    let mut work = Work::new(mesh, &adjacency, params);
    work.fit_faces(&on)?;
    work.cut_edges(&on)?;
    work.propose_corners(&on)?;
    if params.nodes == Nodes::Void {
        work.widen_nodes();
        on(0)?;
    }
    // First the panels that are impossible by themselves, so that they do not take their neighbours along.
    work.check_offsets(Nodes::Keep, &on)?;
    if params.nodes == Nodes::Void {
        work.check_offsets(Nodes::Void, &on)?;
    }
    let set = work.finish(&on)?;
    work.issues.sort_by_key(PanelIssue::face);
    Ok((set, work.issues))
}

/// So many faces or corners are worked on before it is asked whether to go on.
const OFTEN: u32 = 256;

/// Asked with the number of the face or corner: an error if it should stop.
type On<'a> = &'a dyn Fn(u32) -> Result<(), ThickenError>;

/// Per-corner columns are indexed like `Mesh::face_vertices`.
pub(super) struct Work<'a> {
    pub(super) mesh: &'a Mesh,
    pub(super) adjacency: &'a Adjacency,
    pub(super) params: &'a ThickenParams,
    pub(super) issues: Vec<PanelIssue>,
    /// Per face: whether it can still become a panel.
    pub(super) alive: Vec<bool>,
    /// Per face: its fitted plane; meaningless where there is no area.
    pub(super) plane: Vec<Option<Plane>>,
    /// Per corner: unit direction of its edge.
    pub(super) along: Vec<DVec3>,
    /// Per corner: length of its edge, mm.
    pub(super) length: Vec<f64>,
    /// Per corner: chamfer plane of its edge.
    pub(super) chamfer: Vec<Plane>,
    /// Per corner: how the corner moves along both its chamfers while sinking 1 mm into the wood.
    pub(super) sink: Vec<DVec3>,
    /// Per corner: height of the mesh vertex above the fitted plane, mm.
    pub(super) height: Vec<f64>,
    /// Per vertex: the cone that voids it, on nodes of more panels than the rule of two candidates can part.
    pub(super) cone: Vec<Option<Cone>>,
}

impl<'a> Work<'a> {
    fn new(mesh: &'a Mesh, adjacency: &'a Adjacency, params: &'a ThickenParams) -> Self {
        let (faces, corners) = (mesh.face_count(), mesh.face_vertices.len());
        Self {
            mesh,
            adjacency,
            params,
            issues: Vec::new(),
            alive: vec![true; faces],
            plane: Vec::with_capacity(faces),
            along: Vec::with_capacity(corners),
            length: Vec::with_capacity(corners),
            chamfer: vec![Plane { normal: DVec3::Z, offset: 0.0 }; corners],
            sink: vec![DVec3::ZERO; corners],
            height: vec![0.0; corners],
            cone: Vec::new(),
        }
    }

    fn vertex(&self, corner: u32) -> DVec3 {
        self.mesh.points[self.mesh.face_vertices[corner as usize] as usize]
    }

    fn fail(&mut self, issue: PanelIssue) {
        self.alive[issue.face() as usize] = false;
        self.issues.push(issue);
    }

    /// The edge number of a corner within its face.
    fn edge(&self, corner: u32) -> u32 {
        corner - self.mesh.face_start[self.adjacency.face_of(corner) as usize]
    }

    /// Fitted planes, edge directions; refuses faces that are degenerate, concave or not planar.
    fn fit_faces(&mut self, on: On<'_>) -> Result<(), ThickenError> {
        for f in 0..self.mesh.face_count() as u32 {
            on(f)?;
            for c in self.adjacency.corners(f) {
                let edge = self.vertex(self.adjacency.next(c)) - self.vertex(c);
                let length = edge.length();
                self.length.push(length);
                self.along.push(edge / length);
            }
            let plane = self.mesh.face_plane(f as usize);
            self.plane.push(plane);
            if let Some(issue) = self.face_issue(f, plane) {
                self.fail(issue);
            }
        }
        Ok(())
    }

    fn face_issue(&self, face: u32, plane: Option<Plane>) -> Option<PanelIssue> {
        let p = self.params;
        let corners = self.adjacency.corners(face);
        for c in corners.clone() {
            let length = self.length[c as usize];
            if length <= p.merge {
                return Some(PanelIssue::ShortEdge { face, edge: self.edge(c), length, merge: p.merge });
            }
        }
        let Some(plane) = plane else { return Some(PanelIssue::NoArea { face }) };
        let mismatch = corners.clone().map(|c| plane.distance(self.vertex(c)).abs()).fold(0.0, f64::max);
        if mismatch > p.project_up_to {
            return Some(PanelIssue::NotPlanar { face, mismatch, tolerance: p.project_up_to });
        }
        let most = std::f64::consts::FRAC_PI_2 - p.max_lean;
        for c in corners.clone() {
            let slope = plane.normal.dot(self.along[c as usize]).abs().asin();
            if slope > most {
                return Some(PanelIssue::Slope { face, edge: self.edge(c), slope, most });
            }
        }
        let mut round = 0.0;
        for c in corners {
            let (before, after) = (self.along[self.adjacency.previous(c) as usize], self.along[c as usize]);
            let turn = plane.normal.dot(before.cross(after)).atan2(before.dot(after));
            if turn <= p.min_turn {
                return Some(PanelIssue::Concave { face, corner: self.edge(c), turn, least: p.min_turn });
            }
            round += turn;
        }
        let turns = (round / std::f64::consts::TAU).round() as u32;
        (turns != 1).then_some(PanelIssue::CrossesItself { face, turns })
    }

    /// Chamfer planes of all edges; refuses folds and border cuts that lean too far.
    fn cut_edges(&mut self, on: On<'_>) -> Result<(), ThickenError> {
        let mut exceptions = std::collections::BTreeMap::new();
        for e in &self.params.border.edges {
            let none = ThickenError::NoBorderEdge { face: e.face, edge: e.edge };
            if e.face as usize >= self.mesh.face_count() {
                return Err(none);
            }
            let corners = self.adjacency.corners(e.face);
            if e.edge as usize >= corners.len() || self.adjacency.twin(corners.start + e.edge).is_some() {
                return Err(none);
            }
            exceptions.insert(corners.start + e.edge, e.cut);
        }
        for c in 0..self.mesh.face_vertices.len() as u32 {
            on(c)?;
            let face = self.adjacency.face_of(c);
            let Some(own) = self.plane[face as usize] else { continue };
            let across = self.adjacency.twin(c).and_then(|t| {
                let neighbour = self.adjacency.face_of(t);
                self.plane[neighbour as usize].map(|plane| (t, neighbour, plane.normal))
            });
            let edge = self.edge(c);
            let most = self.params.max_lean;
            let cut = match across {
                Some((_, neighbour, normal)) => {
                    let fold = angle(own.normal, normal);
                    let issue = PanelIssue::Fold { face, edge, neighbour, angle: fold, most: 2.0 * most };
                    if fold > 2.0 * most { Err(issue) } else { Ok(own.normal + normal) }
                }
                None => {
                    let cut = exceptions.get(&c).copied().unwrap_or(self.params.border.side(self.side(c)));
                    let (lean, mean) = border_direction(cut, own.normal, self.along[c as usize]);
                    let issue = PanelIssue::BorderLean { face, edge, lean, most };
                    if lean > most { Err(issue) } else { Ok(mean) }
                }
            };
            match cut {
                // One plane for both panels of an edge: their chamfers coincide to the last bit.
                Ok(_) if across.is_some_and(|(t, ..)| t < c) => {
                    let twin = self.chamfer[across.map_or(c, |(t, ..)| t) as usize];
                    self.chamfer[c as usize] = Plane { normal: -twin.normal, offset: -twin.offset };
                }
                Ok(mean) => {
                    let normal = self.along[c as usize].cross(mean).normalize();
                    self.chamfer[c as usize] = Plane::through(self.vertex(c), normal);
                }
                Err(issue) if self.alive[face as usize] => self.fail(issue),
                Err(_) => {}
            }
        }
        Ok(())
    }

    fn side(&self, corner: u32) -> Side {
        let face = self.adjacency.face_of(corner) as usize;
        if self.mesh.addresses.len() != self.mesh.face_count() || self.mesh.face(face).len() != 4 {
            return Side::Other;
        }
        [Side::Bottom, Side::Right, Side::Top, Side::Left][self.edge(corner) as usize]
    }

    /// Corner lines of the living panels.
    fn propose_corners(&mut self, on: On<'_>) -> Result<(), ThickenError> {
        for c in 0..self.mesh.face_vertices.len() as u32 {
            on(c)?;
            let face = self.adjacency.face_of(c) as usize;
            let (true, Some(plane)) = (self.alive[face], self.plane[face]) else { continue };
            let before = self.chamfer[self.adjacency.previous(c) as usize].normal;
            let line = before.cross(self.chamfer[c as usize].normal);
            let rise = plane.normal.dot(line);
            // Positive: the outline is convex and no chamfer leans by a right angle. Only a corner that is straight to
            // within the slope of its edges can come out otherwise.
            if rise.is_nan() || rise <= 0.0 {
                let (face, least) = (face as u32, self.params.min_turn);
                self.fail(PanelIssue::Concave { face, corner: self.edge(c), turn: rise, least });
                continue;
            }
            self.sink[c as usize] = -line / rise;
            self.height[c as usize] = plane.distance(self.vertex(c));
        }
        Ok(())
    }

    /// Refuses panels of which a back edge vanishes.
    fn check_offsets(&mut self, nodes: Nodes, on: On<'_>) -> Result<(), ThickenError> {
        let thickness = self.params.thickness;
        let mut flipped = Vec::new();
        for face in 0..self.mesh.face_count() as u32 {
            on(face)?;
            if !self.alive[face as usize] {
                continue;
            }
            let mut worst: Option<(f64, u32, f64)> = None;
            for c in self.adjacency.corners(face) {
                let front = self.length[c as usize];
                let furthest = |[own, other]: [Inset; 2]| own.at.max(other.at);
                let [start, end] = self.candidates(c, nodes).map(furthest);
                let length = front - start - end;
                // The largest thickness holds for the nodes as they will be.
                let [starts, ends] = self.candidates(c, self.params.nodes);
                let mut largest = f64::INFINITY;
                for (s, e) in starts.iter().flat_map(|s| ends.iter().map(move |e| (s, e))) {
                    let rate = s.per_depth + e.per_depth;
                    if rate > 0.0 {
                        largest = largest.min(thickness + (front - s.at - e.at) / rate);
                    }
                }
                if length <= self.params.merge && worst.is_none_or(|w| largest < w.2) {
                    worst = Some((length, self.edge(c), largest));
                }
            }
            if let Some((length, edge, largest)) = worst {
                flipped.push(PanelIssue::OffsetFlips { face, edge, length, thickness, largest });
            }
        }
        flipped.into_iter().for_each(|issue| self.fail(issue));
        Ok(())
    }

    /// Writes the set, reports projected faces.
    fn finish(&mut self, on: On<'_>) -> Result<PanelSet, ThickenError> {
        let (mesh, p) = (self.mesh, self.params);
        let faces = mesh.face_count();
        let corners: usize = (0..faces).filter(|&f| self.alive[f]).map(|f| mesh.face(f).len()).sum();
        let mut set = PanelSet {
            thickness: p.thickness,
            address: address_column(mesh),
            front: Vec::with_capacity(corners).into(),
            vertex: Vec::with_capacity(corners).into(),
            chamfer: Vec::with_capacity(corners).into(),
            neighbour: Vec::with_capacity(corners).into(),
            side: Vec::with_capacity(corners).into(),
            back_start: Vec::with_capacity(corners).into(),
            back_end: Vec::with_capacity(corners).into(),
            voided: Vec::with_capacity(corners).into(),
            ..PanelSet::default()
        };
        let mut corner_start = Vec::with_capacity(faces + 1);
        let mut normal = Vec::with_capacity(faces);
        corner_start.push(0);
        for face in 0..faces as u32 {
            on(face)?;
            let plane = self.plane[face as usize];
            normal.push(plane.map_or(DVec3::ZERO, |p| p.normal));
            if let (true, Some(plane)) = (self.alive[face as usize], plane) {
                self.write_panel(&mut set, face, plane);
            }
            corner_start.push(set.front.len() as u32);
        }
        Ok(PanelSet { normal: normal.into(), corner_start: corner_start.into(), ..set })
    }

    fn write_panel(&mut self, set: &mut PanelSet, face: u32, plane: Plane) {
        let (front_corners, vertices, chamfers) = (set.front.to_mut(), set.vertex.to_mut(), set.chamfer.to_mut());
        let (neighbours, sides) = (set.neighbour.to_mut(), set.side.to_mut());
        let (back_start, back_end, voided) = (set.back_start.to_mut(), set.back_end.to_mut(), set.voided.to_mut());
        let (p, first) = (self.params, front_corners.len());
        let (mut mismatch, mut moved) = (0f64, 0f64);
        for c in self.adjacency.corners(face) {
            let (i, n) = (c as usize, self.adjacency.next(c));
            let vertex = self.vertex(c);
            let front = vertex + self.sink[i] * self.height[i];
            mismatch = mismatch.max(self.height[i].abs());
            moved = moved.max(front.distance(vertex));
            let [starts, ends] = self.candidates(c, p.nodes);
            // Along the line where chamfer and back face meet, 1 mm along the edge.
            let line = plane.normal.cross(self.chamfer[i].normal);
            let line = line / line.dot(self.along[i]);
            let own_start = front + self.sink[i] * p.thickness;
            let end_corner = self.vertex(n) + self.sink[n as usize] * self.height[n as usize];
            let own_end = end_corner + self.sink[n as usize] * p.thickness;
            let pull = |[own, other]: [Inset; 2]| {
                let pull = other.at - own.at;
                if pull > p.merge { pull } else { 0.0 }
            };
            front_corners.push(front);
            vertices.push(self.mesh.face_vertices[i]);
            chamfers.push(self.chamfer[i]);
            let living = |t: &u32| self.alive[self.adjacency.face_of(*t) as usize];
            let across = self.adjacency.twin(c).filter(living);
            let across = across.map(|t| EdgeRef { panel: self.adjacency.face_of(t), edge: self.edge(t) });
            neighbours.push(across.into());
            sides.push(self.side(c));
            back_start.push(own_start + line * pull(starts));
            back_end.push(own_end - line * pull(ends));
        }
        let count = front_corners.len() - first;
        for k in 0..count {
            let (before, after) = (first + (k + count - 1) % count, first + k);
            voided.push(back_end[before] != back_start[after]);
        }
        if mismatch > p.planar_within {
            self.issues.push(PanelIssue::Projected { face, mismatch, moved });
        }
    }
}

/// One address per panel, also where the mesh has none.
fn address_column(mesh: &Mesh) -> Shared<Address> {
    if mesh.addresses.len() == mesh.face_count() {
        return mesh.addresses.clone();
    }
    (0..mesh.face_count() as u32).map(|column| Address { patch: 0, row: 0, column }).collect()
}

/// Lean of a border cut from square, and a vector that lies in the cut across the edge.
fn border_direction(cut: BorderCut, normal: DVec3, along: DVec3) -> (f64, DVec3) {
    match cut {
        BorderCut::Square => (0.0, normal),
        BorderCut::InPlane { normal: limit } => {
            let limit = limit.normalize();
            let lean = limit.dot(normal).abs().atan2(limit.cross(normal).length());
            // Half of n0 + n_i with the imaginary neighbour n_i = n0 - 2 l (l · n0).
            (lean, normal - limit * limit.dot(normal))
        }
        BorderCut::Angle(lean) => (lean.abs(), normal * lean.cos() + along.cross(normal) * lean.sin()),
    }
}

/// Angle between two unit vectors, exact near 0 and π.
fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}
