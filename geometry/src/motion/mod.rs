//! Tool motion: paths for fixing holes, engraving, drilling and chamfer contours.

mod path;
pub use path::{MoveKind, Operation, Purpose, ToolPaths};
