//! Inputs and the call as other hosts lay them out: as read-only memory, with the structs of the oldest version and nothing
//! behind them, and with structs that have grown at their ends. A plugin that goes from one struct to the next by its own
//! `sizeof` and not by the stride that it is told, or that takes for granted what only later versions have, reads rubbish.

use super::pages::{Behind, Pages, Touched};
use crate::abi::plugin::tenon_call;
use crate::abi::value::*;

/// Who gives the inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) enum Host {
    /// This program, as in every evaluation.
    #[default]
    Ours,
    /// One that lends memory that cannot be written to.
    ReadOnly,
    /// The oldest: its structs are as large as in the version that brought them, and nothing behind them can be read.
    Older,
    /// One of a later version: its structs have grown at their ends.
    Newer,
}

/// By how much every struct of a newer host has grown, bytes, and what stands there.
const MORE: usize = 16;
const RUBBISH: u64 = 0xA5A5_A5A5_A5A5_A5A5;

/// A struct that may grow.
trait Grows {
    /// Its bytes in the version that brought it.
    const FIRST: usize;
}

macro_rules! grows {
    ($($name:ident $bytes:literal),*) => {
        $(impl Grows for $name {
            const FIRST: usize = $bytes;
        })*
        #[cfg(test)]
        const FIRST: &[(&str, usize)] = &[$((stringify!($name), $bytes)),*];
    };
}

grows! {
    tenon_call 64, tenon_branch 72, tenon_column 56, tenon_curve 40, tenon_mesh 64, tenon_panels 120, tenon_features 40,
    tenon_feature 160, tenon_table 32, tenon_attribute 72
}

/// What another host gives.
pub(super) struct Laid {
    host: Host,
    pages: Pages,
    trees: *const tenon_tree,
}

impl Laid {
    /// Inputs as `host` lays them out. O(bytes).
    ///
    /// # Safety
    /// The trees are views whose pointers and counts are right.
    pub unsafe fn new(host: Host, trees: &[tenon_tree]) -> Self {
        let behind = if host == Host::Older { Behind::Nothing } else { Behind::Zeros };
        let mut laid = Self { host, pages: Pages::new(behind), trees: std::ptr::null() };
        // SAFETY: as the caller vouches.
        laid.trees = unsafe { laid.all(trees.as_ptr(), trees.len() as u64, |laid, tree| laid.tree(tree)) };
        laid
    }

    /// Where the inputs are; good as long as this.
    pub fn trees(&self) -> *const tenon_tree {
        self.trees
    }

    /// The call as this host lays it out. It is never freed, as this program's own calls are not: a plugin that calls back
    /// too late meets a closed gate.
    pub fn call(&mut self, call: &'static tenon_call) -> *const tenon_call {
        if self.host == Host::ReadOnly {
            return call;
        }
        let size = self.size::<tenon_call>();
        let mut copy = vec![RUBBISH; size.div_ceil(8)];
        let at = copy.as_mut_ptr().cast::<u8>();
        // SAFETY: there is room for as much, and the size comes first.
        unsafe {
            at.copy_from_nonoverlapping(std::ptr::from_ref(call).cast(), size.min(size_of::<tenon_call>()));
            at.cast::<u32>().write(size as u32);
            self.pages.keep(at, size).cast()
        }
    }

    /// What the plugin did with what it was lent.
    pub fn touched(&self) -> Touched {
        self.pages.touched()
    }

    /// Bytes of a struct as this host knows it.
    fn size<T: Grows>(&self) -> usize {
        match self.host {
            Host::Ours | Host::ReadOnly => size_of::<T>(),
            Host::Older => T::FIRST,
            Host::Newer => size_of::<T>() + MORE,
        }
    }

    /// An array as it is.
    ///
    /// # Safety
    /// There are so many items.
    unsafe fn array<T: Copy>(&mut self, items: *const T, count: u64) -> *const T {
        // SAFETY: as the caller vouches.
        unsafe { self.bytes(items.cast(), count as usize * size_of::<T>()).cast() }
    }

    /// # Safety
    /// There are so many bytes.
    unsafe fn bytes(&mut self, from: *const u8, count: usize) -> *const u8 {
        // SAFETY: as the caller vouches.
        if count == 0 || from.is_null() { from } else { unsafe { self.pages.lend(from, count) } }
    }

    /// Structs that never grow, each made anew by `lay`.
    ///
    /// # Safety
    /// There are so many items.
    unsafe fn all<T: Copy>(&mut self, items: *const T, count: u64, lay: impl Fn(&mut Self, T) -> T) -> *const T {
        // SAFETY: as the caller vouches.
        let copy: Vec<T> = (0..count as usize).map(|i| lay(self, unsafe { *items.add(i) })).collect();
        // SAFETY: as many as were copied.
        unsafe { self.array(copy.as_ptr(), count) }
    }

    /// Structs that may grow, each made anew by `lay` and as large as this host knows it.
    ///
    /// # Safety
    /// There are so many items.
    unsafe fn grown<T: Grows + Copy>(
        &mut self,
        items: *const T,
        count: u64,
        lay: impl Fn(&mut Self, T) -> T,
    ) -> *const T {
        let (size, count) = (self.size::<T>(), count as usize);
        let mut copy = vec![RUBBISH; (size * count).div_ceil(8)];
        for i in 0..count {
            // SAFETY: as the caller vouches; the copy has `size` bytes for each.
            unsafe {
                let item = lay(self, *items.add(i));
                let to = copy.as_mut_ptr().cast::<u8>().add(i * size);
                to.copy_from_nonoverlapping((&raw const item).cast(), size.min(size_of::<T>()));
            }
        }
        // SAFETY: as many as were copied.
        unsafe { self.bytes(copy.as_ptr().cast(), size * count).cast() }
    }
}

// SAFETY of all functions below: they are given parts of views whose pointers and counts are right.
impl Laid {
    fn text(&mut self, t: tenon_str) -> tenon_str {
        // SAFETY: see above.
        unsafe { tenon_str { ptr: self.array(t.ptr, t.len), len: t.len } }
    }

    fn tree(&mut self, t: tenon_tree) -> tenon_tree {
        let lay = |laid: &mut Self, b: tenon_branch| tenon_branch {
            // SAFETY: see above.
            path: unsafe { laid.array(b.path, b.path_count) },
            column: laid.column(b.column),
            ..b
        };
        // SAFETY: see above.
        let branches = unsafe { self.grown(t.branches, t.branch_count, lay) };
        tenon_tree { branch_stride: self.size::<tenon_branch>() as u32, branches, ..t }
    }

    fn column(&mut self, c: tenon_column) -> tenon_column {
        // SAFETY: see above.
        let (items, stride) = unsafe {
            match c.kind {
                TENON_CURVE => self.structs(c, Self::curve),
                TENON_MESH => self.structs(c, Self::mesh),
                TENON_PANELS => self.structs(c, Self::panels),
                TENON_FEATURES => self.structs(c, Self::features),
                TENON_TABLE => self.structs(c, Self::table),
                TENON_TEXT => (self.all(c.items.cast(), c.count, Self::text).cast(), c.stride),
                // Their layout is fixed for ever.
                _ => (self.bytes(c.items.cast(), (c.count * c.stride) as usize).cast(), c.stride),
            }
        };
        let (size, type_name) = (self.size::<tenon_column>() as u32, self.text(c.type_name));
        // SAFETY: see above.
        let valid = if c.valid.is_null() { c.valid } else { unsafe { self.array(c.valid, c.count) } };
        tenon_column { size, type_name, items, stride, valid, ..c }
    }

    /// Items that may grow, and how far they lie apart.
    ///
    /// # Safety
    /// They are of the column's kind.
    unsafe fn structs<T: Grows + Copy>(
        &mut self,
        c: tenon_column,
        lay: impl Fn(&mut Self, T) -> T,
    ) -> (*const std::ffi::c_void, u64) {
        // SAFETY: as the caller vouches.
        (unsafe { self.grown::<T>(c.items.cast(), c.count, lay).cast() }, self.size::<T>() as u64)
    }

    fn curve(&mut self, c: tenon_curve) -> tenon_curve {
        let strips = if c.strip_start.is_null() { 0 } else { c.strip_count + 1 };
        // SAFETY: see above.
        let (points, strip_start) = unsafe { (self.array(c.points, c.point_count), self.array(c.strip_start, strips)) };
        tenon_curve { size: self.size::<tenon_curve>() as u32, points, strip_start, ..c }
    }

    fn mesh(&mut self, m: tenon_mesh) -> tenon_mesh {
        let faces = if m.addresses.is_null() { 0 } else { m.face_count };
        // SAFETY: see above.
        unsafe {
            tenon_mesh {
                size: self.size::<tenon_mesh>() as u32,
                points: self.array(m.points, m.point_count),
                face_start: self.array(m.face_start, m.face_count + 1),
                face_vertices: self.array(m.face_vertices, m.face_vertex_count),
                addresses: self.array(m.addresses, faces),
                ..m
            }
        }
    }

    fn panels(&mut self, p: tenon_panels) -> tenon_panels {
        let (n, k) = (p.panel_count, p.corner_count);
        // SAFETY: see above.
        unsafe {
            tenon_panels {
                size: self.size::<tenon_panels>() as u32,
                corner_start: self.array(p.corner_start, n + 1),
                address: self.array(p.address, n),
                normal: self.array(p.normal, n),
                front: self.array(p.front, k),
                vertex: self.array(p.vertex, k),
                chamfer: self.array(p.chamfer, k),
                neighbour: self.array(p.neighbour, k),
                side: self.array(p.side, k),
                back_start: self.array(p.back_start, k),
                back_end: self.array(p.back_end, k),
                voided: self.array(p.voided, k),
                ..p
            }
        }
    }

    fn features(&mut self, f: tenon_features) -> tenon_features {
        let hardware = |laid: &mut Self, h: tenon_hardware| tenon_hardware { name: laid.text(h.name), ..h };
        // SAFETY: see above.
        unsafe {
            tenon_features {
                size: self.size::<tenon_features>() as u32,
                feature_stride: self.size::<tenon_feature>() as u32,
                features: self.grown(f.features, f.feature_count, Self::feature),
                hardware: self.all(f.hardware, f.hardware_count, hardware),
                ..f
            }
        }
    }

    fn feature(&mut self, f: tenon_feature) -> tenon_feature {
        let (text, purpose) = (self.text(f.text), self.text(f.purpose));
        // SAFETY: see above.
        let line = unsafe { self.array(f.line, f.line_count) };
        tenon_feature { size: self.size::<tenon_feature>() as u32, line, text, purpose, ..f }
    }

    fn table(&mut self, t: tenon_table) -> tenon_table {
        let lay = |laid: &mut Self, a: tenon_attribute| tenon_attribute {
            name: laid.text(a.name),
            column: laid.column(a.column),
        };
        // SAFETY: see above.
        let attributes = unsafe { self.grown(t.attributes, t.attribute_count, lay) };
        tenon_table {
            size: self.size::<tenon_table>() as u32,
            attribute_stride: self.size::<tenon_attribute>() as u32,
            attributes,
            ..t
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Version 1.0 says what its structs measured; those of 1.1 have not grown since.
    #[test]
    fn the_oldest_host_is_that_of_the_first_version() {
        let read = |name: &str| {
            let place = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name);
            std::fs::read_to_string(place).unwrap()
        };
        let (first, today) = (read("layout-1.0-x86_64-linux.txt"), read("layout-x86_64-linux.txt"));
        for (name, bytes) in FIRST {
            let line = |text: &str| {
                let found = text.lines().find_map(|l| l.strip_prefix(name)?.strip_prefix(' ')?.parse::<usize>().ok());
                found.filter(|_| name.starts_with("tenon_"))
            };
            let since_then = ["tenon_table", "tenon_attribute"].contains(name);
            assert_eq!(line(if since_then { &today } else { &first }), Some(*bytes), "{name}");
        }
    }
}
