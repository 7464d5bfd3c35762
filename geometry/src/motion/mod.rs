//! Tool motion: paths for fixing holes, engraving, drilling and chamfer contours.

mod body;
mod contour;
mod drill;
mod engrave;
pub mod glyph;
mod path;
mod reach;
mod toolpath;
mod trace;

#[cfg(test)]
mod laws;

pub use body::{Envelope, flat_radius};
pub use contour::Contour;
pub use path::{MoveKind, Operation, Purpose, ToolPaths};
pub use reach::{PathError, PathIssue, PathParams, Place};
pub use toolpath::{PartPaths, cut_parts, place_boards, place_paths};
