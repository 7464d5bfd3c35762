//! The memory that a host makes for a plugin: by address, what is in it, and whether it was given.
//!
//! A buffer that was given lives until the evaluation is over, here or with who keeps it: nothing of the plugin's own can
//! come to lie where one was given and be refused for it.

use crate::abi::plugin::*;
use crate::abi::value::*;
use crate::sound::BadValue;
use bytemuck::Pod;
use std::collections::BTreeMap;
use std::ffi::c_void;
use std::ops::Range;
use std::ptr::NonNull;

/// A buffer of the host.
#[derive(Debug)]
struct Buffer {
    /// It ends before this address.
    end: usize,
    /// It was given, and is not read again.
    given: bool,
    memory: Memory,
}

/// Where a buffer's memory is.
#[derive(Debug)]
pub(crate) enum Memory {
    U8(Vec<u8>),
    U32(Vec<u32>),
    I64(Vec<i64>),
    F64(Vec<f64>),
    Vec3(Vec<tenon_vec3>),
    Vec4(Vec<tenon_vec4>),
    Plane(Vec<tenon_plane>),
    Edge(Vec<tenon_edge>),
    Address(Vec<tenon_address>),
    /// Somebody else has it until the evaluation is over: who lent it, or to whom it went over. Only one of a value that was
    /// refused, with which the evaluation has failed, may be gone before.
    Elsewhere(tenon_element),
}

/// What becomes of an array that may be a buffer.
pub(crate) enum Given<T> {
    /// It is no buffer as a whole.
    No,
    /// It is given, and stays where it is.
    Stays,
    /// It is given, and this is it.
    Over(Vec<T>),
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
                (at, Memory::$variant(v))
            }};
        }
        let (at, memory) = match element {
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
        let bytes = count * usize::try_from(element_size(element)?).ok()?;
        self.add(at.addr()..at.addr() + bytes, memory);
        Some(at)
    }

    /// The buffer in which an array lies. Whatever is read is looked for here first: nothing is read where a buffer was
    /// given, which may be gone. O(log buffers).
    pub(crate) fn find(
        &self,
        at: usize,
        bytes: usize,
        what: &'static str,
        count: u64,
    ) -> Result<Option<usize>, BadValue> {
        let Some(buffers) = self.0.as_ref().filter(|_| bytes > 0) else { return Ok(None) };
        let (end, mut found) = (at.saturating_add(bytes), None);
        for (start, buffer) in buffers.range(..end).rev().take_while(|(_, buffer)| at < buffer.end) {
            if buffer.given {
                return Err(BadValue::Shared);
            }
            if at < *start || buffer.end < end {
                return Err(BadValue::Length { what, found: count, hint: ": longer than its buffer" });
            }
            found = Some(*start);
        }
        Ok(found)
    }

    /// Notes that the buffer of just these bytes is given, if it is one of such elements: from then on nothing in it is read.
    /// With `over` its memory goes over, unless somebody else has it; otherwise it stays where it is. O(log buffers).
    pub(crate) fn give<T: Element>(&mut self, at: usize, bytes: usize, over: bool) -> Given<T> {
        let whole = |b: &&mut Buffer| (b.end, b.memory.element()) == (at + bytes, T::ELEMENT);
        let Some(buffer) = self.0.as_mut().and_then(|all| all.get_mut(&at)).filter(whole) else { return Given::No };
        buffer.given = true;
        over.then(|| T::take(&mut buffer.memory)).flatten().map_or(Given::Stays, Given::Over)
    }

    /// Counts memory that somebody else has among the buffers.
    pub fn lend(&mut self, element: tenon_element, at: NonNull<u8>, bytes: u64) -> *mut c_void {
        let start = at.addr().get();
        self.add(start..start.saturating_add(usize::try_from(bytes).unwrap_or(usize::MAX)), Memory::Elsewhere(element));
        at.as_ptr().cast()
    }

    fn add(&mut self, range: Range<usize>, memory: Memory) {
        let all = self.0.get_or_insert_default();
        // What is gone although it was given may lie there anew; the parts before and behind stay given.
        while let Some((&start, &Buffer { end, ref memory, .. })) = all.range(..range.end).next_back()
            && end > range.start
        {
            let element = memory.element();
            all.remove(&start);
            for part in [start..range.start, range.end..end].into_iter().filter(|part| !part.is_empty()) {
                all.insert(part.start, Buffer { end: part.end, given: true, memory: Memory::Elsewhere(element) });
            }
        }
        all.insert(range.start, Buffer { end: range.end, given: false, memory });
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
pub(crate) trait Element: Pod {
    const ELEMENT: tenon_element;
    /// What is there goes elsewhere; `None`: it is there already.
    fn take(memory: &mut Memory) -> Option<Vec<Self>>;
}

macro_rules! elements {
    ($($type:ty, $variant:ident, $element:ident;)*) => {
        $(
            impl Element for $type {
                const ELEMENT: tenon_element = $element;
                fn take(memory: &mut Memory) -> Option<Vec<Self>> {
                    let Memory::$variant(v) = memory else { return None };
                    let v = std::mem::take(v);
                    *memory = Memory::Elsewhere($element);
                    Some(v)
                }
            }
        )*

        impl Memory {
            fn element(&self) -> tenon_element {
                match self {
                    $(Self::$variant(_) => $element,)*
                    Self::Elsewhere(element) => *element,
                }
            }
        }
    };
}

elements! {
    u8, U8, TENON_U8;
    u32, U32, TENON_U32;
    i64, I64, TENON_I64;
    f64, F64, TENON_F64;
    tenon_vec3, Vec3, TENON_VEC3;
    tenon_vec4, Vec4, TENON_VEC4;
    tenon_plane, Plane, TENON_PLANES;
    tenon_edge, Edge, TENON_EDGE_REFS;
    tenon_address, Address, TENON_ADDRESSES;
}
