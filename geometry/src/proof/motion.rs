//! A program as a control would run it: straight motions in programmed coordinates, each with its line in the text.

use glam::DVec3;

/// One straight motion of all axes together, from where the motion before ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Line in the program text, from 1.
    pub line: u32,
    /// At full speed (G0) instead of at feed (G1).
    pub rapid: bool,
    /// Number of the tool in the spindle, 0 for none.
    pub tool: u32,
    /// Spindle speed, 1/min; 0 while it stands still.
    pub speed: f64,
    /// Feed, mm/min; 0 for a rapid.
    pub feed: f64,
    /// Programmed X, Y, Z at the end, mm.
    pub linear: DVec3,
    /// Programmed angles of the primary and secondary axis at the end, radians.
    pub angles: [f64; 2],
}

/// A program for one board, read back from its text.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// Name for people, such as the file's.
    pub name: String,
    /// Board of the layout that it machines.
    pub board: u32,
    /// Its motions. The first one comes from an unknown place.
    pub motions: Vec<Motion>,
    /// Line and problem, if the text is not a program; it has no motions then.
    pub refused: Option<(u32, String)>,
}
