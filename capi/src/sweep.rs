//! Rows of sweeps: evaluated by a warm engine, their results in a folder that machines share.

use crate::engine::tenon_engine;
use crate::error::{Failure, guard, guard_or, tenon_error};
use crate::handle::{self, Object};
use crate::job::{Listener, tenon_evaluate_options};
use crate::read;
use crate::text::{self, tenon_text};
use ::tenon_engine::sweep::Row;
use ::tenon_engine::{Control, Progress};
use std::ffi::c_char;
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use tenon_nodes::host::output::prepare_folder;
use tenon_nodes::host::sweep::{Bench, Found, Inputs, Lock, Planned, SweepError, found};

/// Evaluates rows of sweeps one after another and keeps what they have in common. Free it with `tenon_sweep_free`. Calls
/// with the same one wait for one another.
pub struct tenon_sweep {
    _opaque: [u8; 0],
}

/// What a `tenon_sweep` stands for.
pub struct Sweep(Mutex<Bench>);

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        match error {
            SweepError::Refused { ref because, .. } => Self::of(&[(**because).clone()]),
            error => Self::argument([error.to_string()].into_iter().chain(error.hint()).collect::<Vec<_>>().join("; ")),
        }
    }
}

/// Makes one with an engine's node types and settings. Fails if the engine is none. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_sweep_new(engine: *const tenon_engine, out: *mut *mut tenon_sweep) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let engine = handle::engine(engine)?;
        let bench = Bench::new(engine.plugins.clone(), engine.threads, engine.cache_bytes, None);
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(handle::give(Object::Sweep(Sweep(bench.into()).into()))) };
        Ok(())
    })
}

/// Frees one. NULL and those that were freed before do nothing. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_sweep_free(sweep: *mut tenon_sweep) {
    guard_or((), || {
        handle::free(sweep);
        Ok(())
    });
}

/// Evaluates a row, a line of a plan that `tenon sweep plan` has made and that lies in `folder`, and writes its result as
/// `results/KEY` whole or not at all, as `tenon sweep run-row` does; a result that is there and whole is left as it is.
/// Writes its `result.json`, or NULL if `progress` has cancelled. Many processes and machines may do so in one folder. Fails
/// if the line is no row, the graph is another than when it was planned, an input refuses a value or the result cannot be
/// written; that nodes failed stands in the result. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_sweep_row(
    sweep: *mut tenon_sweep,
    line: *const c_char,
    folder: *const c_char,
    results: *const c_char,
    options: *const tenon_evaluate_options,
    out: *mut *mut tenon_text,
) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let sweep = handle::sweep(sweep)?;
        // SAFETY: the header asks for NUL-terminated strings.
        let [line, folder, results] =
            unsafe { [read::text(line, "line")?, read::text(folder, "folder")?, read::text(results, "results")?] };
        // SAFETY: the header asks for NULL or a struct of that size.
        let options = unsafe { read::options(options, tenon_evaluate_options::DEFAULT, "options")? };
        let row = Row::from_line(line).ok_or_else(|| Failure::argument("the line is no row of a sweep"))?;
        let planned = Planned::new(row, Path::new(folder));
        let results = Path::new(results);
        prepare_folder(results).map_err(|e| Failure::argument(e.to_string()))?;
        let _lock = Lock::shared(results)?;
        let mut bench = sweep.0.lock().unwrap_or_else(PoisonError::into_inner);
        // A plan of another graph is refused even where the result is there.
        bench.load(&planned)?;
        let result = match found(results, &planned, &mut Inputs::default()) {
            Found::Finished(result) => Some(result),
            _ => {
                let (listener, cancel) = (Listener::new(options), Arc::new(AtomicBool::new(false)));
                let hear = |p: &Progress| {
                    if !listener.hear(p) {
                        cancel.store(true, Ordering::Release);
                    }
                };
                let control = Control { cancel: cancel.clone(), on_progress: Some(&hear) };
                bench.evaluate(&planned, &control, results)?.map(|made| made.result)
            }
        };
        let text = result.map_or(std::ptr::null_mut(), |result| text::give(result.to_string()));
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(text) };
        Ok(())
    })
}
