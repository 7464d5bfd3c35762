//! Machines as geometry: kinematics, limits, tools, holders, spindle, table.

mod description;
pub use description::{Axis, Clamp, Feeds, Machine, Revolved, Rotary, Table, Tool, ToolKind};
