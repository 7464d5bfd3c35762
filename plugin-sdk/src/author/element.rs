//! What the host's buffers can hold.

use crate::abi::plugin::*;
use crate::abi::value::*;
use bytemuck::Zeroable;

mod sealed {
    pub trait Sealed {}
}

/// A type of numbers in buffers of the host, see [`super::Call::buffer`].
pub trait Element: Copy + Zeroable + sealed::Sealed {
    /// What the contract calls it.
    const ELEMENT: tenon_element;
}

macro_rules! elements {
    ($($type:ty, $element:ident;)*) => { $(
        impl sealed::Sealed for $type {}
        impl Element for $type {
            const ELEMENT: tenon_element = $element;
        }
    )* };
}

elements! {
    bool, TENON_U8; u8, TENON_U8; u32, TENON_U32; i64, TENON_I64; f64, TENON_F64; tenon_vec3, TENON_VEC3; tenon_vec4, TENON_VEC4;
    tenon_plane, TENON_PLANES; tenon_edge, TENON_EDGE_REFS; tenon_address, TENON_ADDRESSES;
}
