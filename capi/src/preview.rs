//! Outputs as triangle, line and point buffers.

use crate::error::{Failure, guard, tenon_error};
use crate::handle;
use crate::read;
use crate::result::tenon_result;
use std::ffi::c_char;
use tenon_nodes::exchange::{self, Preview};
use tenon_plugin::abi::value::{TENON_NONE, tenon_address, tenon_str, tenon_vec3};

/// What can be picked: a panel, a face, a curve or a point, and where it stands in the output.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct tenon_part {
    /// Item in its branch.
    pub item: u64,
    /// Branch of the output's tree.
    pub branch: u32,
    /// Panel or face in the item; 0 for what has none.
    pub element: u32,
    /// Its address; `TENON_NONE` three times for what has none.
    pub address: tenon_address,
    /// 0.
    pub flags: u32,
}

/// An output as buffers for a viewport. Good until the result is freed; read-only. Faces have vertices of their own, so
/// that their edges stay sharp; triangles are counter-clockwise seen from outside.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct tenon_preview {
    /// Bytes of this struct; set it before the call.
    pub size: u32,
    /// 0.
    pub flags: u32,
    /// The node that made the output.
    pub node: tenon_str,
    /// Its port.
    pub port: tenon_str,
    /// Add it to a position to get the place in space, mm. Positions are about it, so that single precision is enough.
    pub origin: tenon_vec3,
    /// Smallest coordinates in space, mm.
    pub low: tenon_vec3,
    /// Largest coordinates in space, mm.
    pub high: tenon_vec3,
    /// Three per vertex: x, y, z about the origin, mm.
    pub positions: *const f32,
    /// Three per vertex: unit normal; 0 for vertices of lines and points.
    pub normals: *const f32,
    /// One per vertex: its part.
    pub vertex_parts: *const u32,
    /// Number of vertices.
    pub vertex_count: u64,
    /// Three vertices per triangle.
    pub triangles: *const u32,
    /// Number of triangles.
    pub triangle_count: u64,
    /// Two vertices per line.
    pub lines: *const u32,
    /// Number of lines.
    pub line_count: u64,
    /// One vertex per point.
    pub points: *const u32,
    /// Number of points.
    pub point_count: u64,
    /// What can be picked.
    pub parts: *const tenon_part,
    /// Number of parts.
    pub part_count: u64,
}

// SAFETY: plain data, size first.
unsafe impl read::Sized32 for tenon_preview {}

/// A preview as it lies in memory until its result goes.
pub(crate) struct Drawn {
    preview: Preview,
    parts: Vec<tenon_part>,
}

fn some<T, U>(items: &[T]) -> *const U {
    if items.is_empty() { std::ptr::null() } else { items.as_ptr().cast() }
}

impl Drawn {
    fn new(preview: Preview) -> Self {
        let none = tenon_address { patch: TENON_NONE, row: TENON_NONE, column: TENON_NONE };
        let part = |p: &exchange::Part| tenon_part {
            item: p.item,
            branch: p.branch,
            element: p.element,
            address: p.address.map_or(none, |a| tenon_address { patch: a.patch, row: a.row, column: a.column }),
            flags: 0,
        };
        Self { parts: preview.parts.iter().map(part).collect(), preview }
    }

    fn view(&self, source: &'_ str) -> tenon_preview {
        let p = &self.preview;
        let vec = |[x, y, z]: [f64; 3]| tenon_vec3 { x, y, z };
        let (node, port) = source.rsplit_once('.').unwrap_or((source, ""));
        tenon_preview {
            size: 0,
            flags: 0,
            node: tenon_str::of(node),
            port: tenon_str::of(port),
            origin: vec(p.origin.to_array()),
            low: vec(p.bounds[0].to_array()),
            high: vec(p.bounds[1].to_array()),
            positions: some(&p.positions),
            normals: some(&p.normals),
            vertex_parts: some(&p.vertex_parts),
            vertex_count: p.positions.len() as u64,
            triangles: some(&p.triangles),
            triangle_count: p.triangles.len() as u64,
            lines: some(&p.lines),
            line_count: p.lines.len() as u64,
            points: some(&p.points),
            point_count: p.points.len() as u64,
            parts: some(&self.parts),
            part_count: self.parts.len() as u64,
        }
    }
}

/// Fills `out` with what an output looks like: panels as solids, meshes, polygons, curves and points; of other types
/// there is nothing to see, which is no error. Made at the first call for an output and kept with the result. Set
/// `out->size` before. Fails if there is no such output. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_result_preview(
    result: *const tenon_result,
    name: *const c_char,
    out: *mut tenon_preview,
) -> *mut tenon_error {
    guard(|| {
        let result = handle::result(result)?;
        // SAFETY: the header asks for a NUL-terminated string.
        let name = unsafe { read::text(name, "name")? };
        let output = result.output(name)?;
        let drawn = output.preview.get_or_init(|| Drawn::new(exchange::preview(&output.tree)));
        if drawn.preview.positions.len() > u32::MAX as usize {
            return Err(Failure::argument(format!("{name} has more vertices than 32 bits can number")));
        }
        // SAFETY: the header asks for a struct whose size is set.
        unsafe { read::fill(out, drawn.view(&output.source), "out") }
    })
}
