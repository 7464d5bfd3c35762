//! Values as they cross the boundary: trees of typed columns, all arrays by pointer and length. From this file
//! `include/tenon_value.h` is generated.

use bytemuck::{Pod, Zeroable};
use std::ffi::{c_char, c_void};

/// UTF-8 text of `len` bytes, not NUL-terminated. `ptr` may be NULL when `len` is 0.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_str {
    /// First byte.
    pub ptr: *const c_char,
    /// Number of bytes.
    pub len: u64,
}

/// What a function came to: `TENON_OK`, `TENON_CANCELLED` or an error, which is negative.
pub type tenon_status = i32;
/// All is well.
pub const TENON_OK: tenon_status = 0;
/// It stopped because it was asked to.
pub const TENON_CANCELLED: tenon_status = 1;
/// An argument is NULL, misaligned, out of range or not UTF-8.
pub const TENON_BAD_ARGUMENT: tenon_status = -1;
/// A value is not of the type that stands here.
pub const TENON_BAD_TYPE: tenon_status = -2;
/// The computation failed; diagnostics say why.
pub const TENON_FAILED: tenon_status = -3;
/// No memory.
pub const TENON_NO_MEMORY: tenon_status = -4;
/// This version does not do that.
pub const TENON_UNSUPPORTED: tenon_status = -5;
/// A fault of the program itself, such as a panic that was caught.
pub const TENON_INTERNAL: tenon_status = -6;

/// How bad a diagnostic is.
pub type tenon_severity = u32;
/// Worth knowing.
pub const TENON_NOTE: tenon_severity = 0;
/// The result stands but may not be what was meant.
pub const TENON_WARNING: tenon_severity = 1;
/// Something is missing from the result.
pub const TENON_ERROR: tenon_severity = 2;

/// What the items of a column are; each constant names the C type of one item.
pub type tenon_kind = u32;
/// No items, so no type.
pub const TENON_NOTHING: tenon_kind = 0;
/// `uint8_t`, 0 or 1.
pub const TENON_BOOLEAN: tenon_kind = 1;
/// `int64_t`.
pub const TENON_INTEGER: tenon_kind = 2;
/// `double`.
pub const TENON_NUMBER: tenon_kind = 3;
/// `tenon_str`.
pub const TENON_TEXT: tenon_kind = 4;
/// `tenon_vec3`, mm.
pub const TENON_POINT: tenon_kind = 5;
/// `tenon_vec3`.
pub const TENON_VECTOR: tenon_kind = 6;
/// `tenon_plane`.
pub const TENON_PLANE: tenon_kind = 7;
/// `tenon_curve`.
pub const TENON_CURVE: tenon_kind = 8;
/// `tenon_mesh`.
pub const TENON_MESH: tenon_kind = 9;
/// `tenon_panels`.
pub const TENON_PANELS: tenon_kind = 10;
/// `tenon_features`.
pub const TENON_FEATURES: tenon_kind = 11;
/// `tenon_file`.
pub const TENON_FILE: tenon_kind = 12;
/// `tenon_edge_pair`: edges selected for a fastener.
pub const TENON_EDGES: tenon_kind = 13;
/// `tenon_table`. Since 1.1.
pub const TENON_TABLE: tenon_kind = 14;
/// A type that does not cross: `items` is NULL, `type_name` says what it is.
pub const TENON_OPAQUE: tenon_kind = 0x10000;

/// No panel, edge or joint.
pub const TENON_NONE: u32 = 0xFFFF_FFFF;

/// Three coordinates, mm where they are lengths.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct tenon_vec3 {
    /// X.
    pub x: f64,
    /// Y.
    pub y: f64,
    /// Z.
    pub z: f64,
}

/// A homogeneous point: the place in space is (x / w, y / w, z / w), w > 0. Plain polylines have w = 1.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct tenon_vec4 {
    /// W times X.
    pub x: f64,
    /// W times Y.
    pub y: f64,
    /// W times Z.
    pub z: f64,
    /// Weight.
    pub w: f64,
}

/// An oriented plane, `normal . p = offset`; `normal` has length 1.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Pod, Zeroable)]
pub struct tenon_plane {
    /// Unit normal.
    pub normal: tenon_vec3,
    /// Signed distance of the origin's foot point along the normal, mm.
    pub offset: f64,
}

/// Where a face or panel stands: row from the bottom, column from the left, both from 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct tenon_address {
    /// Grid patch, 0 on a plain grid.
    pub patch: u32,
    /// Row.
    pub row: u32,
    /// Column.
    pub column: u32,
}

/// One edge of one panel; both are `TENON_NONE` where there is none.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct tenon_edge {
    /// Panel index.
    pub panel: u32,
    /// Edge index in the panel, from 0.
    pub edge: u32,
}

/// A curve: one polyline, or several strips.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_curve {
    /// Bytes of this struct as its maker knows it.
    pub size: u32,
    /// 1 if the last point is joined to the first (then there is one strip).
    pub closed: u32,
    /// Points of all strips in drawing order.
    pub points: *const tenon_vec4,
    /// Number of points.
    pub point_count: u64,
    /// First point of each strip, then `point_count`: `strip_count + 1` entries. NULL means one strip.
    pub strip_start: *const u32,
    /// Number of strips.
    pub strip_count: u64,
}

/// A polygon mesh; loops are counter-clockwise seen from the front.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_mesh {
    /// Bytes of this struct as its maker knows it.
    pub size: u32,
    /// 0.
    pub flags: u32,
    /// Vertices, mm.
    pub points: *const tenon_vec3,
    /// Number of vertices.
    pub point_count: u64,
    /// Where each face's loop starts in `face_vertices`, then its end: `face_count + 1` entries.
    pub face_start: *const u32,
    /// Number of faces.
    pub face_count: u64,
    /// Vertex indices of all loops.
    pub face_vertices: *const u32,
    /// Number of entries in `face_vertices`.
    pub face_vertex_count: u64,
    /// One per face; NULL if the mesh is not ordered.
    pub addresses: *const tenon_address,
}

/// The grid side of an edge: `TENON_SIDE_*`.
pub type tenon_side = u8;
/// Towards the row below.
pub const TENON_SIDE_BOTTOM: tenon_side = 0;
/// Towards the next column.
pub const TENON_SIDE_RIGHT: tenon_side = 1;
/// Towards the row above.
pub const TENON_SIDE_TOP: tenon_side = 2;
/// Towards the column before.
pub const TENON_SIDE_LEFT: tenon_side = 3;
/// The mesh is no grid.
pub const TENON_SIDE_OTHER: tenon_side = 4;

/// Panels as columns. Per-corner columns, equally per-edge ones, are indexed by `corner_start[panel] + k`: edge k runs
/// from corner k to corner k + 1. A panel that could not be made has no corners and stays at its index.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_panels {
    /// Bytes of this struct as its maker knows it.
    pub size: u32,
    /// 0.
    pub flags: u32,
    /// Thickness of every panel, mm.
    pub thickness: f64,
    /// Number of panels, failed ones included.
    pub panel_count: u64,
    /// Number of corners of all panels.
    pub corner_count: u64,
    /// First corner of each panel, then `corner_count`: `panel_count + 1` entries.
    pub corner_start: *const u32,
    /// Per panel.
    pub address: *const tenon_address,
    /// Per panel: unit normal of the front face, away from the wood.
    pub normal: *const tenon_vec3,
    /// Per corner: on the front face, counter-clockwise seen from the front, mm.
    pub front: *const tenon_vec3,
    /// Per corner: its vertex in the mesh.
    pub vertex: *const u32,
    /// Per edge: its chamfer's plane, normal away from the wood.
    pub chamfer: *const tenon_plane,
    /// Per edge: the edge across it, or `TENON_NONE` at the border and beside failed panels.
    pub neighbour: *const tenon_edge,
    /// Per edge: `TENON_SIDE_*`.
    pub side: *const u8,
    /// Per edge: where it starts on the back face, mm.
    pub back_start: *const tenon_vec3,
    /// Per edge: where it ends on the back face, mm.
    pub back_end: *const tenon_vec3,
    /// Per corner: 1 if the node is voided there.
    pub voided: *const u8,
}

/// What a feature is: `TENON_DRILL` and so on.
pub type tenon_machining = u32;
/// A round hole: `at` its entry, `axis`, `depth`, `width` its diameter.
pub const TENON_DRILL: tenon_machining = 0;
/// A slot of rectangular section: floor line `at` to `to`, `axis`, `width`, `depth`.
pub const TENON_SLOT: tenon_machining = 1;
/// A pocket with flat floor: outline `line` on the surface, counter-clockwise seen against `axis`; `depth`.
pub const TENON_POCKET: tenon_machining = 2;
/// A cut through along the polyline `line` on the surface; `axis`.
pub const TENON_CONTOUR: tenon_machining = 3;
/// `text` in single strokes: `at` lower left, `to` unit reading direction, `axis`, `width` glyph height, `depth`.
pub const TENON_ENGRAVING: tenon_machining = 4;

/// One machining feature on one panel, in the coordinates of the panels. What a kind does not name is 0, NULL or empty.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_feature {
    /// Bytes of this struct as its maker knows it.
    pub size: u32,
    /// `TENON_DRILL` and so on.
    pub kind: tenon_machining,
    /// Panel index.
    pub panel: u32,
    /// Edge that it belongs to, or `TENON_NONE`.
    pub edge: u32,
    /// Number shared by the features that must meet in space, or `TENON_NONE`.
    pub joint: u32,
    /// 1: it is made by hand, because the machine cannot.
    pub by_hand: u32,
    /// Entry, start or origin, mm.
    pub at: tenon_vec3,
    /// End of a slot, mm; reading direction of an engraving.
    pub to: tenon_vec3,
    /// Unit direction into the wood.
    pub axis: tenon_vec3,
    /// Depth along `axis`, mm.
    pub depth: f64,
    /// Diameter, width or glyph height, mm.
    pub width: f64,
    /// Outline or line, mm.
    pub line: *const tenon_vec3,
    /// Points of `line`.
    pub line_count: u64,
    /// Text of an engraving.
    pub text: tenon_str,
    /// What it is for, in a few words: "toe screw", "hinge".
    pub purpose: tenon_str,
}

/// Purchased parts by name.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_hardware {
    /// Trade name with size, as on the piece list.
    pub name: tenon_str,
    /// How many.
    pub count: u64,
}

/// Features of a panel set, ordered by panel, and the hardware that they take.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_features {
    /// Bytes of this struct as its maker knows it.
    pub size: u32,
    /// Bytes from one feature to the next.
    pub feature_stride: u32,
    /// Features.
    pub features: *const tenon_feature,
    /// Number of features.
    pub feature_count: u64,
    /// Hardware.
    pub hardware: *const tenon_hardware,
    /// Number of entries in `hardware`.
    pub hardware_count: u64,
}

/// A file that the graph made and that the host may write.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_file {
    /// Name relative to an output folder.
    pub name: tenon_str,
    /// Content.
    pub bytes: *const u8,
    /// Number of bytes.
    pub byte_count: u64,
    /// Why it must not get its name unless a person insists; empty: it may.
    pub withheld: tenon_str,
}

/// An edge that a fastener is asked to join, seen from the panel that comes first (it holds a screw's head).
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct tenon_edge_pair {
    /// The first panel's edge.
    pub first: tenon_edge,
    /// The second panel's edge; `TENON_NONE` at the border.
    pub second: tenon_edge,
    /// Where the edge starts on the first panel's front face, mm.
    pub start: tenon_vec3,
    /// Where it ends.
    pub end: tenon_vec3,
    /// Angle between the two panels' wood, radians; pi where they lie in one plane, 0 at the border.
    pub angle: f64,
}

/// Items of one type. Gaps, which items that failed upstream leave, keep their index.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_column {
    /// Bytes of this struct as its maker knows it.
    pub size: u32,
    /// `TENON_NUMBER` and so on.
    pub kind: tenon_kind,
    /// Name of the type in graph files.
    pub type_name: tenon_str,
    /// The items, `stride` bytes apart; NULL if there are none or the kind is `TENON_OPAQUE`. What stands in a gap means
    /// nothing, but lengths and pointers in it must be good.
    pub items: *const c_void,
    /// Number of items, gaps included.
    pub count: u64,
    /// Bytes from one item to the next.
    pub stride: u64,
    /// Per item 1, or 0 for a gap; NULL if there are no gaps.
    pub valid: *const u8,
}

/// One attribute of every row of a table.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_attribute {
    /// Its name, once in a table.
    pub name: tenon_str,
    /// One item per row: of a kind up to `TENON_PLANE`, or `TENON_OPAQUE`.
    pub column: tenon_column,
}

/// A table of attributes: columns of as many rows, each under a name. Since 1.1.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_table {
    /// Bytes of this struct as its maker knows it.
    pub size: u32,
    /// Bytes from one attribute to the next.
    pub attribute_stride: u32,
    /// Number of rows.
    pub row_count: u64,
    /// Attributes.
    pub attributes: *const tenon_attribute,
    /// Number of attributes.
    pub attribute_count: u64,
}

/// A column and where it hangs in its tree.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_branch {
    /// Its path; NULL means {0}.
    pub path: *const i32,
    /// Steps of the path.
    pub path_count: u64,
    /// Its items.
    pub column: tenon_column,
}

/// What flows on a wire: branches sorted by path. A single item is one branch of one item. Trees lie side by side, so
/// that this struct alone never grows, though its branches may.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_tree {
    /// Bytes of this struct as its maker knows it.
    pub size: u32,
    /// Bytes from one branch to the next.
    pub branch_stride: u32,
    /// Branches.
    pub branches: *const tenon_branch,
    /// Number of branches.
    pub branch_count: u64,
}

impl tenon_str {
    /// A view of `text`, valid as long as it.
    #[must_use]
    pub const fn of(text: &str) -> Self {
        Self { ptr: text.as_ptr().cast(), len: text.len() as u64 }
    }
}
