//! Values as they cross to another process: what is small as bytes, arrays as places in the shared memory. Nothing that
//! comes is trusted: lengths are checked before anything is read, and the checks of [`crate::sound`] are made again.

use super::memory::Memory;
use crate::abi::value::*;
use crate::load::{Message, NodeInfo, PluginInfo, PortInfo};
use crate::value::{Attribute, Branch, Curve, Feature, Features, File, Items, Machining, Mesh, Panels, Table};
use bytemuck::Pod;
use std::borrow::Cow;

/// Why bytes are no message. It names what was being read.
#[derive(Debug, thiserror::Error)]
pub(super) enum Garbled {
    #[error("a message ends too early")]
    Short,
    #[error("a message has the unknown mark {0}")]
    Mark(u8),
    #[error("an array of {count} items at {at} lies outside the shared memory")]
    Place { at: u64, count: u64 },
    #[error("a text is not UTF-8")]
    Text,
    #[error("{0}")]
    Value(#[from] crate::BadValue),
}

/// What the other side is to read.
pub(super) struct Put<'m> {
    pub bytes: Vec<u8>,
    memory: &'m Memory,
    /// An array found no room.
    pub full: bool,
}

/// What the other side wrote.
pub(super) struct Take<'a> {
    bytes: &'a [u8],
    memory: &'a Memory,
    /// Arrays are read in place; otherwise they are copied out, since the other side may still write there.
    in_place: bool,
}

/// What crosses.
pub(super) trait Wire<'a>: Sized {
    fn put(&self, to: &mut Put<'_>);
    fn take(from: &mut Take<'a>) -> Result<Self, Garbled>;
}

impl<'m> Put<'m> {
    pub fn new(memory: &'m Memory) -> Self {
        Self { bytes: Vec::with_capacity(256), memory, full: false }
    }

    fn array<T: Pod>(&mut self, items: &[T]) {
        let at = if items.is_empty() { Some(0) } else { self.memory.place(bytemuck::cast_slice(items)) };
        self.full |= at.is_none();
        at.unwrap_or(0).put(self);
        (items.len() as u64).put(self);
    }
}

impl<'a> Take<'a> {
    /// Reads `bytes`, arrays in place.
    pub fn in_place(bytes: &'a [u8], memory: &'a Memory) -> Self {
        Self { bytes, memory, in_place: true }
    }

    /// Reads `bytes`, arrays copied.
    pub fn copied(bytes: &'a [u8], memory: &'a Memory) -> Self {
        Self { bytes, memory, in_place: false }
    }

    fn bytes(&mut self, count: usize) -> Result<&'a [u8], Garbled> {
        let (front, rest) = self.bytes.split_at_checked(count).ok_or(Garbled::Short)?;
        self.bytes = rest;
        Ok(front)
    }

    fn array<T: Pod>(&mut self) -> Result<Cow<'a, [T]>, Garbled> {
        let (at, count) = (u64::take(self)?, u64::take(self)?);
        if count == 0 {
            return Ok(Cow::Borrowed(&[]));
        }
        let read = match self.in_place {
            true => self.memory.view(at, count).map(Cow::Borrowed),
            false => self.memory.copy(at, count).map(Cow::Owned),
        };
        read.ok_or(Garbled::Place { at, count })
    }
}

macro_rules! numbers {
    ($($type:ty),*) => { $(
        impl<'a> Wire<'a> for $type {
            fn put(&self, to: &mut Put<'_>) {
                to.bytes.extend_from_slice(&self.to_le_bytes());
            }
            fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
                let bytes = from.bytes(size_of::<Self>())?;
                Ok(Self::from_le_bytes(bytes.try_into().map_err(|_| Garbled::Short)?))
            }
        }
    )* };
}
numbers!(u8, u32, i32, u64, f64);

macro_rules! arrays {
    ($($type:ty),*) => { $(
        impl<'a> Wire<'a> for Cow<'a, [$type]> {
            fn put(&self, to: &mut Put<'_>) {
                to.array(self);
            }
            fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
                from.array()
            }
        }
    )* };
}
arrays!(u8, u32, i32, i64, f64, tenon_vec3, tenon_vec4, tenon_plane, tenon_edge, tenon_address, tenon_edge_pair);

impl<'a> Wire<'a> for Cow<'a, [bool]> {
    fn put(&self, to: &mut Put<'_>) {
        to.array::<u8>(bytemuck::cast_slice(self));
    }
    fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
        Ok(from.array::<u8>()?.iter().map(|b| *b != 0).collect())
    }
}

impl<'a> Wire<'a> for bool {
    fn put(&self, to: &mut Put<'_>) {
        u8::from(*self).put(to);
    }
    fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
        Ok(u8::take(from)? != 0)
    }
}

impl<'a> Wire<'a> for usize {
    fn put(&self, to: &mut Put<'_>) {
        (*self as u64).put(to);
    }
    fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
        usize::try_from(u64::take(from)?).map_err(|_| Garbled::Short)
    }
}

impl<'a> Wire<'a> for Cow<'a, str> {
    fn put(&self, to: &mut Put<'_>) {
        self.len().put(to);
        to.bytes.extend_from_slice(self.as_bytes());
    }
    fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
        let count = usize::take(from)?;
        std::str::from_utf8(from.bytes(count)?).map(Cow::Borrowed).map_err(|_| Garbled::Text)
    }
}

impl<'a> Wire<'a> for String {
    fn put(&self, to: &mut Put<'_>) {
        Cow::Borrowed(self.as_str()).put(to);
    }
    fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
        Cow::<'a, str>::take(from).map(Cow::into_owned)
    }
}

impl<'a, T: Wire<'a>> Wire<'a> for Option<T> {
    fn put(&self, to: &mut Put<'_>) {
        self.is_some().put(to);
        self.iter().for_each(|x| x.put(to));
    }
    fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
        if bool::take(from)? { T::take(from).map(Some) } else { Ok(None) }
    }
}

impl<'a, T: Wire<'a>> Wire<'a> for Vec<T> {
    fn put(&self, to: &mut Put<'_>) {
        self.len().put(to);
        self.iter().for_each(|x| x.put(to));
    }
    fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
        // Grows as items come: the number alone must not take memory.
        (0..usize::take(from)?).map(|_| T::take(from)).collect()
    }
}

impl<'a, A: Wire<'a>, B: Wire<'a>> Wire<'a> for (A, B) {
    fn put(&self, to: &mut Put<'_>) {
        self.0.put(to);
        self.1.put(to);
    }
    fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
        Ok((A::take(from)?, B::take(from)?))
    }
}

/// Structs field by field; `checked` ones keep what [`crate::sound`] says.
macro_rules! structs {
    ($($type:ty { $($field:ident),* } $($check:ident)?;)*) => { $(
        impl<'a> Wire<'a> for $type {
            fn put(&self, to: &mut Put<'_>) {
                $(self.$field.put(to);)*
            }
            fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
                let read = Self { $($field: Wire::take(from)?),* };
                $(read.$check()?;)?
                Ok(read)
            }
        }
    )* };
}
structs! {
    tenon_vec3 { x, y, z };
    Branch<'a> { path, items, valid };
    Curve<'a> { points, strip_start, closed } check;
    Mesh<'a> { points, face_start, face_vertices, addresses } check;
    Panels<'a> {
        thickness, corner_start, address, normal, front, vertex, chamfer, neighbour, side, back_start, back_end, voided
    } check;
    Features<'a> { features, hardware };
    Feature<'a> { panel, edge, joint, by_hand, purpose, machining } check;
    File<'a> { name, bytes, withheld };
    Table<'a> { rows, attributes } check;
    Message { severity, code, message, hint, port, item };
    PluginInfo { id, version, vendor, doc, nodes };
    NodeInfo { id, version, name, category, doc, keywords, inputs, outputs, slow, fastener, migrate_from };
    PortInfo { name, doc, kind, access, unit, default_json, range, choices, optional };
}

impl<'a> Wire<'a> for Attribute<'a> {
    fn put(&self, to: &mut Put<'_>) {
        self.name.put(to);
        self.items.put(to);
        self.valid.put(to);
    }
    fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
        let name = Wire::take(from)?;
        // Tables hold no tables, so that nothing here nests.
        match from.bytes.first() {
            Some(mark @ 8..=254) => Err(Garbled::Mark(*mark)),
            _ => Ok(Self { name, items: Wire::take(from)?, valid: Wire::take(from)? }),
        }
    }
}

/// Enums by a mark.
macro_rules! marked {
    ($type:ty: $($mark:literal $variant:ident { $($field:ident),* };)*) => {
        impl<'a> Wire<'a> for $type {
            fn put(&self, to: &mut Put<'_>) {
                match self {
                    $(Self::$variant { $($field),* } => { to.bytes.push($mark); $($field.put(to);)* })*
                }
            }
            fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
                match u8::take(from)? {
                    $($mark => Ok(Self::$variant { $($field: Wire::take(from)?),* }),)*
                    other => Err(Garbled::Mark(other)),
                }
            }
        }
    };
}
marked! { Machining<'a>:
    0 Drill { entry, axis, depth, diameter };
    1 Slot { from, to, axis, width, depth };
    2 Pocket { outline, axis, depth };
    3 Contour { line, axis };
    4 Engraving { origin, along, axis, height, depth, text };
}

/// The same for variants of one field without a name.
macro_rules! wrapped {
    ($type:ty: $($mark:literal $variant:ident;)*) => {
        impl<'a> Wire<'a> for $type {
            fn put(&self, to: &mut Put<'_>) {
                match self {
                    $(Self::$variant(x) => { to.bytes.push($mark); x.put(to); })*
                    Self::Opaque { type_name, count } => { to.bytes.push(255); type_name.put(to); count.put(to); }
                }
            }
            fn take(from: &mut Take<'a>) -> Result<Self, Garbled> {
                match u8::take(from)? {
                    $($mark => Wire::take(from).map(Self::$variant),)*
                    255 => Ok(Self::Opaque { type_name: Wire::take(from)?, count: Wire::take(from)? }),
                    other => Err(Garbled::Mark(other)),
                }
            }
        }
    };
}
wrapped! { Items<'a>:
    1 Boolean; 2 Integer; 3 Number; 4 Text; 5 Point; 6 Vector; 7 Plane; 8 Curve; 9 Mesh; 10 Panels; 11 Features; 12 File;
    13 Edges; 14 Table;
}
