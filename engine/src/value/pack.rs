//! Values as bytes that outlive the process: serde's derives in the postcard format, one after another.

use serde::{Deserialize, Serialize};

/// Appends `value`; false if its type cannot be written in this format (`flatten`, sequences of unknown length). Floats keep
/// every bit. O(bytes).
pub fn pack<T: Serialize + ?Sized>(value: &T, out: &mut Vec<u8>) -> bool {
    let before = out.len();
    match postcard::to_extend(value, std::mem::take(out)) {
        Ok(longer) => {
            *out = longer;
            out.len() > before
        }
        // What was written so far is lost with it: whoever is told false keeps nothing.
        Err(_) => false,
    }
}

/// Takes a value that [`pack`] has written off the front of `bytes`; `None` if it is none. Whatever the bytes are, it
/// neither panics nor takes more memory than in proportion to their number. O(bytes).
pub fn unpack<'a, T: Deserialize<'a>>(bytes: &mut &'a [u8]) -> Option<T> {
    let (value, rest) = postcard::take_from_bytes(bytes).ok()?;
    *bytes = rest;
    Some(value)
}
