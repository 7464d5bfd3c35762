//! Meshes. JSON `{ "points": [[x, y, z]…], "faces": [[vertex…]…], "addresses": ["row.column"…] }`.

use super::{Carried, digest_points, point::read_xyz, xyz};
use serde_json::json;
use tenon_engine::{Digester, Json};
use tenon_geometry::mesh::{Address, Mesh};

pub(crate) fn digest_addresses(d: &mut Digester, addresses: &[Address]) {
    d.u64(addresses.len() as u64);
    for a in addresses {
        d.u32(a.patch);
        d.u32(a.row);
        d.u32(a.column);
    }
}

impl Carried for Mesh {
    const TYPE: &'static str = "mesh";
    fn digest(&self, d: &mut Digester) {
        digest_points(d, &self.points);
        d.u64(self.face_start.len() as u64);
        self.face_start.iter().for_each(|i| d.u32(*i));
        self.face_vertices.iter().for_each(|i| d.u32(*i));
        digest_addresses(d, &self.addresses);
    }
    fn heap_bytes(&self) -> usize {
        self.points.len() * 24 + (self.face_start.len() + self.face_vertices.len()) * 4 + self.addresses.len() * 12
    }
    fn to_json(&self) -> Json {
        json!({
            "points": self.points.iter().map(|p| xyz(*p)).collect::<Vec<_>>(),
            "faces": (0..self.face_count()).map(|f| self.face(f)).collect::<Vec<_>>(),
            "addresses": self.addresses.iter().map(ToString::to_string).collect::<Vec<_>>(),
        })
    }
    fn from_json(json: &Json) -> Result<Self, String> {
        let list = |key: &str| {
            json.get(key)
                .and_then(Json::as_array)
                .ok_or_else(|| format!("a mesh is {{\"points\": [[x, y, z]…], \"faces\": [[vertex…]…]}}; no {key}"))
        };
        let points = list("points")?.iter().map(read_xyz).collect::<Result<Vec<_>, _>>()?;
        let mut mesh = Self { points: points.into(), face_start: vec![0].into(), ..Self::default() };
        for (f, face) in list("faces")?.iter().enumerate() {
            for v in face.as_array().ok_or_else(|| format!("face {f} is not a list of vertex numbers"))? {
                let v = v.as_u64().filter(|v| (*v as usize) < mesh.points.len());
                mesh.face_vertices
                    .to_mut()
                    .push(v.ok_or_else(|| format!("face {f} names a vertex that does not exist"))? as u32);
            }
            mesh.face_start.to_mut().push(mesh.face_vertices.len() as u32);
        }
        Ok(mesh)
    }
    fn summary(&self) -> String {
        format!("{} faces, {} vertices", self.face_count(), self.points.len())
    }
}
