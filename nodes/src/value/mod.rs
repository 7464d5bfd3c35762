//! The value types that the built-in nodes put on wires.
//!
//! The engine's [`Item`] is implemented for [`V<T>`] once, for every geometry type that is [`Carried`]: a type's name,
//! digest, size and documented JSON stand in its own file here.

mod board;
mod curve;
mod feature;
mod machine;
mod mesh;
mod panel;
mod path;
mod point;
mod polygon;
mod program;
mod proof;
mod table;

pub use curve::SegmentNames;
pub(crate) use panel::with_address;
pub use point::{Plane, Point, Vector};
pub use program::{Program, Standing};
pub use table::Table;

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::json;
use std::ops::Deref;
use std::sync::Arc;
use tenon_engine::{Digester, Item, Json, Registry, pack, unpack};
use tenon_geometry::DVec3;
use tenon_geometry::ifs::Curve;
use tenon_geometry::polygon::Polygon;

/// A shared value on a wire; cloning it is free.
#[derive(Debug, Default)]
pub struct V<T>(pub Arc<T>);

impl<T> V<T> {
    /// Puts `value` on a wire.
    pub fn new(value: T) -> Self {
        Self(Arc::new(value))
    }
}

impl<T> Clone for V<T> {
    fn clone(&self) -> Self {
        Self(Arc::clone(&self.0))
    }
}

impl<T> Deref for V<T> {
    type Target = T;
    fn deref(&self) -> &T {
        &self.0
    }
}

/// What the engine must know of a type that wires carry.
pub trait Carried: Default + Serialize + DeserializeOwned + Send + Sync + 'static {
    /// Name of the type in files, docs and errors.
    const TYPE: &'static str;
    /// Version of its bytes in a cache; to be raised when its fields, or those of what it holds, become others.
    const FORMAT: u32 = 1;
    /// Feeds everything that makes two values differ.
    fn digest(&self, d: &mut Digester);
    /// Memory held besides the value itself, bytes.
    fn heap_bytes(&self) -> usize;
    /// The documented JSON of the type.
    fn to_json(&self) -> Json;
    /// Reads a literal; most types have none.
    fn from_json(_json: &Json) -> Result<Self, String> {
        Err(format!("a {} cannot be written in the file; wire one to this port", Self::TYPE))
    }
    /// One line for people.
    fn summary(&self) -> String;
    /// As [`Item::encode`].
    fn encode(&self, out: &mut Vec<u8>) -> bool {
        pack(self, out)
    }
    /// As [`Item::decode`].
    fn decode(bytes: &mut &[u8]) -> Option<Self> {
        unpack(bytes)
    }
}

impl<T: Carried> Item for V<T> {
    const TYPE: &'static str = T::TYPE;
    const FORMAT: u32 = T::FORMAT;
    fn digest(&self, d: &mut Digester) {
        self.0.digest(d);
    }
    fn heap_bytes(&self) -> usize {
        size_of::<T>() + self.0.heap_bytes()
    }
    fn to_json(&self) -> Json {
        self.0.to_json()
    }
    fn from_json(json: &Json) -> Result<Self, String> {
        T::from_json(json).map(Self::new)
    }
    fn summary(&self) -> String {
        self.0.summary()
    }
    fn encode(&self, out: &mut Vec<u8>) -> bool {
        self.0.encode(out)
    }
    fn decode(bytes: &mut &[u8]) -> Option<Self> {
        T::decode(bytes).map(Self::new)
    }
}

/// Makes every value type and every implicit conversion known.
pub fn register(registry: &mut Registry) {
    registry.register_type::<Point>();
    registry.register_type::<Vector>();
    registry.register_type::<Plane>();
    registry.register_type::<V<Curve>>();
    registry.register_type::<V<SegmentNames>>();
    registry.register_type::<V<Polygon>>();
    registry.register_type::<V<tenon_geometry::mesh::Mesh>>();
    registry.register_type::<V<tenon_geometry::panel::PanelSet>>();
    registry.register_type::<V<tenon_geometry::joint::FeatureSet>>();
    registry.register_type::<V<tenon_geometry::board::PartSet>>();
    registry.register_type::<V<tenon_geometry::board::Layout>>();
    registry.register_type::<V<tenon_geometry::motion::PathParams>>();
    registry.register_type::<V<tenon_geometry::motion::PartPaths>>();
    registry.register_type::<V<crate::post::MachineFile>>();
    registry.register_type::<Program>();
    registry.register_type::<Table>();
    registry.register_type::<V<tenon_geometry::proof::ProofReport>>();
    registry.register_conversion::<Point, Vector>(|p| Ok(Vector(p.0)));
    registry.register_conversion::<Vector, Point>(|v| Ok(Point(v.0)));
    registry.register_conversion::<V<Curve>, V<Polygon>>(|curve| {
        Polygon::of_curve(curve).map(V::new).map_err(|e| e.to_string())
    });
}

/// `[x, y, z]`, mm.
pub(crate) fn xyz(p: DVec3) -> Json {
    json!([p.x, p.y, p.z])
}

/// Feeds points to a digest.
pub(crate) fn digest_points(d: &mut Digester, points: &[DVec3]) {
    d.u64(points.len() as u64);
    // By blocks: a digest takes many bytes at once far faster than few at a time.
    let mut block = [0.0; 192];
    for points in points.chunks(64) {
        for (c, p) in block.chunks_exact_mut(3).zip(points) {
            p.write_to_slice(c);
        }
        d.f64s(&block[..3 * points.len()]);
    }
}
