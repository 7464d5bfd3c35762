//! Values as triangles, lines and points for a host's viewport. Positions are `f32` about an origin of their own, so that
//! a building far from zero does not tremble.

use crate::value::{Point, V};
use tenon_engine::{Column, Tree};
use tenon_geometry::DVec3;
use tenon_geometry::ifs::Curve;
use tenon_geometry::mesh::{Address, Mesh};
use tenon_geometry::panel::PanelSet;
use tenon_geometry::polygon::Polygon;

/// What can be picked: a panel, a face, a curve or a point, and where it stands in its tree.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Part {
    /// Branch of the tree.
    pub branch: u32,
    /// Item of the branch.
    pub item: u64,
    /// Panel or face in the item; 0 for what has none.
    pub element: u32,
    /// Its address; `None` for what has none.
    pub address: Option<Address>,
}

/// What a value looks like. Triangles have vertices of their own face by face, so that edges stay sharp.
#[derive(Clone, Debug, Default)]
pub struct Preview {
    /// The middle of all, mm: added to a position it gives the place in space.
    pub origin: DVec3,
    /// Smallest and largest coordinates in space, mm; both 0 if there is nothing.
    pub bounds: [DVec3; 2],
    /// Positions of vertices about the origin, mm.
    pub positions: Vec<[f32; 3]>,
    /// Unit normals of vertices; 0 for those of lines and points.
    pub normals: Vec<[f32; 3]>,
    /// The part of each vertex.
    pub vertex_parts: Vec<u32>,
    /// Vertices of triangles, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Vertices of lines.
    pub lines: Vec<[u32; 2]>,
    /// Vertices of points.
    pub points: Vec<u32>,
    /// What can be picked.
    pub parts: Vec<Part>,
}

/// Panels (as solids), meshes, polygons, curves and points of a tree; other types show nothing. O(corners), and
/// O(corners²) per concave face.
#[must_use]
pub fn preview(tree: &Tree) -> Preview {
    let mut builder = Builder::default();
    for (b, (_, column)) in tree.branches().iter().enumerate() {
        for i in 0..column.len() {
            builder.at = (b as u32, i as u64);
            builder.item(column, i);
        }
    }
    builder.finish()
}

#[derive(Default)]
struct Builder {
    out: Preview,
    places: Vec<DVec3>,
    at: (u32, u64),
}

impl Builder {
    fn item(&mut self, column: &Column, i: usize) {
        if let Some(panels) = column.get::<V<PanelSet>>(i) {
            self.panels(panels);
        } else if let Some(mesh) = column.get::<V<Mesh>>(i) {
            self.mesh(mesh);
        } else if let Some(curve) = column.get::<V<Curve>>(i) {
            self.curve(curve);
        } else if let Some(polygon) = column.get::<V<Polygon>>(i) {
            self.part(0, None);
            self.outline(polygon.corners(), true);
        } else if let Some(point) = column.get::<Point>(i) {
            self.part(0, None);
            let vertex = self.vertex(point.0, DVec3::ZERO);
            self.out.points.push(vertex);
        }
    }

    fn part(&mut self, element: usize, address: Option<Address>) {
        let (branch, item) = self.at;
        self.out.parts.push(Part { branch, item, element: element as u32, address });
    }

    /// A vertex of the part that was begun last.
    fn vertex(&mut self, place: DVec3, normal: DVec3) -> u32 {
        self.places.push(place);
        self.out.normals.push(normal.as_vec3().to_array());
        self.out.vertex_parts.push(self.out.parts.len() as u32 - 1);
        self.places.len() as u32 - 1
    }

    /// A flat face: its vertices, its triangles; gives the first vertex.
    fn face(&mut self, corners: &[DVec3], normal: DVec3) -> u32 {
        let first = self.places.len() as u32;
        for p in corners {
            self.vertex(*p, normal);
        }
        let triangles = tenon_geometry::mesh::triangles(corners, normal);
        self.out.triangles.extend(triangles.into_iter().map(|t| t.map(|k| first + k)));
        first
    }

    fn panels(&mut self, panels: &PanelSet) {
        for i in (0..panels.len()).filter(|i| panels.is_valid(*i)) {
            self.part(i, panels.address.get(i).copied());
            let solid = panels.solid(i);
            for f in 0..solid.face_count() {
                let face = solid.face(f);
                let corners: Vec<DVec3> = face.iter().map(|v| solid.points[*v as usize]).collect();
                let first = self.face(&corners, solid.planes[f].normal);
                for k in 0..face.len() {
                    let next = (k + 1) % face.len();
                    // Every edge is run along twice, in opposite directions.
                    if face[k] < face[next] {
                        self.out.lines.push([first + k as u32, first + next as u32]);
                    }
                }
            }
        }
    }

    fn mesh(&mut self, mesh: &Mesh) {
        for f in 0..mesh.face_count() {
            self.part(f, mesh.addresses.get(f).copied());
            let corners: Vec<DVec3> = mesh.face_points(f).collect();
            let first = self.face(&corners, mesh.face_normal(f).unwrap_or(DVec3::Z));
            let n = corners.len() as u32;
            self.out.lines.extend((0..n).map(|k| [first + k, first + (k + 1) % n]));
        }
    }

    fn curve(&mut self, curve: &Curve) {
        self.part(0, None);
        let points = curve.projected();
        for strip in curve.strips() {
            self.outline(points.get(strip).unwrap_or(&[]), curve.closed);
        }
    }

    fn outline(&mut self, points: &[DVec3], closed: bool) {
        let first = self.places.len() as u32;
        for p in points {
            self.vertex(*p, DVec3::ZERO);
        }
        let n = points.len() as u32;
        self.out.lines.extend((1..n).map(|k| [first + k - 1, first + k]));
        if closed && n > 2 {
            self.out.lines.push([first + n - 1, first]);
        }
    }

    fn finish(mut self) -> Preview {
        if let Some(first) = self.places.first() {
            let grow = |[low, high]: [DVec3; 2], p: &DVec3| [low.min(*p), high.max(*p)];
            self.out.bounds = self.places.iter().fold([*first, *first], grow);
            self.out.origin = (self.out.bounds[0] + self.out.bounds[1]) / 2.0;
        }
        let origin = self.out.origin;
        self.out.positions = self.places.iter().map(|p| (*p - origin).as_vec3().to_array()).collect();
        self.out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use tenon_geometry::panel::{ThickenParams, thicken};

    fn grid() -> Mesh {
        let points = [[0.0, 0.0], [2.0, 0.0], [4.0, 0.0], [0.0, 1.0], [2.0, 1.0], [4.0, 1.0]];
        let far = DVec3::new(1e7, 0.0, 0.0);
        let points = points.map(|[x, y]| far + 100.0 * DVec3::new(x, y, 0.0)).to_vec();
        Mesh::from_faces(points, &[[0, 1, 4, 3], [1, 2, 5, 4]])
    }

    /// Volume within the triangles, mm³: only if they close and face outwards it is that of the solid.
    fn volume(p: &Preview, part: u32) -> f64 {
        let mine = p.triangles.iter().filter(|t| p.vertex_parts[t[0] as usize] == part);
        let at = |v: u32| DVec3::from(p.positions[v as usize].map(f64::from));
        mine.map(|&[a, b, c]| at(a).dot(at(b).cross(at(c)))).sum::<f64>() / 6.0
    }

    #[test]
    fn panels_become_closed_triangles_that_know_their_panel() {
        let (panels, _) = thicken(&grid(), &ThickenParams::new(10.0)).unwrap();
        let p = preview(&Tree::item(V::new(panels.clone())));
        assert_eq!(p.parts.len(), 2);
        assert_eq!((p.parts[1].item, p.parts[1].element), (0, 1));
        for i in 0..2 {
            // Positions are single, a millionth of the panel's size.
            assert!((volume(&p, i) - panels.volume(i as usize)).abs() < 1.0, "{}", volume(&p, i));
        }
        assert!((p.origin.x - 1e7 - 200.0).abs() < 1e-6);
        assert_eq!((p.positions.len(), p.normals.len()), (p.vertex_parts.len(), p.vertex_parts.len()));
        assert_eq!(p.lines.len(), 2 * 12);
    }

    #[test]
    fn curves_points_and_gaps_keep_their_places() {
        let curve = Curve::polyline([DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p.extend(1.0)).to_vec(), false).unwrap();
        let p = preview(&Tree::column(Column::with_gaps(vec![None, Some(V::new(curve))])));
        assert_eq!((p.lines.len(), p.parts[0].item), (2, 1));
        let p = preview(&Tree::list(vec![Point(DVec3::X), Point(DVec3::Y)]));
        assert_eq!((p.points.as_slice(), p.parts.len()), (&[0, 1][..], 2));
        assert!(preview(&Tree::item(3.0)).positions.is_empty());
    }
}
