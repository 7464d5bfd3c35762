//! Nodes for tool motion.

mod post;
mod toolpath;

use crate::value::with_address;
use tenon_engine::{Fail, NodeType};
use tenon_geometry::board::PartSet;
use tenon_geometry::motion::{PathError, PathIssue};

pub(crate) fn nodes() -> Vec<NodeType> {
    vec![toolpath::node(), post::node()]
}

/// What cannot be made on one part, in the words of a diagnostic.
pub(crate) fn issue_fail(parts: &PartSet, issue: &PathIssue) -> Fail {
    fail(&issue.error, with_address(&parts.panels, issue.part, issue)).item(issue.part as usize)
}

/// A path error in the words of a diagnostic.
pub(crate) fn path_fail(error: &PathError) -> Fail {
    fail(error, error.to_string())
}

fn fail(error: &PathError, message: String) -> Fail {
    let (code, port) = match error {
        PathError::Cancelled => return Fail::cancelled(),
        PathError::Parameter { .. } => ("out-of-range", "machining"),
        PathError::NoTool { .. } => ("no-such-tool", "machine"),
        PathError::Flat { .. } => ("chamfer-too-flat", "parts"),
        PathError::TooDeep { .. } | PathError::HoleTooDeep { .. } => ("below-sacrificial-layer", "machine"),
        PathError::TooShort { .. } => ("tool-too-short", "machine"),
        PathError::TooLong { .. } => ("tool-too-long", "machine"),
        PathError::Holder { .. } => ("holder-in-board", "machine"),
        PathError::FromBelow { .. } => ("feature-out-of-reach", "parts"),
        PathError::Travel { .. } => ("axis-limit", "machine"),
        PathError::SafeHeight { .. } => ("safe-height", "machine"),
        PathError::NoOperation { .. } => ("no-operation", "parts"),
        PathError::NotFinite => ("not-finite", "parts"),
        _ => ("axis-limit", "machine"),
    };
    Fail::new(code, message).port(port)
}
