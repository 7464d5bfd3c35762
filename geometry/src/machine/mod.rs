//! Machines as geometry: kinematics, limits, tools, holders, spindle, table.

mod body;
mod check;
mod description;
mod kinematics;
#[cfg(test)]
mod sample;
pub use body::ToolBody;
pub use check::MachineError;
pub use description::{Axis, Clamp, Feeds, Machine, Revolved, Rotary, Table, Tool, ToolKind};
pub use kinematics::{KinematicsError, Pose};
#[cfg(test)]
pub(crate) use sample::test_machine;
