//! Texts that are made for the caller: saved graphs, descriptions.

use crate::error::guard_or;
use crate::handle::{self, Object};
use tenon_plugin::abi::value::tenon_str;

/// A text made for the caller, who frees it with `tenon_text_free`.
pub struct tenon_text {
    _opaque: [u8; 0],
}

pub(crate) fn give(text: String) -> *mut tenon_text {
    handle::give(Object::Text(text.into()))
}

/// The text, good until it is freed; empty for NULL or a freed one. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_text_get(text: *const tenon_text) -> tenon_str {
    guard_or(tenon_str::of(""), || Ok(tenon_str::of(&handle::text(text)?)))
}

/// Frees a text. NULL and texts that were freed before do nothing. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_text_free(text: *mut tenon_text) {
    guard_or((), || {
        handle::free(text);
        Ok(())
    });
}
