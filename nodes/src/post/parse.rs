//! Reads a program back, strictly: the neutral subset of G-code that every five-axis control and LinuxCNC's interpreter
//! understand alike. What is not in it is an error with its line, never skipped.

use std::ops::Range;
use tenon_geometry::machine::Machine;
use tenon_geometry::proof::Motion;

/// Longest line that LinuxCNC reads.
const LONGEST_LINE: usize = 255;

/// Why a program text is refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}: {problem}")]
pub struct ProgramError {
    /// Line, from 1.
    pub line: u32,
    /// What is wrong there.
    pub problem: String,
}

/// The words of one line, by letter; each letter stands at most once except G and M.
#[derive(Default)]
struct Block {
    /// X, Y, Z, primary, secondary.
    axes: [Option<f64>; 5],
    motion: Option<bool>,
    cancel: bool,
    feed: Option<f64>,
    speed: Option<f64>,
    tool: Option<u32>,
    metric: bool,
    absolute: bool,
    change: bool,
    spindle: Option<bool>,
    end: bool,
    any: bool,
}

/// What the control remembers between lines.
#[derive(Default)]
struct State {
    axes: [Option<f64>; 5],
    rapid: Option<bool>,
    feed: f64,
    speed: f64,
    turning: bool,
    selected: Option<u32>,
    loaded: u32,
    metric: bool,
    absolute: bool,
    ended: bool,
}

/// Reads a program: words G0 G1 G17 G21 G40 G49 G54 G61 G80 G90 G94, M2 M3 M5 M6 M30, N F S T and the machine's axes,
/// comments in parentheses or after a semicolon, `%` lines. The first motions may leave axes unnamed as long as they are
/// rapids: they come from an unknown place and are no motions of the result. O(bytes); never panics.
///
/// # Errors
/// The first line that is not in the subset or makes no sense there, with what is wrong.
pub fn parse_program(text: &[u8], machine: &Machine) -> Result<Vec<Motion>, ProgramError> {
    let letters: [u8; 5] = [
        machine.linear[0].letter,
        machine.linear[1].letter,
        machine.linear[2].letter,
        machine.primary.letter,
        machine.secondary.letter,
    ]
    .map(|c| u8::try_from(c).unwrap_or(0).to_ascii_uppercase());
    let mut motions = Vec::with_capacity(text.len() / 24);
    let mut state = State::default();
    let mut line = 0u32;
    for raw in text.split(|b| *b == b'\n') {
        line = line.saturating_add(1);
        let raw = raw.strip_suffix(b"\r").unwrap_or(raw);
        let refuse = |problem: String| ProgramError { line, problem };
        let block = read_block(raw, &letters).map_err(refuse)?;
        if state.ended {
            if block.any {
                return Err(refuse("words after the end of the program".into()));
            }
            continue;
        }
        if let Some(motion) = state.run(&block, line).map_err(refuse)? {
            motions.push(motion);
        }
    }
    if state.ended {
        Ok(motions)
    } else {
        Err(ProgramError { line, problem: "the program does not end: M2 or M30 is missing".into() })
    }
}

/// Splits a line into words. Spaces may stand between words and between a letter and its number, not inside a number.
fn read_block(line: &[u8], letters: &[u8; 5]) -> Result<Block, String> {
    if line.len() > LONGEST_LINE {
        return Err(format!("{} characters; controls read {LONGEST_LINE} at most", line.len()));
    }
    let mut block = Block::default();
    let mut seen = 0u32;
    let mut groups = 0u32;
    let mut at = 0;
    let trimmed = line.trim_ascii();
    if trimmed == b"%" {
        return Ok(block);
    }
    while let Some(&byte) = line.get(at) {
        match byte {
            b' ' | b'\t' => at += 1,
            b';' => return Ok(block),
            b'(' => {
                let rest = &line[at + 1..];
                match rest.iter().position(|b| matches!(b, b'(' | b')')) {
                    Some(end) if rest[end] == b')' => at += end + 2,
                    Some(_) => return Err("a comment inside a comment".into()),
                    None => return Err("a comment is opened and not closed".into()),
                }
            }
            _ if byte.is_ascii_alphabetic() => {
                let letter = byte.to_ascii_uppercase();
                let number = number_at(line, at + 1);
                let digits = line.get(number.clone()).unwrap_or_default();
                let text = std::str::from_utf8(digits).unwrap_or_default();
                let value: f64 = match text.parse() {
                    Ok(v) if digits.iter().any(u8::is_ascii_digit) => v,
                    _ => return Err(format!("{} is not followed by a number", char::from(letter))),
                };
                if !value.is_finite() {
                    return Err(format!("{}{text} is too large", char::from(letter)));
                }
                at = number.end;
                if letter != b'G' && letter != b'M' {
                    let bit = 1 << (letter - b'A');
                    if seen & bit != 0 {
                        return Err(format!("{} stands twice", char::from(letter)));
                    }
                    seen |= bit;
                }
                block.word(letter, value, text, letters, &mut groups)?;
            }
            _ => return Err(format!("'{}' is no word of a program", byte.escape_ascii())),
        }
    }
    Ok(block)
}

/// Where the number after a letter stands: sign, digits, point. No exponents, as in every control.
fn number_at(line: &[u8], mut at: usize) -> Range<usize> {
    let is = |at: usize, set: &[u8]| line.get(at).is_some_and(|b| set.contains(b));
    while is(at, b" \t") {
        at += 1;
    }
    let start = at;
    if is(at, b"+-") {
        at += 1;
    }
    while is(at, b"0123456789") {
        at += 1;
    }
    if is(at, b".") {
        at += 1;
        while is(at, b"0123456789") {
            at += 1;
        }
    }
    start..at
}

impl Block {
    fn word(&mut self, letter: u8, value: f64, text: &str, letters: &[u8; 5], groups: &mut u32) -> Result<(), String> {
        let name = char::from(letter);
        let whole = |most: f64| {
            if value.fract() == 0.0 && (0.0..=most).contains(&value) {
                Ok(value as u32)
            } else {
                Err(format!("{name}{text}: a whole number from 0 to {most} is wanted"))
            }
        };
        self.any |= letter != b'N';
        if let Some(axis) = letters.iter().position(|l| *l == letter) {
            self.axes[axis] = Some(value);
            return Ok(());
        }
        // One word of a modal group per line.
        let mut group = |bit: u32| {
            let taken = *groups & (1 << bit) != 0;
            *groups |= 1 << bit;
            if taken { Err(format!("{name}{text} contradicts another {name} word of the line")) } else { Ok(()) }
        };
        match letter {
            b'N' => whole(99_999_999.0).map(|_| ()),
            b'F' if value > 0.0 => {
                self.feed = Some(value);
                Ok(())
            }
            b'F' => Err(format!("feed F{text} must be more than 0")),
            b'S' if value >= 0.0 => {
                self.speed = Some(value);
                Ok(())
            }
            b'S' => Err(format!("speed S{text} must not be negative")),
            b'T' => {
                self.tool = Some(whole(99_999_999.0)?);
                Ok(())
            }
            b'G' => match whole(999.0).unwrap_or(u32::MAX) {
                code @ (0 | 1) => {
                    self.motion = Some(code == 0);
                    group(0)
                }
                17 => group(1),
                21 => {
                    self.metric = true;
                    group(2)
                }
                90 => {
                    self.absolute = true;
                    group(3)
                }
                40 => group(4),
                49 => group(5),
                54 => group(6),
                80 => {
                    self.cancel = true;
                    group(0)
                }
                61 => group(7),
                94 => group(8),
                20 => Err("G20: inches are not in the neutral subset (G21 is)".into()),
                91 => Err("G91: incremental motion is not in the neutral subset (G90 is)".into()),
                _ => Err(format!("G{text} is not in the neutral subset (G0 G1 G17 G21 G40 G49 G54 G61 G80 G90 G94)")),
            },
            b'M' => match whole(999.0).unwrap_or(u32::MAX) {
                3 => {
                    self.spindle = Some(true);
                    group(9)
                }
                5 => {
                    self.spindle = Some(false);
                    group(9)
                }
                6 => {
                    self.change = true;
                    group(10)
                }
                2 | 30 => {
                    self.end = true;
                    group(11)
                }
                _ => Err(format!("M{text} is not in the neutral subset (M2 M3 M5 M6 M30)")),
            },
            b'X' | b'Y' | b'Z' | b'A' | b'B' | b'C' | b'U' | b'V' | b'W' => {
                Err(format!("{name}{text}: this machine has no axis {name}"))
            }
            _ => Err(format!("{name}{text}: unknown word")),
        }
    }
}

impl State {
    /// Runs a line in the order of every control: feed, speed, tool, change, spindle, modes, motion, end.
    fn run(&mut self, block: &Block, line: u32) -> Result<Option<Motion>, String> {
        self.feed = block.feed.unwrap_or(self.feed);
        self.speed = block.speed.unwrap_or(self.speed);
        self.selected = block.tool.or(self.selected);
        if block.change {
            self.loaded = self.selected.ok_or("M6 without a tool (T) to change to")?;
            self.turning = false;
        }
        if let Some(turning) = block.spindle {
            if turning && self.speed <= 0.0 {
                return Err("M3 without a speed (S)".into());
            }
            self.turning = turning;
        }
        self.metric |= block.metric;
        self.absolute |= block.absolute;
        self.rapid = if block.cancel { None } else { block.motion.or(self.rapid) };
        self.ended = block.end;
        if block.axes.iter().all(Option::is_none) {
            return if block.motion.is_some() { Err("G0 or G1 without an axis".into()) } else { Ok(None) };
        }
        if block.end {
            return Err("a motion on the line that ends the program".into());
        }
        let Some(rapid) = self.rapid else {
            return Err("a motion while neither G0 nor G1 is in force".into());
        };
        if !self.metric || !self.absolute {
            return Err("a motion before G21 and G90".into());
        }
        if !rapid && self.feed <= 0.0 {
            return Err("G1 before the first feed (F)".into());
        }
        for (axis, word) in self.axes.iter_mut().zip(block.axes) {
            *axis = word.or(*axis);
        }
        let [Some(x), Some(y), Some(z), Some(a), Some(b)] = self.axes else {
            return if rapid { Ok(None) } else { Err("G1 before every axis has a position".into()) };
        };
        Ok(Some(Motion {
            line,
            rapid,
            tool: self.loaded,
            speed: if self.turning { self.speed } else { 0.0 },
            feed: if rapid { 0.0 } else { self.feed },
            linear: tenon_geometry::DVec3::new(x, y, z),
            angles: [a.to_radians(), b.to_radians()],
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::post::machine_preset;
    use proptest::prelude::*;

    fn maka() -> Machine {
        machine_preset("maka-mm7s").unwrap().machine
    }

    fn refused(line: &str) -> String {
        let text = format!("G21 G90\n{line}\nM30\n");
        let error = parse_program(text.as_bytes(), &maka()).unwrap_err();
        assert_eq!(error.line, 2, "{error}");
        error.problem
    }

    #[test]
    fn a_program_becomes_motions_with_lines_and_modes() {
        let text = "%\n(board 1)\nN10 G21 G90 G17 G40 G49 G80\nG54 G0 Z60.\nT10 M6\nS18000 M3\n\
                    g0 x1 Y 2.5 A-90 B+.5 ; up here\nG1Z-1.25F1500\nX10\nM5\nG0 Z60\nM30\n%\n";
        let motions = parse_program(text.as_bytes(), &maka()).unwrap();
        assert_eq!(motions.len(), 4);
        assert_eq!((motions[0].line, motions[0].rapid, motions[0].tool), (7, true, 10));
        assert_eq!(motions[0].linear.to_array(), [1.0, 2.5, 60.0]);
        assert!((motions[0].angles[0] + 90f64.to_radians()).abs() < 1e-15);
        assert_eq!((motions[1].feed, motions[1].speed, motions[1].linear.z), (1500.0, 18000.0, -1.25));
        assert_eq!((motions[2].feed, motions[2].linear.x), (1500.0, 10.0));
        assert_eq!((motions[3].speed, motions[3].rapid), (0.0, true));
    }

    #[test]
    fn what_is_not_in_the_subset_is_refused_with_its_line() {
        for (line, says) in [
            ("G2 X1 Y1 I1", "G2"),
            ("G20", "inches"),
            ("G91", "incremental"),
            ("G43.4 H1", "G43.4"),
            ("M4 S100", "M4"),
            ("G0 C5", "no axis C"),
            ("#1=5", "no word"),
            ("O100 sub", "unknown word"),
            ("G0 X1 X2", "stands twice"),
            ("G0 G1 X1", "contradicts"),
            ("G0 X", "not followed"),
            ("G0 X1e5", "unknown word"),
            ("G0 X1.2.3", "no word"),
            ("G0 X--1", "not followed"),
            ("G1 X1", "before the first feed"),
            ("X1", "neither G0 nor G1"),
            ("G80 X1", "neither G0 nor G1"),
            ("G1 X1 F100", "every axis"),
            ("G0", "without an axis"),
            ("M6", "without a tool"),
            ("M3", "without a speed"),
            ("T1.5", "whole number"),
            ("F0", "more than 0"),
            ("(open", "not closed"),
            ("(a (b) c)", "inside a comment"),
            ("/G0 X1", "no word"),
        ] {
            let problem = refused(line);
            assert!(problem.contains(says), "{line}: {problem}");
        }
        assert!(refused(&"G".repeat(300)).contains("255"));
        assert!(parse_program(b"G21 G90\n", &maka()).unwrap_err().problem.contains("does not end"));
        assert!(parse_program(b"G0 X1\nM2", &maka()).unwrap_err().problem.contains("G21"));
        assert!(parse_program(b"M2\nG0 X1\n", &maka()).unwrap_err().problem.contains("after the end"));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        #[test]
        fn any_bytes_give_an_answer(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
            let _ = parse_program(&bytes, &maka());
        }

        #[test]
        fn near_programs_give_an_answer(text in "[GMXYZABNFST0-9. ()%;\\-\n]{0,200}") {
            let _ = parse_program(text.as_bytes(), &maka());
        }
    }
}
