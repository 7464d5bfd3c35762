//! Points, vectors and planes.

use super::xyz;
use serde_json::json;
use tenon_engine::{Digester, Item, Json, pack, unpack};
use tenon_geometry::DVec3;

/// A point, mm. JSON `[x, y, z]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Point(pub DVec3);

/// A vector, mm where it is a length. JSON `[x, y, z]`.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Vector(pub DVec3);

/// An oriented plane. JSON `{ "origin": [x, y, z], "normal": [x, y, z] }`; a literal's normal may have any length.
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(transparent)]
pub struct Plane(pub tenon_geometry::Plane);

/// Reads `[x, y]` or `[x, y, z]` with finite numbers.
pub(crate) fn read_xyz(json: &Json) -> Result<DVec3, String> {
    let list = json.as_array().filter(|l| l.len() == 2 || l.len() == 3);
    let Some(list) = list else { return Err(format!("expected [x, y, z] in mm, found {json}")) };
    let mut c = [0.0; 3];
    for (slot, value) in c.iter_mut().zip(list) {
        *slot = value
            .as_f64()
            .filter(|x| x.is_finite())
            .ok_or_else(|| format!("expected three finite numbers [x, y, z] in mm, found {json}"))?;
    }
    Ok(DVec3::from_array(c))
}

fn digest_xyz(v: DVec3, d: &mut Digester) {
    d.f64(v.x);
    d.f64(v.y);
    d.f64(v.z);
}

/// Points and vectors differ in name and summary only.
macro_rules! coordinates {
    ($type:ident, $name:literal, $unit:literal) => {
        impl Item for $type {
            const TYPE: &'static str = $name;
            const FORMAT: u32 = 1;
            fn digest(&self, d: &mut Digester) {
                digest_xyz(self.0, d);
            }
            fn to_json(&self) -> Json {
                xyz(self.0)
            }
            fn from_json(json: &Json) -> Result<Self, String> {
                read_xyz(json).map(Self)
            }
            fn summary(&self) -> String {
                format!(concat!("({}, {}, {})", $unit), self.0.x, self.0.y, self.0.z)
            }
            fn encode(&self, out: &mut Vec<u8>) -> bool {
                pack(&self.0, out)
            }
            fn decode(bytes: &mut &[u8]) -> Option<Self> {
                unpack(bytes).map(Self)
            }
        }
    };
}

coordinates!(Point, "point", " mm");
coordinates!(Vector, "vector", "");

impl Item for Plane {
    const TYPE: &'static str = "plane";
    const FORMAT: u32 = 1;
    fn digest(&self, d: &mut Digester) {
        digest_xyz(self.0.normal, d);
        d.f64(self.0.offset);
    }
    fn to_json(&self) -> Json {
        json!({ "origin": xyz(self.0.normal * self.0.offset), "normal": xyz(self.0.normal) })
    }
    fn from_json(json: &Json) -> Result<Self, String> {
        let part = |key: &str| json.get(key).ok_or_else(|| format!("a plane is {{\"origin\", \"normal\"}}; no {key}"));
        let origin = read_xyz(part("origin")?)?;
        let normal = read_xyz(part("normal")?)?
            .try_normalize()
            .ok_or_else(|| "a plane's normal must not be the zero vector".to_string())?;
        Ok(Self(tenon_geometry::Plane::through(origin, normal)))
    }
    fn summary(&self) -> String {
        let n = self.0.normal;
        format!("plane with normal ({}, {}, {}) at {} mm", n.x, n.y, n.z, self.0.offset)
    }
    fn encode(&self, out: &mut Vec<u8>) -> bool {
        pack(&self.0, out)
    }
    fn decode(bytes: &mut &[u8]) -> Option<Self> {
        unpack(bytes).map(Self)
    }
}
