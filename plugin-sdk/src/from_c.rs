//! C values as safe values: pointers, lengths, sizes, types, texts and offsets are checked before anything is read as
//! what it is said to be. Arrays that are a buffer of [`Buffers`] as a whole are given, and are not read again; parts of one,
//! which may still be written and given, are copied; others are borrowed.

use crate::abi::value::*;
use crate::buffers::{Buffers, Element, Given};
use crate::sound::BadValue;
use crate::value::{Attribute, Branch, Curve, Feature, Features, File, Items, Machining, Mesh, Panels, Table};
use bytemuck::Pod;
use std::borrow::Cow;
use std::ffi::c_void;

type Read<T> = Result<T, BadValue>;

/// Reads what one side gave the other, one value.
pub(crate) struct Reader<'b> {
    buffers: &'b mut Buffers,
    /// Buffers that are given go over, to who keeps them; otherwise they are only shown, and stay.
    over: bool,
}

/// Bytes of `count` items that lie `stride` bytes apart.
fn length(count: u64, stride: usize, what: &'static str) -> Read<usize> {
    let bytes = usize::try_from(count).ok().and_then(|c| c.checked_mul(stride)).filter(|b| *b <= isize::MAX as usize);
    bytes.ok_or(BadValue::Length { what, found: count, hint: "" })
}

fn good<T>(ptr: *const T, what: &'static str) -> Read<()> {
    match ptr.is_aligned() {
        _ if ptr.is_null() => Err(BadValue::Null(what)),
        false => Err(BadValue::Misaligned(what)),
        true => Ok(()),
    }
}

/// The slice at `ptr`.
///
/// # Safety
/// `ptr` is NULL or points to `count` items that nobody changes during `'a`.
unsafe fn slice<'a, T>(ptr: *const T, count: u64, what: &'static str) -> Read<&'a [T]> {
    if length(count, size_of::<T>(), what)? == 0 {
        return Ok(&[]);
    }
    good(ptr, what)?;
    // SAFETY: not NULL, aligned, of possible length; the caller vouches for the rest.
    Ok(unsafe { std::slice::from_raw_parts(ptr, count as usize) })
}

/// A text.
///
/// # Safety
/// It is a view of bytes that nobody changes during `'a`.
pub(crate) unsafe fn text<'a>(t: tenon_str, what: &'static str) -> Read<&'a str> {
    // SAFETY: as the caller vouches.
    let bytes = unsafe { slice(t.ptr.cast::<u8>(), t.len, what)? };
    std::str::from_utf8(bytes).map_err(|e| BadValue::Text { what, after: e.valid_up_to() })
}

/// 0 and 1 as truth values; anything but 0 is true. O(n), and a copy only of borrowed bytes that are neither.
fn truths(bytes: Cow<'_, [u8]>) -> Cow<'_, [bool]> {
    match bytes {
        // In place: both are one byte.
        Cow::Owned(v) => Cow::Owned(v.into_iter().map(|b| b != 0).collect()),
        Cow::Borrowed(v) => match bytemuck::checked::try_cast_slice(v) {
            Ok(truths) => Cow::Borrowed(truths),
            Err(_) => v.iter().map(|b| *b != 0).collect(),
        },
    }
}

// SAFETY of all functions below: the caller vouches that every pointer is NULL or leads to as many items as the struct
// says, which nobody changes during 'a. What can be seen from here is checked.
impl<'b> Reader<'b> {
    /// With `over` buffers that are given become arrays of the value's own: only for who keeps them until the evaluation is
    /// over.
    pub fn new(buffers: &'b mut Buffers, over: bool) -> Self {
        Self { buffers, over }
    }

    /// An array, copied if it lies in a buffer, which may still be written and given.
    unsafe fn slice<'a, T: Pod>(&self, ptr: *const T, count: u64, what: &'static str) -> Read<Cow<'a, [T]>> {
        let found = self.buffers.find(ptr.addr(), length(count, size_of::<T>(), what)?, what, count)?;
        // SAFETY: see above; it lies in no buffer that is gone.
        let items = unsafe { slice(ptr, count, what)? };
        Ok(if found.is_some() { Cow::Owned(items.to_vec()) } else { Cow::Borrowed(items) })
    }

    /// Structs `stride` bytes apart, each as far as the other side's version reaches. Any bytes are good for `T`, zeros
    /// included.
    unsafe fn structs<T: Copy>(&self, ptr: *const T, count: u64, stride: u64, what: &'static str) -> Read<Vec<T>> {
        if count == 0 {
            return Ok(Vec::new());
        }
        let stride_ok =
            stride >= size_of::<T>() as u64 && stride.is_multiple_of(align_of::<T>() as u64) && stride <= 1 << 16;
        if !stride_ok {
            return Err(BadValue::Length { what, found: stride, hint: " as the bytes from one to the next" });
        }
        good(ptr, what)?;
        self.buffers.find(ptr.addr(), length(count, stride as usize, what)?, what, count)?;
        // SAFETY: inside what the caller vouches for.
        Ok((0..count as usize).map(|i| unsafe { *ptr.byte_add(i * stride as usize) }).collect())
    }

    /// A struct that begins with its size, if it is at least as large as this version of it. Any bytes are good for `T`.
    pub unsafe fn sized<T: Copy>(&self, ptr: *const T, what: &'static str, [size, hint]: [&'static str; 2]) -> Read<T> {
        good(ptr, what)?;
        self.buffers.find(ptr.addr(), size_of::<T>(), what, 1)?;
        // SAFETY: see above; the size comes first.
        let found = unsafe { *ptr.cast::<u32>() };
        if (found as usize) < size_of::<T>() {
            return Err(BadValue::Length { what: size, found: found.into(), hint });
        }
        // SAFETY: see above; it is as large as this version of the struct.
        Ok(unsafe { *ptr })
    }

    /// A text, copied like arrays.
    pub unsafe fn text<'a>(&self, t: tenon_str, what: &'static str) -> Read<Cow<'a, str>> {
        let found = self.buffers.find(t.ptr.addr(), length(t.len, 1, what)?, what, t.len)?;
        // SAFETY: see above; it lies in no buffer that is gone.
        let text = unsafe { text(t, what)? };
        Ok(if found.is_some() { Cow::Owned(text.to_owned()) } else { Cow::Borrowed(text) })
    }

    /// An array, given if it is a buffer as a whole.
    unsafe fn array<'a, T: Element>(&mut self, ptr: *const T, count: u64, what: &'static str) -> Read<Cow<'a, [T]>> {
        let (at, bytes) = (ptr.addr(), length(count, size_of::<T>(), what)?);
        if self.buffers.find(at, bytes, what, count)? == Some(at) {
            match self.buffers.give(at, bytes, self.over) {
                Given::No => {}
                Given::Over(v) => return Ok(Cow::Owned(v)),
                // SAFETY: see above; it stays where it is, and nobody changes it any more.
                Given::Stays => return unsafe { slice(ptr, count, what) }.map(Cow::Borrowed),
            }
        }
        // SAFETY: see above.
        unsafe { self.slice(ptr, count, what) }
    }

    /// Items of a column. One alone stays in its buffer: nobody keeps an array of one item.
    unsafe fn list<'a, T: Element>(
        &mut self,
        ptr: *const c_void,
        count: u64,
        what: &'static str,
    ) -> Read<Cow<'a, [T]>> {
        let over = self.over;
        self.over = over && count != 1;
        // SAFETY: see above.
        let items = unsafe { self.array(ptr.cast(), count, what) };
        self.over = over;
        items
    }

    /// Items that are structs. What gaps hold stays in its buffers: nobody keeps it.
    unsafe fn each<T: Copy, R>(
        &mut self,
        c: &tenon_column,
        valid: Option<&[bool]>,
        what: &'static str,
        read: impl Fn(&mut Self, &T) -> Read<R>,
    ) -> Read<Vec<R>> {
        // SAFETY: see above.
        let all = unsafe { self.structs(c.items.cast::<T>(), c.count, c.stride, what)? };
        let over = self.over;
        let one = |(i, item): (usize, &T)| {
            self.over = over && valid.is_none_or(|valid| valid.get(i) == Some(&true));
            read(self, item)
        };
        let items = all.iter().enumerate().map(one).collect();
        self.over = over;
        items
    }

    /// A tree.
    pub unsafe fn tree<'a>(mut self, tree: *const tenon_tree) -> Read<Vec<Branch<'a>>> {
        // SAFETY: see above.
        let tree = unsafe { self.sized(tree, "tree", ["tree.size", "; set it to sizeof(tenon_tree)"])? };
        // SAFETY: see above.
        let branches =
            unsafe { self.structs(tree.branches, tree.branch_count, tree.branch_stride.into(), "branches")? };
        branches
            .iter()
            .map(|b| {
                let path = if b.path.is_null() {
                    Cow::Borrowed(&[0][..])
                } else {
                    // SAFETY: see above.
                    unsafe { self.slice(b.path, b.path_count, "path")? }
                };
                let c = &b.column;
                // SAFETY: see above.
                let (items, valid) = unsafe { self.column(c)? };
                Ok(Branch { path, items, valid })
            })
            .collect()
    }

    /// The items of a column, and which of them are there; `None`: all are.
    unsafe fn column<'a>(&mut self, c: &tenon_column) -> Read<(Items<'a>, Option<Cow<'a, [bool]>>)> {
        // SAFETY: see above.
        unsafe {
            // Read as a copy, so that one buffer may serve many columns.
            let valid = match c.valid.is_null() {
                true => None,
                false => Some(truths(self.slice(c.valid, c.count, "valid")?)),
            };
            Ok((self.items(c, valid.as_deref())?, valid))
        }
    }

    unsafe fn items<'a>(&mut self, c: &tenon_column, valid: Option<&[bool]>) -> Read<Items<'a>> {
        let fixed = |size: usize| match c.stride == size as u64 || c.count == 0 {
            true => Ok(()),
            false => {
                Err(BadValue::Length { what: "column.stride", found: c.stride, hint: "; set it to sizeof one item" })
            }
        };
        // SAFETY: see above.
        unsafe {
            Ok(match c.kind {
                TENON_NOTHING if c.count == 0 => Items::Opaque { type_name: Cow::Borrowed(""), count: 0 },
                TENON_BOOLEAN => {
                    fixed(1)?;
                    Items::Boolean(truths(self.list(c.items, c.count, "booleans")?))
                }
                TENON_INTEGER => {
                    fixed(8)?;
                    Items::Integer(self.list(c.items, c.count, "integers")?)
                }
                TENON_NUMBER => {
                    fixed(8)?;
                    Items::Number(self.list(c.items, c.count, "numbers")?)
                }
                TENON_POINT | TENON_VECTOR => {
                    fixed(size_of::<tenon_vec3>())?;
                    let points = self.list(c.items, c.count, "points")?;
                    if c.kind == TENON_POINT { Items::Point(points) } else { Items::Vector(points) }
                }
                TENON_PLANE => {
                    fixed(size_of::<tenon_plane>())?;
                    Items::Plane(self.list(c.items, c.count, "planes")?)
                }
                TENON_TEXT => {
                    fixed(size_of::<tenon_str>())?;
                    let texts = self.structs::<tenon_str>(c.items.cast(), c.count, c.stride, "texts")?;
                    Items::Text(texts.iter().map(|t| self.text(*t, "text")).collect::<Read<_>>()?)
                }
                TENON_CURVE => Items::Curve(self.each(c, valid, "curves", |r, x| r.curve(x))?),
                TENON_MESH => Items::Mesh(self.each(c, valid, "meshes", |r, x| r.mesh(x))?),
                TENON_PANELS => Items::Panels(self.each(c, valid, "panel sets", |r, x| r.panels(x))?),
                TENON_FEATURES => Items::Features(self.each(c, valid, "feature sets", |r, x| r.features(x))?),
                TENON_FILE => Items::File(self.each(c, valid, "files", |r, x| r.file(x))?),
                TENON_TABLE => Items::Table(self.each(c, valid, "tables", |r, x| r.table(x))?),
                TENON_EDGES => {
                    fixed(size_of::<tenon_edge_pair>())?;
                    Items::Edges(self.slice(c.items.cast(), c.count, "edges")?)
                }
                TENON_OPAQUE => Items::Opaque {
                    type_name: self.text(c.type_name, "type_name")?,
                    count: usize::try_from(c.count).unwrap_or(usize::MAX),
                },
                other => return Err(BadValue::Unknown { what: "kind", found: other.into() }),
            })
        }
    }

    unsafe fn curve<'a>(&mut self, c: &tenon_curve) -> Read<Curve<'a>> {
        // SAFETY: see above.
        let points = unsafe { self.array(c.points, c.point_count, "curve points")? };
        let strip_start = if c.strip_start.is_null() {
            Cow::Owned(vec![0, points.len() as u32])
        } else {
            // SAFETY: see above.
            unsafe { self.array(c.strip_start, c.strip_count.saturating_add(1), "strip_start")? }
        };
        let curve = Curve { points, strip_start, closed: c.closed != 0 };
        curve.check()?;
        Ok(curve)
    }

    unsafe fn mesh<'a>(&mut self, m: &tenon_mesh) -> Read<Mesh<'a>> {
        // SAFETY: see above.
        let mesh = unsafe {
            Mesh {
                points: self.array(m.points, m.point_count, "mesh points")?,
                face_start: match m.face_count {
                    0 => Cow::Borrowed(&[0][..]),
                    count => self.array(m.face_start, count.saturating_add(1), "face_start")?,
                },
                face_vertices: self.array(m.face_vertices, m.face_vertex_count, "face_vertices")?,
                addresses: match m.addresses.is_null() {
                    true => Cow::Borrowed(&[][..]),
                    false => self.array(m.addresses, m.face_count, "addresses")?,
                },
            }
        };
        mesh.check()?;
        Ok(mesh)
    }

    unsafe fn panels<'a>(&mut self, p: &tenon_panels) -> Read<Panels<'a>> {
        let (n, k) = (p.panel_count, p.corner_count);
        // SAFETY: see above.
        let panels = unsafe {
            Panels {
                thickness: p.thickness,
                corner_start: match n {
                    0 => Cow::Borrowed(&[0][..]),
                    n => self.array(p.corner_start, n.saturating_add(1), "corner_start")?,
                },
                address: self.array(p.address, n, "address")?,
                normal: self.array(p.normal, n, "normal")?,
                front: self.array(p.front, k, "front")?,
                vertex: self.array(p.vertex, k, "vertex")?,
                chamfer: self.array(p.chamfer, k, "chamfer")?,
                neighbour: self.array(p.neighbour, k, "neighbour")?,
                side: self.array(p.side, k, "side")?,
                back_start: self.array(p.back_start, k, "back_start")?,
                back_end: self.array(p.back_end, k, "back_end")?,
                voided: truths(self.array(p.voided, k, "voided")?),
            }
        };
        panels.check()?;
        Ok(panels)
    }

    unsafe fn features<'a>(&mut self, f: &tenon_features) -> Read<Features<'a>> {
        // SAFETY: see above.
        unsafe {
            let features = self.structs(f.features, f.feature_count, f.feature_stride.into(), "features")?;
            let stride = size_of::<tenon_hardware>() as u64;
            let hardware = self.structs(f.hardware, f.hardware_count, stride, "hardware")?;
            Ok(Features {
                features: features.iter().map(|f| self.feature(f)).collect::<Read<_>>()?,
                hardware: hardware
                    .iter()
                    .map(|h| Ok((self.text(h.name, "hardware.name")?, h.count)))
                    .collect::<Read<_>>()?,
            })
        }
    }

    unsafe fn feature<'a>(&mut self, f: &tenon_feature) -> Read<Feature<'a>> {
        // SAFETY: see above.
        let (words, purpose) =
            unsafe { (self.text(f.text, "feature.text")?, self.text(f.purpose, "feature.purpose")?) };
        // SAFETY: see above.
        let line = |r: &mut Self| unsafe { r.array(f.line, f.line_count, "feature.line") };
        let machining = match f.kind {
            TENON_DRILL => Machining::Drill { entry: f.at, axis: f.axis, depth: f.depth, diameter: f.width },
            TENON_SLOT => Machining::Slot { from: f.at, to: f.to, axis: f.axis, width: f.width, depth: f.depth },
            TENON_POCKET => Machining::Pocket { outline: line(self)?, axis: f.axis, depth: f.depth },
            TENON_CONTOUR => Machining::Contour { line: line(self)?, axis: f.axis },
            TENON_ENGRAVING => Machining::Engraving {
                origin: f.at,
                along: f.to,
                axis: f.axis,
                height: f.width,
                depth: f.depth,
                text: words,
            },
            other => return Err(BadValue::Unknown { what: "feature.kind", found: other.into() }),
        };
        let some = |i: u32| (i != TENON_NONE).then_some(i);
        let (edge, joint, by_hand) = (some(f.edge), some(f.joint), f.by_hand != 0);
        let feature = Feature { panel: f.panel, edge, joint, by_hand, purpose, machining };
        feature.check()?;
        Ok(feature)
    }

    unsafe fn table<'a>(&mut self, t: &tenon_table) -> Read<Table<'a>> {
        // SAFETY: see above.
        let all = unsafe { self.structs(t.attributes, t.attribute_count, t.attribute_stride.into(), "attributes")? };
        let mut attributes = Vec::with_capacity(all.len());
        for a in &all {
            let c = &a.column;
            // Tables hold no tables, so that nothing here nests.
            if c.kind > TENON_PLANE && c.kind != TENON_OPAQUE {
                return Err(BadValue::Unknown { what: "attribute of kind", found: c.kind.into() });
            }
            // SAFETY: see above.
            let (name, (items, valid)) = unsafe { (self.text(a.name, "attribute.name")?, self.column(c)?) };
            attributes.push(Attribute { name, items, valid });
        }
        let table = Table { rows: usize::try_from(t.row_count).unwrap_or(usize::MAX), attributes };
        table.check()?;
        Ok(table)
    }

    unsafe fn file<'a>(&mut self, f: &tenon_file) -> Read<File<'a>> {
        // SAFETY: see above.
        unsafe {
            let withheld = self.text(f.withheld, "file.withheld")?;
            Ok(File {
                name: self.text(f.name, "file.name")?,
                bytes: self.array(f.bytes, f.byte_count, "file.bytes")?,
                withheld: (!withheld.is_empty()).then_some(withheld),
            })
        }
    }
}

/// A tree that a program outside made, checked as far as pointers allow; arrays are borrowed. O(items).
///
/// # Errors
/// Says what cannot be: NULL, misaligned, lengths, offsets, indices, texts that are not UTF-8, numbers that are not finite.
///
/// # Safety
/// Every pointer in it is NULL or leads to as many items as the structs say, which nobody changes during `'a`.
pub unsafe fn read_tree<'a>(tree: *const tenon_tree) -> Result<Vec<Branch<'a>>, BadValue> {
    // SAFETY: as the caller vouches.
    unsafe { Reader::new(&mut Buffers::default(), false).tree(tree) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::abi::plugin::TENON_U8;
    use std::ops::Range;
    use std::ptr::NonNull;

    #[test]
    fn a_new_buffer_over_part_of_a_given_one_leaves_the_rest_given() {
        let mut buffers = Buffers::default();
        let bytes = [0_u8; 100];
        let at = |range: &Range<usize>| NonNull::from(&bytes[range.start]);
        let lend = |buffers: &mut Buffers, range: Range<usize>| {
            buffers.lend(TENON_U8, at(&range), range.len() as u64);
        };
        let read = |buffers: &mut Buffers, range: Range<usize>| {
            // SAFETY: bytes that are there and that nobody changes.
            let read = unsafe { Reader::new(buffers, true).array(at(&range).as_ptr(), range.len() as u64, "bytes") };
            read.map(|bytes| bytes.len())
        };
        for range in [0..40, 40..60, 60..100] {
            lend(&mut buffers, range.clone());
            assert_eq!(read(&mut buffers, range.clone()), Ok(range.len()));
        }
        for gone in [0..40, 39..40, 40..60, 59..61, 60..100, 99..100] {
            assert_eq!(read(&mut buffers, gone.clone()), Err(BadValue::Shared), "{gone:?}");
        }
        // Over the end of the first, all of the second and the beginning of the third.
        lend(&mut buffers, 30..70);
        for gone in [0..30, 29..30, 70..71, 70..100] {
            assert_eq!(read(&mut buffers, gone.clone()), Err(BadValue::Shared), "{gone:?}");
        }
        for half in [29..31, 69..71, 0..100] {
            assert!(read(&mut buffers, half.clone()).is_err(), "{half:?}");
        }
        for there in [30..31, 69..70, 30..70] {
            assert_eq!(read(&mut buffers, there.clone()), Ok(there.len()));
        }
        assert_eq!(read(&mut buffers, 30..70), Err(BadValue::Shared));
    }
}
