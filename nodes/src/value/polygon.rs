//! Polygons. JSON `{ "corners": [[x, y, z]…] }`.

use super::{Carried, digest_points, point::read_xyz, xyz};
use serde_json::json;
use tenon_engine::{Digester, Json};
use tenon_geometry::polygon::Polygon;

impl Carried for Polygon {
    const TYPE: &'static str = "polygon";
    fn digest(&self, d: &mut Digester) {
        digest_points(d, self.corners());
    }
    fn heap_bytes(&self) -> usize {
        size_of_val(self.corners())
    }
    fn to_json(&self) -> Json {
        json!({ "corners": self.corners().iter().map(|p| xyz(*p)).collect::<Vec<_>>() })
    }
    fn from_json(json: &Json) -> Result<Self, String> {
        let corners = json.get("corners").and_then(Json::as_array);
        let corners = corners.ok_or("a polygon is {\"corners\": [[x, y, z]…]}")?;
        Self::new(corners.iter().map(read_xyz).collect::<Result<_, _>>()?).map_err(|e| e.to_string())
    }
    fn summary(&self) -> String {
        format!("polygon of {} corners, {:.3} mm² in {:.3} mm", self.corners().len(), self.area(), self.circumference())
    }
}
