//! Errors as handles, and the guard around every function: no panic leaves the library.

use crate::handle::{self, Object};
use ::tenon_engine::Diagnostic;
use std::panic::{AssertUnwindSafe, catch_unwind};
use tenon_plugin::abi::value::{TENON_BAD_ARGUMENT, TENON_FAILED, TENON_INTERNAL, tenon_status, tenon_str};

/// Why a call failed. Functions that can fail give NULL when all is well, otherwise one of these, which the caller
/// frees with `tenon_error_free`.
pub struct tenon_error {
    _opaque: [u8; 0],
}

/// What a `tenon_error` stands for.
#[derive(Clone, Debug)]
pub struct Failure {
    status: tenon_status,
    message: String,
    node: String,
}

impl Failure {
    pub(crate) fn argument(message: impl Into<String>) -> Self {
        Self { status: TENON_BAD_ARGUMENT, message: message.into(), node: String::new() }
    }

    /// Something that the system does not give.
    pub(crate) fn system(message: impl Into<String>) -> Self {
        Self { status: TENON_FAILED, message: message.into(), node: String::new() }
    }

    /// A panic that was caught.
    pub(crate) fn fault(panic: &(dyn std::any::Any + Send)) -> Self {
        let message = format!("libtenon has a fault; please report it: {}", words(panic));
        Self { status: TENON_INTERNAL, message, node: String::new() }
    }

    pub(crate) fn status(&self) -> tenon_status {
        self.status
    }

    pub(crate) fn of(diagnostics: &[Diagnostic]) -> Self {
        let message = diagnostics.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n");
        let node = diagnostics.iter().find_map(|d| d.node.as_deref()).unwrap_or_default().to_owned();
        Self { status: TENON_FAILED, message, node }
    }
}

/// What a caught panic says.
fn words(panic: &(dyn std::any::Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("no message")
}

/// Runs the body of a function that can fail.
pub(crate) fn guard(body: impl FnOnce() -> Result<(), Failure>) -> *mut tenon_error {
    let failure = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => return std::ptr::null_mut(),
        Ok(Err(failure)) => failure,
        Err(panic) => Failure::fault(&*panic),
    };
    handle::give(Object::Error(failure.into()))
}

/// Runs the body of a function that has another way to say that there is nothing.
pub(crate) fn guard_or<T>(otherwise: T, body: impl FnOnce() -> Result<T, Failure>) -> T {
    catch_unwind(AssertUnwindSafe(body)).ok().and_then(Result::ok).unwrap_or(otherwise)
}

/// The kind of error, `TENON_BAD_ARGUMENT` and so on; `TENON_OK` for NULL. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_error_status(error: *const tenon_error) -> tenon_status {
    if error.is_null() {
        return tenon_plugin::abi::value::TENON_OK;
    }
    guard_or(TENON_BAD_ARGUMENT, || Ok(handle::error(error)?.status))
}

/// A sentence for people, good until the error is freed; empty for NULL. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_error_message(error: *const tenon_error) -> tenon_str {
    guard_or(tenon_str::of(""), || Ok(tenon_str::of(&handle::error(error)?.message)))
}

/// The node concerned, good until the error is freed; empty if there is none. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_error_node(error: *const tenon_error) -> tenon_str {
    guard_or(tenon_str::of(""), || Ok(tenon_str::of(&handle::error(error)?.node)))
}

/// Frees an error. NULL and errors that were freed before do nothing. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_error_free(error: *mut tenon_error) {
    guard_or((), || {
        handle::free(error);
        Ok(())
    });
}

/// Number of handles of all kinds that were given and not freed yet: 0 at the end of a host that frees everything.
/// [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_handle_count() -> u64 {
    guard_or(0, || Ok(handle::count() as u64))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_panic_leaves_the_library() {
        let error = guard(|| panic!("one {}", "too many"));
        assert_eq!(tenon_error_status(error), TENON_INTERNAL);
        let failure = handle::error(error).unwrap();
        assert_eq!(failure.message, "libtenon has a fault; please report it: one too many");
        tenon_error_free(error);
        assert_eq!(guard_or(7, || panic!("another")), 7);
    }
}
