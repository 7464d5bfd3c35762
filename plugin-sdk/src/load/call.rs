//! One evaluation: what the plugin is given to call back with, and where its answers go.

use super::slot::Slot;
use super::{Body, PluginNode};
use crate::abi::plugin::*;
use crate::abi::value::*;
use crate::buffers::{Buffers, element_size};
use crate::from_c::Reader;
use crate::sound::BadValue;
use crate::to_c::CTree;
use crate::value::Branch;
use std::borrow::Cow;
use std::cell::UnsafeCell;
use std::ffi::c_void;
use std::ptr::NonNull;
use std::sync::atomic::{AtomicBool, Ordering};

/// Something that a plugin said about its input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// `TENON_NOTE`, `TENON_WARNING`, `TENON_ERROR`.
    pub severity: tenon_severity,
    /// Stable name.
    pub code: String,
    /// Sentence for people.
    pub message: String,
    /// What would fix it.
    pub hint: Option<String>,
    /// Input concerned.
    pub port: Option<String>,
    /// Item concerned.
    pub item: Option<usize>,
}

/// What the caller of a node does with what comes.
pub trait Sink {
    /// Whether arrays that come to it to keep, with a value that it accepts, live until the evaluation is over, but for
    /// columns of one item and what stands in gaps. Only then do buffers go over to it without a copy; otherwise it is shown
    /// them.
    fn keeps(&self) -> bool {
        false
    }
    /// Takes the value of an output.
    ///
    /// # Errors
    /// Says why it is not accepted.
    fn set(&mut self, output: u32, value: Vec<Branch<'_>>) -> Result<(), String>;
    /// Takes an input's value as an output's.
    ///
    /// # Errors
    /// Says why it cannot be.
    fn forward(&mut self, output: u32, input: u32) -> Result<(), String>;
    /// Takes a message.
    fn tell(&mut self, message: Message);
}

/// How an evaluation hears of its host.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Whether it should stop.
    pub cancelled: &'a (dyn Fn() -> bool + Sync),
    /// Takes the fraction done.
    pub progress: &'a (dyn Fn(f64) + Sync),
    /// The buffer that is refused as if there were no memory, from 0; for tests of plugins.
    pub refuse_buffer: Option<u64>,
    /// Where buffers are made, by their bytes, zeroed and aligned to 8, to stay until the evaluation is over; none: they are
    /// the host's own.
    pub room: Option<&'a dyn Fn(u64) -> Option<NonNull<u8>>>,
}

/// How an evaluation ended otherwise than well.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EvaluateError {
    /// It stopped because it was asked to.
    Cancelled,
    /// It failed; messages say why.
    Failed,
    /// The plugin breaks the contract.
    Fault(String),
    /// The plugin's own process ended, or had to be ended.
    Died(String),
}

/// One evaluation, as the callbacks see it.
pub(super) struct Running<'a> {
    watch: &'a Watch<'a>,
    /// A thread called back that may not.
    stray: AtomicBool,
    own: UnsafeCell<Own<'a>>,
}

/// What only the thread that evaluates touches.
struct Own<'a> {
    sink: &'a mut dyn Sink,
    buffers: Buffers,
    /// Buffers asked for so far.
    asked: u64,
    fault: Option<Box<str>>,
}

impl Own<'_> {
    /// Keeps the first fault.
    #[cold]
    fn fault(&mut self, place: std::fmt::Arguments<'_>, why: &dyn std::fmt::Display) {
        self.fault.get_or_insert_with(|| format!("{place}: {why}").into());
    }
}

/// What a plugin is given, but for where it leads.
pub(super) fn callbacks() -> tenon_call {
    let (size, host) = (size_of::<tenon_call>() as u32, std::ptr::null_mut());
    tenon_call { size, flags: 0, host, cancelled, progress, tell, buffer, set, forward }
}

/// What the thread that evaluates may do; other threads, and NULL, get `otherwise`.
#[inline]
fn own<R>(slot: Option<&Slot>, otherwise: R, f: impl FnOnce(&Watch<'static>, &mut Own<'static>) -> R) -> R {
    let Some(slot) = slot else { return otherwise };
    let Some(running) = slot.owned() else {
        slot.visit(|running| running.stray.store(true, Ordering::Relaxed));
        return otherwise;
    };
    // SAFETY: only the thread that evaluates comes here, and what it does does not call back.
    f(running.watch, unsafe { &mut *running.own.get() })
}

unsafe extern "C" fn cancelled(call: *const tenon_call) -> i32 {
    // SAFETY: the plugin hands back what it was given.
    let Some(slot) = (unsafe { Slot::of(call) }) else { return 1 };
    match slot.owned() {
        Some(running) => i32::from((running.watch.cancelled)()),
        None => slot.visit(|running| i32::from((running.watch.cancelled)())).unwrap_or(1),
    }
}

unsafe extern "C" fn progress(call: *const tenon_call, fraction: f64) {
    let told = |watch: &Watch<'_>| {
        if fraction.is_finite() {
            (watch.progress)(fraction.clamp(0.0, 1.0));
        }
    };
    // SAFETY: the plugin hands back what it was given.
    own(unsafe { Slot::of(call) }, (), |watch, _| told(watch));
}

unsafe extern "C" fn tell(call: *const tenon_call, message: *const tenon_message) -> tenon_status {
    // SAFETY: the plugin hands back what it was given.
    let slot = unsafe { Slot::of(call) };
    own(slot, TENON_BAD_ARGUMENT, |_, r| {
        // SAFETY: the contract: NULL or a message.
        match unsafe { read_message(&Reader::new(&mut r.buffers, false), message) } {
            Ok(message) => {
                r.sink.tell(message);
                TENON_OK
            }
            Err(why) => {
                r.fault(format_args!("tell"), &why);
                TENON_BAD_ARGUMENT
            }
        }
    })
}

/// # Safety
/// It is NULL or a message as the contract says.
unsafe fn read_message(reader: &Reader<'_>, message: *const tenon_message) -> Result<Message, BadValue> {
    // SAFETY: as the caller vouches.
    let (m, [code, words, hint, port]) = unsafe {
        let m = reader.sized(message, "message", ["message.size", "; set it to sizeof(tenon_message)"])?;
        let texts = [
            reader.text(m.code, "message.code")?,
            reader.text(m.message, "message.message")?,
            reader.text(m.hint, "message.hint")?,
            reader.text(m.port, "message.port")?,
        ];
        (m, texts)
    };
    let some = |t: Cow<'_, str>| (!t.is_empty()).then(|| t.into_owned());
    Ok(Message {
        severity: m.severity.min(TENON_ERROR),
        code: some(code).unwrap_or_else(|| "plugin".to_owned()),
        message: words.into_owned(),
        hint: some(hint),
        port: some(port),
        item: usize::try_from(m.item).ok().filter(|i| *i != usize::MAX),
    })
}

unsafe extern "C" fn buffer(call: *const tenon_call, element: tenon_element, count: u64) -> *mut c_void {
    // SAFETY: the plugin hands back what it was given.
    let slot = unsafe { Slot::of(call) };
    own(slot, std::ptr::null_mut(), |watch, r| {
        r.asked += 1;
        match watch.room {
            _ if watch.refuse_buffer == Some(r.asked - 1) => std::ptr::null_mut(),
            Some(room) => {
                let bytes = element_size(element).and_then(|size| size.checked_mul(count.max(1)));
                let place = bytes.and_then(|bytes| Some((room(bytes)?, bytes)));
                place.map_or(std::ptr::null_mut(), |(place, bytes)| r.buffers.lend(element, place, bytes))
            }
            None => r.buffers.make(element, count),
        }
    })
}

unsafe extern "C" fn set(call: *const tenon_call, output: u32, value: *const tenon_tree) -> tenon_status {
    // SAFETY: the plugin hands back what it was given.
    let slot = unsafe { Slot::of(call) };
    own(slot, TENON_BAD_ARGUMENT, |_, r| {
        let reader = Reader::new(&mut r.buffers, r.sink.keeps());
        // SAFETY: the contract: NULL or a value whose pointers are good until we return.
        let read = unsafe { reader.tree(value) }.map_err(|e| e.to_string());
        match read.and_then(|branches| r.sink.set(output, branches)) {
            Ok(()) => TENON_OK,
            Err(why) => {
                r.fault(format_args!("output {output}"), &why);
                TENON_BAD_TYPE
            }
        }
    })
}

unsafe extern "C" fn forward(call: *const tenon_call, output: u32, input: u32) -> tenon_status {
    // SAFETY: the plugin hands back what it was given.
    let slot = unsafe { Slot::of(call) };
    own(slot, TENON_BAD_ARGUMENT, |_, r| match r.sink.forward(output, input) {
        Ok(()) => TENON_OK,
        Err(why) => {
            r.fault(format_args!("output {output}"), &why);
            TENON_BAD_ARGUMENT
        }
    })
}

/// Inputs as a plugin reads them.
pub struct Views<'a> {
    inputs: &'a [Vec<Branch<'a>>],
    trees: Vec<tenon_tree>,
    _views: Vec<CTree<'a>>,
}

impl<'a> Views<'a> {
    /// Views of `inputs`. O(branches), plus O(items) for curves, meshes and the like.
    #[must_use]
    pub fn new(inputs: &'a [Vec<Branch<'a>>]) -> Self {
        let views: Vec<CTree<'_>> = inputs.iter().map(|branches| CTree::new(branches)).collect();
        Self { inputs, trees: views.iter().map(CTree::get).collect(), _views: views }
    }

    /// The trees, as the checks lay them out otherwise.
    pub(crate) fn trees(&self) -> &[tenon_tree] {
        &self.trees
    }
}

impl PluginNode {
    /// Evaluates it on this thread. O(inputs) besides what the plugin does; large arrays are not copied.
    ///
    /// # Errors
    /// If it was cancelled, failed, or breaks the contract.
    pub fn evaluate(
        &self,
        inputs: &[Vec<Branch<'_>>],
        watch: Watch<'_>,
        sink: &mut dyn Sink,
    ) -> Result<(), EvaluateError> {
        match &self.body {
            Body::Here { .. } => self.evaluate_views(&Views::new(inputs), watch, sink),
            Body::Apart(processes, index) => processes.evaluate(*index, inputs, watch, sink),
        }
    }

    /// The same for inputs that are views already: some ten nanoseconds besides what the plugin does.
    ///
    /// # Errors
    /// As [`PluginNode::evaluate`].
    pub fn evaluate_views(
        &self,
        inputs: &Views<'_>,
        watch: Watch<'_>,
        sink: &mut dyn Sink,
    ) -> Result<(), EvaluateError> {
        self.evaluate_at(inputs, watch, sink, |call, trees| (call, trees))
    }

    /// The same with call and trees where `place` puts them; a plugin in its own process gets its own all the same.
    ///
    /// # Errors
    /// As [`PluginNode::evaluate`].
    #[inline]
    pub(crate) fn evaluate_at(
        &self,
        inputs: &Views<'_>,
        watch: Watch<'_>,
        sink: &mut dyn Sink,
        place: impl FnOnce(&'static tenon_call, *const tenon_tree) -> (*const tenon_call, *const tenon_tree),
    ) -> Result<(), EvaluateError> {
        let (evaluate, data) = match &self.body {
            Body::Here { evaluate, data, .. } => (*evaluate, *data),
            Body::Apart(processes, index) => return processes.evaluate(*index, inputs.inputs, watch, sink),
        };
        let own = Own { sink, buffers: Buffers::default(), asked: 0, fault: None };
        let mut running = Running { watch: &watch, stray: AtomicBool::new(false), own: UnsafeCell::new(own) };
        let trees = &inputs.trees;
        let status = Slot::with(&running, |call| {
            let (call, at) = place(call, trees.as_ptr());
            // SAFETY: the plugin was loaded and never goes; inputs and call live through the call; it does not unwind,
            // says the contract.
            unsafe { evaluate(data, call, at, trees.len() as u32) }
        });
        if status == TENON_OK && running.own.get_mut().fault.is_none() && !*running.stray.get_mut() {
            return Ok(());
        }
        Err(running.ended(status))
    }
}

impl Running<'_> {
    /// Why it did not end well.
    #[cold]
    fn ended(&mut self, status: tenon_status) -> EvaluateError {
        let stray = self.stray.get_mut().then(|| "it calls back from a thread that evaluate does not run on".into());
        let fault = self.own.get_mut().fault.take().map(String::from).or(stray);
        match (status, fault) {
            (TENON_CANCELLED, _) if (self.watch.cancelled)() => EvaluateError::Cancelled,
            (_, Some(fault)) => EvaluateError::Fault(fault),
            (TENON_CANCELLED, None) => EvaluateError::Fault("it gave up although nobody asked it to".into()),
            (TENON_FAILED, None) => EvaluateError::Failed,
            (TENON_NO_MEMORY, None) => {
                let message = "there is no memory".to_owned();
                let (severity, code, hint) = (TENON_ERROR, "no-memory".to_owned(), None);
                self.own.get_mut().sink.tell(Message { severity, code, message, hint, port: None, item: None });
                EvaluateError::Failed
            }
            (other, None) => EvaluateError::Fault(format!("evaluate gave the status {other}")),
        }
    }
}
