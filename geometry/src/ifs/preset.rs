//! The schemes that have a name: Bézier and B-spline curves and the classical figures of 000 §5.1–§5.3.

use super::error::SchemeError;
use super::scheme::{Scheme, Tie, Window, unit};

/// Largest degree of a Bézier scheme: up to it all binomial coefficients are exact.
pub const MAX_DEGREE: u32 = 50;

/// A scheme with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Bézier curve; degree + 1 control points (000 §4.1, §5.2.1, §5.2.4).
    Bezier {
        /// Degree, 1 ..= [`MAX_DEGREE`].
        degree: u32,
    },
    /// Uniform cubic B-spline; 4 control points, germ [p2, p3] (000 §5.2.4).
    CubicBSpline,
    /// Takagi curve through p1, p2, p3 (000 §5.2.3).
    Takagi,
    /// Von Koch curve through p1, p2, p3: the classical one when p2 stands √3/6 of the base above its middle. Two
    /// iterations make one step of the classical construction (000 §5.2.3).
    Koch,
    /// Lévy C curve through p1, p2, p3: the classical one on a right isosceles triangle (000 §5.2.3).
    Levy,
    /// Parabola through p1, p2, p3 (000 §5.2.3).
    Parabola,
    /// Dragon curve: as Lévy's, with the second transformation reversed (000 §5.3 d).
    Dragon,
    /// Cantor set of thirds between 2 control points (000 §5.1.1).
    Cantor,
}

impl Preset {
    /// Names under which graphs know the presets.
    pub const NAMES: [&'static str; 8] =
        ["bezier", "b-spline", "takagi", "koch", "levy", "parabola", "dragon", "cantor"];

    /// The preset of that name; `degree` is read for `bezier` only.
    #[must_use]
    pub fn from_name(name: &str, degree: u32) -> Option<Self> {
        Some(match name {
            "bezier" => Self::Bezier { degree },
            "b-spline" => Self::CubicBSpline,
            "takagi" => Self::Takagi,
            "koch" => Self::Koch,
            "levy" => Self::Levy,
            "parabola" => Self::Parabola,
            "dragon" => Self::Dragon,
            "cantor" => Self::Cantor,
            _ => return None,
        })
    }

    /// Number of control points of one patch.
    #[must_use]
    pub fn control_count(self) -> usize {
        match self {
            Self::Bezier { degree } => degree as usize + 1,
            Self::CubicBSpline => 4,
            Self::Cantor => 2,
            _ => 3,
        }
    }

    /// Number of control points that neighbouring patches share: see [`super::patches`].
    #[must_use]
    pub fn shared_count(self) -> usize {
        if self == Self::CubicBSpline { 3 } else { 1 }
    }
}

impl Scheme {
    /// The scheme of that name. O(m²).
    ///
    /// # Errors
    /// [`SchemeError::Degree`].
    pub fn preset(preset: Preset) -> Result<Self, SchemeError> {
        match preset {
            Preset::Bezier { degree } => bezier(degree),
            Preset::CubicBSpline => cubic_b_spline(),
            Preset::Takagi => through_three([0.25, 1.0, -0.25], [-0.25, 1.0, 0.25]),
            Preset::Koch => through_three([2.0 / 3.0, 0.0, 1.0 / 3.0], [1.0 / 3.0, 0.0, 2.0 / 3.0]),
            Preset::Levy => through_three([0.5, 1.0, -0.5], [-0.5, 1.0, 0.5]),
            Preset::Parabola => through_three([0.375, 0.75, -0.125], [-0.125, 0.75, 0.375]),
            Preset::Dragon => dragon(),
            Preset::Cantor => {
                let columns = [1.0, 0.0, 2.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0, 2.0 / 3.0, 0.0, 1.0];
                Self::custom(2, columns.to_vec())?.fix(0, 0)?.fix(3, 1)
            }
        }
    }
}

/// De Casteljau's construction at one half: the columns are rows of Pascal's triangle.
fn bezier(degree: u32) -> Result<Scheme, SchemeError> {
    if degree == 0 || degree > MAX_DEGREE {
        return Err(SchemeError::Degree { given: degree, largest: MAX_DEGREE });
    }
    let m = degree as usize + 1;
    let mut left = Vec::with_capacity(m * m);
    let mut row = unit(m, 0);
    for _ in 0..m {
        left.extend_from_slice(&row);
        let shifted = std::iter::once(0.0).chain(row.iter().copied().take(m - 1));
        row = row.iter().zip(shifted).map(|(a, b)| 0.5 * a + 0.5 * b).collect();
    }
    // The right half is the left half read backwards.
    let mut columns = left.clone();
    columns.extend(left.iter().rev());
    Scheme::custom(m, columns)?.fix(0, 0)?.fix(2 * m - 1, m - 1)?.tie(&[m - 1, m])
}

/// Knot insertion at the middles. The two halves share three points at every level only while the two masks repeat
/// along the control points; that is what the shifts of the ties say.
fn cubic_b_spline() -> Result<Scheme, SchemeError> {
    let (a, b, c) = (0.5, 0.125, 0.75);
    #[rustfmt::skip]
    let columns = vec![
        a, a, 0.0, 0.0,   b, c, b, 0.0,   0.0, a, a, 0.0,   0.0, b, c, b,
        b, c, b, 0.0,   0.0, a, a, 0.0,   0.0, b, c, b,   0.0, 0.0, a, a,
    ];
    let germ = [unit(4, 1), unit(4, 2)].concat();
    let mut scheme = Scheme::custom(4, columns)?.with_germ(germ)?;
    let edge = |shift| Tie::Class { class: 0, shift };
    let vertex = |shift| Tie::Class { class: 1, shift };
    scheme.ties = vec![edge(0), vertex(0), edge(1), vertex(1), vertex(0), edge(1), vertex(1), edge(2)];
    scheme.windows = vec![Window { start: 0, len: 2 }, Window { start: 0, len: 3 }];
    Ok(scheme)
}

/// The one object of 000 §5.2.3: p1 = s1, p2 = s3 = s4, p3 = s6; s2 and s5 make the figure.
fn through_three(s2: [f64; 3], s5: [f64; 3]) -> Result<Scheme, SchemeError> {
    let columns = [[1.0, 0.0, 0.0], s2, [0.0, 1.0, 0.0], [0.0, 1.0, 0.0], s5, [0.0, 0.0, 1.0]].concat();
    Scheme::custom(3, columns)?.fix(0, 0)?.fix(2, 1)?.fix(3, 1)?.fix(5, 2)
}

/// 000 §5.3 d: p1 = s1, p2 = s3 = s6, p3 = s4.
fn dragon() -> Result<Scheme, SchemeError> {
    let columns =
        [[1.0, 0.0, 0.0], [0.5, 1.0, -0.5], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.5, 0.0, 0.5], [0.0, 1.0, 0.0]];
    Scheme::custom(3, columns.concat())?.fix(0, 0)?.fix(2, 1)?.fix(3, 2)?.fix(5, 1)
}
