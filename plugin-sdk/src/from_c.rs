//! C values as safe values: pointers, lengths, sizes, types, texts and offsets are checked before anything is read as
//! what it is said to be. Arrays that begin in a [`Buffers`] and are as long change hands, and are not read again; others
//! are borrowed.

use crate::abi::plugin::*;
use crate::abi::value::*;
use crate::sound::BadValue;
use crate::value::{Attribute, Branch, Curve, Feature, Features, File, Items, Machining, Mesh, Panels, Table};
use bytemuck::Pod;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::ffi::c_void;
use std::ops::Range;

type Read<T> = Result<T, BadValue>;

/// A buffer of the host.
#[derive(Debug)]
enum Buffer {
    U8(Vec<u8>),
    U32(Vec<u32>),
    I64(Vec<i64>),
    F64(Vec<f64>),
    Vec3(Vec<tenon_vec3>),
    Vec4(Vec<tenon_vec4>),
    Plane(Vec<tenon_plane>),
    Edge(Vec<tenon_edge>),
    Address(Vec<tenon_address>),
    /// It changed hands, and may be gone; it ended before this address.
    Given(usize),
}

/// The buffers of one evaluation by address. Most make none, so the map comes with the first.
#[derive(Debug, Default)]
#[expect(clippy::box_collection, reason = "it is moved at every call, and then one word instead of three")]
pub struct Buffers(Option<Box<BTreeMap<usize, Buffer>>>);

/// The largest buffer, bytes: beyond that a length is a mistake.
const LARGEST: u64 = 1 << 40;

impl Buffers {
    /// A zeroed buffer; NULL without memory or for an unknown element. O(count).
    pub fn make(&mut self, element: tenon_element, count: u64) -> *mut c_void {
        self.try_make(element, count).unwrap_or(std::ptr::null_mut())
    }

    fn try_make(&mut self, element: tenon_element, count: u64) -> Option<*mut c_void> {
        let count = usize::try_from(count.max(1)).ok().filter(|c| (*c as u64) < LARGEST)?;
        macro_rules! make {
            ($variant:ident, $type:ty) => {{
                // Fresh pages of the system are zero: they are not touched here.
                let mut v = bytemuck::try_zeroed_vec::<$type>(count).ok()?;
                let at: *mut c_void = v.as_mut_ptr().cast();
                (at, Buffer::$variant(v))
            }};
        }
        let (at, buffer) = match element {
            TENON_U8 => make!(U8, u8),
            TENON_U32 => make!(U32, u32),
            TENON_I64 => make!(I64, i64),
            TENON_F64 => make!(F64, f64),
            TENON_VEC3 => make!(Vec3, tenon_vec3),
            TENON_VEC4 => make!(Vec4, tenon_vec4),
            TENON_PLANES => make!(Plane, tenon_plane),
            TENON_EDGE_REFS => make!(Edge, tenon_edge),
            TENON_ADDRESSES => make!(Address, tenon_address),
            _ => return None,
        };
        let all = self.0.get_or_insert_default();
        let range = at.addr()..at.addr() + count * usize::try_from(element_size(element)?).ok()?;
        // What was given and let go may lie there anew.
        while let Some((&start, Buffer::Given(end))) = all.range(..range.end).next_back()
            && *end > range.start
        {
            all.remove(&start);
        }
        all.insert(range.start, buffer);
        Some(at)
    }
}

/// Bytes of one element of a buffer; `None`: there is no such element.
pub(crate) fn element_size(element: tenon_element) -> Option<u64> {
    let size = match element {
        TENON_U8 => 1,
        TENON_U32 => 4,
        TENON_I64 | TENON_F64 => 8,
        TENON_VEC3 => size_of::<tenon_vec3>(),
        TENON_VEC4 => size_of::<tenon_vec4>(),
        TENON_PLANES => size_of::<tenon_plane>(),
        TENON_EDGE_REFS => size_of::<tenon_edge>(),
        TENON_ADDRESSES => size_of::<tenon_address>(),
        _ => return None,
    };
    Some(size as u64)
}

/// Element types of buffers.
trait Element: Pod {
    fn take(buffer: Buffer) -> Result<Vec<Self>, Buffer>;
    fn keep(v: Vec<Self>) -> Buffer;
}

macro_rules! elements {
    ($($type:ty, $variant:ident;)*) => { $(
        impl Element for $type {
            fn take(buffer: Buffer) -> Result<Vec<Self>, Buffer> {
                match buffer {
                    Buffer::$variant(v) => Ok(v),
                    other => Err(other),
                }
            }
            fn keep(v: Vec<Self>) -> Buffer {
                Buffer::$variant(v)
            }
        }
    )* };
}

elements! {
    u8, U8; u32, U32; i64, I64; f64, F64; tenon_vec3, Vec3; tenon_vec4, Vec4; tenon_plane, Plane; tenon_edge, Edge;
    tenon_address, Address;
}

/// Reads what one side gave the other, one value.
pub(crate) struct Reader<'b> {
    buffers: &'b mut Buffers,
    /// If there are buffers: the addresses of every array of the value, and whether it changed hands.
    arrays: Option<Vec<(Range<usize>, bool)>>,
}

/// The slice at `ptr`.
///
/// # Safety
/// `ptr` is NULL or points to `count` items that nobody changes during `'a`.
unsafe fn slice<'a, T>(ptr: *const T, count: u64, what: &'static str) -> Read<&'a [T]> {
    let fits =
        usize::try_from(count).ok().filter(|c| c.checked_mul(size_of::<T>()).is_some_and(|b| b <= isize::MAX as usize));
    match fits {
        Some(0) => Ok(&[]),
        None => Err(BadValue::Length { what, found: count, hint: "" }),
        Some(_) if ptr.is_null() => Err(BadValue::Null(what)),
        Some(_) if !ptr.is_aligned() => Err(BadValue::Misaligned(what)),
        // SAFETY: not NULL, aligned, of possible length; the caller vouches for the rest.
        Some(count) => Ok(unsafe { std::slice::from_raw_parts(ptr, count) }),
    }
}

/// Structs `stride` bytes apart, each as far as the other side's version reaches.
///
/// # Safety
/// As [`slice`], with `stride` bytes per item; any bytes are good for `T`, zeros included.
unsafe fn structs<T: Copy>(ptr: *const T, count: u64, stride: u64, what: &'static str) -> Read<Vec<T>> {
    if count == 0 {
        return Ok(Vec::new());
    }
    let stride_ok =
        stride >= size_of::<T>() as u64 && stride.is_multiple_of(align_of::<T>() as u64) && stride <= 1 << 16;
    if !stride_ok {
        return Err(BadValue::Length { what, found: stride, hint: " as the bytes from one to the next" });
    }
    if ptr.is_null() {
        return Err(BadValue::Null(what));
    }
    if !ptr.is_aligned() {
        return Err(BadValue::Misaligned(what));
    }
    let count = usize::try_from(count)
        .ok()
        .filter(|c| c.checked_mul(stride as usize).is_some_and(|b| b <= isize::MAX as usize));
    let Some(count) = count else { return Err(BadValue::Length { what, found: u64::MAX, hint: "" }) };
    // SAFETY: inside what the caller vouches for.
    Ok((0..count).map(|i| unsafe { *ptr.byte_add(i * stride as usize) }).collect())
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
    pub fn new(buffers: &'b mut Buffers) -> Self {
        let some = buffers.0.as_ref().is_some_and(|buffers| !buffers.is_empty());
        Self { buffers, arrays: some.then(Vec::new) }
    }

    /// What changed hands may be gone when another array is looked at, so no two may share it.
    fn apart(&mut self) -> Read<()> {
        let Some(mut arrays) = self.arrays.take() else { return Ok(()) };
        arrays.sort_unstable_by_key(|(range, _)| range.start);
        let (mut end, mut taken_end) = (0, 0);
        for (range, taken) in arrays {
            if range.start < if taken { end } else { taken_end } {
                return Err(BadValue::Shared);
            }
            end = end.max(range.end);
            taken_end = if taken { taken_end.max(range.end) } else { taken_end };
        }
        Ok(())
    }

    /// An array, taken over if it is a buffer.
    unsafe fn array<'a, T: Element>(&mut self, ptr: *const T, count: u64, what: &'static str) -> Read<Cow<'a, [T]>> {
        // SAFETY: see above.
        unsafe { self.array_or_buffer(ptr, count, what, true) }
    }

    /// An array, taken over if it is a buffer and `take`.
    unsafe fn array_or_buffer<'a, T: Element>(
        &mut self,
        ptr: *const T,
        count: u64,
        what: &'static str,
        take: bool,
    ) -> Read<Cow<'a, [T]>> {
        let array = match self.buffer(ptr.addr(), count, what, take)? {
            Some(v) => Cow::Owned(v),
            // SAFETY: see above; it lies in no buffer that is gone.
            None => Cow::Borrowed(unsafe { slice(ptr, count, what)? }),
        };
        if let Some(arrays) = &mut self.arrays
            && !array.is_empty()
        {
            let range = array.as_ptr_range();
            arrays.push((range.start.addr()..range.end.addr(), matches!(array, Cow::Owned(_))));
        }
        Ok(array)
    }

    /// The buffer that begins at an address, if it is to be taken; what lies in one that was taken is refused.
    fn buffer<T: Element>(&mut self, at: usize, count: u64, what: &'static str, take: bool) -> Read<Option<Vec<T>>> {
        let Some(buffers) = self.buffers.0.as_mut().filter(|_| count > 0) else { return Ok(None) };
        let Some((start, buffer)) = buffers.range_mut(..=at).next_back() else { return Ok(None) };
        match buffer {
            Buffer::Given(end) if at < *end => return Err(BadValue::Shared),
            _ if *start != at => return Ok(None),
            _ => {}
        }
        let mut v = match T::take(std::mem::replace(buffer, Buffer::Given(at))) {
            Ok(v) => v,
            Err(other) => {
                *buffer = other;
                return Ok(None);
            }
        };
        let fits = count <= v.len() as u64;
        if fits && take {
            *buffer = Buffer::Given(at + v.len() * size_of::<T>());
            v.truncate(count as usize);
            return Ok(Some(v));
        }
        *buffer = T::keep(v);
        if fits { Ok(None) } else { Err(BadValue::Length { what, found: count, hint: ": longer than its buffer" }) }
    }

    /// A tree.
    pub unsafe fn tree<'a>(mut self, tree: *const tenon_tree) -> Read<Vec<Branch<'a>>> {
        if tree.is_null() {
            return Err(BadValue::Null("tree"));
        }
        if !tree.is_aligned() {
            return Err(BadValue::Misaligned("tree"));
        }
        // SAFETY: see above; the size comes first.
        let size = unsafe { (*tree).size };
        if (size as usize) < size_of::<tenon_tree>() {
            return Err(BadValue::Length {
                what: "tree.size",
                found: size.into(),
                hint: "; set it to sizeof(tenon_tree)",
            });
        }
        // SAFETY: see above; it is as large as this version of the struct.
        let tree = unsafe { *tree };
        // SAFETY: see above.
        let branches = unsafe { structs(tree.branches, tree.branch_count, tree.branch_stride.into(), "branches")? };
        let read = branches
            .iter()
            .map(|b| {
                let path = if b.path.is_null() {
                    Cow::Borrowed(&[0][..])
                } else {
                    // SAFETY: see above.
                    Cow::Borrowed(unsafe { slice(b.path, b.path_count, "path")? })
                };
                let c = &b.column;
                // SAFETY: see above.
                let (items, valid) = unsafe { (self.items(c)?, self.valid(c)?) };
                Ok(Branch { path, items, valid })
            })
            .collect::<Read<Vec<Branch<'a>>>>()?;
        self.apart()?;
        Ok(read)
    }

    unsafe fn items<'a>(&mut self, c: &tenon_column) -> Read<Items<'a>> {
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
                    Items::Boolean(truths(self.array(c.items.cast(), c.count, "booleans")?))
                }
                TENON_INTEGER => {
                    fixed(8)?;
                    Items::Integer(self.array(c.items.cast(), c.count, "integers")?)
                }
                TENON_NUMBER => {
                    fixed(8)?;
                    Items::Number(self.array(c.items.cast(), c.count, "numbers")?)
                }
                TENON_POINT | TENON_VECTOR => {
                    fixed(size_of::<tenon_vec3>())?;
                    let points = self.array(c.items.cast(), c.count, "points")?;
                    if c.kind == TENON_POINT { Items::Point(points) } else { Items::Vector(points) }
                }
                TENON_PLANE => {
                    fixed(size_of::<tenon_plane>())?;
                    Items::Plane(self.array(c.items.cast(), c.count, "planes")?)
                }
                TENON_TEXT => {
                    fixed(size_of::<tenon_str>())?;
                    let texts = slice::<tenon_str>(c.items.cast(), c.count, "texts")?;
                    Items::Text(texts.iter().map(|t| text(*t, "text").map(Cow::Borrowed)).collect::<Read<_>>()?)
                }
                TENON_CURVE => {
                    let all = structs::<tenon_curve>(c.items.cast(), c.count, c.stride, "curves")?;
                    Items::Curve(all.iter().map(|x| self.curve(x)).collect::<Read<_>>()?)
                }
                TENON_MESH => {
                    let all = structs::<tenon_mesh>(c.items.cast(), c.count, c.stride, "meshes")?;
                    Items::Mesh(all.iter().map(|x| self.mesh(x)).collect::<Read<_>>()?)
                }
                TENON_PANELS => {
                    let all = structs::<tenon_panels>(c.items.cast(), c.count, c.stride, "panel sets")?;
                    Items::Panels(all.iter().map(|x| self.panels(x)).collect::<Read<_>>()?)
                }
                TENON_FEATURES => {
                    let all = structs::<tenon_features>(c.items.cast(), c.count, c.stride, "feature sets")?;
                    Items::Features(all.iter().map(|x| self.features(x)).collect::<Read<_>>()?)
                }
                TENON_FILE => {
                    let all = structs::<tenon_file>(c.items.cast(), c.count, c.stride, "files")?;
                    Items::File(all.iter().map(|x| self.file(x)).collect::<Read<_>>()?)
                }
                TENON_TABLE => {
                    let all = structs::<tenon_table>(c.items.cast(), c.count, c.stride, "tables")?;
                    Items::Table(all.iter().map(|x| self.table(x)).collect::<Read<_>>()?)
                }
                TENON_EDGES => {
                    fixed(size_of::<tenon_edge_pair>())?;
                    Items::Edges(Cow::Borrowed(slice(c.items.cast(), c.count, "edges")?))
                }
                TENON_OPAQUE => Items::Opaque {
                    type_name: Cow::Borrowed(text(c.type_name, "type_name")?),
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
            let features = structs(f.features, f.feature_count, f.feature_stride.into(), "features")?;
            let hardware = slice(f.hardware, f.hardware_count, "hardware")?;
            Ok(Features {
                features: features.iter().map(|f| self.feature(f)).collect::<Read<_>>()?,
                hardware: hardware
                    .iter()
                    .map(|h| Ok((Cow::Borrowed(text(h.name, "hardware.name")?), h.count)))
                    .collect::<Read<_>>()?,
            })
        }
    }

    unsafe fn feature<'a>(&mut self, f: &tenon_feature) -> Read<Feature<'a>> {
        // SAFETY: see above.
        let (line, words, purpose) = unsafe {
            let line: Cow<'a, [tenon_vec3]> = self.array(f.line, f.line_count, "feature.line")?;
            (line, text::<'a>(f.text, "feature.text")?, text::<'a>(f.purpose, "feature.purpose")?)
        };
        let machining = match f.kind {
            TENON_DRILL => Machining::Drill { entry: f.at, axis: f.axis, depth: f.depth, diameter: f.width },
            TENON_SLOT => Machining::Slot { from: f.at, to: f.to, axis: f.axis, width: f.width, depth: f.depth },
            TENON_POCKET => Machining::Pocket { outline: line, axis: f.axis, depth: f.depth },
            TENON_CONTOUR => Machining::Contour { line, axis: f.axis },
            TENON_ENGRAVING => Machining::Engraving {
                origin: f.at,
                along: f.to,
                axis: f.axis,
                height: f.width,
                depth: f.depth,
                text: words.into(),
            },
            other => return Err(BadValue::Unknown { what: "feature.kind", found: other.into() }),
        };
        let some = |i: u32| (i != TENON_NONE).then_some(i);
        let (edge, joint, by_hand) = (some(f.edge), some(f.joint), f.by_hand != 0);
        let feature = Feature { panel: f.panel, edge, joint, by_hand, purpose: purpose.into(), machining };
        feature.check()?;
        Ok(feature)
    }

    unsafe fn table<'a>(&mut self, t: &tenon_table) -> Read<Table<'a>> {
        // SAFETY: see above.
        let all = unsafe { structs(t.attributes, t.attribute_count, t.attribute_stride.into(), "attributes")? };
        let mut attributes = Vec::with_capacity(all.len());
        for a in &all {
            let c = &a.column;
            // Tables hold no tables, so that nothing here nests.
            if c.kind > TENON_PLANE && c.kind != TENON_OPAQUE {
                return Err(BadValue::Unknown { what: "attribute of kind", found: c.kind.into() });
            }
            // SAFETY: see above.
            let (name, items, valid) = unsafe { (text(a.name, "attribute.name")?, self.items(c)?, self.valid(c)?) };
            attributes.push(Attribute { name: name.into(), items, valid });
        }
        let table = Table { rows: usize::try_from(t.row_count).unwrap_or(usize::MAX), attributes };
        table.check()?;
        Ok(table)
    }

    /// Which items of a column are there. A buffer is not taken over, so that one may serve many columns.
    unsafe fn valid<'a>(&mut self, c: &tenon_column) -> Read<Option<Cow<'a, [bool]>>> {
        if c.valid.is_null() {
            return Ok(None);
        }
        // SAFETY: see above.
        unsafe { self.array_or_buffer(c.valid, c.count, "valid", false) }.map(|valid| Some(truths(valid)))
    }

    unsafe fn file<'a>(&mut self, f: &tenon_file) -> Read<File<'a>> {
        // SAFETY: see above.
        unsafe {
            let withheld = text(f.withheld, "file.withheld")?;
            Ok(File {
                name: text(f.name, "file.name")?.into(),
                bytes: self.array(f.bytes, f.byte_count, "file.bytes")?,
                withheld: (!withheld.is_empty()).then_some(withheld.into()),
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
    unsafe { Reader::new(&mut Buffers::default()).tree(tree) }
}
