//! From values to what a graphics card draws: triangles, lines and points, with the part (panel, face) that each belongs
//! to. No window is needed here; it runs beside the evaluation.

mod figures;
mod pick;

use figures::{conicity, fold, off_plane};
use glam::Vec3;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::LazyLock;
use tenon_engine::{Column, Tree};
use tenon_geometry::DVec3;
use tenon_geometry::ifs::Curve;
use tenon_geometry::mesh::Mesh;
use tenon_geometry::panel::PanelSet;
use tenon_nodes::value::{Point, V};

/// Item types that can be seen in the viewport.
pub const VISIBLE: [&str; 4] = ["panels", "mesh", "curve", "point"];

/// Item types that are not shown where another node goes on with them: what follows is made of them.
pub const YIELDS: [&str; 1] = ["mesh"];

/// So many parts are drawn on one thread at a time.
const PIECE: usize = 4096;

/// Bodies of no more vertices than this are one piece: two bytes say which.
const TOGETHER: usize = 1 << 16;

/// A corner of a triangle.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Vertex {
    /// Place, mm.
    pub position: [f32; 3],
    /// Normal, each component times 127; the fourth is 0.
    pub normal: [i8; 4],
    /// The part that it belongs to.
    pub part: u32,
}

/// A straight line.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct Line {
    /// Start, mm.
    pub from: [f32; 3],
    /// End, mm.
    pub to: [f32; 3],
    /// The part that it belongs to.
    pub part: u32,
}

/// Bodies as a card takes them: of every corner one vertex, of every edge two numbers. A triangle has normal and part of its
/// first vertex, so that faces share the others. No more than 65,536 vertices.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bodies {
    /// Corners.
    pub vertices: Vec<Vertex>,
    /// Triangles, three vertices each.
    pub triangles: Vec<u16>,
    /// Edges, by their ends.
    pub edges: Vec<[u16; 2]>,
}

/// What is drawn, which also fixes its colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Panels as solids.
    Panels,
    /// A mesh.
    Mesh,
    /// Curves.
    Curve,
    /// Points.
    Points,
    /// Moves of tools, with colours of their own.
    Paths,
}

/// A panel, a face, a curve or a point that can be picked.
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// What it is called: a panel's address, a number otherwise.
    pub label: String,
    /// Where its label stands, mm.
    pub centre: DVec3,
    /// Area of a panel's front or of a face, mm²; 0 for what has none.
    pub area: f64,
    /// Largest angle between a panel and a neighbour, degrees.
    pub fold: f64,
    /// How far corners lie off the plane through them, mm.
    pub planarity: f64,
    /// How far the sums of opposite angles around its corners differ, degrees: 0 where a conical mesh is. Corners where other
    /// than four faces meet do not count.
    pub conicity: f64,
}

impl Part {
    /// A part without figures.
    #[must_use]
    pub fn new(label: String, centre: DVec3) -> Self {
        Self { label, centre, area: 0.0, fold: 0.0, planarity: 0.0, conicity: 0.0 }
    }
}

/// All that one output shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// What is drawn.
    pub kind: Kind,
    /// Corners of triangles, three by three; those of bodies too, to be picked and cut.
    pub triangles: Vec<Vertex>,
    /// All triangles and their edges as bodies, in pieces; empty if triangles and lines are drawn as they stand.
    pub bodies: Vec<Bodies>,
    /// Edges and curves.
    pub lines: Vec<Line>,
    /// Points, mm.
    pub points: Vec<[f32; 3]>,
    /// What can be picked, by the numbers that corners and lines carry.
    pub parts: Vec<Part>,
    /// Smallest and largest coordinates, mm.
    pub bounds: [DVec3; 2],
    /// Digest of the value that it shows.
    pub digest: u128,
    /// Boxes around the triangles of each part, in their order, so that picking looks at few of them.
    pub(crate) boxes: Vec<PartBox>,
}

/// A box around triangles that stand one after the other and belong to one part.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PartBox {
    corners: Range<usize>,
    low: Vec3,
    high: Vec3,
}

/// What a value looks like; `None` if there is nothing to see. O(corners).
#[must_use]
pub fn draw(tree: &Tree) -> Option<Drawing> {
    beside(|| draw_here(tree))
}

/// Runs work on threads of its own, one fewer than there are cores: what the window shares out among threads never waits for
/// a drawing.
fn beside<T: Send>(work: impl FnOnce() -> T + Send) -> T {
    static THREADS: LazyLock<Option<rayon::ThreadPool>> = LazyLock::new(|| {
        let threads = std::thread::available_parallelism().map_or(1, |n| n.get().saturating_sub(1).max(1));
        rayon::ThreadPoolBuilder::new().num_threads(threads).thread_name(|i| format!("draw {i}")).build().ok()
    });
    match &*THREADS {
        Some(threads) => threads.install(work),
        None => work(),
    }
}

fn draw_here(tree: &Tree) -> Option<Drawing> {
    let mut d = Drawing { digest: tree.digest(), ..Drawing::empty(Kind::Points) };
    for (_, column) in tree.branches() {
        (0..column.len()).for_each(|i| d.item(column, i));
    }
    d.put_in_boxes();
    let seen = !d.triangles.is_empty() || !d.lines.is_empty() || !d.points.is_empty();
    (seen && d.bounds.iter().all(|b| b.is_finite())).then_some(d)
}

impl Drawing {
    /// A drawing of nothing.
    #[must_use]
    pub fn empty(kind: Kind) -> Self {
        Self {
            kind,
            triangles: Vec::new(),
            bodies: Vec::new(),
            lines: Vec::new(),
            points: Vec::new(),
            parts: Vec::new(),
            bounds: [DVec3::INFINITY, DVec3::NEG_INFINITY],
            digest: 0,
            boxes: Vec::new(),
        }
    }

    /// Puts the triangles of every part into a box, as far as they are in none. O(triangles).
    fn put_in_boxes(&mut self) {
        let mut corners = self.boxes.last().map_or(0, |b| b.corners.end);
        for own in self.triangles[corners..].chunk_by(|a, b| a.part == b.part) {
            let places = own.iter().map(|v| Vec3::from(v.position));
            let [low, high] = places.fold([Vec3::INFINITY, Vec3::NEG_INFINITY], |[a, b], p| [a.min(p), b.max(p)]);
            self.boxes.push(PartBox { corners: corners..corners + own.len(), low, high });
            corners += own.len();
        }
    }

    fn item(&mut self, column: &Column, i: usize) {
        if let Some(panels) = column.get::<V<PanelSet>>(i) {
            self.panels(panels);
        } else if let Some(mesh) = column.get::<V<Mesh>>(i) {
            self.mesh(mesh);
        } else if let Some(curve) = column.get::<V<Curve>>(i) {
            self.curve(curve);
        } else if let Some(point) = column.get::<Point>(i) {
            let part = self.part(i.to_string(), point.0);
            debug_assert!((part as usize) < self.parts.len());
            let place = self.place(point.0);
            self.points.push(place);
        }
    }

    fn part(&mut self, label: String, centre: DVec3) -> u32 {
        self.parts.push(Part::new(label, centre));
        self.parts.len() as u32 - 1
    }

    fn place(&mut self, p: DVec3) -> [f32; 3] {
        self.bounds = [self.bounds[0].min(p), self.bounds[1].max(p)];
        p.as_vec3().to_array()
    }

    /// A convex face as triangles from its first corner, all with one normal.
    fn face(&mut self, corners: impl IntoIterator<Item = DVec3>, normal: DVec3, part: u32) {
        let n = (normal * 127.0).round();
        let normal = [n.x as i8, n.y as i8, n.z as i8, 0];
        let mut corners = corners.into_iter();
        let Some(first) = corners.next().map(|p| self.place(p)) else { return };
        let mut before = None;
        for corner in corners {
            let corner = self.place(corner);
            if let Some(before) = before.replace(corner) {
                self.triangles.extend([first, before, corner].map(|position| Vertex { position, normal, part }));
            }
        }
    }

    /// Draws so many parts, a piece of them on each thread: `one` draws the part with that index under that number. What comes of
    /// it depends on no number of threads.
    fn draw_parts(&mut self, count: usize, one: impl Fn(&mut Self, usize, u32) + Sync) {
        let before = self.parts.len();
        let piece = |from: usize| {
            let mut d = Self::empty(self.kind);
            (from..(from + PIECE).min(count)).for_each(|i| one(&mut d, i, (before + i) as u32));
            d.put_in_boxes();
            d
        };
        let starts: Vec<usize> = (0..count).step_by(PIECE).collect();
        let pieces: Vec<Self> = starts.into_par_iter().map(piece).collect();
        self.put_in_boxes();
        self.triangles.reserve_exact(pieces.iter().map(|d| d.triangles.len()).sum());
        pieces.into_iter().for_each(|d| self.append(d));
    }

    /// Puts another one behind this one; its parts are numbered so already.
    fn append(&mut self, mut d: Self) {
        let first = self.triangles.len();
        let moved = |b: PartBox| PartBox { corners: b.corners.start + first..b.corners.end + first, ..b };
        self.boxes.extend(d.boxes.into_iter().map(moved));
        self.triangles.append(&mut d.triangles);
        d.bodies.into_iter().for_each(|b| self.put(b));
        self.parts.append(&mut d.parts);
        self.bounds = [self.bounds[0].min(d.bounds[0]), self.bounds[1].max(d.bounds[1])];
    }

    /// Takes bodies with those before them, as long as there are few: each piece is brought to the card by itself.
    fn put(&mut self, mut b: Bodies) {
        let Some(last) = self.bodies.last_mut().filter(|l| l.vertices.len() + b.vertices.len() <= TOGETHER) else {
            self.bodies.push(b);
            return;
        };
        let first = last.vertices.len() as u16;
        last.vertices.append(&mut b.vertices);
        last.triangles.extend(b.triangles.iter().map(|v| v + first));
        last.edges.extend(b.edges.iter().map(|e| e.map(|v| v + first)));
    }

    fn line(&mut self, from: DVec3, to: DVec3, part: u32) {
        let (from, to) = (self.place(from), self.place(to));
        self.lines.push(Line { from, to, part });
    }

    /// Gives the last parts their conicity, one per face.
    fn conical(&mut self, faces: &[&[DVec3]]) {
        let first = self.parts.len() - faces.len().min(self.parts.len());
        for (part, conicity) in self.parts[first..].iter_mut().zip(conicity(faces)) {
            part.conicity = conicity;
        }
    }

    fn panels(&mut self, panels: &PanelSet) {
        self.kind = Kind::Panels;
        self.draw_parts(panels.len(), |d, i, part| d.panel(panels, i, part));
        let fronts: Vec<&[DVec3]> = (0..panels.len()).map(|i| &panels.front[panels.corners(i)]).collect();
        self.conical(&fronts);
    }

    fn panel(&mut self, panels: &PanelSet, i: usize, part: u32) {
        let solid = panels.solid(i);
        let front = &panels.front[panels.corners(i)];
        let centre = front.iter().sum::<DVec3>() / front.len().max(1) as f64;
        let label = panels.address.get(i).map_or_else(|| i.to_string(), ToString::to_string);
        self.parts.push(Part {
            area: if solid.face_count() > 0 { solid.face_area(0) } else { 0.0 },
            fold: fold(panels, i),
            planarity: off_plane(front),
            ..Part::new(label, centre)
        });
        // The last faces have the fewest corners to choose from.
        let faces = (0..solid.face_count()).rev().map(|f| (solid.face(f), solid.planes[f].normal));
        self.body(&solid.points, faces, false, part);
    }

    /// The piece of bodies that has room for so many vertices, taken out to be put back.
    fn with_room(&mut self, vertices: usize) -> Bodies {
        let room = |b: &Bodies| b.vertices.len() + vertices <= TOGETHER;
        self.bodies.pop_if(|b| room(b)).unwrap_or_default()
    }

    /// Convex faces around a body, or, if it is open, faces on their own.
    fn body<'a>(
        &mut self,
        points: &[DVec3],
        faces: impl ExactSizeIterator<Item = (&'a [u32], DVec3)>,
        open: bool,
        part: u32,
    ) {
        if points.len() + faces.len() > TOGETHER {
            return self.large_body(points, faces, open, part);
        }
        let mut own = self.with_room(points.len() + faces.len());
        let first = own.vertices.len();
        let vertex = |p: &DVec3| Vertex { position: p.as_vec3().to_array(), normal: [0; 4], part };
        own.vertices.extend(points.iter().map(vertex));
        for (face, normal) in faces {
            let corner = self.triangles.len();
            self.face(face.iter().map(|v| points[*v as usize]), normal, part);
            let Some(normal) = self.triangles.get(corner).map(|v| v.normal) else { continue };
            // It begins at a corner at which no other face does, or else at one of its own.
            let free = |v: &u32| own.vertices[first + *v as usize].normal == [0; 4];
            let start = face.iter().position(free).unwrap_or(0);
            let mut round = face[start..].iter().chain(&face[..start]).map(|v| (first + *v as usize) as u16);
            let Some(mut begin) = round.next() else { continue };
            if own.vertices[begin as usize].normal != [0; 4] {
                own.vertices.push(own.vertices[begin as usize]);
                begin = (own.vertices.len() - 1) as u16;
            }
            own.vertices[begin as usize].normal = normal;
            let mut before = None;
            for v in round {
                if let Some(before) = before.replace(v) {
                    own.triangles.extend([begin, before, v]);
                }
            }
            own.edges.extend(edges_of(face, open).map(|edge| edge.map(|v| (first + v as usize) as u16)));
        }
        self.bodies.push(own);
    }

    /// A body of more vertices than a piece can have: its triangles and edges share none.
    fn large_body<'a>(
        &mut self,
        points: &[DVec3],
        faces: impl Iterator<Item = (&'a [u32], DVec3)>,
        open: bool,
        part: u32,
    ) {
        for (face, normal) in faces {
            let corner = self.triangles.len();
            self.face(face.iter().map(|v| points[*v as usize]), normal, part);
            for k in (corner..self.triangles.len()).step_by(3) {
                let mut own = self.with_room(3);
                let first = own.vertices.len() as u16;
                own.vertices.extend_from_slice(&self.triangles[k..k + 3]);
                own.triangles.extend([first, first + 1, first + 2]);
                self.bodies.push(own);
            }
            for edge in edges_of(face, open) {
                let mut own = self.with_room(2);
                let first = own.vertices.len() as u16;
                let end = |v: u32| Vertex { position: points[v as usize].as_vec3().to_array(), normal: [0; 4], part };
                own.vertices.extend(edge.map(end));
                own.edges.push([first, first + 1]);
                self.bodies.push(own);
            }
        }
    }

    fn mesh(&mut self, mesh: &Mesh) {
        self.kind = Kind::Mesh;
        self.draw_parts(mesh.face_count(), |d, f, part| d.mesh_face(mesh, f, part));
        let faces: Vec<Vec<DVec3>> = (0..mesh.face_count()).map(|f| mesh.face_points(f).collect()).collect();
        self.conical(&faces.iter().map(Vec::as_slice).collect::<Vec<_>>());
    }

    fn mesh_face(&mut self, mesh: &Mesh, f: usize, part: u32) {
        let corners: Vec<DVec3> = mesh.face_points(f).collect();
        let label = mesh.addresses.get(f).map_or_else(|| f.to_string(), ToString::to_string);
        self.parts.push(Part {
            area: mesh.face_area_vector(f).length(),
            planarity: off_plane(&corners),
            ..Part::new(label, mesh.face_centre(f))
        });
        let round: Vec<u32> = (0..corners.len() as u32).collect();
        self.body(&corners, [(&round[..], mesh.face_normal(f).unwrap_or(DVec3::Z))].into_iter(), true, part);
    }

    fn curve(&mut self, curve: &Curve) {
        self.kind = Kind::Curve;
        let points = curve.projected();
        let label = self.parts.len().to_string();
        let part = self.part(label, points.first().copied().unwrap_or_default());
        for strip in curve.strips() {
            for w in points.get(strip).unwrap_or(&[]).windows(2) {
                self.line(w[0], w[1], part);
            }
        }
        if let (true, Some(first), Some(last)) = (curve.closed, points.first(), points.last()) {
            self.line(*last, *first, part);
        }
    }

    /// The corners of a part's triangles. O(parts).
    pub fn corners_of(&self, part: u32) -> impl Iterator<Item = DVec3> {
        let own = move |b: &&PartBox| self.triangles.get(b.corners.start).is_some_and(|v| v.part == part);
        let corners = self.boxes.iter().filter(own).flat_map(|b| &self.triangles[b.corners.clone()]);
        corners.map(|v| DVec3::from(v.position.map(f64::from)))
    }
}

/// Edges of a face. Those of a closed body are run along twice, in opposite directions, and are edges once.
fn edges_of(face: &[u32], open: bool) -> impl Iterator<Item = [u32; 2]> {
    let next = face.iter().cycle().skip(1);
    face.iter().zip(next).map(|(a, b)| [*a, *b]).filter(move |[a, b]| open && a != b || a < b)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges(d: &Drawing) -> usize {
        d.bodies.iter().map(|b| b.edges.len()).sum()
    }

    /// Both say the same: as many triangles, of one area by normal and part, and every edge between two corners of one part.
    fn bodies_are_the_triangles(d: &Drawing) {
        let area = |t: [Vertex; 3]| {
            let [a, b, c] = t.map(|v| DVec3::from(v.position.map(f64::from)));
            (b - a).cross(c - a).length()
        };
        let mut sums: std::collections::BTreeMap<(u32, [i8; 4]), f64> = Default::default();
        for t in d.triangles.chunks_exact(3) {
            *sums.entry((t[0].part, t[0].normal)).or_default() += area([t[0], t[1], t[2]]);
        }
        for b in &d.bodies {
            for t in b.triangles.chunks_exact(3) {
                let t = [t[0], t[1], t[2]].map(|v| b.vertices[v as usize]);
                assert!(t.iter().all(|v| v.part == t[0].part));
                *sums.entry((t[0].part, t[0].normal)).or_default() -= area(t);
            }
            assert!(b.edges.iter().flatten().all(|v| (*v as usize) < b.vertices.len()));
        }
        assert_eq!(d.triangles.len(), d.bodies.iter().map(|b| b.triangles.len()).sum::<usize>());
        assert!(d.bodies.iter().all(|b| b.vertices.len() <= TOGETHER));
        assert!(sums.values().all(|s| s.abs() < 1.0), "{sums:?}");
    }

    #[test]
    fn faces_of_a_body_share_its_corners() {
        let corners: Vec<DVec3> =
            (0..8).map(|i| DVec3::from([i & 1, i >> 1 & 1, i >> 2].map(|c| f64::from(c) * 2.0))).collect();
        let faces = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let normals = [-DVec3::Z, DVec3::Z, -DVec3::Y, DVec3::Y, -DVec3::X, DVec3::X];
        let mut d = Drawing::empty(Kind::Panels);
        d.body(&corners, faces.iter().map(|f| &f[..]).zip(normals), false, 0);
        assert_eq!((d.bodies[0].vertices.len(), edges(&d), d.triangles.len()), (8, 12, 36));
        bodies_are_the_triangles(&d);
        // Three faces that all have one triangle's corners cannot all begin at one of their own.
        let mut d = Drawing::empty(Kind::Panels);
        let same = [[0_u32, 1, 2]; 4];
        d.body(&corners[..3], same.iter().map(|f| &f[..]).zip(normals), false, 0);
        assert_eq!(d.bodies[0].vertices.len(), 4);
        bodies_are_the_triangles(&d);
    }

    #[test]
    fn a_body_of_more_corners_than_a_piece_can_number_is_several_pieces() {
        const COUNT: usize = TOGETHER + 5_000;
        let on_circle = |i: usize| {
            let angle = i as f64 / COUNT as f64 * std::f64::consts::TAU;
            DVec3::new(angle.cos(), angle.sin(), 0.0) * 1e4
        };
        let face: Box<[u32; COUNT]> = Box::new(std::array::from_fn(|i| i as u32));
        let mesh = Mesh::from_faces((0..COUNT).map(on_circle).collect(), std::slice::from_ref(&*face));
        let d = draw(&Tree::item(V::new(mesh))).unwrap();
        assert_eq!((d.triangles.len(), edges(&d), d.parts.len()), (3 * (COUNT - 2), COUNT, 1));
        bodies_are_the_triangles(&d);
    }

    #[test]
    fn a_mesh_is_drawn_and_picked_by_face() {
        let points = [[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [0.0, 1.0], [2.0, 1.0], [4.0, 1.0]];
        let points = points.map(|[x, y]| DVec3::new(x, y, 0.0)).to_vec();
        let mesh = Mesh::from_faces(points, &[[0, 1, 4, 3], [1, 2, 5, 4]]);
        let d = draw(&Tree::item(V::new(mesh))).unwrap();
        assert_eq!((d.triangles.len(), edges(&d), d.parts.len()), (12, 8, 2));
        assert_eq!(d.bounds, [DVec3::ZERO, DVec3::new(4.0, 1.0, 0.0)]);
        assert_eq!(d.pick(DVec3::new(3.0, 0.5, 5.0), -DVec3::Z, |_| true), Some((1, 5.0)));
        assert_eq!(d.pick(DVec3::new(3.0, 1.5, 5.0), -DVec3::Z, |_| true), None);
        assert_eq!(d.triangles[0].normal, [0, 0, 127, 0]);
    }

    #[test]
    fn many_parts_are_drawn_in_pieces_and_come_out_as_one_by_one() {
        // A strip of more faces than one thread draws at a time, behind a mesh of one face.
        let count = 2 * PIECE + 5;
        let points = (0..2 * count + 2).map(|i| DVec3::new((i / 2) as f64, (i % 2) as f64, 0.0)).collect();
        let face = |i: usize| [2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1].map(|v| v as u32);
        let strip = Mesh::from_faces(points, &(0..count).map(face).collect::<Vec<_>>());
        let one = Mesh::from_faces(strip.face_points(0).collect(), &[[0, 1, 2, 3]]);
        let d = draw(&Tree::list(vec![V::new(one), V::new(strip)])).unwrap();
        assert_eq!((d.parts.len(), d.triangles.len(), edges(&d)), (count + 1, 6 * (count + 1), 4 * (count + 1)));
        bodies_are_the_triangles(&d);
        assert_eq!(d.bounds[1], DVec3::new(count as f64, 1.0, 0.0));
        for (i, triangle) in d.triangles.chunks_exact(3).enumerate() {
            assert!(triangle.iter().all(|v| v.part == i as u32 / 2), "triangle {i}");
        }
        let part = PIECE as u32 + 40;
        let from = d.parts[part as usize].centre + DVec3::Z;
        assert_eq!(d.pick(from, -DVec3::Z, |_| true), Some((part, 1.0)));
        assert_eq!(d.corners_of(part).count(), 6);
        assert_eq!(d.parts[part as usize].label, (part - 1).to_string());
    }

    #[test]
    fn many_small_meshes_are_few_pieces() {
        let square = |i: usize| {
            let at = |x: f64, y: f64| DVec3::new(i as f64 * 2.0 + x, y, 0.0);
            V::new(Mesh::from_faces(vec![at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)], &[[0, 1, 2, 3]]))
        };
        let count = 20_000;
        let d = draw(&Tree::list((0..count).map(square).collect())).unwrap();
        let vertices: usize = d.bodies.iter().map(|b| b.vertices.len()).sum();
        assert_eq!((d.bodies.len(), vertices, edges(&d)), (2, 4 * count, 4 * count));
        bodies_are_the_triangles(&d);
        for (b, edge) in d.bodies.iter().flat_map(|b| b.edges.iter().map(move |e| (b, e))) {
            let [from, to] = edge.map(|v| b.vertices[v as usize]);
            assert_eq!(from.part, to.part, "an edge belongs to one mesh");
        }
    }

    #[test]
    fn drawings_leave_a_core_and_the_common_threads_to_the_window() {
        let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
        assert_eq!(beside(rayon::current_num_threads), (cores - 1).max(1));
        assert_eq!(beside(|| std::thread::current().name().map(|n| n.starts_with("draw "))), Some(true));
    }

    #[test]
    fn what_cannot_be_seen_is_not_drawn() {
        assert_eq!(draw(&Tree::item(3.0)), None);
        assert_eq!(draw(&Tree::list::<Point>(Vec::new())), None);
    }
}
