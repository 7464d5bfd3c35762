//! Boards: mapping parts to the machine plane, outlines, packing.

pub mod convex;
mod facet;
mod map;
mod marks;
mod outline;
mod pack;
mod part;
mod row;
#[cfg(test)]
pub(crate) mod testing;

pub use facet::{Facet, FacetName, facets, piece_outline};
pub use map::{Align, GrainAxis, MapIssue, MapParams, map_parts};
pub use marks::{AddressMark, FixingHoles, MarkIssue};
pub use outline::cleared_outlines;
pub use pack::{Bounds, Goods, Grain, LayoutFault, PackError, Packed, Packer, check_layout};
pub use part::{Board, Layout, PartSet, Placement, Up};
pub use row::RowPacker;
