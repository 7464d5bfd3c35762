//! What can be wrong with a transformation scheme or with the curve that it draws, with the data to put it right.
//!
//! Indices in the data count from 0; the words for people count from 1, as the thesis does (p1, s1, T1).

use super::curve::Word;
use glam::DVec3;
use thiserror::Error;

/// A scheme that cannot be made, or a subdivision point that cannot go where it is sent.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SchemeError {
    /// A Bézier degree outside 1 ..= `largest`.
    #[error("a Bézier curve of degree {given} cannot be drawn: the degree must lie between 1 and {largest}")]
    Degree {
        /// The degree asked for.
        given: u32,
        /// The largest that works.
        largest: u32,
    },
    /// Fewer than two control points.
    #[error("a scheme needs at least 2 control points, not {given}")]
    TooFewControlPoints {
        /// The number of control points.
        given: usize,
    },
    /// The column table is no whole number of m × m matrices, or empty.
    #[error("{given} column entries are no whole number of {m}×{m} transformations")]
    ColumnCount {
        /// Entries given.
        given: usize,
        /// Number of control points.
        m: usize,
    },
    /// The germ is no list of at least two columns of m entries.
    #[error("a germ needs at least 2 columns of {m} entries; {given} entries were given")]
    GermCount {
        /// Entries given.
        given: usize,
        /// Number of control points.
        m: usize,
    },
    /// A column entry is NaN or infinite.
    #[error("entry {} of subdivision column s{} is {value}", .row + 1, .point + 1)]
    ColumnNotFinite {
        /// Subdivision point.
        point: usize,
        /// Row in its column.
        row: usize,
        /// The value.
        value: f64,
    },
    /// A germ entry is NaN or infinite.
    #[error("entry {} of germ column {} is {value}", .row + 1, .column + 1)]
    GermNotFinite {
        /// Germ column.
        column: usize,
        /// Row in it.
        row: usize,
        /// The value.
        value: f64,
    },
    /// There is no such subdivision point.
    #[error("there is no subdivision point s{}: the scheme has {count}", .point + 1)]
    NoSuchPoint {
        /// The one asked for.
        point: usize,
        /// How many there are.
        count: usize,
    },
    /// There is no such control point.
    #[error("there is no control point p{}: the scheme has {count}", .control + 1)]
    NoSuchControl {
        /// The one asked for.
        control: usize,
        /// How many there are.
        count: usize,
    },
    /// Two points cannot be tied because their columns differ.
    #[error("s{} and s{} cannot be tied: their columns differ by {difference}", .a + 1, .b + 1)]
    ColumnsDiffer {
        /// First subdivision point.
        a: usize,
        /// Second subdivision point.
        b: usize,
        /// Largest difference of an entry.
        difference: f64,
    },
    /// A point cannot be bound to a control point that it is not.
    #[error("s{} cannot be bound to p{}: its column is not the one of p{}", .point + 1, .control + 1, .control + 1)]
    NotTheControl {
        /// Subdivision point.
        point: usize,
        /// Control point.
        control: usize,
    },
    /// A subdivision point that is a control point was sent elsewhere.
    #[error("s{} is the control point p{} in this scheme and cannot leave it (it was sent {distance} mm away): move p{}, or release s{}",
        .point + 1, .control + 1, .control + 1, .point + 1)]
    Fixed {
        /// Subdivision point.
        point: usize,
        /// The control point that it is.
        control: usize,
        /// How far away it was sent, mm.
        distance: f64,
    },
    /// Two tied subdivision points were sent to different places.
    #[error("s{} and s{} are tied, but were sent to places {distance} mm apart", .a + 1, .b + 1)]
    TiedApart {
        /// The point that was moved first.
        a: usize,
        /// The tied point.
        b: usize,
        /// Distance between the place it was sent to and the one its tie gives, mm.
        distance: f64,
    },
    /// No column reaches the place.
    #[error("s{} cannot be reached: the control points span no place nearer than {residual} mm, at ({}, {}, {})",
        .point + 1, .nearest.x, .nearest.y, .nearest.z)]
    Unreachable {
        /// Subdivision point.
        point: usize,
        /// Distance of the nearest reachable place, mm.
        residual: f64,
        /// The nearest reachable place.
        nearest: DVec3,
    },
    /// The number of control points does not fit the scheme.
    #[error("the scheme has {needed} control points, {given} were given")]
    ControlCount {
        /// Number given.
        given: usize,
        /// Number of the scheme.
        needed: usize,
    },
    /// A control point is NaN or infinite.
    #[error("control point p{} has a coordinate or weight that is not finite", .control + 1)]
    ControlNotFinite {
        /// Control point.
        control: usize,
    },
    /// A subdivision point's position or weight is NaN or infinite.
    #[error("subdivision point s{} has a coordinate or weight that is not finite", .point + 1)]
    PointNotFinite {
        /// Subdivision point.
        point: usize,
    },
    /// A subdivision point's weight is not positive.
    #[error("subdivision point s{} has the weight {weight}; it must be greater than 0", .point + 1)]
    PointWeight {
        /// Subdivision point.
        point: usize,
        /// Its weight.
        weight: f64,
    },
}

/// A curve that cannot be drawn.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum CurveError {
    /// No control points at all.
    #[error("the curve has no control points")]
    Empty,
    /// Too few points for a polyline.
    #[error("a {} needs at least {needed} points, {given} were given", if *closed { "closed curve" } else { "curve" })]
    TooFewPoints {
        /// Number of points.
        given: usize,
        /// Least number.
        needed: usize,
        /// Whether it is closed.
        closed: bool,
    },
    /// Strips that do not divide the points, or a closed curve of several.
    #[error("{points} points cannot be {} of {strips} strips", if *closed { "a closed curve" } else { "a curve" })]
    Strips {
        /// Number of strips.
        strips: usize,
        /// Number of points.
        points: usize,
        /// Whether it is closed.
        closed: bool,
    },
    /// All control points lie in one place, within the tolerance.
    #[error("all control points lie in one place: the curve is a point")]
    OnePoint,
    /// A patch has a number of control points that is not the scheme's.
    #[error("patch {} has {given} control points; the scheme needs {needed}", .patch + 1)]
    ControlCount {
        /// Patch.
        patch: usize,
        /// Number given.
        given: usize,
        /// Number of the scheme.
        needed: usize,
    },
    /// A list of control points cannot be divided into patches.
    #[error(
        "{given} control points make no whole number of patches of {m} points that share {shared}; {fitting} would"
    )]
    NoWholePatches {
        /// Number given.
        given: usize,
        /// Control points per patch.
        m: usize,
        /// Points that neighbours share.
        shared: usize,
        /// The next larger number that works.
        fitting: usize,
    },
    /// Neighbouring patches must share fewer points than they have.
    #[error("patches of {m} control points cannot share {shared}: at most {}", m - 1)]
    Shared {
        /// Control points per patch.
        m: usize,
        /// Points asked to be shared.
        shared: usize,
    },
    /// A coordinate or weight is NaN or infinite.
    #[error("control point p{} of patch {} has a coordinate or weight that is not finite", .control + 1, .patch + 1)]
    NotFinite {
        /// Patch.
        patch: usize,
        /// Control point.
        control: usize,
    },
    /// The weights of a patch sum to nothing or less.
    #[error("the weights of patch {} sum to {sum}; they must sum to more than 0", .patch + 1)]
    WeightSum {
        /// Patch.
        patch: usize,
        /// The sum.
        sum: f64,
    },
    /// A point of the figure has no place in space.
    #[error(
        "the curve's point on element {word} has the weight {weight}: it lies at infinity or beyond; raise the weights near it"
    )]
    Weight {
        /// The element.
        word: Word,
        /// Weight of the point.
        weight: f64,
    },
    /// A coordinate of the figure grew out of the range of numbers.
    #[error(
        "the curve's point on element {word} runs out of the range of numbers; the transformations do not contract"
    )]
    Overflow {
        /// The element.
        word: Word,
    },
    /// A patch does not start where the one before it ends.
    #[error("patch {} starts {gap} mm away from the end of patch {} (tolerance {tolerance} mm)", .patch + 1, .patch)]
    Gap {
        /// The later patch.
        patch: usize,
        /// Distance, mm.
        gap: f64,
        /// Tolerance, mm.
        tolerance: f64,
    },
    /// Two patches meet with different weights.
    #[error("patch {} starts with the weight {start} where patch {} ends with {end}; make them equal", .patch + 1, .patch)]
    WeightJump {
        /// The later patch.
        patch: usize,
        /// Weight at the end of the patch before.
        end: f64,
        /// Weight at its start.
        start: f64,
    },
    /// More segments than a curve may have.
    #[error("{iterations} iterations give more than {limit} segments; {largest} is the most for this curve")]
    TooManySegments {
        /// Iterations asked for.
        iterations: u32,
        /// Largest number of segments.
        limit: usize,
        /// Most iterations that work.
        largest: u32,
    },
    /// A tolerance that is NaN, infinite or negative.
    #[error("the tolerance is {tolerance} mm; it must be finite and not negative")]
    Tolerance {
        /// The tolerance, mm.
        tolerance: f64,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}
