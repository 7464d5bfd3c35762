//! Evaluations: on the caller's thread, or on one of their own as jobs.

use crate::error::{Failure, guard, guard_or, tenon_error};
use crate::graph::{Graph, tenon_graph};
use crate::handle::{self, Object};
use crate::read;
use crate::result::{Evaluated, tenon_result};
use ::tenon_engine::{Control, Progress};
use std::cell::Cell;
use std::ffi::{c_char, c_void};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, mpsc};
use std::thread::ThreadId;
use std::time::{Duration, Instant};
use tenon_plugin::abi::value::{tenon_status, tenon_str};

/// An evaluation on a thread of its own. Free it with `tenon_job_free`, before or after it has ended.
pub struct tenon_job {
    _opaque: [u8; 0],
}

/// How to evaluate. Set `size` to `sizeof(tenon_evaluate_options)` and the rest to 0 or NULL for the defaults.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct tenon_evaluate_options {
    /// Bytes of this struct.
    pub size: u32,
    /// 0.
    pub flags: u32,
    /// Given to `progress` and `done` as it is.
    pub context: *mut c_void,
    /// Called at most about 30 times a second with the fraction done, 0 to 1, and the node at work, from threads of the
    /// library, one call at a time. Giving 0 cancels. It must return soon and must not throw. It may call the library, but
    /// what would wait for the evaluation that it stands in is refused.
    pub progress: Option<unsafe extern "C" fn(context: *mut c_void, fraction: f64, node: tenon_str) -> i32>,
    /// For `tenon_graph_start` only: called once with the status of the result (or of the error) when the job has ended,
    /// also when it was cancelled, from the job's own thread, after the last `progress`; not after `tenon_job_free` has
    /// returned. It may call the library, take the result and free the job. It must not throw.
    pub done: Option<unsafe extern "C" fn(context: *mut c_void, status: tenon_status)>,
}

// SAFETY: plain data and function pointers that may be NULL, size first.
unsafe impl read::Sized32 for tenon_evaluate_options {}

impl tenon_evaluate_options {
    pub(crate) const DEFAULT: Self =
        Self { size: 0, flags: 0, context: std::ptr::null_mut(), progress: None, done: None };
}

/// The caller's context and functions, called by one thread at a time.
pub(crate) struct Listener(Mutex<tenon_evaluate_options>);

// SAFETY: the context is only handed back to the caller's functions, which the header asks to be fit for any thread.
unsafe impl Sync for Listener {}
// SAFETY: see above.
unsafe impl Send for Listener {}

impl Listener {
    pub(crate) fn new(options: tenon_evaluate_options) -> Self {
        Self(options.into())
    }

    /// Tells of progress; false if the caller wants no more.
    pub(crate) fn hear(&self, progress: &Progress) -> bool {
        let options = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        // SAFETY: the caller gave function and context for each other; the text lives through the call.
        options
            .progress
            .is_none_or(|call| unsafe { call(options.context, progress.fraction, tenon_str::of(&progress.node)) != 0 })
    }
}

thread_local! {
    /// Graph and job in whose progress callback this thread stands, as addresses; 0: none.
    static INSIDE: Cell<(usize, usize)> = const { Cell::new((0, 0)) };
}

/// Marks a callback while it lives.
struct Inside((usize, usize));

impl Inside {
    fn of(job: &Job) -> Self {
        let here = (std::ptr::from_ref(&*job.graph).addr(), std::ptr::from_ref(job).addr());
        Self(INSIDE.replace(here))
    }
}

impl Drop for Inside {
    fn drop(&mut self) {
        INSIDE.set(self.0);
    }
}

/// Refuses to wait in a callback for what waits for the callback.
fn may_wait(graph: &Graph, instead: &str) -> Result<(), Failure> {
    if INSIDE.get().0 == std::ptr::from_ref(graph).addr() {
        return Err(Failure::argument(format!("a callback cannot wait for an evaluation of its own graph; {instead}")));
    }
    Ok(())
}

/// What a `tenon_job` stands for; blocking evaluations are jobs that nobody gets.
pub struct Job {
    graph: Arc<Graph>,
    turn: u64,
    names: Vec<String>,
    cancel: Arc<AtomicBool>,
    /// Bits of the fraction done.
    fraction: AtomicU64,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    outcome: Option<Result<Arc<Evaluated>, Failure>>,
    /// `done` has returned, or there is none.
    over: bool,
    /// Who calls `done`.
    caller: Option<ThreadId>,
}

impl Job {
    fn new(graph: Arc<Graph>, names: &[&str]) -> Arc<Self> {
        let turn = graph.queue();
        let job = Arc::new(Self {
            turn,
            names: names.iter().map(|n| (*n).to_owned()).collect(),
            cancel: Arc::default(),
            fraction: AtomicU64::new(0),
            state: Mutex::default(),
            changed: Condvar::new(),
            graph,
        });
        job.graph.jobs().push(job.clone());
        job
    }

    fn state(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn cancel(&self) {
        self.cancel.store(true, Ordering::Release);
        self.graph.turns.wake();
    }

    /// Waits for its turn, evaluates, leaves the turn.
    fn run(&self, listener: &Listener) -> Result<Arc<Evaluated>, Failure> {
        let done = catch_unwind(AssertUnwindSafe(|| self.evaluate(listener)));
        self.leave();
        done.map(Arc::new).map_err(|panic| Failure::fault(&*panic))
    }

    /// Lets the next come forward.
    fn leave(&self) {
        self.graph.turns.leave(self.turn);
        self.graph.jobs().retain(|job| !std::ptr::eq(&**job, self));
    }

    fn evaluate(&self, listener: &Listener) -> Evaluated {
        let Some(changes) = self.graph.turns.wait(self.turn, &self.cancel) else { return Evaluated::cancelled() };
        let mut session = self.graph.session.lock().unwrap_or_else(PoisonError::into_inner);
        // The draft has accepted them, so that they cannot be refused here; if one is, then not in silence.
        let refused: Vec<_> = changes.into_iter().filter_map(|change| change.apply(&mut session).err()).collect();
        let hear = |p: &Progress| self.hear(listener, p);
        let control = Control { cancel: self.cancel.clone(), on_progress: Some(&hear) };
        let names: Vec<&str> = self.names.iter().map(String::as_str).collect();
        let mut report = session.evaluate(&names, &control);
        report.diagnostics.extend(refused);
        // The log is read by nobody here and would grow for ever.
        session.take_events();
        Evaluated::new(&session, &names, report)
    }

    fn hear(&self, listener: &Listener, progress: &Progress) {
        self.fraction.store(progress.fraction.to_bits(), Ordering::Relaxed);
        let _inside = Inside::of(self);
        if !listener.hear(progress) {
            self.cancel.store(true, Ordering::Release);
        }
    }

    /// Runs on its own thread and tells whoever waits and listens.
    fn run_alone(&self, listener: &Listener) {
        let outcome = self.run(listener);
        let status = match &outcome {
            Ok(evaluated) => evaluated.status(),
            Err(failure) => failure.status(),
        };
        {
            let mut state = self.state();
            (state.outcome, state.caller) = (Some(outcome), Some(std::thread::current().id()));
        }
        self.changed.notify_all();
        let options = *listener.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(call) = options.done {
            // SAFETY: the caller gave function and context for each other.
            unsafe { call(options.context, status) };
        }
        self.state().over = true;
        self.changed.notify_all();
    }

    /// What it came to, waiting for it until `end` (`None`: as long as it takes); `None` if it has not ended by then.
    fn wait(&self, end: Option<Instant>) -> Option<Result<Arc<Evaluated>, Failure>> {
        let mut state = self.state();
        loop {
            if let Some(outcome) = &state.outcome {
                return Some(outcome.clone());
            }
            let wait = |state| self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
            state = match end.map(|end| end.saturating_duration_since(Instant::now())) {
                None => wait(state),
                Some(Duration::ZERO) => return None,
                Some(left) => self.changed.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0,
            };
        }
    }

    /// Cancels and waits until no callback can come any more, unless this is one of them.
    fn end(&self) {
        self.cancel();
        if INSIDE.get().1 == std::ptr::from_ref(self).addr() {
            return;
        }
        let mut state = self.state();
        while !state.over && state.caller != Some(std::thread::current().id()) {
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

/// A thread that does the work of a job once it is told to; without one, or when nobody is left to tell it, the job is over.
fn alone(job: &Arc<Job>, work: impl FnOnce() + Send + 'static) -> Result<mpsc::Sender<()>, Failure> {
    let (go, told) = mpsc::channel();
    let of = job.clone();
    let wait = move || match told.recv() {
        Ok(()) => work(),
        Err(_) => of.leave(),
    };
    if let Err(why) = thread(wait) {
        job.leave();
        return Err(Failure::system(format!("the system gives no thread: {why}")));
    }
    Ok(go)
}

fn thread(work: impl FnOnce() + Send + 'static) -> std::io::Result<()> {
    #[cfg(test)]
    if tests::NO_THREADS.get() {
        return Err(std::io::ErrorKind::WouldBlock.into());
    }
    std::thread::Builder::new().name("tenon-job".into()).spawn(work).map(drop)
}

/// Evaluates `count` outputs, each an interface output or `node.port`; with `count` 0 every interface output and every
/// node that makes files. Only what changed runs. Waits until it is done, behind the evaluations that were asked for
/// before. The result holds what the outputs come to for the graph as it stood at the call and stays as it is whatever
/// happens to the graph later; the caller frees it. That nodes failed is no error of this call: the result says it. Fails if
/// an argument is wrong. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_evaluate(
    graph: *mut tenon_graph,
    outputs: *const *const c_char,
    count: u64,
    options: *const tenon_evaluate_options,
    out: *mut *mut tenon_result,
) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let graph = handle::graph(graph)?;
        may_wait(&graph, "tenon_graph_start does not wait")?;
        // SAFETY: the header asks for `count` NUL-terminated strings.
        let names = unsafe { read::texts(outputs, count, "outputs")? };
        // SAFETY: the header asks for NULL or a struct of that size.
        let options = unsafe { read::options(options, tenon_evaluate_options::DEFAULT, "options")? };
        let evaluated = Job::new(graph, &names).run(&Listener::new(options))?;
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(handle::give(Object::Result(evaluated))) };
        Ok(())
    })
}

/// Starts the same on a thread of its own and returns at once. The job is of the graph as it stands at this call: what is
/// set and edited from then on is for later evaluations. Jobs of one graph run one after another. A host that follows a
/// slider cancels the job before and starts the next. Fails if an argument is wrong or the system gives no thread
/// (`TENON_FAILED`); then no callback comes. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_graph_start(
    graph: *mut tenon_graph,
    outputs: *const *const c_char,
    count: u64,
    options: *const tenon_evaluate_options,
    out: *mut *mut tenon_job,
) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let graph = handle::graph(graph)?;
        // SAFETY: the header asks for `count` NUL-terminated strings.
        let names = unsafe { read::texts(outputs, count, "outputs")? };
        // SAFETY: the header asks for NULL or a struct of that size.
        let options = unsafe { read::options(options, tenon_evaluate_options::DEFAULT, "options")? };
        let listener = Listener::new(options);
        let job = Job::new(graph, &names);
        let worker = job.clone();
        let go = alone(&job, move || worker.run_alone(&listener))?;
        // Before the job begins, since its callbacks may look there.
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(handle::give(Object::Job(job))) };
        // It cannot fail: the thread waits for it.
        let _ = go.send(());
        Ok(())
    })
}

/// Waits for a job, `milliseconds` at most: 0 only looks, UINT64_MAX waits as long as it takes. Writes a result, which the
/// caller frees, or NULL if the job has not ended by then. Every call after its end gives the result again. Fails if the
/// job is none, if its own callback would wait for it, or, with `TENON_INTERNAL`, if the evaluation met a fault of the
/// library. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_job_wait(
    job: *const tenon_job,
    milliseconds: u64,
    out: *mut *mut tenon_result,
) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let job = handle::job(job)?;
        let found = match (milliseconds, job.wait(Some(Instant::now()))) {
            (_, Some(outcome)) => Some(outcome),
            (0, None) => None,
            _ => {
                may_wait(&job.graph, "with 0 milliseconds it only looks")?;
                // What no clock can hold is for ever.
                job.wait(Instant::now().checked_add(Duration::from_millis(milliseconds)))
            }
        };
        let result = match found {
            Some(outcome) => handle::give(Object::Result(outcome?)),
            None => std::ptr::null_mut(),
        };
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(result) };
        Ok(())
    })
}

/// How far a job is, 0 to 1; 1 when it has ended, NaN for what is no job. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_job_progress(job: *const tenon_job) -> f64 {
    guard_or(f64::NAN, || {
        let job = handle::job(job)?;
        let ended = job.state().outcome.is_some();
        Ok(if ended { 1.0 } else { f64::from_bits(job.fraction.load(Ordering::Relaxed)).clamp(0.0, 1.0) })
    })
}

/// Asks a job to stop: if it has not ended by itself its result says that it was cancelled. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_job_cancel(job: *const tenon_job) {
    guard_or((), || {
        handle::job(job)?.cancel();
        Ok(())
    });
}

/// Frees a job; one that has not ended is cancelled. When this returns no callback of it runs or comes any more, except
/// where it is called from one of them. Results live on. NULL and jobs that were freed before do nothing. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_job_free(job: *mut tenon_job) {
    guard_or((), || {
        // Its callbacks may still ask for it.
        handle::job(job)?.end();
        handle::free(job);
        Ok(())
    });
}

/// Stops the evaluations of this graph that run or wait for their turn: their results say that they were cancelled, and
/// the graph is as it was before. [any thread, also while the graph is evaluated]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_graph_cancel(graph: *const tenon_graph) {
    guard_or((), || {
        let graph = handle::graph(graph)?;
        let jobs = graph.jobs().clone();
        jobs.iter().for_each(|job| job.cancel());
        Ok(())
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::{tenon_engine_free, tenon_engine_new};
    use crate::error::{tenon_error_free, tenon_error_message, tenon_error_status};
    use crate::graph::{tenon_graph_free, tenon_graph_load};
    use crate::result::tenon_result_free;
    use std::cell::Cell;
    use std::ptr::{null, null_mut};
    use tenon_plugin::abi::value::TENON_FAILED;

    thread_local! {
        /// As if the system had no thread for who calls from here.
        pub static NO_THREADS: Cell<bool> = const { Cell::new(false) };
    }

    /// What `test` does with a graph of no nodes.
    fn with_graph(test: impl FnOnce(*mut tenon_graph)) {
        let json = br#"{ "format": "tenon", "version": 1, "units": "mm", "nodes": {} }"#;
        let (mut engine, mut graph) = (null_mut(), null_mut());
        // SAFETY: pointers to places and texts that live through the calls.
        unsafe {
            assert!(tenon_engine_new(null(), &raw mut engine).is_null());
            let (text, length) = (json.as_ptr().cast(), json.len() as u64);
            assert!(tenon_graph_load(engine, text, length, null(), &raw mut graph).is_null());
        }
        test(graph);
        tenon_graph_free(graph);
        tenon_engine_free(engine);
    }

    /// Fails if somebody's turn before is not over.
    fn evaluates(graph: *mut tenon_graph) {
        let (mut job, mut result) = (null_mut(), null_mut());
        // SAFETY: pointers to places that live through the calls.
        unsafe {
            assert!(tenon_graph_start(graph, null(), 0, null(), &raw mut job).is_null());
            assert!(tenon_job_wait(job, 60_000, &raw mut result).is_null());
        }
        assert!(!result.is_null(), "it waits for the one before");
        tenon_result_free(result);
        tenon_job_free(job);
    }

    #[test]
    fn without_a_thread_there_is_no_job_and_the_graph_goes_on() {
        with_graph(|graph| {
            let mut job = null_mut();
            // SAFETY: a pointer to a place that lives through the call, and a message that does so until it is freed.
            unsafe {
                NO_THREADS.set(true);
                let error = tenon_graph_start(graph, null(), 0, null(), &raw mut job);
                NO_THREADS.set(false);
                assert_eq!(tenon_error_status(error), TENON_FAILED);
                let message = tenon_error_message(error);
                let message = std::slice::from_raw_parts(message.ptr.cast::<u8>(), message.len as usize);
                assert!(message.starts_with(b"the system gives no thread"));
                assert!(job.is_null(), "a handle of no job was written");
                tenon_error_free(error);
            }
            evaluates(graph);
        });
    }

    #[test]
    fn a_job_that_nobody_is_left_to_begin_leaves_its_turn() {
        with_graph(|graph| {
            let job = Job::new(handle::graph(graph).ok().unwrap(), &[]);
            let go = alone(&job, || panic!("nobody told it to begin")).ok().unwrap();
            drop(go);
            evaluates(graph);
        });
    }
}
