//! Quantities: a number and what it measures, as whole powers of millimetre, degree, revolution and minute.

use std::fmt;

/// The largest power of a unit that anything here can have; beyond it a formula is a slip of the pen.
const HIGHEST: i8 = 9;

/// What a number measures: powers of its base units. All zero: a plain number.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dimension {
    pub(crate) length: i8,
    pub(crate) angle: i8,
    pub(crate) turn: i8,
    pub(crate) minute: i8,
}

impl Dimension {
    pub(crate) const fn length(power: i8) -> Self {
        Self { length: power, angle: 0, turn: 0, minute: 0 }
    }

    pub(crate) const ANGLE: Self = Self { length: 0, angle: 1, turn: 0, minute: 0 };

    pub(crate) const FEED: Self = Self { length: 1, angle: 0, turn: 0, minute: -1 };

    pub(crate) const SPEED: Self = Self { length: 0, angle: 0, turn: 1, minute: -1 };

    /// True for a number without a unit.
    #[must_use]
    pub fn is_plain(self) -> bool {
        self == Self::default()
    }

    fn map(self, other: Self, f: impl Fn(i8, i8) -> Option<i8>) -> Option<Self> {
        let power = |a, b| f(a, b).filter(|p: &i8| (-HIGHEST..=HIGHEST).contains(p));
        Some(Self {
            length: power(self.length, other.length)?,
            angle: power(self.angle, other.angle)?,
            turn: power(self.turn, other.turn)?,
            minute: power(self.minute, other.minute)?,
        })
    }

    /// Of a product; `None` if a power grows beyond all measure.
    pub(crate) fn times(self, other: Self) -> Option<Self> {
        self.map(other, i8::checked_add)
    }

    /// Of a quotient.
    pub(crate) fn over(self, other: Self) -> Option<Self> {
        self.map(other, i8::checked_sub)
    }

    pub(crate) fn power(self, power: i8) -> Option<Self> {
        self.map(self, |p, _| p.checked_mul(power))
    }

    /// Of a square root; `None` if a power is odd.
    pub(crate) fn root(self) -> Option<Self> {
        self.map(self, |p, _| (p % 2 == 0).then_some(p / 2))
    }
}

/// The unit's sign as one writes it (`mm2`, `mm/min`); for a plain number it says so in words.
impl fmt::Display for Dimension {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_plain() {
            return f.write_str("a number without a unit");
        }
        let parts = [("mm", self.length), ("deg", self.angle), ("rev", self.turn), ("min", self.minute)];
        let mut first = true;
        for (sign, power) in parts.iter().filter(|(_, power)| *power > 0) {
            f.write_str(if first { sign } else { "*" })?;
            if !first {
                f.write_str(sign)?;
            }
            first = false;
            if *power > 1 {
                write!(f, "{power}")?;
            }
        }
        if first {
            f.write_str("1")?;
        }
        for (sign, power) in parts.iter().filter(|(_, power)| *power < 0) {
            write!(f, "/{sign}")?;
            if *power < -1 {
                write!(f, "{}", -power)?;
            }
        }
        Ok(())
    }
}

/// A number with what it measures, in mm, degrees, revolutions and minutes.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Quantity {
    /// How many base units.
    pub value: f64,
    /// What it measures.
    pub dimension: Dimension,
}

impl Quantity {
    /// A number without a unit.
    #[must_use]
    pub fn plain(value: f64) -> Self {
        Self { value, dimension: Dimension::default() }
    }

    /// One of the unit with that sign: `mm`, `cm`, `m`, `in`, squared (`mm2`), cubed (`mm3`) or per minute (`m/min`); `deg`,
    /// `°`, `rad`; `rev/min`.
    #[must_use]
    pub fn unit(sign: &str) -> Option<Self> {
        let quantity = |value, dimension| Some(Self { value, dimension });
        match sign {
            "deg" | "°" => return quantity(1.0, Dimension::ANGLE),
            "rad" => return quantity(180.0 / std::f64::consts::PI, Dimension::ANGLE),
            "rev/min" => return quantity(1.0, Dimension::SPEED),
            _ => {}
        }
        let ends = [("/min", 1, Dimension::FEED), ("2", 2, Dimension::length(2)), ("²", 2, Dimension::length(2))];
        let ends = ends.into_iter().chain([("3", 3, Dimension::length(3)), ("³", 3, Dimension::length(3))]);
        let found = ends.into_iter().find_map(|(end, power, d)| Some((sign.strip_suffix(end)?, power, d)));
        let (base, power, dimension) = found.unwrap_or((sign, 1, Dimension::length(1)));
        let mm: f64 = match base.strip_suffix('^').filter(|_| power > 1).unwrap_or(base) {
            "mm" => 1.0,
            "cm" => 10.0,
            "m" => 1000.0,
            "in" => 25.4,
            _ => return None,
        };
        quantity(mm.powi(power), dimension)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_know_their_size_and_write_themselves() {
        for (sign, value, written) in [
            ("cm", 10.0, "mm"),
            ("cm2", 100.0, "mm2"),
            ("m^3", 1e9, "mm3"),
            ("in²", 645.16, "mm2"),
            ("m/min", 1000.0, "mm/min"),
            ("rad", 57.295_779_513_082_32, "deg"),
            ("rev/min", 1.0, "rev/min"),
        ] {
            let unit = Quantity::unit(sign).expect(sign);
            assert!((unit.value - value).abs() < 1e-9 * value, "{sign}: {}", unit.value);
            assert_eq!(unit.dimension.to_string(), written);
        }
        for stranger in ["", "kg", "mm4", "deg2", "rev", "min", "/min", "^2", "mm^", "rad/min"] {
            assert_eq!(Quantity::unit(stranger), None, "{stranger}");
        }
        assert_eq!(Dimension::FEED.over(Dimension::ANGLE).map(|d| d.to_string()).as_deref(), Some("mm/deg/min"));
        assert_eq!(Dimension::length(-1).to_string(), "1/mm");
    }
}
