//! What a frustum of a tool passes through on a short straight move: the convex hull of its discs at both ends.

use glam::DVec3;

/// A disc in space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Disc {
    pub center: DVec3,
    /// Unit normal.
    pub axis: DVec3,
    pub radius: f64,
}

/// The hull of a frustum at the start (discs 0, 1) and at the end (discs 2, 3) of a move, widened by `margin`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sweep {
    pub discs: [Disc; 4],
    /// How far the true sweep may leave the hull because the tool turns, mm; 0 on a straight move, whose hull is exact.
    pub margin: f64,
}

/// An axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aabb {
    pub min: DVec3,
    pub max: DVec3,
}

impl Aabb {
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    pub fn of(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |b, p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    pub fn grown(self, by: f64) -> Self {
        Self { min: self.min - DVec3::splat(by), max: self.max + DVec3::splat(by) }
    }

    pub fn meets(&self, other: &Self) -> bool {
        self.min.cmple(other.max).all() && other.min.cmple(self.max).all()
    }

    pub fn contains(&self, p: DVec3) -> bool {
        self.min.cmple(p).all() && p.cmple(self.max).all()
    }
}

impl Disc {
    /// Largest `x · m` over the disc.
    fn reach(&self, m: DVec3) -> f64 {
        let along = self.axis.dot(m);
        self.center.dot(m) + self.radius * (m.length_squared() - along * along).max(0.0).sqrt()
    }

    fn farthest(&self, m: DVec3) -> DVec3 {
        let side = m - self.axis * self.axis.dot(m);
        self.center + side.normalize_or_zero() * self.radius
    }

    /// Half extents along x, y, z.
    fn extent(&self) -> DVec3 {
        let a = self.axis;
        DVec3::new((1.0 - a.x * a.x).max(0.0), (1.0 - a.y * a.y).max(0.0), (1.0 - a.z * a.z).max(0.0)).map(f64::sqrt)
            * self.radius
    }

    /// Height of the lowest point.
    pub fn lowest(&self) -> f64 {
        self.center.z - self.extent().z
    }
}

impl Sweep {
    /// Largest `x · m` over the sweep: its support function.
    pub fn reach(&self, m: DVec3) -> f64 {
        let widest = self.discs.iter().map(|d| d.reach(m)).fold(f64::NEG_INFINITY, f64::max);
        if self.margin == 0.0 { widest } else { widest + self.margin * m.length() }
    }

    /// A point of the sweep where `x · m` is largest.
    pub fn farthest(&self, m: DVec3) -> DVec3 {
        let mut best = (f64::NEG_INFINITY, 0);
        for (k, d) in self.discs.iter().enumerate() {
            let reach = d.reach(m);
            if reach > best.0 {
                best = (reach, k);
            }
        }
        self.discs[best.1].farthest(m) + m.normalize_or_zero() * self.margin
    }

    pub fn lowest(&self) -> f64 {
        self.discs.iter().map(Disc::lowest).fold(f64::INFINITY, f64::min) - self.margin
    }

    pub fn aabb(&self) -> Aabb {
        let mut b = Aabb::EMPTY;
        for d in &self.discs {
            let e = d.extent();
            b = Aabb { min: b.min.min(d.center - e), max: b.max.max(d.center + e) };
        }
        b.grown(self.margin)
    }
}
