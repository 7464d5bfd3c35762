//! From text to steps: recursive descent with a bounded depth, straight from characters.
//!
//! sum = product {(+|-) product} · product = signed {(*|/) signed} · signed = {+|-} power · power = atom [^ signed] ·
//! atom = number [unit] | name | 'name' | pi | function(sum, ...) | (sum)

use super::{Expression, ExpressionError, ExpressionFault as Fault, Function, Quantity, Step, fault};

/// Characters that a formula may have.
const LONGEST: usize = 1000;
/// Signs, exponents and brackets inside one another.
const DEEPEST: usize = 64;

pub(super) fn parse(text: &str) -> Result<Expression, ExpressionError> {
    let chars: Vec<char> = text.chars().take(LONGEST + 1).collect();
    if chars.len() > LONGEST {
        return fault(LONGEST as u32 + 1, Fault::TooLong(LONGEST));
    }
    let mut parser = Parser { chars, at: 0, depth: 0, out: Expression { steps: Vec::new(), names: Vec::new() } };
    parser.sum()?;
    if parser.peek().is_some() {
        return parser.expected("an operator or the end");
    }
    Ok(parser.out)
}

struct Parser {
    chars: Vec<char>,
    at: usize,
    depth: usize,
    out: Expression,
}

fn starts_name(c: char) -> bool {
    c.is_alphabetic() || c == '_'
}

fn in_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

impl Parser {
    fn next_char(&self, ahead: usize) -> Option<char> {
        self.chars.get(self.at + ahead).copied()
    }

    /// The next character that is no space.
    fn peek(&mut self) -> Option<char> {
        while self.next_char(0).is_some_and(char::is_whitespace) {
            self.at += 1;
        }
        self.next_char(0)
    }

    fn take(&mut self, c: char) -> bool {
        let found = self.peek() == Some(c);
        self.at += usize::from(found);
        found
    }

    fn take_while(&mut self, test: impl Fn(char) -> bool) -> String {
        let from = self.at;
        while self.next_char(0).is_some_and(&test) {
            self.at += 1;
        }
        self.chars[from..self.at].iter().collect()
    }

    fn column(&self) -> u32 {
        self.at as u32 + 1
    }

    fn expected<T>(&mut self, wanted: &'static str) -> Result<T, ExpressionError> {
        let found = match self.peek() {
            None => "the end".to_owned(),
            Some(c) if in_name(c) => {
                let word: String = self.chars[self.at..].iter().take_while(|c| in_name(**c)).take(40).collect();
                format!("\"{word}\"")
            }
            Some(c) => format!("\"{c}\""),
        };
        fault(self.column(), Fault::Expected { wanted, found })
    }

    fn push(&mut self, step: Step, column: u32) {
        self.out.steps.push((step, column));
    }

    fn sum(&mut self) -> Result<(), ExpressionError> {
        self.product()?;
        loop {
            let step = match self.peek() {
                Some('+') => Step::Add,
                Some('-' | '−') => Step::Subtract,
                _ => return Ok(()),
            };
            let column = self.column();
            self.at += 1;
            self.product()?;
            self.push(step, column);
        }
    }

    fn product(&mut self) -> Result<(), ExpressionError> {
        self.signed()?;
        loop {
            let step = match self.peek() {
                Some('*' | '×' | '·') => Step::Multiply,
                Some('/') => Step::Divide,
                _ => return Ok(()),
            };
            let column = self.column();
            self.at += 1;
            self.signed()?;
            self.push(step, column);
        }
    }

    /// Everything that nests passes through here, so the depth is counted here.
    fn signed(&mut self) -> Result<(), ExpressionError> {
        let mut negate = None;
        while let Some(sign @ ('+' | '-' | '−')) = self.peek() {
            if sign != '+' {
                negate = if negate.is_some() { None } else { Some(self.column()) };
            }
            self.at += 1;
        }
        self.depth += 1;
        if self.depth > DEEPEST {
            return fault(self.column(), Fault::TooDeep(DEEPEST));
        }
        self.atom()?;
        if self.peek() == Some('^') {
            let column = self.column();
            self.at += 1;
            self.signed()?;
            self.push(Step::Power, column);
        }
        self.depth -= 1;
        if let Some(column) = negate {
            self.push(Step::Negate, column);
        }
        Ok(())
    }

    fn atom(&mut self) -> Result<(), ExpressionError> {
        let first = self.peek();
        let column = self.column();
        match first {
            Some('(') => {
                self.at += 1;
                self.sum()?;
                self.close()
            }
            Some('\'') => {
                self.at += 1;
                let name = self.take_while(|c| c != '\'');
                if self.next_char(0).is_none() {
                    return self.expected("a closing '");
                }
                self.at += 1;
                self.name(name, column);
                Ok(())
            }
            Some(c) if c.is_ascii_digit() || c == '.' => self.number(column),
            Some(c) if starts_name(c) => {
                let name = self.take_while(in_name);
                if self.peek() == Some('(') {
                    return self.function(&name, column);
                }
                if name == "pi" {
                    self.push(Step::Push(Quantity::plain(std::f64::consts::PI)), column);
                } else {
                    self.name(name, column);
                }
                Ok(())
            }
            _ => self.expected("a number, a name or a bracket"),
        }
    }

    fn close(&mut self) -> Result<(), ExpressionError> {
        if self.take(')') { Ok(()) } else { self.expected("an operator or \")\"") }
    }

    fn name(&mut self, name: String, column: u32) {
        let known = self.out.names.iter().position(|n| *n == name);
        let index = known.unwrap_or_else(|| {
            self.out.names.push(name);
            self.out.names.len() - 1
        });
        self.push(Step::Name(index as u32), column);
    }

    fn function(&mut self, name: &str, column: u32) -> Result<(), ExpressionError> {
        let Some(function) = Function::find(name) else {
            let known = Function::ALL.map(|(n, _)| n).join(", ");
            return fault(column, Fault::Function { name: name.chars().take(40).collect(), known });
        };
        self.at += 1;
        let mut found = 0;
        if self.peek() != Some(')') {
            loop {
                self.sum()?;
                found += 1;
                if !self.take(',') {
                    break;
                }
            }
        }
        self.close()?;
        let (fits, wanted) =
            if function.is_variadic() { (found >= 1, "at least one argument") } else { (found == 1, "one argument") };
        if !fits {
            return fault(column, Fault::Arguments { function: function.name(), wanted, found });
        }
        self.push(Step::Call(function, found as u32), column);
        Ok(())
    }

    fn number(&mut self, column: u32) -> Result<(), ExpressionError> {
        let mut text = self.take_while(|c| c.is_ascii_digit() || c == '.');
        if matches!(self.next_char(0), Some('e' | 'E')) {
            let sign = usize::from(matches!(self.next_char(1), Some('+' | '-')));
            if self.next_char(1 + sign).is_some_and(|c| c.is_ascii_digit()) {
                text.extend(&self.chars[self.at..=self.at + sign]);
                self.at += 1 + sign;
                text += &self.take_while(|c| c.is_ascii_digit());
            }
        }
        let Some(value) = text.parse().ok().filter(|v: &f64| v.is_finite()) else {
            return fault(column, Fault::Number(text.chars().take(40).collect()));
        };
        let unit = match self.peek() {
            Some(c) if c.is_alphabetic() || c == '°' => self.unit()?,
            _ => Quantity::plain(1.0),
        };
        let value = value * unit.value;
        if !value.is_finite() {
            return fault(column, Fault::Number(text.chars().take(40).collect()));
        }
        self.push(Step::Push(Quantity { value, ..unit }), column);
        Ok(())
    }

    fn unit(&mut self) -> Result<Quantity, ExpressionError> {
        let column = self.column();
        let mut sign = self.take_while(|c| in_name(c) || matches!(c, '°' | '²' | '³'));
        // `2 mm^2` is two square millimetres, not the square of two millimetres; no other power can stand here.
        if self.peek() == Some('^') {
            self.at += 1;
            self.peek();
            sign.push('^');
            sign += &self.take_while(|c| in_name(c) || matches!(c, '.' | '-'));
        }
        let per_minute: String = self.chars[self.at..].iter().take(4).collect();
        // `mm/min` is a unit, `mm/min(a, b)` a quotient.
        if per_minute == "/min" && !self.next_char(4).is_some_and(|c| in_name(c) || c == '(') {
            self.at += 4;
            sign += &per_minute;
        }
        Quantity::unit(&sign).map_or_else(|| fault(column, Fault::Unit(sign.chars().take(40).collect())), Ok)
    }
}
