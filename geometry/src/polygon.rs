//! Polygons: closed lines of straight edges in space, as outlines of faces, panels and boards are. What a closed curve
//! comes down to.

use crate::ifs::Curve;
use crate::plane::Plane;
use glam::DVec3;
use serde::{Deserialize, Serialize};

/// A closed line of at least three corners that encloses an area. The last corner is joined to the first one, which is
/// not repeated, and no corner is where the one before it is. Its corners need not lie in one plane: see
/// [`Polygon::flatness`].
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Polygon {
    corners: Vec<DVec3>,
}

/// Why something is no polygon.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PolygonError {
    /// The curve has ends.
    #[error("the curve is open: its ends are {gap:.3} mm apart; a polygon needs a closed curve")]
    Open {
        /// Distance between first and last point, mm.
        gap: f64,
    },
    /// The curve consists of several pieces.
    #[error("the curve is in {count} pieces; a polygon is one closed line")]
    Pieces {
        /// Number of strips.
        count: usize,
    },
    /// Too few different corners.
    #[error("{count} different corners; a polygon has at least 3")]
    TooFewCorners {
        /// How many there are.
        count: usize,
    },
    /// A coordinate is not a number.
    #[error("corner {corner} is not at a finite place")]
    NotFinite {
        /// Its index.
        corner: usize,
    },
    /// It encloses nothing.
    #[error("the corners enclose no area: they lie on a line, or the halves of a figure eight cancel each other")]
    NoArea,
}

/// An area below this times the squared circumference is none: rounding of that many digits makes it.
const ROUNDING: f64 = 1e-14;

impl Polygon {
    /// The polygon of these corners; corners that repeat the one before are dropped. O(corners).
    ///
    /// # Errors
    /// [`PolygonError`] except `Open` and `Pieces`.
    pub fn new(corners: Vec<DVec3>) -> Result<Self, PolygonError> {
        if let Some(corner) = corners.iter().position(|p| !p.is_finite()) {
            return Err(PolygonError::NotFinite { corner });
        }
        let mut corners = corners;
        corners.dedup();
        while corners.len() > 1 && corners.first() == corners.last() {
            corners.pop();
        }
        if corners.len() < 3 {
            return Err(PolygonError::TooFewCorners { count: corners.len() });
        }
        let polygon = Self { corners };
        let (area, length) = (polygon.area_vector().length(), polygon.circumference());
        // Negated, so that an overflow to NaN is refused as well.
        if !(area > ROUNDING * length * length && area.is_finite()) {
            return Err(PolygonError::NoArea);
        }
        Ok(polygon)
    }

    /// The polygon of a closed curve's points. O(points).
    ///
    /// # Errors
    /// [`PolygonError`], also where the curve is open or in pieces.
    pub fn of_curve(curve: &Curve) -> Result<Self, PolygonError> {
        let points = curve.projected();
        if curve.strip_count() > 1 {
            return Err(PolygonError::Pieces { count: curve.strip_count() });
        }
        if !curve.closed {
            let gap = points.first().zip(points.last()).map_or(0.0, |(a, b)| a.distance(*b));
            return Err(PolygonError::Open { gap });
        }
        Self::new(points)
    }

    /// The corners, mm.
    #[must_use]
    pub fn corners(&self) -> &[DVec3] {
        &self.corners
    }

    /// The edges, from corner to corner.
    pub fn edges(&self) -> impl Iterator<Item = (DVec3, DVec3)> {
        self.corners.iter().copied().zip(self.corners.iter().copied().cycle().skip(1))
    }

    /// Half the sum of the cross products of its edges: its length is the area of the shadow along it, mm², its direction
    /// the normal by the right-hand rule (Newell's method). Parts of a polygon that crosses itself count with the sign
    /// of their turn. O(corners).
    #[must_use]
    pub fn area_vector(&self) -> DVec3 {
        let Some(&from) = self.corners.first() else { return DVec3::ZERO };
        // From a corner of its own, so that a polygon far from the origin loses no digits.
        self.edges().map(|(a, b)| (a - from).cross(b - from)).sum::<DVec3>() * 0.5
    }

    /// Its area, mm²: of a polygon that is not flat, that of its shadow in its plane.
    #[must_use]
    pub fn area(&self) -> f64 {
        self.area_vector().length()
    }

    /// Length of all its edges, mm.
    #[must_use]
    pub fn circumference(&self) -> f64 {
        self.edges().map(|(a, b)| a.distance(b)).sum()
    }

    /// The point in which a plate of this outline balances, mm. O(corners).
    #[must_use]
    pub fn centroid(&self) -> DVec3 {
        let Some(&from) = self.corners.first() else { return DVec3::ZERO };
        let whole = self.area_vector();
        let weigh = |(a, b): (DVec3, DVec3)| {
            let (a, b) = (a - from, b - from);
            (a + b) * (0.5 * a.cross(b).dot(whole))
        };
        from + self.edges().map(weigh).sum::<DVec3>() / (3.0 * whole.length_squared())
    }

    /// The plane through the mean of its corners, square to its area.
    #[must_use]
    pub fn plane(&self) -> Plane {
        let mean = self.corners.iter().sum::<DVec3>() / self.corners.len().max(1) as f64;
        Plane::through(mean, self.area_vector().normalize_or_zero())
    }

    /// The greatest distance of a corner from [`Polygon::plane`], mm.
    #[must_use]
    pub fn flatness(&self) -> f64 {
        let plane = self.plane();
        self.corners.iter().map(|p| plane.distance(*p).abs()).fold(0.0, f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ifs::homogeneous;
    use glam::DAffine3;
    use proptest::prelude::*;

    fn of(corners: &[[f64; 3]]) -> Result<Polygon, PolygonError> {
        Polygon::new(corners.iter().map(|c| DVec3::from_array(*c)).collect())
    }

    #[test]
    fn an_angle_piece_far_away_has_its_textbook_figures() {
        // A square of 2 with its upper right quarter cut away: concave.
        let l = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [1.0, 1.0], [1.0, 2.0], [0.0, 2.0]];
        let far = l.map(|[x, y]| [x + 1e6, y - 1e6, 5.0]);
        let p = of(&far).unwrap();
        assert_eq!((p.area(), p.circumference(), p.flatness()), (3.0, 8.0, 0.0));
        assert!(p.centroid().distance(DVec3::new(1e6 + 5.0 / 6.0, -1e6 + 5.0 / 6.0, 5.0)) < 1e-8);
        assert_eq!(p.plane().normal, DVec3::Z);
    }

    #[test]
    fn what_encloses_nothing_is_refused() {
        assert_eq!(of(&[[0.0; 3], [1.0; 3], [1.0; 3], [0.0; 3]]), Err(PolygonError::TooFewCorners { count: 2 }));
        assert_eq!(of(&[[0.0; 3], [1.0; 3], [3.0; 3]]), Err(PolygonError::NoArea));
        let eight = [[0.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        assert_eq!(of(&eight), Err(PolygonError::NoArea));
        assert_eq!(of(&[[0.0; 3], [1.0, 0.0, 0.0], [0.0, f64::NAN, 0.0]]), Err(PolygonError::NotFinite { corner: 2 }));
        assert_eq!(
            of(&[[0.0; 3], [1e300, 0.0, 0.0], [0.0, 1e300, 0.0]]),
            Err(PolygonError::NoArea),
            "an area beyond all numbers is no area"
        );
    }

    #[test]
    fn only_a_closed_curve_of_one_piece_is_a_polygon() {
        let points: Vec<_> =
            [[0.0, 0.0, 0.0], [3.0, 0.0, 0.0], [3.0, 4.0, 0.0]].map(|p| homogeneous(p.into(), 2.0)).to_vec();
        let open = Curve::polyline(points.clone(), false).unwrap();
        assert_eq!(Polygon::of_curve(&open), Err(PolygonError::Open { gap: 5.0 }));
        let closed = Curve::polyline(points, true).unwrap();
        assert_eq!(Polygon::of_curve(&closed).unwrap().area(), 6.0);
        let pieces = Curve { strip_start: vec![0, 1, 3].into(), ..closed };
        assert_eq!(Polygon::of_curve(&pieces), Err(PolygonError::Pieces { count: 2 }));
    }

    proptest! {
        /// Moving a polygon moves its centroid and plane and keeps its measures, wherever it begins.
        #[test]
        fn a_rigid_motion_moves_what_it_should(
            radii in prop::collection::vec(1.0..100.0f64, 3..12),
            turn in -3.0..3.0f64,
            shift in prop::array::uniform3(-1e3..1e3f64),
            first in 0..3usize,
        ) {
            let n = radii.len() as f64;
            let around = |k: usize, r: f64| DVec3::from((r * glam::DVec2::from_angle(k as f64 / n * std::f64::consts::TAU), 0.0));
            let corners: Vec<DVec3> = radii.iter().enumerate().map(|(k, r)| around(k, *r)).collect();
            let before = Polygon::new(corners.clone()).unwrap();
            let motion = DAffine3::from_translation(shift.into()) * DAffine3::from_axis_angle(DVec3::new(1.0, 2.0, 2.0) / 3.0, turn);
            let mut moved: Vec<DVec3> = corners.iter().map(|p| motion.transform_point3(*p)).collect();
            moved.rotate_left(first);
            let after = Polygon::new(moved).unwrap();
            prop_assert!((after.area() - before.area()).abs() < 1e-9 * before.area());
            prop_assert!((after.circumference() - before.circumference()).abs() < 1e-9 * before.circumference());
            prop_assert!(after.centroid().distance(motion.transform_point3(before.centroid())) < 1e-8);
            prop_assert!(after.flatness() < 1e-9);
        }
    }
}
