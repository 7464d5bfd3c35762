//! The transformation scheme of a projected IFS (000 §3.3.4, §4.1): columns, ties between subdivision points, germ.
//!
//! Subdivision point `i · m + a` is the image of control point `a` under transformation `i`; its column holds its
//! barycentric coordinates with regard to the control points. Every point has a tie, which is why continuity is part
//! of the scheme and outlives every edit (000 §5.2).

use super::error::SchemeError;
use glam::DVec4;

/// What a subdivision point is bound to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tie {
    /// It is this control point (`s1 = p1`) and stays it.
    Control(u32),
    /// All points of a class have the same column, each moved down by its `shift`: points of one class and one shift
    /// coincide, and points of different shift repeat one mask along the control points (uniform splines, where
    /// neighbouring polygons share more than one point at every level).
    Class {
        /// Number of the class.
        class: u32,
        /// Rows by which the class's column is moved down.
        shift: u32,
    },
}

/// The rows of a class's column (at shift 0) that may differ from zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Window {
    pub(crate) start: u32,
    pub(crate) len: u32,
}

/// Control points (how many), transformations (as columns), ties and germ of an iterated figure. It knows no
/// coordinates: moving a control point changes nothing here.
#[derive(Clone, Debug, PartialEq)]
pub struct Scheme {
    pub(crate) m: usize,
    pub(crate) columns: Vec<f64>,
    pub(crate) ties: Vec<Tie>,
    pub(crate) windows: Vec<Window>,
    pub(crate) germ: Vec<f64>,
}

impl Scheme {
    /// A scheme of `m` control points and given transformations: `columns` holds k·m columns of `m` entries, one after
    /// the other, T1 first. The germ is the segment from p1 to pm, all subdivision points are free and untied.
    ///
    /// # Errors
    /// [`SchemeError`] when `m < 2`, the number of entries is no positive multiple of m², or one is not finite.
    pub fn custom(m: usize, columns: Vec<f64>) -> Result<Self, SchemeError> {
        if m < 2 {
            return Err(SchemeError::TooFewControlPoints { given: m });
        }
        if columns.is_empty() || !columns.len().is_multiple_of(m * m) {
            return Err(SchemeError::ColumnCount { given: columns.len(), m });
        }
        if let Some(at) = columns.iter().position(|v| !v.is_finite()) {
            return Err(SchemeError::ColumnNotFinite { point: at / m, row: at % m, value: columns[at] });
        }
        let points = columns.len() / m;
        let mut germ = unit(m, 0);
        germ.extend(unit(m, m - 1));
        Ok(Self {
            m,
            columns,
            ties: (0..points as u32).map(|class| Tie::Class { class, shift: 0 }).collect(),
            windows: vec![Window { start: 0, len: m as u32 }; points],
            germ,
        })
    }

    /// The same scheme with another germ: a polyline given by columns of barycentric coordinates (000 §3.3.3), two at
    /// least, one after the other.
    ///
    /// # Errors
    /// [`SchemeError::GermCount`], [`SchemeError::GermNotFinite`].
    pub fn with_germ(mut self, germ: Vec<f64>) -> Result<Self, SchemeError> {
        let m = self.m;
        if germ.len() < 2 * m || !germ.len().is_multiple_of(m) {
            return Err(SchemeError::GermCount { given: germ.len(), m });
        }
        if let Some(at) = germ.iter().position(|v| !v.is_finite()) {
            return Err(SchemeError::GermNotFinite { column: at / m, row: at % m, value: germ[at] });
        }
        self.germ = germ;
        Ok(self)
    }

    /// The same scheme with `points` tied together: from now on they move as one. Their columns must agree already, up
    /// to rounding; those of the first point are taken.
    ///
    /// # Errors
    /// [`SchemeError::NoSuchPoint`], [`SchemeError::ColumnsDiffer`] (also when a point is bound already).
    pub fn tie(mut self, points: &[usize]) -> Result<Self, SchemeError> {
        for &p in points {
            self.check_point(p)?;
        }
        let Some((&first, rest)) = points.split_first() else { return Ok(self) };
        for &p in rest {
            let difference =
                self.column(first).iter().zip(self.column(p)).fold(0.0_f64, |d, (a, b)| d.max((a - b).abs()));
            let largest = self.column(first).iter().fold(1.0_f64, |d, a| d.max(a.abs()));
            if difference > 16.0 * f64::EPSILON * largest {
                return Err(SchemeError::ColumnsDiffer { a: first, b: p, difference });
            }
            self.columns.copy_within(first * self.m..(first + 1) * self.m, p * self.m);
            self.ties[p] = self.ties[first];
        }
        Ok(self)
    }

    /// The same scheme with subdivision point `point` bound to control point `control` (`s1 = p1`), which its column
    /// must say already.
    ///
    /// # Errors
    /// [`SchemeError::NoSuchPoint`], [`SchemeError::NoSuchControl`], [`SchemeError::NotTheControl`].
    pub fn fix(mut self, point: usize, control: usize) -> Result<Self, SchemeError> {
        self.check_point(point)?;
        if control >= self.m {
            return Err(SchemeError::NoSuchControl { control, count: self.m });
        }
        if self.column(point) != unit(self.m, control) {
            return Err(SchemeError::NotTheControl { point, control });
        }
        self.ties[point] = Tie::Control(control as u32);
        Ok(self)
    }

    /// The same scheme with `point` freed from every tie, so that it can be moved alone. Continuity may be lost by it.
    ///
    /// # Errors
    /// [`SchemeError::NoSuchPoint`].
    pub fn release(mut self, point: usize) -> Result<Self, SchemeError> {
        self.check_point(point)?;
        self.ties[point] = Tie::Class { class: self.windows.len() as u32, shift: 0 };
        self.windows.push(Window { start: 0, len: self.m as u32 });
        Ok(self)
    }

    pub(crate) fn check_point(&self, point: usize) -> Result<(), SchemeError> {
        let count = self.ties.len();
        if point < count { Ok(()) } else { Err(SchemeError::NoSuchPoint { point, count }) }
    }

    /// Number of control points, m.
    #[must_use]
    pub fn control_count(&self) -> usize {
        self.m
    }

    /// Number of transformations, k.
    #[must_use]
    pub fn transformation_count(&self) -> usize {
        self.ties.len() / self.m
    }

    /// Number of segments of the germ.
    #[must_use]
    pub fn germ_segments(&self) -> usize {
        self.germ.len() / self.m - 1
    }

    /// The germ's columns, one after the other.
    #[must_use]
    pub fn germ(&self) -> &[f64] {
        &self.germ
    }

    /// All columns, k·m of m entries each, T1 first.
    #[must_use]
    pub fn columns(&self) -> &[f64] {
        &self.columns
    }

    /// Ties of all subdivision points.
    #[must_use]
    pub fn ties(&self) -> &[Tie] {
        &self.ties
    }

    /// Column of subdivision point `point` (its number is below k·m).
    pub(crate) fn column(&self, point: usize) -> &[f64] {
        &self.columns[point * self.m..(point + 1) * self.m]
    }

    /// The m columns of transformation `i`.
    pub(crate) fn transformation(&self, i: usize) -> &[f64] {
        &self.columns[i * self.m * self.m..(i + 1) * self.m * self.m]
    }

    /// The subdivision points `S = P · C` of the given control points, homogeneous (WX, WY, WZ, W); k·m of them.
    ///
    /// # Errors
    /// [`SchemeError::ControlCount`].
    pub fn subdivision_points(&self, control: &[DVec4]) -> Result<Vec<DVec4>, SchemeError> {
        if control.len() != self.m {
            return Err(SchemeError::ControlCount { given: control.len(), needed: self.m });
        }
        Ok(self.columns.chunks_exact(self.m).map(|c| combine(control, c)).collect())
    }
}

/// Unit column `e_j`.
pub(crate) fn unit(m: usize, j: usize) -> Vec<f64> {
    let mut column = vec![0.0; m];
    column[j] = 1.0;
    column
}

/// The point of `polygon` with barycentric coordinates `column`.
#[inline]
pub(crate) fn combine(polygon: &[DVec4], column: &[f64]) -> DVec4 {
    polygon.iter().zip(column).fold(DVec4::ZERO, |sum, (p, &c)| sum + *p * c)
}
