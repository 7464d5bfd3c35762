//! A growing run of moves.

use super::path::{MoveKind, Operation, Purpose, ToolPaths};
use glam::DVec3;

/// Writes moves with the axis that is set, into the columns of [`ToolPaths`].
#[derive(Debug, Default)]
pub(super) struct Trace {
    pub paths: ToolPaths,
    pub axis: DVec3,
}

impl Trace {
    /// One straight move to `tip`.
    pub fn go(&mut self, kind: MoveKind, tip: DVec3, feed: f64) {
        self.paths.kind.push(kind);
        self.paths.tip.push(tip);
        self.paths.axis.push(self.axis);
        self.paths.feed.push(feed);
    }

    /// Moves so far.
    pub fn len(&self) -> u32 {
        self.paths.tip.len() as u32
    }

    /// Forgets all moves from `len` on.
    pub fn truncate(&mut self, len: u32) {
        let len = len as usize;
        self.paths.kind.truncate(len);
        self.paths.tip.truncate(len);
        self.paths.axis.truncate(len);
        self.paths.feed.truncate(len);
    }

    /// Makes the moves since `from` an operation, or part of the one before if that has the same purpose and tool.
    pub fn close(&mut self, from: u32, purpose: Purpose, part: u32, tool: u32) {
        let to = self.len();
        if from == to {
            return;
        }
        match self.paths.operations.last_mut() {
            Some(last) if (last.purpose, last.part, last.tool, last.moves.end) == (purpose, part, tool, from) => {
                last.moves.end = to;
            }
            _ => self.paths.operations.push(Operation { purpose, board: 0, part, tool, moves: from..to }),
        }
    }
}
