//! Reading what C gives: texts, structs that grow, places for results. All `unsafe` of arguments is here.

use crate::error::Failure;
use std::ffi::{CStr, c_char};

/// The NUL-terminated text at `text`; `name` names the argument in errors.
///
/// # Safety
/// `text` is NULL or points to a NUL-terminated string that nobody changes during `'a`.
pub(crate) unsafe fn text<'a>(text: *const c_char, name: &str) -> Result<&'a str, Failure> {
    if text.is_null() {
        return Err(Failure::argument(format!("{name} is NULL")));
    }
    // SAFETY: not NULL, and the caller vouches for the rest.
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|e| Failure::argument(format!("{name} is not UTF-8 after byte {}", e.valid_up_to())))
}

/// `count` NUL-terminated texts.
///
/// # Safety
/// `texts` is NULL or points to so many pointers as for [`text`].
pub(crate) unsafe fn texts<'a>(texts: *const *const c_char, count: u64, name: &str) -> Result<Vec<&'a str>, Failure> {
    if count > 0 && (texts.is_null() || !texts.is_aligned()) {
        return Err(Failure::argument(format!("{name} is NULL or misaligned")));
    }
    if count > 1 << 20 {
        return Err(Failure::argument(format!("{count} {name} are given; 2^20 is the most")));
    }
    // SAFETY: not NULL, and the caller vouches for the rest.
    (0..count as usize).map(|i| unsafe { text(*texts.add(i), &format!("{name}[{i}]")) }).collect()
}

/// `count` bytes at `bytes`.
///
/// # Safety
/// `bytes` is NULL or points to `count` bytes that nobody changes during `'a`.
pub(crate) unsafe fn bytes<'a>(bytes: *const c_char, count: u64, name: &str) -> Result<&'a [u8], Failure> {
    let count = usize::try_from(count).ok().filter(|c| *c <= isize::MAX as usize);
    match count {
        Some(0) => Ok(&[]),
        _ if bytes.is_null() => Err(Failure::argument(format!("{name} is NULL"))),
        // SAFETY: not NULL, of possible length, and the caller vouches for the rest; bytes have no alignment.
        Some(count) => Ok(unsafe { std::slice::from_raw_parts(bytes.cast(), count) }),
        None => Err(Failure::argument(format!("the length of {name} is impossible"))),
    }
}

/// The place for a result; said before anything is done.
pub(crate) fn place<T>(out: *mut T, name: &str) -> Result<*mut T, Failure> {
    if out.is_null() || !out.is_aligned() {
        return Err(Failure::argument(format!("{name} is NULL or misaligned")));
    }
    Ok(out)
}

/// Structs whose first field is their size in bytes.
///
/// # Safety
/// The type is `repr(C)`, consists of plain data that any bytes are good for, and starts with `size: u32`.
pub(crate) unsafe trait Sized32: Copy {}

/// Writes `value` as far as the caller's version of the struct reaches, and says in `size` how far that was.
///
/// # Safety
/// `out` is NULL or points to a struct of that kind whose `size` says how many bytes may be written.
pub(crate) unsafe fn fill<T: Sized32>(out: *mut T, value: T, name: &str) -> Result<(), Failure> {
    let out = place(out, name)?;
    // SAFETY: not NULL, aligned, and its first field is the size, as the caller vouches.
    let size = unsafe { *out.cast::<u32>() };
    if (size as usize) < 8 {
        return Err(Failure::argument(format!("{name}.size is {size}; set it to sizeof *{name} before the call")));
    }
    let reach = (size as usize).min(size_of::<T>());
    // SAFETY: both reach so far; they do not overlap, since `value` is our own.
    unsafe {
        std::ptr::copy_nonoverlapping((&raw const value).cast::<u8>(), out.cast::<u8>(), reach);
        *out.cast::<u32>() = reach as u32;
    }
    Ok(())
}

/// A struct that the caller filled; fields past its `size` keep the value of `default`. NULL gives `default`.
///
/// # Safety
/// `given` is NULL or points to a struct of that kind, readable as far as its `size` says.
pub(crate) unsafe fn options<T: Sized32>(given: *const T, default: T, name: &str) -> Result<T, Failure> {
    if given.is_null() {
        return Ok(default);
    }
    if !given.is_aligned() {
        return Err(Failure::argument(format!("{name} is misaligned")));
    }
    // SAFETY: not NULL, aligned, and its first field is the size, as the caller vouches.
    let size = unsafe { *given.cast::<u32>() };
    if (size as usize) < 8 {
        return Err(Failure::argument(format!("{name}.size is {size}; set it to sizeof *{name} before the call")));
    }
    let mut value = default;
    let reach = (size as usize).min(size_of::<T>());
    // SAFETY: both reach so far, and any bytes are good for such a struct.
    unsafe { std::ptr::copy_nonoverlapping(given.cast::<u8>(), (&raw mut value).cast::<u8>(), reach) };
    Ok(value)
}
