//! Why tool paths cannot be posted: line, part, axis and by how much.

use tenon_geometry::machine::KinematicsError;

/// Why tool paths cannot be posted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PostError {
    /// A position beyond a linear axis.
    #[error(
        "{program}, line {line}: part {part} needs {axis} {value:.3} mm, {by:.3} mm beyond the axis ({min} … {max} mm)"
    )]
    Limit {
        /// Program name.
        program: String,
        /// Line that the word would stand on.
        line: u32,
        /// Address of the part.
        part: String,
        /// Axis letter.
        axis: char,
        /// Value needed, mm.
        value: f64,
        /// How far beyond the limit, mm.
        by: f64,
        /// Least value, mm.
        min: f64,
        /// Greatest value, mm.
        max: f64,
    },
    /// An orientation that the head cannot take.
    #[error("{program}, line {line}: part {part}: {source}")]
    Orientation {
        /// Program name.
        program: String,
        /// Line that the words would stand on.
        line: u32,
        /// Address of the part.
        part: String,
        /// What the head says.
        source: KinematicsError,
    },
    /// A turn at feed that the two rotary axes do not follow evenly.
    #[error(
        "{program}, line {line}: part {part}: the tool axis turns at feed and would leave its path by {by:.3}°; divide the move"
    )]
    Turn {
        /// Program name.
        program: String,
        /// Line that the words would stand on.
        line: u32,
        /// Address of the part.
        part: String,
        /// Deviation half way, degrees.
        by: f64,
    },
    /// A tool that the machine does not have.
    #[error("part {part} is machined with tool index {tool}, but the machine has {count} tools")]
    NoTool {
        /// Address of the part.
        part: String,
        /// Index asked for.
        tool: u32,
        /// How many tools there are.
        count: usize,
    },
    /// A coordinate or feed that is not finite, or out of all proportion.
    #[error("{program}, line {line}: part {part}: {value} cannot be written")]
    NotANumber {
        /// Program name.
        program: String,
        /// Line that it would stand on.
        line: u32,
        /// Address of the part.
        part: String,
        /// The value.
        value: f64,
    },
    /// The caller asked to stop.
    #[error("cancelled")]
    Cancelled,
}
