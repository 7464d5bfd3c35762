//! Oriented planes.

use glam::DVec3;
use serde::{Deserialize, Serialize};

/// An oriented plane `normal · x = offset`; `normal` is a unit vector.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Plane {
    /// Unit normal.
    pub normal: DVec3,
    /// Signed distance of the origin's foot point along the normal, mm.
    pub offset: f64,
}

impl Plane {
    /// The plane through `point` with unit normal `normal`.
    #[must_use]
    pub fn through(point: DVec3, normal: DVec3) -> Self {
        Self { normal, offset: normal.dot(point) }
    }

    /// Signed distance of `point`, positive on the normal's side, mm.
    #[must_use]
    pub fn distance(&self, point: DVec3) -> f64 {
        self.normal.dot(point) - self.offset
    }

    /// The point of the plane nearest to `point`.
    #[must_use]
    pub fn project(&self, point: DVec3) -> DVec3 {
        point - self.normal * self.distance(point)
    }
}
