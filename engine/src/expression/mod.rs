//! Formulas over named numbers with units: `thickness * 2 + 3 mm`. Parsed once into a flat list of steps, evaluated without
//! recursion; every fault says at which column of the text it lies.

mod parse;
mod quantity;

pub use quantity::{Dimension, Quantity};

/// A formula, ready to be evaluated.
#[derive(Clone, Debug, PartialEq)]
pub struct Expression {
    /// Reverse Polish, each with the column where it stands.
    steps: Vec<(Step, u32)>,
    names: Vec<String>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Step {
    Push(Quantity),
    /// Index into the names.
    Name(u32),
    Negate,
    Add,
    Subtract,
    Multiply,
    Divide,
    Power,
    /// With how many arguments.
    Call(Function, u32),
}

/// The functions; angles are in degrees.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Function {
    Sin,
    Cos,
    Tan,
    Sqrt,
    Min,
    Max,
    Abs,
    Round,
    Floor,
    Ceil,
}

impl Function {
    const ALL: [(&'static str, Self); 10] = [
        ("sin", Self::Sin),
        ("cos", Self::Cos),
        ("tan", Self::Tan),
        ("sqrt", Self::Sqrt),
        ("min", Self::Min),
        ("max", Self::Max),
        ("abs", Self::Abs),
        ("round", Self::Round),
        ("floor", Self::Floor),
        ("ceil", Self::Ceil),
    ];

    fn find(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(n, _)| *n == name).map(|(_, f)| *f)
    }

    fn name(self) -> &'static str {
        Self::ALL.iter().find(|(_, f)| *f == self).map_or("", |(n, _)| n)
    }

    fn is_variadic(self) -> bool {
        matches!(self, Self::Min | Self::Max)
    }
}

/// What is wrong with a formula, and where.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("column {column}: {fault}")]
pub struct ExpressionError {
    /// The first character that it concerns, counted from 1.
    pub column: usize,
    /// What is wrong.
    pub fault: ExpressionFault,
}

/// What is wrong with a formula.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ExpressionFault {
    /// More characters than a formula may have.
    #[error("a formula may have at most {0} characters")]
    TooLong(usize),
    /// Brackets and signs inside one another.
    #[error("nested deeper than {0} levels")]
    TooDeep(usize),
    /// Something else should stand here.
    #[error("expected {wanted}, found {found}")]
    Expected {
        /// What should stand here.
        wanted: &'static str,
        /// What stands here.
        found: String,
    },
    /// A number that no `f64` holds.
    #[error("\"{0}\" is not a number that can be computed with")]
    Number(String),
    /// No unit is written so.
    #[error("\"{0}\" is no unit; there are mm, cm, m, in (also mm2, mm3, mm/min ...), deg, rad and rev/min")]
    Unit(String),
    /// No function is called so.
    #[error("there is no function \"{name}\"; there are {known}")]
    Function {
        /// As written.
        name: String,
        /// All that there are.
        known: String,
    },
    /// A function with too few or too many arguments.
    #[error("{function} takes {wanted}, found {found}")]
    Arguments {
        /// Its name.
        function: &'static str,
        /// What it takes.
        wanted: &'static str,
        /// How many were given.
        found: usize,
    },
    /// A name without a number behind it.
    #[error("{0}")]
    Name(String),
    /// Two things that cannot be added, or compared.
    #[error("{left} and {right} cannot be {done}")]
    Mixed {
        /// What was to be done.
        done: &'static str,
        /// On the left.
        left: Dimension,
        /// On the right.
        right: Dimension,
    },
    /// An argument of the wrong kind.
    #[error("{what} takes {wanted}, found {found}")]
    Kind {
        /// A function or an exponent.
        what: &'static str,
        /// What it takes.
        wanted: &'static str,
        /// What was given.
        found: Dimension,
    },
    /// A power of a unit that measures nothing.
    #[error("nothing is measured in such a power of {0}")]
    NoMeasure(Dimension),
    /// Division by zero, root of a negative number, overflow.
    #[error("{0} gives no finite number")]
    NotFinite(String),
}

fn fault<T>(column: u32, fault: ExpressionFault) -> Result<T, ExpressionError> {
    Err(ExpressionError { column: column as usize, fault })
}

/// Sine of degrees and so many quarters of a turn, exact at whole quarters.
fn sine(degrees: f64, quarters: i64) -> f64 {
    let rest = degrees % 360.0;
    let quarter = (rest / 90.0).round();
    let radians = (rest - 90.0 * quarter).to_radians();
    match (quarter as i64 + quarters).rem_euclid(4) {
        0 => radians.sin(),
        1 => radians.cos(),
        2 => -radians.sin(),
        _ => -radians.cos(),
    }
}

impl Expression {
    /// Reads a formula: numbers with units, names, `'other names'`, `+ - * / ^`, brackets, `pi` and the functions `sin`, `cos`,
    /// `tan`, `sqrt`, `min`, `max`, `abs`, `round`, `floor`, `ceil`. O(length).
    ///
    /// # Errors
    /// The first place where the text is no formula.
    pub fn parse(text: &str) -> Result<Self, ExpressionError> {
        parse::parse(text)
    }

    /// The names in it, each once, in order of their first place.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// `text`, which this was parsed from, with `of` in the place of every name. O(length).
    ///
    /// # Errors
    /// The first that `of` gives.
    pub(crate) fn written_with(
        &self,
        text: &str,
        of: &dyn Fn(&str) -> Result<String, String>,
    ) -> Result<String, String> {
        let chars: Vec<char> = text.chars().collect();
        let named = self.steps.iter().filter_map(|(step, column)| match step {
            Step::Name(i) => Some((*column as usize - 1, self.names.get(*i as usize)?)),
            _ => None,
        });
        let mut places: Vec<(usize, &String)> = named.collect();
        places.sort_unstable();
        let (mut out, mut done) = (String::new(), 0);
        for (at, name) in places {
            out.extend(chars.get(done..at).into_iter().flatten());
            out += &of(name)?;
            let quotes = if chars.get(at) == Some(&'\'') { 2 } else { 0 };
            done = at + name.chars().count() + quotes;
        }
        out.extend(chars.get(done..).into_iter().flatten());
        Ok(out)
    }

    /// Its value, where `number` gives what a name stands for or says why it stands for nothing. O(length).
    ///
    /// # Errors
    /// A name without a number, units that do not go together, or a step that gives no finite number.
    pub fn evaluate(&self, number: &dyn Fn(&str) -> Result<Quantity, String>) -> Result<Quantity, ExpressionError> {
        let mut stack: Vec<Quantity> = Vec::with_capacity(8);
        for (step, column) in &self.steps {
            let arguments = match step {
                Step::Push(_) | Step::Name(_) => 0,
                Step::Negate => 1,
                Step::Call(_, n) => *n as usize,
                _ => 2,
            };
            // The parser never makes a step without its operands.
            let operands = stack.split_off(stack.len().saturating_sub(arguments));
            let value = match (step, operands.as_slice()) {
                (Step::Push(q), _) => *q,
                (Step::Name(i), _) => {
                    let name = self.names.get(*i as usize).map_or("", String::as_str);
                    match number(name) {
                        Ok(q) => q,
                        Err(why) => return fault(*column, ExpressionFault::Name(why)),
                    }
                }
                (Step::Negate, [a]) => Quantity { value: -a.value, ..*a },
                (Step::Call(f, _), arguments) => call(*f, arguments, *column)?,
                (step, [a, b]) => operate(*step, *a, *b, *column)?,
                _ => Quantity::default(),
            };
            if !value.value.is_finite() {
                let what = match step {
                    Step::Divide if operands.get(1).is_some_and(|b| b.value == 0.0) => "division by zero".to_owned(),
                    Step::Call(f, _) => {
                        let arguments: Vec<String> = operands.iter().map(|q| q.value.to_string()).collect();
                        format!("{}({})", f.name(), arguments.join(", "))
                    }
                    _ => "this".to_owned(),
                };
                return fault(*column, ExpressionFault::NotFinite(what));
            }
            stack.push(value);
        }
        Ok(stack.pop().unwrap_or_default())
    }
}

fn operate(step: Step, a: Quantity, b: Quantity, column: u32) -> Result<Quantity, ExpressionError> {
    let same = |done| {
        let (left, right) = (a.dimension, b.dimension);
        if left == right { Ok(left) } else { fault(column, ExpressionFault::Mixed { done, left, right }) }
    };
    let measured = |d: Option<Dimension>, of: Dimension| match d {
        Some(d) => Ok(d),
        None => fault(column, ExpressionFault::NoMeasure(of)),
    };
    Ok(match step {
        Step::Add => Quantity { value: a.value + b.value, dimension: same("added")? },
        Step::Subtract => Quantity { value: a.value - b.value, dimension: same("subtracted")? },
        Step::Multiply => {
            Quantity { value: a.value * b.value, dimension: measured(a.dimension.times(b.dimension), a.dimension)? }
        }
        Step::Divide => {
            Quantity { value: a.value / b.value, dimension: measured(a.dimension.over(b.dimension), a.dimension)? }
        }
        _ => {
            let wrong =
                |wanted| fault(column, ExpressionFault::Kind { what: "an exponent", wanted, found: b.dimension });
            if !b.dimension.is_plain() {
                return wrong("a number without a unit");
            }
            let dimension = if a.dimension.is_plain() {
                a.dimension
            } else if b.value.fract() == 0.0 && b.value.abs() <= 9.0 {
                measured(a.dimension.power(b.value as i8), a.dimension)?
            } else {
                return fault(column, ExpressionFault::NoMeasure(a.dimension));
            };
            Quantity { value: a.value.powf(b.value), dimension }
        }
    })
}

fn call(f: Function, arguments: &[Quantity], column: u32) -> Result<Quantity, ExpressionError> {
    let Some(first) = arguments.first().copied() else { return Ok(Quantity::default()) };
    let wrong = |wanted| ExpressionError {
        column: column as usize,
        fault: ExpressionFault::Kind { what: f.name(), wanted, found: first.dimension },
    };
    let angle = || {
        let fits = first.dimension.is_plain() || first.dimension == Dimension::ANGLE;
        if fits { Ok(first.value) } else { Err(wrong("an angle (deg)")) }
    };
    let keep = |value: f64| Ok(Quantity { value, ..first });
    match f {
        Function::Sin => angle().map(|a| Quantity::plain(sine(a, 0))),
        Function::Cos => angle().map(|a| Quantity::plain(sine(a, 1))),
        Function::Tan => angle().map(|a| Quantity::plain(sine(a, 0) / sine(a, 1))),
        Function::Sqrt => match first.dimension.root() {
            Some(dimension) => Ok(Quantity { value: first.value.sqrt(), dimension }),
            None => Err(wrong("a number without a unit or an even power of one (mm2)")),
        },
        Function::Abs => keep(first.value.abs()),
        Function::Round => keep(first.value.round()),
        Function::Floor => keep(first.value.floor()),
        Function::Ceil => keep(first.value.ceil()),
        Function::Min | Function::Max => {
            if let Some(other) = arguments.iter().find(|q| q.dimension != first.dimension) {
                let (left, right) = (first.dimension, other.dimension);
                return fault(column, ExpressionFault::Mixed { done: "compared", left, right });
            }
            let pick = if f == Function::Min { f64::min } else { f64::max };
            keep(arguments.iter().map(|q| q.value).fold(first.value, pick))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn value(text: &str) -> Result<(f64, String), String> {
        let names = |name: &str| match name {
            "thickness" => Ok(Quantity { value: 12.0, dimension: Dimension::length(1) }),
            "tilt" => Ok(Quantity { value: 30.0, dimension: Dimension::ANGLE }),
            "count" | "board length" => Ok(Quantity::plain(3.0)),
            _ => Err(format!("no {name}")),
        };
        let q = Expression::parse(text).and_then(|e| e.evaluate(&names)).map_err(|e| e.to_string())?;
        Ok((q.value, if q.dimension.is_plain() { String::new() } else { q.dimension.to_string() }))
    }

    #[test]
    fn formulas_give_numbers_with_units() {
        for (text, expected, unit) in [
            ("12", 12.0, ""),
            ("-1.5e1", -15.0, ""),
            ("15 cm", 150.0, "mm"),
            ("1in+2mm", 27.4, "mm"),
            ("thickness * 2", 24.0, "mm"),
            ("thickness*thickness", 144.0, "mm2"),
            ("2 cm^2 / thickness", 200.0 / 12.0, "mm"),
            ("sqrt(9 cm2)", 30.0, "mm"),
            ("2 + 3 * 4 ^ 2 ^ 0.5 - 1", 1.0 + 3.0 * 4f64.powf(2f64.sqrt()), ""),
            ("-2^2", -4.0, ""),
            ("2^-1", 0.5, ""),
            ("(thickness + 1 cm)^2", 484.0, "mm2"),
            ("8 / 4 / 2", 1.0, ""),
            ("10 - 3 - 2", 5.0, ""),
            ("sin(30 deg) + cos(60)", 1.0, ""),
            ("sin(180)", 0.0, ""),
            ("cos(-90)", 0.0, ""),
            ("sin(270) + cos(180)", -2.0, ""),
            ("tan(45)", 1.0, ""),
            ("tan(tilt) * thickness", 12.0 / 3f64.sqrt(), "mm"),
            ("sin(pi / 2 * 1 rad)", 1.0, ""),
            ("max(thickness, 1 cm, 5 mm)", 12.0, "mm"),
            ("min(3, 2, count)", 2.0, ""),
            ("round(2.5) + floor(-0.5) + ceil(0.2) + abs(-4)", 7.0, ""),
            ("2 * 'board length'", 6.0, ""),
            ("3 m/min", 3000.0, "mm/min"),
            ("18000 rev/min", 18000.0, "rev/min"),
            ("6 mm/min(3, 2)", 3.0, "mm"),
            ("3.5 °", 3.5, "deg"),
            ("2 × 3 · 4 − 1", 23.0, ""),
        ] {
            let (found, found_unit) = value(text).unwrap_or_else(|e| panic!("{text}: {e}"));
            assert!((found - expected).abs() <= 1e-12 * expected.abs().max(1.0), "{text}: {found}, not {expected}");
            assert_eq!(found_unit, unit, "{text}");
        }
        assert_eq!(value("sin(180) + cos(90) + cos(270)"), Ok((0.0, String::new())));
    }

    #[test]
    fn faults_name_their_column_and_both_units() {
        for (text, expected) in [
            ("", "column 1: expected a number, a name or a bracket, found the end"),
            ("1 +", "column 4: expected a number, a name or a bracket, found the end"),
            ("thickness * * 2", "column 13: expected a number, a name or a bracket, found \"*\""),
            ("(1 + 2", "column 7: expected an operator or \")\", found the end"),
            ("1 + 2)", "column 6: expected an operator or the end, found \")\""),
            ("2 * thickness mm", "column 15: expected an operator or the end, found \"mm\""),
            ("thickness + 5", "column 11: mm and a number without a unit cannot be added"),
            ("thickness - tilt", "column 11: mm and deg cannot be subtracted"),
            ("max(1 mm, 2 mm2)", "column 1: mm and mm2 cannot be compared"),
            ("1 + sin(thickness)", "column 5: sin takes an angle (deg), found mm"),
            ("sqrt(thickness)", "column 1: sqrt takes a number without a unit or an even power of one (mm2), found mm"),
            ("2 ^ thickness", "column 3: an exponent takes a number without a unit, found mm"),
            ("thickness ^ 0.5", "column 11: nothing is measured in such a power of mm"),
            ("thickness ^ 9 * thickness", "column 15: nothing is measured in such a power of mm9"),
            ("1 / (count - 3)", "column 3: division by zero gives no finite number"),
            ("sqrt(1 - 2)", "column 1: sqrt(-1) gives no finite number"),
            ("tan(90)", "column 1: tan(90) gives no finite number"),
            ("1e308 * 10", "column 7: this gives no finite number"),
            ("1e999", "column 1: \"1e999\" is not a number that can be computed with"),
            ("1.2.3", "column 1: \"1.2.3\" is not a number that can be computed with"),
            (
                "5 + 2 width",
                "column 7: \"width\" is no unit; there are mm, cm, m, in (also mm2, mm3, mm/min ...), deg, rad and rev/min",
            ),
            ("5 + width", "column 5: no width"),
            (
                "asin(1)",
                "column 1: there is no function \"asin\"; there are sin, cos, tan, sqrt, min, max, abs, round, floor, ceil",
            ),
            ("min()", "column 1: min takes at least one argument, found 0"),
            ("abs(1, 2)", "column 1: abs takes one argument, found 2"),
            ("'open", "column 6: expected a closing ', found the end"),
            ("ä + ö #", "column 7: expected an operator or the end, found \"#\""),
        ] {
            assert_eq!(value(text), Err(expected.to_owned()), "{text}");
        }
    }

    #[test]
    fn long_and_deep_texts_are_refused() {
        let deep = |n: usize| value(&format!("{}1{}", "(".repeat(n), ")".repeat(n)));
        assert_eq!(deep(60), Ok((1.0, String::new())));
        assert_eq!(deep(64), Err("column 65: nested deeper than 64 levels".into()));
        assert!(value(&"2^".repeat(400)).is_err_and(|e| e.contains("nested deeper")));
        assert_eq!(value(&format!("{}1", "-".repeat(999))), Ok((-1.0, String::new())));
        assert!(value(&"1+".repeat(600)).is_err_and(|e| e.contains("column 1001: a formula may have at most 1000")));
    }
}
