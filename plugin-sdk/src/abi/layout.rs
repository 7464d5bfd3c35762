//! Where every field of every struct of the contract lies, as this compiler laid it out. Plugins made by the Rust layer carry
//! it, so that one built from a source of the contract that was changed, or by a compiler that lays out otherwise, is
//! refused when it is loaded and not met as rubbish later.

use super::plugin::*;
use super::value::*;
use std::ffi::c_void;

/// A field of a struct; a whole struct that never grows if `name` is empty; a field's type if `name` ends with [`TYPE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Field {
    /// The struct.
    pub of: &'static str,
    /// The field.
    pub name: &'static str,
    /// Bytes before it; of a type the lower half of its number.
    pub offset: u32,
    /// Its bytes; 0: it may grow; of a type the upper half of its number.
    pub bytes: u32,
}

/// What a field's name ends with where its type is meant. Programs that do not know of it take it for a field that is new.
pub const TYPE: &str = ": type";

/// Types of fields by a number that depends on nothing but what they are. Structs count by their names: what they hold is
/// looked at by itself.
trait Kind {
    const NUMBER: u64;
}

const fn add(mut digest: u64, bytes: &[u8]) -> u64 {
    let mut i = 0;
    while i < bytes.len() {
        digest = (digest ^ bytes[i] as u64).wrapping_mul(0x0100_0000_01b3);
        i += 1;
    }
    digest
}

/// FNV-1a of nothing.
const NOTHING: u64 = 0xcbf2_9ce4_8422_2325;

macro_rules! kinds {
    ($($type:ty: $name:expr;)*) => { $(
        impl Kind for $type {
            const NUMBER: u64 = add(NOTHING, $name.as_bytes());
        }
    )* };
}

kinds! {
    (): "nothing"; u8: "u8"; u32: "u32"; i32: "i32"; u64: "u64"; i64: "i64"; f64: "f64"; i8: "i8"; c_void: "void";
}

impl<T: Kind> Kind for *const T {
    const NUMBER: u64 = add(add(NOTHING, b"pointer to"), &T::NUMBER.to_le_bytes());
}

impl<T: Kind> Kind for *mut T {
    const NUMBER: u64 = add(add(NOTHING, b"pointer to changeable"), &T::NUMBER.to_le_bytes());
}

// In C both are a pointer that may be NULL.
impl<T: Kind> Kind for Option<T> {
    const NUMBER: u64 = T::NUMBER;
}

macro_rules! functions {
    ($(($($of:ident)*))*) => { $(
        impl<R: Kind, $($of: Kind),*> Kind for unsafe extern "C" fn($($of),*) -> R {
            const NUMBER: u64 = {
                let number = add(add(NOTHING, b"function"), &R::NUMBER.to_le_bytes());
                $(let number = add(number, &$of::NUMBER.to_le_bytes());)*
                number
            };
        }
    )* };
}

functions! { () (A) (A B) (A B C) (A B C D) (A B C D E) (A B C D E F) }

/// The number of the type of the field that a function gives.
const fn number<S, F: Kind>(_: fn(&S) -> &F) -> u64 {
    F::NUMBER
}

/// Bytes of the field that a function gives.
const fn bytes<S, F>(_: fn(&S) -> &F) -> u32 {
    size_of::<F>() as u32
}

macro_rules! layout {
    ($($growth:ident $name:ident { $($field:ident $(: $grown:ident)?),* })*) => {
        /// All fields, struct by struct.
        pub const FIELDS: &[Field] = &[$(
            layout!(@$growth $name),
            $(Field {
                of: stringify!($name),
                name: stringify!($field),
                offset: std::mem::offset_of!($name, $field) as u32,
                bytes: layout!(@bytes $name $field $($grown)?),
            },
            Field {
                of: stringify!($name),
                name: concat!(stringify!($field), ": type"),
                offset: number(|s: &$name| &s.$field) as u32,
                bytes: (number(|s: &$name| &s.$field) >> 32) as u32,
            }),*
        ),*];

        kinds! { $($name: stringify!($name);)* }

        /// No field is forgotten above: a pattern must name them all.
        const _: () = {
            $(let _ = |s: &$name| {
                let $name { $($field: _),* } = s;
            };)*
        };
    };
    (@bytes $name:ident $field:ident) => {
        bytes(|s: &$name| &s.$field)
    };
    (@bytes $name:ident $field:ident grows) => {
        0
    };
    (@fixed $name:ident) => {
        Field { of: stringify!($name), name: "", offset: 0, bytes: size_of::<$name>() as u32 }
    };
    // What grows begins with its size or lies as far apart as a stride says: its whole size is nobody's business.
    (@grows $name:ident) => {
        Field { of: stringify!($name), name: "", offset: 0, bytes: 0 }
    };
}

layout! {
    fixed tenon_str { ptr, len }
    fixed tenon_vec3 { x, y, z }
    fixed tenon_vec4 { x, y, z, w }
    fixed tenon_plane { normal, offset }
    fixed tenon_address { patch, row, column }
    fixed tenon_edge { panel, edge }
    grows tenon_curve { size, closed, points, point_count, strip_start, strip_count }
    grows tenon_mesh {
        size, flags, points, point_count, face_start, face_count, face_vertices, face_vertex_count, addresses
    }
    grows tenon_panels {
        size, flags, thickness, panel_count, corner_count, corner_start, address, normal, front, vertex, chamfer,
        neighbour, side, back_start, back_end, voided
    }
    grows tenon_feature {
        size, kind, panel, edge, joint, by_hand, at, to, axis, depth, width, line, line_count, text, purpose
    }
    fixed tenon_hardware { name, count }
    grows tenon_features { size, feature_stride, features, feature_count, hardware, hardware_count }
    fixed tenon_file { name, bytes, byte_count, withheld }
    fixed tenon_edge_pair { first, second, start, end, angle }
    grows tenon_column { size, kind, type_name, items, count, stride, valid }
    grows tenon_attribute { name, column: grows }
    grows tenon_table { size, attribute_stride, row_count, attributes, attribute_count }
    grows tenon_branch { path, path_count, column: grows }
    fixed tenon_tree { size, branch_stride, branches, branch_count }
    grows tenon_port { size, flags, kind, access, name, doc, unit, default_json, min, max, choices, choice_count }
    grows tenon_message { size, severity, code, message, hint, port, item }
    grows tenon_call { size, flags, host, cancelled, progress, tell, buffer, set, forward }
    grows tenon_node_type {
        size, flags, id, version, input_count, inputs, outputs, output_count, port_stride, name, category, doc,
        keywords, data, evaluate, migrate, migrate_from, reserved
    }
    fixed tenon_field { of, name, offset, bytes }
    grows tenon_layout { size, field_stride, digest, fields, field_count }
    grows tenon_plugin {
        magic, size, abi_major, abi_minor, id, version, vendor, doc, nodes, node_count, node_stride, layout
    }
}

/// FNV-1a of fields; see [`tenon_layout::digest`].
#[must_use]
pub const fn digest(fields: &[Field]) -> u64 {
    let (mut digest, mut i) = (NOTHING, 0);
    while i < fields.len() {
        let f = &fields[i];
        digest = add(add(digest, f.of.as_bytes()), &[0]);
        digest = add(add(digest, f.name.as_bytes()), &[0]);
        digest = add(add(digest, &f.offset.to_le_bytes()), &f.bytes.to_le_bytes());
        i += 1;
    }
    digest
}

/// As the contract wants it.
pub static LAYOUT: tenon_layout = tenon_layout {
    size: size_of::<tenon_layout>() as u32,
    field_stride: size_of::<tenon_field>() as u32,
    digest: digest(FIELDS),
    fields: C_FIELDS.as_ptr(),
    field_count: FIELDS.len() as u64,
};

static C_FIELDS: [tenon_field; FIELDS.len()] = {
    let none = tenon_str { ptr: std::ptr::null(), len: 0 };
    let mut all = [tenon_field { of: none, name: none, offset: 0, bytes: 0 }; FIELDS.len()];
    let mut i = 0;
    while i < FIELDS.len() {
        let Field { of, name, offset, bytes } = FIELDS[i];
        all[i] = tenon_field { of: tenon_str::of(of), name: tenon_str::of(name), offset, bytes };
        i += 1;
    }
    all
};
