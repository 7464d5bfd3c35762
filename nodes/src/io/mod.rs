//! Files of other programs: bytes to geometry and back. Pure functions; reading and writing files is the host's work.
//!
//! Text that is written is the same for the same input: fixed decimals in drawings and tables, shortest round-trip
//! numbers in OBJ and JSON, no time stamps.

mod blocks;
pub mod drawing;
pub mod dxf;
#[cfg(test)]
mod fixture;
pub mod layout_json;
mod lines;
pub mod obj;
pub mod pieces;
pub mod svg;

pub use blocks::Blocks;
pub use drawing::{Drawing, DrawingError, draw};
pub use dxf::write_dxf;
pub use layout_json::write_layout_json;
pub use obj::{ObjError, read_obj, write_obj, write_panels_obj};
pub use pieces::{write_hardware_csv, write_pieces_csv, write_pieces_json};
pub use svg::write_svg;
