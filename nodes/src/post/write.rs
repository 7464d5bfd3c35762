//! Tool paths to programs: one text per board, in a machine's words.

use super::error::PostError;
use super::number::{push_units, short, to_units};
use super::words::Words;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use tenon_geometry::DVec3;
use tenon_geometry::board::Layout;
use tenon_geometry::machine::{KinematicsError, Machine, Pose, Tool};
use tenon_geometry::mesh::Address;
use tenon_geometry::motion::{MoveKind, Operation, PartPaths, PathIssue, Purpose, ToolPaths, place_boards};

/// How far the tool axis may leave the even turn from one pose to the next while both rotary axes run linearly, radians.
const TURN_DEVIATION: f64 = 1e-4;

/// What a program is called and says about itself.
#[derive(Clone, Copy, Debug)]
pub struct PostParams<'a> {
    /// Programs are called `{name}-1`, `{name}-2`, …
    pub name: &'a str,
    /// Address per part, for the comments; a part beyond its end is called by its index.
    pub addresses: &'a [Address],
    /// Comment lines at the head of every program.
    pub header: &'a [String],
}

/// A program as text.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct PostedProgram {
    /// Board that it machines.
    pub board: u32,
    /// File name without extension.
    pub name: String,
    /// File name extension.
    pub extension: String,
    /// The text; its second line says whether the program has been proven.
    pub text: String,
}

impl PostedProgram {
    /// File name.
    #[must_use]
    pub fn file_name(&self) -> String {
        format!("{}.{}", self.name, self.extension)
    }

    /// Writes into the program's second line what is known of its proof; line numbers stay.
    pub fn set_status(&mut self, words: &Words, status: &str) {
        let line = comment(words, &format!("status: {status}"));
        let start = self.text.find('\n').map_or(self.text.len(), |n| n + 1);
        let end = self.text[start..].find('\n').map_or(self.text.len(), |n| start + n);
        self.text.replace_range(start..end, &line);
    }
}

/// A comment line's text, cut to what every control reads.
fn comment(words: &Words, text: &str) -> String {
    let clean: String = text
        .chars()
        .map(|c| match c {
            '(' => '[',
            ')' => ']',
            ' '..='~' => c,
            '°' => 'd',
            _ => '?',
        })
        .take(200)
        .collect();
    format!("{}{clean}{}", words.comment[0], words.comment[1])
}

/// Writes one program per board, in the order of `paths`. Rotary angles are chosen per operation so that all of it stays
/// within the limits without turning over, the nearest choice first. O(moves); boards in parallel.
///
/// # Errors
/// A position or orientation beyond the machine (line, part, axis, by how much), a missing tool, a turn at feed that
/// the machine would not follow evenly.
pub fn post(
    paths: &ToolPaths,
    machine: &Machine,
    words: &Words,
    params: &PostParams,
    go: &(dyn Fn() -> bool + Sync),
) -> Result<Vec<PostedProgram>, PostError> {
    let mut boards: Vec<Range<usize>> = Vec::new();
    for (k, op) in paths.operations.iter().enumerate() {
        match boards.last_mut() {
            Some(range) if paths.operations[range.start].board == op.board => range.end = k + 1,
            _ => boards.push(k..k + 1),
        }
    }
    let programs: Vec<_> =
        boards.into_par_iter().map(|range| Writer::new(paths, machine, words, params, range).program(go)).collect();
    // One after another, so that of several errors the first is told, whatever thread met it.
    programs.into_iter().collect()
}

/// Puts the paths of parts on their boards and writes one program per board, as [`post`] of [`place_boards`] does; with
/// the parts that are out of reach. A board's moves are written while they are at hand: those of all boards are never in
/// memory at once. O(p log p + moves); boards in parallel.
///
/// # Errors
/// As [`post`], of the first board that has one.
pub fn post_parts(
    (paths, layout): (&PartPaths, &Layout),
    machine: &Machine,
    words: &Words,
    params: &PostParams,
    go: &(dyn Fn() -> bool + Sync),
) -> (Result<Vec<PostedProgram>, PostError>, Vec<PathIssue>) {
    let write =
        |placed: &ToolPaths| Writer::new(placed, machine, words, params, 0..placed.operations.len()).program(go);
    let (programs, issues) = place_boards(paths, layout, machine, go, &write);
    (programs.into_iter().collect(), issues)
}

/// Writes the program of one board.
struct Writer<'a> {
    paths: &'a ToolPaths,
    machine: &'a Machine,
    words: &'a Words,
    params: &'a PostParams<'a>,
    operations: &'a [Operation],
    board: u32,
    name: String,
    text: String,
    line: u32,
    /// Last written values: X Y Z and the rotary axes in units of their last decimal, G word, feed.
    last: [Option<i64>; 5],
    last_rapid: Option<bool>,
    last_feed: Option<f64>,
    angles: [f64; 2],
    letters: [char; 5],
}

impl<'a> Writer<'a> {
    fn new(
        paths: &'a ToolPaths,
        machine: &'a Machine,
        words: &'a Words,
        params: &'a PostParams<'a>,
        range: Range<usize>,
    ) -> Self {
        let operations = &paths.operations[range];
        let board = operations.first().map_or(0, |op| op.board);
        let moves: usize = operations.iter().map(|op| op.moves.len()).sum();
        let l = &machine.linear;
        Self {
            paths,
            machine,
            words,
            params,
            operations,
            board,
            name: format!("{}-{}", params.name, board + 1),
            text: String::with_capacity(moves * 28 + operations.len() * 24 + 1024),
            line: 1,
            last: [None; 5],
            last_rapid: None,
            last_feed: None,
            angles: [0.0; 2],
            letters: [l[0].letter, l[1].letter, l[2].letter, machine.primary.letter, machine.secondary.letter],
        }
    }

    fn program(mut self, go: &(dyn Fn() -> bool + Sync)) -> Result<PostedProgram, PostError> {
        let opening = [self.name.clone(), "status: not proven".into(), format!("machine: {}", self.machine.name)];
        for line in opening.iter().chain(self.params.header) {
            self.put(&comment(self.words, line));
        }
        let safe = self.safe_word();
        for line in &self.words.program_start {
            self.put(&line.replace("{safe}", &safe));
        }
        let mut loaded = None;
        for op in self.operations {
            if !go() {
                return Err(PostError::Cancelled);
            }
            let Some(tool) = self.machine.tools.get(op.tool as usize) else {
                let count = self.machine.tools.len();
                return Err(PostError::NoTool { part: self.part(op), tool: op.tool, count });
            };
            if loaded != Some(op.tool) {
                self.change_tool(tool, &safe);
                loaded = Some(op.tool);
            }
            self.operation(op, tool)?;
        }
        for line in &self.words.program_end {
            self.put(&line.replace("{safe}", &safe));
        }
        let extension = self.words.extension.clone();
        Ok(PostedProgram { board: self.board, name: self.name, extension, text: self.text })
    }

    /// The safe height as a word's number: of the tip, or of a pivot that carries the longest tool upright.
    fn safe_word(&self) -> String {
        let longest = self.machine.tools.iter().map(|t| self.machine.reach_above_tip(t)).fold(0.0, f64::max);
        let height = (self.machine.safe_height + longest).min(self.machine.linear[2].max);
        let mut word = String::new();
        push_units(&mut word, to_units(height, self.words.length_decimals).unwrap_or(0), self.words.length_decimals);
        word
    }

    fn put(&mut self, line: &str) {
        self.text.push_str(line);
        self.text.push('\n');
        self.line += 1;
    }

    fn part(&self, op: &Operation) -> String {
        self.params.addresses.get(op.part as usize).map_or_else(|| format!("#{}", op.part), ToString::to_string)
    }

    fn change_tool(&mut self, tool: &Tool, safe: &str) {
        self.put(&comment(self.words, &format!("tool {}: {}", tool.number, tool.name)));
        let (number, speed) = (tool.number.to_string(), short(tool.speed));
        for line in &self.words.tool_change {
            self.put(&line.replace("{tool}", &number).replace("{speed}", &speed).replace("{safe}", safe));
        }
        // What the control remembers across a change differs between controls: say everything again.
        self.last = [None; 5];
        self.last_rapid = None;
        self.last_feed = None;
    }

    fn operation(&mut self, op: &Operation, tool: &Tool) -> Result<(), PostError> {
        let what = match op.purpose {
            Purpose::Fixing => "fixing",
            Purpose::Engraving => "engraving",
            Purpose::Drilling => "drilling",
            Purpose::Contour => "contour",
        };
        self.put(&comment(self.words, &format!("{} {what}", self.part(op))));
        let moves = op.moves.start as usize..op.moves.end as usize;
        let angles = self.choose_angles(op, moves.clone())?;
        for (k, angles) in moves.zip(angles) {
            let rapid = self.paths.kind[k] == MoveKind::Rapid;
            let pose = Pose { tip: self.paths.tip[k], axis: self.paths.axis[k] };
            self.motion(op, rapid, self.machine.programmed(pose, tool), angles, self.paths.feed[k])?;
            self.angles = angles;
        }
        Ok(())
    }

    /// Angles of every move of an operation. A choice at its start fixes the rest (a move at feed must not turn over),
    /// so the choices are tried in order of travel until one stays within the limits to the end.
    fn choose_angles(&self, op: &Operation, moves: Range<usize>) -> Result<Vec<[f64; 2]>, PostError> {
        let Some(first) = self.paths.axis.get(moves.start).copied() else { return Ok(Vec::new()) };
        let fail = |k: usize, source| PostError::Orientation {
            program: self.name.clone(),
            line: self.line + (k - moves.start) as u32,
            part: self.part(op),
            source,
        };
        let starts = self.machine.solutions(first, self.angles).map_err(|e| fail(moves.start, e))?;
        let mut refused = None;
        for start in starts {
            match self.follow(start, moves.clone()) {
                Ok(angles) => return Ok(angles),
                Err((k, Broken::Kinematics(e))) => refused = refused.or(Some(fail(k, e))),
                Err((k, Broken::Turn(by))) => {
                    let (program, line) = (self.name.clone(), self.line + (k - moves.start) as u32);
                    refused = refused.or(Some(PostError::Turn { program, line, part: self.part(op), by }));
                }
            }
        }
        Err(refused.unwrap_or_else(|| fail(moves.start, KinematicsError::NotADirection { axis: first.into() })))
    }

    fn follow(&self, start: [f64; 2], moves: Range<usize>) -> Result<Vec<[f64; 2]>, (usize, Broken)> {
        let mut angles = Vec::with_capacity(moves.len());
        let mut now = start;
        let mut axis = self.paths.axis[moves.start];
        for k in moves {
            let next_axis = self.paths.axis[k];
            if next_axis != axis {
                let next = self.machine.angles(next_axis, now).map_err(|e| (k, Broken::Kinematics(e)))?;
                if self.paths.kind[k] != MoveKind::Rapid {
                    let middle = self.machine.tool_axis([0.5 * (now[0] + next[0]), 0.5 * (now[1] + next[1])]);
                    let even = (axis + next_axis).normalize_or_zero();
                    let by = middle.cross(even).length().atan2(middle.dot(even));
                    if by > TURN_DEVIATION {
                        return Err((k, Broken::Turn(by.to_degrees())));
                    }
                }
                (now, axis) = (next, next_axis);
            }
            angles.push(now);
        }
        Ok(angles)
    }

    fn motion(
        &mut self,
        op: &Operation,
        rapid: bool,
        linear: DVec3,
        angles: [f64; 2],
        feed: f64,
    ) -> Result<(), PostError> {
        let values = [linear.x, linear.y, linear.z, angles[0].to_degrees(), angles[1].to_degrees()];
        let line_start = self.text.len();
        let bad =
            |value| PostError::NotANumber { program: self.name.clone(), line: self.line, part: self.part(op), value };
        let mut units = [0i64; 5];
        for (k, value) in values.iter().enumerate() {
            let decimals = if k < 3 { self.words.length_decimals } else { self.words.angle_decimals };
            units[k] = to_units(*value, decimals).ok_or_else(|| bad(*value))?;
            if let Some(axis) = self.machine.linear.get(k) {
                // Half a unit of the last decimal is lost in writing and must not count.
                let by = (axis.min - value).max(value - axis.max);
                if by > 0.5 * 0.1f64.powi(decimals as i32) {
                    let (program, part) = (self.name.clone(), self.part(op));
                    let (axis, min, max) = (axis.letter, axis.min, axis.max);
                    return Err(PostError::Limit { program, line: self.line, part, axis, value: *value, by, min, max });
                }
            }
        }
        let modal = self.words.modal;
        if modal && self.last == units.map(Some) {
            return Ok(());
        }
        if !modal || self.last_rapid != Some(rapid) {
            self.text.push_str(if rapid { &self.words.rapid } else { &self.words.feed });
            self.last_rapid = Some(rapid);
        }
        for (k, unit) in units.iter().enumerate() {
            if !modal || self.last[k] != Some(*unit) {
                let decimals = if k < 3 { self.words.length_decimals } else { self.words.angle_decimals };
                if self.text.len() > line_start {
                    self.text.push(' ');
                }
                self.text.push(self.letters[k]);
                push_units(&mut self.text, *unit, decimals);
            }
        }
        self.last = units.map(Some);
        if !rapid && (!modal || self.last_feed != Some(feed)) {
            if !(feed > 0.0 && feed < 1e9) {
                return Err(PostError::NotANumber {
                    program: self.name.clone(),
                    line: self.line,
                    part: self.part(op),
                    value: feed,
                });
            }
            self.text.push(' ');
            self.text.push_str(&self.words.feed_rate.replace("{feed}", &short(feed)));
            self.last_feed = Some(feed);
        }
        self.text.push('\n');
        self.line += 1;
        Ok(())
    }
}

/// Why a choice of angles cannot be followed through an operation.
enum Broken {
    Kinematics(KinematicsError),
    Turn(f64),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::post::{machine_preset, parse_program};
    use proptest::prelude::*;

    /// One operation per (tip, tilt, heading): rapid above, plunge, cut along x, lift.
    fn paths(places: &[(DVec3, f64, f64)]) -> ToolPaths {
        let mut paths = ToolPaths::default();
        for (part, (tip, tilt, heading)) in places.iter().enumerate() {
            let axis = DVec3::new(tilt.sin() * heading.cos(), tilt.sin() * heading.sin(), tilt.cos());
            let up = *tip + axis * ((60.0 - tip.z) / axis.z);
            let start = paths.tip.len() as u32;
            let far = DVec3::new(120.0, 0.0, 0.0);
            for (kind, tip, feed) in [
                (MoveKind::Rapid, up, 0.0),
                (MoveKind::Plunge, *tip, 1500.0),
                (MoveKind::Cut, *tip + far, 3000.0),
                (MoveKind::Lift, up + far, 4000.0),
            ] {
                paths.kind.push(kind);
                paths.tip.push(tip);
                paths.axis.push(axis);
                paths.feed.push(feed);
            }
            paths.operations.push(Operation {
                purpose: Purpose::Contour,
                board: part as u32 / 3,
                part: part as u32,
                tool: 5,
                moves: start..paths.tip.len() as u32,
            });
        }
        paths
    }

    fn params() -> PostParams<'static> {
        PostParams { name: "board", addresses: &[], header: &[] }
    }

    #[test]
    fn a_program_reads_as_a_person_expects() {
        let file = machine_preset("maka-mm7s").unwrap();
        let tilt = 20f64.to_radians();
        let ways = paths(&[(DVec3::new(100.0, 200.0, -5.0), tilt, 0.0)]);
        let mut programs = post(&ways, &file.machine, &file.words, &params(), &|| true).unwrap();
        programs[0].set_status(&file.words, "proven (all)");
        assert_eq!(programs[0].file_name(), "board-1.ngc");
        let expected = "(board-1)\n(status: proven [all])\n(machine: MAKA MM7s)\nG21 G90 G17 G40 G49 G80\nG54\nG0 Z60.000\n\
            (tool 10: Flat end mill 20)\nM5\nT10 M6\nS18000 M3\n(#0 contour)\n\
            G0 X123.658 Y200.000 Z60.000 A90.000 B20.000\nG1 X100.000 Z-5.000 F1500\nX220.000 F3000\n\
            X243.658 Z60.000 F4000\nG0 Z60.000\nM5\nM30\n";
        assert_eq!(programs[0].text, expected);
    }

    #[test]
    fn beyond_an_axis_is_an_error_that_says_by_how_much() {
        let file = machine_preset("maka-mm7s").unwrap();
        let ways = paths(&[(DVec3::new(1600.0, 200.0, 5.0), 0.0, 0.0)]);
        let error = post(&ways, &file.machine, &file.words, &params(), &|| true).unwrap_err();
        match &error {
            PostError::Limit { line: 14, axis: 'X', value, by, .. } => {
                assert_eq!((*value, *by), (1720.0, 70.0));
            }
            other => panic!("{other:?}"),
        }
        assert!(error.to_string().contains("70.000 mm beyond"), "{error}");
        let ways = paths(&[(DVec3::new(100.0, 200.0, 5.0), 2.5, 0.0)]);
        let error = post(&ways, &file.machine, &file.words, &params(), &|| true).unwrap_err();
        assert!(error.to_string().contains("axis B"), "{error}");
        let mut ways = paths(&[(DVec3::new(100.0, 200.0, 5.0), 0.1, 0.0)]);
        ways.tip[1].y = f64::NAN;
        assert!(matches!(
            post(&ways, &file.machine, &file.words, &params(), &|| true),
            Err(PostError::NotANumber { .. })
        ));
    }

    #[test]
    fn a_turn_over_at_feed_is_refused() {
        let file = machine_preset("maka-mm7s").unwrap();
        let mut ways = paths(&[(DVec3::new(100.0, 200.0, 5.0), 0.5, 0.0)]);
        ways.axis[2] = DVec3::new(-0.5f64.sin(), 0.01, 0.5f64.cos()).normalize();
        assert!(matches!(post(&ways, &file.machine, &file.words, &params(), &|| true), Err(PostError::Turn { .. })));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// Text → parser → forward kinematics gives back the poses, to the last decimal written.
        #[test]
        fn poses_return_from_the_text(
            places in proptest::collection::vec(
                ((100.0..1200.0f64, 100.0..2800.0f64, -10.0..20.0f64), 0.0..1.0f64, -3.2..3.2f64), 1..12),
            preset in 0..2usize, pivot in any::<bool>(),
        ) {
            let name = crate::post::machine_presets().nth(preset).unwrap();
            let mut file = machine_preset(name).unwrap();
            file.machine.tip_control = !pivot;
            let places: Vec<_> = places.iter().map(|((x, y, z), t, h)| (DVec3::new(*x, *y, *z), *t, *h)).collect();
            let ways = paths(&places);
            if pivot {
                file.machine.linear[0] = tenon_geometry::machine::Axis { letter: 'X', min: -1e3, max: 3e3 };
                file.machine.linear[1] = tenon_geometry::machine::Axis { letter: 'Y', min: -1e3, max: 5e3 };
            }
            let programs = post(&ways, &file.machine, &file.words, &params(), &|| true).unwrap();
            let mut k = 0;
            for program in &programs {
                let motions = parse_program(program.text.as_bytes(), &file.machine).unwrap();
                let tool = file.machine.tool(10).unwrap();
                let mut motions = motions.iter().filter(|m| m.tool == 10).peekable();
                while let Some(m) = motions.next() {
                    if m.rapid && motions.peek().is_none() { break; } // the closing G0 to the safe height
                    let pose = file.machine.pose(m.linear, m.angles, tool);
                    let slack = if pivot { 0.006 } else { 0.001 };
                    prop_assert!((pose.tip - ways.tip[k]).length() < slack, "{} {}", pose.tip, ways.tip[k]);
                    prop_assert!((pose.axis - ways.axis[k]).length() < 2e-5);
                    prop_assert_eq!(m.rapid, ways.kind[k] == MoveKind::Rapid);
                    k += 1;
                }
            }
            prop_assert_eq!(k, ways.tip.len());
        }
    }
}
